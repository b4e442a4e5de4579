"""Are matrix and exponents those of constant coefficients, piece by piece?"""

import numpy as np
from scipy.linalg import expm

from floquet import PeriodicSystem, monodromy


def test_exponents_of_constant_coefficients() -> None:
    # The exponents are the eigenvalues of A while |Im| < pi/T; seed 7 keeps them there.
    A = np.random.default_rng(7).normal(size=(5, 5)) - 0.5 * np.eye(5)
    eigenvalues = np.linalg.eigvals(A)
    assert np.abs(eigenvalues.imag).max() < np.pi / 2
    found = monodromy(PeriodicSystem(lambda t: A, 2.0), 1e-11).exponents
    # 1e-8: conditioning of the smallest multiplier.
    assert np.abs(found[:, None] - eigenvalues[None, :]).min(axis=1).max() < 1e-8


def test_piecewise_constant_product() -> None:
    # Three different constant matrices: M = exp(A3 h3) exp(A2 h2) exp(A1 h1), the last factor acting first.
    rng = np.random.default_rng(3)
    matrices = rng.normal(size=(3, 4, 4))
    edges = np.array([0.0, 0.3, 0.75, 1.0])

    def A(t: np.ndarray) -> np.ndarray:
        return matrices[np.searchsorted(edges, t) - 1]

    result = monodromy(PeriodicSystem(A, 1.0, edges[1:3], vectorized=True), rtol=1e-12)
    exact = np.eye(4)
    for matrix, h in zip(matrices, np.diff(edges), strict=True):
        exact = expm(matrix * h) @ exact
    assert np.linalg.norm(result.matrix - exact) < 1e-10 * np.linalg.norm(exact)  # rtol with room for scaling
