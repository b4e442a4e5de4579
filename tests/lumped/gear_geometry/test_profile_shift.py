"""Do profile shifts, centre distance and tips belong to the gears of a drawing?"""

import math

import numpy as np
import pytest

from lumped import ParameterError, load_gear_pair
from lumped.gear_geometry.profile_shift import (
    distance_without_backlash,
    resolved_shifts,
    shared,
    shift_sum,
    tip_alteration,
)
from tests.unlike_pairs import UNLIKE, unlike_pair
from validation.exchange.new_pair_file import new_pair

#: 12/24 of module 3 with the shifts 0.6 and 0.36, a manufacturer's worked example: printed tip diameters and
#: centre distance [mm], contact ratio.
WORKED = {"tips": (44.840, 79.400), "centre_distance": 56.4999, "contact_ratio": 1.202}


#: Unlike pairs whose files leave the tips to the program.
WITHOUT_TIPS = [name for name in UNLIKE if unlike_pair(name).pinion.tip_alteration is None]


def drawn(teeth, module, **changes):
    return new_pair(teeth, module, 20.0, 1000.0, 30.0, changes)


def test_a_sum_becomes_a_centre_distance_and_the_sum_again():
    random = np.random.default_rng(48)
    for _ in range(500):
        teeth = int(random.integers(20, 400))
        module = 10.0 ** random.uniform(-4.0, -2.0)
        alpha = math.radians(random.uniform(14.5, 30.0))
        # From nearly overlapping base circles to teeth that stand on their tips.
        least = -0.5 * teeth * (math.tan(alpha) - alpha) / math.tan(alpha)
        total = random.uniform(max(0.9 * least, -3.0), 4.0)
        centre = distance_without_backlash(teeth, module, alpha, total)
        assert shift_sum(teeth, module, alpha, centre) == pytest.approx(total, rel=0.0, abs=1e-12 * teeth)
        again = distance_without_backlash(teeth, module, alpha, shift_sum(teeth, module, alpha, centre))
        assert again == pytest.approx(centre, rel=1e-12)


@pytest.mark.parametrize("teeth", ["27/43", "53/29"])
@pytest.mark.parametrize("total", [0.8, -0.3])
def test_a_pair_without_shifts_has_those_of_its_centre_distance(teeth, total):
    numbers = tuple(map(int, teeth.split("/")))
    centre = distance_without_backlash(sum(numbers), 2.5e-3, math.radians(20.0), total)
    pair = drawn(teeth, 2.5, **{"centre_distance": 1e3 * centre, "mesh.backlash": 0.0})
    assert sum(pair.profile_shifts) == pytest.approx(total, abs=1e-12)
    assert pair.geometry.normal_backlash == pytest.approx(0.0, abs=1e-15)
    # The gear with fewer teeth gets more of a positive sum and less of a negative one, neither all nor none.
    small = numbers.index(min(numbers))
    assert 0.5 < (pair.profile_shifts[small] if total > 0 else pair.profile_shifts[1 - small]) / total < 1.0
    # With one shift of the drawing the other has no choice: it is no assumption.
    one = pair.with_({"gear.profile_shift": 0.1})
    assert one.profile_shifts == pytest.approx((total - 0.1, 0.1), abs=1e-12)
    assert "pinion.profile_shift" in pair.assumed
    assert "pinion.profile_shift" not in one.assumed


def test_sums_are_shared_by_the_numbers_of_teeth():
    assert shared(0.0, (17, 60)) == (0.0, 0.0)
    assert shared(1.0, (20, 60)) == (0.75, 0.25)
    assert shared(-1.0, (20, 60)) == (-0.25, -0.75)
    assert resolved_shifts((None, None), (17, 60), 1e-3, 0.35, None) == (0.0, 0.0)


