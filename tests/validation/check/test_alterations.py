"""Are the alterations of the model what their words say? Each is compared with a formula, not with itself."""

import numpy as np
import pytest

import lumped
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


def places(pair):
    """Positions inside the path of contact, and whether no pair is ahead at each."""
    g = pair.geometry
    xi = np.linspace(g.L_XA, g.L_XD, 203)[1:-1]
    return xi, xi + g.base_pitch > g.L_XD


def variant_of(pair, name, label):
    """The variant of a pair with a fixed value."""
    motion = lumped_motion(pair)
    problem = Problem.of(pair, sampled(motion), motion)
    choices = EXPLANATIONS[name].choices(problem, Variant(pair))
    return next(one for one in choices if one.label == label).variant(Variant(pair))


@pytest.mark.parametrize(
    ("label", "power"), [("times the module", 1), ("over the module as millimetres", -1)]
)
def test_tips_of_shifts_in_another_unit(label, power):
    """r_a1 = a - m z2/2 + m (h_a - x2): the bottom clearance of the rack is kept (ISO 21771)."""
    module, addendum, shifts = 1.75, 0.9, (0.2, -0.1)
    pair = lumped.load_gear_pair("high_contact_ratio_29_47").with_(
        {
            **COULOMB,
            "basic_rack.module": module,
            "basic_rack.addendum_coefficient": addendum,
            "pinion.profile_shift": shifts[0],
            "gear.profile_shift": shifts[1],
            **{
                f"{gear}.{size}": None for gear in ("pinion", "gear") for size in ("addendum", "tip_diameter")
            },
            "centre_distance": None,
        }
    )
    changed = variant_of(pair, "profile shifts", f"{label}, centre kept").pair
    assert changed.geometry.centre_distance == pytest.approx(pair.geometry.centre_distance, rel=1e-12)
    for gear, teeth, shift in (("pinion", 47, shifts[1]), ("gear", 29, shifts[0])):
        radius = 1e3 * pair.geometry.centre_distance - 0.5 * module * teeth
        radius += module * (addendum - shift * module**power)
        assert 1e3 * getattr(changed.geometry, f"tip_radius_{gear}") == pytest.approx(radius, rel=1e-9)


def test_friction_over_the_path(pair):
    """mu is -0.06 before the pitch point and 0.06 behind it (Coulomb, s = sgn(xi - L_XP))."""
    xi, leads = places(pair)
    sign = np.sign(xi - pair.geometry.L_XP)
    expected = {
        "without reversal": 0.06 + 0.0 * xi,
        "leading pair": np.where(leads, 0.06 * sign, 0.0),
        "newest pair": np.where(xi - pair.geometry.base_pitch < pair.geometry.L_XA, 0.06 * sign, 0.0),
        "": 0.06 * sign,
    }
    for course, values in expected.items():
        law = altered_elements(pair, Physics(course=course)).friction
        assert law(xi) == pytest.approx(values, abs=1e-9), course


def total_of(pair, law):
    """Sum of a law over all pairs, at positions of one of them."""
    xi, _ = places(pair)
    return sum(law(xi + number * pair.geometry.base_pitch) for number in range(-3, 4))


def test_total_load_on_the_leading_pair(pair):
    xi, leads = places(pair)
    stiffness = altered_elements(pair, Physics()).stiffness
    law = altered_elements(pair, Physics(course="total load on the leading pair")).friction
    sign = np.sign(xi - pair.geometry.L_XP)
    expected = np.where(leads, 0.06 * sign * total_of(pair, stiffness) / stiffness(xi), 0.0)
    assert law(xi) == pytest.approx(expected, rel=1e-4, abs=1e-9)
    law = altered_elements(pair, Physics(course="total load on the newest pair")).friction
    newest = xi - pair.geometry.base_pitch < pair.geometry.L_XA
    expected = np.where(newest, 0.06 * sign * total_of(pair, stiffness) / stiffness(xi), 0.0)
    assert law(xi) == pytest.approx(expected, rel=1e-4, abs=1e-9)


