"""Is what is proven called proven, and what is sampled an estimate that looks where nobody looked?"""

import numpy as np
import pytest

from floquet import (
    FourierSeries,
    PeriodicMatrix,
    PeriodicSystem,
    PiecewisePolynomial,
    monodromy,
)
from floquet.engine.formula_steps import proven_product
from lumped.errors import NumericalError, ParameterError, ResolutionWarning


def bumped(width: float) -> PeriodicSystem:
    """An oscillator with a narrow bump of its stiffness, as a callable."""

    def A(t: float) -> np.ndarray:
        bump = 2.0 / width * np.exp(-(((t - 0.437) / width) ** 2) / 2.0)
        return np.array([[0.0, 1.0], [-(30.0 + 5.0 * np.cos(2.0 * np.pi * t) + bump), -0.04]])

    return PeriodicSystem(A, 1.0)


def oscillator(entry, damping):
    return PeriodicMatrix([[0.0, 1.0], [0.0, -damping]], (entry, [[0.0, 0.0], [1.0, 0.0]]))


def test_a_narrow_feature_of_a_callable_is_found_and_told() -> None:
    with pytest.warns(ResolutionWarning, match=r"0\.4|0\.5"):
        result = monodromy(bumped(3e-4))
    assert result.spectral_radius == pytest.approx(1.3503742883, abs=1e-8)
    assert result.certificate == "estimate"
    assert 0.0 < result.resolution < 1e-3


def test_a_formula_has_a_proven_bound_that_holds_for_both_routes() -> None:
    entry = FourierSeries(1.0, -30.0, [-5.0]) - PiecewisePolynomial(
        [0.0, 0.3, 1.0], [[0.0, 1.0, 2.0], [1.0, 2.0, 3.0]]
    ) * FourierSeries(1.0, 1.0, [], [0.3, 0.2])
    system = PeriodicSystem(oscillator(entry, 0.04), 1.0)
    proven = monodromy(system)
    sampled = monodromy(system, method="gauss")
    assert (proven.certificate, sampled.certificate) == ("proven", "estimate")
    assert (proven.resolution, proven.method) == (0.0, "taylor")
    assert system.edges.tolist() == [0.0, 0.3, 1.0]  # the break of the polynomial
    assert abs(proven.spectral_radius - sampled.spectral_radius) <= proven.error + sampled.error
    assert 0.0 < proven.matrix_error < 1e-10
    assert proven.liouville_residual < 1e-11


def test_a_coefficient_that_is_zero_in_the_middle_does_not_spoil_the_scales() -> None:
    # x'' + 3.43 (1 + cos t) x = 0: at t = T/2 nothing balances the 1.
    wave = FourierSeries(2.0 * np.pi, 3.43, [3.43])
    result = monodromy(PeriodicSystem(oscillator(-wave, 0.0), 2.0 * np.pi))
    assert result.matrix_error < 1e-10


def test_the_product_keeps_terms_of_second_order() -> None:
    # Errors so large that the first order alone is not enough: (1 + e)^m - 1 > m e.
    e = 0.05
    m = 40
    exact, bound = proven_product(np.ones((m, 1, 1)), np.full(m, e))
    assert exact[0, 0] == 1.0
    assert (1.0 + e) ** m - 1.0 <= bound <= 1.001 * ((1.0 + e) ** m - 1.0)  # in one dimension nothing is lost


def test_decay_beyond_the_squares_of_floating_point_keeps_its_bound() -> None:
    # 150 steps of ten, then 170 of 1/10: the flow after step 149 is 1e-170, whose square is no number.
    steps = np.concatenate([np.full(150, 10.0), np.full(170, 0.1)]).reshape(-1, 1, 1)
    errors = np.zeros(320)
    last_large = 149
    errors[last_large] = 1e-3
    product, bound = proven_product(steps, errors)
    assert product[0, 0] == pytest.approx(1e-20)
    assert 1e-3 * 1e149 * 1e-170 <= bound < 1e-22
    dead = monodromy(PeriodicSystem(PeriodicMatrix(-4000.0), 0.2))
    assert dead.multiplier_errors[0] >= 5e-324
    assert dead.verdict == "stable"


def test_what_cannot_be_proven_is_refused() -> None:
    wave = FourierSeries(1.0, -30.0, [-5.0])
    with pytest.raises(NumericalError, match="cannot be proven"):
        monodromy(PeriodicSystem(oscillator(wave, 0.04), 400.0), 1e-14)
    with pytest.raises(ParameterError, match="square"):
        PeriodicMatrix([[0.0, 1.0]])
    with pytest.raises(ParameterError, match="coefficients"):
        PiecewisePolynomial([0.0, 1.0, 2.0], [[1.0]])


def test_a_tolerance_between_two_that_are_met_is_met() -> None:
    """Refused steps are measured by what the last grid reached; else the same grid came again."""
    a = -0.8119798362942523
    b = 4.453781979209743
    system = PeriodicSystem(
        lambda t: np.array([[0.0, 1.0], [-(a + b * (np.cos(t) + 2.0 * np.cos(2.0 * t))), 0.0]]), 2.0 * np.pi
    )
    for rtol in (1e-6, 1e-7, 1e-8, 1e-9):
        result = monodromy(system, rtol)
        assert result.matrix_error <= rtol * np.linalg.norm(result.matrix, 2) * 1.5
