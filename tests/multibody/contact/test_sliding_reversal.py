"""What happens where the actual sliding velocity changes sign away from the pitch point?"""

from __future__ import annotations

import sys

import numpy as np
import pytest
import xarray as xr

import lumped
import multibody

SLOW = lumped.load_gear_pair("nasa_28_28").with_(
    friction__law="coulomb",
    friction__coefficient=0.05,
    operating__pinion_torque=79.1,
    operating__pinion_speed=800,
)


def test_default_says_which_sign_function_it_takes_and_why():
    fast = SLOW.with_(operating__pinion_speed=4000)
    for pair, velocity, word in (
        (SLOW, 1e-4, "hold the teeth"),
        # Friction changes 0.2 of the nominal acceleration here, but from rest the bearings swing up: sign()
        # sticks.
        (SLOW.with_(operating__pinion_speed=2000), 1e-4, "hold the teeth"),
        (fast, 0.0, "resonance could take away"),
        (SLOW.with_(friction__law="xu_kahraman"), 0.0, "continuous"),
    ):
        attributes = multibody.simulate(pair, 1).attrs
        assert attributes["friction_velocity"] == velocity
        assert word in attributes["friction_velocity_reason"]


def test_sign_function_gets_stuck_and_says_so(monkeypatch):
    """In a sliding mode the steps shrink without end; the cap on calls turns a hang into an error."""
    monkeypatch.setattr("multibody.run.setup.CALL_LIMIT", 60_000)
    with pytest.raises(lumped.NumericalError, match="friction_velocity"):
        multibody.simulate(SLOW, 2, friction_velocity=0.0)


def test_solution_converges_as_the_sign_change_sharpens():
    """79.1 N m, 800 rpm: each halving of the velocity moves the motion by less, at about first order."""
    found = multibody.reversal_convergence(SLOW, 2, velocities=(8e-3, 4e-3, 2e-3, 1e-3, 5e-4))
    for name in ("dte", "y_p"):
        steps = found["change"].sel(quantity=name).to_numpy()
        orders = found["order"].sel(quantity=name).to_numpy()[1:]
        np.testing.assert_allclose(2.0**orders, steps[:-1] / steps[1:], rtol=1e-12)
        assert np.all(orders > 0.26), (name, steps)  # a factor of 1.2 per halving
        # What is left below 0.5 mm/s: a geometric series with the last ratio; the default is smaller still.
        assert steps[-1] / (2.0 ** orders[-1] - 1) < 0.02


def test_changes_and_orders_of_runs_that_converge_with_a_known_power(monkeypatch):
    """dte leaves its limit by v at one time, x_p by v^2, y_p does not move: orders 1, 2 and none."""

    def run(pair, cycles, *, friction_velocity, **options):
        v = friction_velocity
        values = {"dte": [0.0, 4.0, 2.0 - v], "x_p": [0.0, 4.0, 2.0 + v**2], "y_p": [1.0, 1.0, 1.0]}
        result = xr.Dataset({name: ("time", np.array(x)) for name, x in values.items()})
        return result.assign_attrs(force_evaluations=300.0 * cycles / v)

    monkeypatch.setattr(sys.modules["multibody.study.reversal_convergence"], "simulate", run)
    found = multibody.reversal_convergence(SLOW, 3, velocities=(0.8, 0.4, 0.2))
    assert found["velocity"].to_numpy().tolist() == [0.8, 0.4]
    assert found.attrs["last_velocity"] == 0.2
    np.testing.assert_allclose(found["change"].sel(quantity="dte"), [0.1, 0.05])
    np.testing.assert_allclose(found["change"].sel(quantity="x_p"), [0.12, 0.03])
    assert found["change"].sel(quantity="y_p").isnull().all()
    np.testing.assert_allclose(found["order"].sel(quantity="dte"), [np.nan, 1.0])
    np.testing.assert_allclose(found["order"].sel(quantity="x_p"), [np.nan, 2.0])
    np.testing.assert_allclose(found["force_evaluations"], [375.0, 750.0])


@pytest.mark.parametrize("velocities", [(1e-3,), (1e-3, 1e-3), (1e-3, 2e-3), (1e-3, 0.0), (1e-3, np.nan)])
def test_velocities_that_do_not_fall_are_refused(velocities):
    with pytest.raises(lumped.ParameterError, match="velocities"):
        multibody.reversal_convergence(SLOW, velocities=velocities)


@pytest.mark.parametrize("velocity", [8e-3, 5e-4])
def test_friction_takes_energy_however_sharp(velocity):
    run = multibody.simulate(SLOW, 2, friction_velocity=velocity)
    assert float(run["friction_power"].max()) <= 0.0
