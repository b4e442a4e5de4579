"""Does the independent model cut the gears of the drawing by its own formulas?"""

import math

import numpy as np
import pytest

from multibody.gears.circles import circles
from multibody.gears.cut_teeth import profile_shifts, root_radius
from tests.unlike_pairs import unlike_pair
from validation.exchange.new_pair_file import new_pair


def drawings():
    """Fifty drawings: a centre distance with no shift, the shift of one gear, or both shifts without it."""
    random = np.random.default_rng(7)
    for number in range(50):
        teeth = tuple(int(n) for n in random.integers(22, 90, 2))
        module = random.choice([1.25, 2.0, 4.0, 7.0])
        alpha = random.choice([17.5, 20.0, 22.5])
        reference = 0.5 * module * sum(teeth)
        changes = {"basic_rack.pressure_angle": alpha, "mesh.stiffness.model": "rectangular"}
        changes |= {"basic_rack.fillet_radius_coefficient": 0.2}
        if number % 3 < 2:
            changes["centre_distance"] = reference + module * random.uniform(-0.2, 0.9)
        if number % 3 > 0:
            changes["gear.profile_shift"] = random.uniform(-0.1, 0.3)
        if number % 3 == 2:
            changes["pinion.profile_shift"] = random.uniform(0.0, 0.5)
        yield teeth, float(module), changes


@pytest.mark.parametrize("drawing", [*drawings()], ids=lambda drawing: f"{drawing[0][0]}_{drawing[0][1]}")
def test_both_models_cut_the_same_gears(drawing):
    teeth, module, changes = drawing
    pair = new_pair(teeth, module, 20.0, 1000.0, 30.0, changes)
    drawn = circles(pair)
    g = pair.geometry
    assert profile_shifts(pair) == pytest.approx(pair.profile_shifts, abs=1e-11)
    for value, expected in (
        (drawn.tip_pinion, g.tip_radius_pinion), (drawn.tip_gear, g.tip_radius_gear),
        (drawn.centre_distance, g.centre_distance), (root_radius(pair, 0), g.root_radius_pinion),
        (root_radius(pair, 1), g.root_radius_gear),
    ):  # fmt: skip
        assert value == pytest.approx(expected, rel=1e-12)


def test_altered_tips_are_those_of_the_file():
    pair = unlike_pair(
        "contact_ratio_1_1_large_shifts"
    )  # its file says 0 where the clearance asks for -0.57 mm
    drawn = circles(pair)
    assert 2e3 * drawn.tip_pinion == pytest.approx(4.0 * (15 + 2 * 0.74 + 2 * 0.75), rel=1e-12)
    shorter = circles(pair.with_({"gear.tip_alteration": -0.1}))
    assert 1e3 * (drawn.tip_gear - shorter.tip_gear) == pytest.approx(0.1, rel=1e-9)
    assert math.isclose(drawn.tip_pinion, shorter.tip_pinion, rel_tol=1e-15)
