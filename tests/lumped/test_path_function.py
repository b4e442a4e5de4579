"""Is a path function the function it stands for, with its jumps where they are?"""

import numpy as np
import pytest

from lumped.errors import NumericalError
from lumped.path_function import PathFunction


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
