"""Eigenvalues of a monodromy matrix that has an error, with a bound on the error of each eigenvalue.

Sources: docs/theory/floquet.md, "From the equations to a matrix"; proven_bounds.md, "Multipliers".
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar, Literal, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.linalg import schur
from scipy.linalg.lapack import ztrsen

from lumped.display.result import DisplayedResult
from lumped.typing import BoolArray, ComplexArray, FloatArray

Certificate = Literal["proven", "estimate"]
"""What an error is: a bound by a theorem, rounding included, or an estimate from samples."""

_EPS = float(np.finfo(np.float64).eps)
_U = 0.5 * _EPS
_SLACK = 1.0 + 1e-9  # rounding of a bound itself
_FLOOR = 1e-150  # what squares in a norm may lose to underflow
_LARGEST_NORM = math.sqrt(1.5)  # of the computed unitary factor, see `_triangular_error`


def _size(matrix: ComplexArray | FloatArray) -> float:
    """Bound on the 2-norm: the Frobenius norm, or the root of the largest row and column sums."""
    absolute = np.abs(matrix)
    sums = math.sqrt(float(absolute.sum(axis=0).max()) * float(absolute.sum(axis=1).max()))
    return min(float(np.linalg.norm(absolute)), sums) * _SLACK


def _rounding(n: int, *factors: ComplexArray | FloatArray) -> float:
    """Bound on the Frobenius norm of the rounding of a product of n x n matrices in a sum."""
    size = math.prod(float(np.linalg.norm(f)) for f in factors)
    return 4.0 * (n + 4.0) * _U * len(factors) * size * _SLACK + _FLOOR


def _triangular_error(M: FloatArray, T: ComplexArray, Z: ComplexArray, delta: float) -> float:
    """Bound on the Frobenius norm of Z^-1 (M + E) Z - T for every |E| <= delta, from residuals.

    This matrix is Z^-1 (M Z - Z T + E Z), with |Z^-1|^2 <= 1/(1 - q) and |Z|^2 <= 1 + q for q = |Z^H Z - I|.
    """
    n = M.shape[0]
    rest = float(np.linalg.norm(M @ Z - Z @ T)) + _rounding(n, M, Z) + _rounding(n, Z, T)
    q = float(np.linalg.norm(Z.conj().T @ Z - np.eye(n))) + _rounding(n, Z, Z)
    if not q < 0.5:
        return math.inf
    return (rest + delta * math.sqrt(1.0 + q)) / math.sqrt(1.0 - q) * _SLACK


def least_separation(first: ComplexArray, second: ComplexArray) -> tuple[float, ComplexArray]:
    """Lower bound on the smallest singular value of X -> first X - X second, and an approximate inverse.

    As a matrix K on the columns of X: W being any matrix with q = |I - W K| < 1, |K^-1| <= |W|/(1 - q).
    """
    m = first.shape[0]
    k = second.shape[0]
    K = np.kron(np.eye(k), first) - np.kron(second.T, np.eye(m))
    try:
        W = np.linalg.inv(K)
    except np.linalg.LinAlgError:
        return 0.0, K
    with np.errstate(over="ignore", invalid="ignore"):  # of equal multipliers W is beyond floating point
        q = float(np.linalg.norm(np.eye(m * k) - W @ K)) + _rounding(m * k, W, K)
        norms = float(np.linalg.norm(first)) + float(np.linalg.norm(second))
        q += 4.0 * _U * float(np.linalg.norm(W)) * norms
    return (1.0 - q) / _size(W) / _SLACK if q < 1.0 else 0.0, W.astype(complex)


class Cluster(NamedTuple):
    """Eigenvalues of a matrix that errors may merge, apart from all its other eigenvalues.

    Attributes
    ----------
    members : numbers of the eigenvalues in the Schur form
    block : (m, m) triangular, its diagonal the computed eigenvalues
    change : bound on the 2-norm of the change of the block by the errors; inf: the eigenvalues are unknown
    basis : (n, m) columns that span nearly the invariant subspace
    tilt : bound on the 2-norm of what ``basis`` lacks of a basis of the exact invariant subspace
    """

    members: list[int]
    block: ComplexArray
    change: float
    basis: ComplexArray
    tilt: float


def _separated(
    M: FloatArray, T: ComplexArray, Z: ComplexArray, members: list[int], delta: float
) -> Cluster | None:
    """A cluster when M is wrong by delta; None: not separable from the other eigenvalues.

    With the cluster first, T = [[B, C], [0, D]]. Let B X - X D ~ -C. Then [[I, X], [0, I]] makes T block
    diagonal but for the residual of this equation. Let e be the error of the triangular form (Frobenius) and
    p^2 = 1 + |X|^2. The diagonal blocks change by at most p e, the off-diagonal blocks by p^2 e and e. Let f
    be the change of the upper off-diagonal block, sep the smallest singular value of X -> B X - X D, and
    s = sep - 2 p e. If 4 e f < s^2, an invariant subspace persists, and the block of the cluster changes by
    at most p e + 2 e f/s (Stewart and Sun, Matrix Perturbation Theory, theorem V.2.1). The columns
    Z [I + X P, P] span the subspace, |P| <= 2 e/s: Z_1 but for (Z_1 X + Z_2) P.
    """
    n = T.shape[0]
    m = len(members)
    if m < n:
        select = np.zeros(n, dtype=np.int32)
        select[members] = 1
        # Only the order counts here: the factors are checked anew, and no estimate of LAPACK is used.
        T, Z = ztrsen(select, T, Z, job="N")[:2]
        T = np.triu(T)
    block = T[:m, :m]
    basis = Z[:, :m]
    error = _triangular_error(M, T, Z, delta)
    if not math.isfinite(error):
        return None
    if m == n:
        return Cluster(members, block, error, basis, 0.0)
    corner = T[:m, m:]
    rest = T[m:, m:]
    sep, W = least_separation(block, rest)
    if sep == 0.0:
        return None
    X = -(W @ corner.T.ravel()).reshape(n - m, m).T
    remainder = float(np.linalg.norm(block @ X - X @ rest + corner))
    remainder += _rounding(n, block, X) + _rounding(n, X, rest) + 4.0 * _U * float(np.linalg.norm(corner))
    p = math.hypot(1.0, float(np.linalg.norm(X))) * _SLACK
    upper = p * p * error + remainder
    separation = sep - 2.0 * p * error
    if not (separation > 0.5 * sep and 4.0 * error * upper < separation * separation):
        return None
    turn = 2.0 * error / separation
    change = p * error + turn * upper
    return Cluster(members, block, change * _SLACK, basis, _LARGEST_NORM * p * turn * _SLACK)


def _eigenvalue_bound(cluster: Cluster) -> float:
    """Bound on the errors of the eigenvalues of a cluster.

    Elsner's theorem gives the m-th root law of a defective multiplier, with the block B about its mean:
    |d lambda| <= (2 |B| + e)^(1 - 1/m) e^(1/m).
    """
    m = len(cluster.members)
    change = cluster.change
    if m == 1 or not math.isfinite(change):
        return change
    departure = _size(cluster.block - np.trace(cluster.block) / m * np.eye(m))
    root_law = (2.0 * departure + change) ** (1.0 - 1.0 / m) * change ** (1.0 / m)
    return float(root_law) * _SLACK


def clusters_of(M: FloatArray, delta: float) -> list[Cluster]:
    """Clusters of eigenvalues of M, the smallest that an error of M up to delta (Frobenius) leaves apart.

    PROVEN, rounding included: residuals check the results of LAPACK. Source: docs/theory/proven_bounds.md,
    "Multipliers".
    """
    n = M.shape[0]
    T, Z = schur(M, output="complex")
    T = np.triu(T)
    eigenvalues = np.diagonal(T)
    members = [[i] for i in range(n)]
    clusters = [_separated(M, T, Z, one, delta) for one in members]
    while len(members) > 1 and None in clusters:
        bad = clusters.index(None)
        cluster_values = eigenvalues[members[bad]]
        distance = [
            math.inf if k == bad else float(np.abs(cluster_values[:, None] - eigenvalues[other]).min())
            for k, other in enumerate(members)
        ]
        nearest = int(np.argmin(distance))
        members[bad] = members[bad] + members[nearest]
        clusters[bad] = _separated(M, T, Z, members[bad], delta)
        del members[nearest], clusters[nearest]
    unknown = Cluster(members[0], T, math.inf, Z, math.inf)
    return [unknown if cluster is None else cluster for cluster in clusters]


def multipliers_with_bounds(M: FloatArray, delta: float) -> tuple[ComplexArray, FloatArray]:
    """Eigenvalues (n,) of M, largest modulus first, each with a bound (n,) on its error.

    PROVEN, rounding included. ``delta`` bounds the Frobenius norm of the error of M. Multipliers that an
    error of delta may merge share one bound. Within this bound of each computed multiplier of the group there
    is an exact one, and within this bound of each exact multiplier of the group there is a computed one.
    Source: docs/theory/proven_bounds.md, "Multipliers".
    """
    n = M.shape[0]
    values = np.empty(n, dtype=complex)
    errors = np.empty(n)
    for cluster in clusters_of(M, delta):
        values[cluster.members] = np.diagonal(cluster.block)
        errors[cluster.members] = _eigenvalue_bound(cluster)
    # Largest modulus first; a conjugate pair (equal modulus up to rounding) with its positive phase first.
    order = sorted(
        range(n), key=lambda i: (-_significant(float(abs(values[i]))), -values[i].imag, -values[i].real)
    )
    return values[order], errors[order]


def _significant(x: float) -> float:
    """Round to 10 significant digits, so that the order of conjugate pairs does not hang on rounding."""
    return float(f"{x:.9e}")


def radii_with_bounds(multipliers: ComplexArray, errors: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Largest |multiplier| of each row, (..., n) -> (...,), and a bound on its error."""
    modulus = np.abs(multipliers)
    radius = modulus.max(axis=-1)
    # No more than this below: the largest multiplier's own bound, which is at most as much.
    return radius, (modulus + errors).max(axis=-1) - radius


