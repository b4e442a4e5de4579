"""Are the slopes of reliefs those of the profile, and 0 where reliefs end or do not reach?"""

import numpy as np
import pytest

from lumped.mesh.unloaded import RELIEF, relief_slopes
from lumped.model.tooth_laws import _Differences

#: Flanks from A to D, and the pinion's relief from 0.018 m on, whose amount is reached at 0.024 m [m].
ENDS = (0.010, 0.022)
RADIUS = 0.030
START, END = 0.018, 0.024
AMOUNT = 12e-6
NODES = np.array([0.0, 0.5, 1.0])


def slopes_at(xi, parabolic):
    relief = np.array([(AMOUNT, START / RADIUS, END / RADIUS, parabolic, RADIUS, 0.0, 1.0)], RELIEF)
    position = np.asarray(xi)[:, None, None] + np.zeros((1, NODES.size, 1))
    at_nodes = _Differences.at_nodes(NODES, 2e-8)
    return relief_slopes(relief, *ENDS, position, at_nodes.offsets, at_nodes.weights)[:, :, 0]


@pytest.mark.parametrize("parabolic", [0.0, 1.0])
def test_slope_of_the_profile(parabolic):
    """d(C s^n)/dxi, s = (xi - start)/(end - start); differences of second order are exact for a parabola."""
    xi = np.array([0.0190, 0.0205, 0.0219])
    s = (xi - START) / (END - START)
    exact = AMOUNT / (END - START) * (2.0 * s if parabolic else np.ones(3))
    # Rounding of a gap, 2e-21 m, over the distance: 1e-13 of a slope of 2e-3 is far above it.
    np.testing.assert_allclose(slopes_at(xi, parabolic), np.repeat(exact[:, None], 3, axis=1), rtol=1e-9)


def test_no_slope_before_the_relief_and_beyond_the_flanks():
    assert not slopes_at([0.0170, 0.0221, 0.0230, 0.0090], 1.0).any()
