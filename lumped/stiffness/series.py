"""A curve that is analytic over the path of contact and costs much to evaluate, as a path function."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial import Chebyshev

from lumped.path_function import PathFunction
from lumped.typing import FloatArray

#: Fit error over the largest value.
_TOLERANCE = 1e-10
#: Terms of the Chebyshev series over the path of contact that are tried.
_TERMS = (64, 128)


def fitted_series(function: Callable[[FloatArray], FloatArray], ends: tuple[float, float]) -> PathFunction:
    """Fit an analytic function by its Chebyshev series from a few dozen evaluations.

    Parameters
    ----------
    function : (n,) -> (n,), in any unit
    ends : of the path [m]

    Raises
    ------
    NumericalError : the function is not smooth or not finite
    """
    for terms in _TERMS:
        series = Chebyshev.interpolate(function, terms - 1, ends)
        tolerance = _TOLERANCE * float(np.abs(series.linspace(terms)[1]).max())
        if np.abs(series.coef[-terms // 8 :]).max() <= 0.1 * tolerance:
            return PathFunction.fit(series, ends, tolerance=tolerance)
    return PathFunction.fit(function, ends, tolerance=tolerance)