VERDICTS = {-1: "unstable", 0: "undecided", 1: "stable", 2: "neutral"}
"""Verdicts by their number in a chart."""
STABLE = ("stable", "neutral")
"""Verdicts of motions that stay bounded."""
_WORDS = {"neutral": "stable (neutral): on the unit circle, proven"}
_BOUNDARY = "undecided: on a boundary of stability within the bounds, without damping"


def verdicts(
    radius: FloatArray, error: FloatArray, neutral: BoolArray | bool = False
) -> npt.NDArray[np.int8]:
    """Numbers of `VERDICTS`, any shape: 1 stable, 0 undecided where radius +- error contains 1, -1 unstable.

    2 neutral where all multipliers are proven to be on the unit circle and motions bounded.
    """
    decided = np.asarray(radius + error < 1.0, dtype=np.int8)
    decided = decided - np.asarray(radius - error > 1.0, dtype=np.int8)
    return np.asarray(np.where(neutral, np.int8(2), decided), dtype=np.int8)


@dataclass(frozen=True, eq=False, repr=False)
class Spectrum(DisplayedResult):
    """Floquet multipliers of one periodic system.

    Attributes
    ----------
    multipliers : (n,) complex, largest modulus first
    multiplier_errors : (n,) bound on the error of each, see ``certificate``
    period : T [s]
    certificate : "proven" where the errors are bounds by a theorem, rounding included; "estimate" where they
        rest on samples
    symplectic : whether the coefficients prove that 1/conj(m) is a multiplier with each multiplier m
    neutral : whether all multipliers are proven to be on the unit circle and all motions bounded, by
        `on_unit_circle` or `definite_signatures`
    """

    shown: ClassVar = ("verdict", "spectral_radius", "error", "certificate", "multipliers", "period")

    multipliers: ComplexArray
    multiplier_errors: FloatArray
    period: float
    certificate: Certificate = field(default="estimate", kw_only=True)
    symplectic: bool = field(default=False, kw_only=True)
    neutral: bool = field(default=False, kw_only=True)

    @cached_property
    def _radius(self) -> tuple[float, float]:
        radius, error = radii_with_bounds(self.multipliers, self.multiplier_errors)
        return float(radius), float(error)

    @property
    def spectral_radius(self) -> float:
        """Largest |multiplier|."""
        return self._radius[0]

    @property
    def error(self) -> float:
        """Bound on the error of ``spectral_radius``, see ``certificate``."""
        return self._radius[1]

    @property
    def verdict(self) -> str:
        """One of `VERDICTS`.

        "stable" and "unstable" where ``spectral_radius`` +- ``error`` does not contain 1; "neutral" where all
        multipliers are proven to be on the unit circle and motions without damping stay bounded; else
        "undecided".
        """
        radius, error = (np.array(value) for value in self._radius)
        return VERDICTS[int(verdicts(radius, error, self.neutral))]

    @property
    def verdict_words(self) -> str:
        """The verdict in words: what "neutral" means, and what an undecided system without damping is."""
        verdict = self.verdict
        if verdict == "undecided" and self.symplectic:
            return _BOUNDARY
        return _WORDS.get(verdict, verdict)

    @property
    def exponents(self) -> ComplexArray:
        """log(multiplier)/T [1/s], (n,), principal branch; -inf for a multiplier that is zero."""
        with np.errstate(divide="ignore"):
            return np.asarray(np.log(self.multipliers.astype(complex)) / self.period)
