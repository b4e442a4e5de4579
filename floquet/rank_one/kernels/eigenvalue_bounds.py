"""Disks that hold the eigenvalues of small real matrices, proven by residuals, compiled.

Sources: docs/theory/proven_bounds.md, "Multipliers".
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from floquet.rank_one.kernels.eigenvalues import eigenvalues
from lumped.compiler import compiled
from lumped.typing import ComplexArray, FloatArray

_EPS = 2.220446049250313e-16
_U = 0.5 * _EPS


@compiled(_nrt=False, forceinline=True)
def _vectors_of(
    LU: ComplexArray,
    pivots: npt.NDArray[np.int64],
    A: FloatArray,
    shift: complex,
    x: ComplexArray,
    y: ComplexArray,
) -> None:
    """Right and left null vectors x, y (n,) of A - shift I, y^T x = 1, |x| = |y|.

    By one inverse iteration, for the shift is an eigenvalue to rounding: y from a vector of no symmetry, x
    from L times that vector, its rows exchanged back.
    """
    n = A.shape[0]
    scale = 0.0
    for i in range(n):
        for j in range(n):
            LU[i, j] = A[i, j]
            scale += abs(A[i, j])
        LU[i, i] -= shift
    tiny = _EPS * scale + 1e-300
    for k in range(n):
        p = k
        most = -1.0
        for i in range(k, n):
            size = abs(LU[i, k].real) + abs(LU[i, k].imag)
            if size > most:
                p = i
                most = size
        pivots[k] = p
        if p != k:
            for j in range(n):
                other = LU[k, j]
                LU[k, j] = LU[p, j]
                LU[p, j] = other
        if most < tiny:
            LU[k, k] = tiny
        # The pivot is kept as its inverse: complex divisions are slow.
        c = LU[k, k]
        square = c.real * c.real + c.imag * c.imag
        inverse = complex(c.real / square, -c.imag / square)
        LU[k, k] = inverse
        for i in range(k + 1, n):
            factor = LU[i, k] * inverse
            LU[i, k] = factor
            for j in range(k + 1, n):
                LU[i, j] -= factor * LU[k, j]
    for i in range(n):
        x[i] = 1.0 / (1.0 + 0.6180339887 * i)  # no symmetry, which would keep it off a vector
        y[i] = x[i]
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            x[i] -= LU[i, j] * x[j]
        x[i] *= LU[i, i]
    _normalise(x)
    for i in range(n):
        for j in range(i):
            y[i] -= LU[j, i] * y[j]
        y[i] *= LU[i, i]
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            y[i] -= LU[j, i] * y[j]
    for k in range(n - 1, -1, -1):
        other = y[k]
        y[k] = y[pivots[k]]
        y[pivots[k]] = other
    _normalise(y)
    dot = 0.0 + 0.0j
    for i in range(n):
        dot += y[i] * x[i]
    size = math.sqrt(dot.real * dot.real + dot.imag * dot.imag)
    if size > 0.0:
        root = 1.0 / math.sqrt(size)
        turned = complex(dot.real / size, -dot.imag / size) * root
        for i in range(n):
            x[i] *= root
            y[i] *= turned
    else:
        x[0] = math.nan


@compiled(_nrt=False, forceinline=True)
def _normalise(x: ComplexArray) -> None:
    """Scale x to length one."""
    square = 0.0
    for i in range(x.size):
        square += x[i].real * x[i].real + x[i].imag * x[i].imag
    if square > 1e-280 and math.isfinite(square):
        factor = 1.0 / math.sqrt(square)
    else:  # beyond the range of squares
        largest = 0.0
        for i in range(x.size):
            largest = max(largest, abs(x[i].real) + abs(x[i].imag))
        factor = 1.0 / largest if largest > 0.0 else math.nan
    for i in range(x.size):
        x[i] *= factor


@compiled(_nrt=False, forceinline=True)
def _partners(values: ComplexArray, partner: npt.NDArray[np.int64]) -> None:
    """Which value is the conjugate of each; conjugates stand side by side."""
    for p in range(values.size):
        partner[p] = p
        if (
            p > 0
            and partner[p - 1] == p - 1
            and values[p].imag != 0.0
            and values[p] == values[p - 1].conjugate()
        ):
            partner[p] = p - 1
            partner[p - 1] = p


@compiled(_nrt=False, forceinline=True)
def _eigenvectors(
    A: FloatArray,
    values: ComplexArray,
    LU: ComplexArray,
    pivots: npt.NDArray[np.int64],
    X: ComplexArray,
    Y: ComplexArray,
    partner: npt.NDArray[np.int64],
) -> None:
    """Approximate right and left eigenvectors, rows of X and of Y."""
    n = A.shape[0]
    for p in range(n):
        if partner[p] < p:
            for i in range(n):
                X[p, i] = X[p - 1, i].conjugate()
                Y[p, i] = Y[p - 1, i].conjugate()
        else:
            _vectors_of(LU, pivots, A, values[p], X[p], Y[p])


@compiled(_nrt=False, forceinline=True)
def _modulus(z: complex) -> float:
    """|z|, rounded up a little: faster than a careful abs where nothing overflows."""
    return math.sqrt(z.real * z.real + z.imag * z.imag) * (1.0 + 4.0 * _EPS) + 1e-150


@compiled(_nrt=False, forceinline=True)
def _entries(
    A: FloatArray, values: ComplexArray, X: ComplexArray, Y: ComplexArray, partner: npt.NDArray[np.int64],
    delta: float, sizes: FloatArray, work: ComplexArray, f: FloatArray,
) -> float:  # fmt: skip
    """Bounds f (n, n) on the entries of X^-1 (A + E) X - diag(values) for every |E| <= delta.

    X, here by columns, and Y are any matrices with q = |I - Y X| < 1, row sums. With R = I - Y X and G = Y (A
    + E) X - D the matrix is (I - R)^-1 (G + R D), so that f = |G| + |R||D| plus q_i/(1 - q) times the largest
    entry of a column. Each entry of R and of G is computed with its rounding: a product of n complex terms is
    right to 4 (n + 4) u of the norms of row and column. Returns q.
    """
    n = A.shape[0]
    rounding = 4.0 * (n + 4.0) * _U
    total = 0.0
    for i in range(n):
        square = 0.0
        for j in range(n):
            square += X[i, j].real * X[i, j].real + X[i, j].imag * X[i, j].imag
            total += A[i, j] * A[i, j]
        sizes[0, i] = math.sqrt(square)
        square = 0.0
        for j in range(n):
            square += Y[i, j].real * Y[i, j].real + Y[i, j].imag * Y[i, j].imag
        sizes[1, i] = math.sqrt(square)
    total = math.sqrt(total)
    for j in range(n):
        if partner[j] < j:
            for i in range(n):
                work[j, i] = work[j - 1, i].conjugate()
            continue
        for i in range(n):
            real = 0.0
            imaginary = 0.0
            for k in range(n):
                real += A[i, k] * X[j, k].real
                imaginary += A[i, k] * X[j, k].imag
            work[j, i] = complex(real, imaginary)
    worst = 0.0
    for i in range(n):
        if partner[i] < i:  # the conjugate of the row before
            sizes[2, i] = sizes[2, i - 1]
            for j in range(n):
                f[i, j] = f[i - 1, partner[j]]
            continue
        row = 0.0
        for j in range(n):
            gain = 0.0 + 0.0j
            rest = 0.0 + 0.0j
            if i == j:
                gain = -values[i]
                rest = -1.0 + 0.0j
            for k in range(n):
                gain += Y[i, k] * work[j, k]
                rest += Y[i, k] * X[j, k]
            reach = sizes[1, i] * sizes[0, j]
            off = _modulus(rest) + rounding * (reach + 1.0)
            f[i, j] = _modulus(gain) + 2.0 * rounding * (reach * total + _modulus(values[i])) + delta * reach
            f[i, j] += off * _modulus(values[j])
            row += off
        sizes[2, i] = row
        if not row <= worst:
            worst = row
    if not worst < 0.5:
        return worst
    for j in range(n):
        largest = 0.0
        for i in range(n):
            largest = max(largest, f[i, j])
        for i in range(n):
            f[i, j] = (f[i, j] + sizes[2, i] / (1.0 - worst) * largest) * (1.0 + 1e-12)
    return worst


@compiled(_nrt=False, forceinline=True)
def _gershgorin(values: ComplexArray, f: FloatArray, rows: FloatArray, radii: FloatArray) -> None:
    """Radii by Gershgorin's theorem for diag(values) + F, |F_ij| <= f_ij, with R_i = sum_j f_ij.

    Where every |lambda_i - lambda_j| is at least 2 (R_i + R_j), scaling the i-th coordinate by tau = max_j 2
    f_ji/|lambda_i - lambda_j| leaves disk i apart and shrinks its radius to f_ii + tau (R_i - f_ii).
    """
    n = values.size
    for i in range(n):
        rows[i] = 0.0
        for j in range(n):
            rows[i] += f[i, j]
    for i in range(n):
        tau = 0.0
        for j in range(n):
            if j != i:
                gap = _modulus(values[i] - values[j]) * (1.0 - 1e-12)
                if gap < 2.0 * (rows[i] + rows[j]):
                    tau = 1.0
                elif gap * tau < 2.0 * f[j, i]:
                    tau = 2.0 * f[j, i] / gap
        radii[i] = (f[i, i] + min(tau, 1.0) * (rows[i] - f[i, i])) * (1.0 + 1e-12)


@compiled(_nrt=False, forceinline=True)
def _join(values: ComplexArray, radii: FloatArray, scratch: FloatArray, group: npt.NDArray[np.int64]) -> None:
    """Widen the radii of overlapping disks: a union of k disks apart from the others holds k eigenvalues."""
    n = values.size
    for i in range(n):
        group[i] = i
        scratch[i] = radii[i]
    for i in range(n):
        for j in range(i):
            if group[i] != group[j] and _modulus(values[i] - values[j]) <= radii[i] + radii[j]:
                old = group[i]
                new = group[j]
                for k in range(n):
                    if group[k] == old:
                        group[k] = new
    for i in range(n):
        for j in range(n):
            if j != i and group[i] == group[j]:
                radii[i] = max(radii[i], (_modulus(values[i] - values[j]) + scratch[j]) * (1.0 + 1e-12))


@compiled(nogil=True)
def spectra(
    M: FloatArray, delta: FloatArray, values: ComplexArray, radii: FloatArray, safe: npt.NDArray[np.bool_]
) -> None:
    """Eigenvalues (N, n) of M (N, n, n) wrong by delta (N,), 2-norm, each with a disk for as many exact ones.

    The radii follow from what is left of X^-1 M X - D, computed with its rounding. Where ``safe`` (N,) the
    eigenvectors are good enough, so that each is a bound for its own eigenvalue; where disks overlap it
    reaches around all of those that hang together.
    """
    n = M.shape[1]
    A = np.empty((n, n))
    f = np.empty((n, n))
    sizes = np.empty((3, n))
    vectors = np.empty((3, n, n), np.complex128)
    pivots = np.empty(n, np.int64)
    X = vectors[0]
    Y = vectors[1]
    LU = vectors[2]
    partner = np.empty(n, np.int64)
    group = np.empty(n, np.int64)
    for point in range(M.shape[0]):
        for i in range(n):
            for j in range(n):
                A[i, j] = M[point, i, j]
        found = eigenvalues(A, values[point], sizes[0])
        _partners(values[point], partner)
        _eigenvectors(M[point], values[point], LU, pivots, X, Y, partner)
        q = _entries(M[point], values[point], X, Y, partner, delta[point], sizes, LU, f)
        _gershgorin(values[point], f, sizes[2], radii[point])
        _join(values[point], radii[point], sizes[2], group)
        # Beyond this, values that nearly meet do better as a cluster.
        good = found and q < 0.01
        for i in range(n):
            good = good and sizes[0, i] * sizes[1, i] < 1e6
        safe[point] = good
