"""Exponential methods: the exponential of a truncated Magnus series per step.

Sources: Blanes, Casas, Oteo and Ros, Physics Reports 470 (2009) 151-238.
"""

from __future__ import annotations

from abc import abstractmethod

import numpy as np
from scipy.linalg import expm

from floquet.engine.propagators.base import Propagator
from lumped.gauss_legendre import gauss_tableau
from lumped.typing import FloatArray


def _commutator(x: FloatArray, y: FloatArray) -> FloatArray:
    return np.asarray(x @ y - y @ x)


class _Exponential(Propagator):
    def __init__(self, name: str, order: int, stages: int) -> None:
        self.name, self.order = name, order
        self.nodes = gauss_tableau(stages)[2]

    @abstractmethod
    def exponent(self, hA: FloatArray) -> FloatArray:
        """Exponent Omega (k, n, n) of the step from h A at the nodes, (k, s, n, n)."""

    def step_matrices(self, A: FloatArray, h: FloatArray) -> FloatArray:
        """See `Propagator.step_matrices`; exp(Omega)."""
        return np.asarray(expm(self.exponent(h[:, None, None, None] * A)))


class PiecewiseExponential(_Exponential):
    """A frozen at the middle of each step: exact for piecewise constant A, order 2 otherwise."""

    def __init__(self) -> None:
        super().__init__("expm", 2, 1)

    def exponent(self, hA: FloatArray) -> FloatArray:
        """Omega = h A(t + h/2)."""
        return np.asarray(hA[:, 0])


class Magnus4(_Exponential):
    """Order 4 from two Gauss points (Iserles and Norsett 1999)."""

    def __init__(self) -> None:
        super().__init__("magnus4", 4, 2)

    def exponent(self, hA: FloatArray) -> FloatArray:
        """Omega = h (A1 + A2)/2 - sqrt(3)/12 h^2 [A1, A2]."""
        first, second = hA[:, 0], hA[:, 1]
        return np.asarray(0.5 * (first + second) - np.sqrt(3.0) / 12.0 * _commutator(first, second))


class Magnus6(_Exponential):
    """Order 6 from three Gauss points with three commutators (Blanes, Casas and Ros 2000)."""

    def __init__(self) -> None:
        super().__init__("magnus6", 6, 3)

    def exponent(self, hA: FloatArray) -> FloatArray:
        """Omega = a1 + a3/12 + [-20 a1 - a3 + C1, a2 + C2]/240, a_i = moments of h A about the middle."""
        a1 = hA[:, 1]
        a2 = np.sqrt(15.0) / 3.0 * (hA[:, 2] - hA[:, 0])
        a3 = 10.0 / 3.0 * (hA[:, 2] - 2.0 * hA[:, 1] + hA[:, 0])
        c1 = _commutator(a1, a2)
        c2 = -_commutator(a1, 2.0 * a3 + c1) / 60.0
        return np.asarray(a1 + a3 / 12.0 + _commutator(-20.0 * a1 - a3 + c1, a2 + c2) / 240.0)
