"""Piecewise polynomials of bounded degree in place of periodic gains that are polynomials of higher degree.

On every segment the gains are polynomials of known degree. Their values at degree + 1 Chebyshev points
determine the gains. The sum of the dropped coefficients of the Chebyshev series bounds the dropped part,
since |T_k| <= 1. So the misfit is a bound everywhere in the piece, not only at the points.

Sources: docs/theory/proven_bounds.md, "The gains".
"""

from __future__ import annotations

from functools import cache
from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt
from numpy.polynomial import chebyshev

from floquet.rank_one.system import trimmed
from lumped.errors import NumericalError
from lumped.typing import FloatArray

_U = 0.5 * float(np.finfo(np.float64).eps)
_MAX_HALVINGS = 40
# A piece shorter than this may be worse fitted in proportion, since what counts is the integral of the error
# over the period. Without this a gain that varies fast at a point would take many more pieces around it.
_SHORT = 1.0 / 16.0


class GainValues(NamedTuple):
    """Values of G gains of m components at s nodes on k pieces, with two kinds of error.

    Attributes
    ----------
    values : (G, k, s, m)
    errors : (G, k) bounds on the norm of the gain less the polynomial through its values; halving a piece
        reduces them
    rounding : (G, k) bounds on the rounding of values and phases, which halving a piece does not reduce
    """

    values: FloatArray
    errors: FloatArray
    rounding: FloatArray


class PieceFits(NamedTuple):
    """Polynomials of G gains on P pieces of the period.

    Attributes
    ----------
    phases : (P+1,) ends of the pieces
    polynomials : for each gain (P, m, d+1) in powers of u in [-1, 1], lowest first
    errors : (P, G) bounds on the errors everywhere in each piece, rounding included
    edge_indices : (S+1,) which of the phases are the ends of the segments
    """

    phases: FloatArray
    polynomials: list[FloatArray]
    errors: FloatArray
    edge_indices: npt.NDArray[np.intp]


class PolynomialGains(Protocol):
    """G gains of m components, polynomials on every segment up to errors that are bounded.

    Attributes
    ----------
    count : number of values that determine a gain on a piece: its degree plus one
    """

    count: int

    def __call__(
        self, centre: FloatArray, half: FloatArray, segment: npt.NDArray[np.intp], nodes: FloatArray
    ) -> GainValues:
        """Values at the phases centre + half nodes on k pieces, which lie in the segments (k,)."""
        ...


def to_series(count: int) -> tuple[FloatArray, FloatArray]:
    """Chebyshev points of the first kind, and values there -> Chebyshev coefficients (count, count).

    The angles are reduced as whole numbers, so that every entry is right to 8 units of rounding of 2/count.
    """
    j = np.arange(count)
    k = np.arange(count)
    nodes = np.cos((2 * j + 1) * (np.pi / (2 * count)))
    matrix = np.cos(np.mod(np.outer(k, 2 * j + 1), 4 * count) * (np.pi / (2 * count))) * (2.0 / count)
    matrix[0] *= 0.5
    return nodes, np.asarray(matrix, dtype=float)


def series_rounding(count: int) -> float:
    """Bound on the sum of the errors of the coefficients by `to_series` per unit of the largest value.

    Entries are right to 8 u, sums to count u; a point off by 2 u moves a value by 2 u count^2 (Markov).
    """
    return 4.0 * count * (count + 12.0) * _U


@cache
def _power_matrix(degree: int) -> FloatArray:
    """Chebyshev coefficients -> power coefficients; whole numbers, exact."""
    conversion = np.zeros((degree + 1, degree + 1))
    for k in range(degree + 1):
        power = chebyshev.cheb2poly(np.eye(degree + 1)[k])
        conversion[: power.size, k] = np.round(power)
    return conversion


