"""Is the model with one degree of freedom the gear pair on rigid bearings?"""

import tomllib

import numpy as np
import pytest

import floquet
import lumped
from floquet.gear.axes import GearVariation, vary
from lumped.errors import ParameterError
from lumped.schema.bodies import bodies_of
from tests.unlike_pairs import UNLIKE, unlike_pair
from validation import plot

#: Every law of friction that varies along the path, and the constant one.
LAWS = ("coulomb", "benedict_kelley", "xu_kahraman", "smoothed_coulomb", "composite")


def pair_of(name):
    return unlike_pair(name).healthy


def by_moments(pair, time):
    """k(t), c(t) and f(t) from the moments of loads and friction on both gears: the power of friction has no
    other sign than that of a loss.
    """
    g, b = pair.geometry, bodies_of(pair)
    r_p, r_g = g.base_radius_pinion, g.base_radius_gear
    tooth_pairs = lumped.mesh_cycle(pair).sample(time)
    X = tooth_pairs.position
    forward = g.omega_pinion * X - g.omega_gear * (g.L_XY - X)  # of the pinion's flank along -y
    mu = np.abs(tooth_pairs.friction) * np.sign(forward)  # +y on the pinion where its flank is faster
    mass = 1.0 / (r_p**2 / b.inertia_pinion + r_g**2 / b.inertia_gear)

    def along_delta(load):
        friction = mu * load
        pinion = (-r_p * load - X * friction).sum(axis=0) / b.inertia_pinion
        gear = (r_g * load + (g.L_XY - X) * friction).sum(axis=0) / b.inertia_gear
        return -mass * (r_p * pinion - r_g * gear)

    at_rest = tooth_pairs.stiffness * tooth_pairs.error + tooth_pairs.damping * tooth_pairs.error_rate
    return mass, along_delta(tooth_pairs.stiffness), along_delta(tooth_pairs.damping), along_delta(at_rest)


@pytest.mark.parametrize("name", UNLIKE)
def test_coefficients_are_the_moments_on_both_gears(name):
    pair = pair_of(name)
    model = floquet.single_degree(pair)
    edges = np.array([0.0, *lumped.mesh_cycle(model.rigid_pair).switch_times, model.period])
    shares = np.array([0.07, 0.41, 0.93])
    time = (edges[:-1, None] + np.diff(edges)[:, None] * shares).ravel()
    mass, k, c, force = by_moments(model.rigid_pair, time)
    assert model.mass == pytest.approx(mass, rel=1e-13)
    # Polynomials of friction laws are fitted to 1e-10 of the largest gain.
    np.testing.assert_allclose(model.stiffness(time), k, rtol=0, atol=1e-9 * k.max())
    np.testing.assert_allclose(model.damping(time), c, rtol=0, atol=1e-9 * c.max())
    np.testing.assert_allclose(
        model.tooth_error_force(time), force, rtol=1e-9, atol=1e-9 * np.abs(force).max()
    )


@pytest.mark.parametrize("name", UNLIKE)
def test_multipliers_are_those_of_the_engine_and_of_liouville(name):
    model = floquet.single_degree(pair_of(name))
    assert model.multipliers.certificate == "proven"
    other = floquet.monodromy(model.system, 1e-10)
    for value, error in zip(other.multipliers, other.multiplier_errors, strict=True):
        distance = np.abs(model.multipliers.multipliers - value)
        assert distance.min() <= error + model.multipliers.multiplier_errors.max()
    decay = floquet.engine.monodromy.integral_of_trace(model.system, model.system.edges)
    assert np.prod(model.multipliers.multipliers).real == pytest.approx(np.exp(decay), rel=1e-7)


def on_stiff_bearings(pair, factor):
    """The pair on springs that are so many times as stiff as the mesh, and damped: they do not ring."""
    k = float(lumped.mesh_stiffness(pair)["mesh_stiffness"].max())
    ends = [f"bearings.{end}.{axis}" for end in ("pinion", "gear") for axis in ("loa", "oloa")]
    stiff = pair.with_({f"{one}_stiffness": factor * k for one in ends})
    return stiff.with_({f"{one}_damping_ratio": 0.5 for one in ends})


