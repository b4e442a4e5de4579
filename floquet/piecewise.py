"""Piecewise polynomial fits of the periodic gains of a rank-one feedback system."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
from numpy.polynomial import chebyshev

from floquet.system import FloatArray
from lumped.errors import NumericalError

Gains = Callable[[FloatArray, int], tuple[FloatArray, FloatArray]]
"""(phases (k,) inside segment j, j) -> w (k, m), wd (k, m)."""

_MAX_HALVINGS = 40


@cache
def _matrices(degree: int) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Nodes, probes, node values -> Chebyshev coefficients, Chebyshev coefficients -> probe values."""
    nodes = chebyshev.chebpts1(degree + 1)
    probes = np.linspace(-0.999, 0.999, 2 * degree + 5)
    to_series = np.linalg.inv(chebyshev.chebvander(nodes, degree))
    to_probes = chebyshev.chebvander(probes, degree)
    return nodes, probes, np.asarray(to_series, dtype=float), np.asarray(to_probes, dtype=float)


def fit_pieces(
    gains: Gains, edges: FloatArray, metric: FloatArray, degree: int = 8, rtol: float = 1e-11
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Polynomials of both gains on pieces of the period, halved until the fit is good to rtol.

    Parameters
    ----------
    gains : the gains inside each smooth segment
    edges : (S+1,) ends of the smooth segments as parts of the period, 0 to 1
    metric : (m,) weights of the norm of errors, sum_i metric_i e_i^2
    degree : largest degree; where less is enough for all pieces, less is returned
    rtol : wanted error relative to the largest value of each gain

    Returns
    -------
    phases (P+1,), w (P, m, d+1) and wd (P, m, d'+1) in powers of u in [-1, 1], lowest first, and (P, 2) the
    largest errors of w and of wd at 2 degree + 5 probes in each piece

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
    sizes = np.full(2, 1e-300)
    middles = 0.5 * (edges[:-1] + edges[1:])
    halves = 0.5 * np.diff(edges)
    for j in range(middles.size):
        for i, gain in enumerate(gains(middles[j] + halves[j] * nodes, j)):
            sizes[i] = max(sizes[i], float(np.abs(gain * root).max()))
    for j in range(middles.size):
        centre, half = middles[j : j + 1], halves[j : j + 1]
        for depth in range(_MAX_HALVINGS + 1):
            both = np.stack(gains((centre[:, None] + half[:, None] * nodes).ravel(), j))
            series = np.einsum("dn,ipnm->pidm", to_series, both.reshape(2, centre.size, nodes.size, -1))
            exact = np.stack(gains((centre[:, None] + half[:, None] * probes).ravel(), j))
            exact = exact.reshape(2, centre.size, probes.size, -1)
            misfit = np.einsum("nd,pidm->ipnm", to_probes, series) - exact
            errors = np.linalg.norm(misfit * root, axis=3).max(axis=2)  # (2, pieces)
            if not np.isfinite(errors).all():
                raise NumericalError(
                    f"the feedback is not finite between {edges[j]:g} and {edges[j + 1]:g} of the period."
                )
            good = (errors <= rtol * sizes[:, None]).all(axis=0)
            if depth == _MAX_HALVINGS:
                if (errors > 1e-6 * sizes[:, None]).any():
                    raise NumericalError(
                        f"the feedback is not smooth near {centre[~good][0]:g} of the period. "
                        "Name the jump or kink as a switch."
                    )
                good[:] = True
            if good.any():
                misfits.append(errors[:, good].T)
                starts.append(centre[good] - half[good])
                fits.append(series[good])
            rest, quarter = centre[~good], 0.5 * half[~good]
            if rest.size == 0:
                break
            centre = np.concatenate([rest - quarter, rest + quarter])
            half = np.concatenate([quarter, quarter])
    start = np.concatenate(starts)
    order = np.argsort(start)
    power = _to_powers(np.concatenate(fits)[order])
    # Start points are exact only for the segments' own ends; others differ by rounding, which is harmless
    # because neighbours share the computed value.
    phases = np.append(start[order], edges[-1])
    phases[0] = edges[0]
    for edge in edges[1:-1]:
        phases[np.argmin(np.abs(phases - edge))] = edge
    w, wd = (_trimmed(power[:, i], float(sizes[i]), root) for i in (0, 1))
    return phases, w, wd, np.ascontiguousarray(np.concatenate(misfits)[order])


def _to_powers(series: FloatArray) -> FloatArray:
    """(P, 2, d+1, m) Chebyshev coefficients -> (P, 2, m, d+1) power coefficients."""
    degree = series.shape[2] - 1
    conversion = np.zeros((degree + 1, degree + 1))
    for k in range(degree + 1):
        power = chebyshev.cheb2poly(np.eye(degree + 1)[k])
        conversion[: power.size, k] = power
    # Coefficients at rounding level would only add noise of higher degree.
    size = np.abs(series).max(axis=2, keepdims=True)
    cleaned = np.where(np.abs(series) < 4e-16 * size, 0.0, series)
    return np.asarray(np.einsum("kd,pidm->pimk", conversion, cleaned))


def _trimmed(power: FloatArray, size: float, root: FloatArray) -> FloatArray:
    """Drop the highest powers that vanish on all pieces."""
    used = np.flatnonzero(np.abs(power * root[None, :, None]).max(axis=(0, 1)) > 1e-15 * size)
    return np.ascontiguousarray(power[:, :, : 1 + (int(used[-1]) if used.size else 0)])
