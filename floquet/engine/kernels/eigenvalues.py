"""Eigenvalues of small real matrices by Francis's double-shift iteration, compiled.

LAPACK through numpy takes 20 us for one 6 x 6 matrix, most of it overhead, which is more than propagating the
system. Checked against LAPACK on random and on defective matrices.
"""

from __future__ import annotations

import math

from lumped.compiler import called
from lumped.typing import ComplexArray, FloatArray

_EPS = 2.220446049250313e-16
_MAX_SWEEPS = 60


@called
def _hessenberg(A: FloatArray, u: FloatArray) -> None:
    """Reduce A (n, n) to upper Hessenberg form in place by Householder reflections; u (n,) is scratch."""
    n = A.shape[0]
    for k in range(n - 2):
        norm = 0.0
        for i in range(k + 1, n):
            norm += A[i, k] * A[i, k]
        norm = math.sqrt(norm)
        if norm == 0.0:
            continue
        sign = 1.0 if A[k + 1, k] >= 0.0 else -1.0
        for i in range(k + 1, n):
            u[i] = A[i, k]
        u[k + 1] += sign * norm
        beta = 0.0
        for i in range(k + 1, n):
            beta += u[i] * u[i]
        if beta == 0.0:
            continue
        factor = 2.0 / beta
        for j in range(k, n):
            dot = 0.0
            for i in range(k + 1, n):
                dot += u[i] * A[i, j]
            dot *= factor
            for i in range(k + 1, n):
                A[i, j] -= dot * u[i]
        for i in range(n):
            dot = 0.0
            for j in range(k + 1, n):
                dot += A[i, j] * u[j]
            dot *= factor
            for j in range(k + 1, n):
                A[i, j] -= dot * u[j]
        for i in range(k + 2, n):
            A[i, k] = 0.0


@called
def _francis(H: FloatArray, lo: int, hi: int, sum_: float, product: float) -> None:
    """One implicit double-shift QR sweep on rows lo..hi; the shifts have this sum and product."""
    x = H[lo, lo] * H[lo, lo] + H[lo, lo + 1] * H[lo + 1, lo] - sum_ * H[lo, lo] + product
    y = H[lo + 1, lo] * (H[lo, lo] + H[lo + 1, lo + 1] - sum_)
    z = H[lo + 1, lo] * H[lo + 2, lo + 1] if hi > lo + 1 else 0.0
    for k in range(lo, hi):
        three = k + 2 <= hi
        if not three:
            z = 0.0
        norm = math.sqrt(x * x + y * y + z * z)
        if norm > 0.0:
            # Reflection I - u u^T/(norm |u0|) that sends (x, y, z) to a multiple of the first axis.
            u0 = x + norm if x >= 0.0 else x - norm
            factor = 1.0 / (norm * abs(u0))
            first = max(lo, k - 1)
            for j in range(first, hi + 1):
                dot = u0 * H[k, j] + y * H[k + 1, j]
                if three:
                    dot += z * H[k + 2, j]
                dot *= factor
                H[k, j] -= dot * u0
                H[k + 1, j] -= dot * y
                if three:
                    H[k + 2, j] -= dot * z
            last = min(hi, k + 3)
            for i in range(lo, last + 1):
                dot = H[i, k] * u0 + H[i, k + 1] * y
                if three:
                    dot += H[i, k + 2] * z
                dot *= factor
                H[i, k] -= dot * u0
                H[i, k + 1] -= dot * y
                if three:
                    H[i, k + 2] -= dot * z
        if k > lo:
            H[k + 1, k - 1] = 0.0
            if three:
                H[k + 2, k - 1] = 0.0
        if k < hi - 1:
            x = H[k + 1, k]
            y = H[k + 2, k]
            z = H[k + 3, k] if k + 3 <= hi else 0.0


@called
def eigenvalues(A: FloatArray, values: ComplexArray, scratch: FloatArray) -> bool:
    """Eigenvalues of A (overwritten); conjugate pairs stand side by side. False: no convergence.

    ``scratch`` is (n,).
    """
    n = A.shape[0]
    _hessenberg(A, scratch)
    scale = 0.0
    for i in range(n):
        for j in range(n):
            scale += abs(A[i, j])
    hi = n - 1
    sweeps = 0
    while hi >= 0:
        lo = hi
        while lo > 0:
            size = abs(A[lo, lo]) + abs(A[lo - 1, lo - 1])
            if size == 0.0:
                size = scale
            if abs(A[lo, lo - 1]) <= _EPS * size:
                A[lo, lo - 1] = 0.0
                break
            lo -= 1
        if lo == hi:
            values[hi] = A[hi, hi]
            hi = hi - 1
            sweeps = 0
            continue
        a = A[hi - 1, hi - 1]
        b = A[hi - 1, hi]
        c = A[hi, hi - 1]
        d = A[hi, hi]
        if lo == hi - 1:
            half = 0.5 * (a - d)
            product = b * c
            root = half * half + product
            if root >= 0.0:
                # The larger root without cancellation, the other from the determinant.
                shift = half + math.copysign(math.sqrt(root), half)
                values[hi - 1] = d + shift
                values[hi] = d - product / shift if shift != 0.0 else d
            else:
                middle = 0.5 * (a + d)
                values[hi - 1] = complex(middle, math.sqrt(-root))
                values[hi] = complex(middle, -math.sqrt(-root))
            hi = hi - 2
            sweeps = 0
            continue
        sweeps += 1
        if sweeps > _MAX_SWEEPS:
            return False
        sum_ = a + d
        product = a * d - b * c
        if sweeps % 11 == 10:  # an exceptional shift breaks the rare cycle
            size = abs(A[hi, hi - 1]) + abs(A[hi - 1, hi - 2])
            sum_ = 1.5 * size
            product = size * size
        _francis(A, lo, hi, sum_, product)
    return True
