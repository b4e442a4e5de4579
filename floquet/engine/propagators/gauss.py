"""Gauss-Legendre collocation applied to the matrix equation."""

from __future__ import annotations

import numpy as np

from floquet.engine.propagators.base import Propagator
from lumped.gauss_legendre import gauss_tableau
from lumped.typing import FloatArray


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
        self._a, self._b, self.nodes = gauss_tableau(stages)

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
