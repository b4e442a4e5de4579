"""Gauss-Legendre collocation: s stages, order 2 s, symplectic, A-stable.

Sources: Hairer, Lubich and Wanner, Geometric Numerical Integration, 2006, section II.1.3.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial.legendre import leggauss, legvander

from floquet.engine.propagators.base import Propagator
from lumped.typing import FloatArray


def butcher_gauss(stages: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Butcher tableau (a, b, c) of Gauss-Legendre collocation on [0, 1].

    a_ij is the integral of the j-th Lagrange polynomial from 0 to c_i. Expanding it in Legendre polynomials,
    whose coefficients the quadrature itself gives exactly, avoids the ill-conditioned Vandermonde system.
    """
    x, w = leggauss(stages)
    c, b = 0.5 * (x + 1.0), 0.5 * w
    P = legvander(x, stages)  # P[i, m] = P_m(x_i), m = 0..s
    integral = np.empty((stages, stages))  # of P_m(2 tau - 1) from 0 to c_i
    integral[:, 0] = c
    for m in range(1, stages):
        integral[:, m] = (P[:, m + 1] - P[:, m - 1]) / (2.0 * (2 * m + 1))
    weight = (2 * np.arange(stages) + 1.0)[:, None] * P[:, :stages].T * b
    return integral @ weight, b, c


class GaussLegendre(Propagator):
    """Collocation at the s Gauss points (Hairer, Norsett and Wanner, Solving ODEs I, section II.7).

    The system is linear, so the stages follow from one linear solve of size s n, without iteration.
    Quadratic invariants are kept: with a Hamiltonian A(t) every step is symplectic to rounding.

    Parameters
    ----------
    stages : s >= 1
    """

    def __init__(self, stages: int) -> None:
        self.name = f"gauss{2 * stages}"
        self.order = 2 * stages
        self._a, self._b, self.nodes = butcher_gauss(stages)

    def step_matrices(self, A: FloatArray, h: FloatArray) -> FloatArray:
        """See `Propagator.step_matrices`; solves (I - h a_ij A_i) K = A, then I + h sum b_i K_i."""
        k, s, n, _ = A.shape
        hA = h[:, None, None, None] * A
        system = -np.einsum("ij,kiab->kiajb", self._a, hA).reshape(k, s * n, s * n)
        system[:, np.arange(s * n), np.arange(s * n)] += 1.0
        slopes = np.linalg.solve(system, hA.reshape(k, s * n, n)).reshape(k, s, n, n)
        steps = np.einsum("i,kiab->kab", self._b, slopes)
        steps[:, np.arange(n), np.arange(n)] += 1.0
        return np.asarray(steps)
