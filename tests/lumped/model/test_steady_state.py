"""Is the periodic solution the motion that the pair settles to, and are its torques in balance?"""

import math

import numpy as np
import pytest

from lumped import (
    NumericalError,
    geometry,
    load_gear_pair,
    periodic_system,
    simulate,
    speed_sweep,
    steady_state,
)
from lumped.labelling import parameters_hash
from lumped.model.equations import Y_P
from lumped.model.period_closure import balanced_start
from lumped.model.propagation import step_maps
from lumped.model.results import VARIABLES, cycle_peak_to_peak, peak_to_peak
from lumped.model.steady import periodic_solution, sample_times

MOTION = ("dte", "x_p", "x_g", "y_p", "y_g")


@pytest.mark.parametrize("speed", [800, 12000])
def test_the_period_closes(published, speed):
    pair = published.with_(operating__pinion_speed=speed)
    run = steady_state(pair, samples_per_cycle=32)
    # Rounding of the bordered system, whose condition is about 1e4.
    assert run.attrs["closure"] < 1e-10
    start = np.concatenate([run[n].to_numpy()[:1] for n in list(run)[:12]])
    ahead = simulate(pair, 2, samples_per_cycle=32, initial=start)
    scale = float(np.abs(run["dte"]).max())
    for variable in MOTION:
        again = ahead[variable].to_numpy()[32:64]
        once = run[variable].to_numpy()
        # The transient errs by 1e-10 of the largest deflection a step, some hundred steps a cycle.
        assert np.abs(again - once).max() <= 1e-8 * scale, variable


def test_a_pair_that_does_not_move_closes(high_contact):
    """Contact ratio 2, equal pairs, P in the middle: stiffness and friction are constant, so is all."""
    g = geometry(high_contact)
    tips = {
        f"{name}.tip_diameter": 2e3 * math.hypot(radius, length + g.base_pitch)
        for name, radius, length in (
            ("pinion", g.base_radius_pinion, g.L_XP),
            ("gear", g.base_radius_gear, g.L_XY - g.L_XP),
        )
    }
    pair = high_contact.with_(tips | {"mesh.stiffness": {"model": "rectangular"}})
    assert geometry(pair).contact_ratio == pytest.approx(2.0, rel=1e-12)
    run = steady_state(pair, samples_per_cycle=8)
    assert np.ptp(run["dte"].to_numpy()) < 1e-12 * float(run["dte"].mean())
    # Its rates are rounding of nothing; the mismatch is judged by displacement over period.
    assert run.attrs["closure"] < 1e-10


@pytest.fixture(scope="module")
def with_brake(unequal):
    """The same pair with balanced brake and with a given one."""
    pair = unequal.with_(operating__brake_torque=40.0)
    return steady_state(unequal, samples_per_cycle=16), steady_state(pair, samples_per_cycle=16)


def test_the_drive_balances_a_given_brake(with_brake, unequal):
    free, braked = with_brake
    assert braked.attrs["brake_torque"] == 40.0
    # The balance is linear in the load: same ratio of the torques, other size.
    ratio = free.attrs["pinion_torque"] / free.attrs["brake_torque"]
    assert braked.attrs["pinion_torque"] == pytest.approx(40.0 * ratio, rel=1e-10)
    # Dampers lose by the square of the load, sliding by the load itself: the efficiency is another one.
    lost = {name: one.attrs[name] for one in (braked,) for name in one.attrs if name.startswith("power_")}
    power = braked.attrs["pinion_torque"] * geometry(unequal).omega_pinion
    places = ("power_sliding", "power_tooth_dampers", "power_bearings")
    assert braked.attrs["mesh_efficiency"] == pytest.approx(
        1.0 - sum(lost[n] for n in places) / power, rel=1e-12
    )


def test_the_motion_scales_with_the_torque(with_brake):
    free, braked = with_brake
    factor = braked.attrs["pinion_torque"] / free.attrs["pinion_torque"]
    for name in MOTION:
        a = braked[name].to_numpy()
        b = factor * free[name].to_numpy()
        assert np.abs(a - b).max() < 1e-9 * np.abs(b).max(), name


@pytest.mark.parametrize(("speed", "samples"), [(500, 8), (4875, 128), (30000, 8)])
def test_the_estimate_bounds_the_error(published, speed, samples):
    """Against the same equations at steps 25 times shorter, far into the tail of order 8."""
    pair = published.with_(operating__pinion_speed=speed)
    system = periodic_system(pair, "full")
    times = sample_times(system.period, samples)
    torques = np.stack([system.torque_pinion, system.torque_gear], axis=1)
    fine = step_maps(system, torques, outputs=times, step_angle=0.02)
    states = fine.states(*balanced_start(system, *fine.over_all))
    exact = states[np.searchsorted(fine.times, times - 1e-9 * system.period)][:, :6] @ system.deflection
    solution = periodic_solution(system, times)
    dte = solution.states[:, :6] @ system.deflection
    error = np.abs(dte - exact).max() / np.abs(exact).max()
    assert error < 1e-9
    assert error <= solution.error + 1e-12  # rounding of two solves


