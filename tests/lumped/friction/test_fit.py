"""Does a fit whose pieces shrink towards P reach its tolerance on the singularities of the friction laws?"""

import numpy as np
import pytest

from lumped.friction.base import graded_breaks
from lumped.path_function import PathFunction

PITCH, LOW, HIGH = 0.0152, 0.0075, 0.0229


def graded(law, breaks, tolerance):
    return PathFunction.fit(law, breaks, tolerance=tolerance, cut=graded_breaks(PITCH))


def logarithm(xi):
    d = np.maximum(np.abs(xi - PITCH), 1e-8)
    return np.sign(xi - PITCH) * -0.0085 * np.log(d)


def power(xi):
    return np.sign(xi - PITCH) * 6.0 * np.abs(xi - PITCH) ** 1.036


def ramp(xi):
    return 0.03 * np.arctan((xi - PITCH) / 2e-5)


@pytest.mark.parametrize(("law", "knots"), [(logarithm, (-1e-8, 0.0, 1e-8)), (power, (0.0,)), (ramp, (0.0,))])
@pytest.mark.parametrize("tolerance", [1e-6, 1e-10])
def test_tolerance_is_met_at_every_distance(law, knots, tolerance):
    breaks = [LOW, *(PITCH + k for k in knots), HIGH]
    fit = graded(law, breaks, tolerance)
    d = np.geomspace(1.1e-8, 0.99 * (PITCH - LOW), 4000)
    for side in (-1.0, 1.0):
        error = np.abs(fit(PITCH + side * d) - law(PITCH + side * d)).max()
        # probes see the error of a piece to within its ripple, a factor of two
        assert error < 2 * tolerance
    assert fit.breaks.size < 100


def test_pieces_grow_like_the_logarithm_of_the_resolution():
    # graded pieces: each decade of a smaller inner scale adds some pieces, it does not multiply them
    def ramps(scale):
        return graded(lambda xi: np.arctan((xi - PITCH) / scale), [LOW, PITCH, HIGH], 1e-9).breaks.size

    sizes = [ramps(1e-4), ramps(1e-5), ramps(1e-6)]
    # a piece spans a ratio of 1.6 or so in distance: ln 10/ln 1.6 = 5 a decade and side, and slack
    assert max(np.diff(sizes)) <= 14
    assert sizes[2] < 80