@pytest.mark.parametrize(("name", "law"), [*zip(UNLIKE, [*LAWS, "iso_14179"], strict=True)])
def test_six_degrees_on_stiff_bearings_go_to_one_in_proportion_to_the_give(name, law):
    """The bearings give k/K of the deflection: twice as stiff, half the difference."""
    pair = pair_of(name).with_(law=law, mesh__damping_ratio=0.02)
    one = floquet.single_degree(pair)
    motion = one.motion(128)
    swing = np.ptp(motion["dte"].to_numpy())
    of_motion, of_torque, of_matrix = [], [], []
    for factor in (2000.0, 4000.0):
        stiff = on_stiff_bearings(pair, factor)
        six = lumped.steady_state(stiff, supports="springs", samples_per_cycle=128)
        of_motion.append(np.abs(six["dte"].to_numpy() - motion["dte"].to_numpy()).max() / swing)
        of_torque.append(six.attrs["brake_torque"] / motion.attrs["brake_torque"] - 1.0)
        # The polynomial of one degree at the nearest multipliers of six: no root of two that nearly meet.
        values = floquet.gear_pair_multipliers(stiff, supports="springs").feedback
        nearest = values[np.argsort(np.abs(np.polyval(np.poly(one.multipliers.multipliers), values)))[:2]]
        of_matrix.append(np.abs(np.polyval(np.poly(one.multipliers.multipliers), nearest)).max())
    assert of_motion[1] < 5e-3
    # The next order is k/K, here 0.05 %, times the dynamic amplification.
    assert of_motion[0] / of_motion[1] == pytest.approx(2.0, rel=0.02)
    assert of_matrix[0] / of_matrix[1] == pytest.approx(2.0, rel=0.1)
    assert np.abs(of_torque).max() < 1e-5


@pytest.mark.parametrize("brake_torque", ["balanced", 90.0])
@pytest.mark.parametrize("name", UNLIKE)
def test_motion_holds_the_mean_speed_and_is_the_closed_form(name, brake_torque):
    """Means of the moments on both gears are the torques; with constant mu the motion is in closed form."""
    pair = pair_of(name).with_(
        law="coulomb",
        friction__coefficient=0.09,
        mesh__damping_ratio=0.0,
        operating__brake_torque=brake_torque,
    )
    model = floquet.single_degree(pair, stiffness="rectangular")
    motion = model.motion(64)
    closed = model.closed_form()
    exact = closed.motion(motion["time"].to_numpy()).dte
    # Steps of order 8 at 0.5 rad err by 1e-12 each; near a resonance of an order more is left of the sum.
    assert np.abs(motion["dte"].to_numpy() - exact).max() < 1e-8 * np.ptp(exact)
    # The closed form balances moments by integrals, the motion by the map over the cycle.
    assert motion.attrs["force"] == pytest.approx(closed.force_start[0], rel=1e-10)
    g, b = pair.geometry, bodies_of(pair)
    torques = motion.attrs["pinion_torque"], motion.attrs["brake_torque"]
    by_torques = torques[0] * g.base_radius_pinion / b.inertia_pinion
    by_torques += torques[1] * g.base_radius_gear / b.inertia_gear
    assert motion.attrs["force"] == pytest.approx(model.mass * by_torques, rel=1e-12)
    for value in closed.multipliers:
        distance = np.abs(model.multipliers.multipliers - value)
        assert (distance.min() <= model.multipliers.multiplier_errors + 1e-11).all()


@pytest.mark.parametrize("name", ["larger_gear_drives_contact_lost", "contact_ratio_2_3_on_shafts"])
def test_without_mesh_damping_friction_leaves_the_pair_neutral(name):
    """One coordinate: tr A = -c/m = 0 with friction too, so that det M = 1; not so with six degrees."""
    pair = pair_of(name).with_(law="composite", mesh__damping_ratio=0.0, mesh__contact="prescribed")
    model = floquet.single_degree(pair)
    assert model.multipliers.symplectic
    assert model.multipliers.verdict == "neutral"
    assert floquet.monodromy(model.system).verdict == "neutral"
    undamped = pair.with_(
        {f"bearings.{g}.{a}_damping_ratio": 0.0 for g in ("pinion", "gear") for a in ("loa", "oloa")}
    )
    six = floquet.gear_pair_multipliers(undamped, supports="springs")
    assert not six.symplectic
    assert six.verdict != "neutral"
    damped = floquet.single_degree(pair.with_(mesh__damping_ratio=0.01)).multipliers
    assert not damped.symplectic
    assert damped.verdict == "stable"


