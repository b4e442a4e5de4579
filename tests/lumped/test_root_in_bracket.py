"""Is the root of a bracket the same as that of scipy, bit by bit?"""

import math
import random

import numpy as np
import pytest
from scipy.optimize import brentq

from lumped.root_in_bracket import ROUNDING, root_in_bracket, roots_in_brackets


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


#: Simple roots at k pi; at 2.5 of the fifth power, so flat that a secant creeps; a jump at 4.
FUNCTIONS = {
    "sine": (
        np.sin,
        np.array([-4.0, 2.0, 5.5]),
        np.array([-2.0, 3.5, 7.0]),
        np.pi * np.array([-1, 1, 2]),
    ),
    "flat": (lambda x: (x - 2.5) ** 5, np.array([-1.0, 2.0]), np.array([4.0, 2.6]), np.array([2.5, 2.5])),
    "jump": (lambda x: np.where(x < 4.0, -1.0, 1e-6), np.array([3.0]), np.array([9.0]), np.array([4.0])),
    "end": (lambda x: x * (x - 1.0), np.array([0.0, 0.5]), np.array([0.5, 1.0]), np.array([0.0, 1.0])),
}


class TestManyBrackets:
    @pytest.mark.parametrize("name", FUNCTIONS)
    def test_each_root_is_met_to_the_tolerance(self, name):
        function, low, high, exact = FUNCTIONS[name]
        roots = roots_in_brackets(function, low, high, xtol=1e-14)
        if name == "flat":  # the fifth power of 1e-65 is the least number: the function is 0 around the root
            assert np.abs(roots - exact).max() <= 1e-13
        else:
            assert (np.abs(roots - exact) <= 1e-14 + ROUNDING * np.abs(exact)).all()

    def test_all_brackets_share_few_calls(self):
        calls = []

        def sine(x):
            calls.append(x.size)
            return np.sin(x)

        k = np.arange(1, 40)
        roots = roots_in_brackets(sine, np.pi * k - 1.0, np.pi * k + 1.3, xtol=1e-15)
        assert np.abs(roots - np.pi * k).max() <= 1e-15 + ROUNDING * 40.0 * np.pi
        assert len(calls) <= 12  # bisection takes 50

    def test_no_brackets_have_no_roots(self):
        assert roots_in_brackets(np.sin, np.empty(0), np.empty(0), xtol=1e-15).size == 0

    def test_ends_of_one_sign_and_what_is_no_number_are_errors(self):
        with pytest.raises(ValueError, match="opposite signs"):
            roots_in_brackets(np.cos, np.array([-1.0]), np.array([1.0]), xtol=1e-15)
        with pytest.raises(ValueError, match="NaN"):
            roots_in_brackets(
                lambda x: np.where(np.abs(x) < 0.9, np.nan, x), np.array([-1.0]), np.array([1.0]), xtol=1e-15
            )
