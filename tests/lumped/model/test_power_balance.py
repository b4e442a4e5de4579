"""Does every watt go somewhere: input, mesh, bearings, friction?"""

import itertools

import numpy as np
import pytest
from scipy.interpolate import make_interp_spline

from lumped import bodies, geometry, load_gear_pair, mesh_cycle, preset_names, simulate, steady_state
from lumped.model.equations import structure


@pytest.fixture(scope="module")
def run(unequal):
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


def test_instantaneous_balance(unequal, run):
    # Differentiating samples known to 1e-12 at 1024 a cycle costs three digits.
    assert relative_imbalance(unequal, run) < 1e-9


@pytest.mark.parametrize("name", preset_names())
def test_friction_never_gives_power(name):
    """Where the teeth press (N_i >= 0), nominal sliding power is negative; at the pitch point it is zero."""
    run = steady_state(
        load_gear_pair(name).with_(mesh__contact="prescribed", mesh__relief="ignored")
    )  # with it nasa_28_28 has pulls
    assert float(run["normal_load"].where(run["contact"] > 0).min()) > 0.0
    assert float(run["friction_power_nominal"].max()) <= 0.0
    assert float(run["friction_power_nominal"].min()) < 0.0
