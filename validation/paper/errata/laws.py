"""Errata of the friction laws: equations 13b, 14, 16, 18 and 19."""

from __future__ import annotations

import numpy as np

from lumped import GearPair, PathFunction
from lumped.friction import benedict_kelley, mean_coefficient, xu_kahraman
from lumped.path_of_contact import contact_path, friction_path_function
from validation.paper.errata import dimensions
from validation.paper.errata.printed_laws import (
    average_coefficient,
    law_ii_printed,
    law_iii_printed,
    law_iv_printed,
)
from validation.paper.errata.response import response
from validation.paper.errata.signs import multiplier_change
from validation.paper.operating_points import mean_of_law
from validation.paper.records import Erratum, Evidence


def law_errata(pair: GearPair) -> tuple[Erratum, ...]:
    """Errata of the laws; ``pair`` at the operating point of their effects."""
    return _erratum_14(pair), _erratum_16(pair), _erratum_18(pair), _erratum_19(pair)


def law_effects(pair: GearPair, printed: PathFunction, law: str) -> list[Evidence]:
    """Mean coefficient, motions, efficiency and multipliers with a law as printed and as repaired."""
    own = pair.with_({"friction.law": law})
    right, wrong = response(own), response(own, friction=printed)
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


def _ratio(row: Evidence) -> float:
    return float(row.printed) / float(row.repaired)


def _erratum_14(pair: GearPair) -> Erratum:
    check = [float(benedict_kelley(100, 10, 2, v_e, 0.4)) for v_e in (2.0, 10.0)]
    effects = law_effects(pair, law_ii_printed(pair), "benedict_kelley")
    return Erratum(
        "13b, 14",
        "v_e = v_rp + v_rg typed as v_s; log argument with v_s v_s^2",
        "v_s v_e^2",
        "misprinted symbol",
        "Equation 13 defines v_s twice, as difference and as sum of the rolling velocities, and v_e never. "
        f"Taken literally, law II gives {_ratio(effects[0]):.2f} times the mean coefficient, and y_g "
        f"{_ratio(effects[2]):.2f} times its peak to peak. Its constant 29700 carries units, so dimensions "
        "cannot tell v_s^3 from v_s v_e^2; the definition and the law's source decide.",
        (
            Evidence(
                "law II at w 100 N/mm, eta 10 mPa s, v_s 2 m/s, v_e 10 m/s, S 0.4 µm",
                "1",
                check[0],
                check[1],
                "0.06235267 (worked out by hand)",
            ),
            dimensions.evidence("of the logarithm", dimensions.equation_14),
            *effects,
        ),
    )


def _erratum_16(pair: GearPair) -> Erratum:
    path = contact_path(pair)
    at_pitch = float(path.hertz_pressure(np.array(path.L_XP))) * 1e-9
    # Hertz in SI, without any unit factor: p_h = sqrt(w E'/(2 pi rho)).
    rho = float(path.radius(np.array(path.L_XP)))
    si = float(np.sqrt(path.unit_load * path.effective_modulus / (2.0 * np.pi * rho))) * 1e-9
    return Erratum(
        "16",
        "rho_h = sqrt(w_n E'/(2000 pi rho_r))",
        "p_h = ...",
        "misprinted symbol",
        "The right side is a pressure: w_n in N/mm, E' in GPa and rho_r in mm give GPa with the factor "
        f"{dimensions.hertz_factor():.5f} = 1/sqrt(1000), which is the 2000 in the place of 2. At the pitch "
        f"point it is {at_pitch:.4f} GPa; Hertz's formula in SI units gives {si:.4f} GPa.",
        (
            dimensions.evidence("of the left side", dimensions.equation_16),
            Evidence("Hertz pressure at the pitch point, (16) and Hertz in SI", "GPa", at_pitch, si, "equal"),
            Evidence(
                "motion, mean speed and multipliers",
                "",
                "as repaired: the formula is right",
                "those of law III",
            ),
        ),
    )


def _erratum_18(pair: GearPair) -> Erratum:
    # SR = 0.1 and V_e = 10 m/s mean v_s = 1 m/s.
    check = [float(xu_kahraman(1.0, 0.1, v, 10.0, 0.3, 0.008)) for v in (1.0, 10.0)]
    in_mm = float(xu_kahraman(1.0, 0.1, 10.0, 10.0, 0.3, 8.0))
    effects = law_effects(pair, law_iii_printed(pair), "xu_kahraman")
    wrong_unit = law_effects(
        pair, law_iii_printed(pair, sliding_speed=False, millimetres=True), "xu_kahraman"
    )
    return Erratum(
        "18",
        "V_s^b6; unit of R not given",
        "V_e^b6; R in metres",
        "wrong",
        f"V_s for V_e raises the mean coefficient {_ratio(effects[0]):.3f} times and y_g "
        f"{_ratio(effects[2]):.3f} times. R in millimetres divides mu by {check[1] / in_mm:.2f} everywhere: "
        f"a mean of {float(wrong_unit[0].printed):.2g} at the figures' operating point, far below what "
        "elastohydrodynamic contacts show. The law is a regression, so dimensions cannot decide; the "
        "magnitude does.",
        (
            Evidence(
                "law III at p_h 1 GPa, SR 0.1, V_e 10 m/s, eta 10 mPa s, S 0.3 µm, R 8 mm: V_s for V_e",
                "1",
                check[0],
                check[1],
                "0.01039515 (worked out by hand)",
            ),
            Evidence("the same with R in mm", "1", in_mm, check[1], "0.01039515 (worked out by hand)"),
            *effects,
            *(
                Evidence(f"{row.quantity}, R in mm", row.unit, row.printed, row.repaired)
                for row in wrong_unit
            ),
        ),
    )


def derivative_residual(pair: GearPair, function: PathFunction, mu: float) -> float:
    """Largest |law - d/dd ((2 mu/pi) d arctan(Phi d))| over the path, over mu; by complex-step derivative.

    Parameters
    ----------
    pair : gives Phi
    function : law IV, signed
    mu : its average coefficient
    """
    g, phi = pair.geometry, pair.friction.sharpness
    xi = np.linspace(g.L_XA, g.L_XD, 4001)[1:-1]
    d = xi - g.L_XP
    step = 1e-30
    potential = (d + 1j * step) * np.arctan(phi * (d + 1j * step))
    exact = 2.0 * mu / np.pi * potential.imag / step
    return float(np.abs(function(xi) - exact).max()) / mu


def _erratum_19(pair: GearPair) -> Erratum:
    own = pair.with_({"friction.law": "smoothed_coulomb"})
    mu = average_coefficient(own)
    printed, right = law_iv_printed(own), friction_path_function(own)
    effects = law_effects(own, printed, "smoothed_coulomb")
    residual = [derivative_residual(own, f, mu) for f in (printed, right)]
    return Erratum(
        "19",
        "sigma (contact ratio) in the second numerator",
        "Phi",
        "wrong",
        "With Phi the law is exactly the derivative of (2 mu_avg/pi) d arctan(Phi d); "
        f"with sigma it misses that by {100 * residual[0]:.3g} % of mu_avg near the pitch point, and adds a "
        "length to a pure number. Away from the pitch point both tend to Coulomb's law, so the effect on the "
        "motions is small.",
        (
            Evidence(
                "largest distance from the derivative of (2 mu_avg/pi) d arctan(Phi d)",
                "% of mu_avg",
                100 * residual[0],
                100 * residual[1],
                "0",
            ),
            dimensions.evidence("of the sum", dimensions.equation_19),
            *effects,
        ),
    )