@pytest.mark.parametrize("name", UNLIKE)
def test_rectangular_stiffness_keeps_the_mean_of_the_pair(name):
    pair = pair_of(name)
    model = floquet.single_degree(pair, stiffness="rectangular")
    cycles = [lumped.mesh_cycle(one) for one in (floquet.single_degree(pair).rigid_pair, model.rigid_pair)]
    assert cycles[1].mean_stiffness == pytest.approx(cycles[0].mean_stiffness, rel=1e-12)
    time = model.period * (np.arange(400) + 0.5) / 400
    levels = np.unique(np.round(cycles[1].sample(time).stiffness.sum(axis=0) / cycles[1].mean_stiffness, 9))
    assert levels.size == 2, "n and n + 1 tooth pairs"
    assert not model.tooth_error_force(time).any()


def test_friction_of_a_mean_load_is_a_force_and_changes_no_multiplier():
    pair = pair_of("rack_25_degrees_always_pushing").with_(law="coulomb", friction__coefficient=0.12)
    model = floquet.single_degree(pair, stiffness="rectangular")
    mean = model.closed_form(friction_load="mean")
    smooth = floquet.single_degree(pair.with_(law="none"), stiffness="rectangular")
    for value in mean.multipliers:
        assert np.abs(smooth.multipliers.multipliers - value).min() < 1e-10
    assert np.abs(model.multipliers.multipliers - mean.multipliers[0]).min() > 1e-6
    g = pair.geometry
    time = (mean.edges[:-1] + mean.edges[1:]) / 2.0
    pairs = lumped.mesh_cycle(model.rigid_pair).sample(time)
    share = (
        pairs.stiffness / pairs.stiffness.sum(axis=0) * pair.operating.pinion_torque / g.base_radius_pinion
    )
    along_delta = (pairs.friction * share * model.arm(pairs.position)).sum(axis=0)
    assert np.ptp(mean.force(time) + along_delta) < 1e-11 * mean.force(time).max()
    # The moments on the pinion have the mean T_p: loads N in the motion, friction of the mean load.
    fine = np.concatenate(
        [
            a + (b - a) * (np.arange(400) + 0.5) / 400
            for a, b in zip(mean.edges[:-1], mean.edges[1:], strict=True)
        ]
    )
    weights = np.repeat(np.diff(mean.edges) / 400, 400) / mean.period
    pairs = lumped.mesh_cycle(model.rigid_pair).sample(fine)
    motion = mean.motion(fine)
    load = (pairs.stiffness * motion.dte + pairs.damping * motion.dte_dot).sum(axis=0)
    share = (
        pairs.stiffness / pairs.stiffness.sum(axis=0) * pair.operating.pinion_torque / g.base_radius_pinion
    )
    moment = g.base_radius_pinion * load + (pairs.position * pairs.friction * share).sum(axis=0)
    # Midpoints of 400 panels.
    assert weights @ moment == pytest.approx(pair.operating.pinion_torque, rel=1e-5)


@pytest.mark.parametrize("law", LAWS)
def test_nodes_of_a_chart_are_the_model_at_that_speed_damping_and_friction(law):
    before = pair_of("larger_gear_drives_contact_lost").with_(law="iso_14179")
    pair = before.with_(law=law)
    axes = {"speed_rpm": [1900.0, 4700.0], "damping_ratio": [0.0, 0.03], "friction_coefficient": [0.0, 0.06]}
    chart = floquet.single_degree_chart(before, axes, friction_law=law, store="all")
    assert chart.attrs["supports"] == "rigid"
    assert lumped.load_gear_pair(tomllib.loads(chart.attrs["parameters"])) == pair
    assert chart.attrs["certificate"] == "proven"
    assert chart.sizes["multiplier"] == 2
    for point in ((0, 0, 1), (0, 1, 0), (1, 1, 1)):
        values = {name: axes[name][i] for name, i in zip(axes, point, strict=True)}
        direct = floquet.gear_pair_multipliers(
            vary(GearVariation(floquet.single_degree(pair).rigid_pair, supports="rigid"), values)
        )
        node = chart.isel(dict(zip(axes, point, strict=True)))
        assert (
            abs(float(node["spectral_radius"]) - direct.spectral_radius)
            <= float(node["error"]) + direct.error
        )
        assert int(node["verdict"]) == {"neutral": 2, "stable": 1}[direct.verdict]
    plot(chart.isel(friction_coefficient=1))


