"""The same machine built once more: bodies that turn through their own angle in exudyn's nodes.

The other builds hold deviations from the nominal rotation and add it as a function of time. Here exudyn
integrates the whole angles and speeds, so nothing of the model but the law of friction knows a nominal
motion. The relative tolerance would act on the many turns, so the absolute one controls alone; entries and
reversals of sliding are not foreseen.

Sources: docs/theory/multibody.md, "Three builds of one machine".
"""

from __future__ import annotations

from dataclasses import dataclass

import exudyn as exu
import numpy as np

from lumped.arguments import real_number, whole_number
from lumped.errors import NumericalError
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import FloatArray
from multibody.contact import kernels as kn
from multibody.run.integration import Segment, quiet, settings
from multibody.run.model import accelerations, build, stored
from multibody.run.setup import Setup, prepare
from multibody.run.simulation import record

#: Relative tolerance of the turning bodies: none. That of the run they are compared with.
_NONE, _REFERENCE = 1e-16, 1e-9
#: First step over the mesh cycle.
_FIRST_STEP = 1e-4
#: Output times per mesh cycle, and most mesh cycles.
_SAMPLES, _MOST_CYCLES = 128, 1000


@dataclass(frozen=True)
class TurningBuild:
    """Bodies that turn, beside the usual build in deviations.

    Attributes
    ----------
    cycles : mesh cycles of both runs
    turned : angle of the pinion at the end [rad]
    difference : largest difference of the transmission error [m]
    span : peak to peak of the transmission error [m]
    evaluations : what it costs, force evaluations per mesh cycle: turning, usual
    """

    cycles: int
    turned: float
    difference: float
    span: float
    evaluations: tuple[float, float]


def turning_build(
    pair: AnyPair,
    cycles: int = 5,
    *,
    atol: float = 1e-9,
) -> TurningBuild:
    """Run the exact model with bodies that turn in exudyn's nodes, and compare it with the usual build.

    Both start from the lumped periodic motion; the usual build runs at rtol 1e-9.

    Parameters
    ----------
    pair : a validated gear pair
    cycles : mesh cycles, 1 to 1000
    atol : absolute tolerance of the turning bodies, of angles, lengths and their rates alike (SI)

    Raises
    ------
    ParameterError : arguments out of range
    NumericalError : a run fails
    """
    pair = load_gear_pair(pair)
    cycles = whole_number("cycles", cycles, 1, _MOST_CYCLES)
    atol = real_number("atol", atol, 1e-12, 1e-3)
    setup = prepare(pair, initial="periodic", rtol=_REFERENCE)
    p = setup.machine.parameters
    usual, _, _ = record(setup, cycles, _SAMPLES)
    states, calls = _run(setup, cycles, usual["time"].to_numpy(), atol)
    dte = usual["dte"].to_numpy()
    return TurningBuild(
        cycles=cycles,
        turned=float(p[kn.OMEGA_P]) * cycles * setup.machine.period,
        difference=float(np.abs(states @ setup.machine.overlap - dte).max()),
        span=float(np.ptp(dte)),
        evaluations=(calls / cycles, setup.model.budget.calls / cycles),
    )


def _run(setup: Setup, cycles: int, times: FloatArray, atol: float) -> tuple[FloatArray, int]:
    """Integrate the turning bodies; returns the deviations (n, 6) at output times, and force evaluations."""
    usual, period = setup.model, setup.machine.period
    p = setup.machine.parameters
    speeds = np.array([0.0, 0.0, -p[kn.OMEGA_P], 0.0, 0.0, p[kn.OMEGA_G]])
    model = build(setup.machine, usual.flags, cycles * usual.budget.limit, turning=True)
    s = settings(_NONE, atol, period)
    s.timeIntegration.startTime, s.timeIntegration.endTime = 0.0, cycles * period
    s.timeIntegration.initialStepSize = _FIRST_STEP * period
    initial = exu.ConfigurationType.Initial
    model.system.systemData.SetODE2Coordinates(setup.q.tolist(), configuration=initial)
    model.system.systemData.SetODE2Coordinates_t((setup.v + speeds).tolist(), configuration=initial)
    with quiet():
        if not model.system.SolveDynamic(s):
            raise NumericalError("exudyn's integrator stopped on turning bodies; raise atol.")
    at, q, v = stored(model)
    keep = np.diff(at, prepend=-np.inf) > 0.0
    at, q, v = at[keep], q[keep] - at[keep, None] * speeds, v[keep] - speeds
    dense = Segment(at, q, v, accelerations(usual, at, q, v))
    return dense.at(np.minimum(times, at[-1]))[0], model.budget.calls
