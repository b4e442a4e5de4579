"""Explicit Runge-Kutta methods applied to the matrix equation.

Sources: Hairer, Nørsett and Wanner, Solving Ordinary Differential Equations I, 1993.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from scipy.integrate import DOP853

from floquet.engine.propagators.base import Propagator
from lumped.typing import FloatArray


class ExplicitRungeKutta(Propagator):
    """An explicit Runge-Kutta method given by its Butcher tableau.

    Parameters
    ----------
    name, order : as in `Propagator`
    a : (s, s) strictly lower triangular
    b, c : (s,) weights and abscissae
    """

    def __init__(self, name: str, order: int, a: npt.ArrayLike, b: npt.ArrayLike, c: npt.ArrayLike) -> None:
        self.name, self.order = name, order
        self._a, self._b = np.asarray(a, dtype=float), np.asarray(b, dtype=float)
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


def rk4() -> ExplicitRungeKutta:
    """Return the classical method of order 4."""
    a = np.zeros((4, 4))
    a[1, 0] = a[2, 1] = 0.5
    a[3, 2] = 1.0
    return ExplicitRungeKutta("rk4", 4, a, np.array([1.0, 2.0, 2.0, 1.0]) / 6.0, [0.0, 0.5, 0.5, 1.0])


def dop853() -> ExplicitRungeKutta:
    """Return the order-8 method of Dormand and Prince, with scipy's coefficients."""
    return ExplicitRungeKutta("dop853", 8, DOP853.A, DOP853.B, DOP853.C)
