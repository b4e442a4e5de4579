"""Stability of a rank-one feedback system everywhere in boxes of period and damping, proven.

Where the gains change slowly, a Lyapunov function that follows the frozen system decides for all longer
periods (`slow_period`). Elsewhere the monodromy matrix is a polynomial of period and damping with a bound on
its error (`FlowPolynomial`), and so are its entries in the eigenvectors of the middle of a box (`decided`).

Sources: docs/theory/proven_bounds.md, "Between the nodes of a chart".
"""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise, product
from typing import NamedTuple

import numpy as np
from numpy.polynomial.chebyshev import chebvander

from floquet.rank_one.batch import fast_monodromies
from floquet.rank_one.kernel_input import own, packed
from floquet.rank_one.kernels.gains import Limits, Point, Problem
from floquet.rank_one.largest_flow import largest_flow
from floquet.rank_one.piecewise import to_series
from floquet.rank_one.system import RankOneSystem
from lumped.typing import ComplexArray, FloatArray, IntArray, Progress

_U = 0.5 * float(np.finfo(np.float64).eps)
#: Terms of the polynomial over a box whose signs count, along period and damping.
_TERMS = (8, 4)
#: Largest error of the polynomial of a patch; the size of the patch follows.
_TOLERANCE = 1e-6
_RADII = np.geomspace(1.5, 200.0, 40)  # sums of the semi-axes of the ellipses of the error bound
_ANGLE = 0.5  # of half a step in `largest_flow`
_CELLS = 4  # parts of a piece of the gains whose frozen systems are taken
_ROWS = 8  # rows of cells for which one Lyapunov function is sought
_STRIP = 0.1  # integral of the change of A over a strip of a patch, if there are no more than so many strips
_STRIPS = 24
_CLOSE = 1.1  # ratio of periods below which all of them are likely to be long together
_HOPELESS = 1e9  # error of a patch in which nothing is decided
_BATCH = 512  # boxes that are decided together


class NodeCounts(NamedTuple):
    """Nodes of the polynomial of a patch along period and along damping."""

    period: int
    damping: int


_NODES = NodeCounts(24, 16)


class GainDeviation(NamedTuple):
    """Bounds on the integrals over the phase of the norm of what w and wd deviate, norm as in `Gains`."""

    w: float
    wd: float


#: Periods (k,) [s] -> factors (k, Q-1) on the varied gains; None: one system does not hold for all periods.
Factors = Callable[[FloatArray], FloatArray | None]


def proven_cells(
    system: RankOneSystem,
    periods: FloatArray,
    damping: FloatArray,
    factors: Factors,
    progress: Progress | None = None,
    *,
    deviation: GainDeviation | None = None,
) -> IntArray:
    """Verdict (N, M) of each cell of a grid: 1 stable, -1 unstable everywhere in it, 0 not proven.

    Parameters
    ----------
    periods, damping : (N+1,) [s] and (M+1,), increasing: edges of the cells; damping is the factor on wd
    factors : on the varied gains, powers of the period or linear in its logarithm, else nothing is proven
    deviation : of the gains that are meant from those of the system and the factors; None: zero
    """
    problem = packed(system)
    rows = damping.size - 1
    verdict = np.zeros((periods.size - 1, rows), dtype=np.intp)
    factor_values = _scaled(np.geomspace(periods[0], periods[-1], _NODES.damping), factors)
    if factor_values is None:
        return verdict
    end_factors = factor_values[[0, -1]]

    def by_slow_variation(low: int, high: int) -> bool:
        """Prove rows of cells for long periods; whether some cells are proven."""
        leaf = high - low <= _ROWS
        if leaf or periods[-1] < _CLOSE * periods[0]:
            slow = slow_period(system, damping[[low, high]], end_factors, deviation)
            if leaf or slow <= periods[0]:
                verdict[np.searchsorted(periods, slow) :, low:high] = 1
                return bool(slow <= periods[-1])
        middle = (low + high) // 2
        # With less damping hardly more is proven.
        return by_slow_variation(middle, high) and by_slow_variation(low, middle)

    by_slow_variation(0, rows)
    end = int(np.flatnonzero((verdict == 0).any(axis=1)).max(initial=-1)) + 1
    i = 0
    growth = 2.0
    while i < end:
        size = PatchSize(problem, growth)

        def wide(k: int, i: int = i, size: PatchSize = size) -> float:
            return 1e3 * size.error(periods[[i, k]], damping[[0, 0]])

        b = _last(i, end, wide)
        along_period = _fewest_nodes(size, periods[[i, b]], damping[[0, 0]])
        c = 0
        while c < rows:

            def tall(k: int, c: int = c, T: FloatArray = periods[[i, b]], size: PatchSize = size) -> float:
                return size.error(T, damping[[c, k]])

            d = _last(c, rows, tall)
            patch = None
            block_verdict = verdict[i:b, c:d]
            if not block_verdict.all():
                patch = FlowPolynomial.of(
                    system,
                    problem,
                    periods[[i, b]],
                    damping[[c, d]],
                    factors,
                    NodeCounts(along_period, _NODES.damping),
                    deviation=deviation,
                )
            if patch is not None:
                growth = min(1.1 * patch.growth, 10.0)
            if patch is not None and patch.error < _HOPELESS:
                result = _subdivided(patch, periods[i : b + 1], damping[c : d + 1])
                block_verdict[block_verdict == 0] = result[block_verdict == 0]
            c = d
        i = b
        if progress is not None:
            progress(i / end)
    return verdict


