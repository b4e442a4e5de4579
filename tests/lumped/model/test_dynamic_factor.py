"""K_v of ISO 6336-1:2006, method B, by hand on two pairs with unlike gears."""

import math

import pytest

from lumped import stiffness_components
from lumped.model.dynamic_factor import iso_dynamic_factor
from lumped.path_of_contact import pair_stiffness
from lumped.path_of_contact.stiffness import WITHOUT_FACTORS
from lumped.stiffness.iso6336 import pair_single_stiffness
from tests.guards.by_hand import ByHand, Contact
from tests.unlike_pairs import unlike_pair


def by_hand(pair):
    """N = n/n_E and B_p, B_f, B_k of clause 6.5, in N, mm, um; tolerances of ISO 1328-1:2013, class 6."""
    pinion, gear = ByHand(pair, "pinion"), ByHand(pair, "gear")
    width = 1e3 * Contact(pair).width
    ratio = (pinion.tip_length - pinion.start_length) / pinion.base_pitch
    single = pair_single_stiffness(pair)  # tests/lumped/stiffness/test_call_sites
    inertia = []
    for hand in (pinion, gear):
        wheel = getattr(pair, hand.gear)
        radius = 1e-3 * hand.r
        mass = wheel.density * math.pi * (radius**2 - 0.25 * wheel.bore**2) * wheel.face_width
        inertia.append(0.5 * mass * (radius**2 + 0.25 * wheel.bore**2) / (1e-3 * hand.r_b) ** 2)
    reduced = inertia[0] * inertia[1] / sum(inertia) / width  # kg/mm
    resonance = 30000.0 / (math.pi * pinion.z) * math.sqrt(single * (0.75 * ratio + 0.25) / reduced)
    n = pair.operating.pinion_speed * 30.0 / math.pi / resonance
    load = 1e3 * pair.operating.pinion_torque / pinion.r / width
    larger = 2.0 * max(pinion.r, gear.r)
    pitch = (0.001 * larger + 0.4 * pinion.m + 5.0) * math.sqrt(2.0) * math.cos(pinion.alpha)
    profile = (0.55 * pinion.m + 5.0) * math.sqrt(2.0)
    b_p, b_f = (single * 0.925 * deviation / load for deviation in (pitch, profile))
    return n, b_p, b_f, load


def test_below_the_resonance():
    """23/38: K_v = N (0.32 B_p + 0.34 B_f + 0.23 B_k) + 1, contact ratio up to 2; B_k = 1 without relief."""
    pair = unlike_pair("rack_25_degrees_always_pushing")
    n, b_p, b_f, load = by_hand(pair)
    assert load >= 100.0
    assert n <= 0.85
    dynamic_factor = iso_dynamic_factor(pair)
    assert (dynamic_factor.zone, dynamic_factor.resonance_ratio) == (
        "subcritical",
        pytest.approx(n, rel=1e-9),
    )
    assert dynamic_factor.factor == pytest.approx(n * (0.32 * b_p + 0.34 * b_f + 0.23) + 1.0, rel=1e-9)


def test_at_the_resonance_the_larger_gear_may_drive():
    """43 teeth drive 22, at N = 1: K_v = 0.32 B_p + 0.34 B_f + 0.90 B_k + 1, and f_p of the 43 teeth."""
    slow = unlike_pair("larger_gear_drives_contact_lost")
    n, b_p, b_f, _ = by_hand(slow)
    pair = slow.with_(speed=slow.operating.pinion_speed.to("rpm") / n)
    dynamic_factor = iso_dynamic_factor(pair)
    assert (dynamic_factor.zone, dynamic_factor.resonance_ratio) == (
        "main resonance",
        pytest.approx(1.0, rel=1e-9),
    )
    assert dynamic_factor.factor == pytest.approx(0.32 * b_p + 0.34 * b_f + 0.90 + 1.0, rel=1e-9)


def test_a_factor_on_the_model_s_stiffness_changes_no_number_of_the_standard():
    """K_v and the components of the method have stiffnesses of their own; a stiffer pair is another curve."""
    pair = unlike_pair("rack_25_degrees_always_pushing")
    stiffer = pair.with_(mesh__stiffness_factor=1.3)  # every other factor acts by the same function
    assert iso_dynamic_factor(stiffer) == iso_dynamic_factor(pair)
    ours, theirs = (stiffness_components(one) for one in (stiffer, pair))
    assert (ours.stiffness.to_numpy() == theirs.stiffness.to_numpy()).all()
    assert all(WITHOUT_FACTORS in ours[name].attrs["note"] for name in ours)
    xi = theirs.position.to_numpy()[3:-3]
    assert pair_stiffness(stiffer)(xi) == pytest.approx(1.3 * pair_stiffness(pair)(xi), rel=1e-14)
