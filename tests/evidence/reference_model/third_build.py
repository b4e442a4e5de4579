"""The same machine built once more: bodies that turn through their own angle in exudyn's nodes.

The other builds hold deviations from the nominal rotation and add it as a function of time. Here exudyn
integrates the whole angles and speeds, so nothing of the model but the law of friction knows a nominal
motion. The relative tolerance would act on the many turns, so the absolute one controls alone; entries and
reversals of sliding are not foreseen.

Sources: docs/theory/multibody.md, "Three builds of one machine".
"""

from __future__ import annotations

import exudyn as exu
import numpy as np

from lumped.schema.pair import GearPair
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
#: Output times per mesh cycle.
_SAMPLES = 128


def third_build(pair: GearPair, cycles: int = 2, *, atol: float = 1e-9) -> tuple[float, float]:
    """Largest difference of the transmission error from the usual build, and its peak to peak [m].

    Both start from the lumped periodic motion; ``atol`` is that of the turning bodies, of angles, lengths and
    their rates alike (SI).
    """
    setup = prepare(pair, initial="periodic", rtol=_REFERENCE)
    usual, _, _ = record(setup, cycles, _SAMPLES)
    states = _run(setup, cycles, usual["time"].to_numpy(), atol)
    dte = usual["dte"].to_numpy()
    return float(np.abs(states @ setup.machine.overlap - dte).max()), float(np.ptp(dte))


def _run(setup: Setup, cycles: int, times: FloatArray, atol: float) -> FloatArray:
    """Integrate the turning bodies; returns the deviations (n, 6) at output times."""
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
        assert model.system.SolveDynamic(s), "exudyn's integrator stopped on turning bodies: raise atol"
    at, q, v = stored(model)
    keep = np.diff(at, prepend=-np.inf) > 0.0
    at, q, v = at[keep], q[keep] - at[keep, None] * speeds, v[keep] - speeds
    dense = Segment(at, q, v, accelerations(usual, at, q, v))
    return dense.at(np.minimum(times, at[-1]))[0]
