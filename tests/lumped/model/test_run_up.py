"""Is a run-up the integral of the speed, and the known motions in its limits?"""

from __future__ import annotations

import numpy as np
import pytest

import spurcheck
from lumped import ParameterError, load_gear_pair, periodic_system, run_up, simulate, speed_sweep

SMOOTH = {"model": "parabolic", "ramp_length": 2.0}
PAIR = load_gear_pair("nasa_28_28").with_(
    law="coulomb",
    friction__coefficient=0.05,
    mesh__contact="prescribed",
    mesh__relief="ignored",
    stiffness=SMOOTH,
)


def test_without_a_ramp_it_is_the_motion_at_that_speed():
    run = run_up(PAIR, (3000, 3000), 0.02)
    constant_speed = simulate(PAIR.with_(speed=3000), 20, samples_per_cycle=32, initial="periodic")
    assert np.abs(run["dte"][:640] - constant_speed["dte"].values[:640]).max() < 1e-9 * np.ptp(
        constant_speed["dte"].values
    )


def difference(seconds: float) -> float:
    """From dx/dphi = (A(phi) x + b)/f(phi), phi the integral of the mesh frequency f, by Runge-Kutta; rms."""
    run = run_up(PAIR, (2000, 4000), seconds)
    system = periodic_system(PAIR.with_(speed=2000), "full")
    brake = spurcheck.steady_state(PAIR.with_(speed=2000)).attrs["brake_torque"]
    first = 2000 * 28 / 60
    count = run.sizes["time"]
    inner = 6
    phase = np.arange(2 * inner * (count - 1) + 1) / (2 * inner * 32)  # two places a step, 6 steps an output
    duration = 1.0 / np.sqrt(first**2 + 2 * first / seconds * phase)
    time = phase % 1.0 * system.period
    a = system.matrices(time) * duration[:, None, None]
    b = (system.forcing(time) + brake * system.torque_gear) * duration[:, None]
    state = np.array([float(run[name][0]) for name in system.state_names])
    states = [state]
    h = 1.0 / (inner * 32)
    for j in range(0, phase.size - 2, 2):
        k1 = a[j] @ state + b[j]
        k2 = a[j + 1] @ (state + h / 2 * k1) + b[j + 1]
        k3 = a[j + 1] @ (state + h / 2 * k2) + b[j + 1]
        k4 = a[j + 2] @ (state + h * k3) + b[j + 2]
        state = state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        states.append(state)
    dte = np.array(states[::inner])[:, : len(system.coordinates)] @ system.deflection
    return float(np.std(dte - run["dte"].to_numpy()) / np.std(dte))


def test_coefficients_that_stay_for_a_cycle_err_by_the_speed_of_the_ramp():
    fast = difference(0.025)
    slow = difference(0.05)
    assert slow < 0.02
    assert slow == pytest.approx(fast / 2, rel=0.15)  # first order in the change of speed per mesh cycle


def test_a_slow_ramp_is_the_sweep_and_the_mesh_order_carries_it():
    run = run_up(PAIR, (3000, 3300), 2.0, samples_per_cycle=16)
    waterfall = spurcheck.waterfall(run)
    speeds = waterfall["speed_rpm"].to_numpy()[[5, -5]]
    sweep = speed_sweep(PAIR, speeds)
    mesh_orders = waterfall["amplitude"].sel(order=[1, 2, 3, 4, 5, 6, 7], method="nearest")
    rms = np.sqrt((mesh_orders**2).sum("order") / 2).to_numpy()[[5, -5]]  # Parseval
    assert rms == pytest.approx(sweep["dte_rms"].to_numpy(), rel=2e-3)


def test_angle_speed_and_time_belong_together():
    run = run_up(PAIR, (2000, 1000), 0.1)
    turns = np.trapezoid(run["running_speed"], run["time"]) / 60
    assert turns == pytest.approx(float(run["pinion_turns"][-1]), rel=1e-3)
    assert float(run["running_speed"][-1]) == pytest.approx(1000, rel=0.02)


@pytest.mark.parametrize(("speeds", "seconds", "message"), [
    ((0, 3000), 1, "speeds_rpm = .* > 0"),
    ((500,), 1, "1 numbers: allowed two"),
    ((500, 600), 1e-5, "0 mesh cycles"),
    ((500, 60000), 1e4, "allowed 1 to 93750 mesh cycles"),
])  # fmt: skip
def test_runs_that_cannot_be_are_refused(speeds, seconds, message):
    with pytest.raises(ParameterError, match=message):
        run_up(PAIR, speeds, seconds)
