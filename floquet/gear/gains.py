"""The gains by which the mesh of a gear pair acts on each coordinate, as polynomials with proven errors.

The laws k, c and mu of a tooth pair are piecewise polynomials, so between two breaks of any law of any
pair the gains are polynomials of known degree: k (normal + mu (arm_0 + arm_1 xi)) and the like. Where teeth
differ, polynomials through computed values stand for them, in every mesh cycle between its own touches.

Sources: docs/theory/proven_bounds.md, "The gains".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from floquet.rank_one.piecewise import series_rounding, to_series
from lumped.errors import NumericalError
from lumped.friction.registry import law_of
from lumped.mesh.element import BY_APPROACH, BY_RATE
from lumped.mesh.places import kinks, linear_form_at
from lumped.mesh.tables import MeshTables
from lumped.model.periodic_system import LTVSystem
from lumped.model.swing import moments
from lumped.model.tooth_laws import ToothLaws, mesh_tables
from lumped.path_function import PathFunction
from lumped.typing import FloatArray

_U = 0.5 * float(np.finfo(np.float64).eps)
#: Roundings on the way to one value but for those of Horner's rule and of the sum over pairs: 10 of arm,
#: level, products and the factor on stiffness, 20 of the factor on mu by speed.
_ROUNDINGS = 30
#: The same of a position, relative to the largest one: offset, phase, product, sum, difference.
_PLACE = 16.0 * _U
#: Error of a switch that is a root, see `ContactPath.crossings`, relative to L_XY.
_SEARCH = 1e-14
#: Breaks closer than this part of a base pitch may be one segment's end.
_MERGED = 1e-12
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
        whole = terms.sum(axis=0)
        slope = (terms * powers[:, None]).sum(axis=0) / reach
        piece = np.clip(np.searchsorted(law.breaks, middle, side="right") - 1, 0, width.size - 1)
        inside = touch & (middle >= law.breaks[0]) & (middle <= law.breaks[-1])
        size = np.where(inside, whole[piece], 0.0)
        near = np.maximum(np.pad(size, ((0, 0), (1, 0))), np.pad(size, ((0, 0), (0, 1))))
        near[:, [0, -1]] = near[:, [0, -1]].max()
        # Where rounding has made one of several breaks, the pieces between them have no segment of their own.
        near = np.maximum(near, whole[width < _MERGED * pitch].max(initial=0.0))
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


class MeshGains:
    """Gains on the coordinates of a "mesh" form, with PROVEN errors, as `fit_pieces` asks for them.

    In this order: feedback of deflection and of its rate by normal loads (with their friction, unless there
    are ``levels``), the same by mu less the sum of the levels, and by each level but the first, zero.
    ``factor`` is on the variation of the total stiffness about its mean; ``edges`` (S+1,) are the ends of the
    segments as parts of the period.
    """

    def __init__(
        self,
        system: LTVSystem,
        metric: FloatArray,
        misfit: FloatArray,
        factor: float,
        levels: Sequence[float],
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
        self.side = np.sign(middle - g.L_XP)
        e = cycle.elements
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
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """See `PolynomialGains`."""
        phases = centre[:, None] + half[:, None] * nodes
        groups = np.zeros((2 * self.parts, *phases.shape, self.normal.size))
        errors = np.zeros((groups.shape[0], centre.size))
        factors = [np.ones_like(phases)] * 2
        fixed = self._fixed[0][:, segment]
        if self.varied:
            factors, off, most = self._factors(centre, half, segment, nodes)
            fixed = fixed * most
            for j, law in enumerate((self.k, self.c)):
                for p in range(self.parts):
                    reach = self._reach(law.size, self.mu.size, self.tilt.size, p)[:, segment].sum(axis=0)
                    errors[2 * p + j] = off[j] * reach
        for i in range(self.offsets.size):
            if not self.touch[i, segment].any():
                continue
            xi = self.offsets[i] + self.pitch * phases
            mu = self.mu(xi, i, segment)[..., None]
            arm = self.arm[0] + xi[..., None] * self.arm[1]
            sign = self.side[i, segment][:, None, None]
            rows = [np.broadcast_to(self.normal, (*xi.shape, self.normal.size))]
            if self.apart.any():
                rows[0] = rows[0] + self.tilt(xi, i, segment)[..., None] * self.apart
            if self.levels:
                rows += [(mu - sum(self.levels) * sign) * arm, *(s * sign * arm for s in self.levels[1:])]
            else:
                rows[0] = rows[0] + mu * arm
            for j, law in enumerate((self.k, self.c)):
                load = law(xi, i, segment) * factors[j]
                for p, row in enumerate(rows):
                    groups[2 * p + j] -= load[..., None] * row
        return groups, errors, fixed

    def _row(self, part: int) -> tuple[float, float, float, float]:
        """Bounds on a row without tilt: constant, per |mu|, of levels, and per unit of position and |mu|."""
        root = np.sqrt(self.metric)
        normal = float(np.linalg.norm(self.normal * root))
        arms = [float(np.linalg.norm(a * root)) for a in self.arm]
        arm = arms[0] + arms[1] * float(self.offsets[0] + self.pitch)
        if not self.levels:
            return normal, arm, 0.0, arms[1]
        if part == 0:
            return normal, 0.0, 0.0, 0.0
        return (
            (0.0, arm, sum(self.levels), arms[1]) if part == 1 else (0.0, 0.0, self.levels[part - 1], arms[1])
        )

    def _apart(self, part: int) -> float:
        """Bound on a row per unit of tilt."""
        return float(np.linalg.norm(self.apart * np.sqrt(self.metric))) if part == 0 else 0.0

    def _reach(self, size: FloatArray, mu: FloatArray, tilt: FloatArray, part: int) -> FloatArray:
        """Bound on the norm of what one pair adds to a gain, from bounds on its load, |mu| and tilt."""
        normal, arm, level, _ = self._row(part)
        full = self._row(1)[1] if self.levels and part else arm
        row = normal + arm * mu + full * level + self._apart(part) * tilt
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
        for j, law in enumerate((self.k, self.c)):
            for p in range(self.parts):
                _, arm, _, turn = self._row(p)
                reach = self._reach(law.size, self.mu.size, self.tilt.size, p)
                moved = self._reach(law.slope, self.mu.size, self.tilt.size, p) + law.size * (
                    arm * self.mu.slope
                    + turn * (self.mu.size + sum(self.levels))
                    + self._apart(p) * self.tilt.slope
                )
                misfit = law.size * arm * self.mu.misfit
                errors[2 * p + j] = (self.rounding * reach + self.place * moved + misfit).sum(axis=0)
                near = self._reach(law.near, self.mu.near, self.tilt.near, p).sum(axis=0)
                jumps[2 * p + j] = 2.0 * self.slips * self._largest_factor * near
        return errors, jumps

    @cached_property
    def _largest_factor(self) -> FloatArray:
        """Bound (S+1,) on 1, f and sqrt f of ``_factors`` on both sides of each edge."""
        if not self.varied:
            return np.ones(self.edges.size)
        low, high = self.edges[:-1], self.edges[1:]
        total, target = self._total(
            0.5 * (low + high), 0.5 * (high - low), np.arange(low.size), np.array([-1.0, 1.0])
        )
        with np.errstate(divide="ignore"):
            f = np.maximum(1.01 * np.abs(target) / total, 1.0)
        f[~(total > 0.0)] = np.inf
        both = np.maximum(np.append(f[:, 0], f[-1, 1]), np.insert(f[:, 1], 0, f[0, 0]))
        both[[0, -1]] = both[[0, -1]].max()
        return np.asarray(both)

    def _factors(
        self, centre: FloatArray, half: FloatArray, segment: npt.NDArray[np.intp], nodes: FloatArray
    ) -> tuple[list[FloatArray], list[FloatArray], FloatArray]:
        """The factor f = (mean + factor (k - mean))/k on stiffnesses and its root, by polynomials q and s.

        Bounds (k,) on the errors follow from |q - f| = |q k - mean - factor (k - mean)|/k and |s - sqrt f| =
        |s^2 - f|/(s + sqrt f), each residual bounded by the sum of its Chebyshev coefficients. The third
        result (k,) bounds 1, q and s.
        """
        low, into = to_series(_FACTOR_DEGREE + 1)
        high, onto = to_series(2 * _FACTOR_DEGREE + 1 + self.k.degree)
        total, target = self._total(centre, half, segment, low)
        f = target / total
        if not (np.isfinite(f).all() and (f > 0.0).all()):
            bad = centre[~(np.isfinite(f) & (f > 0.0)).all(axis=1)][0]
            raise NumericalError(f"the varied stiffness is not positive near {bad:g} of the period.")
        q, s = f @ into.T, np.sqrt(f) @ into.T
        vander = np.polynomial.chebyshev.chebvander
        total, target = self._total(centre, half, segment, high)
        q_high = q @ vander(high, _FACTOR_DEGREE).T
        s_high = s @ vander(high, _FACTOR_DEGREE).T
        slack = series_rounding(high.size) + 4.0 * _FACTOR_DEGREE**2 * self.rounding

        def sup(values: FloatArray, scale: FloatArray) -> FloatArray:
            return np.asarray(np.abs(values @ onto.T).sum(axis=1) + slack * scale)

        def least(values: FloatArray) -> FloatArray:
            series = values @ onto.T
            return np.asarray(
                series[:, 0] - np.abs(series[:, 1:]).sum(axis=1) - slack * np.abs(values).max(axis=1)
            )

        most = np.abs(q).sum(axis=1)
        size = most * total.max(axis=1) + np.abs(target).max(axis=1)
        # By how much the total is wrong, rounding of its positions included, and what that does.
        wrong = (self.rounding * self.k.size + self.place * self.k.slope).sum(axis=0)[segment]
        made = (most + abs(self.factor)) * wrong + abs(1.0 - self.factor) * self.mean_error
        with np.errstate(divide="ignore", invalid="ignore"):
            floor = least(total) - wrong
            off = np.where(floor > 0.0, (sup(q_high * total - target, size) + made) / floor, np.inf)
            floor = least(s_high)
            gap = sup(s_high**2 - q_high, np.abs(s).sum(axis=1) ** 2 + most) + off
            off_root = np.where(floor > 0.0, gap / floor, np.inf)
        off_root[~np.isfinite(off)] = np.inf
        at = vander(nodes, _FACTOR_DEGREE)
        return [q @ at.T, s @ at.T], [off, off_root], np.maximum(most, np.abs(s).sum(axis=1)) + 1.0

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
    """Tables of laws with every break that give each law to rounding between their nodes."""
    return mesh_tables(laws, _LARGEST_STEP, 1, 0.5 - 0.5 * to_series(_NODES)[0])


class OwnGains:
    """Gains of ``cycles`` mesh cycles from ``first`` on, as `fit_pieces` asks for them.

    They are feedback of deflection and of its rate. A phase counts mesh cycles from ``first``; ``edges`` are
    where a law ends and where in its own cycle a pair touches or leaves, its damper is full, or its tip
    leaves the line of action. Between them the polynomials through ``count`` values stand for the gains.
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
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
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
            by += [force["friction"], force["friction_moment"], force["separating"]]
            gains.append(-np.stack(by, axis=-1) @ self.forces)
        nothing = np.zeros((2, centre.size))
        return np.stack(gains), nothing, nothing


def _slips(raw: FloatArray, edges: FloatArray, rounding: float) -> FloatArray:
    """How far (S+1,) each edge may be from the breaks that it stands for, in parts of the period."""
    raw = np.concatenate([raw, raw[raw < 1e-6] + 1.0, raw[raw > 1.0 - 1e-6] - 1.0])
    after = np.clip(np.searchsorted(edges, raw), 1, edges.size - 1)
    nearest = np.where(raw - edges[after - 1] < edges[after] - raw, after - 1, after)
    slips = np.zeros(edges.size)
    np.maximum.at(slips, nearest, np.abs(raw - edges[nearest]))
    return slips + rounding
