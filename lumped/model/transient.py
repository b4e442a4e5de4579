"""The motion of a pair in time from any start, of teeth that are alike or differ.

Sources: docs/theory/equations.md, eqs. 1 to 9; docs/theory/teeth.md, "Motion".
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from lumped.arguments import whole_number
from lumped.display.progress import reported_to, shows_progress
from lumped.errors import NumericalError
from lumped.labelling import provenance
from lumped.model.cycle_maps import CycleSteps, linear_motion, linear_steps, loads_of, stepped_run
from lumped.model.linear_or_unilateral import ContactArgument, MotionForm, motion_form
from lumped.model.momentary_load import MomentaryRuns, momentary_tables, steps_of
from lumped.model.neighbouring_motion import unilateral_or_followed_motion
from lumped.model.periodic_system import LTVSystem, Supports, supports_of
from lumped.model.propagation import step_maps
from lumped.model.revolution_motion import RevolutionMotion, Touch, plain_motion
from lumped.model.solution import Initial, initial_state, transient
from lumped.model.steady import periodic_solution, sample_times
from lumped.model.steady_state import check_printed
from lumped.model.tooth_laws import ToothLaws
from lumped.model.unilateral_motion import unilateral_motion
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import Progress, ProgressRequest

if TYPE_CHECKING:
    import xarray as xr

#: Mesh cycles between two calls of ``progress``.
_BLOCK = 200


@shows_progress("lumped model")
def simulate(
    pair: AnyPair,
    cycles: int = 20,
    *,
    contact: ContactArgument = "linear",
    supports: Supports | None = None,
    samples_per_cycle: int = 256,
    initial: Initial | ArrayLike = "static",
    as_printed: Collection[int] = (),
    progress: ProgressRequest = None,
) -> xr.Dataset:
    """Transient of the lumped model (docs/theory/equations.md, eqs. 1 to 9).

    With linear contact it is that of the linear time-varying model: the maps of the periodic motion take the
    state from output to output, steps end at every switch, and each is exact to about 1e-12. With unilateral
    contact teeth only push, and stiffness and dampers follow the momentary load. The torques keep the mean
    speed of the periodic motion.

    Parameters
    ----------
    pair : a validated gear pair
    cycles : mesh cycles, 1 to 100000
    contact : "linear" or "unilateral", as of ``steady_state``
    supports : "springs", the four of ``bearings``, or "shafts", the elastic ones of ``shafts``; by default
        the shafts of a pair that has them
    samples_per_cycle : output times per mesh cycle; the grid ends on the last cycle's end
    initial : "static" (at rest relative to nominal rotation, mesh wound up by the mean load), "periodic"
        (the periodic motion at t = 0) or 12 states in SI (on shafts, those of ``LTVSystem.state_names``)
    as_printed : equations out of 1, 2, 7, 9 whose printed sign is used; of linear contact and like teeth
    progress : True (a bar), False (none), None (a bar where the call takes over two seconds), or a function
        that is called with the finished fraction

    Returns
    -------
    xarray.Dataset over ``time`` [s] and ``pair``, see ``lumped.model.results.VARIABLES``; the attributes
    carry the balanced brake torque, ``contact``, ``supports`` and the provenance. Of teeth that differ also
    ``pinion_tooth`` and ``gear_tooth`` of each pair and time, counted from 1

    Raises
    ------
    ParameterError : arguments out of range
    NumericalError : no periodic motion exists, the motion overflows, or the speed is so low that a cycle
        would take minutes
    """
    progress = reported_to(progress)
    pair = load_gear_pair(pair)
    cycles = whole_number("cycles", cycles, 1, 100_000)
    samples = whole_number("samples_per_cycle", samples_per_cycle, 8, 65536)
    form = motion_form(pair, contact)
    supports = supports_of(pair, supports)
    check_printed(pair, contact, as_printed)
    if form is MotionForm.LINEAR_LIKE_TEETH:
        return transient(pair, cycles, samples, initial, as_printed, supports, progress)
    motion = _linear_run if form is MotionForm.LINEAR_OWN_TEETH else _unilateral_run
    start = initial if isinstance(initial, str) else "given"
    attributes = provenance(pair, cycles=cycles, samples_per_cycle=samples, initial=start, contact=contact)
    run_motion = motion(pair, cycles, samples, initial, supports, progress)
    if not np.isfinite(run_motion.states).all():
        raise NumericalError("The motion grows beyond all numbers: take fewer cycles, or a stable pair.")
    return plain_motion(run_motion, lambda: attributes, periodic=False).dataset


def _linear_run(
    pair: GearPair,
    cycles: int,
    samples: int,
    initial: Initial | ArrayLike,
    supports: Supports,
    progress: Progress | None,
) -> RevolutionMotion:
    """Linear motion of teeth that differ: the motion of like teeth, plus what the deviations change."""
    steady = linear_motion(pair, samples, supports)
    system = steady.system
    form = CycleSteps(pair, system, samples, linear_steps(system))
    like = form.with_like_teeth()
    weights = np.array([1.0, steady.pinion_torque - system.pinion_torque, steady.brake_torque])
    grid = sample_times(system.period, samples)
    maps = step_maps(system, np.stack([system.torque_pinion, system.torque_gear], axis=1), outputs=grid)
    own_end = like_end = twin_end = initial_state(system, initial, steady)
    states = []
    loads = []
    stiffness = []
    for cycle in range(cycles + 1):
        with_own, own_end = stepped_run(form, cycle, 1, own_end, weights)
        with_like, like_end = stepped_run(like, cycle, 1, like_end, weights)
        twin = maps.states(twin_end, weights)
        twin_end = twin[-1]
        states.append(with_own[0] + (twin[:-1] - with_like[0]))
        load, of_mesh = loads_of(form, steady.tables, cycle % steady.period, states[-1])
        loads.append(load)
        stiffness.append(of_mesh)
        if progress is not None:
            progress(min((cycle + 1) / cycles, 1.0))
    count = cycles * samples + 1
    return replace(
        steady,
        time=np.asarray(np.arange(count) * (system.period / samples), dtype=np.float64),
        states=np.concatenate(states)[:count],
        load=np.concatenate(loads, axis=1)[:, :count],
        stiffness=np.concatenate(stiffness)[:count],
    )


def _unilateral_run(
    pair: GearPair,
    cycles: int,
    samples: int,
    initial: Initial | ArrayLike,
    supports: Supports,
    progress: Progress | None,
) -> RevolutionMotion:
    """Motion by momentary load, under the torques of the periodic motion, else of the linear motion."""
    system = LTVSystem.of(pair.healthy, "full", supports=supports)
    periodic = isinstance(initial, str) and initial == "periodic"
    try:
        if periodic:
            steady = unilateral_or_followed_motion(pair, samples, supports)
        else:
            steady = unilateral_motion(pair, samples, supports, settles=False)
    except NumericalError:
        if periodic:
            raise
        steady = _linear_balance(pair, system, samples)
    torques = steady.pinion_torque * system.torque_pinion + steady.brake_torque * system.torque_gear
    state = initial_state(system, initial, steady)
    states = []
    loads = []
    runs = MomentaryRuns(pair, system, steady.tables)
    # One cycle more gives the end of the last one.
    for first in range(0, cycles + 1, _BLOCK):
        count = min(_BLOCK, cycles + 1 - first)
        block = runs.run(first, count, count, state, torques)
        states.append(block.states)
        loads.append(block.loads)
        state = block.end
        if progress is not None:
            progress(min((first + count) / cycles, 1.0))
    outputs = cycles * samples + 1
    return replace(
        steady,
        time=np.asarray(np.arange(outputs) * (system.period / samples), dtype=np.float64),
        states=np.concatenate(states)[:outputs],
        load=np.concatenate(loads, axis=1)[:, :outputs],
        origin=None,
    )


def _linear_balance(pair: GearPair, system: LTVSystem, samples: int) -> RevolutionMotion:
    """Return the linear motion of like teeth, whose torques are used where no unilateral motion is found."""
    linear = periodic_solution(system, np.zeros(1), estimate_error=False)
    tables = momentary_tables(ToothLaws(pair), system, 1.0 / steps_of(system), samples)
    return RevolutionMotion(
        pair=pair,
        system=system,
        tables=tables,
        touch=Touch.WINDOWS if tables.law.prescribed else Touch.MOMENTARY,
        time=linear.time,
        states=linear.states,
        load=np.zeros((tables.ahead.size, 1)),
        pinion_torque=linear.pinion_torque,
        brake_torque=linear.brake_torque,
        powers={},
        closure=np.nan,
        error=np.nan,
        spectral_radius=linear.spectral_radius,
    )
