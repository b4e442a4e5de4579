"""The friction and film laws as printed, for comparison with the repaired ones of ``lumped``.

Each function takes positions xi (k,) [m] and the nominal contact of a pair, and returns signed mu (k,).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from lumped import GearPair, PathFunction
from lumped.friction import ContactPath, xu_kahraman
from lumped.path_of_contact import contact_path
from lumped.typing import FloatArray
from reproductions.he_cho_singh_2008.operating_points import mean_of_law

Law = Callable[[FloatArray], FloatArray]

#: Far below every number that the errata state.
_TOLERANCE = 1e-8
#: Powers of ten of equation 21 as printed: of the film in um (a) and of the speed parameter U (d).
PRINTED_FILM_EXPONENT = 8
PRINTED_SPEED_EXPONENT = -16


def average_coefficient(pair: GearPair) -> float:
    """mu_avg of laws I and IV: the coefficient of the pair, or else the mean of law II over the path."""
    coefficient = pair.friction.coefficient
    return mean_of_law(pair, "benedict_kelley") if coefficient is None else coefficient


def law_ii_level(path: ContactPath, xi: FloatArray) -> FloatArray:
    """Law II with v_s v_s^2 in the logarithm, before its bounds (equation 14 as printed)."""
    s = path.roughness * 1e6
    number = 29700.0 * path.unit_load * 1e-3 / (path.viscosity * 1e3 * path.sliding_velocity(xi) ** 3)
    return np.asarray(0.0127 * 1.13 / (1.13 - s) * np.log10(number), dtype=np.float64)


def law_ii_printed(pair: GearPair) -> PathFunction:
    """Law II as printed, with the bounds of the repaired law (0 and ``friction.maximum``)."""
    path = contact_path(pair)
    settings = pair.friction
    bounds = [
        xi
        for level in (0.0, settings.maximum)
        for xi in path.crossings(lambda x, level=level: law_ii_level(path, x) - level)  # type: ignore[misc]
    ]

    def law(xi: FloatArray) -> FloatArray:
        magnitude = np.clip(law_ii_level(path, xi), 0.0, settings.maximum)
        return np.asarray(np.sign(xi - path.L_XP) * magnitude, dtype=np.float64)

    return _fitted(pair, law, bounds)


def law_iii_printed(pair: GearPair, *, sliding_speed: bool = True, millimetres: bool = False) -> PathFunction:
    """Law III with V_s for V_e (equation 18 as printed), or with R in millimetres (its unit is not given).

    Parameters
    ----------
    pair : the gear pair
    sliding_speed : take V_s = v_s for the rolling velocity
    millimetres : take R in mm
    """
    path = contact_path(pair)

    def law(xi: FloatArray) -> FloatArray:
        speed = path.sliding_velocity(xi) if sliding_speed else 0.5 * path.entraining_velocity(xi)
        magnitude = xu_kahraman(
            path.hertz_pressure(xi) * 1e-9,
            path.slide_to_roll(xi),
            speed,
            path.viscosity * 1e3,
            path.roughness * 1e6,
            path.radius(xi) * (1e3 if millimetres else 1.0),
        )
        return np.asarray(np.sign(xi - path.L_XP) * magnitude, dtype=np.float64)

    return _fitted(pair, law)


def law_iv_printed(pair: GearPair) -> PathFunction:
    """Law IV with the contact ratio sigma in the second numerator (equation 19 as printed), lengths in mm."""
    path = contact_path(pair)
    mu = average_coefficient(pair)
    sigma = pair.geometry.contact_ratio
    phi = pair.friction.sharpness * 1e-3

    def law(xi: FloatArray) -> FloatArray:
        d = 1e3 * (xi - path.L_XP)
        second = d * sigma / (1.0 + (phi * d) ** 2)
        return np.asarray(2.0 * mu / np.pi * (np.arctan(phi * d) + second), dtype=np.float64)

    return _fitted(pair, law)


def film_thickness_printed(
    path: ContactPath, xi: FloatArray, *, film: bool = True, speed: bool = True
) -> FloatArray:
    """Central film thickness [m] with the printed powers of ten (21a film, 21d speed) (k,)."""
    # U enters with the power 0.69; 10^3 and 10^-6 are the repaired powers.
    factor = 10.0 ** (PRINTED_FILM_EXPONENT - 3) if film else 1.0
    if speed:
        factor *= 10.0 ** (0.69 * (PRINTED_SPEED_EXPONENT + 6))
    return factor * path.film_thickness(xi)


def _fitted(pair: GearPair, law: Law, bounds: list[float] | None = None) -> PathFunction:
    g = pair.geometry
    inner = [xi for xi in bounds or [] if g.L_XA < xi < g.L_XD]
    # Graded towards the pitch point, where powers of the sliding velocity are hardest to fit.
    graded = [
        g.L_XP + side * distance
        for side, reach in ((-1.0, g.L_XP - g.L_XA), (1.0, g.L_XD - g.L_XP))
        for distance in reach * 10.0 ** np.arange(-5.0, 0.0)
    ]
    breaks = sorted({g.L_XA, g.L_XP, g.L_XD, *inner, *graded})
    return PathFunction.fit(law, breaks, [g.L_XP, *inner], tolerance=_TOLERANCE)