def _fewest_nodes(size: PatchSize, periods: FloatArray, damping: FloatArray) -> int:
    """Nodes along the period that are enough for a small error along it: few for a narrow patch."""
    for count in range(_TERMS[0], _NODES.period, 4):
        if 1e3 * size.error(periods, damping, nodes=NodeCounts(count, 1)) <= _TOLERANCE:
            return count
    return _NODES.period


def _last(first: int, end: int, error: Callable[[int], float]) -> int:
    """The last index of first + 1 .. end at which an error is small; first + 1 if there is none."""
    return max(first, bisect_left(range(first + 1, end + 1), _TOLERANCE, key=error) + first, first + 1)


def slow_period(
    system: RankOneSystem,
    damping: FloatArray,
    factors: FloatArray,
    deviation: GainDeviation | None = None,
) -> float:
    """Period from which on a system is stable, PROVEN, for all damping (2,) and factors (2, Q-1) in between.

    With a ``deviation`` for all gains that deviate by no more, wherever in the cycle.

    On a cell of the phase |L x| grows at most with the logarithmic norm of L A L^-1, from cell to cell by |L'
    L^-1|; the norm is convex, so that the largest is at a corner. inf: none such, or gyroscopic terms.
    """
    if system.gyroscopic is not None:
        return math.inf
    form = system.modal()
    problem = packed(system)
    m = form.omega.size
    share = np.repeat(np.diff(system.phases) / _CELLS, _CELLS)
    middle = (2.0 * np.arange(_CELLS) + 1.0) / _CELLS - 1.0
    values, spreads = zip(*(_around(poly, middle) for poly in (form.w, form.wd)), strict=True)
    constant = np.zeros((share.size, 2 * m, 2 * m))
    constant[:, range(m), range(m, 2 * m)] = form.omega
    constant[:, range(m, 2 * m), range(m)] = -form.omega
    constant[:, m:, m:] -= form.C
    constant[:, m:, :m] += np.outer(form.reference, form.v / form.omega)

    def frozen(zeta: float, g: FloatArray) -> FloatArray:
        A = constant.copy()
        A[:, m:, :m] -= np.tensordot(g, values[0], 1)[:, :, None] * (form.v / form.omega)
        A[:, m:, m:] -= zeta * np.tensordot(g, values[1], 1)[:, :, None] * form.v
        return A

    gains = np.concatenate([np.ones((2, 1)), factors], axis=1)
    V = np.linalg.eig(frozen(float(damping.mean()), gains.mean(axis=0)))[1]
    L = np.linalg.inv(V)
    size = np.linalg.norm(L, axis=(1, 2)) * np.linalg.norm(V, axis=(1, 2))
    # L is what is meant exactly; V is its inverse but for this.
    rounding = 32.0 * (2.0 * m + 8.0) * _U * size
    corners = [frozen(z, np.array(g)) for z in damping for g in product(*map(np.unique, gains.T))]
    rate = np.full(share.size, -np.inf)
    for A in corners:
        transformed = L @ A @ V
        top = np.linalg.eigvalsh(transformed + np.conj(np.swapaxes(transformed, 1, 2)))[:, -1]
        rate = np.maximum(rate, 0.5 * top + rounding * np.linalg.norm(A, axis=(1, 2)))
    most = np.abs(gains).max(axis=0)
    z = float(damping.max())
    column = np.abs(L[:, :, m:])
    into = np.linalg.norm(form.v / form.omega @ V[:, :m], axis=1), np.linalg.norm(form.v @ V[:, m:], axis=1)
    for spread, factor, row in zip(spreads, (1.0, z), into, strict=True):
        within_cell = np.einsum("kij,kj->ki", column, factor * np.tensordot(most, spread, 1))
        rate += np.linalg.norm(within_cell, axis=1) * row * (1.0 + 1e-9)
    norms = np.array([np.linalg.norm(form.v / form.omega), z * np.linalg.norm(form.v)])
    rate += size * np.repeat(problem.noise + np.tensordot(most, problem.fit_error, 1) @ norms, _CELLS)
    edges = (np.tensordot(most, problem.edge_error, 1) @ norms).sum()
    edges += 0.0 if deviation is None else np.array(deviation) @ norms
    total = rate @ share + size.max() * edges
    jump_norms = np.linalg.norm(np.roll(L, -1, axis=0) @ V, 2, axis=(1, 2)) * (1.0 + rounding)
    return float(np.log(jump_norms).sum() / -total) * (1.0 + 1e-9) if total < 0.0 else math.inf


