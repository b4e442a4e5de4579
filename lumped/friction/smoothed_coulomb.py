"""Law IV: Coulomb friction smoothed through the pitch point, equation (19).

Sources: Abbas Al-Zubaidi 2008, eq. 19 (docs/theory/friction.md, "The laws").
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from lumped.arguments import real_array
from lumped.friction.average_coefficient import AVERAGE_READS, AVERAGE_SLOPE, average_coefficient
from lumped.friction.base import ContactPath, FrictionLaw, FrictionSettings
from lumped.friction.misfit import Ellipses
from lumped.ranges import checked
from lumped.typing import FloatArray


def smoothed_coulomb(coefficient: ArrayLike, distance: ArrayLike, sharpness: ArrayLike) -> FloatArray:
    """Smoothed Coulomb friction, the derivative of (2 mu_avg / pi) d arctan(Phi d), equation (19).

    mu = (2 mu_avg / pi) (arctan(Phi d) + Phi d / (1 + Phi^2 d^2))

    Parameters
    ----------
    coefficient : mu_avg, magnitude far from the pitch point [-]
    distance : d = xi - L_XP, signed distance of the contact point from the pitch point
    sharpness : Phi, in the inverse of the unit of ``distance``

    Returns
    -------
    mu [-] with its sign; odd in d, and within 4 mu_avg / (3 pi |Phi d|^3) of law I for |Phi d| >> 1

    Examples
    --------
    >>> round(float(smoothed_coulomb(0.05, 1.0, 1.0)), 8)
    0.04091549
    """
    mu = checked("coefficient", coefficient, "", allow_zero=True)
    phi = checked("sharpness", sharpness, "1/length")
    scaled = phi * real_array("distance", distance)
    return np.asarray(2.0 * mu / np.pi * (np.arctan(scaled) + scaled / (1.0 + scaled**2)), dtype=np.float64)


def _signed(xi: FloatArray, path: ContactPath, settings: FrictionSettings) -> FloatArray:
    return smoothed_coulomb(average_coefficient(path, settings), xi - path.L_XP, settings.sharpness)


def _analytic(
    low: FloatArray, high: FloatArray, path: ContactPath, settings: FrictionSettings
) -> tuple[FloatArray, FloatArray]:
    """The poles are P +- i/Phi. The derivative of arctan is bounded from the middle of a piece outwards.

    Where a piece contains a transition that is too short for a polynomial, |mu| is at most mu_avg.
    """
    phi = settings.sharpness
    pole = path.L_XP + 1j / settings.sharpness
    around = Ellipses.clear_of(low, high, [pole])
    least = (phi * around.distances(pole)[0]) ** 2  # |1 + Phi^2 d^2|
    angle = 0.5 * np.pi + phi * around.reach / least
    size = angle + phi * around.distances(path.L_XP)[1] / least
    size = np.where(around.clear, size, 0.5 * np.pi)
    return around.ratio, 2.0 / np.pi * average_coefficient(path, settings) * size


LAW = FrictionLaw(
    name="smoothed_coulomb",
    numeral="IV",
    label="smoothed Coulomb",
    formula=_signed,
    switches=lambda path, settings: [],
    coefficient=True,
    average_slope=AVERAGE_SLOPE,
    reads=AVERAGE_READS | {"sharpness"},
    factor=average_coefficient,
    analytic=_analytic,
)
