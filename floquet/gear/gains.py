"""The gains by which the mesh of a gear pair acts on each coordinate, as polynomials with proven errors.

The laws k, c and mu of a tooth pair are piecewise polynomials, so between two breaks of any law of any
pair the gains are polynomials of known degree: k (normal + mu (arm_0 + arm_1 xi)) and the like. Where teeth
differ, polynomials through computed values take the place of the gains, in every mesh cycle between the
instants at which a pair of this cycle touches or leaves.

Sources: docs/theory/proven_bounds.md, "The gains".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from floquet.rank_one.piecewise import GainValues, series_rounding, to_series
from lumped.errors import NumericalError
from lumped.friction.registry import law_of
from lumped.mesh.places import kinks, linear_form_at
from lumped.mesh.records import BY_APPROACH, BY_RATE
from lumped.mesh.tables import MeshTables
from lumped.model.periodic_system import LTVSystem
from lumped.model.swing import moments
from lumped.model.tooth_laws import ToothLaws, mesh_tables
from lumped.path_function import PathFunction
from lumped.typing import FloatArray

_U = 0.5 * float(np.finfo(np.float64).eps)
#: Roundings of one value, without Horner's rule and the sum over pairs: 10 of arm, level, products and the
#: factor on stiffness, 20 of the factor on mu by speed.
_ROUNDINGS = 30
#: Rounding of a position, relative to the largest position: offset, phase, product, sum, difference.
_PLACE = 16.0 * _U
#: Error of a switch of a friction law that is a root, see `ContactPath.crossings`, relative to L_XY.
_SEARCH = 1e-14
#: Breaks closer than this part of a base pitch may share one end of a segment.
_MERGED = 1e-12
#: Positions that are one break of mu, relative to the end of the path.
_SAME_BREAK = 1e-11
#: Degree of the polynomials in place of the factor on stiffness and of its root.
_FACTOR_DEGREE = 8
#: Nodes and largest length of the steps of tables: with 9 a step has all of a law's polynomial.
_NODES = 9
_LARGEST_STEP = 1.0 / 16.0
#: Places of a step between which a kink is looked for, and steps of the search.
_LOOKS = np.linspace(0.0, 1.0, 3)
_ROUNDS = 16


@dataclass(frozen=True, eq=False)
class _Law:
    """A law of one tooth pair on the segments of the cycle, for every pair that may touch.

    Attributes
    ----------
    coefficients : (d+1, pairs, S) highest power first, of the position since ``start``; zero out of contact
    start : (pairs, S) positions [m]
    size, slope : (pairs, S) bounds on |law| and on its derivative there
    near : (pairs, S+1) bound on |law| on both sides of each edge of the segments
    misfit : (pairs, S) bound on the error of the polynomials
    """

    coefficients: FloatArray
    start: FloatArray
    size: FloatArray
    slope: FloatArray
    near: FloatArray
    misfit: FloatArray

    @classmethod
    def of(
        cls,
        law: PathFunction,
        misfit: FloatArray | None,
        middle: FloatArray,
        touch: npt.NDArray[np.bool_],
        pitch: float,
    ) -> _Law:
        used = np.flatnonzero(np.abs(law.coefficients).max(axis=1))
        rows = law.coefficients[used[0] if used.size else -1 :]
        width = np.diff(law.breaks)
        powers = np.arange(rows.shape[0])[::-1]
        # A little beyond both ends, where rounding of the position may lead.
        reach = width * (1.0 + 1e-9) + _PLACE * law.breaks[-1]
        terms = np.abs(rows) * reach ** powers[:, None]
        size_of_piece = terms.sum(axis=0)
        slope = (terms * powers[:, None]).sum(axis=0) / reach
        piece = np.clip(np.searchsorted(law.breaks, middle, side="right") - 1, 0, width.size - 1)
        inside = touch & (middle >= law.breaks[0]) & (middle <= law.breaks[-1])
        size = np.where(inside, size_of_piece[piece], 0.0)
        near = np.maximum(np.pad(size, ((0, 0), (1, 0))), np.pad(size, ((0, 0), (0, 1))))
        near[:, [0, -1]] = near[:, [0, -1]].max()
        # Where rounding has made one of several breaks, the pieces between them have no segment of their own.
        near = np.maximum(near, size_of_piece[width < _MERGED * pitch].max(initial=0.0))
        return cls(
            np.where(inside, rows[:, piece], 0.0),
            law.breaks[piece],
            size,
            np.where(inside, slope[piece], 0.0),
            near,
            np.zeros_like(size) if misfit is None else np.where(inside, misfit[piece], 0.0),
        )

    @property
    def degree(self) -> int:
        return int(self.coefficients.shape[0]) - 1

    def __call__(self, xi: FloatArray, pair: int, segment: npt.NDArray[np.intp]) -> FloatArray:
        """Values at positions xi (k, s) that lie in these segments (k,)."""
        x = xi - self.start[pair, segment][:, None]
        rows = self.coefficients[:, pair, segment]
        value = np.broadcast_to(rows[0][:, None], x.shape)
        for row in rows[1:]:
            value = value * x + row[:, None]
        return np.asarray(value)


class _RowBounds(NamedTuple):
    """Bounds on the contribution of one unit of load to a gain, as norms over the coordinates.

    Attributes
    ----------
    normal : constant part
    arm : per |mu|
    level : level of friction that acts
    arm_slope : per unit of position and |mu|
    """

    normal: float
    arm: float
    level: float
    arm_slope: float


#: Ends of intervals of the path [m].
Intervals = tuple[tuple[float, float], ...]


def _inside(xi: FloatArray, breaks: FloatArray, intervals: Intervals | None) -> FloatArray:
    """1 within any of some intervals between breaks, else 0; None: 1 everywhere."""
    if intervals is None:
        return np.ones_like(xi)
    ends = np.array(intervals).reshape(-1, 2)
    near = np.abs(ends[:, :, None] - breaks).min(axis=2, initial=np.inf)
    if (near > _SAME_BREAK * breaks[-1]).any():
        raise NumericalError("the intervals on which a level of friction acts do not end at breaks of mu.")
    return np.asarray(((xi[..., None] > ends[:, 0]) & (xi[..., None] < ends[:, 1])).any(axis=-1), dtype=float)


class _Factors(NamedTuple):
    """Polynomials q and s in place of the factor f on stiffnesses and of the root of f, on k pieces.

    Attributes
    ----------
    values : of q and of s at the nodes (k, s)
    errors : of q and of s, bounds (k,)
    largest : bound (k,) on 1, q and s
    """

    values: tuple[FloatArray, FloatArray]
    errors: tuple[FloatArray, FloatArray]
    largest: FloatArray


class MeshGains:
    """Gains on the coordinates of a "mesh" form, with PROVEN errors, as `fit_pieces` asks for them.

    The gains come in pairs: feedback of the deflection, feedback of the rate of the deflection. Without
    ``levels`` one pair holds normal loads and friction. With levels of friction, the first of which is zero,
    the first pair holds normal loads, the second pair mu less the sum of the levels, and each further pair
    one level. ``acts`` are the intervals [m] of the path on which levels act, between breaks of mu; None:
    everywhere. ``factor`` is on the variation of the total stiffness about its mean. ``edges`` (S+1,) are the
    ends of the segments as parts of the period.
    """

    def __init__(
        self,
        system: LTVSystem,
        metric: FloatArray,
        misfit: FloatArray,
        factor: float,
        levels: Sequence[float],
        acts: Intervals | None = None,
    ) -> None:
        cycle = system.cycle
        g = system.cycle.geometry
        self.normal = system.per_load[0]
        self.arm = system.per_load[1:]
        self.metric = metric
        self.levels = levels
        self.parts = 1 + len(levels)
        self.factor = factor
        self.mean = cycle.mean_stiffness
        self.pitch = g.base_pitch
        self.offsets = cycle.offsets
        self.edges = cycle.breaks / cycle.period
        middle = cycle.offsets[:, None] + g.base_pitch * 0.5 * (self.edges[:-1] + self.edges[1:])
        self.touch = (middle >= cycle.start) & (middle <= cycle.end)
        e = cycle.elements
        #: Sign of the levels: that of the sliding, 0 where the levels do not act.
        self.side = np.sign(middle - g.L_XP) * _inside(middle, e.friction.breaks, acts)
        self.k, self.c, self.mu = (
            _Law.of(law, misfit, middle, self.touch, g.base_pitch)
            for law, misfit in ((e.stiffness, None), (e.damping, None), (e.friction, misfit))
        )
        self.place = _PLACE * (cycle.end + g.base_pitch)
        self.varied = factor != 1.0
        # Off the line of action a mesh on springs has no coordinate here.
        self.apart = system.per_apart if e.tilt is not None else np.zeros(self.normal.size)
        tilt = e.tilt if e.tilt is not None and self.apart.any() else e.friction.scaled(0.0)
        self.tilt = _Law.of(tilt, None, middle, self.touch, g.base_pitch)
        degree = max(self.k.degree, self.c.degree) + max(self.mu.degree + 1, self.tilt.degree)
        self.count = 1 + degree + (_FACTOR_DEGREE if self.varied else 0)
        self.rounding = (2 * degree + self.offsets.size + _ROUNDINGS) * _U
        # The mean is a sum over the pieces of the law, each to the moduli of its terms.
        rows = np.abs(e.stiffness.coefficients)
        width = np.diff(e.stiffness.breaks)
        moduli = (rows * width ** np.arange(rows.shape[0], 0, -1)[:, None]).sum() / g.base_pitch
        self.mean_error = (width.size + 60.0) * _U * float(moduli)
        rounding = 8.0 * _U * (1.0 + g.contact_ratio)
        if law_of(system.pair.friction).parts is not None:  # mu jumps where a search has found it
            rounding += _SEARCH * g.L_XY / g.base_pitch
        self.slips = _slips(cycle.break_phases, self.edges, rounding)

    def __call__(
        self, centre: FloatArray, half: FloatArray, segment: npt.NDArray[np.intp], nodes: FloatArray
    ) -> GainValues:
        """See `PolynomialGains`."""
        phases = centre[:, None] + half[:, None] * nodes
        groups = np.zeros((2 * self.parts, *phases.shape, self.normal.size))
        errors = np.zeros((groups.shape[0], centre.size))
        factors = [np.ones_like(phases)] * 2
        rounding_errors = self._fixed[0][:, segment]
        if self.varied:
            polynomials = self._factors(centre, half, segment, nodes)
            factors = list(polynomials.values)
            rounding_errors = rounding_errors * polynomials.largest
            for element, law in enumerate((self.k, self.c)):
                for part in range(self.parts):
                    reach = self._reach(law.size, self.mu.size, self.tilt.size, part)[:, segment].sum(axis=0)
                    errors[2 * part + element] = polynomials.errors[element] * reach
        for number in range(self.offsets.size):
            if not self.touch[number, segment].any():
                continue
            xi = self.offsets[number] + self.pitch * phases
            mu = self.mu(xi, number, segment)[..., None]
            arm = self.arm[0] + xi[..., None] * self.arm[1]
            sign = self.side[number, segment][:, None, None]
            rows = [np.broadcast_to(self.normal, (*xi.shape, self.normal.size))]
            if self.apart.any():
                rows[0] = rows[0] + self.tilt(xi, number, segment)[..., None] * self.apart
            if self.levels:
                rows += [(mu - sum(self.levels) * sign) * arm, *(s * sign * arm for s in self.levels[1:])]
            else:
                rows[0] = rows[0] + mu * arm
            for element, law in enumerate((self.k, self.c)):
                load = law(xi, number, segment) * factors[element]
                for part, row in enumerate(rows):
                    groups[2 * part + element] -= load[..., None] * row
        return GainValues(groups, errors, rounding_errors)

    def _row(self, part: int) -> _RowBounds:
        """Bounds on the row of one part of the gains, without tilt."""
        root = np.sqrt(self.metric)
        normal = float(np.linalg.norm(self.normal * root))
        arms = [float(np.linalg.norm(a * root)) for a in self.arm]
        arm = arms[0] + arms[1] * float(self.offsets[0] + self.pitch)
        if not self.levels:
            return _RowBounds(normal, arm, 0.0, arms[1])
        if part == 0:
            return _RowBounds(normal, 0.0, 0.0, 0.0)
        if part == 1:
            return _RowBounds(0.0, arm, sum(self.levels), arms[1])
        return _RowBounds(0.0, 0.0, self.levels[part - 1], arms[1])

    def _apart(self, part: int) -> float:
        """Bound on a row per unit of tilt."""
        return float(np.linalg.norm(self.apart * np.sqrt(self.metric))) if part == 0 else 0.0

    def _reach(self, size: FloatArray, mu: FloatArray, tilt: FloatArray, part: int) -> FloatArray:
        """Bound on the norm of the share of one pair in a gain, from bounds on load, |mu| and tilt."""
        row_bounds = self._row(part)
        level_arm = self._row(1).arm if self.levels and part else row_bounds.arm
        row = (
            row_bounds.normal + row_bounds.arm * mu + level_arm * row_bounds.level + self._apart(part) * tilt
        )
        return np.asarray(size * row, dtype=float)

    @property
    def jumps(self) -> FloatArray:
        """Bounds (G, S+1) on the integral over the phase of the errors by edges that are rounded."""
        return self._fixed[1]

    @cached_property
    def _fixed(self) -> tuple[FloatArray, FloatArray]:
        """Bounds (G, S) by rounding of values and of positions, and ``jumps``."""
        errors = np.zeros((2 * self.parts, self.edges.size - 1))
        jumps = np.zeros((2 * self.parts, self.edges.size))
        for element, law in enumerate((self.k, self.c)):
            for part in range(self.parts):
                arm = self._row(part).arm
                arm_slope = self._row(part).arm_slope
                reach = self._reach(law.size, self.mu.size, self.tilt.size, part)
                by_position = self._reach(law.slope, self.mu.size, self.tilt.size, part) + law.size * (
                    arm * self.mu.slope
                    + arm_slope * (self.mu.size + sum(self.levels))
                    + self._apart(part) * self.tilt.slope
                )
                misfit = law.size * arm * self.mu.misfit
                errors[2 * part + element] = (self.rounding * reach + self.place * by_position + misfit).sum(
                    axis=0
                )
                near = self._reach(law.near, self.mu.near, self.tilt.near, part).sum(axis=0)
                jumps[2 * part + element] = 2.0 * self.slips * self._largest_factor * near
        return errors, jumps

    @cached_property
    def _largest_factor(self) -> FloatArray:
        """Bound (S+1,) on 1, f and sqrt f of ``_factors`` on both sides of each edge."""
        if not self.varied:
            return np.ones(self.edges.size)
        start = self.edges[:-1]
        end = self.edges[1:]
        total, target = self._total(
            0.5 * (start + end), 0.5 * (end - start), np.arange(start.size), np.array([-1.0, 1.0])
        )
        with np.errstate(divide="ignore"):
            f = np.maximum(1.01 * np.abs(target) / total, 1.0)
        f[~(total > 0.0)] = np.inf
        largest = np.maximum(np.append(f[:, 0], f[-1, 1]), np.insert(f[:, 1], 0, f[0, 0]))
        largest[[0, -1]] = largest[[0, -1]].max()
        return np.asarray(largest)

    def _factors(
        self, centre: FloatArray, half: FloatArray, segment: npt.NDArray[np.intp], nodes: FloatArray
    ) -> _Factors:
        """Polynomials q and s for the factor f = (mean + factor (k - mean))/k on stiffnesses and for sqrt f.

        The bounds on the errors follow from |q - f| = |q k - mean - factor (k - mean)|/k and |s - sqrt f| =
        |s^2 - f|/(s + sqrt f). The sum of the Chebyshev coefficients of each residual bounds the residual.
        """
        fit_nodes, to_fit_series = to_series(_FACTOR_DEGREE + 1)
        check_nodes, to_check_series = to_series(2 * _FACTOR_DEGREE + 1 + self.k.degree)
        total, target = self._total(centre, half, segment, fit_nodes)
        f = target / total
        if not (np.isfinite(f).all() and (f > 0.0).all()):
            bad = centre[~(np.isfinite(f) & (f > 0.0)).all(axis=1)][0]
            raise NumericalError(f"the varied stiffness is not positive near {bad:g} of the period.")
        q = f @ to_fit_series.T
        s = np.sqrt(f) @ to_fit_series.T
        vander = np.polynomial.chebyshev.chebvander
        total, target = self._total(centre, half, segment, check_nodes)
        q_high = q @ vander(check_nodes, _FACTOR_DEGREE).T
        s_high = s @ vander(check_nodes, _FACTOR_DEGREE).T
        slack = series_rounding(check_nodes.size) + 4.0 * _FACTOR_DEGREE**2 * self.rounding

        def sup(values: FloatArray, scale: FloatArray) -> FloatArray:
            return np.asarray(np.abs(values @ to_check_series.T).sum(axis=1) + slack * scale)

        def least(values: FloatArray) -> FloatArray:
            series = values @ to_check_series.T
            return np.asarray(
                series[:, 0] - np.abs(series[:, 1:]).sum(axis=1) - slack * np.abs(values).max(axis=1)
            )

        q_size = np.abs(q).sum(axis=1)
        size = q_size * total.max(axis=1) + np.abs(target).max(axis=1)
        # Error of the total stiffness, rounding of the positions included, and its share in the residual.
        stiffness_error = (self.rounding * self.k.size + self.place * self.k.slope).sum(axis=0)[segment]
        residual_error = (q_size + abs(self.factor)) * stiffness_error + abs(
            1.0 - self.factor
        ) * self.mean_error
        with np.errstate(divide="ignore", invalid="ignore"):
            floor = least(total) - stiffness_error
            q_error = np.where(
                floor > 0.0, (sup(q_high * total - target, size) + residual_error) / floor, np.inf
            )
            floor = least(s_high)
            s_residual = sup(s_high**2 - q_high, np.abs(s).sum(axis=1) ** 2 + q_size) + q_error
            s_error = np.where(floor > 0.0, s_residual / floor, np.inf)
        s_error[~np.isfinite(q_error)] = np.inf
        polynomials_at_nodes = vander(nodes, _FACTOR_DEGREE)
        return _Factors(
            values=(q @ polynomials_at_nodes.T, s @ polynomials_at_nodes.T),
            errors=(q_error, s_error),
            largest=np.maximum(q_size, np.abs(s).sum(axis=1)) + 1.0,
        )

    def _total(
        self, centre: FloatArray, half: FloatArray, segment: npt.NDArray[np.intp], nodes: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Total stiffness k at the nodes of each piece, and mean + factor (k - mean)."""
        phases = centre[:, None] + half[:, None] * nodes
        total = np.zeros_like(phases)
        for i, offset in enumerate(self.offsets):
            total += self.k(offset + self.pitch * phases, i, segment)
        return total, self.mean + self.factor * (total - self.mean)


