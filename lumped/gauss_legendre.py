"""Gauss-Legendre collocation, symplectic, A-stable: Hairer, Lubich, Wanner, Geometric Numerical Integration,
2006.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.polynomial import legendre

from lumped.typing import FloatArray


@cache
def gauss_tableau(stages: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Butcher tableau a (s, s), b (s,), c (s,) of the Gauss method with s stages, order 2 s, on [0, 1]."""
    nodes, weights = legendre.leggauss(stages)
    c, b = 0.5 * (nodes + 1.0), 0.5 * weights
    # a_ij integrates the j-th Lagrange polynomial, written in Legendre polynomials: no rounding is amplified.
    values = legendre.legvander(nodes, stages)
    odd = 2 * np.arange(stages) + 1
    integrals = np.column_stack([nodes + 1.0, (values[:, 2:] - values[:, :-2]) / odd[1:]])
    a = 0.5 * (integrals * odd) @ (values[:, :-1].T * b)
    return a, b, c
