"""Errata of the lubrication regime and the film: equations 20 and 21."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from lumped import GearPair
from lumped.lubrication.film import film_parameter, regime
from lumped.path_of_contact import contact_path, friction_path_function
from reproductions.he_cho_singh_2008.errata import dimensions
from reproductions.he_cho_singh_2008.errata.laws import law_effects
from reproductions.he_cho_singh_2008.errata.printed_laws import (
    PRINTED_FILM_EXPONENT,
    PRINTED_SPEED_EXPONENT,
    film_thickness_printed,
)
from reproductions.he_cho_singh_2008.errata.stated import stated
from reproductions.he_cho_singh_2008.records import Erratum, Evidence


def film_errata(pair: GearPair) -> tuple[Erratum, ...]:
    """Errata of equations 20 and 21, at the torque and with the roughness of Fig. 2b."""
    return _erratum_20(pair), _erratum_21(pair)


def speed_of_film_parameter(pair: GearPair, level: float, xi: float) -> float:
    """Pinion speed [rpm] at which Lambda reaches a level at one position; Lambda grows with v_e^0.69.

    Parameters
    ----------
    pair : the gear pair, at its torque
    level : film parameter
    xi : position from X [m]
    """

    def excess(log_rpm: float) -> float:
        path = contact_path(pair.with_(operating__pinion_speed=float(np.exp(log_rpm))))
        return float(np.log(path.film_parameter(np.array(xi)))) - float(np.log(level))

    return float(np.exp(brentq(excess, np.log(1e-2), np.log(1.9e5), xtol=1e-10)))


def _erratum_20(pair: GearPair) -> Erratum:
    light = pair.with_(operating__pinion_torque=22.6)
    thresholds = pair.friction.thresholds
    onset = speed_of_film_parameter(light, thresholds[2], light.geometry.L_XP)
    fast = light.with_(operating__pinion_speed=1.2 * onset)
    path = contact_path(fast)
    xi = np.linspace(path.L_XA, path.L_XD, 2001)
    share = float(np.mean(regime(path.film_parameter(xi), thresholds) == 3))
    numbers = {"full": thresholds[2], "onset": onset, "fast": 1.2 * onset, "share": 100 * share}
    return stated("20", numbers)


def _erratum_21(pair: GearPair) -> Erratum:
    light = pair.with_(operating__pinion_torque=22.6, operating__pinion_speed=2500)
    path = contact_path(light)
    pitch = np.array(path.L_XP)
    right = float(path.film_thickness(pitch)) * 1e6
    both, film_only, speed_only = (
        float(film_thickness_printed(path, pitch, film=film, speed=speed)) * 1e6
        for film, speed in ((True, True), (True, False), (False, True))
    )
    width = float(path.half_width(pitch)) * 1e3
    rough = path.composite_roughness * 1e6
    length = path.film_length * 1e3

    def parameter(film: float) -> float:
        return float(film_parameter(film, width, rough, length))

    switch = light.friction.thresholds[1]
    numbers = {
        "film_printed": PRINTED_FILM_EXPONENT,
        "film": dimensions.film_exponent(),
        "speed_printed": PRINTED_SPEED_EXPONENT,
        "speed": dimensions.speed_exponent(),
        "right": right,
        "both": both,
        "film_only": film_only,
        "speed_only": speed_only,
        "lambda_printed": parameter(both),
        "lambda_repaired": parameter(right),
        "roughness_printed": rough * parameter(both) / switch,
        "roughness_repaired": rough * parameter(right) / switch,
        "needed": 1e3 * rough * parameter(both) / switch,
    }
    effects = _film_effects(pair, both / right)
    return stated("21a, d", numbers, [replace(row, quantity=f"law V: {row.quantity}") for row in effects])


def _film_effects(pair: GearPair, factor: float) -> list[Evidence]:
    """Effects of the printed film on law V at the operating point of the pair.

    Both printed powers multiply Lambda by a constant factor. So the law as printed is the right law with all
    thresholds divided by this factor.

    Parameters
    ----------
    pair : the gear pair
    factor : printed film over the right one
    """
    scaled_thresholds = [threshold / factor for threshold in pair.friction.thresholds]
    printed = friction_path_function(pair.with_({"friction.thresholds": scaled_thresholds}), law="composite")
    return law_effects(pair, printed, "composite")
