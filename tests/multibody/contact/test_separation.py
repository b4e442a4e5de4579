"""Do teeth separate and strike back as a pair with backlash does, and what where sliding changes its sign?"""

from dataclasses import replace

import numpy as np
import pytest

import lumped
import multibody
from multibody.run.setup import prepare
from multibody.run.simulation import record

#: The classic 50/50 pair at low torque and light damping, without friction.
PAIR = lumped.load_gear_pair("kahraman_blankenship_50_50").with_(
    mesh__contact="prescribed", friction__law="none", operating__pinion_torque=50, mesh__damping_ratio=0.02
)


@pytest.mark.slow
def test_primary_resonance_jumps():
    """Softening by separation: near resonance a rising and a falling sweep see different motions.

    At 5000 rpm a change of the torque by 1e-13 decides whether the falling sweep stays on its motion.
    """
    speeds = np.array([5250.0, 5500, 5750, 6000])
    up = multibody.speed_sweep(PAIR, speeds)
    down = multibody.speed_sweep(PAIR, speeds[::-1]).isel(speed=slice(None, None, -1))
    ltv = lumped.speed_sweep(PAIR, speeds)
    rms = {name: run["dte_rms"].to_numpy() for name, run in (("up", up), ("down", down), ("ltv", ltv))}
    flagged = ltv["normal_load_min"].to_numpy() < 0
    np.testing.assert_array_equal(flagged, [False, False, True, True])
    # Below the flag two motions exist: the falling sweep stays on the one with impacts, several times as
    # large.
    assert np.all(rms["down"][~flagged] > 2.0 * rms["up"][~flagged])
    assert np.all(down["separated"] > 0.2)
    # The rising sweep stays on the lower one, which is the LTV motion, until the LTV model's own validity
    # flag (a negative load) says that teeth separate, and separates from there on.
    np.testing.assert_allclose(rms["up"][~flagged], rms["ltv"][~flagged], rtol=0.01)
    np.testing.assert_array_equal(up["separated"].to_numpy() > 0, flagged)
    # There the two sweeps meet again; what is left is the beat of a lightly damped transient.
    np.testing.assert_allclose(rms["up"][flagged], rms["down"][flagged], rtol=0.02)


def test_loads_never_pull_and_back_sides_strike():
    """Reversed torques drive the pair across its backlash, and torques as before drive it back."""
    pair = PAIR.with_(operating__pinion_speed=3000)
    setup = prepare(pair)
    brake = setup.machine.torque_gear
    static = 50 / lumped.geometry(pair).base_radius_pinion
    _, q, v = record(setup, 5, 64)
    there, q, v = record(replace(setup, q=q, v=v).with_torques(-50.0, -brake), 10, 256)
    again, _, _ = record(replace(setup, q=q, v=v), 25, 256)
    backlash = lumped.geometry(pair).normal_backlash
    for run in (there, again):
        front, back = (run[name].sum("pair") for name in ("normal_load", "normal_load_back"))
        assert float(run["normal_load"].min()) >= 0.0
        assert float(run["normal_load_back"].min()) >= 0.0
        assert float((front * back).max()) == 0.0  # never both sides, and only a whole backlash behind
        assert not (back > 0).where(run["overlap"] > -0.97 * backlash, False).any()  # bearings give way by um
    assert float(there["normal_load_back"].max()) > static  # an impact
    # Driving again: the teeth still rattle, but over 20 cycles their impacts carry the torque.
    front, back = (again[name].sum("pair")[-20 * 256 :] for name in ("normal_load", "normal_load_back"))
    assert float(front.mean()) == pytest.approx(static, rel=0.05)
    assert float(back.max()) == 0.0


def test_impacts_are_resolved():
    """A tighter tolerance moves a run with impacts by little: the events are located."""
    pair = PAIR.with_(operating__pinion_speed=5000)
    runs = [multibody.simulate(pair, 10, initial=_knocked(pair), rtol=rtol) for rtol in (1e-7, 1e-9, 1e-11)]
    assert float(runs[0]["overlap"].min()) < -1e-6
    *coarser, finest = runs
    errors = [float(np.abs(run["dte"] - finest["dte"]).max()) for run in coarser]
    scale = float(np.ptp(finest["dte"].to_numpy()))
    # Damping switches on at impact: a jump in force that the step-size control must find.
    assert errors[0] < 1e-4 * scale
    assert errors[1] < 1e-6 * scale


def _knocked(pair):
    state = np.zeros(12)
    state[0] = -5e-6 / lumped.geometry(pair).base_radius_pinion
    return state


SLOW = lumped.load_gear_pair("nasa_28_28").with_(
    friction__law="coulomb", friction__coefficient=0.05, operating__pinion_torque=79.1,
    operating__pinion_speed=800,
)  # fmt: skip


def test_sign_function_gets_stuck_and_says_so(monkeypatch):
    """In a sliding mode the steps shrink without end; the cap on calls turns a hang into an error."""
    monkeypatch.setattr("multibody.run.setup.CALL_LIMIT", 60_000)
    with pytest.raises(lumped.NumericalError, match="friction_velocity"):
        multibody.simulate(SLOW, 2, friction_velocity=0.0)
