"""Are alterations of contact, errors and friction inputs what their words say? Each has its own formula."""

import numpy as np
import pytest

import lumped
from lumped.friction.benedict_kelley import benedict_kelley
from lumped.friction.xu_kahraman import xu_kahraman
from lumped.path_of_contact.friction import contact_path
from lumped.schema.bodies import bodies_of
from tests.unlike_pairs import unlike_pair
from tests.validation.check.motions import lumped_motion
from tests.validation.check.sampled_motions import COULOMB, sampled
from validation.check.explanations.cause import Variant
from validation.check.explanations.physics import Physics, altered_elements, motion_of
from validation.check.explanations.registry import EXPLANATIONS
from validation.check.problem import Problem


@pytest.fixture(scope="module", params=["high_contact_ratio_29_47", "contact_ratio_1_1_large_shifts"])
def pair(request):
    """Two pairs that are unlike each other, with Coulomb friction of 0.06."""
    if request.param.startswith("high"):
        return lumped.load_gear_pair(request.param).with_(COULOMB)
    return unlike_pair(request.param).with_(COULOMB)


@pytest.fixture(scope="module")
def relieved():
    """Tip relief that differs on both gears, linear, with a speed at which its rate counts."""
    return lumped.load_gear_pair("nasa_28_28").with_(
        {
            **COULOMB,
            "operating.pinion_speed": "6000 rpm",
            "pinion.tip_relief": {"amount": "14 um", "start_roll_angle": "25 deg"},
            "gear.tip_relief": {"amount": "9 um", "start_roll_angle": "24 deg"},
        }
    )


@pytest.fixture(scope="module")
def lost():
    """Teeth that lose contact in every mesh cycle, without friction."""
    pair = lumped.load_gear_pair("nasa_art_25_31").healthy
    changes = {"mesh.contact": "prescribed", "mesh.relief": "ignored", "friction.law": "none"}
    return pair.with_({**changes, "mesh.damping_ratio": 0.03})


def choices_of(pair, name):
    """Label -> variant of the fixed values of a cause."""
    motion = lumped_motion(pair)
    problem = Problem.of(pair, sampled(motion), motion)
    found = EXPLANATIONS[name].choices(problem, Variant(pair))
    return {choice.label: choice.variant(Variant(pair)) for choice in found}


def inside(pair, count=41):
    """Positions strictly between A and D."""
    return np.linspace(pair.geometry.L_XA, pair.geometry.L_XD, count + 2)[1:-1]


def total(pair, law, xi):
    """Sum of a law over all pairs."""
    return sum(law(xi + number * pair.geometry.base_pitch) for number in range(-3, 4))


def balances(pair, motion, rel=4e-3):
    """T_p = mean(r_bp N + X_p F): over a mesh cycle inertia averages out.

    Forces jump with a pair that comes or goes: a sum over 256 samples errs by up to a jump over 256.
    """
    load, friction = (motion[key].to_numpy() for key in ("normal_load", "friction_force"))
    moments = pair.geometry.base_radius_pinion * load + motion["position"].to_numpy() * friction
    assert moments.sum(axis=0).mean() == pytest.approx(pair.operating.pinion_torque, rel=rel)


def test_the_kernel_of_contact_forces_has_the_motion_of_the_model(pair):
    """Without relief "no rate of the errors" changes nothing: another integrator, the same motion."""
    own = lumped_motion(pair).motion
    other = motion_of(pair, Physics(contact="no rate of the errors"), None).motion
    for name in ("dte", "theta_g", "x_p", "y_g", "bearing_force_x_p"):
        difference = own[name].to_numpy()[::2] - other[name].to_numpy()  # 512 and 256 samples
        difference -= difference.mean() if name.startswith("theta") else 0.0
        assert np.abs(difference).max() < 2e-3 * np.ptp(own[name].to_numpy()), name


def test_the_kernel_finds_the_motion_that_loses_contact(lost):
    own = lumped_motion(lost).motion
    other = motion_of(lost, Physics(contact="no rate of the errors"), None).motion
    assert own["normal_load"].to_numpy().sum(axis=0).min() == 0.0
    true = own["dte"].to_numpy()[::2]  # 512 and 256 samples
    assert np.abs(true - other["dte"].to_numpy()).max() < 0.02 * np.ptp(true)


