"""Gauss-Legendre collocation for linear systems with smooth coefficients, blocks of steps at once."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from lumped.errors import NumericalError
from lumped.gauss_legendre import gauss_tableau
from lumped.model.kernels import FreeSteps, chained, merged, propagate, states_along
from lumped.model.mesh_cycle import is_edge
from lumped.model.periodic_system import LTVSystem
from lumped.typing import FloatArray, IntArray

#: Largest angle per step of the fastest frequency [rad]. With 4 stages (order 8) the local error constant is
#: (4!)^4 / (9 (8!)^3) = 5.6e-10, so a step of 0.5 rad errs by about 1e-12.
STEP_ANGLE = 0.5
STAGES = 4
#: Rounding of times over the period.
_ROUNDING = 1e-15
#: A step passes over joints of pieces that are no shorter than this share of it.
_SHORT_PIECE = 0.5
#: Bounds on memory: steps solved together where they are not kept, most numbers of maps that are kept (and so
#: many steps in any case), and most intervals where every step is one.
_BLOCK = 1024
_MOST_KEPT = 4_000_000
_MOST_INTERVALS = 16384
_ALWAYS_KEPT = 4096
#: Most steps of a mesh cycle: some ten seconds of work.
_MAX_STEPS = 1_000_000
#: Most stretches of the mesh cycle on which the stiffness is looked at, beside those between switches.
_MOST_LOOKS = 512
#: Columns of maps are filled up with zeros to a multiple of this, for a processor multiplies as many at once.
_TOGETHER = 8


@dataclass(frozen=True, eq=False)
class Steps:
    """Consecutive Gauss steps with s stages.

    Attributes
    ----------
    length : (k,) [s]
    maps : (k, n, n + columns) transition, then forced for each forcing, then columns of zeros
    moving : columns of the maps that move the teeth; steps of one length have all others alike
    inside : (k, moving, 2 s) maps of these to the dynamic transmission error at the stages, and to its rate
    teeth : (5, pairs, k, s) k, c, e, e' and ``closing`` there, as in ``PairState``
    """

    length: FloatArray
    maps: FloatArray
    moving: IntArray
    inside: FloatArray
    teeth: FloatArray


@dataclass(frozen=True, eq=False)
class StepMaps:
    """Affine maps x(end) = transition x(start) + forced of consecutive intervals, each of one or more steps.

    Attributes
    ----------
    edges : (steps + 1,) ends of the steps [s]
    times : (intervals + 1,) ends of the intervals, 0 and the period included [s]
    forcings : the own one and one per unit of each extra column
    maps : (intervals, n, n + columns) transition, then forced for each forcing, then columns of zeros
    steps : all steps in blocks; computed anew where they would fill the memory
    """

    edges: FloatArray
    times: FloatArray
    forcings: int
    maps: FloatArray
    steps: Callable[[], Iterable[Steps]]

    @cached_property
    def over_all(self) -> tuple[FloatArray, FloatArray]:
        """Map over all steps: transition (n, n) and forced (n, forcings)."""
        whole = chained(self.maps, np.zeros(self.maps.shape[0], dtype=np.int64))[0]
        n = whole.shape[0]
        return whole[:, :n], whole[:, n : n + self.forcings]

    def states(self, initial: FloatArray, weights: FloatArray) -> FloatArray:
        """States (intervals + 1, n) at ``times`` from x(0) and the weight (forcings,) of each."""
        found: FloatArray = states_along(self.maps, initial, weights)
        return found

    def energy_residual(self, initial: FloatArray, weights: FloatArray) -> float:
        """Mean power that losses take beyond what torques bring [W], of the periodic motion from x(0).

        The tooth forces N_i do the work N_i delta' on the bodies, with both gears' rigid rotation none; the
        dampers take f_i c_i (delta' - e_i')^2. The rest, f_i c_i (delta' - e_i')^2 - N_i delta', is of no
        energy: in the mean all other powers cancel.
        """
        state = initial
        work = 0.0
        for steps in self.steps():
            states = states_along(steps.maps, state, weights)
            given = np.column_stack([states[:-1], np.broadcast_to(weights, (len(states) - 1, weights.size))])
            dte, rate = np.split((given[:, None, steps.moving] @ steps.inside)[:, 0], 2, axis=1)
            k, c, e, e_rate, closing = steps.teeth
            power = (k * (dte - e)).sum(axis=0) * rate
            power += (c * (rate - e_rate) * (rate - closing * (rate - e_rate))).sum(axis=0)
            work += float(steps.length @ power @ gauss_tableau(power.shape[1])[1])
            state = states[-1]
        return -work / float(self.times[-1])


@lru_cache(maxsize=4)
def fastest_frequency(system: LTVSystem) -> float:
    """Bound on the fastest natural frequency over the cycle [rad/s].

    Frozen-time eigenvalues at the stiffest of three times on each polynomial piece; where pieces are many, on
    each stretch of several without a jump.
    """
    breaks = system.cycle.breaks
    marks = np.union1d(system.cycle.edges, breaks[:: -(-breaks.size // _MOST_LOOKS)])
    times = (marks[:-1] + np.multiply.outer([0.05, 0.5, 0.95], np.diff(marks))).ravel()
    segment = np.searchsorted(system.cycle.edges, times, side="right") - 1
    stiffness = np.abs(system.gain(times, segment).stiffness @ system.deflection)
    values = np.linalg.eigvals(system.matrices(times[[np.argmax(stiffness)]])[0])
    return float(np.abs(values).max()) * 1.1


def step_maps(
    system: LTVSystem,
    extra: FloatArray,
    *,
    outputs: FloatArray | None = None,
    every_step: bool = False,
    step_angle: float = STEP_ANGLE,
    stages: int = STAGES,
) -> StepMaps:
    """Propagate all unit states and forcings over one mesh cycle, step by step, aligned with the switches.

    Parameters
    ----------
    extra : (n, columns) constant forcings of the rates to carry beside the system's own
    outputs : times in [0, T_m] that end an interval [s]; by default there is one interval
    every_step : whether every step ends one, as long as there are not too many for the memory
    step_angle : largest angle of the fastest frequency per step [rad]
    """
    grid = _step_grid(system, np.empty(0) if outputs is None else outputs, every_step, step_angle)
    forcings = 1 + extra.shape[1]
    extra = padded(system, extra)
    first, which = distinct_lengths(system, grid.length)
    free = without_mesh(system, grid.length[first], extra, gauss_tableau(stages), system.directions)

    count = grid.length.size
    few = count <= max(_ALWAYS_KEPT, _MOST_KEPT // free.along[0].size)
    together = count if few else _BLOCK  # kept ones at once: maps need not be copied into one array

    def steps() -> Iterator[Steps]:
        for low in range(0, count, together):
            at = slice(low, low + together)
            yield _steps(system, grid.segment[at], grid.edges[:-1][at], grid.length[at], which[at], free)

    kept = list(steps()) if few else None
    parts = []
    groups = []
    low = 0
    for block in kept or steps():
        group = grid.interval[low : low + together]
        parts.append(merged(block.maps, group - group[0]))
        groups.append(np.unique(group))
        low += together
    maps = merged(np.concatenate(parts), np.concatenate(groups)) if len(parts) > 1 else parts[0]
    if not np.isfinite(maps).all():
        raise NumericalError("The mesh cycle cannot be integrated: check stiffness and inertia for extremes.")
    return StepMaps(grid.edges, grid.times, forcings, maps, steps if kept is None else lambda: kept)


def padded(system: LTVSystem, extra: FloatArray) -> FloatArray:
    """Forcings (n, columns) with columns of zeros behind, so that maps have the width of ``Steps.maps``."""
    return np.pad(extra, ((0, 0), (0, -(system.size + 1 + extra.shape[1]) % _TOGETHER)))


def _steps(
    system: LTVSystem,
    segment: IntArray,
    start: FloatArray,
    h: FloatArray,
    which: IntArray,
    free: FreeSteps,
) -> Steps:
    """Gauss steps of lengths h (k,) from the times ``start``; ``which`` of the lengths of ``free`` each has.

    In x = (z, v) with z' = v only the stage accelerations W_i are unknown. With the constant part (K, C) of
    A, the deflections delta = u.z and delta' = u.v at the stages and the mesh's feedback (g_k, g_c, g_0),

        W_i = K (z + h c_i v + h^2 (a a)_ij W_j) + C (v + h a_ij W_j) + f + n_i,
        n_i = g_k,i delta_i + g_c,i delta'_i + g_0,i.

    The part without n depends on h alone, and few lengths differ. W reaches n through the numbers p_i = u.W_i
    only, so each step solves s equations instead of s m, for all unit states and forcings together that move
    the teeth.
    """
    n, k, (_, stages) = system.size, h.size, free.reach.shape
    times = (start[:, None] + h[:, None] * gauss_tableau(stages)[2]).ravel()
    forces, pairs = system.mesh_forces(times, np.repeat(segment, stages))
    strength = forces.view(np.float64).reshape(k, 1, stages, 3, -1)
    units = np.eye(free.along.shape[1])
    # A column with an approach at its start, or an acceleration along it, or the forces without motion.
    moves = (free.along[:, :, :stages] != 0.0).any(axis=(0, 2))
    moves[:n] |= np.tile(system.deflection != 0.0, 2)
    moves[n] = True
    moving = np.flatnonzero(moves)
    columns = np.ascontiguousarray(np.broadcast_to(units[moving], (k, moving.size, units.shape[0])))
    propagated = propagate(columns, moving.size, strength, which[:, None], free, system.deflection)
    closing = np.ones_like(pairs.damping) if pairs.closing is None else pairs.closing
    teeth = np.stack([pairs.stiffness, pairs.damping, pairs.error, pairs.error_rate, closing])
    maps = np.ascontiguousarray(free.along[:, :, stages:].swapaxes(1, 2))[which]
    maps[:, :, moving] = propagated.ends.swapaxes(1, 2)
    return Steps(h, maps, moving, propagated.inside[:, 0], teeth.reshape(*teeth.shape[:2], k, stages))


def distinct_lengths(system: LTVSystem, h: FloatArray) -> tuple[IntArray, IntArray]:
    """Where each of few lengths of steps stands first, and which one every step has.

    Lengths that differ by the rounding of times are one: few are left where outputs are evenly spaced.
    """
    whole = np.round(h / (_ROUNDING * system.period))
    _, first, which = np.unique(whole, return_index=True, return_inverse=True)
    return first, which


def without_mesh(
    system: LTVSystem,
    h: FloatArray,
    extra: FloatArray,
    gauss: tuple[FloatArray, FloatArray, FloatArray],
    directions: FloatArray,
    *,
    with_rates: bool = False,
) -> FreeSteps:
    """What ``propagate`` needs of step lengths h (k,), of forces with the ``directions`` (forces, m).

    ``with_rates``: the rates of all coordinates at the stages are further rows.
    """
    a, b, c = gauss
    s = c.size
    m = system.size // 2
    k = h.size
    u = system.deflection
    stiffness = system.constant[m:, :m]
    damping = system.constant[m:, m:]
    forces = np.column_stack([system.torque_pinion * system.pinion_torque, extra])[m:]
    lengths = h
    h = h[:, None, None]
    left = np.eye(s * m) - h**2 * np.kron(a @ a, stiffness) - h * np.kron(a, damping)
    inverse = np.linalg.inv(left).reshape(k, s, m, s, m)
    right = np.zeros((k, s, m, 2 * m + forces.shape[1]))
    right[..., :m] = stiffness
    right[..., m : 2 * m] = h[..., None] * np.multiply.outer(c, stiffness) + damping
    right[..., 2 * m :] = forces
    columns = right.shape[-1]
    accelerations = (inverse.reshape(k, s * m, s * m) @ right.reshape(k, s * m, columns)).reshape(right.shape)
    to_end = np.stack([h[:, 0] ** 2 * (b @ a), h[:, 0] * b], axis=1)  # (k, 2, s)
    end = np.einsum("kds,ksmx->kdmx", to_end, accelerations).reshape(k, 2 * m, columns)
    end[:, :, : 2 * m] += np.eye(2 * m)
    end[:, :m, m : 2 * m] += h * np.eye(m)
    p = np.einsum("m,ksmx->ksx", u, accelerations)
    along = [p, end]
    moves = np.einsum("kdr,krmsi->ksidm", to_end, inverse)
    by_feedback = [np.einsum("m,krmsi->ksir", u, inverse), moves.reshape(k, s, m, 2 * m)]
    if with_rates:
        rates = h[..., None] * np.einsum("jr,krmx->kjmx", a, accelerations)
        rates[..., m : 2 * m] += np.eye(m)
        along.append(rates.reshape(k, s * m, columns))
        moves = h[..., None, None] * np.einsum("jr,krmsi->ksijm", a, inverse)
        by_feedback.append(moves.reshape(k, s, m, s * m))
    return FreeSteps(
        along=np.ascontiguousarray(np.concatenate(along, axis=1).swapaxes(1, 2)),
        by_force=np.ascontiguousarray(
            np.einsum("fm,ksmr->ksfr", directions, np.concatenate(by_feedback, axis=3))
        ),
        by_p=np.concatenate([h**2 * (a @ a), h * a], axis=1),
        reach=np.multiply.outer(lengths, c),
    )


@dataclass(frozen=True, eq=False)
class _StepGrid:
    """Steps of a mesh cycle: ends [s]; length [s], smooth segment and interval of each; interval ends [s]."""

    edges: FloatArray
    length: FloatArray
    segment: IntArray
    interval: IntArray
    times: FloatArray


def _step_grid(system: LTVSystem, outputs: FloatArray, every_step: bool, step_angle: float) -> _StepGrid:
    """Steps that end at outputs, wherever a law is not smooth, and wherever its pieces are short."""
    period = system.period
    switches = system.cycle.edges
    breaks = system.cycle.breaks
    marks = np.union1d(switches, system.cycle.bends)
    largest = step_angle / fastest_frequency(system)
    marks = _distinct(np.union1d(marks, outputs), system)
    # Joints join pieces of one smooth law, which varies fast where its pieces are short.
    pieces = np.diff(breaks)
    gaps = np.diff(marks)
    at = np.clip(np.searchsorted(marks, breaks[1:-1], side="right") - 1, 0, gaps.size - 1)
    short = np.minimum(pieces[:-1], pieces[1:]) < _SHORT_PIECE * np.minimum(gaps, largest)[at]
    marks = _distinct(np.union1d(marks, breaks[1:-1][short]), system)
    parts = np.maximum(1.0, np.ceil(np.diff(marks) / largest))
    if not parts.sum() <= _MAX_STEPS:
        raise NumericalError(
            f"A mesh cycle of {period:.3g} s takes {parts.sum():.3g} steps at the fastest vibration, more "
            f"than {_MAX_STEPS}: raise the speed, or lower stiffness or damping where they are extreme."
        )
    count = parts.astype(np.int64)
    first = np.concatenate([[0], np.cumsum(count)])
    length = np.repeat(np.diff(marks) / count, count)
    number = np.arange(first[-1]) - np.repeat(first[:-1], count)
    edges = np.append(np.repeat(marks[:-1], count) + length * number, period)
    if every_step:
        together = -(-length.size // _MOST_INTERVALS)
        ends = (number + 1) % together == 0
        ends[first[1:] - 1] = True
    else:
        ends = np.zeros(length.size, dtype=bool)
        ends[first[np.searchsorted(marks, outputs[outputs > 0.0] - 1e-13 * period)] - 1] = True
        ends[-1] = True
    return _StepGrid(
        edges=edges,
        length=length,
        segment=np.searchsorted(switches, edges[:-1], side="right") - 1,
        interval=np.cumsum(ends) - ends,
        times=np.append(0.0, edges[1:][ends]),
    )


def _distinct(marks: FloatArray, system: LTVSystem) -> FloatArray:
    """Increasing times of which those that differ by rounding are one; a switch stays where it is exactly."""
    close = np.flatnonzero(np.diff(marks) < 1e-13 * system.period)
    if close.size == 0:
        return marks
    fixed = is_edge(marks[close + 1], system.cycle.edges)
    return np.asarray(np.delete(marks, np.where(fixed, close, close + 1)), dtype=np.float64)