def fit_pieces(
    gains: PolynomialGains, edges: FloatArray, metric: FloatArray, degree: int = 8, rtol: float = 1e-11
) -> PieceFits:
    """Polynomials of G gains on pieces of the period, with PROVEN bounds on their errors.

    A piece is halved until the dropped part of its polynomials is small enough.

    Parameters
    ----------
    edges : (S+1,) ends of the segments as parts of the period
    metric : (m,) weights of the norm of errors
    degree : largest degree of the polynomials
    rtol : largest dropped part over the largest value of each gain; on pieces shorter than 1/16 of the period
        larger in proportion
    """
    nodes, matrix = to_series(gains.count)
    root = np.sqrt(metric)
    starts: list[FloatArray] = []
    fits: list[FloatArray] = []
    misfits: list[FloatArray] = []
    low = edges[:-1]
    high = edges[1:]
    segment = np.arange(low.size)
    sizes: FloatArray | None = None
    for depth in range(_MAX_HALVINGS + 1):
        centre = 0.5 * (low + high)
        half = 0.5 * (high - low)
        values, errors, rounding = gains(centre, half, segment, nodes)
        values = values * root
        if not np.isfinite(values).all():
            bad = centre[~np.isfinite(values).all(axis=(0, 2, 3))][0]
            raise NumericalError(f"the feedback is not finite near {bad:g} of the period.")
        largest = np.sqrt(np.square(values).sum(axis=3)).max(axis=2)  # (G, pieces)
        if sizes is None:
            sizes = np.maximum(largest.max(axis=1), 1e-300)
        series = matrix @ values
        allowed = rtol * np.maximum(1.0, _SHORT / (2.0 * half)) * sizes[:, None]
        beyond = np.sqrt(np.square(series[:, :, degree + 1 :]).sum(axis=3)).sum(axis=2)
        good = (beyond + errors <= allowed).all(axis=0)
        if depth == _MAX_HALVINGS:
            if not np.isfinite(errors).all():
                raise NumericalError(f"the feedback is not smooth near {centre[~good][0]:g} of the period.")
            good[:] = True
        if good.any():
            fitted = _padded(series[:, good, : degree + 1], degree)
            errors = errors[:, good] + beyond[:, good] + rounding[:, good]
            errors += series_rounding(gains.count) * largest[:, good]
            _drop_powers(fitted, errors, 0.03 * allowed[:, good])
            fits.append(_to_powers(fitted, errors))
            misfits.append(errors.T)
            starts.append(low[good])
        if good.all():
            break
        low, high = (
            np.concatenate(ends) for ends in ((low[~good], centre[~good]), (centre[~good], high[~good]))
        )
        segment = np.tile(segment[~good], 2)
    start = np.concatenate(starts)
    order = np.argsort(start)
    # The ends of segments are exact, also of one that is a unit in the last place wide.
    phases = np.append(start[order], edges[-1])
    edge_indices = np.searchsorted(phases, edges)
    power = np.concatenate(fits, axis=1)[:, order]
    polynomials = [trimmed(p) / root[:, None] for p in power]
    # 1 + 1e-12: rounding of the sums that make the bounds.
    bounds = np.ascontiguousarray(np.concatenate(misfits)[order]) * (1.0 + 1e-12)
    return PieceFits(phases, polynomials, bounds, edge_indices)


def _padded(series: FloatArray, degree: int) -> FloatArray:
    missing = degree + 1 - series.shape[2]
    return np.pad(series, ((0, 0), (0, 0), (0, max(missing, 0)), (0, 0)))


def _drop_powers(series: FloatArray, errors: FloatArray, allowed: FloatArray) -> None:
    """Drop the highest coefficients whose sum is within ``allowed``, and add the sum to the errors."""
    size = np.sqrt(np.square(series).sum(axis=3))  # (G, pieces, d+1); |T_n| <= 1
    beyond = np.cumsum(size[:, :, ::-1], axis=2)[:, :, ::-1]
    small = beyond <= np.maximum(allowed, 4e-16 * size.max(axis=2))[:, :, None]
    small[:, :, 0] = False
    errors += np.where(small, size, 0.0).sum(axis=2)
    series[small] = 0.0


def _to_powers(series: FloatArray, errors: FloatArray) -> FloatArray:
    """(G, P, d+1, m) Chebyshev coefficients -> (G, P, m, d+1) power coefficients; adds the rounding."""
    conversion = _power_matrix(series.shape[2] - 1)
    count = series.shape[2] + 2  # sums, the root of the metric and its division
    size = np.sqrt(np.square(series).sum(axis=3))
    errors += 2.0 * count * _U * (size @ np.abs(conversion).sum(axis=0))
    return np.asarray(np.einsum("kd,gpdm->gpmk", conversion, series))
