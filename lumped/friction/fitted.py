"""A friction law as a path function, and mu_avg of laws I and IV from law II's.

Sources: piecewise Chebyshev fits (Trefethen, Approximation Theory and Approximation Practice, 2013); the mean
coefficient after Abbas Al-Zubaidi 2008, eq. 10.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy.interpolate import PPoly

from lumped.arguments import real_number
from lumped.friction.base import ContactPath, FrictionLaw, FrictionSettings
from lumped.friction.benedict_kelley import LAW as BENEDICT_KELLEY
from lumped.friction.graded_fit import graded_fit
from lumped.path_function import PathFunction

#: Absolute error of mu in the piecewise polynomials.
FIT_TOLERANCE = 1e-10


def fit_signed(law: FrictionLaw, path: ContactPath, settings: FrictionSettings) -> PathFunction:
    """Signed mu(xi) of a law on [L_XA, L_XD], within ``FIT_TOLERANCE`` wherever it is smooth."""
    switches = sorted({xi for xi in law.switches(path, settings) if path.L_XA < xi < path.L_XD})
    # The pitch point is a break of every law: also where mu is smooth there, it varies fastest around it.
    breaks = sorted({path.L_XA, path.L_XP, path.L_XD, *switches})
    return graded_fit(
        lambda xi: law.signed(xi, path, settings), path.L_XP, breaks, switches, tolerance=FIT_TOLERANCE
    )


def mean_coefficient(function: PathFunction, low: float | None = None, high: float | None = None) -> float:
    """Mean of |mu| over the path of contact.

    Parameters
    ----------
    function : signed mu(xi), changing sign at its breaks only
    low, high : first and last position [m]; default the whole path
    """
    breaks = function.breaks
    middles = 0.5 * (breaks[:-1] + breaks[1:])
    signs = np.where(function(middles) < 0.0, -1.0, 1.0)
    magnitude = PPoly(function.coefficients * signs, breaks)
    a = breaks[0] if low is None else real_number("low", low, *function.interval)
    b = breaks[-1] if high is None else real_number("high", high, a, function.interval[1], above=True)
    return float(magnitude.integrate(a, b)) / float(b - a)


@lru_cache(maxsize=256)
def average_coefficient(path: ContactPath, settings: FrictionSettings) -> float:
    """mu_avg of laws I and IV: as given, or as in the paper the mean of |mu| of law II over A..D."""
    if settings.coefficient is not None:
        return settings.coefficient
    return mean_coefficient(fit_signed(BENEDICT_KELLEY, path, settings))