def test_cells_between_nodes_of_a_chart_are_proven():
    pair = pair_of("heavily_relieved_under_load").with_(law="coulomb", friction__coefficient=0.1)
    axes = {"speed_rpm": np.linspace(1500.0, 9000.0, 41), "damping_ratio": np.linspace(0.004, 0.06, 15)}
    chart = floquet.single_degree_chart(pair, axes, stiffness="rectangular", prove=True)
    assert chart.attrs["proven_share"] > 0.9
    verdict = chart["cell_verdict"].to_numpy()
    assert {-1, 1} <= set(np.unique(verdict).tolist())
    rng = np.random.default_rng(5)
    for i, j in zip(rng.integers(0, 40, 12), rng.integers(0, 14, 12), strict=True):
        if verdict[i, j]:
            share = rng.uniform(size=2)
            rpm = axes["speed_rpm"][i] + share[0] * np.diff(axes["speed_rpm"])[i]
            damping = axes["damping_ratio"][j] + share[1] * np.diff(axes["damping_ratio"])[j]
            model = floquet.single_degree(
                pair.with_(speed=rpm, mesh__damping_ratio=damping), stiffness="rectangular"
            )
            assert model.multipliers.verdict == {1: "stable", -1: "unstable"}[int(verdict[i, j])]


def test_the_motion_is_drawn_and_named():
    motion = floquet.single_degree(pair_of("contact_ratio_1_1_large_shifts")).motion(64)
    assert motion.attrs["supports"] == "rigid"
    assert "bearing_force_x_p" not in motion
    assert {"dte", "normal_load", "friction_force", "sliding_velocity"} <= set(motion.data_vars)
    assert motion["theta_p"].attrs["units"] == "rad"
    assert len(plot(motion).axes) == 2


COULOMB = {"law": "coulomb", "friction__coefficient": 0.05}


@pytest.mark.parametrize(("changes", "arguments", "words"), [
    (COULOMB, {}, r"mesh\.stiffness = .*rectangular"),
    ({**COULOMB, "mesh__stiffness": {"model": "rectangular"}, "mesh__contact": "prescribed"}, {},
     r"mesh\.relief = .*teeth without errors"),
    ({"law": "benedict_kelley"}, {"stiffness": "rectangular"}, r"friction\.law = benedict_kelley: .*coulomb"),
    (COULOMB, {"stiffness": "rectangular"}, r"damper_friction = True: .*damping_ratio = 0"),
])  # fmt: skip
def test_what_has_no_closed_form_says_so(changes, arguments, words):
    pair = pair_of("heavily_relieved_under_load").with_(**changes)
    with pytest.raises(ParameterError, match=words):
        floquet.single_degree(pair, **arguments).closed_form()


def test_wrong_arguments_are_refused():
    pair = pair_of("contact_ratio_1_1_large_shifts")
    with pytest.raises(ParameterError, match=r"supports = rigid: .*springs, shafts"):
        lumped.steady_state(pair, supports="rigid")
    with pytest.raises(ParameterError, match=r"stiffness = square: .*pair, rectangular"):
        floquet.single_degree(pair, stiffness="square")
    with pytest.raises(ParameterError, match="rtol"):
        floquet.single_degree(pair, rtol=0.5)
    model = floquet.single_degree(pair)
    with pytest.raises(ParameterError, match=r"friction_load = static: .*dynamic, mean"):
        model.closed_form(friction_load="static")
    with pytest.raises(ParameterError, match="samples_per_cycle"):
        model.motion(3)
    with pytest.raises(ParameterError, match=r"bearing_stiffness.*: .*not on rigid bearings"):
        floquet.single_degree_chart(pair, {"bearing_stiffness": [1e8, 2e8]})
