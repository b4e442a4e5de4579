"""Eigenvalues of a monodromy matrix that is known only to within an error, with a bound on each."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from scipy.linalg import schur
from scipy.linalg.lapack import ztrsen

from lumped.typing import ComplexArray, FloatArray

_EPS = float(np.finfo(np.float64).eps)


def _cluster_data(T: ComplexArray, Z: ComplexArray, members: list[int]) -> tuple[float, float, float]:
    """Norm of the spectral projector, separation from the rest, and departure |T11 - mean I| of a cluster."""
    n, m = T.shape[0], len(members)
    select = np.zeros(n, dtype=np.int32)
    select[members] = 1
    ordered, _, _, _, s, sep, _ = ztrsen(select, T, Z, lwork=max(1, 2 * m * (n - m)))
    block = ordered[:m, :m]
    departure = float(np.linalg.norm(block - np.trace(block) / m * np.eye(m), 2)) if m > 1 else 0.0
    if m == n:
        return 1.0, math.inf, departure
    # LAPACK's sep is an estimate that may be too large by sqrt(m (n - m)); s cannot be too large.
    return 1.0 / max(s, np.finfo(float).tiny), sep / math.sqrt(m * (n - m)), departure


def _cluster_bound(T: ComplexArray, Z: ComplexArray, members: list[int], delta: float) -> float | None:
    """Bound on the change of a cluster's eigenvalues when M changes by at most delta; None: not separable.

    Block-diagonalise with orthonormal bases: the diagonal blocks change by at most p delta and the
    off-diagonal blocks by p^2 delta and delta, p the norm of the projector. If 4 p delta < sep, an invariant
    subspace persists and the cluster's block changes by at most p delta + 2 (p delta)^2/(sep - 2 p delta)
    (Stewart and Sun, Matrix Perturbation Theory, chapter V). Within the block Elsner's theorem gives the m-th
    root law that a defective multiplier obeys: |d lambda| <= (2 |B| + e)^(1 - 1/m) e^(1/m), B taken about its
    mean.
    """
    p, sep, departure = _cluster_data(T, Z, members)
    pd = p * delta
    if sep <= 4.0 * pd:
        return None
    change = pd + (0.0 if math.isinf(sep) else 2.0 * pd * pd / (sep - 2.0 * pd))
    m = len(members)
    if m == 1:
        return change
    return float((2.0 * departure + change) ** (1.0 - 1.0 / m) * change ** (1.0 / m))


def multipliers_with_bounds(M: FloatArray, delta: float) -> tuple[ComplexArray, FloatArray]:
    """Eigenvalues of M, largest modulus first, each with a bound on its error.

    Parameters
    ----------
    M : (n, n), best in balanced coordinates
    delta : bound on the 2-norm of the error of M

    Returns
    -------
    multipliers : (n,) complex
    bounds : (n,); a simple multiplier's bound grows like delta, that of an m-fold defective one like
        delta^(1/m). Multipliers that delta does not allow to be told apart share one bound.
    """
    n = M.shape[0]
    delta = delta + 4.0 * n * _EPS * float(np.linalg.norm(M))  # backward error of the QR algorithm
    T, Z = schur(M, output="complex")
    eigenvalues = np.diagonal(T)
    clusters = [[i] for i in range(n)]
    bounds: list[float | None] = [None] * n
    while True:
        bounds = [_cluster_bound(T, Z, members, delta) for members in clusters]
        bad = next((i for i, b in enumerate(bounds) if b is None), None)
        if bad is None:
            break
        here = eigenvalues[clusters[bad]]
        distance = [
            math.inf if k == bad else float(np.abs(here[:, None] - eigenvalues[other]).min())
            for k, other in enumerate(clusters)
        ]
        nearest = int(np.argmin(distance))
        clusters[bad] = clusters[bad] + clusters[nearest]
        del clusters[nearest]
    values, errors = np.empty(n, dtype=complex), np.empty(n)
    for members, bound in zip(clusters, bounds, strict=True):
        values[members] = eigenvalues[members]
        errors[members] = bound
    # Largest modulus first; a conjugate pair (equal modulus up to rounding) with its positive phase first.
    order = sorted(
        range(n), key=lambda i: (-_significant(float(abs(values[i]))), -values[i].imag, -values[i].real)
    )
    return values[order], errors[order]


def _significant(x: float) -> float:
    """Round to 10 significant digits, so that the order of conjugate pairs does not hang on rounding."""
    return float(f"{x:.9e}")


def radius_with_bound(multipliers: ComplexArray, bounds: FloatArray) -> tuple[float, float]:
    """Spectral radius and a bound on its error from multipliers and their bounds."""
    modulus = np.abs(multipliers)
    radius = float(modulus.max())
    # No more than this below: the largest multiplier's own bound, which is at most as much.
    return radius, float((modulus + bounds).max()) - radius


def verdict(radius: float, error: float) -> str:
    """Say "stable" or "unstable" when the whole interval radius +- error does, else "undecided"."""
    if radius + error < 1.0:
        return "stable"
    return "unstable" if radius - error > 1.0 else "undecided"


def radii_with_bounds(multipliers: ComplexArray, errors: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Largest |multiplier| of each row, (N, n) -> (N,), and a bound on its error."""
    modulus = np.abs(multipliers)
    radius = modulus.max(axis=1)
    return radius, (modulus + errors).max(axis=1) - radius


def verdicts(radius: FloatArray, error: FloatArray) -> npt.NDArray[np.int8]:
    """1 stable, 0 undecided where radius +- error contains 1, -1 unstable; any shape."""
    return (radius + error < 1.0).astype(np.int8) - (radius - error > 1.0).astype(np.int8)
