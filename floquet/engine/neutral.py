"""Multipliers of undamped systems: are all of them on the unit circle, and is every motion bounded?

Sources: docs/theory/floquet.md, "Systems without damping"; proven_bounds.md, "On the unit circle".
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from floquet.engine.multipliers import Cluster, clusters_of
from lumped.typing import BoolArray, ComplexArray, FloatArray

_U = 0.5 * float(np.finfo(np.float64).eps)
_SLACK = 1.0 + 1e-9  # rounding of distances, radii and mirror images


class SkewForm(NamedTuple):
    """A skew form x^T S y that every motion of a system keeps.

    Attributes
    ----------
    matrix : (n, n) S, exactly skew
    errors : (n, n) bounds on the errors of its entries
    """

    matrix: FloatArray
    errors: FloatArray

    @classmethod
    def exact(cls, matrix: FloatArray) -> SkewForm:
        """A form without errors."""
        return cls(matrix, np.zeros_like(matrix))

    def scaled(self, scaling: FloatArray) -> SkewForm:
        """The form in the coordinates x_i/d_i, d (n,) powers of two."""
        each = np.outer(scaling, scaling)
        return SkewForm(self.matrix * each, self.errors * each)

    @property
    def size(self) -> float:
        """Bound on the 2-norm."""
        return float(np.linalg.norm(np.abs(self.matrix) + self.errors)) * _SLACK


def skew_form(half: int) -> FloatArray:
    """J = [[0, I], [-I, 0]], (2 half, 2 half). x' = A x keeps x^T J y where J A is symmetric."""
    J = np.zeros((2 * half, 2 * half))
    J[:half, half:] = np.eye(half)
    J[half:, :half] = -np.eye(half)
    return J


