"""A rank-one feedback system in the form that the compiled kernels read."""

from __future__ import annotations

import numpy as np

from floquet.rank_one.kernels.gains import Problem
from floquet.rank_one.kernels.lanes import LANES
from floquet.rank_one.system import RankOneSystem
from lumped.typing import FloatArray

_PROPORTIONAL = 1e-12  # wd is rho w where it differs from it by no more than this part


def packed(system: RankOneSystem) -> Problem:
    """Arrange a system for the kernels: modal coordinates, lanes, and bounds that do not change per point."""
    form = system.modal()
    pieces = system.phases.size - 1
    w_size, wd_size = _norms(form.w), _norms(form.wd)
    centred = form.w[0, :, :, 0] - form.reference
    w_size[0] += np.linalg.norm(centred, axis=1) - np.linalg.norm(form.w[0, :, :, 0], axis=1)
    ratios, unequal = _ratios(form.w, form.wd, wd_size)
    degrees = np.stack([_degrees(form.w), _degrees(form.wd)], axis=1)
    flow_error = np.zeros(pieces) if system.coarsening is None else system.coarsening.errors
    return Problem(
        phases=own(system.phases),
        w=_lanes(form.w),
        wd=_lanes(form.wd),
        f=own(form.f),
        fr=own(form.fr),
        degrees=degrees,
        sizes=own(np.stack([w_size, wd_size], axis=2)),
        ratios=ratios,
        unequal=unequal,
        fit_error=own(np.stack([part.fit_errors for part in system.parts])),
        flow_error=own(flow_error),
        C=own(form.C),
        drive=max(0.0, -float(np.linalg.eigvalsh(0.5 * (form.C + form.C.T)).min())),
        omega=own(form.omega),
        v=own(form.v),
        input=own(form.input),
        reference=own(form.reference),
    )


def own(values: object) -> FloatArray:
    """Copy as a contiguous, writable array: other kinds would each make the kernel compile once more."""
    return np.array(values, dtype=float, ndmin=1, order="C")


def _norms(poly: FloatArray) -> FloatArray:
    """Bounds (Q, P) on the norm over |u| <= 1 of polynomials (Q, P, m, d+1) in u."""
    return np.asarray(np.linalg.norm(poly, axis=2).sum(axis=2))


def _degrees(poly: FloatArray) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    """Degree (P,) that holds all parts and coordinates."""
    used = (poly != 0.0).any(axis=(0, 2)) * np.arange(poly.shape[3])
    return np.asarray(used.max(axis=1), dtype=np.int64)


def _ratios(w: FloatArray, wd: FloatArray, wd_size: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The ratio rho (P,) of wd to w, nan where there is none; norms (Q, P) of wd - rho w."""
    degree = max(w.shape[3], wd.shape[3])
    w, wd = (np.pad(poly, ((0, 0), (0, 0), (0, 0), (0, degree - poly.shape[3]))) for poly in (w, wd))
    above, below = (w * wd).sum(axis=(0, 2, 3)), (w * w).sum(axis=(0, 2, 3))
    rho = np.divide(above, below, out=np.zeros_like(above), where=below > 0.0)
    unequal = _norms(wd - rho[:, None, None] * w)
    rho[unequal.sum(axis=0) > _PROPORTIONAL * wd_size.sum(axis=0)] = np.nan
    return rho, unequal


def _lanes(poly: FloatArray) -> FloatArray:
    """(Q, P, m, d+1) -> (Q, P, d+1, LANES)."""
    Q, P, m, count = poly.shape
    out = np.zeros((Q, P, count, LANES))
    out[..., :m] = np.swapaxes(poly, 2, 3)
    return out