@pytest.mark.parametrize(
    ("contact", "exponent"),
    [
        ("exponent 1.5", 1.5),
        ("exponent 10/9", 10 / 9),
        ("exponent 2.2", 2.2),
        ("exponent 1.5 in millimetres", 1.5),
        ("exponent 1.5 of one pair", 1.5),
    ],
)
def test_a_contact_force_with_an_exponent(pair, contact, exponent):
    """N = k d (x/d)^n + c x' with d = F/mean K or 1 mm; the torque balances."""
    motion = motion_of(pair, Physics(contact=contact), None).motion
    laws = altered_elements(pair, Physics())
    position = motion["position"].to_numpy()
    approach, rate = motion["dte"].to_numpy(), motion["dte_dot"].to_numpy()
    force = pair.operating.pinion_torque / pair.geometry.base_radius_pinion
    mean = laws.stiffness.mean() * pair.geometry.contact_ratio
    middle = laws.stiffness(np.array([0.5 * (pair.geometry.L_XA + pair.geometry.L_XD)]))[0]
    reference = {
        "exponent 1.5 in millimetres": 1e-3, "exponent 1.5 of one pair": force / middle
    }.get(contact, force / mean)  # fmt: skip
    spring = laws.stiffness(position) * reference * (approach / reference) ** exponent
    load = motion["normal_load"].to_numpy()
    away = np.abs(np.mod((position - pair.geometry.L_XA) / pair.geometry.base_pitch + 0.5, 1.0) - 0.5) > 2e-2
    away &= np.abs(position - pair.geometry.L_XD) > 2e-2 * pair.geometry.base_pitch
    expected = spring + laws.damping(position) * rate
    assert load[away] == pytest.approx(expected[away], rel=1e-5, abs=1e-3 * load.max())
    balances(pair, motion)


@pytest.mark.parametrize("equal", [False, True])
def test_friction_by_the_static_load_where_relief_keeps_teeth_apart(relieved, equal):
    """F_i = mu_i s_i T_p/r_bp, with shares s_i of all pairs from A to D, also of those that are apart."""
    course = "static load in equal shares" if equal else "static load"
    relieved = relieved.with_({"operating.pinion_torque": 0.4 * relieved.operating.pinion_torque})
    motion = motion_of(relieved, Physics(course=course), None).motion
    perfect = relieved.with_({"mesh.relief": "ignored"})
    k = altered_elements(perfect, Physics()).stiffness(motion["position"].to_numpy())
    weights = np.where(motion["contact"].to_numpy() > 0, 1.0 if equal else k, 0.0)
    force = relieved.operating.pinion_torque / relieved.geometry.base_radius_pinion
    friction = motion["friction_force"].to_numpy()
    mu = motion["mu"].to_numpy()
    assert friction == pytest.approx(mu * weights / weights.sum(axis=0) * force, abs=2e-3 * force * 0.06)
    load = motion["normal_load"].to_numpy()
    assert (np.abs(friction[(load == 0.0) & (weights > 0.0)]) > 0.0).any()
    # m y'' + c y' + k y is the friction: at the mesh frequency. Friction jumps: 256 samples err by 2 %.
    bearing, mass = relieved.bearings.pinion, bodies_of(relieved).mass_pinion
    omega = 2.0 * np.pi / relieved.geometry.mesh_period
    damper = 2.0 * bearing.oloa_damping_ratio * np.sqrt(bearing.oloa_stiffness * mass)
    response = abs(bearing.oloa_stiffness - mass * omega**2 + 1j * omega * damper)
    first, forced = (np.abs(np.fft.rfft(row)[1]) for row in (motion["y_p"].to_numpy(), friction.sum(axis=0)))
    assert response * first == pytest.approx(forced, rel=2e-2)
    balances(relieved, motion)


def test_both_roads_to_friction_by_the_static_load(pair):
    """Where teeth do not part, the linear system and steps of Runge and Kutta have the same motion."""
    linear = motion_of(pair, Physics(course="static load"), None).motion
    steps = motion_of(pair, Physics(contact="friction by the static load"), None).motion
    for name in ("dte", "theta_g", "x_p", "y_g"):
        difference = linear[name].to_numpy()[::2] - steps[name].to_numpy()
        difference -= difference.mean() if name.startswith("theta") else 0.0
        assert np.abs(difference).max() < 2e-3 * np.ptp(linear[name].to_numpy()), name


