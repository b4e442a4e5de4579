"""Do bounds hold a polynomial on its step, and is the first crossing found?"""

import numpy as np
import pytest

from floquet.orbits.polynomials import bounds, crossing, value

PLACES = np.linspace(0.0, 1.0, 1001)


@pytest.mark.parametrize("degree", [2, 3, 4, 7, 12])
def test_bounds_hold_the_polynomial_and_each_power_counts(degree):
    """A power alone, which starts at zero, needs all of its size at the end of the step."""
    h = 0.7
    alone = np.zeros(degree + 1)
    alone[degree] = -2.0
    low, high = bounds(alone, h)
    assert low <= -2.0 * h**degree + 1e-15  # rounding of the powers
    assert high >= 0.0
    rng = np.random.default_rng(degree)
    for c in rng.normal(size=(50, degree + 1)):
        values = np.polynomial.polynomial.polyval(h * PLACES, c)
        low, high = bounds(c, h)
        assert low <= values.min() + 1e-14
        assert high >= values.max() - 1e-14


def test_the_first_crossing_is_the_first_root():
    """Of roots at least an eighth of the step apart: a step of the series has few turns."""
    rng = np.random.default_rng(5)
    seen = 0
    for _ in range(3000):
        roots = np.sort(rng.uniform(-0.5, 1.5, 5))
        c = np.polynomial.polynomial.polyfromroots(roots)
        inside = roots[(roots > 0.0) & (roots < 1.0)]
        if inside.size == 0 or np.diff(inside, append=2.0).min() < 0.13 or np.diff(roots).min() < 0.13:
            continue
        seen += 1
        assert crossing(c, 1.0, float(np.sign(value(c, 0.0)))) == pytest.approx(inside[0], abs=1e-10)
    assert seen > 50