def test_stiffness_over_the_mesh_cycle(pair):
    """The mean of the whole mesh stays; one harmonic is a cosine; each pair has the stiffness of the mesh."""
    true = altered_elements(pair, Physics()).stiffness
    whole = total_of(pair, true)
    for_each = altered_elements(pair, Physics(stiffness="whole mesh for each pair")).stiffness
    assert for_each(places(pair)[0]) == pytest.approx(whole, rel=1e-5)
    g = pair.geometry
    phase = (np.arange(256) + 0.5) / 256
    for name, most in (("first harmonic", 1), ("three harmonics", 3), ("two levels", 128)):
        law = altered_elements(pair, Physics(stiffness=name)).stiffness
        total = sum(law(g.L_XA + (phase + number) * g.base_pitch) for number in range(3))
        right = sum(true(g.L_XA + (phase + number) * g.base_pitch) for number in range(3))
        waves, original = np.fft.rfft(total), np.fft.rfft(right)
        assert waves[0] == pytest.approx(original[0], rel=2e-3)
        assert np.abs(waves[most + 1 :]).max(initial=0.0) < 1e-3 * abs(waves[0])
        if most in (1, 3):
            assert np.abs(waves[1] - original[1]) < 2e-2 * abs(original[1])


@pytest.mark.parametrize("window", [0.1, 0.35])
def test_a_smoothed_stiffness_is_a_moving_average_of_that_of_the_mesh(pair, window):
    g = pair.geometry
    phase = (np.arange(512) + 0.5) / 512
    true, law = (
        altered_elements(pair, physics).stiffness for physics in (Physics(), Physics(smoothing=window))
    )
    right, total = (
        sum(one(g.L_XA + (phase + number) * g.base_pitch) for number in range(3)) for one in (true, law)
    )
    half = round(0.5 * window * 512)
    average = np.mean([np.roll(right, shift) for shift in range(-half, half + 1)], axis=0)
    assert total == pytest.approx(average, rel=0.03)  # 30 harmonics: corners are rounded


@pytest.mark.parametrize("factor", [0.4, 1.3])
def test_the_variation_of_the_stiffness_about_its_mean(pair, factor):
    g = pair.geometry
    phase = (np.arange(256) + 0.5) / 256
    true, law = (
        altered_elements(pair, physics).stiffness for physics in (Physics(), Physics(variation=factor))
    )
    right, total = (
        sum(one(g.L_XA + (phase + number) * g.base_pitch) for number in range(3)) for one in (true, law)
    )
    mean = right.mean()
    assert total == pytest.approx(mean + factor * (right - mean), rel=2e-3)
    exchanged = altered_elements(pair, Physics(stiffness="levels exchanged")).stiffness
    total = sum(exchanged(g.L_XA + (phase + number) * g.base_pitch) for number in range(3))
    assert total == pytest.approx(right.max() + right.min() - right, rel=2e-3)


@pytest.mark.parametrize("course", ["pitch point of the rack", "middle of the path"])
def test_friction_that_reverses_at_another_place(course):
    shifted = unlike_pair("contact_ratio_1_1_large_shifts").with_(COULOMB)
    g = shifted.geometry
    law = altered_elements(shifted, Physics(course=course)).friction
    rack = g.base_radius_pinion * np.tan(shifted.basic_rack.pressure_angle)
    place = rack if course.startswith("pitch") else 0.5 * (g.L_XA + g.L_XD)
    assert abs(place - g.L_XP) > 0.01 * g.base_pitch
    true = altered_elements(shifted, Physics()).friction
    xi = np.linspace(g.L_XA, g.L_XD, 102)[1:-1]
    assert law(xi) == pytest.approx(np.sign(xi - place) * np.abs(true(xi)), rel=1e-5)


