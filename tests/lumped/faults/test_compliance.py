"""Do cracks soften a tooth as plane finite elements say, and spalls take the Hertzian contact's share?"""

import numpy as np
import pytest

from lumped.faults.chip import Chip
from lumped.faults.crack import Crack, root_section
from lumped.faults.spall import Spall

#: Depth [mm] -> E b times the extra compliance under a load at D, plane finite elements with split nodes,
#: crack square to the centre line, and the edge crack's ratio to it (specification of teeth that differ,
#: section 5).
CRACKS = {0.5: (0.623, 0.84), 1.0: (1.963, 1.00), 2.0: (6.561, 1.20), 3.0: (15.68, 1.39)}


def test_root_is_6_5_mm_thick_where_the_fillet_is_at_30_degrees(nasa):
    assert 2e3 * root_section(nasa.flank(0).wheel.tooth)[1] == pytest.approx(6.50, abs=0.005)


@pytest.mark.parametrize("depth", CRACKS)
def test_edge_crack_beside_finite_elements(nasa, depth):
    flank = nasa.flank(0)
    expected, ratio = CRACKS[depth]
    crack = Crack(tooth=1, depth=depth, angle=90)
    at_d, at_p = crack.compliance(flank, np.array([flank.tip, nasa.geometry.L_XP]))
    scale = flank.youngs_modulus * flank.face_width
    assert scale * at_d == pytest.approx(ratio * expected, rel=0.01)
    assert at_p < 0.5 * at_d  # of the square of the arm
    short, shorter = (Crack(tooth=1, depth=d).compliance(flank, flank.tip) for d in (2e-3, 1e-3))
    assert short / shorter == pytest.approx(4.0, rel=0.01)


def test_an_inclined_crack_counts_by_its_depth_across_the_tooth(nasa):
    flank, place = nasa.flank(0), np.array([nasa.geometry.L_XD])
    inclined = Crack(tooth=1, depth=2.0, angle=30).compliance(flank, place)
    assert inclined == pytest.approx(Crack(tooth=1, depth=1.0, angle=90).compliance(flank, place), rel=1e-12)


def test_spall_and_chip(nasa):
    flank = nasa.flank(1)
    places = np.radians([17.9, 18.1, 21.9, 22.1]) * flank.wheel.tooth.base_radius
    spall = {"tooth": 1, "start_roll_angle": 18, "end_roll_angle": 22, "pit_depth": 30}
    half = Spall(**spall, width=0.5e3 * flank.face_width)
    # Half the width carries the load: the Hertzian compliance doubles.
    assert half.compliance(flank, places) == pytest.approx(flank.hertz * np.array([0, 1, 1, 0]), rel=1e-12)
    assert not half.gap(flank, places).any()
    whole = Spall(**spall)
    assert whole.gap(flank, places) == pytest.approx([0.0, 30e-6, 30e-6, 0.0])
    assert Chip(tooth=1, roll_angle=20).end(flank) == pytest.approx(
        np.radians(20) * flank.wheel.tooth.base_radius
    )


@pytest.mark.parametrize(("fault", "field", "allowed"), [
    ({"kind": "crack", "tooth": 1, "depth": 3.5, "angle": 90}, "depth", "half the root"),
    ({"kind": "chip", "tooth": 1, "roll_angle": 40}, "roll_angle", "deg"),
    ({"kind": "spall", "tooth": 1, "start_roll_angle": 18, "end_roll_angle": 22, "width": 7}, "width",
     "6.35 mm"),
])  # fmt: skip
def test_what_does_not_fit_the_tooth_is_refused(nasa, fault, field, allowed):
    with pytest.raises(ValueError, match=rf"pinion\.faults\.0\.{field}.*{allowed}"):
        nasa.with_({"pinion.faults": [fault]})
