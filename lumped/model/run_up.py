"""Run-up: the motion of the linear model while the speed rises or falls evenly.

Sources: docs/theory/equations.md, "Run-up".
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from lumped.arguments import real_number, real_numbers
from lumped.errors import NumericalError, refuse
from lumped.labelling import Variable, provenance
from lumped.model.periodic_system import Supports
from lumped.model.propagation import step_maps
from lumped.model.results import VARIABLES, labelled, response
from lumped.model.steady import balanced_start, sample_times
from lumped.model.sweep import systems_over_speed
from lumped.ranges import warned_once
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import LARGEST_SPEED
from lumped.typing import FloatArray, IntArray, Progress

if TYPE_CHECKING:
    import xarray as xr

#: Most output times.
_MOST = 3_000_000
#: Share by which the speed may change while the coefficients stay, where that is more than one mesh cycle.
_STEP = 1e-3


@warned_once()
def run_up(
    pair: AnyPair,
    speeds_rpm: tuple[float, float],
    seconds: float,
    *,
    samples_per_cycle: int = 32,
    supports: Supports = "springs",
    progress: Progress | None = None,
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
    samples_per_cycle : output times per mesh cycle, even over the angle: 32 resolve 16 mesh orders
    supports : as of `lumped.simulate`
    progress : called with the finished fraction

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
    pair = load_gear_pair(pair)
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
    j, (low, high) = np.arange(cycles + 1), frequencies.tolist()
    begins = 2.0 * j / (low + np.sqrt(np.maximum(low**2 + 2.0 * (high - low) / duration * j, 0.0)))
    groups = list(_groups(begins))
    hertz = ((last - first) / (begins[last] - begins[first]) for first, last in groups)
    pairs = (pair.with_({"operating.pinion_speed": float(60.0 / pair.pinion.teeth * f)}) for f in hertz)
    names = [name for name, (dimensions, *_) in VARIABLES.items() if dimensions == ("time",)]
    state: FloatArray | None = None
    times, parts = [], []
    for (first, last), system in zip(groups, systems_over_speed(pairs, supports), strict=True):
        grid = sample_times(system.period, samples_per_cycle)
        maps = step_maps(system, np.stack([system.torque_pinion, system.torque_gear], axis=1), outputs=grid)
        start, weights = balanced_start(system, *maps.over_all)
        state = start if state is None else state
        for cycle in range(last - first):
            states = maps.states(state, weights)
            state = states[-1]
            values = response(system, grid, states[:-1])
            parts.append(np.stack([values[name] for name in names]))
            times.append(begins[first] + cycle * system.period + grid)
        if progress is not None:
            progress(last / cycles)
    time, found = np.concatenate(times), np.concatenate(parts, axis=1)
    if not np.isfinite(found).all():
        raise NumericalError("The motion grows beyond all numbers: raise the damping, or avoid the speed.")
    speed = ends[0] + (ends[1] - ends[0]) * time / duration
    turns = np.arange(time.size) / (samples_per_cycle * pair.pinion.teeth)
    further: dict[str, Variable] = {
        "running_speed": ("time", speed, "rpm", "pinion speed"),
        "pinion_turns": ("time", turns, "1", "turns of the pinion"),
    }
    attributes = provenance(
        pair, speeds_rpm=tuple(ends.tolist()), seconds=duration, samples_per_cycle=samples_per_cycle
    ) | {"model": "lumped", "supports": supports, "turns": cycles / pair.pinion.teeth}
    return labelled(time, dict(zip(names, found, strict=True)), attributes, further)


def _groups(begins: FloatArray) -> Iterator[tuple[int, int]]:
    """First cycle of each group and that after it."""
    length: FloatArray = np.diff(begins)
    first = 0
    while first < length.size:
        apart: IntArray = np.flatnonzero(np.abs(length[first:] / length[first] - 1.0) > _STEP)
        last = first + max(int(apart[0]), 1) if apart.size else length.size
        yield first, last
        first = last
