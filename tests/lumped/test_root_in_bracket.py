"""Is the root of a bracket the same as that of scipy, bit by bit?"""

import math
import random

import pytest
from scipy.optimize import brentq

from lumped.root_in_bracket import ROUNDING, root_in_bracket


def drawn_functions(rng):
    """Functions whose steps are secants, parabolas and halves of the bracket."""
    a, b, c = (rng.uniform(-3.0, 3.0) for _ in range(3))
    yield lambda x: a * x**3 + b * x * x + c * x + 0.5
    yield lambda x: math.tan(math.fmod(x, 1.4)) - x - a
    yield lambda x: math.exp(a * x) - abs(b) - 0.1
    yield lambda x: math.atan(b * (x - a)) + c / 9.0
    yield lambda x: math.copysign(abs(x - a) ** 5, x - a)


def root(solver, function, bracket, tolerances):
    """The root, or the name of the error."""
    try:
        return solver(function, *bracket, **tolerances)
    except (ValueError, RuntimeError) as error:
        return type(error).__name__


def test_the_root_is_that_of_scipy_bit_by_bit():
    rng = random.Random(1973)
    roots = []
    for _ in range(1000):
        bracket = rng.uniform(-4.0, 4.0), rng.uniform(-4.0, 4.0)
        tolerances = {
            "xtol": rng.choice([1e-15, 2e-12, 1e-6, 0.1]),
            "rtol": rng.choice([ROUNDING, 1e-12, 1e-3]),
        }
        for function in drawn_functions(rng):
            roots.append(root(root_in_bracket, function, bracket, tolerances))
            assert roots[-1] == root(brentq, function, bracket, tolerances)
    assert sum(isinstance(one, float) for one in roots) > 1000
    assert "ValueError" in roots


@pytest.mark.parametrize("ends", [(0.0, 1.0), (-1.0, 0.0)])
def test_a_root_at_an_end_is_that_end(ends):
    assert root_in_bracket(lambda x: x, *ends) == 0.0


def test_what_is_no_number_is_an_error():
    with pytest.raises(ValueError, match="NaN"):
        root_in_bracket(lambda x: math.nan if 0.2 < x < 0.8 else x - 0.5, 0.0, 1.0)
