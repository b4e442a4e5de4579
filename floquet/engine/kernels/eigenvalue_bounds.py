"""Disks that hold the eigenvalues of small real matrices, compiled.

Proven here: each disk of `spectra` that is called safe, by residuals that are computed with their rounding:
`_entry_bounds`, `_gershgorin`, `_join`. The eigenvalues and eigenvectors need no proof.

Sources: docs/theory/proven_bounds.md, "Multipliers".
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from floquet.engine.kernels.eigenvalues import eigenvalues
from lumped.compiler import compiled, inlined
from lumped.typing import ComplexArray, FloatArray

_EPS = 2.220446049250313e-16
_U = 0.5 * _EPS


class Eigenvectors(NamedTuple):
    """Approximate eigenvectors of a matrix (n, n).

    Attributes
    ----------
    right, left : (n, n) rows x and y of A x = lambda x and A^T y = lambda y, y^T x = 1, |x| = |y|
    partner : (n,) index of the conjugate eigenvalue, which stands beside; of a real eigenvalue its own index
    """

    right: ComplexArray
    left: ComplexArray
    partner: npt.NDArray[np.int64]


class Factors(NamedTuple):
    """LU factors of A - shift I with exchanged rows.

    Attributes
    ----------
    LU : (n, n) the diagonal holds the inverses of the pivots: complex divisions are slow
    pivots : (n,) row with which each row was exchanged
    """

    LU: ComplexArray
    pivots: npt.NDArray[np.int64]


class EntryBounds(NamedTuple):
    """What bounds the entries of X^-1 (A + E) X - diag(values), and scratch.

    Attributes
    ----------
    entries : (n, n) bounds f
    right_norms, left_norms : (n,) norms of the eigenvectors
    residual_rows : (n,) row sums q_i of |I - Y X|, rounding included
    images : (n, n) rows A x
    """

    entries: FloatArray
    right_norms: FloatArray
    left_norms: FloatArray
    residual_rows: FloatArray
    images: ComplexArray


@inlined
def _shift(A: FloatArray, shift: complex, out: ComplexArray) -> float:
    """Out = A - shift I; returns the sum of |A_ij|."""
    scale = 0.0
    for i in range(A.shape[0]):
        for j in range(A.shape[0]):
            out[i, j] = A[i, j]
            scale += abs(A[i, j])
        out[i, i] -= shift
    return scale


@inlined
def _exchange_for_pivot(factors: Factors, k: int) -> float:
    """Exchange row k with the row of the largest element of column k below; the size of that element."""
    LU = factors.LU
    n = LU.shape[0]
    pivot = k
    largest = -1.0
    for i in range(k, n):
        size = abs(LU[i, k].real) + abs(LU[i, k].imag)
        if size > largest:
            pivot = i
            largest = size
    factors.pivots[k] = pivot
    if pivot != k:
        for j in range(n):
            element = LU[k, j]
            LU[k, j] = LU[pivot, j]
            LU[pivot, j] = element
    return largest


@inlined
def _inverse(c: complex) -> complex:
    """1/c; faster than a careful complex division."""
    square = c.real * c.real + c.imag * c.imag
    return complex(c.real / square, -c.imag / square)


@inlined
def _factorise(factors: Factors, tiny: float) -> None:
    """LU factorisation in place; a pivot below ``tiny`` is replaced by it, for A - shift I is singular."""
    LU = factors.LU
    n = LU.shape[0]
    for k in range(n):
        if _exchange_for_pivot(factors, k) < tiny:
            LU[k, k] = tiny
        inverse = _inverse(LU[k, k])
        LU[k, k] = inverse
        for i in range(k + 1, n):
            factor = LU[i, k] * inverse
            LU[i, k] = factor
            for j in range(k + 1, n):
                LU[i, j] -= factor * LU[k, j]


@inlined
def _solve_upper(LU: ComplexArray, x: ComplexArray) -> None:
    """Replace x by U^-1 x."""
    n = x.size
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            x[i] -= LU[i, j] * x[j]
        x[i] *= LU[i, i]


@inlined
def _solve_transposed(factors: Factors, y: ComplexArray) -> None:
    """Replace y by (A - shift I)^-T y: solve with U^T, then with L^T, then exchange the rows back."""
    LU = factors.LU
    n = y.size
    for i in range(n):
        for j in range(i):
            y[i] -= LU[j, i] * y[j]
        y[i] *= LU[i, i]
    for i in range(n - 1, -1, -1):
        for j in range(i + 1, n):
            y[i] -= LU[j, i] * y[j]
    for k in range(n - 1, -1, -1):
        element = y[k]
        y[k] = y[factors.pivots[k]]
        y[factors.pivots[k]] = element


@inlined
def _scale_to_each_other(x: ComplexArray, y: ComplexArray) -> None:
    """Scale unit vectors x and y to y^T x = 1 and |x| = |y|; x becomes nan if the vectors are orthogonal."""
    n = x.size
    dot = 0.0 + 0.0j
    for i in range(n):
        dot += y[i] * x[i]
    size = math.sqrt(dot.real * dot.real + dot.imag * dot.imag)
    if size > 0.0:
        root = 1.0 / math.sqrt(size)
        conjugate_phase = complex(dot.real / size, -dot.imag / size) * root
        for i in range(n):
            x[i] *= root
            y[i] *= conjugate_phase
    else:
        x[0] = math.nan


@inlined
def _null_vectors(A: FloatArray, shift: complex, factors: Factors, x: ComplexArray, y: ComplexArray) -> None:
    """Right and left null vectors x, y (n,) of A - shift I, y^T x = 1, |x| = |y|.

    By one inverse iteration, for the shift is an eigenvalue to rounding. y starts from a vector without
    symmetry, which could be orthogonal to an eigenvector; x starts from L times that vector, rows exchanged.
    """
    scale = _shift(A, shift, factors.LU)
    _factorise(factors, _EPS * scale + 1e-300)
    for i in range(x.size):
        x[i] = 1.0 / (1.0 + 0.6180339887 * i)
        y[i] = x[i]
    _solve_upper(factors.LU, x)
    _normalise(x)
    _solve_transposed(factors, y)
    _normalise(y)
    _scale_to_each_other(x, y)


@inlined
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


@inlined
def _find_partners(values: ComplexArray, partner: npt.NDArray[np.int64]) -> None:
    """Index of the conjugate of each eigenvalue; conjugates stand side by side."""
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


@inlined
def _eigenvectors(A: FloatArray, values: ComplexArray, factors: Factors, vectors: Eigenvectors) -> None:
    """Approximate right and left eigenvectors, once for each conjugate pair of eigenvalues."""
    n = A.shape[0]
    right = vectors.right
    left = vectors.left
    for p in range(n):
        if vectors.partner[p] < p:
            for i in range(n):
                right[p, i] = right[p - 1, i].conjugate()
                left[p, i] = left[p - 1, i].conjugate()
        else:
            _null_vectors(A, values[p], factors, right[p], left[p])


@inlined
def _modulus(z: complex) -> float:
    """|z|, rounded up a little: faster than a careful abs where nothing overflows."""
    return math.sqrt(z.real * z.real + z.imag * z.imag) * (1.0 + 4.0 * _EPS) + 1e-150


@inlined
def _row_norm(rows: ComplexArray, i: int) -> float:
    square = 0.0
    for j in range(rows.shape[1]):
        square += rows[i, j].real * rows[i, j].real + rows[i, j].imag * rows[i, j].imag
    return math.sqrt(square)


@inlined
def _frobenius(A: FloatArray) -> float:
    squares = 0.0
    for i in range(A.shape[0]):
        for j in range(A.shape[1]):
            squares += A[i, j] * A[i, j]
    return math.sqrt(squares)


@inlined
def _images(A: FloatArray, vectors: Eigenvectors, images: ComplexArray) -> None:
    """Rows A x of the right eigenvectors."""
    n = A.shape[0]
    for p in range(n):
        if vectors.partner[p] < p:
            for i in range(n):
                images[p, i] = images[p - 1, i].conjugate()
            continue
        for i in range(n):
            real = 0.0
            imaginary = 0.0
            for k in range(n):
                real += A[i, k] * vectors.right[p, k].real
                imaginary += A[i, k] * vectors.right[p, k].imag
            images[p, i] = complex(real, imaginary)


@inlined
def _bound_row(
    i: int, values: ComplexArray, vectors: Eigenvectors, size: float, delta: float, bounds: EntryBounds
) -> float:
    """Bounds |G_ij| + |R_ij| |lambda_j| on row i, rounding and delta included; returns the row sum of |R|.

    ``size`` is |A|. A product of n complex terms is right to 4 (n + 4) u of the norms of row and column.
    """
    n = values.size
    rounding = 4.0 * (n + 4.0) * _U
    row_sum = 0.0
    for j in range(n):
        G = 0.0 + 0.0j
        R = 0.0 + 0.0j
        if i == j:
            G = -values[i]
            R = -1.0 + 0.0j
        for k in range(n):
            G += vectors.left[i, k] * bounds.images[j, k]
            R += vectors.left[i, k] * vectors.right[j, k]
        norms = bounds.left_norms[i] * bounds.right_norms[j]
        R_bound = _modulus(R) + rounding * (norms + 1.0)
        entry = _modulus(G) + 2.0 * rounding * (norms * size + _modulus(values[i])) + delta * norms
        bounds.entries[i, j] = entry + R_bound * _modulus(values[j])
        row_sum += R_bound
    return row_sum


@inlined
def _conjugate_row(i: int, partner: npt.NDArray[np.int64], bounds: EntryBounds) -> None:
    """Bounds on row i of a conjugate eigenvalue: those of row i - 1 with conjugate columns exchanged."""
    bounds.residual_rows[i] = bounds.residual_rows[i - 1]
    for j in range(partner.size):
        bounds.entries[i, j] = bounds.entries[i - 1, partner[j]]


@inlined
def _add_inverse(q: float, bounds: EntryBounds) -> None:
    """Add what (I - R)^-1 makes of a column: q_i/(1 - q) times its largest entry."""
    n = bounds.residual_rows.size
    for j in range(n):
        largest = 0.0
        for i in range(n):
            largest = max(largest, bounds.entries[i, j])
        for i in range(n):
            entry = bounds.entries[i, j] + bounds.residual_rows[i] / (1.0 - q) * largest
            bounds.entries[i, j] = entry * (1.0 + 1e-12)


@inlined
def _entry_bounds(
    A: FloatArray, values: ComplexArray, vectors: Eigenvectors, delta: float, bounds: EntryBounds
) -> float:
    """Bounds f (n, n) on the entries of X^-1 (A + E) X - D for every |E| <= delta, D = diag(values).

    X, the right eigenvectors as columns, and Y, the left eigenvectors as rows, may be any matrices with row
    sums q_i of |R| below 1, R = I - Y X. With G = Y (A + E) X - D the matrix is (I - R)^-1 (G + R D). So
    f_ij = |G_ij| + |R_ij| |lambda_j| plus q_i/(1 - q) times the largest entry of column j. Each entry of R
    and of G is computed with its rounding. Returns q, the largest q_i; from 1/2 on there are no bounds.
    """
    n = A.shape[0]
    size = _frobenius(A)
    for i in range(n):
        bounds.right_norms[i] = _row_norm(vectors.right, i)
        bounds.left_norms[i] = _row_norm(vectors.left, i)
    _images(A, vectors, bounds.images)
    q = 0.0
    for i in range(n):
        if vectors.partner[i] < i:
            _conjugate_row(i, vectors.partner, bounds)
            continue
        row_sum = _bound_row(i, values, vectors, size, delta, bounds)
        bounds.residual_rows[i] = row_sum
        if not row_sum <= q:  # also where it is nan
            q = row_sum
    if q < 0.5:
        _add_inverse(q, bounds)
    return q


@compiled(_nrt=False, forceinline=True)
def _gershgorin(values: ComplexArray, f: FloatArray, rows: FloatArray, radii: FloatArray) -> None:
    """Radii by Gershgorin's theorem for diag(values) + F, |F_ij| <= f_ij, with R_i = sum_j f_ij.

    Where every |lambda_i - lambda_j| is at least 2 (R_i + R_j), the i-th coordinate is scaled by
    tau = max_j 2 f_ji/|lambda_i - lambda_j|. Disk i stays apart, and its radius shrinks to f_ii + tau
    (R_i - f_ii).
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
    """Widen each overlapping disk until the disk holds the union of all overlapping disks.

    A union of k disks apart from the other disks holds k eigenvalues.
    """
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
    """Eigenvalues (N, n) of M (N, n, n) wrong by delta (N,), 2-norm, with PROVEN disks of radii (N, n).

    The radii follow from the residual of X^-1 M X - D, computed with its rounding. Where ``safe`` (N,) is
    true the eigenvectors are good enough, and each radius bounds the error of its own eigenvalue. Where disks
    overlap each of them reaches around all disks of their union.
    """
    n = M.shape[1]
    A = np.empty((n, n))
    vectors = Eigenvectors(
        np.empty((n, n), np.complex128), np.empty((n, n), np.complex128), np.empty(n, np.int64)
    )
    factors = Factors(np.empty((n, n), np.complex128), np.empty(n, np.int64))
    # The factors are no longer used when the images are computed.
    bounds = EntryBounds(np.empty((n, n)), np.empty(n), np.empty(n), np.empty(n), factors.LU)
    scratch = np.empty(n)
    group = np.empty(n, np.int64)
    for point in range(M.shape[0]):
        for i in range(n):
            for j in range(n):
                A[i, j] = M[point, i, j]
        converged = eigenvalues(A, values[point], scratch)
        _find_partners(values[point], vectors.partner)
        _eigenvectors(M[point], values[point], factors, vectors)
        q = _entry_bounds(M[point], values[point], vectors, delta[point], bounds)
        _gershgorin(values[point], bounds.entries, scratch, radii[point])
        _join(values[point], radii[point], scratch, group)
        # Beyond these limits values that nearly meet do better as a cluster.
        good = converged and q < 0.01
        for i in range(n):
            good = good and bounds.right_norms[i] * bounds.left_norms[i] < 1e6
        safe[point] = good
