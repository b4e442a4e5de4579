"""Do cracks soften a tooth as plane finite elements say? Spall and chip: multibody/contact/test_own_teeth."""

import math

import numpy as np
import pytest

from lumped.faults.crack import Crack, root_section
from lumped.faults.spall import Spall
from tests.guards.by_hand import ByHand

#: Depth [mm] -> E b times the extra compliance under a load at D, plane finite elements with split nodes,
#: crack square to the centre line, and the edge crack's ratio to it (specification of teeth that differ,
#: section 5).
CRACKS = {0.5: (0.623, 0.84), 1.0: (1.963, 1.00), 2.0: (6.561, 1.20), 3.0: (15.68, 1.39)}


@pytest.mark.parametrize("depth", CRACKS)
def test_edge_crack_beside_finite_elements(nasa, depth):
    flank = nasa.flank(0)
    assert 2e3 * root_section(flank.wheel.tooth)[1] == pytest.approx(6.50, abs=0.005)  # fillet at 30 degrees
    expected, ratio = CRACKS[depth]
    crack = Crack(tooth=1, depth=depth, angle=90)
    at_d, at_p = crack.compliance(flank, np.array([flank.tip, nasa.geometry.L_XP]))
    scale = flank.youngs_modulus * flank.face_width
    assert scale * at_d == pytest.approx(ratio * expected, rel=0.01)
    assert at_p < 0.5 * at_d  # of the square of the arm
    short, shorter = (Crack(tooth=1, depth=d).compliance(flank, flank.tip) for d in (2e-3, 1e-3))
    assert short / shorter == pytest.approx(4.0, rel=0.01)


@pytest.mark.parametrize(("gear_index", "gear"), [(0, "pinion"), (1, "gear")])
def test_a_crack_is_in_the_material_and_width_of_its_gear(unlike, gear_index, gear):
    """24/(E b t^2) S(x) l^2: strip of thickness t under the moment of the load, x = depth sin(angle)/t."""
    wheel = getattr(unlike, gear)
    flank = unlike.flank(gear_index)
    u, half = root_section(flank.wheel.tooth)
    place = np.array([0.9 * flank.tip])
    at_u, at_h, _, angle = flank.wheel.tooth.involute_points(place)
    arm = np.cos(angle) * (at_u - u) - np.sin(angle) * at_h
    x = 0.6e-3 * math.sin(math.radians(50.0)) / (2.0 * half)
    strip = (x / (1.0 - x)) ** 2 * (5.93 - 19.69 * x + 37.14 * x**2 - 35.84 * x**3 + 13.12 * x**4)  # Tada
    width = min(unlike.pinion.face_width, unlike.gear.face_width)
    expected = 24.0 / (wheel.youngs_modulus * width * (2.0 * half) ** 2) * strip * arm**2
    compliance = Crack(tooth=1, depth=0.6, angle=50).compliance(flank, place)
    np.testing.assert_allclose(compliance, expected, rtol=1e-12)


@pytest.mark.parametrize(("gear_index", "gear"), [(0, "pinion"), (1, "gear")])
def test_a_pit_narrows_the_contact_of_both_materials(unlike, gear_index, gear):
    """2/pi sum((1 - nu^2)/E) over the width b - w in the place of b, between its roll angles."""
    flank = unlike.flank(gear_index)
    hand = ByHand(unlike, gear)
    width = min(unlike.pinion.face_width, unlike.gear.face_width)
    low, high = hand.roll(0.3 * hand.tip_length), hand.roll(0.6 * hand.tip_length)
    pit = Spall(tooth=1, start_roll_angle=low, end_roll_angle=high, width=250.0 * width)  # mm: a quarter
    places = 1e-3 * hand.tip_length * np.array([0.299, 0.301, 0.599, 0.601])
    plane = sum((1.0 - one.poisson_ratio**2) / one.youngs_modulus for one in (unlike.pinion, unlike.gear))
    more = 2.0 / math.pi * plane * (1.0 / (0.75 * width) - 1.0 / width)
    np.testing.assert_allclose(pit.compliance(flank, places), [0.0, more, more, 0.0], rtol=1e-12)
