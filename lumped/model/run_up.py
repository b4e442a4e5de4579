"""Run-up: the motion while the speed rises or falls evenly, with linear or unilateral contact.

Sources: docs/theory/equations.md, "Run-up".
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import tee
from typing import TYPE_CHECKING

import numpy as np

from lumped.arguments import real_number, real_numbers
from lumped.display.progress import reported_to, shows_progress
from lumped.errors import NumericalError, refuse
from lumped.labelling import Variable, provenance
from lumped.mesh.tables import MeshTables
from lumped.model.cycle_maps import CycleSteps, linear_steps, loads_of, stepped_run
from lumped.model.linear_or_unilateral import ContactArgument, MotionForm, motion_form
from lumped.model.momentary_load import MomentaryRuns, momentary_tables, steps_of
from lumped.model.period_closure import balanced_start
from lumped.model.periodic_system import LTVSystem, Supports, supports_of
from lumped.model.propagation import step_maps
from lumped.model.results import VARIABLES, labelled, response
from lumped.model.revolution_motion import RevolutionMotion, Touch
from lumped.model.steady import periodic_solution, sample_times
from lumped.model.sweep import systems_over_speed
from lumped.model.tooth_laws import ToothLaws
from lumped.ranges import warned_once
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import LARGEST_SPEED, GearPair
from lumped.typing import FloatArray, IntArray, ProgressRequest

if TYPE_CHECKING:
    import xarray as xr

#: The variables of a result: those that depend on time alone.
_NAMES = [name for name, (dimensions, *_) in VARIABLES.items() if dimensions == ("time",)]
#: Most output times.
_MOST = 3_000_000
#: Share by which the speed may change while the coefficients stay; they stay for one mesh cycle at least.
_STEP = 1e-3


@shows_progress("run-up")
@warned_once()
def run_up(
    pair: AnyPair,
    speeds_rpm: tuple[float, float],
    seconds: float,
    *,
    contact: ContactArgument = "linear",
    supports: Supports | None = None,
    samples_per_cycle: int = 32,
    progress: ProgressRequest = None,
) -> xr.Dataset:
    """Motion while the speed goes evenly from one value to another (docs/theory/equations.md, "Run-up").

    The phase of the mesh is the integral of the speed. Coefficients stay over a mesh cycle, or over several
    while the speed changes by less than 0.1 %, each with its exact duration. Drive and brake supply the
    torques that accelerate the shafts, so the mean load of the mesh is that of the pair. The run begins on
    the periodic motion of the first speed.

    Parameters
    ----------
    pair : the gear pair; its speed is replaced
    speeds_rpm : pinion speed at the start and at the end [rpm]; a lower end is a run-down
    seconds : duration [s]; the run ends with the last whole mesh cycle
    contact, supports : as of `lumped.simulate`
    samples_per_cycle : output times per mesh cycle, even over the angle: 32 resolve 16 mesh orders
    progress : True (a bar), False (none), None (a bar where the call takes over two seconds), or a function
        that is called with the finished fraction

    Returns
    -------
    xarray.Dataset over ``time`` [s]: the variables of `lumped.simulate` that depend on time alone,
    ``running_speed`` [rpm] and ``pinion_turns``, the angle of the pinion in turns

    Raises
    ------
    ParameterError : arguments out of range, less than one mesh cycle, or more than 3 million
        output times
    NumericalError : a speed on the way has no periodic motion, or the motion overflows
    """
    progress = reported_to(progress)
    pair = load_gear_pair(pair)
    form = motion_form(pair, contact)
    supports = supports_of(pair, supports)
    advice = "Give the speed at the start and at the end: (500, 3000)."
    ends = real_numbers("speeds_rpm", speeds_rpm, 0.0, LARGEST_SPEED, above=True, unit="rpm", action=advice)
    if ends.size != 2:
        raise refuse("speeds_rpm", f"{ends.size} numbers", "two", advice)
    duration = real_number("seconds", seconds, 0.0, above=True, unit="s")
    sample_times(1.0, samples_per_cycle)
    frequencies = ends * pair.pinion.teeth / 60.0
    cycles = int(frequencies.mean() * duration * (1.0 + 1e-12))
    if not 1 <= cycles <= _MOST // samples_per_cycle:
        allowed = f"1 to {_MOST // samples_per_cycle} mesh cycles"
        action = "Change the duration or samples_per_cycle."
        raise refuse("seconds", f"{duration:g} s, {cycles} mesh cycles", allowed, action)
    # Cycle j begins where f_0 t + (f_1 - f_0) t^2/(2 T) = j: the root without cancellation at a small rate.
    j = np.arange(cycles + 1)
    low, high = frequencies.tolist()
    begins = 2.0 * j / (low + np.sqrt(np.maximum(low**2 + 2.0 * (high - low) / duration * j, 0.0)))
    groups = list(_groups(begins))
    hertz = ((last - first) / (begins[last] - begins[first]) for first, last in groups)
    pairs = (pair.with_({"operating.pinion_speed": float(60.0 / pair.pinion.teeth * f)}) for f in hertz)
    of_groups = _unilateral if form is MotionForm.UNILATERAL else _linear
    parts = of_groups(pairs, groups, supports, samples_per_cycle)
    times = []
    values = []
    for (first, last), (period, part) in zip(groups, parts, strict=True):
        times.append(
            begins[first] + np.arange((last - first) * samples_per_cycle) * period / samples_per_cycle
        )
        values.append(part)
        if progress is not None:
            progress(last / cycles)
    time = np.concatenate(times)
    variables = np.concatenate(values, axis=1)
    if not np.isfinite(variables).all():
        raise NumericalError("The motion grows beyond all numbers: raise the damping, or avoid the speed.")
    speed = ends[0] + (ends[1] - ends[0]) * time / duration
    turns = np.arange(time.size) / (samples_per_cycle * pair.pinion.teeth)
    further: dict[str, Variable] = {
        "running_speed": ("time", speed, "rpm", "pinion speed"),
        "pinion_turns": ("time", turns, "1", "turns of the pinion"),
    }
    attributes = provenance(
        pair, speeds_rpm=tuple(ends.tolist()), seconds=duration, samples_per_cycle=samples_per_cycle
    ) | {
        "model": "lumped",
        "contact": contact,
        "supports": supports,
        "teeth": "alike" if pair.healthy is pair else "as given",
        "turns": cycles / pair.pinion.teeth,
    }
    return labelled(time, dict(zip(_NAMES, variables, strict=True)), attributes, further)


def _of_time(values: Mapping[str, FloatArray]) -> FloatArray:
    """Return the variables that depend on time alone, (names, k)."""
    return np.stack([values[name] for name in _NAMES])


def _linear(
    pairs: Iterable[GearPair], groups: Sequence[tuple[int, int]], supports: Supports, samples: int
) -> Iterator[tuple[float, FloatArray]]:
    """Period of a mesh cycle [s] and variables of every group of cycles, by maps.

    Where teeth differ, the difference of two runs by long steps is added, see `lumped.model.cycle_maps`.
    """
    ends: dict[str, FloatArray] = {}  # states at the end of the last group, of three runs
    own_pairs, alike = tee(pairs)
    systems = systems_over_speed((pair.healthy for pair in alike), supports)
    for (first, last), pair, system in zip(groups, own_pairs, systems, strict=True):
        grid = sample_times(system.period, samples)
        count = last - first
        maps = step_maps(system, np.stack([system.torque_pinion, system.torque_gear], axis=1), outputs=grid)
        start, weights = balanced_start(system, *maps.over_all)
        ends = ends or {"short steps": start, "own teeth": start, "like teeth": start}
        of_cycles = []
        for _ in range(count):
            states = maps.states(ends["short steps"], weights)
            ends["short steps"] = states[-1]
            of_cycles.append(states[:-1])
        if pair.healthy is pair:
            yield (
                system.period,
                np.concatenate([_of_time(response(system, grid, one)) for one in of_cycles], axis=1),
            )
            continue
        form = CycleSteps(pair, system, samples, linear_steps(system), range(first, last))
        with_own, ends["own teeth"] = stepped_run(form, first, count, ends["own teeth"], weights)
        with_like, ends["like teeth"] = stepped_run(
            form.with_like_teeth(), first, count, ends["like teeth"], weights
        )
        states_of_group = np.concatenate(of_cycles) + (with_own - with_like).reshape(-1, system.size)
        tables = form.tables_of_outputs
        load, stiffness = loads_of(form, tables, first, states_of_group)
        motion = _motion_of_group(pair, system, tables, first, states_of_group, load)
        values = response(system, motion.time, states_of_group, load, motion.pairs) | {
            "mesh_stiffness": stiffness
        }
        yield system.period, _of_time(values)


def _unilateral(
    pairs: Iterable[GearPair], groups: Sequence[tuple[int, int]], supports: Supports, samples: int
) -> Iterator[tuple[float, FloatArray]]:
    """Period of a mesh cycle [s] and variables of every group of cycles, by momentary load.

    The torques are those of the linear motion of like teeth. The brake also corrects the rate of the common
    rotation that the previous group left.
    """
    state: FloatArray | None = None
    missing = 0.0
    for (first, last), pair in zip(groups, pairs, strict=True):
        system = LTVSystem.of(pair.healthy, "full", supports=supports)
        linear = periodic_solution(system, np.zeros(1), estimate_error=False)
        state = linear.states[0] if state is None else state
        weights = system.supports.common_weights
        tables = momentary_tables(ToothLaws(pair), system, 1.0 / steps_of(system), samples)
        m = weights.size
        duration = (last - first) * system.period
        per_torque = float(weights @ system.torque_gear[m:])
        rate = float(weights @ state[m:])
        brake = linear.brake_torque + (missing - rate / duration) / per_torque
        torques = linear.pinion_torque * system.torque_pinion + brake * system.torque_gear
        runs = MomentaryRuns(pair, system, tables)
        run_of_group = runs.run(first, last - first, last - first, state, torques)
        state = run_of_group.end
        # The rate that the torque did not bring to zero is what the next group has to supply.
        missing -= float(weights @ state[m:]) / duration
        motion = _motion_of_group(pair, system, tables, first, run_of_group.states, run_of_group.loads)
        yield system.period, _of_time(response(system, motion.time, motion.states, motion.load, motion.pairs))


def _motion_of_group(
    pair: GearPair,
    system: LTVSystem,
    tables: MeshTables,
    first: int,
    states: FloatArray,
    load: FloatArray,
) -> RevolutionMotion:
    """Return the motion of one group of mesh cycles, with the times of its own speed."""
    samples = int(tables.outputs.sum())
    return RevolutionMotion(
        pair=pair,
        system=system,
        tables=tables,
        touch=Touch.MOMENTARY,
        time=np.asarray((first + np.arange(len(states)) / samples) * system.period, dtype=np.float64),
        states=states,
        load=load,
        pinion_torque=np.nan,
        brake_torque=np.nan,
        powers={},
        closure=np.nan,
        error=np.nan,
        spectral_radius=np.nan,
        first=first,
    )


def _groups(begins: FloatArray) -> Iterator[tuple[int, int]]:
    """Yield the first cycle of each group, and the cycle after its last one."""
    length: FloatArray = np.diff(begins)
    first = 0
    while first < length.size:
        apart: IntArray = np.flatnonzero(np.abs(length[first:] / length[first] - 1.0) > _STEP)
        last = first + max(int(apart[0]), 1) if apart.size else length.size
        yield first, last
        first = last
