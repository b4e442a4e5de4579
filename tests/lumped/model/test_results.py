"""Are the results labelled, consistent with each other, and reproducible?"""

import itertools
import json

import numpy as np
import pytest
import xarray as xr
from scipy.interpolate import make_interp_spline

from lumped import bodies, geometry, load_gear_pair, mesh_cycle, preset_names, simulate, steady_state
from lumped.labelling import parameters_hash
from lumped.model.equations import structure
from lumped.model.results import VARIABLES, cycle_peak_to_peak, peak_to_peak


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


def test_saving_loses_nothing(run, tmp_path):
    path = tmp_path / "run.nc"
    run.to_netcdf(path, engine="h5netcdf")
    with xr.open_dataset(path, engine="h5netcdf") as back:
        for name in run.variables:
            np.testing.assert_array_equal(back[name], run[name])
            assert back[name].attrs == run[name].attrs
        assert dict(back.attrs) == run.attrs
    json.dumps(run.attrs)  # every attribute is plain data


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


@pytest.fixture(scope="module")
def fine(unequal):
    """A transient with every term at work, fine enough to differentiate."""
    return simulate(unequal, 3, samples_per_cycle=1024)


def smooth_windows(pair, run):
    """Index ranges of the samples strictly within each smooth segment of each cycle."""
    cycle = mesh_cycle(pair)
    time = run["time"].to_numpy()
    edges = np.concatenate([cycle.edges[:-1] + j * cycle.period for j in range(3)] + [[3 * cycle.period]])
    for low, high in itertools.pairwise(edges):
        inside = np.flatnonzero((time > low + 1e-9 * cycle.period) & (time < high - 1e-9 * cycle.period))
        if inside.size > 60:
            yield inside


def powers(pair, run):
    """Stored energies and all powers from the dataset alone, deviations from nominal rotation included."""
    g, b, s = geometry(pair), bodies(pair), structure(pair)
    v = {name: run[name].to_numpy() for name in run}
    # Deviations carry the balance: the nominal rotation adds a constant and a linear term, both included.
    omega_p, omega_g = g.omega_pinion + v["theta_p_dot"], g.omega_gear + v["theta_g_dot"]
    rates = np.stack([v[f"{n}_dot"] for n in ("x_p", "x_g", "y_p", "y_g")])
    places = np.stack([v[n] for n in ("x_p", "x_g", "y_p", "y_g")])
    kinetic = (
        0.5 * b.inertia_pinion * v["theta_p_dot"] ** 2
        + 0.5 * b.inertia_gear * v["theta_g_dot"] ** 2
        # 0.5 J (Omega + theta')^2 without its constant
        + b.inertia_pinion * g.omega_pinion * v["theta_p_dot"]
        + b.inertia_gear * g.omega_gear * v["theta_g_dot"]
        + 0.5 * (s.mass[2:, None] * rates**2).sum(axis=0)
    )
    stored = kinetic + 0.5 * (s.stiffness[2:, None] * places**2).sum(axis=0)
    drive = run.attrs["pinion_torque"] * omega_p - run.attrs["brake_torque"] * omega_g
    bearings = (s.damping[2:, None] * rates**2).sum(axis=0)
    mesh = (v["normal_load"] * v["dte_dot"]).sum(axis=0)
    friction = v["friction_power"].sum(axis=0)
    return stored, drive - bearings - mesh + friction, np.abs(drive).max()


def relative_imbalance(pair, run):
    """Largest |d(stored)/dt - power| over the smooth windows, relative to the power put in."""
    stored, power, scale = powers(pair, run)
    time = run["time"].to_numpy()
    worst = 0.0
    for window in smooth_windows(pair, run):
        slope = make_interp_spline(time[window], stored[window], k=9).derivative()(time[window])
        # The ends of a spline have no data beyond them.
        worst = max(worst, np.abs(slope - power[window])[8:-8].max() / scale)
    return worst


def test_instantaneous_balance(unequal, fine):
    # Differentiating samples known to 1e-12 at 1024 a cycle costs three digits.
    assert relative_imbalance(unequal, fine) < 1e-9


@pytest.mark.parametrize("name", preset_names())
def test_friction_never_gives_power(name):
    """Where the teeth press (N_i >= 0), nominal sliding power is negative; at the pitch point it is zero."""
    run = steady_state(
        load_gear_pair(name).with_(mesh__contact="prescribed", mesh__relief="ignored")
    )  # with it nasa_28_28 has pulls
    assert float(run["normal_load"].where(run["contact"] > 0).min()) > 0.0
    assert float(run["friction_power_nominal"].max()) <= 0.0
    assert float(run["friction_power_nominal"].min()) < 0.0
