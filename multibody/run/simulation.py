"""Simulate a gear pair with the multibody model and return the lumped model's variables.

Sources: docs/theory/multibody.md.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from lumped.arguments import whole_number
from lumped.model.solution import Initial
from lumped.model.steady import sample_times
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import FloatArray, Progress
from multibody.contact.machine import Supports
from multibody.run.drive import Drive
from multibody.run.integration import Segment
from multibody.run.records import Recorder
from multibody.run.setup import MOST_CYCLES, Fidelity, Setup, prepare

if TYPE_CHECKING:
    import xarray as xr

#: Runs over intervals (m + 1,) and calls with each one's number and segment; the state at the end.
Run = Callable[[FloatArray, Callable[[int, Segment], None]], tuple[FloatArray, FloatArray]]


def simulate(
    pair: AnyPair,
    cycles: int = 20,
    *,
    fidelity: Fidelity = "exact",
    samples_per_cycle: int = 256,
    initial: Initial | ArrayLike = "static",
    effects: Collection[str] | Mapping[str, bool] | None = None,
    rtol: float = 1e-8,
    friction_velocity: float | None = None,
    drive: Drive | None = None,
    supports: Supports = "springs",
    progress: Progress | None = None,
) -> xr.Dataset:
    """Transient of the gear pair as an exudyn multibody system.

    Parameters
    ----------
    pair : a validated gear pair
    cycles : mesh cycles, 1 to 100000
    fidelity : "linear" solves the lumped equations with exudyn's objects; "exact" lets rigid gears turn
        through finite angles with true involute contact
    samples_per_cycle : output times per mesh cycle; the grid ends on the last cycle's end
    initial : "static", "periodic" or 12 states, as for ``lumped.simulate``; on shafts no states, and the
        periodic motion is the model's own with the linear mesh
    effects : finite-motion effects that act at fidelity "exact", see ``multibody.EFFECTS``: a collection of
        names, or a mapping name -> bool in which names left out act; default all. At fidelity "linear" only
        "contact_loss", the lumped equations with teeth that push and never pull
    rtol : relative tolerance of the integration
    friction_velocity : sliding velocity over which friction changes its sign (tanh) [m/s]; 0 changes at
        once; None chooses, and the attribute ``friction_velocity_reason`` says why (see
        ``multibody.contact.reversal``)
    drive : motor, torque histories and run-up ramps, see ``multibody.Drive``; None keeps both torques
        constant
    supports : "springs" of ``pair.bearings``, or the elastic "shafts" of ``pair.shafts`` with their own
        bearings, motor and load
    progress : called with the finished fraction

    Returns
    -------
    xarray.Dataset over ``time`` [s] and ``pair`` with the variables, names and units of
    ``lumped.simulate``, and

        overlap : overlap of the driving flanks along the actual line of action [m]
        normal_load_back : normal load on the back sides of the teeth [N]
        bearing_force : on shafts, force of each bearing on its shaft over (bearing, direction, time) [N]

    Raises
    ------
    ParameterError : arguments out of range
    NumericalError : a force is not finite, or the step size collapses

    Notes
    -----
    At fidelity "exact" the friction law is read where the nominal motion slides as fast as the teeth actually
    do, with the sign of the actual sliding velocity, so friction never feeds energy in.
    """
    pair = load_gear_pair(pair)
    cycles = whole_number("cycles", cycles, 1, MOST_CYCLES)
    setup = prepare(pair, fidelity, initial, effects, rtol, friction_velocity, drive, supports)
    run, _, _ = record(setup, cycles, samples_per_cycle, progress=progress)
    return run


def record(
    setup: Setup,
    cycles: int,
    samples_per_cycle: int,
    *,
    first_cycle: int = 0,
    progress: Progress | None = None,
    run: Run | None = None,
) -> tuple[xr.Dataset, FloatArray, FloatArray]:
    """Run a model and keep the variables of the last cycles.

    Parameters
    ----------
    setup : model ready to run
    cycles : mesh cycles to run
    samples_per_cycle : output times per mesh cycle
    first_cycle : the first one whose variables are kept
    progress : called with the finished fraction
    run : visits the segments of a run that was made; None makes it

    Returns
    -------
    (dataset, q, v) : the variables, and the state (size,) at the end in the model's coordinates
    """
    period = setup.machine.period
    grid = sample_times(period, samples_per_cycle)
    time = np.concatenate([grid + j * period for j in range(first_cycle, cycles)] + [[cycles * period]])
    edges = setup.edges(cycles)
    recorder = Recorder(setup.model, time)

    def visit(number: int, segment: Segment) -> None:
        recorder.visit(segment, float(edges[number]), float(edges[number + 1]))
        if progress is not None:
            progress(float(edges[number + 1] / edges[-1]))

    q, v = (run or setup.run)(edges, visit)
    recorder.finish(q, v, float(edges[-1]))
    attributes = setup.attributes | {
        "cycles": cycles,
        "samples_per_cycle": samples_per_cycle,
        "force_evaluations": setup.model.budget.calls,
    }
    return recorder.dataset(attributes), q, v