def test_the_worked_example_has_its_printed_tips_and_contact_ratio():
    pair = drawn("12/24", 3.0, **{"pinion.profile_shift": 0.6, "gear.profile_shift": 0.36})
    assert [2e3 * wheel.tip_radius for wheel in pair.wheels] == pytest.approx(WORKED["tips"], abs=0.5e-3)
    assert pair.geometry.centre_distance * 1e3 == pytest.approx(WORKED["centre_distance"], abs=0.5e-4)
    assert pair.geometry.contact_ratio == pytest.approx(WORKED["contact_ratio"], abs=0.5e-3)
    # Without alteration it has the contact ratio that a gear program would not have: 1.348.
    unaltered = pair.with_({"pinion.tip_alteration": 0, "gear.tip_alteration": 0})
    assert unaltered.geometry.contact_ratio == pytest.approx(1.348, abs=0.5e-3)


@pytest.mark.parametrize("name", WITHOUT_TIPS)
def test_the_clearance_is_that_of_the_rack(name):
    pair = unlike_pair(name)
    rack = pair.basic_rack
    g = pair.geometry
    clearance = rack.module * (rack.dedendum_coefficient - rack.addendum_coefficient)
    assert g.centre_distance - g.tip_radius_pinion - g.root_radius_gear == pytest.approx(clearance, rel=1e-9)
    assert g.centre_distance - g.tip_radius_gear - g.root_radius_pinion == pytest.approx(clearance, rel=1e-9)


def test_tips_are_not_lengthened_and_one_size_of_them_is_enough():
    pair = load_gear_pair("high_contact_ratio_29_47").with_(centre_distance=95.4)  # wider than its shifts
    assert pair.tip_alteration == 0.0
    assert tip_alteration(95.4e-3, 2.5e-3, 76, 0.08) == 0.0
    unaltered = 2.5 * (29 + 2 * 1.35 + 2 * 0.12)
    for size, value, tip in (
        ("tip_alteration", -0.3, unaltered - 0.6), ("tip_diameter", 79.0, 79.0),
        ("addendum", 3.2, 72.5 + 6.4),
    ):  # fmt: skip
        varied = pair.with_({f"pinion.{size}": value})
        assert 2e3 * varied.wheels[0].tip_radius == pytest.approx(tip, rel=1e-12)
        assert varied.wheels[1] == pair.wheels[1]
        assert "pinion.tip_alteration" not in varied.assumed
        assert "gear.tip_alteration" in varied.assumed
    with pytest.raises(ParameterError, match="one of addendum, tip_diameter, tip_alteration"):
        load_gear_pair(pair.to_mapping() | {"pinion": pair.to_mapping()["pinion"] | {
            "tip_alteration": -0.1, "tip_diameter": 79.0}})  # fmt: skip


@pytest.mark.parametrize(("sizes", "texts"), [
    # A drawing of 47/50, module 2.5 on 122 mm beside the shifts of another pair.
    ({"pinion.profile_shift": 0, "gear.profile_shift": 0}, ("shifts 0 and 0", "121.25 mm", "0.3069")),
    # inv(alpha_w) of sum(x) = 1: alpha_w = 23.6826 deg, a = 121.25 cos(20 deg)/cos(alpha_w).
    ({"pinion.profile_shift": 0.6, "gear.profile_shift": 0.4}, ("wedge", "shifts 0.6 and 0.4", "0.3069")),
])  # fmt: skip
def test_a_contradiction_says_both_values_and_what_each_would_give(sizes, texts):
    with pytest.raises(ParameterError) as caught:
        drawn("47/50", 2.5, **{"centre_distance": 122} | sizes)
    (problem,) = caught.value.problems
    assert problem.field == "centre_distance"
    for text in texts:
        assert text in str(problem)


def test_a_centre_distance_of_no_gears_says_what_it_asks_for():
    with pytest.raises(ParameterError, match=r"profile shifts .* without backlash.*121\.25 mm asks for none"):
        drawn("47/50", 2.5, centre_distance=135)
