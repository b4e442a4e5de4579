"""How many Taylor terms are enough: a scalar series that dominates the vector one, compiled.

The Taylor coefficients x_k of x' = A(u) x, A(u) = sum_j A_j u^j, obey (k+1) x_{k+1} = sum_j A_j x_{k-j};
hence |x_k| <= r_k with r_0 = 1, (k+1) r_{k+1} = sum_j a_j r_{k-j}, for any a_j >= |A_j|. The r_k are the
coefficients of exp g(R), g(R) = sum_j a_j R^(j+1)/(j+1). They are not negative, so that r_k R^k <= exp g(R)
for every R > 0, and for every R > 1 the terms beyond degree p sum to at most

    exp(g(R)) R^-p/(R - 1)   for all |u| <= 1.

This gives p before any vector is computed.
"""

from __future__ import annotations

import math

import numpy as np

from floquet.rank_one.kernels.compiled import compiled
from floquet.rank_one.kernels.lanes import LANES, least, load, plus
from lumped.typing import FloatArray

MAX_TERMS = 64
"""Largest Taylor degree."""
RADII = np.geomspace(1.3, 60.0, 2 * LANES)
"""The R at which the bound is tried."""


@compiled(_nrt=False)
def norm(row: FloatArray) -> float:
    """Euclidean norm."""
    total = 0.0
    for value in row:
        total += value * value
    return math.sqrt(total)


@compiled()
def powers_of_radii(count: int) -> FloatArray:
    """What p at all RADII in two rows of lanes is made of, (2, count + 2, LANES).

    R^(j+1)/((j+1) log R) for a_j, j = 0..count-1; 1/log R for the logarithm of 1/tolerance; and what is left.
    """
    powers = np.empty((2, count + 2, LANES))
    for i in range(2 * LANES):
        R, row, lane = RADII[i], i // LANES, i % LANES
        for j in range(count):
            powers[row, j, lane] = R ** (j + 1) / (j + 1) / math.log(R)
        powers[row, count, lane] = 1.0 / math.log(R)
        powers[row, count + 1, lane] = -math.log(R - 1.0) / math.log(R)
    return powers


@compiled(fastmath={"contract"}, _nrt=False, forceinline=True)
def enough_terms(a: FloatArray, degree: int, log_tolerance: float, powers: FloatArray) -> tuple[int, float]:
    """Degree p after which the neglected terms sum to less than the tolerance; -1 above MAX_TERMS.

    Parameters
    ----------
    a : (d+1,) majorant
    degree : d
    log_tolerance : logarithm of the tolerance
    powers : as of `powers_of_radii`

    Returns
    -------
    p; sum of all r_k, which measures rounding
    """
    last = powers.shape[1] - 1
    first = plus(-log_tolerance, load(powers, (0, last - 1)), load(powers, (0, last)))
    second = plus(-log_tolerance, load(powers, (1, last - 1)), load(powers, (1, last)))
    exponent = 0.0
    for j in range(degree + 1):
        first, second = plus(a[j], load(powers, (0, j)), first), plus(a[j], load(powers, (1, j)), second)
        exponent += a[j] / (j + 1.0)
    best, size = least(first, second), math.exp(exponent)
    if not best <= MAX_TERMS:
        return -1, size
    return max(1, math.ceil(best)), size