def own_tables(laws: ToothLaws) -> MeshTables:
    """Tables of laws with every break. Between the nodes of a table each law is exact to rounding."""
    return mesh_tables(laws, _LARGEST_STEP, 1, 0.5 - 0.5 * to_series(_NODES)[0])


class FrictionReach(NamedTuple):
    """Bounds on the norm of the gains w and wd of one tooth pair for a unit of |mu|, anywhere on the path."""

    w: float
    wd: float


def friction_reach(system: LTVSystem, metric: FloatArray) -> FrictionReach:
    """Bounds on the gains of a "mesh" form by the friction of one tooth pair. Norm: as in `Gains`."""
    cycle = system.cycle
    root = np.sqrt(metric)
    arms = [float(np.linalg.norm(arm * root)) for arm in system.per_load[1:]]
    arm = arms[0] + arms[1] * cycle.end

    def largest(law: PathFunction) -> float:
        powers = np.arange(len(law.coefficients))[::-1, None]
        return float((np.abs(law.coefficients) * np.diff(law.breaks) ** powers).sum(axis=0).max())

    load = largest(cycle.elements.stiffness), largest(cycle.elements.damping)
    return FrictionReach(load[0] * arm * (1.0 + 1e-9), load[1] * arm * (1.0 + 1e-9))


