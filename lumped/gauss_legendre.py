"""Gauss-Legendre collocation, a symplectic and A-stable method.

Source: E. Hairer, C. Lubich and G. Wanner, Geometric Numerical Integration, 2006.
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from lumped.typing import FloatArray


class ButcherTableau(NamedTuple):
    """Butcher tableau of a method with s stages: a (s, s), weights b (s,), nodes c (s,) in [0, 1]."""

    a: FloatArray
    b: FloatArray
    c: FloatArray


@cache
def gauss_tableau(stages: int) -> ButcherTableau:
    """Return the Butcher tableau of the Gauss method with s stages, which has the order 2 s."""
    nodes, weights = legendre.leggauss(stages)
    c = 0.5 * (nodes + 1.0)
    b = 0.5 * weights
    # a_ij is the integral of the j-th Lagrange polynomial. Legendre polynomials do not amplify rounding.
    values = legendre.legvander(nodes, stages)
    odd = 2 * np.arange(stages) + 1
    integrals = np.column_stack([nodes + 1.0, (values[:, 2:] - values[:, :-2]) / odd[1:]])
    a = 0.5 * (integrals * odd) @ (values[:, :-1].T * b)
    return ButcherTableau(a, b, c)