def test_a_profile_error_at_the_mesh_frequency(pair):
    g = pair.geometry
    law = altered_elements(pair, Physics(error_cosine=3e-6, error_sine=-4e-6)).error
    xi = np.linspace(g.L_XA, g.L_XD, 102)[1:-1]
    angle = 2.0 * np.pi * (xi - g.L_XA) / g.base_pitch
    true = altered_elements(pair, Physics()).error
    assert law(xi) - true(xi) == pytest.approx(3e-6 * np.cos(angle) - 4e-6 * np.sin(angle), abs=1e-11)


def test_added_relief_is_removed_at_both_tips(pair):
    """Teeth come too late by the amount where a tip touches: at A by that of the gear, at D of the pinion."""
    cause = EXPLANATIONS["relief added"]
    relieved = cause.change(Variant(pair), 0.7).pair
    g = relieved.geometry
    error = altered_elements(relieved, Physics()).error
    step = 1e-6 * g.base_pitch
    assert error(np.array([g.L_XA + step, g.L_XD - step])) == pytest.approx([7e-6, 7e-6], rel=1e-3)
    assert error(np.array([0.5 * (g.L_XA + g.L_XD)])) == pytest.approx([0.0], abs=1e-12)
    assert cause.shown(0.7) == pytest.approx(7.0)


def test_roles(pair):
    """The gear drives with the same power, and the mesh frequency stays."""
    after = variant_of(pair, "driving gear", "the gear at its speed, called pinion").pair
    before = pair.geometry
    assert after.geometry.base_radius_pinion == pytest.approx(before.base_radius_gear)
    assert after.geometry.mesh_period == pytest.approx(before.mesh_period)
    forces = [one.operating.pinion_torque / one.geometry.base_radius_pinion for one in (pair, after)]
    assert forces[0] == pytest.approx(forces[1])


def test_a_static_curve_is_load_over_stiffness(pair):
    """Without inertia and friction: dte = F/K."""
    smooth = pair.with_({"friction.law": "none", "bearings.stiffness": 1e12})
    variant = variant_of(smooth, "static curve", "static")
    motion = motion_of(variant.pair, variant.physics, None)
    force = pair.operating.pinion_torque / pair.geometry.base_radius_pinion
    expected = force / motion.samples("mesh_stiffness")
    # Behind each jump of the stiffness the motion still rings at orders above the natural frequency.
    waves, static = (np.fft.rfft(values)[1:7] for values in (motion.samples("dte"), expected))
    assert np.linalg.norm(waves - static) < 0.05 * np.linalg.norm(static)


#: Label -> diameters of both bores by those of the pair.
BORES = {
    "without bore": lambda pinion, gear: (0.0, 0.0),
    "without bore: pinion": lambda pinion, gear: (0.0, gear),
    "without bore: gear": lambda pinion, gear: (pinion, 0.0),
    "bores exchanged": lambda pinion, gear: (gear, pinion),
    "bore as a radius": lambda pinion, gear: (2.0 * pinion, 2.0 * gear),
    "half of the bore": lambda pinion, gear: (0.5 * pinion, 0.5 * gear),
}


@pytest.mark.parametrize("label", BORES)
def test_discs_of_other_bores(label):
    """m = pi rho b (r^2 - r_b^2) and J = m (r^2 + r_b^2)/2, with the reference radius r = m_n z/2."""
    bored = {"pinion.bore": 20, "gear.bore": 47}
    pair = unlike_pair("contact_ratio_1_1_large_shifts").with_(COULOMB | bored)
    changed = variant_of(pair, "radius of the discs", label).pair
    bores = BORES[label](0.020, 0.047)
    # As in the file of the pair: teeth, face width, density.
    gears = {"pinion": (15, 0.042, 7850.0), "gear": (52, 0.038, 7700.0)}
    for (name, (teeth, width, density)), bore in zip(gears.items(), bores, strict=True):
        r, hole = 0.004 * teeth / 2.0, bore / 2.0
        mass = np.pi * density * width * (r**2 - hole**2)
        assert getattr(changed, name).mass == pytest.approx(mass, rel=1e-12)
        assert getattr(changed, name).inertia == pytest.approx(mass * (r**2 + hole**2) / 2.0, rel=1e-12)
