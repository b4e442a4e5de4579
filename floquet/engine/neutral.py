"""Multipliers of undamped systems: are all of them on the unit circle, and simple?

Sources: docs/theory/floquet.md, "Systems without damping"; proven_bounds.md, "On the unit circle".
"""

from __future__ import annotations

import math

import numpy as np

from lumped.typing import BoolArray, ComplexArray, FloatArray

_U = 0.5 * float(np.finfo(np.float64).eps)
_SLACK = 1.0 + 1e-9  # rounding of distances, radii and mirror images


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
