"""A rank-one feedback system in the form that the compiled kernels read."""

from __future__ import annotations

import numpy as np

from floquet.engine.kernels.simd import LANES
from floquet.rank_one.kernels.gains import Problem
from floquet.rank_one.system import ModalForm, RankOneSystem, padded
from lumped.typing import FloatArray

_U = 0.5 * float(np.finfo(np.float64).eps)
_PROPORTIONAL = 1e-12  # wd is taken as rho w where wd - rho w is no more than this part of wd


def packed(system: RankOneSystem) -> Problem:
    """Arrange a system for the kernels: modal coordinates, lanes, and bounds that do not change per point."""
    form = system.modal()
    pieces = system.phases.size - 1
    w_size = _norms(form.w)
    wd_size = _norms(form.wd)
    centred = form.w[0, :, :, 0] - form.reference
    w_size[0] += np.linalg.norm(centred, axis=1) - np.linalg.norm(form.w[0, :, :, 0], axis=1)
    ratios, unequal = _ratios(form.w, form.wd, wd_size)
    noise, gyroscopic_noise, relative = _rounding(system, form)
    fit_error = np.stack([part.fit_errors for part in system.parts]) * (1.0 + 1e-9)
    fit_error += relative * np.stack([_norms(form.w), wd_size], axis=2)
    edges = [np.zeros((pieces + 1, 2)) if p.edge_errors is None else p.edge_errors for p in system.parts]
    degrees = np.stack([_degrees(form.w), _degrees(form.wd)], axis=1)
    return Problem(
        phases=own(system.phases),
        w=_in_lanes(form.w),
        wd=_in_lanes(form.wd),
        degrees=degrees,
        sizes=own(np.stack([w_size, wd_size], axis=2)),
        ratios=ratios,
        unequal=unequal,
        fit_error=own(fit_error),
        edge_error=own(np.stack(edges) * (1.0 + 1e-9)),
        C=own(form.C),
        gyroscopic=own(form.gyroscopic),
        drive=form.drive,
        noise=noise,
        gyroscopic_drive=form.gyroscopic_drive,
        gyroscopic_noise=gyroscopic_noise,
        omega=own(form.omega),
        v=own(form.v),
        reference=own(form.reference),
    )


def _rounding(system: RankOneSystem, form: ModalForm) -> tuple[float, float, float]:
    """PROVEN bounds on the rounding of the change to modal coordinates.

    Returns the error of the constant part of A [1/s], the error of G, and the relative error of the gains.

    Phi^-1 is (I - E)^-1 Phi^T g, E = I - Phi^T g Phi; the gains go through 57 + m roundings of the sum of
    their moduli. Sources: docs/theory/proven_bounds.md, "The matrix of a step".
    """
    Phi = form.shapes
    omega = form.omega
    Y = Phi.T * system.metric
    m = omega.size
    absolute = np.abs(Y)
    of_three_factors = (2.0 * m + 6.0) * _U
    E = float(np.linalg.norm(np.eye(m) - Y @ Phi) + (m + 5.0) * _U * np.linalg.norm(absolute @ np.abs(Phi)))
    E /= 1.0 - min(E, 0.5)

    def moduli(matrix: FloatArray) -> FloatArray:
        return np.asarray(absolute @ np.abs(matrix) @ np.abs(Phi))

    gyroscopic = np.zeros((m, m)) if system.gyroscopic is None else system.gyroscopic
    noise = E * np.linalg.norm(form.C) + of_three_factors * np.linalg.norm(moduli(system.damping))
    gyroscopic_noise = E * np.linalg.norm(form.gyroscopic) + of_three_factors * np.linalg.norm(
        moduli(gyroscopic)
    )
    transformed = Y @ system.stiffness @ Phi
    feedback = np.outer(form.reference, form.v)
    stiffness_error = np.abs(transformed + feedback - np.diag(omega**2)) + E * np.linalg.norm(transformed)
    stiffness_error += of_three_factors * (moduli(system.stiffness) + np.abs(feedback) + np.diag(omega**2))
    noise += np.linalg.norm(stiffness_error / omega)
    # Sum of the moduli in v = Phi^T v over the modulus of the sum.
    summed = np.abs(Phi).T @ np.abs(system.v)
    excess = max(
        1.0,
        float(np.linalg.norm(summed / omega) / np.linalg.norm(form.v / omega)),
        float(np.linalg.norm(summed) / np.linalg.norm(form.v)),
    )
    relative = E + (57.0 + m) * _U * excess
    constant_size = float(omega.max()) + np.linalg.norm(form.C)
    constant_size += np.linalg.norm(form.reference) * np.linalg.norm(form.v / omega)
    gyroscopic_noise += relative * np.linalg.norm(form.gyroscopic)
    return float(noise + relative * constant_size), float(gyroscopic_noise), float(relative)


def own(values: object) -> FloatArray:
    """Copy as a contiguous, writable array: other kinds would each make the kernel compile once more."""
    return np.array(values, dtype=float, ndmin=1, order="C")


def _norms(poly: FloatArray) -> FloatArray:
    """Bounds (Q, P) on the norm over |u| <= 1 of polynomials (Q, P, m, d+1) in u."""
    return np.asarray(np.linalg.norm(poly, axis=2).sum(axis=2))


def _degrees(poly: FloatArray) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    """Largest degree (P,) over all parts and coordinates."""
    used = (poly != 0.0).any(axis=(0, 2)) * np.arange(poly.shape[3])
    return np.asarray(used.max(axis=1), dtype=np.int64)


def _ratios(w: FloatArray, wd: FloatArray, wd_size: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The ratio rho (P,) of wd to w, nan where there is none; norms (Q, P) of wd - rho w."""
    w, wd = (padded(poly, max(w.shape[3], wd.shape[3])) for poly in (w, wd))
    above = (w * wd).sum(axis=(0, 2, 3))
    below = (w * w).sum(axis=(0, 2, 3))
    rho = np.divide(above, below, out=np.zeros_like(above), where=below > 0.0)
    unequal = _norms(wd - rho[:, None, None] * w)
    rho[unequal.sum(axis=0) > _PROPORTIONAL * wd_size.sum(axis=0)] = np.nan
    return rho, unequal


def _in_lanes(poly: FloatArray) -> FloatArray:
    """(Q, P, m, d+1) -> (Q, P, d+1, lanes), a whole number of `LANES`."""
    Q, P, m, count = poly.shape
    out = np.zeros((Q, P, count, -(-m // LANES) * LANES))
    out[..., :m] = np.swapaxes(poly, 2, 3)
    return out
