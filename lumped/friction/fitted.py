"""A friction law as a path function, and mu_avg of laws I and IV from law II's.

Sources: piecewise Chebyshev fits (Trefethen, Approximation Theory and Approximation Practice, 2013); the mean
coefficient after Abbas Al-Zubaidi 2008, eq. 10.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from lumped.friction.base import ContactPath, FrictionLaw, FrictionSettings
from lumped.friction.benedict_kelley import LAW as BENEDICT_KELLEY
from lumped.path_function import PathFunction
from lumped.typing import FloatArray

#: Absolute error of mu in the piecewise polynomials.
FIT_TOLERANCE = 1e-10
_FIRST_CUT = 64.0  # a piece that ends at P is cut at this fraction of its length
_GEOMETRIC_ABOVE = 2.0  # pieces whose ends are further apart than this ratio are cut at the geometric mean


def fit_signed(law: FrictionLaw, path: ContactPath, settings: FrictionSettings) -> PathFunction:
    """Signed mu(xi) of a law on [L_XA, L_XD], within ``FIT_TOLERANCE`` wherever it is smooth.

    Around the pitch point law II has a logarithm, law III the power 1.036 and law IV a width of its own, so
    pieces are cut in proportion to their distance from it.
    """
    switches = sorted({xi for xi in law.switches(path, settings) if path.L_XA < xi < path.L_XD})
    # The pitch point is a break of every law: also where mu is smooth there, it varies fastest around it.
    breaks = sorted({path.L_XA, path.L_XP, path.L_XD, *switches})
    return PathFunction.fit(
        lambda xi: law.signed(xi, path, settings),
        breaks,
        switches,
        tolerance=FIT_TOLERANCE,
        cut=towards(path.L_XP),
    )


def towards(pitch: float) -> Callable[[FloatArray, FloatArray], FloatArray]:
    """How to cut pieces: nearer to a point the longer a piece is against its distance from it.

    Parameters
    ----------
    pitch : the point, inside no piece [m]
    """

    def cut(low: FloatArray, high: FloatArray) -> FloatArray:
        side = np.where(0.5 * (low + high) >= pitch, 1.0, -1.0)
        near = np.where(side > 0, low - pitch, pitch - high)
        far = np.where(side > 0, high - pitch, pitch - low)
        geometric = np.where(near > 0.0, np.sqrt(near * far), far / _FIRST_CUT)
        distance = np.where(far > _GEOMETRIC_ABOVE * near, geometric, 0.5 * (near + far))
        return np.asarray(pitch + side * distance, dtype=np.float64)

    return cut


def mean_coefficient(function: PathFunction) -> float:
    """Mean of |mu| over the path of contact [-].

    Parameters
    ----------
    function : signed mu(xi), changing sign at its breaks only
    """
    breaks = function.breaks
    middles = 0.5 * (breaks[:-1] + breaks[1:])
    signs = np.where(function(middles) < 0.0, -1.0, 1.0)
    return PathFunction(breaks, function.coefficients * signs, function.switches).mean()


@lru_cache(maxsize=256)
def average_coefficient(path: ContactPath, settings: FrictionSettings) -> float:
    """mu_avg of laws I and IV: as given, or as in the paper the mean of |mu| of law II over A..D."""
    if settings.coefficient is not None:
        return settings.coefficient
    return mean_coefficient(fit_signed(BENEDICT_KELLEY, path, settings))
