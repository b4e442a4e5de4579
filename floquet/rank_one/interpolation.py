"""Monodromy matrices by Chebyshev interpolation in the period and one more parameter, with a checked error.

The monodromy matrix is an entire function of the period and of a factor on damping or friction, as long as
the coefficients over the phase do not depend on them. It turns like exp(i omega T), so that about omega
(T_max - T_min)/2 nodes in T resolve it, after which the error falls faster than any power.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numpy.polynomial import chebyshev

from floquet.rank_one.batch import FastMonodromy, FastMultipliers, in_threads, multipliers_of
from floquet.rank_one.piecewise import to_series
from lumped.errors import NumericalError
from lumped.typing import FloatArray

Flow = Callable[[FloatArray, FloatArray], FastMonodromy]
"""(periods (k,), parameters (k,)) -> monodromy matrices in coordinates that do not depend on either."""

Receive = Callable[[npt.NDArray[np.intp], FastMultipliers], None]
"""(indices (k,) of periods, multipliers at these periods and all b parameters in C order, (k b, n))."""

_BAND = 4.0  # ratio of the longest to the shortest period that share one interpolant
_CHECKS = 24
_SAFETY = 4.0
_LARGEST = 400_000  # nodes of one interpolant
_CHUNK = 4096  # points evaluated at once


@dataclass(frozen=True, eq=False)
class Interpolant:
    """Chebyshev series of M over a rectangle of period and parameter.

    Attributes
    ----------
    coefficients : (K, L, n, n)
    period, parameter : ends of the rectangle
    error : estimate of the Frobenius norm of the error of M, see `interpolant`
    """

    coefficients: FloatArray
    period: tuple[float, float]
    parameter: tuple[float, float]
    error: float

    def __call__(self, periods: FloatArray, parameters: FloatArray) -> FloatArray:
        """M on the product grid, (a,), (b,) -> (a, b, n, n)."""
        K, L, n, _ = self.coefficients.shape
        first = chebyshev.chebvander(_unit(periods, self.period), K - 1)
        second = chebyshev.chebvander(_unit(parameters, self.parameter), L - 1)
        rows = (first @ self.coefficients.reshape(K, -1)).reshape(periods.size, L, n * n)
        return np.asarray(np.matmul(second, rows)).reshape(periods.size, parameters.size, n, n)


def interpolant(
    flow: Flow, period: tuple[float, float], parameter: tuple[float, float], turns: float, tolerance: float
) -> Interpolant:
    """Interpolate M over a rectangle to a tolerance.

    The error consists of the errors of the matrices at the nodes times the Lebesgue constants of both
    directions, which is a bound, and of the interpolation itself, for which the larger of the last
    coefficients and of the differences at random points, times four, is taken.

    Parameters
    ----------
    flow : matrices at given periods and parameters
    period, parameter : ends; equal ends of ``parameter`` mean that it does not vary
    turns : bound on the angle [rad] by which M can turn over the range of periods
    tolerance : wanted error of the interpolation, relative to the largest |M|

    Raises
    ------
    NumericalError : the tolerance is not met with 400000 nodes
    """
    K = math.ceil(0.5 * turns) + 24
    L = 1 if parameter[0] == parameter[1] else 12
    while True:
        if K * L > _LARGEST:
            raise NumericalError(
                f"interpolation to {tolerance:g} needs more than {_LARGEST} nodes. Use the direct method, or "
                "split the range of speeds."
            )
        (x, onto_x), (y, onto_y) = to_series(K), to_series(L)
        matrices = flow(np.repeat(_between(x, period), L), np.tile(_between(y, parameter), K))
        n = matrices.matrices.shape[1]
        values = matrices.matrices.reshape(K, L, n, n)
        coefficients = np.einsum("ak,bl,klij->abij", onto_x, onto_y, values, optimize=True)
        size = np.linalg.norm(values, axis=(2, 3)).max()
        norms = np.linalg.norm(coefficients, axis=(2, 3))
        tail_x = float(norms[-3:].sum())
        tail_y = float(norms[:, -2:].sum()) if L > 1 else 0.0
        if max(tail_x, tail_y) <= tolerance * size:
            break
        if tail_x > tolerance * size:
            K = math.ceil(1.25 * K)
        if tail_y > tolerance * size:
            L = math.ceil(1.4 * L)
    # Fixed points, so that the same chart has the same bounds: a Kronecker sequence fills the rectangle.
    spread = np.mod(np.outer(np.arange(1, _CHECKS + 1), [0.7548776662466927, 0.5698402909980532]), 1.0)
    T, p = _between(2.0 * spread[:, 0] - 1.0, period), _between(2.0 * spread[:, 1] - 1.0, parameter)
    direct = flow(T, p)
    trial = Interpolant(coefficients, period, parameter, 0.0)
    found = np.array([trial(T[i : i + 1], p[i : i + 1])[0, 0] for i in range(_CHECKS)])
    difference = np.linalg.norm(found - direct.matrices, axis=(1, 2)).max()
    at_nodes = float(matrices.errors.max()) * _lebesgue(K) * _lebesgue(L)
    error = at_nodes + _SAFETY * max(float(difference), tail_x, tail_y)
    return Interpolant(coefficients, period, parameter, error)


def interpolated_multipliers(
    flow: Flow,
    periods: FloatArray,
    parameters: FloatArray,
    rate: float,
    tolerance: float,
    receive: Receive,
) -> None:
    """Multipliers over a product grid of periods and parameters, handed on in parts as they come.

    Parameters
    ----------
    flow : monodromy matrices, asked at the nodes only
    periods, parameters : (a,) and (b,)
    rate : bound on the frequencies of the system [rad/s]
    tolerance : of the interpolation, relative to |M|
    receive : called for every part of the grid, from several threads at a time
    """
    order = np.argsort(periods)
    ends = (float(parameters.min()), float(parameters.max()))
    height = max(1, _CHUNK // parameters.size)
    while order.size:
        low = float(periods[order[0]])
        rows = order[periods[order] <= _BAND * low]
        order = order[rows.size :]
        high = float(periods[rows[-1]])
        if low == high:
            high = low * (1.0 + 1e-9)  # one speed alone: any width will do
        series = interpolant(flow, (low, high), ends, rate * (high - low), tolerance)

        def run(chunks: slice, series: Interpolant = series, rows: npt.NDArray[np.intp] = rows) -> None:
            for chunk in range(chunks.start, chunks.stop):
                part = rows[chunk * height : (chunk + 1) * height]
                M = series(periods[part], parameters)
                M = M.reshape(-1, *M.shape[2:])
                receive(part, multipliers_of(M, np.full(M.shape[0], series.error), "estimate"))

        in_threads(run, -(-rows.size // height))


def _between(unit: FloatArray, ends: tuple[float, float]) -> FloatArray:
    return np.asarray(0.5 * (ends[0] + ends[1]) + 0.5 * (ends[1] - ends[0]) * unit)


def _unit(values: FloatArray, ends: tuple[float, float]) -> FloatArray:
    if ends[0] == ends[1]:
        return np.zeros_like(values)
    return np.asarray((2.0 * values - ends[0] - ends[1]) / (ends[1] - ends[0]))


def _lebesgue(count: int) -> float:
    """Bound on the Lebesgue constant of Chebyshev points of the first kind, 2/pi log(count) + 1."""
    return 2.0 / math.pi * math.log(count) + 1.0