def test_a_damper_across_the_gap(lost):
    """N = k max(x, 0) + c x' of each pair on its path, also where x < 0; the torque balances."""
    motion = motion_of(lost, Physics(contact="damper across the gap"), None).motion
    laws = altered_elements(lost, Physics())
    position = motion["position"].to_numpy()
    approach, rate = motion["dte"].to_numpy(), motion["dte_dot"].to_numpy()
    expected = laws.stiffness(position) * np.maximum(approach, 0.0) + laws.damping(position) * rate
    away = np.abs(np.mod((position - lost.geometry.L_XA) / lost.geometry.base_pitch + 0.5, 1.0) - 0.5) > 2e-2
    away &= np.abs(position - lost.geometry.L_XD) > 2e-2 * lost.geometry.base_pitch
    load = motion["normal_load"].to_numpy()
    assert load[away] == pytest.approx(expected[away], rel=1e-5, abs=1e-3 * load.max())
    assert approach.min() < 0.0  # teeth are apart, and the damper acts there
    assert load.min() < -1e-2 * load.max()
    balances(lost, motion)


def test_contact_loss_of_the_sum(lost):
    """All pairs are cut together: where their sum is cut each has no load, elsewhere k x + c x'."""
    motion = motion_of(lost, Physics(contact="sum of the pairs"), None).motion
    laws = altered_elements(lost, Physics())
    position = motion["position"].to_numpy()
    approach, rate = motion["dte"].to_numpy(), motion["dte_dot"].to_numpy()
    each = laws.stiffness(position) * approach + laws.damping(position) * rate
    cut = each.sum(axis=0) < 0.0
    assert 0.0 < cut.mean() < 1.0
    load = motion["normal_load"].to_numpy()
    places = np.mod(motion["time"].to_numpy() / lost.geometry.mesh_period, 1.0)
    ends = np.array([0.0, lost.geometry.contact_ratio % 1.0, 1.0])
    away = np.abs(places[:, None] - ends).min(axis=1) > 5e-3
    assert np.abs(load[:, cut & away]).max() == 0.0
    assert load[:, ~cut & away] == pytest.approx(each[:, ~cut & away], rel=1e-5, abs=1e-3 * load.max())
    balances(lost, motion)


def test_dampers_without_the_rate_of_the_relief(relieved):
    """N = k (delta - e) + c delta' in contact, without c e'."""
    relieved = relieved.with_({"mesh.damping_ratio": 0.3})
    motion = motion_of(relieved, Physics(contact="no rate of the errors"), None).motion
    laws = altered_elements(relieved, Physics())
    position = motion["position"].to_numpy()
    approach, rate = motion["dte"].to_numpy(), motion["dte_dot"].to_numpy()
    expected = laws.stiffness(position) * (approach - laws.error(position)) + laws.damping(position) * rate
    load = motion["normal_load"].to_numpy()
    loaded = load > 0.02 * load.max()
    assert load[loaded] == pytest.approx(expected[loaded], rel=1e-2, abs=2e-3 * load.max())
    speed = relieved.geometry.omega_pinion * relieved.geometry.base_radius_pinion
    left_out = laws.damping(position) * laws.error_slope(position) * speed
    assert np.abs(left_out[loaded]).max() > 0.05 * load.max()


def test_relief_at_the_wrong_end(relieved):
    """At A acts the gear's tip (9 um), at D the pinion's (14 um): exchanged, the other way round."""
    g = relieved.geometry
    ends = np.array([g.L_XA, g.L_XD]) + 1e-7 * g.base_pitch * np.array([1.0, -1.0])
    expected = {
        "of the pinion": (23e-6, 0.0),
        "of the gear": (0.0, 23e-6),
        "of both gears": (14e-6, 9e-6),
        "of the pinion on both": (14e-6, 14e-6),
        "of the gear on both": (9e-6, 9e-6),
        "exchanged": (14e-6, 9e-6),
    }
    found = choices_of(relieved, "end of the relief")
    assert set(found) == set(expected)
    for label, variant in found.items():
        error = altered_elements(variant.pair, variant.physics).error
        assert error(ends) == pytest.approx(expected[label], abs=1e-9), label


