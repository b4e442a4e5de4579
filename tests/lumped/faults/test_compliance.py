"""Do cracks soften a tooth as plane finite elements say? Spall and chip: multibody/contact/test_own_teeth."""

import numpy as np
import pytest

from lumped.faults.crack import Crack, root_section

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
