"""Values of a function over the path of contact: the compiled part of ``lumped.path_function``."""

from __future__ import annotations

import numpy as np

from lumped.compiler import compiled, inlined
from lumped.typing import FloatArray


@inlined
def piece_at(breaks: FloatArray, xi: float, near: int) -> int:
    """Return the piece of a position inside the interval. The piece ``near`` is tried first.

    A break belongs to the piece behind it, the last break to the last piece.
    """
    last = breaks.size - 1
    if breaks[near] <= xi and (xi < breaks[near + 1] or near == last - 1):
        return near
    low = 0
    high = last
    while high - low > 1:
        middle = (low + high) // 2
        if xi >= breaks[middle]:
            low = middle
        else:
            high = middle
    return low


@inlined
def value_on(breaks: FloatArray, coefficients: FloatArray, piece: int, xi: float) -> float:
    """Return the value of the polynomial of one piece."""
    local = xi - breaks[piece]
    value: float = coefficients[0, piece]
    for power in range(1, coefficients.shape[0]):
        value = value * local + coefficients[power, piece]
    return value


@compiled
def values_at(breaks: FloatArray, coefficients: FloatArray, xi: FloatArray) -> FloatArray:
    """Return values (k,) at positions (k,); zero outside the interval.

    ``breaks`` (m + 1,) and ``coefficients`` (order, m) are those of ``PathFunction``. The piece of the
    previous position is tried first.
    """
    values = np.zeros(xi.size)
    piece = 0
    for i in range(xi.size):
        if breaks[0] <= xi[i] <= breaks[breaks.size - 1]:
            piece = piece_at(breaks, xi[i], piece)
            values[i] = value_on(breaks, coefficients, piece, xi[i])
    return values


@compiled
def series_at(coefficients: FloatArray, low: float, high: float, xi: FloatArray) -> FloatArray:
    """Return values (k,) of a Chebyshev series on [low, high] at positions (k,), by Clenshaw's recursion."""
    values = np.empty(xi.size)
    for i in range(xi.size):
        t = (2.0 * xi[i] - (low + high)) / (high - low)
        following = 0.0
        second = 0.0
        for term in range(coefficients.size - 1, 0, -1):
            following, second = coefficients[term] + 2.0 * t * following - second, following
        values[i] = coefficients[0] + t * following - second
    return values
