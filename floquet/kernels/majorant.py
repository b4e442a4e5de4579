"""How many Taylor terms are enough: a scalar recurrence that dominates the vector one, compiled.

The Taylor coefficients x_k of x' = A(tau) x, A(tau) = sum_j A_j tau^j, obey (k+1) x_{k+1} = sum_j A_j
x_{k-j}; hence |x_k| <= r_k with r_0 = 1, (k+1) r_{k+1} = sum_j a_j r_{k-j}, for any a_j >= |A_j|. This gives,
before any vector is computed, the degree p after which the neglected terms sum to less than the tolerance.
The solution from rest under a forcing f then has |x_{k+1}| <= h |f| r_k, by induction from the same
recurrence.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from floquet.system import FloatArray

MAX_TERMS = 64
"""Largest Taylor degree."""
_INVERSE = 1.0 / np.arange(1, MAX_TERMS + 3)
_INVERSE = np.concatenate([[np.inf], _INVERSE])


@numba.njit(cache=True, fastmath={"contract"}, error_model="numpy", _nrt=False)
def shift(poly: FloatArray, degree: int, u: float, scale: float, out: FloatArray) -> None:
    """Coefficients of tau -> poly(u + scale tau) by synthetic division, (degree+1, m) lowest first."""
    m = poly.shape[1]
    for j in range(degree + 1):
        for r in range(m):
            out[j, r] = poly[j, r]
    for j in range(degree):
        for i in range(degree - 1, j - 1, -1):
            for r in range(m):
                out[i, r] += u * out[i + 1, r]
    factor = 1.0
    for j in range(1, degree + 1):
        factor *= scale
        for r in range(m):
            out[j, r] *= factor


@numba.njit(cache=True, error_model="numpy", _nrt=False)
def norm(row: FloatArray) -> float:
    """Euclidean norm."""
    total = 0.0
    for value in row:
        total += value * value
    return math.sqrt(total)


@numba.njit(cache=True, error_model="numpy", _nrt=False)
def _enough_constant(a: float, tolerance: float, r: FloatArray) -> tuple[int, float, float, float]:
    """`enough_terms` for degree 0: r_k = a^k/k!."""
    size = 1.0
    for k in range(MAX_TERMS):
        r[k + 1] = r[k] * a / (k + 1)
        size += r[k + 1]
        theta = a / (k + 2)
        tail = theta / (1.0 - theta) * r[k + 1]
        if theta < 0.5 and tail <= tolerance:
            return k + 1, tail, tail + r[k + 1], size
    return -1, math.inf, math.inf, size


@numba.njit(cache=True, fastmath={"contract"}, error_model="numpy", _nrt=False)
def enough_terms(
    a: FloatArray, degree: int, tolerance: float, r: FloatArray
) -> tuple[int, float, float, float]:
    """Degree p, bounds on everything beyond it, sum_k r_k; p = -1 when MAX_TERMS do not suffice.

    With rho_k the largest of the last degree + 1 values r and theta = sum a/(k+1) < 1, r_{k+1} <= theta
    rho_k, so the terms after k sum to at most (degree + 1) theta/(1 - theta) rho_k.

    Returns
    -------
    p; bound on the neglected terms of the flow; the same, per unit of h |f|, of the solution from rest; sum
    of the r_k kept, which measures rounding
    """
    total = 0.0
    for j in range(degree + 1):
        total += a[j]
    r[0] = 1.0
    if degree == 0:
        terms, tail, tail_f, size = _enough_constant(a[0], tolerance, r)
        return terms, tail, tail_f, size
    size = 1.0
    for k in range(MAX_TERMS):
        value = 0.0
        for j in range(min(degree, k), -1, -1):  # the newest last: the older ones need not wait for it
            value += a[j] * r[k - j]
        r[k + 1] = value * _INVERSE[k + 1]
        size += r[k + 1]
        theta = total * _INVERSE[k + 2]
        # The newest value alone must pass before the others are looked at.
        if theta < 0.5 and k >= degree and (degree + 1) * theta * r[k + 1] <= tolerance:
            largest = 0.0
            for j in range(degree + 1):
                largest = max(largest, r[k + 1 - j])
            tail = (degree + 1) * theta / (1.0 - theta) * largest
            if tail <= tolerance:
                return k + 1, tail, tail + r[k + 1], size
    return -1, math.inf, math.inf, size
