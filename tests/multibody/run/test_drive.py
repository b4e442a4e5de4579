"""Do drive and load do what they are told: hold the speed, follow a history, run up?"""

from __future__ import annotations

import numpy as np
import pytest

import lumped
import multibody
from multibody import Drive

PAIR = lumped.load_gear_pair("nasa_28_28").with_(friction__law="coulomb", friction__coefficient=0.05)
OMEGA = PAIR.operating.pinion_speed
PERIOD = lumped.geometry(PAIR).mesh_period


def last_mean(run, name, cycles, samples=32):
    return float(run[name][-cycles * samples :].mean())


def test_balanced_torques_hold_the_mean_speed():
    run = multibody.simulate(PAIR, 40, initial="periodic", samples_per_cycle=32)
    assert abs(last_mean(run, "theta_p_dot", 20)) < 1e-3 * OMEGA


def test_unbalanced_torque_drifts_at_the_rate_of_the_free_train():
    """Brake torque off by dT on a 1:1 pair: both inertias together speed up by dT/(J_p + J_g)."""
    brake = lumped.steady_state(PAIR).attrs["brake_torque"]
    drive = Drive(brake_torque=([0.0], [brake - 1.0]))
    run = multibody.simulate(PAIR, 40, initial="periodic", drive=drive, samples_per_cycle=32)
    b = lumped.bodies(PAIR)
    expected = 1.0 / (b.inertia_pinion + b.inertia_gear)
    speed = run["theta_p_dot"].to_numpy()[:-1].reshape(40, 32).mean(axis=1)
    measured = (speed[39] - speed[9]) / (30 * PERIOD)
    assert measured == pytest.approx(expected, rel=0.01)  # friction follows the speed a little


def test_motor_behind_a_spring_holds_the_speed_against_a_wrong_brake():
    brake = lumped.steady_state(PAIR).attrs["brake_torque"]
    stiffness, excess = 5e3, 2.0
    inertia = sum(getattr(lumped.bodies(PAIR), f"inertia_{g}") for g in ("pinion", "gear"))
    drive = Drive(stiffness, 2 * 0.3 * np.sqrt(stiffness * inertia), brake_torque=([0.0], [brake + excess]))
    run = multibody.simulate(PAIR, 80, initial="periodic", drive=drive, samples_per_cycle=32)
    assert abs(last_mean(run, "theta_p_dot", 20)) < 1e-3 * OMEGA
    # The spring carries the excess: the pinion lags by dT/k behind the motor (equal gears, so dT on either
    # side). What still swings after 60 cycles is a per cent of it.
    lag = float(run["theta_p"][0]) - last_mean(run, "theta_p", 20)
    assert lag == pytest.approx(excess / stiffness, rel=0.03)


def test_run_up_follows_the_ramp():
    """From 3000 to 4875 rpm: the pair ends at the motor's speed and has turned as far as the motor."""
    stiffness = 5e3
    inertia = sum(getattr(lumped.bodies(PAIR), f"inertia_{g}") for g in ("pinion", "gear"))
    duration = 60 * PERIOD
    drive = Drive(
        stiffness,
        2 * 0.5 * np.sqrt(stiffness * inertia),
        motor_speed=([0.0, 0.5 * duration], [3000.0, 4875.0]),
    )
    run = multibody.simulate(PAIR, 60, drive=drive, samples_per_cycle=32, rtol=1e-9)
    assert float(run["theta_p_dot"][0]) == pytest.approx((3000 - 4875) * np.pi / 30, rel=1e-12)
    assert abs(last_mean(run, "theta_p_dot", 10)) < 1e-3 * OMEGA
    behind = float(run["theta_p"][0] - run["theta_p"][-320:].mean())
    # Mean lag of the ramp: half its height over half the run.
    assert behind == pytest.approx(0.5 * 1875 * np.pi / 30 * 0.5 * duration, rel=1e-3)
    assert float(run["friction_power"].max()) <= 0.0


def test_torque_history_reaches_the_teeth():
    """Twice the torque from the middle on, on both sides: twice the mean mesh load (equal inertias)."""
    brake = 56.5 * lumped.steady_state(PAIR).attrs["mesh_efficiency"]
    times = np.array([0.0, 20 * PERIOD, 30 * PERIOD])
    drive = Drive(
        pinion_torque=(times, 56.5 * np.array([1, 1, 2])), brake_torque=(times, brake * np.array([1, 1, 2]))
    )
    # Smooth stiffness, so that 32 samples give the mean of a cycle.
    smooth = PAIR.with_(mesh__stiffness={"model": "parabolic", "ramp_length": 3.0})
    run = multibody.simulate(smooth, 60, initial="periodic", drive=drive, samples_per_cycle=32)
    load = run["normal_load"].sum("pair").to_numpy()[:-1].reshape(60, 32).mean(axis=1)
    assert load[50:].mean() / load[:19].mean() == pytest.approx(2.0, rel=0.01)


@pytest.mark.parametrize(
    ("drive", "field"),
    [
        (Drive(stiffness=-1.0), "drive.stiffness"),
        (Drive(damping=float("nan")), "drive.damping"),
        (Drive(motor_speed=([0.0, 1.0], [0.0, 100.0])), "drive.stiffness"),
        (Drive(pinion_torque=([0.0, 0.0], [1.0, 2.0])), "drive.pinion_torque"),
        (Drive(brake_torque=([0.0, 1.0], [1.0])), "drive.brake_torque"),
    ],
)
def test_a_drive_that_cannot_be_is_refused(drive, field):
    with pytest.raises(lumped.ParameterError, match=field):
        multibody.simulate(PAIR, 1, drive=drive)
