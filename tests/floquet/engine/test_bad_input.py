"""Is what cannot be computed refused with a message that says what to do?"""

import numpy as np
import pytest

from floquet import PeriodicSystem, monodromy
from lumped.errors import NumericalError, ParameterError


def oscillator(t: float) -> list[list[float]]:
    return [[0.0, 1.0], [-1.0, 0.0]]


@pytest.mark.parametrize(("arguments", "word"), [
    *(((oscillator, period), "period") for period in (0.0, -1.0, np.nan, np.inf)),
    *(((oscillator, 1.0, breaks), "breakpoints") for breaks in ((-0.1,), (1.5,), (np.nan,))),
    *(((lambda t, A=A: A, 1.0), "shape") for A in ([[1.0, 2.0]], 1.0, np.zeros((0, 0)))),
    ((np.eye(2), 1.0), "callable"),
])  # fmt: skip
def test_what_is_no_system_is_refused(arguments, word) -> None:
    with pytest.raises(ParameterError, match=word):
        PeriodicSystem(*arguments)


@pytest.mark.parametrize("entry", [1j, "1", None])
@pytest.mark.parametrize("vectorized", [False, True])
def test_coefficients_must_be_real_numbers(entry: object, vectorized: bool) -> None:
    # numpy drops an imaginary part, and reads numbers in texts.
    matrix = [[0.0, 1.0], [entry, 0.0]]
    with pytest.raises(ParameterError, match="real numbers"):
        PeriodicSystem(lambda t: [matrix] * len(t) if vectorized else matrix, 1.0, vectorized=vectorized)


@pytest.mark.parametrize(("A", "options", "error", "word"), [
    *((oscillator, {"rtol": rtol}, ParameterError, "rtol") for rtol in (0.0, -1e-3, 1e-17, 1.0, np.nan)),
    (oscillator, {"method": "newmark"}, ParameterError, "gauss"),
    (lambda t: [[0.0, 1.0], [np.nan if t > 0.9 else -1.0, 0.0]], {}, NumericalError,
     r"not finite at t = 0\.9"),
    (lambda t: [[1.0 / abs(t - 1.0 / 3.0)]], {}, NumericalError, "breakpoints"),
    (lambda t: [[0.0, 6.3], [-6.3 - 3.1 * np.cos(6.3 * t), 0.0]], {"method": "rk4", "max_substeps": 500},
     NumericalError, "higher order"),
    (lambda t: [[0.0, 300.0], [-300.0, -1.0]], {"rtol": 1e-14}, NumericalError, "rtol >= "),
    (lambda t: [[800.0]], {}, NumericalError, "unstable"),
])  # fmt: skip
def test_what_cannot_be_computed_is_refused_with_what_to_do(A, options, error, word) -> None:
    with pytest.raises(error, match=word):
        monodromy(PeriodicSystem(A, 1.0), **options)


def test_extinct_motion_is_stable_and_finite() -> None:
    result = monodromy(PeriodicSystem(lambda t: [[-2000.0]], 1.0))  # exp(-2000) is zero in floating point
    assert result.verdict == "stable"
    assert result.spectral_radius < 1e-300