def test_mean_speed_is_held(coulomb_pair):
    run = steady_state(coulomb_pair, samples_per_cycle=2048)
    for name in ("theta_p_dot", "theta_g_dot"):
        values = run[name].to_numpy()
        # Mean of a periodic function with kinks by 2048 samples.
        assert abs(values.mean()) < 1e-4 * np.abs(values).max()


def test_a_stability_boundary_is_refused(published):
    """With no damping at all and no friction the map at a resonance T w = 2 pi k has a multiplier at +1."""
    stiff = published.with_(
        {
            "friction.law": "none",
            "mesh.damping_ratio": 0.0,
            **{f"bearings.{g}.{d}_damping_ratio": 0.0 for g in ("pinion", "gear") for d in ("loa", "oloa")},
        }
    )
    # y is a plain oscillator: its multiplier is at +1 where a whole number of periods fits the mesh cycle.
    mass = periodic_system(stiff, "full").structure.mass[Y_P]
    stiffness = published.bearings.pinion.oloa_stiffness
    teeth = published.pinion.teeth
    speed = math.sqrt(stiffness / mass) * 60 / (2 * math.pi * teeth) / 3
    with pytest.raises(NumericalError, match="Change the speed slightly or add damping"):
        steady_state(stiff.with_(operating__pinion_speed=speed), samples_per_cycle=8)
    assert steady_state(stiff.with_(operating__pinion_speed=1.01 * speed), samples_per_cycle=8)


def test_an_unstable_periodic_motion_says_so(high_contact):
    """Undamped pairs have unstable speeds; the transient leaves the periodic motion exactly there.

    A disturbance grows over a cycle by the largest multiplier in the end, so over many cycles by its power.
    """
    pair = high_contact.with_(mesh__damping_ratio=0.0, friction__law="none")
    speeds = np.linspace(3000.0, 20000.0, 69)
    radii = speed_sweep(pair, speeds, samples_per_cycle=8)["spectral_radius"].to_numpy()
    worst = int(np.argmax(radii))
    assert radii[worst] > 1.01
    assert radii.min() < 1.0
    for place in (worst, int(np.argmin(radii))):
        unstable = pair.with_(operating__pinion_speed=float(speeds[place]))
        motion = steady_state(unstable, samples_per_cycle=8)
        # Speeds of a sweep are computed together, on the clock of the first: times are rounded once more.
        assert motion.attrs["spectral_radius"] == pytest.approx(radii[place], rel=1e-12)
        start = np.array([float(motion[n][0]) for n in list(motion)[:12]])
        start[2:4] += 1e-6, -1e-6
        run = simulate(unstable, 200, samples_per_cycle=8, initial=start)
        rest = run["x_p"].to_numpy()[:-1].reshape(200, 8) - motion["x_p"].to_numpy()
        size = np.abs(rest).max(axis=1)
        if place == worst:
            # Windows of 20 cycles see the envelope; whatever else was excited has died away by the first.
            growth = (size[180:].max() / size[80:100].max()) ** (1.0 / 100.0)
            assert growth == pytest.approx(radii[place], rel=2e-3)
        else:
            assert size[-1] < 1e-3 * size[0]


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


def test_same_parameters_same_bits(published):
    a = steady_state(published, samples_per_cycle=32)
    b = steady_state(published, samples_per_cycle=32)
    assert a.identical(b)
    c = simulate(published, 1, samples_per_cycle=16)
    d = simulate(published, 1, samples_per_cycle=16)
    assert c.identical(d)


def test_extremes_between_samples_are_found():
    time = np.linspace(0.0, 2.0 * np.pi, 9)  # the extremes of the sine below lie between these
    swing = peak_to_peak(time, np.sin(time + 0.3), np.cos(time + 0.3))
    # Cubic from exact values and rates: error up to h^4/384 at each extreme, h = pi/4.
    assert swing == pytest.approx(2.0, abs=2 * (np.pi / 4) ** 4 / 384)
    assert np.ptp(np.sin(time + 0.3)) < 1.92


def test_a_straight_line_and_a_constant_have_no_extremes_between():
    time = np.array([0.0, 1.0, 3.0])
    assert peak_to_peak(time, 2.0 * time, np.full(3, 2.0)) == 6.0
    assert peak_to_peak(time, np.ones(3), np.zeros(3)) == 0.0


@pytest.mark.parametrize("speed", [1450, 9000])
def test_the_transmission_error_of_a_pair_has_one_peak_to_peak(published, speed):
    pair = published.with_(operating__pinion_speed=speed)
    few, many = (steady_state(pair, samples_per_cycle=n) for n in (16, 2048))
    swing = many.attrs["dte_peak_to_peak"]
    assert few.attrs["dte_peak_to_peak"] == pytest.approx(swing, rel=1e-4)
    assert swing == pytest.approx(np.ptp(many["dte"].to_numpy()), rel=1e-3)
    assert cycle_peak_to_peak(many, "dte", pair.geometry.mesh_period) == pytest.approx(swing, rel=1e-5)
    run = simulate(pair, 1, samples_per_cycle=512, initial="periodic")
    assert cycle_peak_to_peak(run, "dte") == pytest.approx(swing, rel=1e-3)
