"""Is the true error never above the reported bound, in easy and in awkward cases?"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

from floquet import PROPAGATORS, PeriodicSystem, monodromy


def distances(computed: np.ndarray, exact: np.ndarray) -> np.ndarray:
    """For each computed multiplier the distance to the nearest exact one."""
    return np.abs(computed[:, None] - exact[None, :]).min(axis=1)


@pytest.mark.parametrize("shape", ["sine", "triangle"])
@pytest.mark.parametrize(
    ("method", "rtol"),
    [
        ("gauss", 1e-4),
        ("gauss", 1e-7),
        ("gauss", 1e-10),
        ("gauss8", 1e-7),
        ("magnus6", 1e-5),
        ("dop853", 1e-8),
    ],
)
def test_bounds_hold_on_random_systems(known_system, method: str, rtol: float, shape: str) -> None:
    rng = np.random.default_rng(101)
    for _ in range(10):
        n = int(rng.integers(2, 7))
        B, S = rng.normal(size=(2, n, n))
        period = float(rng.uniform(0.5, 3.0))
        system, exact = known_system(B, 0.4 * S, period, shape)
        result = monodromy(system, rtol=rtol, method=method)
        d = result.scaling
        scaled_error = (result.matrix - exact) * d[None, :] / d[:, None]
        assert np.linalg.norm(scaled_error, 2) <= result.matrix_error
        assert result.matrix_error <= rtol * np.linalg.norm(result.matrix * d[None, :] / d[:, None], 2)
        true = np.exp(np.linalg.eigvals(B) * period)
        assert (distances(result.multipliers, true) <= result.multiplier_errors).all()
        assert abs(result.spectral_radius - np.abs(true).max()) <= result.error


def test_defective_multiplier_gets_a_root_law_bound(known_system) -> None:
    # A double multiplier with one eigenvector moves like the square root of a perturbation, so an honest
    # bound is of order sqrt(matrix_error), and a bound of order matrix_error would be a lie.
    B = np.array([[-0.1, 5.0, 0.3], [0.0, -0.1, 0.2], [0.0, 0.0, -2.0]])
    S = np.random.default_rng(1).normal(size=(3, 3))
    system, exact = known_system(B, 0.2 * S, 1.0)
    result = monodromy(system, rtol=1e-12)
    assert np.linalg.norm((result.matrix - exact) * result.scaling / result.scaling[:, None]) < 1e-10
    assert abs(result.spectral_radius - np.exp(-0.1)) <= result.error
    assert 0.1 * np.sqrt(result.matrix_error) < result.error < 1e-4  # 100 sqrt(1e-12)
    assert result.multiplier_errors[2] < 1e-9  # the simple multiplier exp(-2) keeps its own accuracy
    assert result.verdict == "stable"


def test_marginal_system_is_undecided() -> None:
    # An undamped oscillator has |multiplier| = 1 exactly; no finite computation can say which side it is on.
    result = monodromy(PeriodicSystem(lambda t: [[0.0, 1.0], [-1.0, 0.0]], 1.0))
    assert result.verdict == "undecided"
    assert result.error < 1e-9


@pytest.mark.parametrize(("damping", "expected"), [(1e-7, "stable"), (-1e-7, "unstable")])
def test_verdict_near_the_boundary(damping: float, expected: str) -> None:
    system = PeriodicSystem(lambda t: [[0.0, 1.0], [-1.0, -damping]], 2.0)
    assert monodromy(system, rtol=1e-11).verdict == expected


def test_low_speed_hundreds_of_radians(known_system) -> None:
    # Three modes with 200 to 900 rad per period, 1 to 5 % damping, mixed by a periodic change of variables.
    period = 1.0
    blocks = [(200.0, 0.010), (450.0, 0.015), (900.0, 0.05)]
    B = np.zeros((6, 6))
    for i, (w, zeta) in enumerate(blocks):
        B[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] = [[-zeta * w, w], [-w, -zeta * w]]
    S = np.random.default_rng(9).normal(size=(6, 6))
    system, _ = known_system(B, 0.1 * S, period, "triangle")
    result = monodromy(system, rtol=1e-9)
    true = np.exp(np.linalg.eigvals(B) * period)  # |.| = exp(-2), exp(-6.75), exp(-45) = 3e-20
    assert (distances(result.multipliers, true) <= result.multiplier_errors).all()
    assert result.spectral_radius == pytest.approx(np.exp(-2.0), rel=1e-9)  # rtol
    assert result.error < 1e-8
    # det M = exp(-107.5) is far below what the determinant of M can show; per substep it is exact.
    assert result.liouville_residual < 1e-8


def test_transient_growth_inside_the_period_is_accounted_for() -> None:
    # Growth by exp(20) in the first half, decay by exp(-21) in the second: local errors of the first half are
    # amplified 5e8-fold before they decay, and rotate between. The result must still be as accurate as asked.
    def A(t: float) -> np.ndarray:
        return np.array([[40.0, 3.0], [-3.0, 40.0]]) if t < 0.5 else np.array([[-42.0, 1.0], [-1.0, -42.0]])

    result = monodromy(PeriodicSystem(A, 1.0, (0.5,)), rtol=1e-9)
    exact = expm(0.5 * A(0.75)) @ expm(0.5 * A(0.25))
    assert np.linalg.norm(result.matrix - exact, 2) <= 1e-9 * np.linalg.norm(exact, 2)


@pytest.mark.parametrize("method", sorted(set(PROPAGATORS) - {"expm"}))
def test_tolerance_is_met_by_every_method(known_system, method: str) -> None:
    rng = np.random.default_rng(21)
    B, S = rng.normal(size=(2, 3, 3))
    system, exact = known_system(B, 0.3 * S, 1.0)
    result = monodromy(system, rtol=1e-7, method=method)
    assert np.linalg.norm(result.matrix - exact, 2) < 1e-6 * np.linalg.norm(exact, 2)  # rtol, other norm