class OwnGains:
    """Gains of ``cycles`` mesh cycles from ``first`` on, as `fit_pieces` asks for them.

    The gains are feedback of the deflection and of the rate of the deflection. A phase counts mesh cycles
    from ``first``. ``edges`` are the phases at which a law ends, a pair begins or ends contact, the damper of
    a pair acts fully, or the tip of a pair leaves the line of action. Between two edges the polynomials
    through ``count`` values stand for the gains.
    """

    count = 12

    def __init__(self, tables: MeshTables, system: LTVSystem, first: int, cycles: int) -> None:
        self.tables = tables
        self.first = first
        self.forces = np.vstack([system.per_load[0], moments(system), system.per_load[1:], system.per_apart])
        starts = np.add.outer(np.arange(cycles), tables.edges[:-1])
        touches = kinks(tables, first, cycles, _LOOKS, _ROUNDS)
        self.edges = np.unique(np.concatenate([starts.ravel(), [cycles], touches]))

    def __call__(
        self, centre: FloatArray, half: FloatArray, segment: npt.NDArray[np.intp], nodes: FloatArray
    ) -> GainValues:
        """See `PolynomialGains`."""
        cycle = np.floor(centre)[:, None]
        ends = self.tables.edges
        step = np.searchsorted(ends[1:-1], centre[:, None] - cycle, side="right")
        place = (centre[:, None] + half[:, None] * nodes - cycle - ends[step]) / np.diff(ends)[step]
        form, _ = linear_form_at(self.tables, self.first, cycle, step, place)
        gains = []
        for part in (BY_APPROACH, BY_RATE):
            force = form.forces[..., part]
            normal = force["normal"]
            state = form.states
            by = [normal, normal * state["moment_pinion"], normal * state["moment_gear"]]
            by += [force["friction_force"], force["friction_moment"], force["separating"]]
            gains.append(-np.stack(by, axis=-1) @ self.forces)
        nothing = np.zeros((2, centre.size))
        return GainValues(np.stack(gains), nothing, nothing)


def _slips(breaks: FloatArray, edges: FloatArray, rounding: float) -> FloatArray:
    """Largest distance (S+1,) of each edge from the breaks that the edge replaces, in parts of the period."""
    breaks = np.concatenate([breaks, breaks[breaks < 1e-6] + 1.0, breaks[breaks > 1.0 - 1e-6] - 1.0])
    edge_after = np.clip(np.searchsorted(edges, breaks), 1, edges.size - 1)
    nearest = np.where(
        breaks - edges[edge_after - 1] < edges[edge_after] - breaks, edge_after - 1, edge_after
    )
    slips = np.zeros(edges.size)
    np.maximum.at(slips, nearest, np.abs(breaks - edges[nearest]))
    return slips + rounding
