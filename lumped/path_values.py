"""Values of a function over the path of contact: the compiled part of ``lumped.path_function``."""

from __future__ import annotations

import numpy as np

from lumped.compiler import compiled
from lumped.typing import FloatArray


@compiled
def values_at(breaks: FloatArray, coefficients: FloatArray, xi: FloatArray) -> FloatArray:
    """Return values (k,) at positions (k,); zero outside the interval.

    ``breaks`` (m + 1,) and ``coefficients`` (order, m) are those of ``PathFunction``. The piece of the
    previous position is tried first.
    """
    values = np.zeros(xi.size)
    last = breaks.size - 1
    piece = 0
    for i in range(xi.size):
        x = xi[i]
        if not breaks[0] <= x <= breaks[last]:
            continue
        if not (breaks[piece] <= x and (x < breaks[piece + 1] or piece == last - 1)):
            low = 0
            high = last
            while high - low > 1:
                middle = (low + high) // 2
                if x >= breaks[middle]:
                    low = middle
                else:
                    high = middle
            piece = low
        local = x - breaks[piece]
        value = coefficients[0, piece]
        for power in range(1, coefficients.shape[0]):
            value = value * local + coefficients[power, piece]
        values[i] = value
    return values
