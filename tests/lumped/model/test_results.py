"""Are the results labelled, consistent with each other, and reproducible?"""

import json

import numpy as np
import pytest
import xarray as xr

from lumped import geometry, load_gear_pair, simulate, steady_state
from lumped.labelling import parameters_hash
from lumped.model.results import VARIABLES


@pytest.fixture(scope="module")
def run(unequal):
    return simulate(unequal, 2, samples_per_cycle=64)


def test_every_variable_has_unit_and_name(run):
    assert set(run) == set(VARIABLES)
    for name in run.variables:
        assert run[name].attrs["units"]
        assert run[name].attrs["long_name"]


def test_derived_variables_follow_from_the_states(run, unequal):
    g = geometry(unequal)
    dte = (
        g.base_radius_pinion * run["theta_p"] - g.base_radius_gear * run["theta_g"] + run["x_p"] - run["x_g"]
    )
    np.testing.assert_allclose(run["dte"], dte, rtol=1e-9)
    np.testing.assert_allclose(run["friction_force"], run["mu"] * run["normal_load"], rtol=1e-15)
    b = unequal.bearings
    for name, k in (
        ("x_p", b.pinion.loa_stiffness),
        ("x_g", b.gear.loa_stiffness),
        ("y_p", b.pinion.oloa_stiffness),
        ("y_g", b.gear.oloa_stiffness),
    ):
        # Where the velocity vanishes only the spring is left; elsewhere the damper acts against the velocity.
        damper = run[f"bearing_force_{name}"] + k * run[name]
        rate = run[f"{name}_dot"]
        assert float((damper * rate).max()) <= 0.0


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


def test_pairs_out_of_contact_carry_nothing(run):
    free = run["contact"] == 0
    assert bool(free.any())
    for name in ("normal_load", "friction_force", "mu", "sliding_velocity", "friction_power"):
        assert float(np.abs(run[name].where(free, 0.0)).max()) == 0.0, name


def test_a_tooth_keeps_its_load_from_pair_to_pair(coulomb_pair):
    """Pair i of one cycle is pair i - 1 of the next: its load goes on without a jump at the cycle's end."""
    run = steady_state(coulomb_pair, samples_per_cycle=4096)
    load = run["normal_load"].to_numpy()
    # Last sample of pair 1 against the first of pair 0: one step of 1/4096 of a cycle apart.
    step = np.abs(np.diff(load[1, -50:])).max()
    assert abs(load[0, 0] - load[1, -1]) < 3 * step


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


def test_a_given_start_is_named(coulomb_pair):
    run = simulate(coulomb_pair, 1, samples_per_cycle=8, initial=np.zeros(12))
    assert "initial=given" in run.attrs["settings"]


def test_same_parameters_same_bits(coulomb_pair):
    a, b = steady_state(coulomb_pair, samples_per_cycle=32), steady_state(coulomb_pair, samples_per_cycle=32)
    assert a.identical(b)
    c, d = simulate(coulomb_pair, 1, samples_per_cycle=16), simulate(coulomb_pair, 1, samples_per_cycle=16)
    assert c.identical(d)


def test_saving_loses_nothing(run, tmp_path):
    path = tmp_path / "run.nc"
    run.to_netcdf(path, engine="h5netcdf")
    with xr.open_dataset(path, engine="h5netcdf") as back:
        for name in run.variables:
            np.testing.assert_array_equal(back[name], run[name])
            assert back[name].attrs == run[name].attrs
        assert dict(back.attrs) == run.attrs
    json.dumps(run.attrs)  # every attribute is plain data
