"""Gauss-Legendre collocation of the linear system: steps through a mesh cycle, computed in blocks."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache, partial

import numpy as np

from lumped.errors import NumericalError, SlowPairError
from lumped.gauss_legendre import ButcherTableau, gauss_tableau
from lumped.mesh.records import BY_APPROACH, BY_RATE
from lumped.model.kernels import (
    FreeEquations,
    FreeSteps,
    add_free_steps,
    chained,
    merged,
    propagate,
    states_along,
)
from lumped.model.mesh_cycle import is_edge
from lumped.model.periodic_system import LTVSystem
from lumped.model.speeds_together import MeshTimes, forces_together
from lumped.typing import ComplexArray, FloatArray, IntArray

#: Largest angle per step of the fastest frequency [rad]. With 4 stages (order 8) the local error constant is
#: (4!)^4 / (9 (8!)^3) = 5.6e-10, so a step of 0.5 rad errs by about 1e-12.
STEP_ANGLE = 0.5
STAGES = 4
#: Rounding error of times, over the period.
_ROUNDING = 1e-15
#: A step may pass over the joint of two pieces of a law if both pieces are longer than this share of the
#: step.
_SHORT_PIECE = 0.5
#: Bounds on memory: steps that are solved together where maps are not stored; most numbers of all stored
#: maps, and a number of steps that is stored in any case; most intervals where every step is an interval.
_BLOCK = 1024
_MOST_STORED = 4_000_000
_MOST_INTERVALS = 16384
_ALWAYS_STORED = 4096
#: Most steps of systems that are computed together: their numbers then stay in the cache of a processor.
_TOGETHER_STEPS = 1024
#: Most steps of a mesh cycle; so many take some ten seconds.
_MAX_STEPS = 1_000_000
#: Most stretches of the mesh cycle on which the stiffness is evaluated, beside those between switches.
_MOST_LOOKS = 512
#: The number of columns of a map is a multiple of this, because a processor multiplies so many at once.
_TOGETHER = 8


@dataclass(frozen=True, eq=False)
class Steps:
    """Consecutive Gauss steps with s stages.

    Attributes
    ----------
    length : (k,) [s]
    maps : (k, n, n + columns) transition, then forced for each forcing, then columns of zeros
    moving : indices of the columns that move the teeth; all steps of one length have the same other columns
    inside : (k, moving, 2 s) maps of the moving columns to the dynamic transmission error at the stages, then
        to its rate
    teeth : (5, pairs, k, s) stiffness, damping, error, error_rate and closing of ``PairState`` at the stages
    """

    length: FloatArray
    maps: FloatArray
    moving: IntArray
    inside: FloatArray
    teeth: FloatArray

    def part(self, low: int, high: int) -> Steps:
        """Return the steps from ``low`` to before ``high``."""
        at = slice(low, high)
        return Steps(self.length[at], self.maps[at], self.moving, self.inside[at], self.teeth[:, :, at])


@dataclass(frozen=True, eq=False)
class StepMaps:
    """Affine maps x(end) = transition x(start) + forced of consecutive intervals. An interval has some steps.

    Attributes
    ----------
    edges : (steps + 1,) ends of the steps [s]
    times : (intervals + 1,) ends of the intervals, 0 and the period included [s]
    forcings : number of forcings: the forcing of the system, and one for each extra column
    maps : (intervals, n, n + columns) transition, then forced for each forcing, then columns of zeros
    steps : returns all steps in blocks; they are computed again where storing them would fill the memory
    """

    edges: FloatArray
    times: FloatArray
    forcings: int
    maps: FloatArray
    steps: Callable[[], Iterable[Steps]]

    @cached_property
    def over_all(self) -> tuple[FloatArray, FloatArray]:
        """Map over all steps: transition (n, n) and forced (n, forcings)."""
        over_cycle = chained(self.maps, np.zeros(self.maps.shape[0], dtype=np.int64))[0]
        n = over_cycle.shape[0]
        return over_cycle[:, :n], over_cycle[:, n : n + self.forcings]

    def states(self, initial: FloatArray, weights: FloatArray) -> FloatArray:
        """States (intervals + 1, n) at ``times``, from x(0) (n,) and weights (forcings,)."""
        states: FloatArray = states_along(self.maps, initial, weights)
        return states

    def energy_residual(self, initial: FloatArray, weights: FloatArray) -> float:
        """Mean power by which the losses exceed what the torques bring [W], of the periodic motion from x(0).

        The tooth forces N_i do the work N_i delta' on the vibration and no work on the rigid rotation. The
        dampers take f_i c_i (delta' - e_i')^2. The difference f_i c_i (delta' - e_i')^2 - N_i delta' belongs
        to no energy. The means of all other powers cancel.
        """
        state = initial
        work = 0.0
        for steps in self.steps():
            states = states_along(steps.maps, state, weights)
            columns = np.column_stack(
                [states[:-1], np.broadcast_to(weights, (len(states) - 1, weights.size))]
            )
            dte, rate = np.split((columns[:, None, steps.moving] @ steps.inside)[:, 0], 2, axis=1)
            k, c, e, e_rate, closing = steps.teeth
            power = (k * (dte - e)).sum(axis=0) * rate
            power += (c * (rate - e_rate) * (rate - closing * (rate - e_rate))).sum(axis=0)
            work += float(steps.length @ power @ gauss_tableau(power.shape[1]).b)
            state = states[-1]
        return -work / float(self.times[-1])


@lru_cache(maxsize=4)
def fastest_frequency(system: LTVSystem) -> float:
    """Bound on the fastest natural frequency over the cycle [rad/s].

    Frozen-time eigenvalues at the stiffest of three times on each polynomial piece; where pieces are many, on
    each stretch of several without a jump.
    """
    return float(fastest_frequencies([system])[0])


def fastest_frequencies(systems: Sequence[LTVSystem]) -> FloatArray:
    """``fastest_frequency`` (systems,) of systems that go together, see ``goes_with`` [rad/s]."""
    system = systems[0]
    breaks = system.cycle.breaks
    marks = np.union1d(system.cycle.edges, breaks[:: -(-breaks.size // _MOST_LOOKS)])
    times = (marks[:-1] + np.multiply.outer([0.05, 0.5, 0.95], np.diff(marks))).ravel()
    segment = np.searchsorted(system.cycle.edges, times, side="right") - 1
    each = np.arange(len(systems))
    clock = np.array([one.period / system.period for one in systems])
    owner = np.repeat(each, times.size)
    at = MeshTimes(np.outer(clock, times).ravel(), np.tile(segment, each.size), owner)
    forces, _ = forces_together(systems, at)
    by_part = forces.view(np.float64).reshape(each.size, times.size, 3, -1) @ system.directions
    stiffest = np.argmax(np.abs(by_part[:, :, BY_APPROACH] @ system.deflection), axis=1)
    gain = by_part[each, stiffest]
    frozen = system.with_feedback(gain[:, BY_APPROACH], gain[:, BY_RATE])
    return np.asarray(np.abs(np.linalg.eigvals(frozen)).max(axis=1) * 1.1, dtype=np.float64)


def step_maps(
    system: LTVSystem,
    extra: FloatArray,
    *,
    outputs: FloatArray | None = None,
    every_step: bool = False,
    step_angle: float = STEP_ANGLE,
    stages: int = STAGES,
) -> StepMaps:
    """Propagate all unit states and forcings over one mesh cycle. Steps end at every switch.

    Parameters
    ----------
    extra : (n, columns) constant forcings in addition to the forcing of the system
    outputs : times in [0, T_m] that end an interval [s]; by default there is one interval
    every_step : whether every step is an interval; where these would fill the memory, a few steps are
    step_angle : largest angle of the fastest frequency per step [rad]
    """
    marks = _marks(system, np.empty(0) if outputs is None else outputs)
    grid = _step_grid(marks, 1.0, fastest_frequency(system), every_step, step_angle)
    maps = _maps_over([(system, grid)], extra, stages)[0]
    if isinstance(maps, NumericalError):
        raise maps
    return maps


def step_maps_together(
    systems: Sequence[LTVSystem], extra: FloatArray, outputs: FloatArray, step_angle: float = STEP_ANGLE
) -> Iterator[StepMaps | NumericalError]:
    """Yield the ``step_maps`` of systems that go together, or why there are none. Every step is an interval.

    Parameters
    ----------
    systems : systems that go together, see ``goes_with``
    extra, step_angle : as of ``step_maps``
    outputs : times of the first system that end an interval [s]; the others end one at the same positions
    """
    marks = _marks(systems[0], outputs)
    waiting: list[tuple[LTVSystem, _StepGrid]] = []
    for system, fastest in zip(systems, fastest_frequencies(systems).tolist(), strict=True):
        grid: _StepGrid | NumericalError
        try:
            grid = _step_grid(marks, system.period / systems[0].period, fastest, True, step_angle)
        except SlowPairError as error:
            grid = error
        steps = 0 if isinstance(grid, NumericalError) else grid.length.size
        full = steps + sum(one.length.size for _, one in waiting) > _TOGETHER_STEPS
        if waiting and (full or isinstance(grid, NumericalError)):
            yield from _maps_over(waiting, extra, STAGES)
            waiting = []
        if isinstance(grid, NumericalError):
            yield grid
        else:
            waiting.append((system, grid))
    if waiting:
        yield from _maps_over(waiting, extra, STAGES)


def _maps_over(
    members: Sequence[tuple[LTVSystem, _StepGrid]], extra: FloatArray, stages: int
) -> list[StepMaps | NumericalError]:
    """Maps of systems that go together, each over its grid. Those of several systems are stored."""
    systems = [system for system, _ in members]
    grids = [grid for _, grid in members]
    system = systems[0]
    extra_columns = padded(system, extra)
    owner = np.repeat(np.arange(len(grids)), [grid.length.size for grid in grids])
    length = np.concatenate([grid.length for grid in grids])
    start = np.concatenate([grid.edges[:-1] for grid in grids])
    segment = np.concatenate([grid.segment for grid in grids])
    distinct, length_of_step = _lengths_of(systems, grids)
    free = without_mesh(system, distinct, extra_columns, gauss_tableau(stages), system.directions)

    count = length.size
    few = len(grids) > 1 or count <= max(_ALWAYS_STORED, _MOST_STORED // free.along[0].size)
    together = count if few else _BLOCK  # stored steps in one block: their maps need not be copied

    def steps() -> Iterator[Steps]:
        for low in range(0, count, together):
            at = slice(low, low + together)
            places = MeshTimes(start[at], segment[at], owner[at])
            yield _steps(systems, places, length[at], length_of_step[at], free)

    if not few:
        return [_merged_steps(grids[0], 1 + extra.shape[1], steps)]
    (stored,) = steps()
    ends = np.cumsum([0, *(grid.length.size for grid in grids)]).tolist()
    of_grids = [[stored.part(low, high)] for low, high in itertools.pairwise(ends)]
    return [
        _merged_steps(grid, 1 + extra.shape[1], partial(iter, own))
        for grid, own in zip(grids, of_grids, strict=True)
    ]


def _lengths_of(systems: Sequence[LTVSystem], grids: Sequence[_StepGrid]) -> tuple[FloatArray, IntArray]:
    """Distinct lengths of the steps of all grids [s], and the index of the length of every step."""
    distinct: list[FloatArray] = []
    index: list[IntArray] = []
    count = 0
    for system, grid in zip(systems, grids, strict=True):
        first, length_of_step = distinct_lengths(system, grid.length)
        distinct.append(grid.length[first])
        index.append(length_of_step + count)
        count += first.size
    return np.concatenate(distinct), np.concatenate(index)


def _merged_steps(
    grid: _StepGrid, forcings: int, steps: Callable[[], Iterable[Steps]]
) -> StepMaps | NumericalError:
    """Maps over the intervals of a grid, from its steps in blocks."""
    parts = []
    groups = []
    low = 0
    for block in steps():
        group = grid.interval[low : low + block.length.size]
        parts.append(merged(block.maps, group - group[0]))
        groups.append(np.unique(group))
        low += block.length.size
    maps = merged(np.concatenate(parts), np.concatenate(groups)) if len(parts) > 1 else parts[0]
    if not np.isfinite(maps).all():
        text = "The mesh cycle cannot be integrated: check stiffness and inertia for extremes."
        return NumericalError(text)
    return StepMaps(grid.edges, grid.times, forcings, maps, steps)


def padded(system: LTVSystem, extra: FloatArray) -> FloatArray:
    """Return forcings (n, columns) with columns of zeros at the end, as ``Steps.maps`` has."""
    n, columns = extra.shape
    wide = np.zeros((n, columns + -(system.size + 1 + columns) % _TOGETHER))
    wide[:, :columns] = extra
    return wide


def _steps(
    systems: Sequence[LTVSystem],
    start: MeshTimes,
    h: FloatArray,
    length_of_step: IntArray,
    free: FreeSteps,
) -> Steps:
    """Gauss steps of lengths h (k,) from the times ``start``; ``length_of_step`` is their index in ``free``.

    In x = (z, v) with z' = v only the stage accelerations W_i are unknown. With the constant part (K, C) of
    A, the deflections delta = u.z and delta' = u.v at the stages and the mesh's feedback (g_k, g_c, g_0),

        W_i = K (z + h c_i v + h^2 (a a)_ij W_j) + C (v + h a_ij W_j) + f + n_i,
        n_i = g_k,i delta_i + g_c,i delta'_i + g_0,i.

    The part without n depends on h alone, and few lengths differ. n depends on W only through the s numbers
    p_i = u.W_i. So each step solves s equations instead of s m, for all unit states and forcings that move
    the teeth.
    """
    system = systems[0]
    n = system.size
    k = h.size
    stages = free.reach.shape[1]
    times = (start.time[:, None] + h[:, None] * gauss_tableau(stages).c).ravel()
    at_stages = MeshTimes(times, np.repeat(start.segment, stages), np.repeat(start.owner, stages))
    forces, pairs = forces_together(systems, at_stages)
    strength = forces.view(np.float64).reshape(k, 1, stages, 3, -1)
    units = np.eye(free.along.shape[1])
    # A column moves the teeth by its approach, by an acceleration along the approach, or by forces at rest.
    moves = (free.along[:, :, :stages] != 0.0).any(axis=(0, 2))
    moves[:n] |= np.tile(system.deflection != 0.0, 2)
    moves[n] = True
    moving = np.flatnonzero(moves)
    columns = np.ascontiguousarray(np.broadcast_to(units[moving], (k, moving.size, units.shape[0])))
    propagated = propagate(columns, moving.size, strength, length_of_step[:, None], free, system.deflection)
    closing = np.ones_like(pairs.damping) if pairs.closing is None else pairs.closing
    teeth = np.stack([pairs.stiffness, pairs.damping, pairs.error, pairs.error_rate, closing])
    maps = np.ascontiguousarray(free.along[:, :, stages:].swapaxes(1, 2))[length_of_step]
    maps[:, :, moving] = propagated.ends.swapaxes(1, 2)
    return Steps(h, maps, moving, propagated.inside[:, 0], teeth.reshape(*teeth.shape[:2], k, stages))


def distinct_lengths(system: LTVSystem, h: FloatArray) -> tuple[IntArray, IntArray]:
    """Return the step that first has each distinct length, and the index of the length of every step.

    Lengths that differ by the rounding of times count as one. Evenly spaced outputs leave few lengths.
    """
    rounded = np.round(h / (_ROUNDING * system.period))
    _, first, length_of_step = np.unique(rounded, return_index=True, return_inverse=True)
    return first, length_of_step


def without_mesh(
    system: LTVSystem,
    h: FloatArray,
    extra: FloatArray,
    gauss: ButcherTableau,
    directions: FloatArray,
    *,
    with_rates: bool = False,
) -> FreeSteps:
    """Gauss steps of the lengths h (k,) without the mesh, and the response to unit forces of the mesh.

    Parameters
    ----------
    h : (k,) step lengths [s]
    extra : (n, columns) forcings in addition to the forcing of the system
    gauss : tableau of the method
    directions : (forces, m) acceleration of the coordinates per unit of each force
    with_rates : whether the rates of all coordinates at the stages are further rows
    """
    m = system.size // 2
    stages = gauss.b.size
    forcings = np.column_stack([system.torque_pinion * system.pinion_torque, extra])
    equations = FreeEquations(
        constant=np.hstack([system.constant[m:], forcings[m:]]),
        deflection=np.ascontiguousarray(system.deflection),
        directions=np.ascontiguousarray(directions),
        nodes=gauss.c,
        to_rate=gauss.b,
        to_place=gauss.b @ gauss.a,
        between=gauss.a,
        with_rates=with_rates,
    )
    rows = stages + 2 * m + (stages * m if with_rates else 0)
    of_length = h[:, None, None]
    free = FreeSteps(
        along=np.zeros((h.size, equations.constant.shape[1], rows)),
        by_force=np.zeros((h.size, stages, len(directions), rows)),
        by_p=np.concatenate([of_length**2 * (gauss.a @ gauss.a), of_length * gauss.a], axis=1),
        reach=np.multiply.outer(h, gauss.c),
    )
    add_free_steps(h, _inverse_of_stages(system, h, stages), equations, free)
    return free


def _inverse_of_stages(system: LTVSystem, h: FloatArray, s: int) -> FloatArray:
    """Inverse of the equations W - h^2 (a a) K W - h a C W = f for the accelerations W at the stages.

    With the eigenvalues of a = V diag(lambda) V^-1, of the Gauss method with s stages, the equations fall
    apart into those of one stage,

        (1 - h^2 lambda^2 K - h lambda C) W = f.

    Only coordinates of one group are coupled: on springs each is a group of its own, on shafts all are one.
    The result (k, groups, s, coupled, s, coupled) has an inverse for each group.

    Source: J. C. Butcher, BIT 16 (1976) 237-240.
    """
    m = system.size // 2
    stiffness, damping = (np.asarray(part) for part in np.split(system.constant[m:], 2, axis=1))
    single = not any(np.count_nonzero(part - np.diag(part.diagonal())) for part in (stiffness, damping))
    eigenvalues, to_stages = _stages_apart(s)
    z: ComplexArray = np.multiply.outer(eigenvalues, h)[..., None]
    change: ComplexArray
    # The inverse less one, 1 / (1 - moved) - 1: exactly 0 where nothing acts on a coordinate, as on the
    # common rotation.
    if single:
        moved = z**2 * stiffness.diagonal() + z * damping.diagonal()
        change = moved / (1.0 - moved)
    else:
        moved = z[..., None] ** 2 * stiffness + z[..., None] * damping
        change = np.linalg.solve(np.eye(m) - moved, moved).astype(np.complex128)
    groups, coupled = (m, 1) if single else (1, m)
    # By einsum: the rounding of @ depends on how many lengths are computed together.
    inverse = np.einsum("pn,nx->px", to_stages, change.reshape(eigenvalues.size, -1)).real
    inverse = inverse.reshape(s, s, h.size, groups, coupled, coupled).transpose(2, 3, 0, 4, 1, 5)
    unit = np.eye(s * coupled).reshape(s, coupled, s, coupled)
    return np.asarray(inverse + unit, dtype=np.float64, order="C")


@cache
def _stages_apart(stages: int) -> tuple[ComplexArray, ComplexArray]:
    """Eigenvalues of a (s, s) of the Gauss method with positive or no imaginary part, (n,), and a matrix
    (s s, n).

    f(a), row by row, is the real part of the matrix times f(eigenvalues), where f is real on the real axis.
    A pair of conjugate eigenvalues has one column.
    """
    a = gauss_tableau(stages).a
    eigenvalues, vectors = np.linalg.eig(a)
    of_stages = vectors[:, None, :] * np.linalg.inv(vectors).T
    pairs = np.where(eigenvalues.imag > 0.0, 2.0, 1.0)
    upper = eigenvalues.imag >= 0.0
    return eigenvalues[upper], (pairs * of_stages).reshape(a.size, -1)[:, upper]


@dataclass(frozen=True, eq=False)
class _StepGrid:
    """Steps of a mesh cycle.

    Attributes
    ----------
    edges : (steps + 1,) ends of the steps [s]
    length : (steps,) [s]
    segment : (steps,) smooth segment of the mesh cycle in which the step lies
    interval : (steps,) interval of ``StepMaps`` to which the step belongs
    times : (intervals + 1,) ends of the intervals [s]
    """

    edges: FloatArray
    length: FloatArray
    segment: IntArray
    interval: IntArray
    times: FloatArray


@dataclass(frozen=True, eq=False)
class _Marks:
    """Times at which steps end in any case, and the joints of pieces between them.

    Attributes
    ----------
    system : the system, on whose clock all times are
    outputs : times that end an interval [s]
    times : (marks,) where a law is not smooth, and the outputs [s]
    joints : (joints,) inner breaks of the laws [s]
    shorter : (joints,) length of the shorter piece beside each joint [s]
    gap : (joints,) length of the gap between two times in which each joint lies [s]
    """

    system: LTVSystem
    outputs: FloatArray
    times: FloatArray
    joints: FloatArray
    shorter: FloatArray
    gap: FloatArray


def _marks(system: LTVSystem, outputs: FloatArray) -> _Marks:
    """Times at which steps end in any case."""
    breaks = system.cycle.breaks
    marks = np.union1d(system.cycle.edges, system.cycle.bends)
    marks = _distinct(np.union1d(marks, outputs), system)
    pieces = np.diff(breaks)
    gaps = np.diff(marks)
    gap_of_joint = np.clip(np.searchsorted(marks, breaks[1:-1], side="right") - 1, 0, gaps.size - 1)
    shorter = np.minimum(pieces[:-1], pieces[1:])
    return _Marks(system, outputs, marks, breaks[1:-1], shorter, gaps[gap_of_joint])


def _step_grid(at: _Marks, clock: float, fastest: float, every_step: bool, step_angle: float) -> _StepGrid:
    """Steps that end at the outputs, where a law is not smooth, and where the pieces of a law are short.

    ``clock`` is the period over that of ``at.system``, ``fastest`` the ``fastest_frequency``.
    """
    period = at.system.period
    switches = at.system.cycle.edges
    marks = at.times
    largest = step_angle / fastest / clock
    # A smooth law has short pieces where it varies fast: steps end at joints of short pieces.
    short = at.shorter < _SHORT_PIECE * np.minimum(at.gap, largest)
    if short.any():
        marks = _distinct(np.union1d(marks, at.joints[short]), at.system)
    gaps = np.diff(marks)
    parts = np.maximum(1.0, np.ceil(gaps / largest))
    if not parts.sum() <= _MAX_STEPS:
        raise SlowPairError(
            f"A mesh cycle of {clock * period:.3g} s takes {parts.sum():.3g} steps at the fastest vibration, "
            f"more than {_MAX_STEPS}: raise the speed, or lower stiffness or damping where they are extreme."
        )
    count = parts.astype(np.int64)
    first = np.concatenate([[0], np.cumsum(count)])
    length = np.repeat(gaps / count, count)
    number = np.arange(first[-1]) - np.repeat(first[:-1], count)
    edges = np.append(np.repeat(marks[:-1], count) + length * number, period)
    if every_step:
        together = -(-length.size // _MOST_INTERVALS)
        ends = (number + 1) % together == 0
        ends[first[1:] - 1] = True
    else:
        ends = np.zeros(length.size, dtype=bool)
        ends[first[np.searchsorted(marks, at.outputs[at.outputs > 0.0] - 1e-13 * period)] - 1] = True
        ends[-1] = True
    return _StepGrid(
        edges=edges * clock,
        length=length * clock,
        segment=np.searchsorted(switches, edges[:-1], side="right") - 1,
        interval=np.cumsum(ends) - ends,
        times=np.append(0.0, edges[1:][ends] * clock),
    )


def _distinct(marks: FloatArray, system: LTVSystem) -> FloatArray:
    """Merge increasing times that differ by rounding.

    Of a switch and another time the exact switch remains.
    """
    close = np.flatnonzero(np.diff(marks) < 1e-13 * system.period)
    if close.size == 0:
        return marks
    fixed = is_edge(marks[close + 1], system.cycle.edges)
    return np.asarray(np.delete(marks, np.where(fixed, close, close + 1)), dtype=np.float64)
