"""Many runs side by side until they have settled, by the fourth-order Runge-Kutta method, compiled.

`settle` says to what a start leads, to about 1e-3. `floquet.orbits.long_run` then finds the exact motion.

Sources: docs/theory/orbits.md, "Settling".
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from floquet.orbits.branch import Family, Limits
from floquet.orbits.records import LinearPart, SystemTables
from floquet.orbits.system import ContactSystem
from lumped.compiler import compiled, inlined
from lumped.typing import BoolArray, FloatArray

#: Steps in a period of the fastest natural motion.
_STEPS = 48
#: A run settles for so many periods of the fastest natural motion, and for so many cycles at least.
_SETTLE = 150.0
_LEAST_CYCLES = 40
#: Cycles over which a settled run is observed.
_OBSERVED = 128
#: Runs side by side whose states stay in the cache of a core.
_SIDE_BY_SIDE = 64


@dataclass(frozen=True, eq=False)
class Settled:
    """The motions to which L runs have settled.

    Attributes
    ----------
    states : (L, 2m) at phase 0
    mean, rms, least, most : (L,) of the output over the last cycles; not finite where a run grows
    """

    states: FloatArray
    mean: FloatArray
    rms: FloatArray
    least: FloatArray
    most: FloatArray

    def grown(self, amplitude: float) -> BoolArray:
        """Which runs have grown beyond an amplitude about their mean."""
        return ~(np.maximum(self.most - self.mean, self.mean - self.least) <= amplitude)

    @property
    def sizes(self) -> FloatArray:
        """(L, 3) root mean square, smallest and largest value."""
        return np.stack([self.rms, self.least, self.most], axis=1)


def alike(one: FloatArray, other: FloatArray, tolerance: float = 0.1) -> bool:
    """Whether two motions have one size.

    A size is root mean square, smallest and largest value. The root mean squares may differ by a part of the
    larger one, the extremes by a part of the larger range.
    """
    allowed = tolerance * max(float(np.ptp(one[1:])), float(np.ptp(other[1:])))
    return bool(
        abs(one[0] - other[0]) <= tolerance * max(one[0], other[0])
        and np.abs(one[1:] - other[1:]).max() <= allowed
    )


class _Runs(NamedTuple):
    """L runs side by side: the last axis of all arrays, so that one instruction advances several runs.

    Attributes
    ----------
    z, v : (m, L) displacements and phase rates, changed in place
    period, parameter : (L,) T and p
    """

    z: FloatArray
    v: FloatArray
    period: FloatArray
    parameter: FloatArray


class _Outputs(NamedTuple):
    """Of the output of L runs over the observed cycles, (L,) each."""

    mean: FloatArray
    mean_square: FloatArray
    least: FloatArray
    most: FloatArray


class _SteppedLaws(NamedTuple):
    """Laws of I contacts at the start, middle and end of each of the S steps of a cycle.

    Attributes
    ----------
    step : (S,) lengths of the steps, as phases
    stiffness, damping, clearance, clearance_rate : (S, 3, I) k, c, e and de/dtau in the damper
    acceleration : (S, 3, I, m) a
    """

    step: FloatArray
    stiffness: FloatArray
    damping: FloatArray
    clearance: FloatArray
    clearance_rate: FloatArray
    acceleration: FloatArray


class _Stage(NamedTuple):
    """Memory for the stages of one step.

    Attributes
    ----------
    z, v : (m, L) state of the stage
    acceleration : (m, L) dv/dtau of the stage
    change_z, change_v : (m, L) weighted sums of the rates, the change over the step in the end
    penetration, penetration_rate : (L,) d and d' of one contact
    load : (L,) T^2 N of one contact
    """

    z: FloatArray
    v: FloatArray
    acceleration: FloatArray
    change_z: FloatArray
    change_v: FloatArray
    penetration: FloatArray
    penetration_rate: FloatArray
    load: FloatArray


def settle(
    family: Family, limits: Limits, starts: FloatArray, periods: FloatArray, parameters: FloatArray
) -> Settled:
    """Let runs from states (L, 2m) settle at periods (L,) with parameters (L,)."""
    states = np.array(starts, dtype=float)
    outputs = _Outputs(*(np.empty(periods.size) for _ in _Outputs._fields))
    order = np.argsort(periods, kind="stable")
    cuts = np.arange(_SIDE_BY_SIDE, order.size, _SIDE_BY_SIDE)
    if not family.constant:
        cuts = np.union1d(cuts, np.flatnonzero(np.diff(periods[order])) + 1)
    for runs in np.split(order, cuts):
        longest = float(periods[runs].max())
        system = family.at(longest)
        cycles = max(int(np.ceil(_SETTLE / (limits.frequency * longest))), _LEAST_CYCLES)
        state = np.ascontiguousarray(states[runs].T)
        z, v = np.split(state, 2)
        observed = _Outputs(*(np.zeros(runs.size) for _ in _Outputs._fields))
        _run(
            _Runs(z, v, np.ascontiguousarray(periods[runs]), np.ascontiguousarray(parameters[runs])),
            cycles,
            _stepped_laws(system, max(1.0, _STEPS * limits.frequency * longest)),
            system.tables,
            observed,
        )
        states[runs] = state.T
        for all_runs, these_runs in zip(outputs, observed, strict=True):
            all_runs[runs] = these_runs
    with np.errstate(invalid="ignore"):
        rms = np.sqrt(np.maximum(outputs.mean_square - outputs.mean**2, 0.0))
    return Settled(states, outputs.mean, rms, outputs.least, outputs.most)


def _stepped_laws(system: ContactSystem, steps: float) -> _SteppedLaws:
    """Laws at equal steps in each piece of the cycle, at least ``steps`` of them in a cycle."""
    tables = system.tables
    lengths = np.diff(tables.phases)
    counts = np.ceil(lengths * steps).astype(int)
    piece = np.repeat(np.arange(counts.size), counts)
    step = np.repeat(lengths / counts, counts)
    start = np.concatenate([np.arange(count) for count in counts]) * step
    phase = start[:, None] + step[:, None] * [0.0, 0.5, 1.0]

    def values(rows: FloatArray) -> FloatArray:
        """(P, ..., D + 1) -> (S, 3, ...)."""
        powers = phase[..., None] ** np.arange(rows.shape[-1])
        return np.ascontiguousarray(np.einsum("s...d,sjd->sj...", rows[piece], powers))

    laws = tables.laws
    present = tables.present[piece][:, None, :]
    coordinates = tables.direction.shape[1]
    return _SteppedLaws(
        step=step,
        stiffness=np.where(present, values(laws.stiffness), 0.0),
        damping=np.where(present, values(laws.damping), 0.0),
        clearance=values(laws.clearance),
        clearance_rate=values(laws.clearance_rate),
        acceleration=values(laws.acceleration[:, :, :coordinates]),
    )


@compiled(nogil=True, long_loops=True)
def _run(runs: _Runs, cycles: int, laws: _SteppedLaws, system: SystemTables, outputs: _Outputs) -> None:
    """Take all runs over some cycles and over the observed ones behind; the runs change in place."""
    work = _Stage(
        np.empty_like(runs.z),
        np.empty_like(runs.z),
        np.empty_like(runs.z),
        np.empty_like(runs.z),
        np.empty_like(runs.z),
        np.empty(runs.period.size),
        np.empty(runs.period.size),
        np.empty(runs.period.size),
    )
    outputs.least[:] = np.inf
    outputs.most[:] = -np.inf
    for cycle in range(cycles + _OBSERVED):
        for s in range(laws.step.size):
            step = laws.step[s]
            if cycle >= cycles:
                _observe(runs, system.output, step, outputs)
            for stage in range(4):
                if stage == 0:
                    _first_stage(runs, work)
                else:
                    _next_stage(runs, step if stage == 3 else 0.5 * step, work)
                _linear_acceleration(runs, system.linear, work)
                for i in range(system.direction.shape[0]):
                    place = (stage + 1) // 2  # start, middle, middle and end of the step
                    if laws.stiffness[s, place, i] == 0.0 and laws.damping[s, place, i] == 0.0:
                        continue
                    _penetration(laws, system.direction, s, place, i, work)
                    _load(runs, laws, s, place, i, work)
                    _contact_acceleration(laws, s, place, i, work)
                _add_rates(stage, step / 6.0 if stage in (0, 3) else step / 3.0, work)
            for p in range(runs.z.shape[0]):
                for q in range(runs.z.shape[1]):
                    runs.z[p, q] += work.change_z[p, q]
                    runs.v[p, q] += work.change_v[p, q]


@inlined
def _observe(runs: _Runs, output: FloatArray, step: float, outputs: _Outputs) -> None:
    """Add y = output . z at the start of a step to its means and extremes."""
    for q in range(runs.z.shape[1]):
        y = 0.0
        for p in range(runs.z.shape[0]):
            y += output[p] * runs.z[p, q]
        outputs.mean[q] += step * y / _OBSERVED
        outputs.mean_square[q] += step * y * y / _OBSERVED
        outputs.least[q] = min(outputs.least[q], y)
        outputs.most[q] = max(outputs.most[q], y)


@inlined
def _first_stage(runs: _Runs, work: _Stage) -> None:
    """State of the first stage: the state of the runs."""
    for p in range(runs.z.shape[0]):
        for q in range(runs.z.shape[1]):
            work.z[p, q] = runs.z[p, q]
            work.v[p, q] = runs.v[p, q]


@inlined
def _next_stage(runs: _Runs, ahead: float, work: _Stage) -> None:
    """State of a stage that is ``ahead`` of the start of the step, by the rates of the stage before."""
    for p in range(runs.z.shape[0]):
        for q in range(runs.z.shape[1]):
            rate = work.v[p, q]
            work.z[p, q] = runs.z[p, q] + ahead * rate
            work.v[p, q] = runs.v[p, q] + ahead * work.acceleration[p, q]


@inlined
def _linear_acceleration(runs: _Runs, linear: LinearPart, work: _Stage) -> None:
    """T^2 (F + p H - K z) - T C v."""
    T = runs.period
    for p in range(work.z.shape[0]):
        for q in range(T.size):
            force = linear.force[p] + runs.parameter[q] * linear.parameter_force[p]
            work.acceleration[p, q] = T[q] * T[q] * force
        for r in range(work.z.shape[0]):
            K = linear.stiffness[p, r]
            C = linear.damping[p, r]
            if K != 0.0 or C != 0.0:
                for q in range(T.size):
                    work.acceleration[p, q] -= T[q] * (T[q] * K * work.z[r, q] + C * work.v[r, q])


@inlined
def _penetration(laws: _SteppedLaws, direction: FloatArray, s: int, place: int, i: int, work: _Stage) -> None:
    """Penetration d = u . z - e and d' = u . v - e' of contact i."""
    for q in range(work.penetration.size):
        work.penetration[q] = -laws.clearance[s, place, i]
        work.penetration_rate[q] = -laws.clearance_rate[s, place, i]
    for p in range(work.z.shape[0]):
        for q in range(work.penetration.size):
            work.penetration[q] += direction[i, p] * work.z[p, q]
            work.penetration_rate[q] += direction[i, p] * work.v[p, q]


@inlined
def _load(runs: _Runs, laws: _SteppedLaws, s: int, place: int, i: int, work: _Stage) -> None:
    """T^2 N = T^2 k d + T c d' of contact i where d > 0 and N > 0, else 0."""
    T = runs.period
    k = laws.stiffness[s, place, i]
    c = laws.damping[s, place, i]
    for q in range(T.size):
        load = T[q] * (T[q] * k * work.penetration[q] + c * work.penetration_rate[q])
        work.load[q] = load if work.penetration[q] > 0.0 and load > 0.0 else 0.0


@inlined
def _contact_acceleration(laws: _SteppedLaws, s: int, place: int, i: int, work: _Stage) -> None:
    """Add a T^2 N of contact i."""
    for p in range(work.z.shape[0]):
        a = laws.acceleration[s, place, i, p]
        if a != 0.0:
            for q in range(work.load.size):
                work.acceleration[p, q] += a * work.load[q]


@inlined
def _add_rates(stage: int, weight: float, work: _Stage) -> None:
    """Add the rates of a stage to the change over the step."""
    for p in range(work.z.shape[0]):
        for q in range(work.z.shape[1]):
            if stage == 0:
                work.change_z[p, q] = weight * work.v[p, q]
                work.change_v[p, q] = weight * work.acceleration[p, q]
            else:
                work.change_z[p, q] += weight * work.v[p, q]
                work.change_v[p, q] += weight * work.acceleration[p, q]