def test_the_start_of_the_relief_in_other_measures(relieved):
    """The place of the start on the pinion's flank: r_b phi from X, from A, or by lengths and heights."""
    g = relieved.geometry
    base, tip = g.base_radius_pinion, g.tip_radius_pinion
    roll = np.radians(25.0)
    end = np.sqrt(tip**2 - base**2)
    length = end - base * roll
    height = tip - np.hypot(base * roll, base)
    radius = tip - length
    starts = {
        "roll angle from the start of contact": g.L_XA + base * roll,
        "height as a length": end - height,
        "difference of diameters as a length": end - 2.0 * height,
        "length as a height": np.sqrt(radius**2 - base**2),
    }
    for label, variant in choices_of(relieved, "start of the relief").items():
        relief = variant.pair.pinion.tip_relief
        start = end if relief is None else relief.start_roll_angle * base
        assert start == pytest.approx(min(starts[label], end), rel=1e-6), label


def test_relief_that_adds_material(relieved):
    xi = inside(relieved)
    true = altered_elements(relieved, Physics()).error(xi)
    only = {
        gear: altered_elements(relieved.with_({f"{gear}.tip_relief": None}), Physics()).error(xi)
        for gear in ("pinion", "gear")
    }
    for label, variant in choices_of(relieved, "sign of the relief").items():
        expected = {
            "of both gears": -true,
            "of the pinion": only["pinion"] - only["gear"],
            "of the gear": only["gear"] - only["pinion"],
        }[label]
        assert altered_elements(relieved, variant.physics).error(xi) == pytest.approx(expected, abs=1e-11)


def test_one_error_for_all_pairs(relieved):
    """Smallest error, mean by stiffness, that of the newest pair, and mean(K) SUM e/K."""
    g = relieved.geometry
    laws = altered_elements(relieved, Physics())
    xi = inside(relieved, 200)
    places = xi[:, None] + g.base_pitch * np.arange(-2, 3)
    touches = (places >= g.L_XA) & (places <= g.L_XD)
    error = np.where(touches, laws.error(places), np.nan)
    stiffness = np.where(touches, laws.stiffness(places), 0.0)
    whole = stiffness.sum(axis=1)
    newest = np.nanmin(np.where(touches, places, np.nan), axis=1)
    mean = laws.stiffness.mean() * g.contact_ratio
    expected = {
        "smallest": np.nanmin(error, axis=1),
        "mean": np.nansum(error * stiffness, axis=1) / whole,
        "newest pair": laws.error(newest),
        "mean stiffness": mean * np.nansum(error, axis=1) / whole,
    }
    for label, values in expected.items():
        law = altered_elements(relieved, Physics(common_error=label)).error
        assert law(xi) == pytest.approx(values, abs=2e-9), label


def test_fewer_pairs_than_touch(pair):
    """The stiffness of the newest or the oldest pairs is untouched, that of the others 0."""
    g = pair.geometry
    xi = inside(pair, 300)
    true = altered_elements(pair, Physics()).stiffness
    for most in range(1, int(np.ceil(g.contact_ratio))):
        ages = {most: (xi - g.L_XA) / g.base_pitch, -most: (g.L_XD - xi) / g.base_pitch}
        for number, age in ages.items():
            law = altered_elements(pair, Physics(most_pairs=number)).stiffness
            assert law(xi) == pytest.approx(np.where(age < most, true(xi), 0.0), rel=1e-5, abs=1.0)


def test_a_last_stiffness_that_is_held(pair):
    g = pair.geometry
    law = altered_elements(pair, Physics(last_value_held=True)).stiffness
    true = altered_elements(pair, Physics()).stiffness
    last = float(true(np.array([g.L_XD - 1e-8 * g.base_pitch]))[0])
    behind = np.linspace(g.L_XD, g.L_XA + np.ceil(g.contact_ratio) * g.base_pitch, 7)[1:-1]
    assert law(behind) == pytest.approx(last, rel=1e-4)
    assert law(inside(pair)) == pytest.approx(true(inside(pair)), rel=1e-5)


def test_compliances_in_series(pair):
    """1/k' = 1/k + s/mean k; with the bearings 1/K' = 1/K + 1/k_p + 1/k_g of the whole mesh."""
    xi = inside(pair)
    true = altered_elements(pair, Physics()).stiffness
    law = altered_elements(pair, Physics(series=0.4)).stiffness
    assert 1.0 / law(xi) == pytest.approx(1.0 / true(xi) + 0.4 / true.mean(), rel=1e-5)
    law = altered_elements(pair, Physics(bearings_in_series=True)).stiffness
    bearings = pair.bearings
    more = 1.0 / bearings.pinion.loa_stiffness + 1.0 / bearings.gear.loa_stiffness
    assert 1.0 / total(pair, law, xi) == pytest.approx(1.0 / total(pair, true, xi) + more, rel=1e-4)