def _around(poly: FloatArray, middle: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Values of polynomials (Q, P, m, d+1) in the middles of cells, and bounds on their change within cells.

    Both are (Q, P cells, m).
    """
    j = np.arange(poly.shape[3])
    choose = np.array([[math.comb(a, b) for b in j] for a in j], dtype=float)
    power = np.maximum(j[:, None] - j, 0)
    shift = choose * middle[:, None, None] ** power / middle.size**j
    terms = np.einsum("qpmj,cjk->qpcmk", poly, shift).reshape(poly.shape[0], -1, *poly.shape[2:])
    return terms[..., 0], np.abs(terms[..., 1:]).sum(axis=-1)


class PatchSize:
    """Error of the polynomial of a patch as a function of the size of the patch.

    Flows within a cycle are at most ``growth`` in the middle of the patch. At complex period and damping they
    are at most growth exp(growth d), d being the integral of the change of T A (Gronwall).
    """

    def __init__(self, problem: Problem, growth: float, gains: FloatArray | None = None) -> None:
        self.growth = growth
        shares = np.diff(problem.phases)
        v_over_omega = float(np.linalg.norm(problem.v / problem.omega))
        #: Norms by which the feedback of the deflection and of its rate act.
        self.norms = v_over_omega, float(np.linalg.norm(problem.v))
        rates = (problem.sizes + problem.fit_error).transpose(2, 0, 1) @ shares * (1.0 + 1e-9)
        edges = problem.edge_error.sum(axis=1)
        #: Integrals of the norms of the feedback of each part over the cycle.
        self.each = (
            (rates[0] + edges[:, 0]) * v_over_omega,
            (rates[1] + edges[:, 1]) * self.norms[1],
        )
        gains = np.ones(edges.shape[0]) if gains is None else np.abs(gains)
        self.w, self.wd = (float(gains @ part) for part in self.each)
        self.constant = float(problem.omega.max() + np.linalg.norm(problem.C) + problem.noise)

    def change(
        self, T: FloatArray, damping: FloatArray, along: FloatArray, up: FloatArray, factor_change: FloatArray
    ) -> FloatArray:
        """Bounds d of a patch, (radii,), at so many times its half widths; moved (Q, radii): the factors."""
        z = damping.mean()
        dz = 0.5 * up * (damping[1] - damping[0])
        half = 0.5 * along * (T[1] - T[0])
        by_damping_and_factors = (
            dz * self.wd + self.each[0] @ factor_change + (z + dz) * (self.each[1] @ factor_change)
        )
        return np.asarray(
            half * (self.constant + self.w + z * self.wd) + (T.mean() + half) * by_damping_and_factors
        )

    def error(
        self,
        T: FloatArray,
        damping: FloatArray,
        factor_change: FloatArray | None = None,
        nodes: NodeCounts = _NODES,
    ) -> float:
        """Bound on the error of the polynomial (Trefethen, theorem 8.2, along each axis).

        At one value of damping the polynomial is constant along damping, without an error.
        """
        semi = 0.5 * (_RADII + 1.0 / _RADII)
        one = np.ones_like(_RADII)
        total = 0.0
        factor_change = np.zeros((len(self.each[0]), _RADII.size)) if factor_change is None else factor_change
        along_period = nodes.period, (semi, one, factor_change), 1.0
        lebesgue = 1.0 + 2.0 / math.pi * math.log(nodes.period)
        along_damping = nodes.damping, (one, semi, factor_change[:, :1]), lebesgue
        one_damping = damping[0] == damping[1]
        for count, reach, weight in (along_period,) if one_damping else (along_period, along_damping):
            log = self.growth * self.change(T, damping, *reach) - (count - 1.0) * np.log(_RADII)
            log += np.log(4.0 * self.growth * weight / (_RADII - 1.0))
            total += math.exp(min(float(log.min()), 700.0))
        return total * (1.0 + 1e-9)

    def deviation(
        self,
        T: FloatArray,
        damping: FloatArray,
        factor_change: FloatArray,
        deviation: GainDeviation,
        flow: float | None = None,
    ) -> float:
        """Bound on the change of M everywhere in a patch by gains that deviate, wherever in the cycle.

        Flows within the cycle are at most g = ``flow`` in the patch, by default growth exp(growth d). Let e
        be the integral of the norm of the change of T A over the cycle. Then M changes by g (exp(g e) - 1)
        at most (Gronwall).
        """
        if flow is None:
            flow = self.flow(T, damping, factor_change, self.growth)
        norms = self.norms[0], damping.max() * self.norms[1]
        e = float(T.max()) * (deviation.w * norms[0] + deviation.wd * norms[1])
        return float(flow * np.expm1(min(flow * e, 700.0))) * (1.0 + 1e-9)

    def flow(self, T: FloatArray, damping: FloatArray, factor_change: FloatArray, growth: float) -> float:
        """Bound on all flows within a cycle in a patch, of which ``growth`` is a bound in the middle."""
        one = np.ones(1)
        # The ellipse contains the patch.
        d = float(self.change(T, damping, one, one, factor_change[:, :1])[0])
        return growth * math.exp(min(growth * d, 700.0))


@dataclass(frozen=True, eq=False)
class FlowPolynomial:
    """Monodromy matrices of a patch of period and damping as polynomials with a PROVEN bound on their error.

    Attributes
    ----------
    coefficients : (a, b, n, n) of T_a(x) T_b(y), x and y in [-1, 1] along period and damping
    error : bound on the 2-norm of the error everywhere in the patch
    growth : bound on all flows within a cycle in the middle of the patch
    """

    coefficients: FloatArray
    error: float
    growth: float

    @classmethod
    def of(
        cls,
        system: RankOneSystem,
        problem: Problem,
        periods: FloatArray,
        damping: FloatArray,
        factors: Factors,
        nodes: NodeCounts = _NODES,
        *,
        tolerance: float = 1e-10,
        deviation: GainDeviation | None = None,
    ) -> FlowPolynomial | None:
        """Between two periods and two values of damping; None: factors of no known law.

        Parameters
        ----------
        system, problem : the system, and the same in the form of the kernels
        periods, damping : (2,) [s] and (2,) ends of the patch
        factors : on the varied gains
        nodes : of the polynomial
        tolerance : of the monodromy matrices at the nodes, see `fast_monodromies`
        deviation : of the gains that are meant from those of the system and the factors; None: zero
        """
        x, to_T = to_series(nodes.period)
        y, to_z = to_series(nodes.damping)
        T = periods.mean() + 0.5 * np.diff(periods) * x
        z = damping.mean() + 0.5 * np.diff(damping) * y
        t = float(periods.mean())
        zeta = float(damping.mean())
        factor_values = _scaled(np.append(T, t), factors)
        if factor_values is None:
            return None
        flow = fast_monodromies(
            system,
            np.repeat(T, y.size),
            np.tile(z, x.size),
            np.repeat(factor_values[:-1], y.size, 0),
            tolerance=tolerance,
            problem=problem,
        )
        matrices = flow.matrices.reshape(x.size, y.size, *flow.matrices.shape[1:])
        gains = np.append(1.0, factor_values[-1])
        size = PatchSize(problem, math.inf, gains)
        size.growth = growth_at(problem, size, Point(own(gains), zeta, t))
        factor_change = _factor_change(T / t, factor_values)
        error = size.error(periods, damping, factor_change, nodes)
        if deviation is not None:
            largest = _flow_in_patch(
                problem, size, Point(own(gains), zeta, t), periods, damping, factor_change
            )
            error += size.deviation(periods, damping, factor_change, deviation, largest)
        error += (1.0 + 2.0 / math.pi * math.log(x.size)) ** 2 * float(flow.errors.max())  # Lebesgue's
        along_period = (to_T @ matrices.reshape(x.size, -1)).reshape(matrices.shape)
        coefficients = to_z @ along_period.reshape(x.size, y.size, -1)
        coefficients = coefficients.reshape(matrices.shape)
        return cls(coefficients, error if math.isfinite(error) else math.inf, size.growth)


def growth_at(problem: Problem, size: PatchSize, point: Point) -> float:
    """Bound on all flows within a cycle at one point; inf: none is known."""
    largest, wrong = largest_flow(problem, point, Limits(1e-12, _ANGLE))
    if not largest * wrong < 0.5:
        return math.inf
    # Norms grow within a step, half of which has the angle, by the symmetric part of A alone.
    zeta = abs(point.zeta)
    norms = np.array([np.linalg.norm(problem.v / problem.omega), zeta * np.linalg.norm(problem.v)])
    rates = np.tensordot(np.abs(point.weights), problem.sizes + problem.fit_error, 1) * norms
    growth_rates = (
        rates @ [0.5, 1.0] + problem.drive + problem.noise + problem.gyroscopic_drive / point.period
    )
    within = math.exp(
        4.0 * _ANGLE * float((growth_rates / (size.constant + rates.sum(axis=1))).max()) * (1.0 + 1e-6)
    )
    return within * largest / (1.0 - largest * wrong)


def _flow_in_patch(
    problem: Problem,
    size: PatchSize,
    middle: Point,
    periods: FloatArray,
    damping: FloatArray,
    factor_change: FloatArray,
) -> float:
    """PROVEN bound on all flows within a cycle everywhere in a patch: from the middles of strips of damping.

    Over a whole patch Gronwall's inequality would allow for flows that grow where damping makes them decay.
    """
    one = np.ones(1)
    d = float(size.change(periods, damping, one, one, factor_change[:, :1])[0])
    count = int(np.clip(math.ceil(d / _STRIP), 1, _STRIPS)) if damping[1] > damping[0] else 1
    edges = np.linspace(damping[0], damping[1], count + 1)
    largest = 0.0
    for ends in pairwise(edges):
        strip = np.array(ends)
        growth = growth_at(problem, size, middle._replace(zeta=float(strip.mean())))
        largest = max(largest, size.flow(periods, strip, factor_change, growth))
    return largest * (1.0 + 1e-9)


def _scaled(T: FloatArray, factors: Factors) -> FloatArray | None:
    """Factors (k, Q-1) at periods, if all are powers of the period or all linear in its logarithm."""
    values = factors(T)
    if values is None or not values.shape[1]:
        return values
    log = np.log(T / T[0])[:, None]
    slope, power = _slopes(T, values)
    lines = values[0] + log * slope, values[0] * np.exp(log * power)
    close = 1e-9 * np.abs(values).max(axis=0)
    return values if any((np.abs(line - values).max(axis=0) <= close).all() for line in lines) else None


def _slopes(T: FloatArray, values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Change of factors and of their logarithms (Q-1,) with the logarithm of the period."""
    width = np.log(T[1] / T[0])
    size = np.maximum(np.abs(values), np.finfo(float).tiny)
    return (values[1] - values[0]) / width, np.log(size[1] / size[0]) / width


def _factor_change(x: FloatArray, values: FloatArray) -> FloatArray:
    """Bounds (Q, radii) on the change of factors on ellipses around periods, relative to the middle period.

    ``x`` are the periods over the middle period, the middle one last; ``values`` the factors there. Where an
    ellipse does not reach 0, |ln(1 + z)| <= -ln(1 - |z|).
    """
    reach = 1.01 * np.abs(x - 1.0).max() * 0.5 * (_RADII + 1.0 / _RADII)
    depth = -np.log1p(-np.minimum(reach, 0.999))
    slope, power = (np.abs(v)[:, None] for v in _slopes(x, values))
    change = np.maximum(slope * depth, np.abs(values[-1])[:, None] * np.expm1(power * depth))
    change[:, reach > 0.999] = np.where(slope + power > 0.0, 1e30, 0.0)
    return np.concatenate([np.zeros((1, _RADII.size)), change])


def _subdivided(patch: FlowPolynomial, periods: FloatArray, damping: FloatArray) -> IntArray:
    """Verdicts of the cells of a patch. A box of cells is cut until it is proven or a single cell."""
    x, y = (2.0 * (v - v[0]) / (v[-1] - v[0]) - 1.0 for v in (periods, damping))
    verdict = np.zeros((x.size - 1, y.size - 1), dtype=np.intp)
    boxes = CellBoxes(*np.array([[0], [x.size - 1], [0], [y.size - 1]]))
    while boxes.first.size:
        batch = CellBoxes(*(ends[:_BATCH] for ends in boxes))
        result = decided(
            patch, np.stack([x[batch.first], x[batch.last]]), np.stack([y[batch.low], y[batch.high]])
        )
        for k in np.flatnonzero(result.verdict):
            inside = slice(batch.first[k], batch.last[k]), slice(batch.low[k], batch.high[k])
            verdict[inside] = result.verdict[k]
        rest = CellBoxes(*(ends[_BATCH:] for ends in boxes))
        boxes = CellBoxes(*map(np.concatenate, zip(rest, _parts(batch, result), strict=True)))
    return verdict


class CellBoxes(NamedTuple):
    """Boxes of cells: indices (k,) of their edges, first and last along the period, low and high along the
    damping.
    """

    first: IntArray
    last: IntArray
    low: IntArray
    high: IntArray


def _parts(boxes: CellBoxes, decision: Decision) -> CellBoxes:
    """Halves or quarters of all boxes that are not decided and have several cells.

    A box is cut along the axis along which its entries vary more, along both if they vary alike.
    """
    first, last, low, high = boxes
    is_long = last - first > 1
    is_tall = high - low > 1
    undecided = decision.verdict == 0
    along = undecided & is_long & ((2.0 * decision.across >= decision.upward) | ~is_tall)
    up = undecided & is_tall & ((2.0 * decision.upward >= decision.across) | ~is_long)
    i = np.where(along, (first + last) // 2, last)
    j = np.where(up, (low + high) // 2, high)
    quarters = (
        (CellBoxes(first, i, low, j), along | up),
        (CellBoxes(first, i, j, high), up),
        (CellBoxes(i, last, low, j), along),
        (CellBoxes(i, last, j, high), along & up),
    )
    return CellBoxes(
        *(np.concatenate([part[k][is_cut] for part, is_cut in quarters]) for k in range(len(boxes)))
    )


class Decision(NamedTuple):
    """Verdicts of k boxes.

    Attributes
    ----------
    verdict : (k,) 1 stable, -1 unstable everywhere in the box, 0 not proven
    across, upward : (k,) how much the entries of the matrices vary along period and along damping
    """

    verdict: IntArray
    across: FloatArray
    upward: FloatArray


class EntryRanges(NamedTuple):
    """Ranges of the moduli of the entries of V^-1 M V over k boxes.

    Attributes
    ----------
    V : (k, n, n) eigenvectors in the middles of the boxes
    low, high : (k, n) least and largest modulus of each entry of the diagonal
    others : (k, n, n) largest modulus of the other entries; zeros on the diagonal
    across, upward : (k,) how much the entries vary along period and along damping
    """

    V: ComplexArray
    low: FloatArray
    high: FloatArray
    others: FloatArray
    across: FloatArray
    upward: FloatArray


def decided(patch: FlowPolynomial, x: FloatArray, y: FloatArray) -> Decision:
    """PROVEN verdicts of boxes x, y (2, k) of a patch, see `verdicts_by_disks`."""
    return verdicts_by_disks(bounded_entries(patch, x, y))


def verdicts_by_disks(ranges: EntryRanges) -> Decision:
    """PROVEN verdicts of boxes by Gershgorin's disks, scaled.

    Where margin_k u_k > sum_j f_kj u_j for some u > 0, no multiplier is on the unit circle. The number of
    multipliers outside is then the number of diagonal entries outside.
    """
    low = ranges.low
    high = ranges.high
    f = ranges.others
    margin = np.maximum(1.0 - high, low - 1.0)
    size = margin.shape[1]
    system = -f
    system[:, range(size), range(size)] = np.maximum(margin, 1e-9)
    try:
        u = np.linalg.solve(system, np.ones((*margin.shape, 1)))[:, :, 0]
    except np.linalg.LinAlgError:
        u = np.zeros_like(margin)
    good = (margin > 0.0).all(axis=1) & (u > 0.0).all(axis=1)
    good &= (margin * u * (1.0 - 1e-12) > np.einsum("kij,kj->ki", f, u) * (1.0 + 1e-12)).all(axis=1)
    verdict = np.where(good, np.where((low > 1.0).any(axis=1), -1, 1), 0)
    return Decision(verdict, ranges.across, ranges.upward)


def bounded_entries(patch: FlowPolynomial, x: FloatArray, y: FloatArray) -> EntryRanges:
    """Ranges of the entries of V^-1 M V over boxes x, y (2, k) of a patch, see `entry_ranges`."""
    a, b, n, _ = patch.coefficients.shape
    J, K = _TERMS
    E = _restricted(x, a)
    F = _restricted(y, b)
    count = x.shape[1]
    parts = np.swapaxes(E[:, :, :J], 1, 2) @ patch.coefficients.reshape(a, -1)
    parts = np.swapaxes(F[:, None, :, :K], 2, 3) @ parts.reshape(count, J, b, -1)
    parts = parts.reshape(count, J, K, n, n)
    sizes = np.linalg.norm(patch.coefficients, axis=(2, 3))
    x_weights = np.abs(E)
    y_weights = np.abs(F)
    all_terms = np.einsum("ka,ab,kb->k", x_weights.sum(axis=2), sizes, y_weights.sum(axis=2))
    signed_terms = np.einsum(
        "ka,ab,kb->k", x_weights[:, :, :J].sum(axis=2), sizes, y_weights[:, :, :K].sum(axis=2)
    )
    rest = all_terms - signed_terms + patch.error
    rest += _restriction_rounding(a, n) * (all_terms + sizes.sum())
    return entry_ranges(parts, rest)


def _restriction_rounding(count: int, n: int) -> float:
    """Rounding of a series of so many terms and of its restriction to a box, per unit of the moduli.

    64 count^2 units: values of T_a at the nodes, sums over a and b, series and their restriction.
    """
    return (64.0 * count**2 + 32.0 * (n + 8.0)) * _U


class IntervalBoxes(NamedTuple):
    """Intervals (k,) of patches of one value of damping.

    Attributes
    ----------
    patch : (k,) number of the patch
    low, high : (k,) ends in the patch, from -1 to 1
    """

    patch: IntArray
    low: FloatArray
    high: FloatArray


def decided_intervals(patches: Sequence[FlowPolynomial], boxes: IntervalBoxes) -> IntArray:
    """PROVEN verdicts (k,) of intervals of patches of one value of damping, as of `decided`."""
    coefficients = np.stack([patch.coefficients[:, 0] for patch in patches])
    patch_errors = np.array([patch.error for patch in patches])
    a, n = coefficients.shape[1:3]
    J = _TERMS[0]
    E = _restricted(np.stack([boxes.low, boxes.high]), a)
    of_box = coefficients[boxes.patch]
    parts = (np.swapaxes(E[:, :, :J], 1, 2) @ of_box.reshape(-1, a, n * n)).reshape(-1, J, 1, n, n)
    sizes = np.linalg.norm(of_box, axis=(2, 3))
    weights = np.abs(E)
    all_terms = (weights.sum(axis=2) * sizes).sum(axis=1)
    rest = all_terms - (weights[:, :, :J].sum(axis=2) * sizes).sum(axis=1) + patch_errors[boxes.patch]
    rest += _restriction_rounding(a, n) * (all_terms + sizes.sum(axis=1))
    return verdicts_by_disks(entry_ranges(parts, rest)).verdict


def entry_ranges(parts: FloatArray, rest: FloatArray) -> EntryRanges:
    """Ranges of the entries of V^-1 M V over boxes, V the eigenvectors in the middle.

    Over a box M is the polynomial of ``parts`` (k, J, K, n, n), terms T_j(x) T_l(y), but for ``rest`` (k,),
    a bound on the 2-norm. The signs of the terms of ``parts`` count; ``rest`` is added by modulus.
    """
    J, K, n = parts.shape[1:4]
    V = np.linalg.eig(parts[:, 0, 0])[1]
    Y = np.linalg.inv(V)
    N = Y[:, None, None] @ parts @ V[:, None, None]
    reach = np.linalg.norm(Y, axis=2)[:, :, None] * np.linalg.norm(V, axis=1)[:, None, :]
    moduli = np.abs(N)
    entry_error = rest[:, None, None] * reach
    f = (moduli.sum(axis=(1, 2)) + entry_error) * (1.0 + 1e-12)
    # Y is the inverse of V but for q.
    q = (np.abs(np.eye(n) - Y @ V) + 4.0 * (n + 4.0) * _U * reach).sum(axis=2)
    worst = np.minimum(q.max(axis=1), 0.5)
    by_inverse = (q / (1.0 - worst)[:, None])[:, :, None] * f.max(axis=1)[:, None, :]
    f = f + by_inverse
    entry_error = entry_error + by_inverse
    diagonal = np.einsum("kJKii->kiJK", N)
    X, to_X = to_series(2 * J - 1)
    Z, to_Z = to_series(2 * K - 1)
    square = to_X @ np.abs(chebvander(X, J - 1) @ diagonal @ chebvander(Z, K - 1).T) ** 2 @ to_Z.T
    varied = np.abs(square).sum(axis=(2, 3)) - np.abs(square[:, :, 0, 0])
    varied += 1e-12 * np.abs(diagonal).sum(axis=(2, 3)) ** 2
    diagonal_error = np.einsum("kii->ki", entry_error) + np.where(q.max(axis=1) < 0.5, 0.0, np.inf)[:, None]
    low = np.sqrt(np.maximum(square[:, :, 0, 0] - varied, 0.0)) * (1.0 - 1e-12) - diagonal_error
    high = np.sqrt(square[:, :, 0, 0] + varied) * (1.0 + 1e-12) + diagonal_error
    f[:, range(n), range(n)] = 0.0
    moduli[..., range(n), range(n)] = 0.0
    across = moduli[:, 1:, 0].sum(axis=(1, 2, 3))
    square = np.abs(square)
    across += square[:, :, 1:, 0].sum(axis=2).max(axis=1)
    upward = moduli[:, :, 1:].sum(axis=(1, 2, 3, 4)) + square[:, :, :, 1:].sum(axis=(2, 3)).max(axis=1)
    return EntryRanges(V, low, high, f, across, upward)


def _restricted(ends: FloatArray, count: int) -> FloatArray:
    """Chebyshev coefficients (k, a, j) of the polynomials T_a restricted to intervals (2, k)."""
    x, to = to_series(count)
    places = ends.mean(axis=0)[:, None] + 0.5 * (ends[1] - ends[0])[:, None] * x
    return np.asarray(np.swapaxes(chebvander(places, count - 1), 1, 2) @ to.T)
