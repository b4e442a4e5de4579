"""Propagators: methods for steps of x' = A(t) x, many steps at once; the interface and two families.

Sources: docs/theory/floquet.md, "Computing M"; Hairer, Nørsett and Wanner, Solving Ordinary Differential
Equations I, 1993, section II.7.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
import numpy.typing as npt

from lumped.gauss_legendre import gauss_tableau
from lumped.typing import FloatArray


class Propagator(ABC):
    """A one-step method for the matrix equation X' = A(t) X.

    Attributes
    ----------
    name : name in results and in error messages
    order : p; the error of one step is O(h^(p+1)) while A is smooth inside the step
    nodes : (s,) abscissae in [0, 1] at which A is needed
    symplectic : whether a Hamiltonian A(t) makes every step symplectic to rounding
    """

    name: str
    order: int
    nodes: FloatArray
    symplectic: bool = False

    @abstractmethod
    def step_matrices(self, A: FloatArray, h: FloatArray) -> FloatArray:
        """Return the transition matrices over k steps.

        Parameters
        ----------
        A : (k, s, n, n), A at the nodes of each step
        h : (k,) step lengths [s]

        Returns
        -------
        (k, n, n), approximations of Phi(t_i + h_i, t_i)
        """


class GaussLegendre(Propagator):
    """Collocation at the s Gauss points.

    The system is linear, so the stages follow from one linear solve of size s n, without iteration.
    Quadratic invariants are kept: with a Hamiltonian A(t) every step is symplectic to rounding.
    """

    symplectic = True

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


class ExplicitRungeKutta(Propagator):
    """An explicit Runge-Kutta method given by its Butcher tableau.

    Parameters
    ----------
    name, order : as in `Propagator`
    a : (s, s) strictly lower triangular
    b, c : (s,) weights and abscissae
    """

    def __init__(self, name: str, order: int, a: npt.ArrayLike, b: npt.ArrayLike, c: npt.ArrayLike) -> None:
        self.name = name
        self.order = order
        self._a = np.asarray(a, dtype=float)
        self._b = np.asarray(b, dtype=float)
        self.nodes = np.asarray(c, dtype=float)

    def step_matrices(self, A: FloatArray, h: FloatArray) -> FloatArray:
        """See `Propagator.step_matrices`; K_i = A_i (I + h sum_j a_ij K_j), then I + h sum b_i K_i."""
        hA = h[:, None, None, None] * A
        eye = np.eye(A.shape[-1])
        slopes = np.zeros_like(hA)
        for i, row in enumerate(self._a):
            state = eye + np.einsum("j,kjab->kab", row[:i], slopes[:, :i])
            slopes[:, i] = hA[:, i] @ state
        return np.asarray(eye + np.einsum("i,kiab->kab", self._b, slopes))