def test_a_table_that_a_spline_joins(pair):
    """At the entries the mesh has its own stiffness; the curve is smooth where the mesh jumps."""
    g = pair.geometry
    true = altered_elements(pair, Physics()).stiffness
    law = altered_elements(pair, Physics(table=12, table_join="spline")).stiffness
    entries = g.L_XA + (np.arange(12) + 1e-5) / 12 * g.base_pitch
    assert total(pair, law, entries) == pytest.approx(total(pair, true, entries), rel=1e-3)
    near = g.L_XA + np.array([-1e-4, 1e-4]) * g.base_pitch + g.base_pitch
    below, above = total(pair, law, near)
    assert below == pytest.approx(above, rel=5e-3)
    assert abs(np.subtract(*total(pair, true, near))) > 0.05 * above


@pytest.mark.parametrize(("join", "first"), [("steps", 0.0), ("middles", 0.5)])
def test_a_table_of_places_with_friction(pair, join, first):
    """Over a step every pair has stiffness and friction of the place at its start, or in its middle."""
    g = pair.geometry
    own = altered_elements(pair, Physics())
    laws = altered_elements(pair, Physics(table=10, table_join=join, table_of_friction=True))
    step = g.base_pitch / 10
    places = g.L_XA + (np.arange(40) + first + 1e-6) * step
    places = places[places < g.L_XD]
    for share in (0.1, 0.9):
        xi = g.L_XA + (np.arange(places.size) + share) * step
        assert laws.stiffness(xi) == pytest.approx(own.stiffness(places), rel=1e-4)
        assert laws.friction(xi) == pytest.approx(own.friction(places), rel=1e-4)
    assert laws.stiffness.interval[1] == pytest.approx(g.L_XA + places.size * step)


def test_ends_of_a_parabola_by_another_contact_ratio(pair):
    """ISO 6336-1: c_gamma = c' (0.75 eps + 0.25), so that the ends are 0.25 + 0.75/eps of the peak."""
    iso = pair.with_({"mesh.stiffness": {"model": "parabolic"}})
    variant = choices_of(iso, "zones of contact")["circular pitch"]
    g = iso.geometry
    ratio = g.contact_ratio * np.cos(iso.basic_rack.pressure_angle)
    assert variant.pair.mesh.stiffness.end_ratio == pytest.approx(0.25 + 0.75 / ratio)
    given = pair.with_({"mesh.stiffness": {"model": "parabolic", "end_ratio": 0.6}})
    assert choices_of(given, "zones of contact")["circular pitch"].pair.mesh.stiffness.end_ratio == 0.6


@pytest.mark.parametrize(("entries", "at_start"), [(10, 1.0), (-10, 0.0), (-7, 0.0)])
def test_a_table_of_a_tooth_pair(pair, entries, at_start):
    """Straight lines between k at A, A + p/n, ..., zero at the first one behind D; at A if n < 0."""
    g = pair.geometry
    own = altered_elements(pair, Physics()).stiffness
    laws = altered_elements(pair, Physics(pair_table=entries))
    step = g.base_pitch / abs(entries)
    nodes = [g.L_XA]
    while nodes[-1] < g.L_XD:
        nodes.append(nodes[-1] + step)
    values = own(np.array(nodes) + 1e-9 * step)
    values[0] *= at_start
    values[-1] = 0.0
    xi = np.linspace(nodes[0], nodes[-1], 83)[1:-1]
    assert laws.stiffness(xi) == pytest.approx(
        np.interp(xi, nodes, values), rel=1e-5, abs=1e-6 * values.max()
    )
    assert laws.friction.interval == pytest.approx((nodes[0], nodes[-1]))


@pytest.mark.parametrize(("orders", "sign"), [(1, 1.0), (3, -1.0), (-1, 1.0)])
def test_parts_of_the_static_error(pair, orders, sign):
    """F/K - mean(F/K) over a base pitch, or its first mesh orders by a sum of 4000 places."""
    g = pair.geometry
    laws = altered_elements(pair, Physics(static_error=sign, static_orders=orders))
    force = pair.operating.pinion_torque / g.base_radius_pinion
    phase = (np.arange(4000) + 0.5) / 4000
    curve = force / total(pair, laws.stiffness, g.L_XA + phase * g.base_pitch)
    xi = inside(pair)
    expected = force / total(pair, laws.stiffness, xi) - curve.mean()
    if orders > 0:
        turns = 2j * np.pi * np.arange(1, orders + 1)[:, None]
        waves = 2.0 * (curve * np.exp(-turns * phase)).mean(axis=1)
        expected = (waves[:, None] * np.exp(turns * (xi - g.L_XA) / g.base_pitch)).sum(axis=0).real
    assert laws.error(xi) == pytest.approx(sign * expected, abs=2e-3 * np.ptp(curve))


