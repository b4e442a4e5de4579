"""Errata of symbols and kinematics: equations 8 and 5b."""

from __future__ import annotations

import numpy as np

from lumped import GearPair, Geometry, load_gear_pair
from lumped.typing import FloatArray
from reproductions.he_cho_singh_2008.errata import dimensions
from reproductions.he_cho_singh_2008.errata.stated import stated
from reproductions.he_cho_singh_2008.records import Erratum


def erratum_8() -> Erratum:
    """Equation 8: x_p'' and K_pBx with y_p."""
    # Which of theta_p'', theta_g'', x_p'', x_g'', y_p'', y_g'' stands in equations 1, 2, 6 to 9.
    inertia = {"printed": [0, 1, 2, 3, 2, 5], "repaired": [0, 1, 2, 3, 4, 5]}
    ranks = [int(np.linalg.matrix_rank(np.eye(6)[columns])) for columns in inertia.values()]
    numbers = dict(zip(inertia, ranks, strict=True))
    return stated("8", numbers | dimensions.verdicts(dimensions.equation_8))


def gear_arms(g: Geometry, phase: FloatArray, *, printed: bool) -> FloatArray:
    """X_gi of equation 5b at phases tau (0 to 1) of the mesh cycle, (pairs, k) [m].

    As printed L_YC + i lambda - mod(Omega_g r_bg t, lambda), with L_YC = L_XY - L_XC; as repaired L_XY -
    X_pi.
    """
    i = np.arange(g.pairs)[:, None]
    if printed:
        return np.asarray(g.L_XY - g.L_XC + i * g.base_pitch - phase * g.base_pitch, dtype=np.float64)
    return np.asarray(g.L_XY - pinion_arms(g, phase), dtype=np.float64)


def pinion_arms(g: Geometry, phase: FloatArray) -> FloatArray:
    """X_pi = L_XA + (n - i) lambda + phase lambda of equation 5a, (pairs, k) [m]."""
    i = np.arange(g.pairs)[:, None]
    return np.asarray(g.L_XA + (g.pairs - 1 - i + phase) * g.base_pitch, dtype=np.float64)


def erratum_5b(pair: GearPair) -> Erratum:
    """Equation 5b: right for contact ratios below 2 only."""
    low = pair.geometry
    high = high_contact_ratio().geometry
    phase = np.linspace(0.0, 1.0, 64, endpoint=False)

    def residual(g: Geometry, printed: bool) -> float:
        total = pinion_arms(g, phase) + gear_arms(g, phase, printed=printed)
        return 1e3 * float(np.abs(total - g.L_XY).max())

    numbers: dict[str, object] = {
        "low": low,
        "high": high,
        "motion": "as repaired: the same arms" if low.pairs == 2 else "wrong lever of friction",
    }
    for name, g in (("low", low), ("high", high)):
        numbers |= {f"{name}_printed": residual(g, True), f"{name}_repaired": residual(g, False)}
    return stated("5b", numbers)


def high_contact_ratio() -> GearPair:
    """The 28/28 pair with addenda of 1.35 modules: two to three tooth pairs in contact."""
    return load_gear_pair("nasa_28_28").with_(
        {
            "mesh.contact": "prescribed",
            "basic_rack.addendum_coefficient": 1.35,
            "basic_rack.dedendum_coefficient": 1.55,
            "basic_rack.fillet_radius_coefficient": 0.1,
            "pinion.tip_relief": None,
            "gear.tip_relief": None,
        }
    )
