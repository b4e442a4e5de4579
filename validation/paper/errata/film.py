"""Errata of the lubrication regime and the film: equations 20 and 21."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import brentq

from lumped import GearPair
from lumped.lubrication.film import film_parameter, regime
from lumped.path_of_contact import contact_path, friction_path_function
from validation.paper.errata import dimensions
from validation.paper.errata.laws import law_effects
from validation.paper.errata.printed_laws import (
    PRINTED_FILM_EXPONENT,
    PRINTED_SPEED_EXPONENT,
    film_thickness_printed,
)
from validation.paper.records import Erratum, Evidence


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
    return Erratum(
        "20",
        "no case for Lambda >= 10",
        "law III (full film)",
        "incomplete",
        f"At 22.6 N m and the calibrated roughness Lambda reaches {thresholds[2]:g} at the pitch point at "
        f"{onset:.0f} rpm. 20 % faster the printed law V has no value over {100 * share:.0f} % of the path "
        "of contact; below that speed the gap does not matter.",
        (
            Evidence(
                f"share of the path where law V has no value, 22.6 N m, {1.2 * onset:.0f} rpm",
                "%",
                100 * share,
                0.0,
                "0",
            ),
            Evidence("speed from which the gap is met, 22.6 N m", "rpm", onset, "never", "never"),
            Evidence(
                f"motion, mean speed and multipliers under law V, 22.6 N m, {1.2 * onset:.0f} rpm",
                "",
                "none: no friction coefficient",
                "those of law III",
                "exist",
            ),
        ),
    )


def _erratum_21(pair: GearPair) -> Erratum:
    light = pair.with_(operating__pinion_torque=22.6, operating__pinion_speed=2500)
    path = contact_path(light)
    pitch = np.array(path.L_XP)
    right = float(path.film_thickness(pitch)) * 1e6
    cases = {
        "both": float(film_thickness_printed(path, pitch)) * 1e6,
        "21a only": float(film_thickness_printed(path, pitch, speed=False)) * 1e6,
        "21d only": float(film_thickness_printed(path, pitch, film=False)) * 1e6,
    }
    width, rough = float(path.half_width(pitch)) * 1e3, path.composite_roughness * 1e6
    length = path.film_length * 1e3

    def parameter(film: float) -> float:
        return float(film_parameter(film, width, rough, length))

    needed = rough * parameter(cases["both"]) / light.friction.thresholds[1]
    return Erratum(
        "21a, d",
        f"10^{PRINTED_FILM_EXPONENT} (film in µm), 10^{PRINTED_SPEED_EXPONENT} (U)",
        "10^3, 10^-6",
        "wrong",
        f"Units fix both powers of ten: a film in mm times 10^{dimensions.film_exponent():.0f} is in µm, and "
        "eta v_e/(E_r rho_r) in mPa s, m/s, N/mm^2 and mm is a pure number with "
        f"10^{dimensions.speed_exponent():.0f}. At 22.6 N m and 2500 rpm the film at the pitch point is "
        f"{right:.3g} µm, with both printed powers {cases['both']:.2g} µm; the regime switch of Fig. 2b at "
        f"2500 rpm would then ask for a composite roughness of {1e3 * needed:.2g} nm.",
        (
            Evidence(
                "power of ten of the film in µm",
                "1",
                PRINTED_FILM_EXPONENT,
                dimensions.film_exponent(),
                "3, by units",
            ),
            Evidence(
                "power of ten of U", "1", PRINTED_SPEED_EXPONENT, dimensions.speed_exponent(), "-6, by units"
            ),
            *(Evidence(f"film at the pitch point, {name}", "µm", v, right) for name, v in cases.items()),
            Evidence("Lambda at the pitch point, both", "1", parameter(cases["both"]), parameter(right)),
            Evidence(
                "composite roughness that puts Lambda = 4 at 2500 rpm and 22.6 N m",
                "µm",
                needed,
                rough * parameter(right) / light.friction.thresholds[1],
                "0.05 to 1 µm, as ground gears have",
            ),
            *(
                replace(row, quantity=f"law V: {row.quantity}")
                for row in _film_effects(pair, cases["both"] / right)
            ),
        ),
    )


def _film_effects(pair: GearPair, factor: float) -> list[Evidence]:
    """Effects of the printed film on law V at the pair's own operating point.

    Both printed powers multiply Lambda by one factor everywhere: the law as printed is the right one with its
    thresholds divided by that factor.

    Parameters
    ----------
    pair : the gear pair
    factor : printed film over the right one
    """
    moved = [threshold / factor for threshold in pair.friction.thresholds]
    printed = friction_path_function(pair.with_({"friction.thresholds": moved}), law="composite")
    return law_effects(pair, printed, "composite")