def test_relief_stays_where_the_stiffness_is_altered(relieved):
    """e(xi) is that of the drawing on the old path, and goes on along the flanks on a longer one."""
    own = altered_elements(relieved, Physics()).error
    g = relieved.geometry
    xi = inside(relieved)
    for label in ("reversed", "two levels"):
        variant = choices_of(relieved, "stiffness over the mesh cycle")[label]
        laws = altered_elements(variant.pair, variant.physics)
        assert laws.error(xi) == pytest.approx(own(xi), abs=1e-10)
    longer = altered_elements(relieved, Physics(path_start=-0.1, path_end=0.1))
    assert longer.error(xi) == pytest.approx(own(xi), abs=1e-10)
    beyond = np.array([g.L_XA - 0.05 * g.base_pitch, g.L_XD + 0.05 * g.base_pitch])
    slopes = [9e-6, 14e-6] / np.array(
        [g.L_XY - g.base_radius_gear * np.radians(24.0) - g.L_XA,
         g.L_XD - g.base_radius_pinion * np.radians(25.0)]
    )  # fmt: skip
    expected = np.array([9e-6, 14e-6]) + slopes * 0.05 * g.base_pitch
    assert longer.error(beyond) == pytest.approx(expected, rel=1e-6)


def test_a_constant_stiffness_with_an_excitation(pair):
    """The error e of the constant mesh is F/K - F/mean K, or the force is -(K - mean K) F/mean K."""
    xi = inside(pair)
    true = altered_elements(pair, Physics()).stiffness
    whole = total(pair, true, xi)
    mean = true.mean() * pair.geometry.contact_ratio
    force = pair.operating.pinion_torque / pair.geometry.base_radius_pinion
    expected = {
        "static error": force / whole - force / mean,
        "stiffness as a force": -(whole - mean) / mean * force / mean,
    }
    for label, values in expected.items():
        laws = altered_elements(pair, Physics(excitation=label))
        assert laws.error(xi) == pytest.approx(values, abs=1e-4 * force / mean), label
        assert total(pair, laws.stiffness, xi) == pytest.approx(mean, rel=1e-4)


def test_forces_of_the_step_before(pair):
    """k delta(t - h) is k delta - h k delta' in first order: a damper c - h k."""
    xi = inside(pair)
    true = altered_elements(pair, Physics())
    late = altered_elements(pair, Physics(late_force=0.003))
    delay = 0.003 * pair.geometry.mesh_period
    expected = true.damping(xi) - delay * true.stiffness(xi)
    assert late.damping(xi) == pytest.approx(expected, rel=1e-5)


def test_friction_that_rises_with_the_sliding_velocity(pair):
    path = contact_path(pair)
    xi = inside(pair)
    sliding = (path.omega_pinion + path.omega_gear) * (xi - path.L_XP)
    largest = (path.omega_pinion + path.omega_gear) * max(path.L_XP - path.L_XA, path.L_XD - path.L_XP)
    for field, shape in (("tanh", np.tanh), ("ramp", lambda v: np.clip(v, -1.0, 1.0))):
        law = altered_elements(pair, Physics(**{field: 0.3})).friction
        assert law(xi) == pytest.approx(0.06 * shape(sliding / (0.3 * largest)), abs=1e-7), field


def test_the_coefficient_of_one_pair_for_all(pair):
    g = pair.geometry
    xi = inside(pair, 77)
    newest = xi - np.floor((xi - g.L_XA) / g.base_pitch) * g.base_pitch
    leading = xi + np.floor((g.L_XD - xi) / g.base_pitch) * g.base_pitch
    for name, place in (("newest", newest), ("leading", leading)):
        law = altered_elements(pair, Physics(course=f"coefficient of the {name} pair")).friction
        assert law(xi) == pytest.approx(0.06 * np.sign(place - g.L_XP), abs=1e-6), name


