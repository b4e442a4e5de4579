"""Eigenvalues and their condition numbers for many small real matrices, compiled.

LAPACK through numpy takes 20 us for one 6 x 6 matrix, most of it overhead, which is more than propagating the
system; hence an own Francis iteration. It is checked against LAPACK on random and on defective matrices.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from floquet.rank_one.kernels.compiled import compiled
from lumped.typing import ComplexArray, FloatArray

_EPS = 2.220446049250313e-16
_MAX_SWEEPS = 60


@compiled()
def _hessenberg(A: FloatArray) -> None:
    """Reduce A (n, n) to upper Hessenberg form in place by Householder reflections."""
    n = A.shape[0]
    u = np.zeros(n)
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


@compiled()
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
            x, y = H[k + 1, k], H[k + 2, k]
            z = H[k + 3, k] if k + 3 <= hi else 0.0


@compiled()
def _eigenvalues(A: FloatArray, values: ComplexArray) -> bool:
    """Eigenvalues of A (overwritten); conjugate pairs stand side by side. False: no convergence."""
    n = A.shape[0]
    _hessenberg(A)
    scale = 0.0
    for i in range(n):
        for j in range(n):
            scale += abs(A[i, j])
    hi, sweeps = n - 1, 0
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
            hi, sweeps = hi - 1, 0
            continue
        a, b, c, d = A[hi - 1, hi - 1], A[hi - 1, hi], A[hi, hi - 1], A[hi, hi]
        if lo == hi - 1:
            half, product = 0.5 * (a - d), b * c
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
            hi, sweeps = hi - 2, 0
            continue
        sweeps += 1
        if sweeps > _MAX_SWEEPS:
            return False
        sum_, product = a + d, a * d - b * c
        if sweeps % 11 == 10:  # an exceptional shift breaks the rare cycle
            size = abs(A[hi, hi - 1]) + abs(A[hi - 1, hi - 2])
            sum_, product = 1.5 * size, size * size
        _francis(A, lo, hi, sum_, product)
    return True


@compiled()
def _condition_numbers(
    A: FloatArray, values: ComplexArray, B: FloatArray, product: FloatArray, kappa: FloatArray
) -> None:
    """Condition numbers kappa_i = |adj(lambda_i I - A)|_F / |prod_(j != i) (lambda_i - lambda_j)|.

    They are |x||y|/|y^H x| for a simple eigenvalue, adj(lambda I - A) being the rank-one matrix of its
    right and left eigenvectors. Its coefficients in powers of
    lambda come from the recurrence of Faddeev and LeVerrier; B (n, n, n) and product (n, n) are scratch.
    """
    n = A.shape[0]
    for i in range(n):
        for j in range(n):
            B[0, i, j] = 1.0 if i == j else 0.0
    for k in range(1, n):
        trace = 0.0
        for i in range(n):
            for j in range(n):
                product[i, j] = 0.0
            for q in range(n):
                factor = A[i, q]
                for j in range(n):
                    product[i, j] += factor * B[k - 1, q, j]
            trace += product[i, i]
        c = -trace / k
        for i in range(n):
            for j in range(n):
                B[k, i, j] = product[i, j]
            B[k, i, i] += c
    for p in range(n):
        if p > 0 and values[p] == values[p - 1].conjugate() and values[p].imag != 0.0:
            kappa[p] = kappa[p - 1]
            continue
        re, im = values[p].real, values[p].imag
        square = 0.0
        for i in range(n):
            for j in range(n):
                x, y = 0.0, 0.0
                for k in range(n):  # Horner in lambda: B[0] lambda^(n-1) + ... + B[n-1]
                    x, y = x * re - y * im + B[k, i, j], x * im + y * re
                square += x * x + y * y
        gap = 1.0
        for q in range(n):
            if q != p:
                gap *= abs(values[p] - values[q])
        kappa[p] = math.sqrt(square) / gap if gap > 0.0 else math.inf


@compiled()
def _disks(values: ComplexArray, kappa: FloatArray, size: float, radii: FloatArray) -> None:
    """Radii by Gershgorin's theorem for diag(values) + F, |F_ij| <= f_ij = size sqrt(kappa_i kappa_j).

    R_i = sum_j f_ij. Where every |lambda_i - lambda_j| is at least 2 (R_i + R_j), scaling the i-th coordinate
    by tau = max_j 2 f_ij/|lambda_i - lambda_j| leaves disk i apart from the others and shrinks its radius to
    f_ii + tau (R_i - f_ii): hardly more than the first order, size kappa_i.
    """
    n = values.size
    total = 0.0
    for i in range(n):
        total += math.sqrt(kappa[i])
    for i in range(n):
        root = math.sqrt(kappa[i])
        own, full = size * kappa[i], size * root * total
        tau = 0.0
        for j in range(n):
            if j != i:
                gap = abs(values[i] - values[j])
                other = math.sqrt(kappa[j])
                if gap < 2.0 * (full + size * other * total):
                    tau = 1.0
                elif gap * tau < 2.0 * size * root * other:
                    tau = 2.0 * size * root * other / gap
        radii[i] = own + tau * (full - own)


@compiled()
def _join(values: ComplexArray, radii: FloatArray, scratch: FloatArray, group: npt.NDArray[np.int64]) -> None:
    """Widen the radii of overlapping disks: a union of k disks apart from the others holds k eigenvalues."""
    n = values.size
    for i in range(n):
        group[i] = i
        scratch[i] = radii[i]
    for i in range(n):
        for j in range(i):
            if group[i] != group[j] and abs(values[i] - values[j]) <= radii[i] + radii[j]:
                old, new = group[i], group[j]
                for k in range(n):
                    if group[k] == old:
                        group[k] = new
    for i in range(n):
        for j in range(n):
            if j != i and group[i] == group[j]:
                radii[i] = max(radii[i], abs(values[i] - values[j]) + scratch[j])


@compiled(nogil=True)
def spectra(
    M: FloatArray, delta: FloatArray, values: ComplexArray, radii: FloatArray, safe: npt.NDArray[np.bool_]
) -> None:
    """Eigenvalues of N matrices, each with a disk that holds as many exact ones, when M is wrong by delta.

    With left and right eigenvectors scaled to |x_i| = |y_i| = sqrt(kappa_i) the entries of Y^H E X are at
    most delta sqrt(kappa_i kappa_j), from which Gershgorin's theorem gives the radii (`_disks`).

    Parameters
    ----------
    M : (N, n, n)
    delta : (N,) bound on the 2-norm of the error of each
    values : (N, n), out
    radii : (N, n), out
    safe : (N,), out: the condition numbers are well determined, so that each radius is a bound for its own
        eigenvalue; where disks overlap it reaches around all of those that hang together
    """
    n = M.shape[1]
    A, B, product = np.empty((n, n)), np.empty((n, n, n)), np.empty((n, n))
    kappa, group = np.empty(n), np.empty(n, dtype=np.int64)
    for point in range(M.shape[0]):
        square = 0.0
        for i in range(n):
            for j in range(n):
                A[i, j] = M[point, i, j]
                square += A[i, j] * A[i, j]
        ok = _eigenvalues(A, values[point])
        _condition_numbers(M[point], values[point], B, product, kappa)
        for i in range(n):
            # Rounding of the recurrence: a condition number is worthless once it nears 1/sqrt(eps).
            ok = ok and kappa[i] < 1e6
        # Backward error of the QR iteration, as for LAPACK's. 1.01: relative error of the condition numbers.
        size = 1.01 * (delta[point] + 4.0 * n * _EPS * math.sqrt(square))
        _disks(values[point], kappa, size, radii[point])
        _join(values[point], radii[point], kappa, group)
        safe[point] = ok