def hamiltonian(matrices: FloatArray) -> bool:
    """Whether J B is exactly symmetric for all matrices B (k, n, n); with two states: whether tr B = 0."""
    n = matrices.shape[-1]
    if n % 2:
        return False
    JB = skew_form(n // 2) @ matrices  # exact: one product in each sum is not zero
    return bool((JB - JB.swapaxes(-1, -2) == 0.0).all())


def conservative(mass: FloatArray, damping: FloatArray, stiffness: FloatArray) -> bool:
    """Whether M x'' + C x' + K(t) x = 0 keeps x^T C y + x^T M y' - x'^T M y, exactly.

    Parameters
    ----------
    mass : (n, n)
    damping, stiffness : (1 + terms, n, n) constant matrix, then the matrices of the periodic terms
    """
    symmetric = (mass == mass.T).all() and (stiffness == stiffness.swapaxes(1, 2)).all()
    gyroscopic = (damping[0] == -damping[0].T).all() and not damping[1:].any()
    return bool(symmetric and gyroscopic)


def form_of_motion(mass: FloatArray, gyroscopic: FloatArray, coordinates: FloatArray) -> SkewForm:
    """The form x^T G y + x^T M y' - x'^T M y that motions of M x'' + G x' + K(t) x = 0 keep.

    In the states (z, z') with x = T z. Products are rounded: (2 n + 8) u times the product of the moduli.

    Parameters
    ----------
    mass, gyroscopic : (n, n) M, symmetric, and G, skew
    coordinates : (n, n) T
    """
    n = mass.shape[0]
    size = np.abs(coordinates).T @ np.stack([np.abs(mass), np.abs(gyroscopic)]) @ np.abs(coordinates)
    M, G = coordinates.T @ np.stack([mass, gyroscopic]) @ coordinates
    bound_M, bound_G = (2.0 * n + 8.0) * _U * size
    zero = np.zeros((n, n))
    return SkewForm(
        np.block([[0.5 * (G - G.T), 0.5 * (M + M.T)], [-0.5 * (M + M.T), zero]]),
        np.block([[bound_G, bound_M], [bound_M, zero]]),
    )


def definite_signatures(matrix: FloatArray, delta: float, form: SkewForm) -> bool:
    """Whether all multipliers are on the unit circle and motions bounded: PROVEN by Krein's signatures.

    The exact matrix keeps the Hermitian form x^H (i S) y. On an invariant subspace on which this form is
    definite, the matrix keeps a length: all multipliers there have modulus 1, and no power grows, though
    multipliers may coincide. Sources: docs/theory/proven_bounds.md, "On the unit circle"; Krein 1950.

    Parameters
    ----------
    matrix : (n, n) computed matrix
    delta : bound on the Frobenius norm of its error
    form : the form that the exact matrix keeps
    """
    return all(_is_definite(cluster, form) for cluster in clusters_of(matrix, delta))


def _is_definite(cluster: Cluster, form: SkewForm) -> bool:
    """Whether x^H (i S) x has one sign on the exact invariant subspace of a cluster.

    The subspace has the basis Z + D with |D| <= ``tilt``. So the form in this basis is Z^H i S Z but for
    |S| (2 |Z| |D| + |D|^2), and for the rounding and the error of S.
    """
    if not math.isfinite(cluster.tilt):
        return False
    Z = cluster.basis
    n, m = Z.shape
    K = Z.conj().T @ (1j * form.matrix) @ Z
    K = 0.5 * (K + K.conj().T)
    size = float(np.linalg.norm(Z)) * _SLACK
    error = form.size * (2.0 * size * cluster.tilt + cluster.tilt**2)
    error += (8.0 * (n + 4.0) * _U * form.size + float(np.linalg.norm(form.errors))) * size**2
    values, vectors = np.linalg.eigh(K)
    # Each eigenvalue of K is as near to one of these values as the residuals say (Kahan).
    q = float(np.linalg.norm(vectors.conj().T @ vectors - np.eye(m))) + 8.0 * (m + 4.0) * m * _U
    residual = float(np.linalg.norm(K @ vectors - vectors * values))
    residual += 8.0 * (m + 4.0) * m * _U * float(np.linalg.norm(K))
    error = (error + residual / math.sqrt(1.0 - q)) * _SLACK if q < 0.5 else math.inf
    return bool((values > error).all() or (values < -error).all())


def separate_from_mirror_images(values: ComplexArray, errors: FloatArray) -> BoolArray:
    """Whether no disk meets another disk or the mirror image of another disk in the unit circle, (k,).

    The disks have centres ``values`` (k, n) and radii ``errors`` (k, n). The mirror image of a disk c, r that
    does not hold 0 is the disk with centre c/(|c|^2 - r^2) and radius r/||c|^2 - r^2|.
    """
    modulus = np.abs(values)
    excess = modulus**2 - errors**2
    holds_no_zero = errors * _SLACK < modulus * (1.0 - 1e-6)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        mirrored = values / excess
        mirrored_errors = errors / np.abs(excess) + 64.0 * _U / modulus
        separate = np.ones(values.shape[:-1], dtype=bool)
        others = ~np.eye(values.shape[-1], dtype=bool)
        for centres, radii in ((values, errors), (mirrored, mirrored_errors)):
            distance = np.abs(centres[..., :, None] - values[..., None, :])
            reach = (radii[..., :, None] + errors[..., None, :]) * _SLACK + 64.0 * _U * modulus[..., None, :]
            separate &= ((distance > reach) | ~others).all(axis=(-2, -1))
    return np.asarray(separate & holds_no_zero.all(axis=-1))


def on_unit_circle(
    matrices: FloatArray, deltas: FloatArray, values: ComplexArray, errors: FloatArray
) -> BoolArray:
    """Whether all multipliers are simple and on the unit circle (k,): PROVEN for symplectic matrices.

    Multipliers that coincide, or nearly, are left to `definite_signatures`.

    Two states: det M = 1, so that the multipliers are exp(+-i angle), 2 cos(angle) = tr M, where |tr M| < 2.
    The error of the trace is at most sqrt(2) times the Frobenius norm of the error of M. More states: see
    `separate_from_mirror_images`; with each multiplier its mirror image is a multiplier, and a disk that
    holds exactly one multiplier and meets no other disk, nor does its mirror image, holds its own image.

    Parameters
    ----------
    matrices : (k, n, n) computed matrices M; the exact ones are symplectic in some coordinates
    deltas : (k,) bounds on the Frobenius norms of their errors
    values, errors : (k, n) multipliers of M with bounds, of `multipliers_with_bounds` or `spectra`
    """
    if matrices.shape[-1] > 2:
        return separate_from_mirror_images(values, errors)
    trace = np.abs(np.trace(matrices, axis1=1, axis2=2))
    rounding = 4.0 * _U * np.abs(np.diagonal(matrices, axis1=1, axis2=2)).sum(axis=1)
    return np.asarray((trace + math.sqrt(2.0) * deltas + rounding) * _SLACK < 2.0)
