"""Is a path function the function it stands for, with its jumps where they are?"""

import numpy as np
import pytest

from lumped.errors import NumericalError
from lumped.path_function import PathFunction, one_of_each


def test_polynomials_up_to_the_fit_degree_are_exact():
    coefficients = np.array([2.0, -1.0, 0.5, 3.0, 0.0, 1.0, 0.25, -4.0, 1.0])
    fitted = PathFunction.fit(lambda x: np.polyval(coefficients, x), [0.0, 1.0], tolerance=1e-10)
    x = np.linspace(0.0, 0.999, 57)
    # basis conversion at degree 8 amplifies rounding by about (1 + sqrt 2)^8 = 1.2e3 times eps
    np.testing.assert_allclose(fitted(x), np.polyval(coefficients, x), atol=1e-11)
    np.testing.assert_allclose(fitted.slope(x), np.polyval(np.polyder(coefficients), x), atol=1e-9)


def test_power_with_a_singular_derivative_is_graded_to_the_tolerance():
    fitted = PathFunction.fit(lambda x: x**1.036, [0.0, 1.0], tolerance=1e-10)
    x = np.geomspace(1e-8, 0.999, 400)
    assert np.abs(fitted(x) - x**1.036).max() < 5e-10
    assert fitted.mean() == pytest.approx(1 / 2.036, abs=1e-9)


def test_short_pieces_may_err_by_what_their_length_allows():
    def steep(x):
        return np.log(x + 1e-3)

    plain = PathFunction.fit(steep, [0.0, 1.0], tolerance=1e-10)
    short = PathFunction.fit(steep, [0.0, 1.0], tolerance=1e-10, by_length=True)
    assert short.breaks.size < 0.9 * plain.breaks.size
    x = short.breaks[:-1] + np.outer(np.linspace(0.01, 0.99, 50), np.diff(short.breaks))
    error = np.abs(short(x) - steep(x)).max(axis=0)
    assert np.all(error * np.minimum(1.0, 8.0 * np.diff(short.breaks)) < 2e-10)


def test_a_jump_of_curvature_is_a_bend_and_a_joint_of_a_fit_is_none():
    assert PathFunction.fit(lambda x: x**1.036, [0.1, 1.0], tolerance=1e-10).bends.size == 0
    knot = PathFunction(
        np.array([0.0, 0.5, 1.0]), np.array([[1.0, 1.01], [0.0, 1.0], [0.0, 0.25]]), np.empty(0)
    )
    assert list(knot.bends) == [0.5]


def test_a_jump_is_taken_from_each_side_and_outside_is_zero():
    step = PathFunction.fit(lambda x: np.where(x < 1.0, -1.0, 2.0), [0.0, 1.0, 3.0], [1.0], tolerance=1e-12)
    np.testing.assert_allclose(step([-0.1, 0.5, 1.0, 2.0, 3.5]), [0.0, -1.0, 2.0, 2.0, 0.0], atol=1e-13)
    assert step.mean() == pytest.approx(1.0, abs=1e-13)


def test_an_undeclared_jump_is_refused_not_smoothed():
    with pytest.raises(NumericalError, match="jump or kink"):
        PathFunction.fit(lambda x: np.where(x < np.pi / 4, 0.0, 1.0), [0.0, 1.0], tolerance=1e-10)


def test_non_finite_values_are_refused():
    with pytest.raises(NumericalError, match="not finite"):
        PathFunction.fit(lambda x: np.full_like(x, np.nan), [0.0, 1.0], tolerance=1e-10)


def test_noise_is_refused_after_a_bounded_number_of_pieces():
    rng = np.random.default_rng(1)
    with pytest.raises(NumericalError, match="noisy"):
        PathFunction.fit(lambda x: x + 1e-8 * rng.standard_normal(x.size), [0.0, 1.0], tolerance=1e-10)


def test_further_breaks_change_nothing():
    function = PathFunction.fit(np.exp, [0.0, 0.4, 1.0], tolerance=1e-12)
    split = function.split([0.1, 0.5, 0.51, 2.0])
    assert set(split.breaks) == {*function.breaks, 0.1, 0.5, 0.51}
    x = np.linspace(0.0, 0.999, 201)
    np.testing.assert_allclose(split(x), function(x), rtol=1e-14)


def test_breaks_that_differ_by_rounding_are_one_break():
    """Two of 58/58's breaks are 2 units in the last place apart: on such a piece a fit has no slope."""
    at = 0.0229
    next_to_it = np.nextafter(np.nextafter(at, 1.0), 1.0)
    fitted = PathFunction.fit(np.sqrt, [0.018, at, next_to_it, 0.027], tolerance=1e-10)
    middles = 0.5 * (fitted.breaks[:-1] + fitted.breaks[1:])
    assert at in fitted.breaks
    assert next_to_it not in fitted.breaks
    # sqrt is concave: a slope lies between those at the ends, a curvature too.
    for law, least, most in (
        (fitted.slope, 0.5 * 0.027**-0.5, 0.5 * 0.018**-0.5),
        (fitted.slope.slope, -0.25 * 0.018**-1.5, -0.25 * 0.027**-1.5),
    ):
        values = law(np.concatenate([fitted.breaks[:-1], middles]))
        assert least * (1.0 - 1e-4 * np.sign(least)) <= values.min()
        assert values.max() <= most * (1.0 + 1e-4 * np.sign(most))


def test_of_breaks_that_differ_by_rounding_the_switch_stays():
    at = np.nextafter(1.0, 2.0)
    step = PathFunction.fit(
        lambda x: np.where(x < at, -1.0, 2.0),
        [0.0, 1.0, at, np.nextafter(at, 2.0), 3.0],
        [at],
        tolerance=1e-12,
    )
    np.testing.assert_array_equal(step.breaks, [0.0, at, 3.0])


def test_of_a_chain_of_close_marks_one_mark_stays():
    """The neighbours of a mark may go before the mark is compared: the chain is one group."""
    near = 1.0
    marks = np.array([0.0, 5.0, 5.4, 5.8, 6.2, 9.0, 9.9, 12.0])
    rank = np.array([1, 0, 0, 0, 1, 0, 0, 1])
    np.testing.assert_array_equal(one_of_each(marks, near, rank), [0.0, 6.2, 9.0, 12.0])
    np.testing.assert_array_equal(one_of_each(marks, near, np.zeros(8, bool)), [0.0, 5.0, 9.0, 12.0])
