"""Piecewise polynomial fits of the periodic gains of a rank-one feedback system."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import numpy.typing as npt
from numpy.polynomial import chebyshev

from lumped.errors import NumericalError
from lumped.typing import FloatArray

Gains = Callable[[FloatArray, npt.NDArray[np.intp]], FloatArray]
"""(phases (k, s), segment (k,) in which each row lies) -> G gains (G, k, s, m)."""

_MAX_HALVINGS = 40
# A piece shorter than this may be worse fitted in proportion, since what counts is the integral of the error
# over the period. Without this a gain that varies fast at a point would take many more pieces around it.
_SHORT = 1.0 / 16.0


@cache
def _matrices(degree: int) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Nodes, probes, node values -> Chebyshev coefficients, Chebyshev coefficients -> probe values."""
    nodes = chebyshev.chebpts1(degree + 1)
    probes = np.linspace(-0.999, 0.999, 2 * degree + 5)
    to_series = np.linalg.inv(chebyshev.chebvander(nodes, degree))
    to_probes = chebyshev.chebvander(probes, degree)
    return nodes, probes, np.asarray(to_series, dtype=float), np.asarray(to_probes, dtype=float)


@cache
def _power_matrix(degree: int) -> FloatArray:
    """Chebyshev coefficients -> power coefficients."""
    conversion = np.zeros((degree + 1, degree + 1))
    for k in range(degree + 1):
        power = chebyshev.cheb2poly(np.eye(degree + 1)[k])
        conversion[: power.size, k] = power
    return conversion


def fit_pieces(
    gains: Gains, edges: FloatArray, metric: FloatArray, degree: int = 8, rtol: float = 1e-11
) -> tuple[FloatArray, list[FloatArray], FloatArray]:
    """Polynomials of G gains on pieces of the period, halved until the fit is good to rtol.

    Parameters
    ----------
    gains : the gains strictly inside the smooth segments
    edges : (S+1,) ends of the smooth segments as parts of the period, 0 to 1
    metric : (m,) weights of the norm of errors, sum_i metric_i e_i^2
    degree : largest degree; where less is enough for all pieces, less is returned
    rtol : wanted error relative to the largest value of each gain; on pieces shorter than 1/16 of the period
        larger in proportion

    Returns
    -------
    phases (P+1,); for each gain (P, m, d+1) in powers of u in [-1, 1], lowest first; and (P, G) the largest
    errors at 2 degree + 5 probes in each piece

    Raises
    ------
    NumericalError
        The gains are not finite, or not smooth inside a segment.
    """
    nodes, probes, to_series, to_probes = _matrices(degree)
    root = np.sqrt(metric)
    starts: list[FloatArray] = []
    fits: list[FloatArray] = []
    misfits: list[FloatArray] = []
    centre, half = 0.5 * (edges[:-1] + edges[1:]), 0.5 * np.diff(edges)
    segment = np.arange(centre.size)
    sizes: FloatArray | None = None
    for depth in range(_MAX_HALVINGS + 1):
        places = np.concatenate([nodes, probes])
        values = gains(centre[:, None] + half[:, None] * places, segment) * root
        if not np.isfinite(values).all():
            bad = centre[~np.isfinite(values).all(axis=(0, 2, 3))][0]
            raise NumericalError(f"the feedback is not finite near {bad:g} of the period.")
        if sizes is None:
            sizes = np.maximum(np.abs(values).max(axis=(1, 2, 3)), 1e-300)
        series = np.einsum("dn,gpnm->gpdm", to_series, values[:, :, : nodes.size])
        misfit = np.einsum("nd,gpdm->gpnm", to_probes, series) - values[:, :, nodes.size :]
        errors = np.sqrt(np.square(misfit).sum(axis=3)).max(axis=2)  # (G, pieces)
        allowed = rtol * np.maximum(1.0, _SHORT / (2.0 * half))
        good = (errors <= allowed * sizes[:, None]).all(axis=0)
        if depth == _MAX_HALVINGS:
            if (errors > 1e-6 * sizes[:, None]).any():
                raise NumericalError(
                    f"the feedback is not smooth near {centre[~good][0]:g} of the period. "
                    "Name the jump or kink as a switch."
                )
            good[:] = True
        if good.any():
            _drop_powers(series, errors, 0.03 * allowed * sizes[:, None], good)
            misfits.append(errors[:, good].T)
            starts.append(centre[good] - half[good])
            fits.append(series[:, good])
        rest, quarter, owner = centre[~good], 0.5 * half[~good], segment[~good]
        if rest.size == 0:
            break
        centre = np.concatenate([rest - quarter, rest + quarter])
        half = np.concatenate([quarter, quarter])
        segment = np.concatenate([owner, owner])
    assert sizes is not None
    start = np.concatenate(starts)
    order = np.argsort(start)
    # Start points are exact only for the segments' own ends; others differ by rounding, which is harmless
    # because neighbours share the computed value.
    phases = np.append(start[order], edges[-1])
    phases[0] = edges[0]
    for edge in edges[1:-1]:
        phases[np.argmin(np.abs(phases - edge))] = edge
    power = _to_powers(np.concatenate(fits, axis=1)[:, order])
    polynomials = [_trimmed(p, float(size)) / root[:, None] for p, size in zip(power, sizes, strict=True)]
    return phases, polynomials, np.ascontiguousarray(np.concatenate(misfits)[order])


def _drop_powers(
    series: FloatArray, errors: FloatArray, room: FloatArray, good: npt.NDArray[np.bool_]
) -> None:
    """Set to zero the highest coefficients whose sum stays within the room, and count them as misfit."""
    size = np.sqrt(np.square(series).sum(axis=3))  # (G, pieces, d+1); |T_n| <= 1
    beyond = np.cumsum(size[:, :, ::-1], axis=2)[:, :, ::-1]
    small = (beyond <= room[:, :, None]) & good[None, :, None]
    small[:, :, 0] = False
    errors += np.where(small, size, 0.0).sum(axis=2)
    series[small] = 0.0


def _to_powers(series: FloatArray) -> FloatArray:
    """(G, P, d+1, m) Chebyshev coefficients -> (G, P, m, d+1) power coefficients."""
    # Coefficients at rounding level would only add noise of higher degree.
    size = np.abs(series).max(axis=2, keepdims=True)
    cleaned = np.where(np.abs(series) < 4e-16 * size, 0.0, series)
    return np.asarray(np.einsum("kd,gpdm->gpmk", _power_matrix(series.shape[2] - 1), cleaned))


def _trimmed(power: FloatArray, size: float) -> FloatArray:
    """Drop the highest powers that vanish on all pieces."""
    used = np.flatnonzero(np.abs(power).max(axis=(0, 1)) > 1e-15 * size)
    return np.ascontiguousarray(power[:, :, : 1 + (int(used[-1]) if used.size else 0)])
