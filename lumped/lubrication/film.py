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
    youngs_modulus_pinion: ArrayLike,
    poisson_ratio_pinion: ArrayLike,
    youngs_modulus_gear: ArrayLike,
    poisson_ratio_gear: ArrayLike,
) -> FloatArray:
    """Effective modulus of two bodies in contact, E' = 2 / ((1 - nu_p^2)/E_p + (1 - nu_g^2)/E_g).

    In the unit of the moduli; for equal bodies E/(1 - nu^2).

    >>> round(float(effective_modulus(206e3, 0.3, 206e3, 0.3)), 1)
    226373.6
    """
    pinion = _strain("poisson_ratio_pinion", poisson_ratio_pinion) / checked(
        "youngs_modulus_pinion", youngs_modulus_pinion, ""
    )
    gear = _strain("poisson_ratio_gear", poisson_ratio_gear) / checked(
        "youngs_modulus_gear", youngs_modulus_gear, ""
    )
    return np.asarray(2.0 / (pinion + gear), dtype=np.float64)


def _strain(field: str, poisson_ratio: ArrayLike) -> FloatArray:
    """1 - nu^2 of plane strain."""
    nu = real_array(field, poisson_ratio)
    if not ((nu > -1.0) & (nu <= 0.5)).all():
        raise refuse(field, shown(poisson_ratio), "> -1 and <= 0.5", "Steel has 0.3.")
    return np.asarray(1.0 - np.square(nu), dtype=np.float64)


def _line_contact(
    unit_load: ArrayLike, radius: ArrayLike, effective_modulus: ArrayLike
) -> tuple[FloatArray, FloatArray, FloatArray]:
    return (
        checked("unit_load", unit_load, "N/mm", allow_zero=True),
        checked("radius", radius, "mm"),
        checked("effective_modulus", effective_modulus, "N/mm^2"),
    )


def hertz_half_width(unit_load: ArrayLike, radius: ArrayLike, effective_modulus: ArrayLike) -> FloatArray:
    """Half width b_H of the Hertzian contact band [mm], b_H = sqrt(8 w rho / (pi E')).

    w is the load per face width [N/mm], rho the reduced radius of curvature [mm], E' in N/mm^2.

    >>> round(float(hertz_half_width(100, 8, 226373.6)), 7)
    0.0948642
    """
    w, rho, modulus = _line_contact(unit_load, radius, effective_modulus)
    return np.asarray(np.sqrt(8.0 * w * rho / (np.pi * modulus)), dtype=np.float64)


def hertz_pressure(unit_load: ArrayLike, radius: ArrayLike, effective_modulus: ArrayLike) -> FloatArray:
    """Largest Hertzian pressure of a line contact [GPa], p_h = sqrt(w E' / (2 pi rho)), equation (16).

    Arguments as in ``hertz_half_width``.

    >>> round(float(hertz_pressure(100, 8, 226373.6)), 6)
    0.671086
    """
    w, rho, modulus = _line_contact(unit_load, radius, effective_modulus)
    return np.asarray(1e-3 * np.sqrt(w * modulus / (2.0 * np.pi * rho)), dtype=np.float64)


def pressure_viscosity(
    viscosity: ArrayLike, k: ArrayLike = MINERAL_OIL_K, s: ArrayLike = MINERAL_OIL_S
) -> FloatArray:
    """Pressure-viscosity coefficient alpha = k eta^s [mm^2/N] at a dynamic viscosity [mPa s].

    >>> round(float(pressure_viscosity(10)), 6)
    0.014282
    """
    factor = checked("pressure_viscosity_k", k, "mm^2/N")
    exponent = checked("pressure_viscosity_s", s, "", allow_zero=True)
    return np.asarray(factor * checked("viscosity", viscosity, "mPa s") ** exponent, dtype=np.float64)


