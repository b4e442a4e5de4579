"""Are the results labelled, consistent with each other, and reproducible?"""

import numpy as np
import pytest

from lumped import geometry, load_gear_pair, simulate, steady_state
from lumped.labelling import parameters_hash
from lumped.model.results import VARIABLES, cycle_peak_to_peak, peak_to_peak


@pytest.fixture(scope="module")
def run(unequal):
    return simulate(unequal, 2, samples_per_cycle=64)


def test_every_variable_has_unit_and_name(run):
    assert set(run) == set(VARIABLES)
    for name in run.variables:
        assert run[name].attrs["units"]
        assert run[name].attrs["long_name"]


def test_sliding_velocity_without_vibration_is_nominal(run, unequal):
    g = geometry(unequal)
    xi = run["position"]
    nominal = (g.omega_pinion * xi - g.omega_gear * (g.L_XY - xi)).where(run["contact"] > 0, 0.0)
    vibration = (
        run["theta_p_dot"] * xi - run["theta_g_dot"] * (g.L_XY - xi) - run["y_p_dot"] + run["y_g_dot"]
    ).where(run["contact"] > 0, 0.0)
    np.testing.assert_allclose(run["sliding_velocity"], nominal + vibration, atol=1e-12)
    np.testing.assert_allclose(
        run["friction_power"], -run["friction_force"] * run["sliding_velocity"], atol=1e-9
    )


def test_provenance(run, unequal):
    attrs = run.attrs
    assert attrs["gear_pair"] == unequal.name
    assert attrs["model"] == "lumped"
    assert attrs["parameters_sha256"] == parameters_hash(unequal)
    assert "numpy" in attrs["versions"]
    for setting in ("cycles=2", "samples_per_cycle=64", "initial=static"):
        assert setting in attrs["settings"]
    import tomllib

    assert load_gear_pair(tomllib.loads(attrs["parameters"])) == unequal


def test_same_parameters_same_bits(coulomb_pair):
    a, b = steady_state(coulomb_pair, samples_per_cycle=32), steady_state(coulomb_pair, samples_per_cycle=32)
    assert a.identical(b)
    c, d = simulate(coulomb_pair, 1, samples_per_cycle=16), simulate(coulomb_pair, 1, samples_per_cycle=16)
    assert c.identical(d)


def test_extremes_between_samples_are_found():
    time = np.linspace(0.0, 2.0 * np.pi, 9)  # the extremes of the sine below lie between these
    found = peak_to_peak(time, np.sin(time + 0.3), np.cos(time + 0.3))
    # Cubic from exact values and rates: error up to h^4/384 at each extreme, h = pi/4.
    assert found == pytest.approx(2.0, abs=2 * (np.pi / 4) ** 4 / 384)
    assert np.ptp(np.sin(time + 0.3)) < 1.92


def test_a_straight_line_and_a_constant_have_no_extremes_between():
    time = np.array([0.0, 1.0, 3.0])
    assert peak_to_peak(time, 2.0 * time, np.full(3, 2.0)) == 6.0
    assert peak_to_peak(time, np.ones(3), np.zeros(3)) == 0.0


@pytest.mark.parametrize("speed", [300, 1450, 9000])
def test_the_transmission_error_of_a_pair_has_one_peak_to_peak(unequal, speed):
    pair = unequal.with_(operating__pinion_speed=speed)
    few, many = (steady_state(pair, samples_per_cycle=n) for n in (16, 2048))
    swing = many.attrs["dte_peak_to_peak"]
    assert few.attrs["dte_peak_to_peak"] == pytest.approx(swing, rel=1e-4)
    assert swing == pytest.approx(np.ptp(many["dte"].to_numpy()), rel=1e-3)
    assert cycle_peak_to_peak(many, "dte", pair.geometry.mesh_period) == pytest.approx(swing, rel=1e-5)
    run = simulate(pair, 1, samples_per_cycle=512, initial="periodic")
    assert cycle_peak_to_peak(run, "dte") == pytest.approx(swing, rel=1e-3)
