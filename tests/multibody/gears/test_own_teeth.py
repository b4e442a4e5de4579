"""Do both models read the same errors of teeth from the schema, each by formulas of its own?"""

import itertools
import math

import numpy as np
import pytest

from lumped.schema.meeting_teeth import first_teeth
from lumped.schema.tooth_errors import tooth_errors
from lumped.schema.torque_ripples import ripples
from multibody.gears.circles import circles
from multibody.gears.own_teeth import drawn_gears, gear_teeth, own_ripples
from tests.unlike_pairs import unlike_pair

_RNG = np.random.default_rng(3)
INDEX, SLOPE, RELIEF = ([list(np.round(3.0 * _RNG.normal(size=z), 3)) for z in (20, 30)] for _ in range(3))


def with_own_teeth(first_order, counted, drawn):
    """A pair whose gears differ in everything that teeth may differ by."""
    changes = {
        "mesh.first_teeth": [5, 24],
        "operating.torque_ripple": [
            {"shaft": "gear", "order": 3, "amplitude": 8, "phase": 40},
            {"shaft": "pinion", "order": 2, "amplitude": 3, "phase": 10},
        ],
    }
    for i, name in enumerate(("pinion", "gear")):
        index = {"tolerance_class": 5 + i, "seed": 3 + i} if drawn else {"index": INDEX[i]}
        material = {"profile_slope": SLOPE[i], "tip_relief": np.abs(RELIEF[i]).tolist()}
        changes[f"{name}.deviations"] = index | material | {"first_order": first_order, "counted": counted}
        if first_order == "steps":
            changes[f"{name}.mounting"] = {"eccentricity": 7 + i, "phase": 40 + i}
    return unlike_pair("unlike_teeth_finite_elements").with_(changes)


@pytest.mark.parametrize(
    ("first_order", "counted", "drawn"),
    list(itertools.product(("steps", "eccentricity"), ("with", "against"), (True, False))),
)
def test_both_models_read_the_same_teeth(first_order, counted, drawn):
    pair = with_own_teeth(first_order, counted, drawn)
    gears = drawn_gears(pair, circles(pair))
    for number, (theirs, first) in enumerate(zip(tooth_errors(pair), first_teeth(pair), strict=True)):
        ours = gear_teeth(pair, gears[number])
        flank = pair.flank(number)
        np.testing.assert_allclose(ours.gap, theirs.error, rtol=0.0, atol=1e-18)
        np.testing.assert_allclose(ours.rise, -theirs.slope / (flank.tip - flank.start), rtol=1e-12)
        np.testing.assert_array_equal(ours.relief, theirs.relief)
        assert ours.eccentricity == pytest.approx(theirs.eccentricity, rel=1e-12)
        angle = theirs.phase + 2.0 * math.pi * first / theirs.error.size
        assert math.remainder(ours.angle - angle, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-12)
        assert ours.first == first
    for ours, (shaft, angle, phase, amplitude, teeth) in zip(
        own_ripples(pair, gears), ripples(pair), strict=True
    ):
        assert (ours.gear, ours.amplitude) == (shaft, amplitude)
        assert 2.0 * math.pi * ours.order / teeth == pytest.approx(angle, rel=1e-12)
        assert math.remainder(ours.phase - phase, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-12)
