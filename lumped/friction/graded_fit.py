"""Piecewise polynomials of a friction law, graded towards the pitch point where the laws vary fastest.

Law II has a logarithm there, law III the power 1.036 and law IV a width of its own, so pieces are split in
proportion to their distance from P. All pieces of a round are evaluated in one call.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.polynomial import chebyshev, polynomial

from lumped.errors import NumericalError
from lumped.path_function import FIT_DEGREE, PathFunction
from lumped.typing import FloatArray

_MAX_ROUNDS = 45
_MAX_PIECES = 2000  # laws take fewer than 100; more means rounding noise or an undeclared kink
_FIRST_SPLIT = 64.0  # a piece that ends at P is cut at this fraction of its length
_GEOMETRIC_ABOVE = 2.0  # pieces whose ends are further apart than this ratio are cut at the geometric mean

_NODES = np.asarray(chebyshev.chebpts1(FIT_DEGREE + 1), dtype=np.float64)
# Twice as dense as the nodes and all but at the ends, where a jump hides and a root's error is largest.
_PROBES = np.asarray((1.0 - 1e-6) * chebyshev.chebpts2(2 * FIT_DEGREE + 5), dtype=np.float64)
_AT_PROBES = np.asarray(chebyshev.chebvander(_PROBES, FIT_DEGREE).T, dtype=np.float64)
# Chebyshev coefficients from values at the nodes: discrete orthogonality, (2 - [k = 0])/n T_k(x_j)
_TO_SERIES = np.asarray(chebyshev.chebvander(_NODES, FIT_DEGREE), dtype=np.float64) * (
    2.0 - (np.arange(FIT_DEGREE + 1) == 0)
)
_TO_SERIES /= _NODES.size


def _shifted_powers() -> FloatArray:
    """Row k: coefficients of T_k(t - 1) in powers of t, lowest first."""
    rows = np.zeros((FIT_DEGREE + 1, FIT_DEGREE + 1))
    for k in range(FIT_DEGREE + 1):
        in_s = chebyshev.cheb2poly(np.eye(FIT_DEGREE + 1)[k])
        shifted = polynomial.Polynomial(in_s)(polynomial.Polynomial([-1.0, 1.0])).coef
        rows[k, : shifted.size] = shifted
    return rows


_TO_POWERS = _shifted_powers()


def graded_fit(
    function: Callable[[FloatArray], FloatArray],
    pitch: float,
    breaks: Sequence[float],
    switches: Sequence[float],
    *,
    tolerance: float,
) -> PathFunction:
    """Fit a vectorised function of xi by polynomials on pieces graded towards a point.

    Parameters
    ----------
    function : (k,) -> (k,), smooth between the breaks
    pitch : L_XP, the point towards which pieces shrink; one of the breaks [m]
    breaks : end points and inner breaks [m]
    switches : the breaks that are jumps or kinks [m]
    tolerance : largest absolute error at the probes between the nodes

    Raises
    ------
    NumericalError : the function is not finite, or does not converge between two breaks
    """
    low, high = np.array(breaks[:-1], dtype=float), np.array(breaks[1:], dtype=float)
    starts: list[FloatArray] = []
    halves: list[FloatArray] = []
    fitted: list[FloatArray] = []
    for _ in range(_MAX_ROUNDS):
        half = 0.5 * (high - low)
        series = _values(function, low, half, _NODES) @ _TO_SERIES
        error = np.abs(series @ _AT_PROBES - _values(function, low, half, _PROBES)).max(axis=1)
        good = error <= tolerance
        starts.append(low[good])
        halves.append(half[good])
        fitted.append(series[good])
        if good.all():
            break
        low, high = _split(low[~good], high[~good], pitch)
        if low.size > _MAX_PIECES:
            break
    if not good.all():
        raise NumericalError(
            f"The friction law does not converge to {tolerance:.2g} near xi = {low[0]:.6g} m: "
            "name the jump or kink there as a break, or raise the tolerance."
        )
    start, width = np.concatenate(starts), np.concatenate(halves)
    order = np.argsort(start)
    powers = np.concatenate(fitted)[order] @ _TO_POWERS
    powers /= width[order, None] ** np.arange(FIT_DEGREE + 1)
    return PathFunction(np.append(start[order], breaks[-1]), powers.T[::-1], np.asarray(switches))


def _values(
    function: Callable[[FloatArray], FloatArray], low: FloatArray, half: FloatArray, at: FloatArray
) -> FloatArray:
    """Values (pieces, points) at points of [-1, 1] on every piece."""
    xi = low[:, None] + half[:, None] * (1.0 + at)
    values = function(xi.ravel()).reshape(xi.shape)
    if not np.isfinite(values).all():
        worst = xi[~np.isfinite(values)][0]
        raise NumericalError(f"The friction law is not finite at xi = {worst:.6g} m; check its parameters.")
    return values


def _split(low: FloatArray, high: FloatArray, pitch: float) -> tuple[FloatArray, FloatArray]:
    """Cut every piece in two, nearer to the pitch point the longer it is against its distance from it."""
    side = np.where(0.5 * (low + high) >= pitch, 1.0, -1.0)
    near = np.where(side > 0, low - pitch, pitch - high)
    far = np.where(side > 0, high - pitch, pitch - low)
    geometric = np.where(near > 0.0, np.sqrt(near * far), far / _FIRST_SPLIT)
    distance = np.where(far > _GEOMETRIC_ABOVE * near, geometric, 0.5 * (near + far))
    cut = pitch + side * distance
    return np.concatenate([low, cut]), np.concatenate([cut, high])
