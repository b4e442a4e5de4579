"""Is what cannot be computed refused with a message that says what to do?"""

import numpy as np
import pytest

from floquet import PeriodicSystem, monodromy
from lumped.errors import NumericalError, ParameterError


def oscillator(t: float) -> list[list[float]]:
    return [[0.0, 1.0], [-1.0, 0.0]]


@pytest.mark.parametrize("period", [0.0, -1.0, np.nan, np.inf])
def test_period_must_be_positive(period: float) -> None:
    with pytest.raises(ParameterError, match="period"):
        PeriodicSystem(oscillator, period)


@pytest.mark.parametrize("breaks", [(-0.1,), (1.5,), (np.nan,)])
def test_breakpoints_must_lie_in_the_period(breaks: tuple[float, ...]) -> None:
    with pytest.raises(ParameterError, match="breakpoints"):
        PeriodicSystem(oscillator, 1.0, breaks)


@pytest.mark.parametrize("A", [lambda t: [[1.0, 2.0]], lambda t: 1.0, lambda t: np.zeros((0, 0))])
def test_coefficients_must_be_square(A) -> None:
    with pytest.raises(ParameterError, match="shape"):
        PeriodicSystem(A, 1.0)


@pytest.mark.parametrize("entry", [1j, "1", None])
@pytest.mark.parametrize("vectorized", [False, True])
def test_coefficients_must_be_real_numbers(entry: object, vectorized: bool) -> None:
    # numpy drops an imaginary part, and reads numbers in texts.
    matrix = [[0.0, 1.0], [entry, 0.0]]
    with pytest.raises(ParameterError, match="real numbers"):
        PeriodicSystem(lambda t: [matrix] * len(t) if vectorized else matrix, 1.0, vectorized=vectorized)


def test_a_matrix_is_not_a_callable() -> None:
    with pytest.raises(ParameterError, match="callable"):
        PeriodicSystem(np.eye(2), 1.0)  # type: ignore[arg-type]


@pytest.mark.parametrize("rtol", [0.0, -1e-3, 1e-17, 1.0, np.nan])
def test_tolerance_range(rtol: float) -> None:
    with pytest.raises(ParameterError, match="rtol"):
        monodromy(PeriodicSystem(oscillator, 1.0), rtol=rtol)


def test_unknown_method_lists_the_known_ones() -> None:
    with pytest.raises(ParameterError, match="gauss"):
        monodromy(PeriodicSystem(oscillator, 1.0), method="newmark")


def test_non_finite_coefficients_name_the_time() -> None:
    system = PeriodicSystem(lambda t: [[0.0, 1.0], [np.nan if t > 0.9 else -1.0, 0.0]], 1.0)
    with pytest.raises(NumericalError, match=r"not finite at t = 0\.9"):
        monodromy(system)


def test_undeclared_singularity_is_reported() -> None:
    with pytest.raises(NumericalError, match="breakpoints"):
        monodromy(PeriodicSystem(lambda t: [[1.0 / abs(t - 1.0 / 3.0)]], 1.0))


def test_low_order_method_at_a_tight_tolerance_is_refused() -> None:
    system = PeriodicSystem(lambda t: [[0.0, 1.0], [-1.0 - 0.5 * np.cos(t), 0.0]], 2 * np.pi)
    with pytest.raises(NumericalError, match="higher order"):
        monodromy(system, method="rk4", max_substeps=500)


def test_tolerance_below_rounding_is_refused() -> None:
    system = PeriodicSystem(lambda t: [[0.0, 300.0], [-300.0, -1.0]], 1.0)
    with pytest.raises(NumericalError, match="rtol >= "):
        monodromy(system, rtol=1e-14)


def test_growth_beyond_floating_point_is_reported() -> None:
    with pytest.raises(NumericalError, match="unstable"):
        monodromy(PeriodicSystem(lambda t: [[800.0]], 1.0))


def test_extinct_motion_is_stable_and_finite() -> None:
    result = monodromy(PeriodicSystem(lambda t: [[-2000.0]], 1.0))  # exp(-2000) is zero in floating point
    assert result.verdict == "stable"
    assert result.spectral_radius < 1e-300
