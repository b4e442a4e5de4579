"""Do statements of one period agree: that of the system and those of its coefficients?"""

import numpy as np
import pytest

from floquet import (
    FourierSeries,
    PeriodicMatrix,
    PeriodicSystem,
    PiecewisePolynomial,
    from_second_order,
    monodromy,
)
from lumped.errors import ParameterError

LOWER = [[0.0, 0.0], [1.0, 0.0]]


def system(function, period: float) -> PeriodicSystem:
    return PeriodicSystem(PeriodicMatrix([[0.0, 1.0], [-3.0, -0.05]], (function, LOWER)), period)


STEPS = PiecewisePolynomial([0.0, 0.4, 1.0], [[0.5, 0.1], [-0.7, 0.0]])
WAVE = FourierSeries(1.0472, 0.2, [0.5], [0.1])


@pytest.mark.parametrize(("function", "period", "words"), [
    (WAVE, 1.3, "the period 1.0472 s"),
    (WAVE, 0.5236, "the period 1.0472 s"),  # half of it
    (FourierSeries(2.0, 0.0, [0.0, 1.0, 0.0, 1.0]), 1.5, "the period 1 s"),  # orders 2 and 4
    (FourierSeries(2.0, 0.0, [0.0, 1.0, 1.0]), 1.0, "the period 2 s"),  # orders 2 and 3
    (STEPS, 1.3, "the period 1 s"),
    (STEPS, 0.5, "the period 1 s"),
    (PiecewisePolynomial([0.2, 0.9], [[1.0]]), 1.0, "the period 0.7 s"),
    (STEPS * FourierSeries(1.3, 0.0, [1.0]), 1.3, "another period"),
    (STEPS + FourierSeries(1.3, 0.0, [1.0]), 1.0, "another period"),
    (WAVE * WAVE, 1.3, "another period"),
])  # fmt: skip
def test_two_periods_that_contradict_each_other_are_refused(function, period, words) -> None:
    for make in (
        lambda: system(function, period),
        lambda: from_second_order(1.0, 0.0, PeriodicMatrix(3.0, (function, 1.0)), period),
        lambda: from_second_order(1.0, PeriodicMatrix(0.1, (function, 0.1)), lambda t: 3.0, period),
    ):
        with pytest.raises(ParameterError) as refused:
            make()
        (problem,) = refused.value.problems
        assert problem.field in ("A, term 1", "K, term 1", "C, term 1")
        assert words in str(problem)
        assert f"repeats after the period, {period:g} s" in str(problem)


@pytest.mark.parametrize(("function", "period"), [
    (WAVE, 1.0472), (STEPS, 1.0), (STEPS * FourierSeries(0.5, 0.3, [1.0]), 1.0),
    (FourierSeries(3.0, 0.0, [0.0, 0.0, 0.4, 0.0, 0.0, 0.2]), 1.0),  # orders 3 and 6
    (FourierSeries(2.0, 0.0, [1.0]) * FourierSeries(2.0, 0.0, [1.0]), 1.0),  # cos^2: orders 0 and 2
    (FourierSeries(7.0, 0.3), 1.0),  # a constant
])  # fmt: skip
@pytest.mark.parametrize("count", [2, 3, 7])
def test_a_whole_number_of_periods_gives_powers_of_the_multipliers(function, period, count) -> None:
    one = monodromy(system(function, period))
    many = monodromy(system(function, count * period))
    assert many.certificate == "proven"
    power = np.linalg.matrix_power(one.matrix, count)
    assert np.abs(many.matrix - power).max() < 1e-8
    assert np.abs(one.matrix - many.matrix).max() > 1e-3  # not the same matrix by chance


@pytest.mark.parametrize("start", [-0.7, -0.25, 0.3, 5.6])
def test_pieces_may_begin_at_any_time(start: float) -> None:
    """The steps from another start are the same function of time, and their multipliers do not change."""
    ends = np.array([0.0, 0.4, 1.0])
    shifted = PiecewisePolynomial(ends + start, [[0.5], [-0.7]])
    plain = PiecewisePolynomial(ends, [[0.5], [-0.7]])
    for count in (1.0, 3.0):
        late = system(shifted, count)
        times = np.array([0.05, 0.21, 0.55, 0.83])
        assert np.allclose(late.evaluate(times), system(plain, 1.0).evaluate((times - start) % 1.0))
        exact = monodromy(system(plain, count)).multipliers
        # The same system of M, C and K, whose matrices are brought to the period twice.
        again = from_second_order(1.0, 0.05, PeriodicMatrix(3.0, (shifted, -1.0)), count)
        assert np.abs(monodromy(again).multipliers - exact).max() < 1e-9
        assert np.abs(monodromy(late).multipliers - exact).max() < 1e-9
        assert late.edges[-1] == count


def test_a_period_that_is_rounded_agrees() -> None:
    """A third of pi by two ways, and a sum of steps in the place of their number."""
    assert system(FourierSeries(np.pi / 3.0, 0.0, [1.0]), np.pi * (1.0 / 3.0)).dimension == 2
    steps = PiecewisePolynomial([0.0, 0.1 + 0.2], [[1.0]])
    assert system(steps, 0.3).edges.tolist() == [0.0, 0.3]
