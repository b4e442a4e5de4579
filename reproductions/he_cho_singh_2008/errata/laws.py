"""Errata of the friction laws: equations 13b, 14, 16, 18 and 19."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lumped import GearPair, PathFunction
from lumped.friction import benedict_kelley, mean_coefficient, xu_kahraman
from lumped.path_of_contact import contact_path, friction_path_function
from reproductions.he_cho_singh_2008.errata import dimensions
from reproductions.he_cho_singh_2008.errata.printed_laws import (
    average_coefficient,
    law_ii_printed,
    law_iii_printed,
    law_iv_printed,
)
from reproductions.he_cho_singh_2008.errata.response import response
from reproductions.he_cho_singh_2008.errata.signs import multiplier_change
from reproductions.he_cho_singh_2008.errata.stated import stated
from reproductions.he_cho_singh_2008.operating_points import mean_of_law
from reproductions.he_cho_singh_2008.records import Erratum, Evidence


def law_errata(pair: GearPair) -> tuple[Erratum, ...]:
    """Errata of the laws; ``pair`` at the operating point of their effects."""
    return _erratum_14(pair), _erratum_16(pair), _erratum_18(pair), _erratum_19(pair)


def law_effects(pair: GearPair, printed: PathFunction, law: str) -> list[Evidence]:
    """Mean coefficient, motions, efficiency and multipliers with a law as printed and as repaired."""
    pair_with_law = pair.with_({"friction.law": law})
    right = response(pair_with_law)
    wrong = response(pair_with_law, friction=printed)
    mean = "mean of |mu| over the path of contact"
    return [
        Evidence(mean, "1", mean_coefficient(printed), mean_of_law(pair, law)),
        *(
            Evidence(f"peak to peak of {name}", "µm", wrong.peak_to_peak(name), right.peak_to_peak(name))
            for name in ("dte", "y_g")
        ),
        Evidence("mesh efficiency", "1", wrong.efficiency, right.efficiency),
        Evidence("largest change of a Floquet multiplier", "1", multiplier_change(wrong, right), 0.0),
    ]


def _raised(effects: list[Evidence]) -> dict[str, float]:
    """Mean coefficient and peak to peak of y_g as printed over those as repaired."""
    mean, _, y_g, *_ = (float(row.printed) / float(row.repaired) for row in effects[:3])
    return {"mean": mean, "y_g": y_g}


def _erratum_14(pair: GearPair) -> Erratum:
    check = [float(benedict_kelley(100, 10, 2, v_e, 0.4)) for v_e in (2.0, 10.0)]
    effects = law_effects(pair, law_ii_printed(pair), "benedict_kelley")
    numbers = {"law_printed": check[0], "law_repaired": check[1]} | _raised(effects)
    return stated("13b, 14", numbers | dimensions.verdicts(dimensions.equation_14), effects)


def _erratum_16(pair: GearPair) -> Erratum:
    path = contact_path(pair)
    at_pitch = float(path.hertz_pressure(np.array(path.L_XP))) * 1e-9
    # Hertz in SI, without any unit factor: p_h = sqrt(w E'/(2 pi rho)).
    rho = float(path.radius(np.array(path.L_XP)))
    si = float(np.sqrt(path.unit_load * path.effective_modulus / (2.0 * np.pi * rho))) * 1e-9
    numbers = {"factor": dimensions.hertz_factor(), "at_pitch": at_pitch, "si": si}
    return stated("16", numbers | dimensions.verdicts(dimensions.equation_16))


def _erratum_18(pair: GearPair) -> Erratum:
    # SR = 0.1 and V_e = 10 m/s mean v_s = 1 m/s.
    check = [float(xu_kahraman(1.0, 0.1, v, 10.0, 0.3, 0.008)) for v in (1.0, 10.0)]
    in_mm = float(xu_kahraman(1.0, 0.1, 10.0, 10.0, 0.3, 8.0))
    effects = law_effects(pair, law_iii_printed(pair), "xu_kahraman")
    wrong_unit = law_effects(
        pair, law_iii_printed(pair, sliding_speed=False, millimetres=True), "xu_kahraman"
    )
    numbers = {
        "law_printed": check[0],
        "law_repaired": check[1],
        "law_in_mm": in_mm,
        "millimetres": check[1] / in_mm,
        "wrong_unit": wrong_unit[0].printed,
    }
    in_millimetres = [replace(row, quantity=f"{row.quantity}, R in mm") for row in wrong_unit]
    return stated("18", numbers | _raised(effects), effects + in_millimetres)


def derivative_residual(pair: GearPair, function: PathFunction, mu: float) -> float:
    """Largest |law - d/dd ((2 mu/pi) d arctan(Phi d))| over the path, over mu; by complex-step derivative.

    Parameters
    ----------
    pair : gives Phi
    function : law IV, signed
    mu : its average coefficient
    """
    g = pair.geometry
    phi = pair.friction.sharpness
    xi = np.linspace(g.L_XA, g.L_XD, 4001)[1:-1]
    d = xi - g.L_XP
    step = 1e-30
    potential = (d + 1j * step) * np.arctan(phi * (d + 1j * step))
    exact = 2.0 * mu / np.pi * potential.imag / step
    return float(np.abs(function(xi) - exact).max()) / mu


def _erratum_19(pair: GearPair) -> Erratum:
    pair_with_law = pair.with_({"friction.law": "smoothed_coulomb"})
    mu = average_coefficient(pair_with_law)
    printed = law_iv_printed(pair_with_law)
    right = friction_path_function(pair_with_law)
    effects = law_effects(pair_with_law, printed, "smoothed_coulomb")
    residual = [derivative_residual(pair_with_law, f, mu) for f in (printed, right)]
    numbers = {"residual": 100 * residual[0], "residual_repaired": 100 * residual[1]}
    return stated("19", numbers | dimensions.verdicts(dimensions.equation_19), effects)
