"""Line contact of two teeth: Hertz pressure, roughness, elastohydrodynamic film and film parameter.

The functions keep the units in which the film equations are published: N, mm, N/mm^2, mPa s, m/s and um.
Equations (15), (16) and (21) of the model, with the powers of ten that its dimensions require. Roughness is
Ra; data sheets may give Rq: Rq/Ra is sqrt(pi/2) = 1.253 for Gaussian heights, pi/(2 sqrt(2)) = 1.111 for a
sine.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lumped.arguments import real_array
from lumped.errors import refuse, shown
from lumped.ranges import NOT_STATED, ValidityRange, checked
from lumped.typing import FloatArray

#: Film thickness ratios at which the lubrication regime changes.
DEFAULT_THRESHOLDS = (1.0, 4.0, 10.0)

#: Names of the regimes that ``regime`` numbers 0 to 3.
REGIMES = ("boundary", "mixed", "elastohydrodynamic", "full film")

#: Pressure-viscosity law alpha = k eta^s of a mineral oil, alpha in mm^2/N, eta in mPa s (AGMA 925-A03).
MINERAL_OIL_K = 0.010471
MINERAL_OIL_S = 0.1348

#: Wavelength cut-off of the roughness measurement [mm], the L_x of equation (21).
DEFAULT_FILM_LENGTH = 0.8

RANGES = (
    ValidityRange("unit_load", "N/mm", None, None, NOT_STATED),
    ValidityRange("entraining_velocity", "m/s", None, None, NOT_STATED),
    ValidityRange("viscosity", "mPa s", None, None, NOT_STATED),
)


def effective_modulus(
    youngs_modulus_pinion: float,
    poisson_ratio_pinion: float,
    youngs_modulus_gear: float,
    poisson_ratio_gear: float,
) -> float:
    """Effective modulus of two bodies in contact, E' = 2 / ((1 - nu_p^2)/E_p + (1 - nu_g^2)/E_g).

    In the unit of the moduli; for equal bodies E/(1 - nu^2).

    >>> round(float(effective_modulus(206e3, 0.3, 206e3, 0.3)), 1)
    226373.6
    """
    pinion = (1.0 - poisson_ratio_pinion**2) / youngs_modulus_pinion
    return 2.0 / (pinion + (1.0 - poisson_ratio_gear**2) / youngs_modulus_gear)


def hertz_half_width(
    unit_load: float | FloatArray, radius: FloatArray, effective_modulus: float
) -> FloatArray:
    """Half width b_H of the Hertzian contact band [mm], b_H = sqrt(8 w rho / (pi E')).

    w is the load per face width [N/mm], rho the reduced radius of curvature [mm], E' in N/mm^2.

    >>> round(float(hertz_half_width(100, 8, 226373.6)), 7)
    0.0948642
    """
    return np.asarray(np.sqrt(8.0 * unit_load * radius / (np.pi * effective_modulus)))


def hertz_pressure(unit_load: float | FloatArray, radius: FloatArray, effective_modulus: float) -> FloatArray:
    """Largest Hertzian pressure of a line contact [GPa], p_h = sqrt(w E' / (2 pi rho)), equation (16).

    Arguments as in ``hertz_half_width``.

    >>> round(float(hertz_pressure(100, 8, 226373.6)), 6)
    0.671086
    """
    return np.asarray(1e-3 * np.sqrt(unit_load * effective_modulus / (2.0 * np.pi * radius)))


def pressure_viscosity(viscosity: float, k: float = MINERAL_OIL_K, s: float = MINERAL_OIL_S) -> float:
    """Pressure-viscosity coefficient alpha = k eta^s [mm^2/N] at a dynamic viscosity [mPa s].

    >>> round(float(pressure_viscosity(10)), 6)
    0.014282
    """
    return float(k * viscosity**s)


#: Formula of the film thickness -> its factor and the powers of G, U and W.
_FORMULAS = {"dowson_toyoda": (3.06, 0.56, 0.69, -0.10), "hamrock_dowson": (2.69, 0.53, 0.67, -0.067)}


def film_thickness(
    unit_load: float,
    radius: FloatArray,
    viscosity: float,
    entraining_velocity: FloatArray,
    effective_modulus: float,
    *,
    pressure_viscosity_k: float = MINERAL_OIL_K,
    pressure_viscosity_s: float = MINERAL_OIL_S,
    formula: str = "dowson_toyoda",
) -> FloatArray:
    """Central film thickness of a line contact [um], H_c = 3.06 G^0.56 U^0.69 W^-0.10, equation (21).

    G = alpha E', U = 1e-6 eta v_e / (2 E' rho), W = w / (E' rho), h_c = H_c rho, with the load per face width
    w [N/mm], the reduced radius rho [mm], the viscosity eta at the inlet [mPa s], the *sum* v_e of both
    rolling velocities [m/s] and E' [N/mm^2]. Smooth surfaces, steady, isothermal. D. Dowson and S. Toyoda, "A
    central film thickness formula for elastohydrodynamic line contacts", Proc. 5th Leeds-Lyon Symposium on
    Tribology, 1978; used in AGMA 925-A03.

    With ``formula`` "hamrock_dowson" that of a long ellipse, H_c = 2.69 U^0.67 G^0.53 W^-0.067: how far both
    differ says how well a film thickness is known. The print's factor 1 - 0.61 exp(-0.73 k) is 1 for the
    ellipticity k of a line contact, and its load F/(E' rho^2) becomes w/(E' rho). B. J. Hamrock and
    D. Dowson, "Isothermal elastohydrodynamic lubrication of point contacts, part III", J. Lubr. Technol. 99
    (1977) 264-276.

    >>> modulus = effective_modulus(206e3, 0.3, 206e3, 0.3)
    >>> round(float(film_thickness(100, 8, 10, 10, modulus)), 6)
    0.312115
    >>> round(float(film_thickness(100, 8, 10, 10, modulus, formula="hamrock_dowson")), 6)
    0.253352
    """
    factor, of_material, of_speed, of_load = _FORMULAS[formula]
    material = pressure_viscosity(viscosity, pressure_viscosity_k, pressure_viscosity_s) * effective_modulus
    speed = 1e-6 * viscosity * entraining_velocity / (2.0 * effective_modulus * radius)
    load = unit_load / (effective_modulus * radius)
    thickness = factor * material**of_material * speed**of_speed * load**of_load * radius * 1e3
    return np.asarray(thickness, dtype=np.float64)


def film_parameter(
    film_thickness: ArrayLike,
    half_width: ArrayLike,
    composite_roughness: ArrayLike,
    film_length: ArrayLike = DEFAULT_FILM_LENGTH,
) -> FloatArray:
    """Film parameter Lambda = (h_c / R_comp) sqrt(L_x / (2 b_H)) [-], equation (21).

    The root rescales a roughness R_comp [um] measured over the cut-off L_x [mm] to the width 2 b_H [mm] of
    the contact band; h_c [um].

    >>> round(float(film_parameter(0.312115, 0.0948642, 0.5, 0.8)), 5)
    1.28181
    """
    roughness = checked("composite_roughness", composite_roughness, "um")  # both flanks may be smooth
    ratio = np.divide(film_length, 2.0 * np.asarray(half_width))
    return np.asarray(np.divide(film_thickness, roughness) * np.sqrt(ratio), dtype=np.float64)


def regime(film_parameter: ArrayLike, thresholds: Sequence[float] = DEFAULT_THRESHOLDS) -> NDArray[np.int64]:
    """Lubrication regime by film parameter: 0 boundary, 1 mixed, 2 elastohydrodynamic, 3 full film.

    A film parameter equal to a threshold belongs to the regime above it.

    >>> int(regime(2.0))
    1
    """
    limits = real_array("friction.thresholds", thresholds)
    if limits.shape != (3,) or not (np.diff(limits) > 0).all() or limits[0] <= 0:
        allowed = "three increasing positive film parameters"
        raise refuse("friction.thresholds", shown(thresholds), allowed, "Use for example [1, 4, 10].")
    value = checked("film_parameter", film_parameter, "", allow_zero=True)
    return np.asarray(np.digitize(value, limits), dtype=np.int64)
