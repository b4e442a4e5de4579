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
from floquet.rank_one.kernels.lanes import LANES, load, plus, scaled, store
from lumped.typing import FloatArray

MAX_TERMS = 64
"""Largest Taylor degree."""
RADII = np.concatenate([[1.0], np.geomspace(1.3, 60.0, 2 * LANES - 1)])
"""The R at which the bound is tried, after R = 1, which gives the sum of all r_k."""
_LOGS = np.log(RADII[1:])
_LOWER = np.log(RADII[1:] - 1.0)


@compiled(_nrt=False)
def norm(row: FloatArray) -> float:
    """Euclidean norm."""
    total = 0.0
    for value in row:
        total += value * value
    return math.sqrt(total)


@compiled()
def powers_of_radii(count: int) -> FloatArray:
    """R^(j+1)/(j+1), j = 0..count-1, for all RADII in two rows of lanes: (2, count, LANES)."""
    powers = np.empty((2, count, LANES))
    for i in range(2 * LANES):
        for j in range(count):
            powers[i // LANES, j, i % LANES] = RADII[i] ** (j + 1) / (j + 1)
    return powers


@compiled(fastmath={"contract"}, _nrt=False)
def enough_terms(
    a: FloatArray, degree: int, log_tolerance: float, powers: FloatArray, work: FloatArray
) -> tuple[int, float]:
    """Degree p after which the neglected terms sum to less than the tolerance; -1 above MAX_TERMS.

    Parameters
    ----------
    a : (d+1,) majorant
    degree : d
    log_tolerance : logarithm of the tolerance
    powers : as of `powers_of_radii`
    work : (2, LANES) scratch

    Returns
    -------
    p; sum of all r_k, which measures rounding
    """
    first, second = scaled(a[0], load(powers, (0, 0))), scaled(a[0], load(powers, (1, 0)))
    for j in range(1, degree + 1):
        first, second = plus(a[j], load(powers, (0, j)), first), plus(a[j], load(powers, (1, j)), second)
    store(work, (0,), first)
    store(work, (1,), second)
    best = 1.0 + MAX_TERMS
    for i in range(_LOGS.size):
        terms = (work[(i + 1) // LANES, (i + 1) % LANES] - _LOWER[i] - log_tolerance) / _LOGS[i]
        if terms < best:
            best = terms
    size = math.exp(work[0, 0])
    if not best <= MAX_TERMS:
        return -1, size
    return max(1, math.ceil(best)), size
