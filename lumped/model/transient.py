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
from lumped.errors import NumericalError, refuse
from lumped.labelling import provenance
from lumped.model.momentary_load import run, settled_motion
from lumped.model.periodic_system import Supports
from lumped.model.revolution_motion import labelled_motion
from lumped.model.solution import Initial, initial_state, transient
from lumped.model.steady import periodic_solution
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import Progress

if TYPE_CHECKING:
    import xarray as xr


def simulate(
    pair: AnyPair,
    cycles: int = 20,
    *,
    samples_per_cycle: int = 256,
    initial: Initial | ArrayLike = "static",
    as_printed: Collection[int] = (),
    supports: Supports = "springs",
    progress: Progress | None = None,
) -> xr.Dataset:
    """Transient of the lumped model (docs/theory/equations.md, eqs. 1 to 9).

    Of like teeth it is that of the linear time-varying model: the maps of the periodic motion take the state
    from output to output, steps end at every switch, and each is exact to about 1e-12. Teeth that differ
    have unilateral contact, as in ``steady_state``, under torques that keep the mean speed over their period.

    Parameters
    ----------
    pair : a validated gear pair
    cycles : mesh cycles, 1 to 100000
    samples_per_cycle : output times per mesh cycle; the grid ends on the last cycle's end
    initial : "static" (at rest relative to nominal rotation, mesh wound up by the mean load), "periodic"
        (the periodic motion at t = 0) or 12 states in SI (on shafts, those of ``LTVSystem.state_names``)
    as_printed : equations out of 1, 2, 7, 9 whose printed sign is used; of like teeth alone
    supports : "springs", the four of ``bearings``, or "shafts", the elastic ones of ``shafts``
    progress : called with the finished fraction

    Returns
    -------
    xarray.Dataset over ``time`` [s] and ``pair``, see ``lumped.model.results.VARIABLES``; the attributes
    carry the balanced brake torque and the provenance. Of teeth that differ also ``pinion_tooth`` and
    ``gear_tooth`` of each pair and time, counted from 1

    Raises
    ------
    ParameterError : arguments out of range
    NumericalError : no periodic motion exists, the motion overflows, or the speed is so low that a cycle
        would take minutes
    """
    pair = load_gear_pair(pair)
    cycles = whole_number("cycles", cycles, 1, 100_000)
    if pair.healthy is pair:
        return transient(pair, cycles, samples_per_cycle, initial, as_printed, supports, progress)
    if as_printed:
        raise refuse("as_printed", list(as_printed), "() where teeth differ", "Use pair.healthy.")
    samples = whole_number("samples_per_cycle", samples_per_cycle, 8, 65536)
    steady = settled_motion(pair, samples, supports)
    system = steady.system
    twin = periodic_solution(system, np.zeros(1), estimate_error=False)
    twin = replace(twin, states=steady.states[:1], pinion_torque=steady.pinion_torque)
    torques = steady.pinion_torque * system.torque_pinion + steady.brake_torque * system.torque_gear
    start = initial_state(system, initial, twin)
    # One cycle more gives the end of the last one.
    states, load, _, _ = run(pair, steady.tables, system, 0, cycles + 1, cycles + 1, start, torques)
    count = cycles * samples + 1
    if not np.isfinite(states[:count]).all():
        raise NumericalError("The motion grows beyond all numbers: take fewer cycles, or a stable pair.")
    if progress is not None:
        progress(1.0)
    time = np.arange(count, dtype=np.float64) * (system.period / samples)
    found = replace(steady, time=time, states=states[:count], load=load[:, :count])
    given = initial if isinstance(initial, str) else "given"
    return labelled_motion(
        found, provenance(pair, cycles=cycles, samples_per_cycle=samples, initial=given), periodic=False
    )