def test_what_a_friction_law_reads(pair):
    """The published formulas with a value that is mistaken."""
    xi = inside(pair, 31)
    sign = np.sign(xi - pair.geometry.L_XP)
    mixed = pair.with_({"friction.law": "benedict_kelley", "friction.coefficient": None})
    path = contact_path(mixed)
    slide, roll = path.sliding_velocity(xi), path.entraining_velocity(xi)
    load, oil, rough = path.unit_load * 1e-3, path.viscosity * 1e3, path.roughness * 1e6
    for label, values in {
        "mean of the rolling velocities": (load, 0.5 * roll),
        "half of the load": (0.5 * load, roll),
        "load per metre": (1e3 * load, roll),
    }.items():
        w, v = values
        expected = sign * benedict_kelley(w, oil, slide, v, rough, maximum=mixed.friction.maximum)
        law = altered_elements(mixed, Physics(friction_input=label)).friction
        assert law(xi) == pytest.approx(expected, rel=1e-6), label
    film = pair.with_({"friction.law": "xu_kahraman", "friction.coefficient": None})
    path = contact_path(film)
    pressure, radius, ratio = path.hertz_pressure(xi) * 1e-9, path.radius(xi), 2.0 * slide / roll
    root = np.sqrt(2.0)
    law = altered_elements(film, Physics(friction_input="radius in millimetres")).friction
    expected = sign * xu_kahraman(pressure, ratio, 0.5 * roll, oil, rough, 1e3 * radius)
    assert law(xi) == pytest.approx(expected, rel=1e-6)
    law = altered_elements(mixed, Physics(friction_input="smooth flanks")).friction
    expected = sign * benedict_kelley(load, oil, slide, roll, 0.0, maximum=mixed.friction.maximum)
    assert law(xi) == pytest.approx(expected, rel=1e-6)
    law = altered_elements(mixed, Physics(friction_input="viscosity in pascal seconds")).friction
    expected = sign * benedict_kelley(load, 1e-3 * oil, slide, roll, rough, maximum=mixed.friction.maximum)
    assert law(xi) == pytest.approx(expected, rel=1e-6)
    for label, (p, sr, v) in {
        "sum of the rolling velocities": (pressure, ratio, roll),
        "sum of the rolling velocities everywhere": (pressure, 0.5 * ratio, roll),
        "half of the slide-to-roll ratio": (pressure, 0.5 * ratio, 0.5 * roll),
        "half of the modulus": (pressure / root, ratio, 0.5 * roll),
        "twice the modulus": (pressure * root, ratio, 0.5 * roll),
    }.items():
        expected = sign * xu_kahraman(p, sr, v, oil, rough, radius)
        law = altered_elements(film, Physics(friction_input=label)).friction
        assert law(xi) == pytest.approx(expected, rel=1e-6), label


def test_inertias_by_other_formulas(pair):
    bodies = bodies_of(pair)
    found = choices_of(pair, "inertia by m r^2")
    disc = 0.5 * bodies.inertia_gear + bodies.mass_gear * pair.gear.face_width**2 / 12.0
    assert bodies_of(found["the gear: about a diameter"].pair).inertia_gear == pytest.approx(disc)
    assert bodies_of(found["both gears: 4, GD^2"].pair).inertia_pinion == pytest.approx(
        4.0 * bodies.inertia_pinion
    )
    assert bodies_of(found["both gears: 0.001"].pair).inertia_gear == pytest.approx(
        1e-3 * bodies.inertia_gear
    )


def test_deviations_that_are_read_in_another_way():
    """f_k = F_k - F_(k-1), the sum of F, and the teeth from the last one on."""
    index = np.random.default_rng(5).normal(size=28)
    pair = lumped.load_gear_pair("nasa_28_28").with_(
        {**COULOMB, "mesh.relief": "ignored", "pinion.deviations": {"index": tuple(4.0 * index)}}
    )
    expected = {
        "single for cumulative": 4.0 * np.append(index[0] - index[-1], np.diff(index)),
        "cumulative for single": 4.0 * np.cumsum(index - index.mean()),
        "numbered backwards": 4.0 * np.append(index[0], index[:0:-1]),
    }
    for label, variant in choices_of(pair, "reading of the deviations").items():
        found = np.array(variant.pair.pinion.deviations.index) * 1e6
        assert found == pytest.approx(expected[label], abs=1e-9), label