def film_thickness(
    unit_load: ArrayLike,
    radius: ArrayLike,
    viscosity: ArrayLike,
    entraining_velocity: ArrayLike,
    effective_modulus: ArrayLike,
    *,
    pressure_viscosity_k: ArrayLike = MINERAL_OIL_K,
    pressure_viscosity_s: ArrayLike = MINERAL_OIL_S,
) -> FloatArray:
    """Central film thickness of a line contact [um], H_c = 3.06 G^0.56 U^0.69 W^-0.10, equation (21).

    G = alpha E', U = 1e-6 eta v_e / (2 E' rho), W = w / (E' rho), h_c = H_c rho, with the load per face width
    w [N/mm], the reduced radius rho [mm], the viscosity eta at the inlet [mPa s], the *sum* v_e of both
    rolling velocities [m/s] and E' [N/mm^2]. Smooth surfaces, steady, isothermal. D. Dowson and S. Toyoda, "A
    central film thickness formula for elastohydrodynamic line contacts", Proc. 5th Leeds-Lyon Symposium on
    Tribology, 1978; used in AGMA 925-A03. The film grows beyond bounds as the load vanishes: w = 0 is
    refused.

    >>> modulus = effective_modulus(206e3, 0.3, 206e3, 0.3)
    >>> round(float(film_thickness(100, 8, 10, 10, modulus)), 6)
    0.312115
    """
    w = checked("unit_load", unit_load, "N/mm")
    rho = checked("radius", radius, "mm")
    eta = checked("viscosity", viscosity, "mPa s")
    v_e = checked("entraining_velocity", entraining_velocity, "m/s")
    modulus = checked("effective_modulus", effective_modulus, "N/mm^2")
    material = pressure_viscosity(eta, pressure_viscosity_k, pressure_viscosity_s) * modulus
    speed = 1e-6 * eta * v_e / (2.0 * modulus * rho)
    load = w / (modulus * rho)
    return np.asarray(3.06 * material**0.56 * speed**0.69 * load**-0.10 * rho * 1e3, dtype=np.float64)


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
    h_c = checked("film_thickness", film_thickness, "um", allow_zero=True)
    b_h = checked("half_width", half_width, "mm")
    roughness = checked("composite_roughness", composite_roughness, "um")
    l_x = checked("film_length", film_length, "mm")
    return np.asarray(h_c / roughness * np.sqrt(l_x / (2.0 * b_h)), dtype=np.float64)


def regime(film_parameter: ArrayLike, thresholds: Sequence[float] = DEFAULT_THRESHOLDS) -> NDArray[np.int64]:
    """Lubrication regime by film parameter: 0 boundary, 1 mixed, 2 elastohydrodynamic, 3 full film.

    A film parameter equal to a threshold belongs to the regime above it.

    >>> int(regime(2.0))
    1
    """
    limits = real_array("friction.thresholds", thresholds)
    if limits.shape != (3,) or not (np.diff(limits) > 0).all() or limits[0] <= 0:
        raise refuse(
            "friction.thresholds",
            shown(thresholds),
            "three increasing positive film parameters",
            "Use for example [1, 4, 10].",
        )
    return np.asarray(
        np.digitize(checked("film_parameter", film_parameter, "", allow_zero=True), limits), dtype=np.int64
    )


def composite_roughness(pinion: ArrayLike, gear: ArrayLike) -> FloatArray:
    """R_comp = sqrt(R_p^2 + R_g^2), the roughness of the gap, in the convention and unit of its arguments.

    The surfaces are independent: variances add. Lambda on Ra is 1.25 times Lambda on Rq for Gaussian heights.

    >>> float(composite_roughness(0.3, 0.4))
    0.5
    """
    a = checked("pinion.roughness", pinion, "", allow_zero=True)
    b = checked("gear.roughness", gear, "", allow_zero=True)
    return np.asarray(np.hypot(a, b), dtype=np.float64)


def mean_roughness(pinion: ArrayLike, gear: ArrayLike) -> FloatArray:
    """S = (R_p + R_g)/2, the average roughness that laws II and III take, in the unit of its arguments.

    >>> float(mean_roughness(0.3, 0.4))
    0.35
    """
    a = checked("pinion.roughness", pinion, "", allow_zero=True)
    return np.asarray(0.5 * (a + checked("gear.roughness", gear, "", allow_zero=True)), dtype=np.float64)
