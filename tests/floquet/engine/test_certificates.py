"""Is what is proven called proven, and what is sampled an estimate that looks where nobody looked?"""

from __future__ import annotations

import numpy as np
import pytest

from floquet import (
    FourierSeries,
    KnownMatrix,
    PeriodicSystem,
    PiecewisePolynomial,
    monodromy,
    stability_chart,
)
from lumped import load_gear_pair
from lumped.errors import ParameterError, ResolutionWarning


def bumped(width: float) -> PeriodicSystem:
    """An oscillator with a narrow bump of its stiffness, as a callable."""

    def A(t: float) -> np.ndarray:
        bump = 2.0 / width * np.exp(-(((t - 0.437) / width) ** 2) / 2.0)
        return np.array([[0.0, 1.0], [-(30.0 + 5.0 * np.cos(2.0 * np.pi * t) + bump), -0.04]])

    return PeriodicSystem(A, 1.0)


def test_a_narrow_feature_of_a_callable_is_found_and_told() -> None:
    with pytest.warns(ResolutionWarning, match=r"0\.4|0\.5"):
        found = monodromy(bumped(3e-4))
    assert found.spectral_radius == pytest.approx(1.3503742883, abs=1e-8)
    assert found.certificate == "estimate"
    assert 0.0 < found.resolution < 1e-3


def test_a_formula_knows_its_breaks_and_is_the_callable_that_it_says() -> None:
    def rows(t: float) -> float:
        return [0.0, 1.0, 2.0] @ t ** np.arange(3) if t < 0.3 else [1.0, 2.0, 3.0] @ (t - 0.3) ** np.arange(3)

    def A(t: float) -> np.ndarray:
        w = 2.0 * np.pi * t
        entry = -30.0 - 5.0 * np.cos(w) - rows(t) * (1.0 + 0.3 * np.sin(w) + 0.2 * np.sin(2.0 * w))
        return np.array([[0.0, 1.0], [entry, -0.04]])

    entry = FourierSeries(1.0, -30.0, [-5.0]) - PiecewisePolynomial(
        [0.0, 0.3, 1.0], [[0.0, 1.0, 2.0], [1.0, 2.0, 3.0]]
    ) * FourierSeries(1.0, 1.0, [], [0.3, 0.2])
    system = PeriodicSystem(KnownMatrix([[0.0, 1.0], [entry, -0.04]]), 1.0)
    assert system.edges.tolist() == [0.0, 0.3, 1.0]  # the break of the polynomial
    formula, sampled = monodromy(system), monodromy(PeriodicSystem(A, 1.0, [0.3]))
    assert abs(formula.spectral_radius - sampled.spectral_radius) <= formula.error + sampled.error < 1e-8
    assert formula.liouville_residual < 1e-11


def test_a_coefficient_that_is_zero_in_the_middle_does_not_spoil_the_scales() -> None:
    # x'' + 3.43 (1 + cos t) x = 0: at t = T/2 nothing balances the 1.
    wave = FourierSeries(2.0 * np.pi, 3.43, [3.43])
    found = monodromy(PeriodicSystem(KnownMatrix([[0.0, 1.0], [-wave, 0.0]]), 2.0 * np.pi))
    assert found.matrix_error < 1e-10


def test_charts_say_what_their_errors_are() -> None:
    pair = load_gear_pair("nasa_28_28").with_({"friction.law": "xu_kahraman"})
    speeds = {"speed_rpm": [3000.0, 3010.0]}
    together, alone = stability_chart(pair, speeds), stability_chart(pair, {"speed_rpm": [3000.0]})
    assert (together.attrs["certificate"], alone.attrs["certificate"]) == ("estimate", "proven")
    assert together["proven"].values.tolist() == [False, False]


def test_formulas_of_the_wrong_shape_are_refused() -> None:
    with pytest.raises(ParameterError, match="square"):
        KnownMatrix([[0.0, 1.0]])
    with pytest.raises(ParameterError, match="coefficients"):
        PiecewisePolynomial([0.0, 1.0, 2.0], [[1.0]])
