"""Does the computed flow keep what the exact flow keeps?"""

import numpy as np
import pytest

from floquet import PROPAGATORS, PeriodicSystem, monodromy


def random_system(seed: int, n: int = 4) -> PeriodicSystem:
    C = np.random.default_rng(seed).normal(size=(3, n, n))

    def A(t: np.ndarray) -> np.ndarray:
        w = 2 * np.pi * t[:, None, None]
        return C[0] + np.cos(w) * C[1] + np.sin(2 * w) * C[2]

    return PeriodicSystem(A, 1.0, vectorized=True)


def hamiltonian_system(seed: int) -> PeriodicSystem:
    """x' = J H(t) x with H symmetric, two degrees of freedom, a jump of H at 0.4."""
    H = np.random.default_rng(seed).normal(size=(3, 4, 4))
    H = H + H.transpose(0, 2, 1)
    J = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.eye(2), np.zeros((2, 2))]])

    def A(t: np.ndarray) -> np.ndarray:
        s = t[:, None, None]
        return J @ (H[0] + np.cos(2 * np.pi * s) * H[1] + (s > 0.4) * H[2])

    return PeriodicSystem(A, 1.0, (0.4,), vectorized=True)


@pytest.mark.parametrize("seed", range(5))
def test_determinant_is_exp_of_the_integrated_trace(seed: int) -> None:
    system = random_system(seed)
    result = monodromy(system, rtol=1e-12)
    trace = np.trace(np.random.default_rng(seed).normal(size=(3, 4, 4))[0])  # cos and sin average to zero
    # log det of M adds up errors of 1e-12 relative to |M| over the smallest singular value (1e-3 here).
    assert np.linalg.slogdet(result.matrix)[1] == pytest.approx(trace, abs=1e-8)
    assert result.liouville_residual < 1e-11  # rtol times n


def test_liouville_residual_sees_a_wrong_propagation() -> None:
    # A method of low order at a loose tolerance: its determinant is wrong by about what it was allowed.
    assert monodromy(random_system(1), rtol=1e-4, method="rk4").liouville_residual > 1e-9


def test_hamiltonian_multipliers_come_in_reciprocal_pairs() -> None:
    values = monodromy(hamiltonian_system(4), rtol=1e-12).multipliers
    for value in values:
        assert np.abs(values - 1 / value).min() < 1e-9 * max(1.0, abs(1 / value))


@pytest.mark.parametrize("name", [name for name, known in PROPAGATORS.items() if known.order > 4])
def test_multipliers_do_not_depend_on_coordinates(name: str) -> None:
    # y = P x with a badly scaled P: A -> P A P^-1 has the same multipliers.
    system = random_system(3)
    rng = np.random.default_rng(5)
    P = np.diag(10.0 ** np.array([-4, 3, 0, 6])) @ (np.eye(4) + 0.3 * rng.normal(size=(4, 4)))
    inverse = np.linalg.inv(P)
    turned = PeriodicSystem(lambda t: P @ system.evaluate(t) @ inverse, 1.0, vectorized=True)
    a = monodromy(system, rtol=1e-10, method=name)
    b = monodromy(turned, rtol=1e-10, method=name)
    distance = np.abs(a.multipliers[:, None] - b.multipliers[None, :]).min(axis=1)
    assert (distance <= a.multiplier_errors + b.multiplier_errors.max()).all()
    assert distance.max() < 1e-8 * a.spectral_radius  # rtol, times the conditioning of the multipliers
