"""Where along the path of contact a loaded tooth pair touches."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
from scipy.optimize import brentq

from lumped.path_function import PathFunction
from lumped.typing import FloatArray

#: Samples over the searched range between which contact begins or ends at most once.
_SAMPLES = 2000


def positive_intervals(
    function: Callable[[FloatArray], FloatArray], low: float, high: float, kinks: FloatArray, pitch: float
) -> FloatArray:
    """Intervals of [low, high] in which a piecewise smooth function is positive; (n, 2) [m].

    Parameters
    ----------
    function : (n,) -> (n,) over positions [m]
    low, high : range that is searched [m]
    kinks : positions where the function jumps or has a kink, any shape [m]
    pitch : base pitch [m], the scale of what is close
    """
    inside = 1e-12 * pitch
    marks = np.unique(kinks[(kinks > low + inside) & (kinks < high - inside)])
    ends: list[float] = []
    for left, right in itertools.pairwise([low, *marks, high]):
        if right - left <= 4 * inside:
            continue
        count = max(3, int(_SAMPLES * (right - left) / (high - low)))
        xi = np.linspace(left + inside, right - inside, count)
        positive = function(xi) > 0.0
        roots = [
            float(brentq(lambda x: float(function(np.array([x]))[0]), xi[j], xi[j + 1], xtol=1e-16))
            for j in np.flatnonzero(np.diff(positive))
        ]
        ends += [*([left] if positive[0] else []), *roots, *([right] if positive[-1] else [])]
    meet = 2 * np.flatnonzero(np.diff(ends)[1::2] <= 4 * inside)  # intervals that meet at a mark are one
    return np.delete(ends, [*(meet + 1), *(meet + 2)]).reshape(-1, 2)


def restricted(function: PathFunction, intervals: FloatArray) -> PathFunction:
    """The function on the intervals (n, 2), zero between them; jumps are switches."""
    low, high = function.interval
    function, ends = function.split(intervals), intervals.ravel()
    middle = 0.5 * (function.breaks[:-1] + function.breaks[1:])
    kept = ((middle[:, None] > intervals[:, 0]) & (middle[:, None] < intervals[:, 1])).any(axis=1)
    jumps = ends[(ends > low) & (ends < high)]
    return PathFunction(
        function.breaks, np.where(kept, function.coefficients, 0.0), np.union1d(function.switches, jumps)
    )
