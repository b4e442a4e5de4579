"""Taylor propagation of a rank-one feedback system with a majorant error bound, compiled.

In modal coordinates of a reference problem (`floquet.rank_one`) the system reads

    eta'' + C eta' + omega^2 eta + w(t) (v . eta) + wd(t) (v . eta') = f(t),

with w, wd, f polynomials on every piece of the period. In the energy coordinates x = (omega eta, eta') the
part omega^2 is skew, so that one step of length h has the matrix A(tau) = sum_j A_j tau^j, 0 <= tau <= 1,
with

    |A_0| <= a_0 = h (max omega + |C| + |w_0| |v/omega| + |wd_0| |v|),   |A_j| <= a_j likewise without
    omega, C.

The Taylor coefficients x_k of the flow obey (k+1) x_{k+1} = sum_j A_j x_{k-j}; hence |x_k| <= r_k with r_0
= 1, (k+1) r_{k+1} = sum_j a_j r_{k-j}. This scalar majorant gives, before any vector is computed, the
degree p after which the neglected terms sum to less than the tolerance.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from floquet.system import FloatArray

LANES = 8
"""Columns carried at once: 6 states and one forcing (lane 6), padded to whole vector registers."""
FORCED = 6
MAX_TERMS = 64
"""Largest Taylor degree."""
_EPS = 2.220446049250313e-16


@numba.njit(cache=True, fastmath={"contract"}, error_model="numpy")
def _shift(poly: FloatArray, degree: int, u: float, scale: float, out: FloatArray) -> None:
    """Coefficients of tau -> poly(u + scale tau) by synthetic division; poly (m, d+1), lowest first."""
    for r in range(poly.shape[0]):
        for j in range(degree + 1):
            out[j, r] = poly[r, j]
        for j in range(degree):
            for i in range(degree - 1, j - 1, -1):
                out[i, r] += u * out[i + 1, r]
        factor = 1.0
        for j in range(1, degree + 1):
            factor *= scale
            out[j, r] *= factor


@numba.njit(cache=True, error_model="numpy")
def _norm(row: FloatArray) -> float:
    total = 0.0
    for value in row:
        total += value * value
    return math.sqrt(total)


@numba.njit(cache=True, error_model="numpy")
def _terms(a: FloatArray, degree: int, tolerance: float, r: FloatArray) -> tuple[int, float]:
    """Degree p and a bound on everything beyond it, from the majorant; p = -1 when MAX_TERMS do not suffice.

    With rho_k the largest of the last degree + 1 values r and theta = sum a/(k+1) < 1, r_{k+1} <= theta
    rho_k, so the terms after k sum to at most (degree + 1) theta/(1 - theta) rho_k.
    """
    total = 0.0
    for j in range(degree + 1):
        total += a[j]
    r[0] = 1.0
    for k in range(MAX_TERMS):
        value = 0.0
        for j in range(min(degree, k) + 1):
            value += a[j] * r[k - j]
        r[k + 1] = value / (k + 1)
        theta = total / (k + 2)
        if theta < 0.5 and k >= degree:
            largest = 0.0
            for j in range(degree + 1):
                largest = max(largest, r[k + 1 - j])
            tail = (degree + 1) * theta / (1.0 - theta) * largest
            if tail <= tolerance:
                return k + 1, tail
    return -1, math.inf


@numba.njit(cache=True, fastmath={"contract"}, error_model="numpy")
def _series(
    w: FloatArray,
    wd: FloatArray,
    f: FloatArray,
    degrees: tuple[int, int, int],
    terms: int,
    hC: FloatArray,
    h2_omega2: FloatArray,
    v: FloatArray,
    Z: FloatArray,
    s: FloatArray,
) -> None:
    """Fill Z[k] (m, LANES), the Taylor coefficients in step time, k = 2..terms+1, from Z[0] and Z[1]."""
    m = v.size
    dw, dd, df = degrees
    for k in range(2):
        for lane in range(LANES):
            total = 0.0
            for r in range(m):
                total += v[r] * Z[k, r, lane]
            s[k, lane] = total
    for k in range(terms):
        for r in range(m):
            # Eight named sums instead of a loop over lanes: they stay in registers and become vector
            # instructions, which a loop with stores to possibly overlapping arrays does not.
            factor = h2_omega2[r]
            a0 = factor * Z[k, r, 0]
            a1 = factor * Z[k, r, 1]
            a2 = factor * Z[k, r, 2]
            a3 = factor * Z[k, r, 3]
            a4 = factor * Z[k, r, 4]
            a5 = factor * Z[k, r, 5]
            a6 = factor * Z[k, r, 6]
            a7 = factor * Z[k, r, 7]
            for q in range(m):
                factor = (k + 1) * hC[r, q]
                a0 += factor * Z[k + 1, q, 0]
                a1 += factor * Z[k + 1, q, 1]
                a2 += factor * Z[k + 1, q, 2]
                a3 += factor * Z[k + 1, q, 3]
                a4 += factor * Z[k + 1, q, 4]
                a5 += factor * Z[k + 1, q, 5]
                a6 += factor * Z[k + 1, q, 6]
                a7 += factor * Z[k + 1, q, 7]
            for i in range(min(dw, k) + 1):
                factor = w[i, r]
                a0 += factor * s[k - i, 0]
                a1 += factor * s[k - i, 1]
                a2 += factor * s[k - i, 2]
                a3 += factor * s[k - i, 3]
                a4 += factor * s[k - i, 4]
                a5 += factor * s[k - i, 5]
                a6 += factor * s[k - i, 6]
                a7 += factor * s[k - i, 7]
            for i in range(min(dd, k) + 1):
                factor = wd[i, r] * (k + 1 - i)
                a0 += factor * s[k + 1 - i, 0]
                a1 += factor * s[k + 1 - i, 1]
                a2 += factor * s[k + 1 - i, 2]
                a3 += factor * s[k + 1 - i, 3]
                a4 += factor * s[k + 1 - i, 4]
                a5 += factor * s[k + 1 - i, 5]
                a6 += factor * s[k + 1 - i, 6]
                a7 += factor * s[k + 1 - i, 7]
            if k <= df:
                a6 -= f[k, r]
            factor = -1.0 / ((k + 1.0) * (k + 2.0))
            Z[k + 2, r, 0] = factor * a0
            Z[k + 2, r, 1] = factor * a1
            Z[k + 2, r, 2] = factor * a2
            Z[k + 2, r, 3] = factor * a3
            Z[k + 2, r, 4] = factor * a4
            Z[k + 2, r, 5] = factor * a5
            Z[k + 2, r, 6] = factor * a6
            Z[k + 2, r, 7] = factor * a7
        factor = v[0]
        a0 = factor * Z[k + 2, 0, 0]
        a1 = factor * Z[k + 2, 0, 1]
        a2 = factor * Z[k + 2, 0, 2]
        a3 = factor * Z[k + 2, 0, 3]
        a4 = factor * Z[k + 2, 0, 4]
        a5 = factor * Z[k + 2, 0, 5]
        a6 = factor * Z[k + 2, 0, 6]
        a7 = factor * Z[k + 2, 0, 7]
        for r in range(1, m):
            factor = v[r]
            a0 += factor * Z[k + 2, r, 0]
            a1 += factor * Z[k + 2, r, 1]
            a2 += factor * Z[k + 2, r, 2]
            a3 += factor * Z[k + 2, r, 3]
            a4 += factor * Z[k + 2, r, 4]
            a5 += factor * Z[k + 2, r, 5]
            a6 += factor * Z[k + 2, r, 6]
            a7 += factor * Z[k + 2, r, 7]
        s[k + 2, 0] = a0
        s[k + 2, 1] = a1
        s[k + 2, 2] = a2
        s[k + 2, 3] = a3
        s[k + 2, 4] = a4
        s[k + 2, 5] = a5
        s[k + 2, 6] = a6
        s[k + 2, 7] = a7


@numba.njit(cache=True, fastmath={"contract"}, error_model="numpy")
def _sums(Z: FloatArray, q: int, terms: int, out: FloatArray) -> None:
    """Position and h times rate of coordinate q at the end of the step, smallest terms first."""
    a0 = Z[terms, q, 0]
    a1 = Z[terms, q, 1]
    a2 = Z[terms, q, 2]
    a3 = Z[terms, q, 3]
    a4 = Z[terms, q, 4]
    a5 = Z[terms, q, 5]
    a6 = Z[terms, q, 6]
    a7 = Z[terms, q, 7]
    for k in range(terms - 1, -1, -1):
        a0 += Z[k, q, 0]
        a1 += Z[k, q, 1]
        a2 += Z[k, q, 2]
        a3 += Z[k, q, 3]
        a4 += Z[k, q, 4]
        a5 += Z[k, q, 5]
        a6 += Z[k, q, 6]
        a7 += Z[k, q, 7]
    out[0, 0] = a0
    out[0, 1] = a1
    out[0, 2] = a2
    out[0, 3] = a3
    out[0, 4] = a4
    out[0, 5] = a5
    out[0, 6] = a6
    out[0, 7] = a7
    factor = terms + 1.0
    a0 = factor * Z[terms + 1, q, 0]
    a1 = factor * Z[terms + 1, q, 1]
    a2 = factor * Z[terms + 1, q, 2]
    a3 = factor * Z[terms + 1, q, 3]
    a4 = factor * Z[terms + 1, q, 4]
    a5 = factor * Z[terms + 1, q, 5]
    a6 = factor * Z[terms + 1, q, 6]
    a7 = factor * Z[terms + 1, q, 7]
    for k in range(terms, 0, -1):
        factor = float(k)
        a0 += factor * Z[k, q, 0]
        a1 += factor * Z[k, q, 1]
        a2 += factor * Z[k, q, 2]
        a3 += factor * Z[k, q, 3]
        a4 += factor * Z[k, q, 4]
        a5 += factor * Z[k, q, 5]
        a6 += factor * Z[k, q, 6]
        a7 += factor * Z[k, q, 7]
    out[1, 0] = a0
    out[1, 1] = a1
    out[1, 2] = a2
    out[1, 3] = a3
    out[1, 4] = a4
    out[1, 5] = a5
    out[1, 6] = a6
    out[1, 7] = a7


@numba.njit(cache=True, fastmath={"contract"}, error_model="numpy", nogil=True)
def propagate_points(
    phases: FloatArray,
    w: FloatArray,
    wd: FloatArray,
    f: FloatArray,
    degrees: tuple[int, int, int],
    fit_error: FloatArray,
    damping_factor: FloatArray,
    C: FloatArray,
    omega: FloatArray,
    v: FloatArray,
    periods: FloatArray,
    tolerance: float,
    angle: float,
    max_steps: int,
    M: FloatArray,
    bound: FloatArray,
    forced: FloatArray,
) -> int:
    """Monodromy matrices in energy coordinates for many periods and damping factors.

    Parameters
    ----------
    phases : (P+1,) ends of the pieces as parts of the period, 0 to 1
    w, wd, f : (P, m, d+1) coefficients in powers of the piece's u in [-1, 1]; w [1/s^2], wd [1/s], f
    degrees : degrees to use of w, wd, f
    fit_error : (P, 2) largest |error| of w and of wd by their polynomials on each piece (2-norm over m)
    damping_factor : (N,) factor on wd per point
    C, omega, v : (m, m) [1/s], (m,) [rad/s], (m,)
    periods : (N,) [s]
    tolerance : of each step's truncation, relative to 1
    angle : largest majorant exponent per step
    max_steps : steps per period at most
    M : (N, 2m, 2m), out: Phi(T, 0) in x = (omega eta, eta')
    bound : (N,), out: bound on the Frobenius norm of the error of M, truncation, fit and rounding
    forced : (N, 2m), out: state at T from rest at 0 under f

    Returns
    -------
    index of the first point that needs more than max_steps or MAX_TERMS, -1 if none
    """
    m = v.size
    n = 2 * m
    pieces = phases.size - 1
    dw, dd, df = degrees
    d = max(dw, dd)
    ws, ds, fs = np.zeros((d + 1, m)), np.zeros((d + 1, m)), np.zeros((df + 1, m))
    a, r = np.zeros(d + 1), np.zeros(MAX_TERMS + 2)
    Z = np.zeros((MAX_TERMS + 2, m, LANES))
    s, sums = np.zeros((MAX_TERMS + 2, LANES)), np.zeros((2, LANES))
    steps = np.zeros((max_steps, n, n + 1))
    local = np.zeros(max_steps)
    hC, h2_omega2 = np.zeros((m, m)), np.zeros(m)
    after, product = np.zeros((n, n)), np.zeros((n, n))
    before = np.zeros(max_steps + 1)
    top = omega.max()
    nu = _norm(v / omega)
    nu_rate = _norm(v)
    norm_C = _norm(C.ravel())
    largest_w, largest_wd = np.zeros(pieces), np.zeros(pieces)
    for i in range(pieces):
        for j in range(d + 1):
            if j <= dw:
                largest_w[i] += _norm(w[i, :, j])
            if j <= dd:
                largest_wd[i] += _norm(wd[i, :, j])
    for point in range(periods.size):
        T, zeta = periods[point], damping_factor[point]
        count = 0
        for i in range(pieces):
            length = (phases[i + 1] - phases[i]) * T
            rate = top + norm_C + largest_w[i] * nu + largest_wd[i] * abs(zeta) * nu_rate
            parts = max(1, math.ceil(length * rate / angle))
            part = 0
            while part < parts:
                if count + parts - part > max_steps:
                    return point
                h = length / parts
                du = 2.0 / parts
                for q in range(m):
                    h2_omega2[q] = (h * omega[q]) ** 2
                    for p in range(m):
                        hC[q, p] = h * C[q, p]
                u = -1.0 + du * part
                _shift(w[i], dw, u, du, ws)
                _shift(wd[i], dd, u, du, ds)
                _shift(f[i], df, u, du, fs)
                a[0] = h * (top + norm_C)
                for j in range(1, d + 1):
                    a[j] = 0.0
                for j in range(dw + 1):
                    a[j] += h * _norm(ws[j]) * nu
                    for q in range(m):
                        ws[j, q] *= h * h
                for j in range(dd + 1):
                    a[j] += h * _norm(ds[j]) * abs(zeta) * nu_rate
                    for q in range(m):
                        ds[j, q] *= h * zeta
                for j in range(df + 1):
                    for q in range(m):
                        fs[j, q] *= h * h
                terms, tail = _terms(a, d, tolerance, r)
                if terms < 0:
                    # The polynomials vary too much within the step: begin the piece again with half of it.
                    count -= part
                    parts *= 2
                    part = 0
                    continue
                size = 0.0
                for k in range(terms + 1):
                    size += r[k]
                for k in range(2):
                    for q in range(m):
                        for lane in range(LANES):
                            Z[k, q, lane] = 0.0
                for q in range(m):
                    Z[0, q, q] = 1.0 / omega[q]
                    Z[1, q, m + q] = h
                _series(ws, ds, fs, degrees, terms, hC, h2_omega2, v, Z, s)
                P = steps[count]
                for q in range(m):
                    _sums(Z, q, terms, sums)
                    for lane in range(n + 1):
                        column = lane if lane < n else FORCED
                        P[q, lane] = omega[q] * sums[0, column]
                        P[m + q, lane] = sums[1, column] / h
                # Every coefficient is a sum of at most 2 d + 2 m + 4 rounded products of size r_k.
                rounding = _EPS * (2.0 * d + 2.0 * m + 8.0) * size
                # The skew part of A and the damping C do not let the energy grow; what is left of a does at
                # most.
                growth = -h * (top + norm_C)
                for j in range(d + 1):
                    growth += a[j]
                misfit = fit_error[i, 0] * nu + fit_error[i, 1] * abs(zeta) * nu_rate
                misfit *= h * math.exp(growth)
                local[count] = tail + rounding + misfit
                count += 1
                part += 1
        _accumulate(steps, local, before, count, after, product, M[point], bound, forced[point], point)
    return -1


@numba.njit(cache=True, fastmath={"contract"}, error_model="numpy")
def _accumulate(
    steps: FloatArray,
    local: FloatArray,
    before: FloatArray,
    count: int,
    after: FloatArray,
    product: FloatArray,
    M: FloatArray,
    bound: FloatArray,
    forced: FloatArray,
    point: int,
) -> None:
    """Multiply the steps and carry their errors to the end: sum |S_j| |E_j| |Q_j| as in `propagation`."""
    n = M.shape[0]
    for i in range(n):
        forced[i] = 0.0
        for j in range(n):
            M[i, j] = 1.0 if i == j else 0.0
    before[0] = math.sqrt(n)
    for k in range(count):
        P = steps[k]
        square = 0.0
        for i in range(n):
            total = P[i, n]
            for q in range(n):
                total += P[i, q] * forced[q]
            after[0, i] = total
            for j in range(n):
                product[i, j] = 0.0
            for q in range(n):
                factor = P[i, q]
                for j in range(n):
                    product[i, j] += factor * M[q, j]
        for i in range(n):
            forced[i] = after[0, i]
            for j in range(n):
                M[i, j] = product[i, j]
                square += M[i, j] * M[i, j]
        before[k + 1] = math.sqrt(square)
    for i in range(n):
        for j in range(n):
            after[i, j] = 1.0 if i == j else 0.0
    total = 0.0
    weight = math.sqrt(n)
    for k in range(count - 1, -1, -1):
        P = steps[k]
        square = 0.0
        for i in range(n):
            for j in range(n):
                square += P[i, j] * P[i, j]
        # n eps |P| is the rounding of multiplying by this step.
        total += weight * (local[k] + n * _EPS * math.sqrt(square)) * before[k]
        for i in range(n):
            for j in range(n):
                product[i, j] = 0.0
            for q in range(n):
                factor = after[i, q]
                for j in range(n):
                    product[i, j] += factor * P[q, j]
        square = 0.0
        for i in range(n):
            for j in range(n):
                after[i, j] = product[i, j]
                square += product[i, j] * product[i, j]
        weight = math.sqrt(square)
    bound[point] = total
