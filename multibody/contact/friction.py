"""The published friction laws, evaluated at the multibody model's own contact.

Written from the printed laws (docs/theory/friction.md), with conversions of its own from SI and without a
line or a table of ``lumped.friction``: a wrong unit or factor on either side shows as a difference. A law
that is not written here has the code ``TABLE``: the contact reads the lumped model's mu(xi).

v_s is the sliding velocity, v_e the sum of the rolling velocities, w the load per face width.
"""

from __future__ import annotations

import math

from lumped.typing import FloatArray
from multibody.contact.kinematics import compiled
from multibody.contact.layout import N_FRICTION

# Places in the vector of friction parameters, all SI.
(
    LAW,  # one of the codes below
    MEAN,  # mu_avg of laws I and IV, or the mean coefficient of ISO/TR 14179-2 [-]
    SHARPNESS,  # Phi of law IV [1/m]
    MAXIMUM,  # upper bound of law II [-]
    BOUNDARY, MIXED,  # film parameters below which law V takes IV, and II [-]
    NOMINAL_LOAD,  # w_n, full static load per face width [N/m]
    FACE_WIDTH,  # [m]
    MODULUS,  # E' [Pa]
    VISCOSITY,  # eta [Pa s]
    PRESSURE_K, PRESSURE_S,  # alpha = k eta^s [mm^2/N], eta in mPa s
    ROUGHNESS,  # S, mean of both Ra [m]
    COMPOSITE_ROUGHNESS,  # R_comp [m]
    FILM_LENGTH,  # L_x [m]
    SLOWEST,  # sliding velocity below which law II is held constant [m/s]
    SLOWEST_ROLLING,  # sum of the rolling velocities below which the laws are held [m/s]
    COLUMNS,  # of the lumped model's table, with the code TABLE
) = range(N_FRICTION)  # fmt: skip

#: Codes of the laws, by their names in parameter files.
LAWS = {
    "none": 0.0,
    "coulomb": 1.0,
    "benedict_kelley": 2.0,
    "xu_kahraman": 3.0,
    "smoothed_coulomb": 4.0,
    "composite": 5.0,
    "iso_14179": 1.0,  # one coefficient over the path, as law I
}
#: Code of every other law.
TABLE = 6.0
_NONE, _I, _II, _III, _IV, _V = range(6)

#: Branches of law II, as ``branch`` tells them beside the codes of the laws: at its two bounds.
AT_MAXIMUM, AT_ZERO = 20, 21


@compiled
def hertz_pressure(f: FloatArray, radius: float, w: float) -> float:
    """Largest pressure of a line contact [Pa], equation (16): sqrt(w E'/(2 pi rho))."""
    return math.sqrt(w * f[MODULUS] / (2.0 * math.pi * radius))


@compiled
def film_parameter(f: FloatArray, rolling: float, radius: float, w: float) -> float:
    """Film parameter Lambda, equation (21): Dowson and Toyoda's central film over the filtered roughness."""
    if w <= 0.0:
        return math.inf
    modulus = f[MODULUS]
    alpha = 1e-6 * f[PRESSURE_K] * (1e3 * f[VISCOSITY]) ** f[PRESSURE_S]  # mm^2/N -> 1/Pa
    material, speed = alpha * modulus, f[VISCOSITY] * rolling / (2.0 * modulus * radius)
    thickness = 3.06 * material**0.56 * speed**0.69 * (w / (modulus * radius)) ** -0.10 * radius
    band = 2.0 * math.sqrt(8.0 * w * radius / (math.pi * modulus))
    return float(thickness / f[COMPOSITE_ROUGHNESS] * math.sqrt(f[FILM_LENGTH] / band))


@compiled
def benedict_kelley(f: FloatArray, sliding: float, rolling: float, w: float) -> float:
    """Law II before its bounds, equation (14); w in N/mm, eta in mPa s, S in um there; v_s >= ``SLOWEST``."""
    if w <= 0.0:
        return 0.0
    slow = max(sliding, f[SLOWEST])
    number = 29700.0 * (1e-3 * w) / (1e3 * f[VISCOSITY] * slow * rolling * rolling)
    return float(0.0127 * 1.13 / (1.13 - 1e6 * f[ROUGHNESS]) * math.log10(number))


@compiled
def xu_kahraman(f: FloatArray, sliding: float, rolling: float, radius: float, w: float) -> float:
    """Law III, equation (18); p_h in GPa, V_e = v_e/2 in m/s, eta in mPa s, R in m, S in um there."""
    if w <= 0.0 or sliding == 0.0:
        return 0.0
    pressure, eta = 1e-9 * hertz_pressure(f, radius, w), 1e3 * f[VISCOSITY]
    slide_to_roll = 2.0 * sliding / rolling
    shear = slide_to_roll * pressure * math.log10(eta)
    exponent = -8.916465 - 0.354068 * shear + 2.812084 * math.exp(-shear)
    exponent += 0.620305 * math.exp(1e6 * f[ROUGHNESS])
    exponent += 1.03303 * math.log(pressure) + 1.036077 * math.log(slide_to_roll)
    exponent += -0.100601 * math.log(0.5 * rolling) + 0.752755 * math.log(eta) - 0.390958 * math.log(radius)
    return math.exp(exponent)


@compiled
def smoothed_coulomb(f: FloatArray, distance: float) -> float:
    """Magnitude of law IV at a distance from the pitch point [m], equation (19)."""
    s = f[SHARPNESS] * abs(distance)
    return float(2.0 * f[MEAN] / math.pi * (math.atan(s) + s / (1.0 + s * s)))


@compiled
def reduced_radius(rho_p: float, rho_g: float) -> float:
    """Reduced radius of curvature [m], equation (15); above 0 also past a base circle, without involute."""
    least = 1e-6 * (rho_p + rho_g)
    return max(rho_p, least) * max(rho_g, least) / (rho_p + rho_g)


@compiled
def branch(f: FloatArray, sliding: float, rolling: float, rho_p: float, rho_g: float, w: float) -> int:
    """Which formula is in force: a number that changes where the coefficient jumps or has a kink."""
    law = int(f[LAW])
    rolling = max(rolling, sliding, f[SLOWEST_ROLLING])
    if law == _V:
        film = film_parameter(f, rolling, reduced_radius(rho_p, rho_g), w)
        law = _IV if film < f[BOUNDARY] else _II if film < f[MIXED] else _III
    if law == _II:
        mu = benedict_kelley(f, sliding, rolling, w)
        return AT_ZERO if mu <= 0.0 else AT_MAXIMUM if mu >= f[MAXIMUM] or sliding < f[SLOWEST] else law
    return law


@compiled
def magnitude(
    f: FloatArray, sliding: float, rolling: float, rho_p: float, rho_g: float, distance: float, w: float
) -> float:
    """Size of the friction coefficient at one contact: v_s >= 0, v_e [m/s], rho_p, rho_g [m], w [N/m].

    ``distance`` is law IV's argument: from the pitch point to where the nominal motion slides as fast [m].
    """
    law = int(f[LAW])
    if law == _NONE:
        return 0.0
    if law == _I:
        return float(f[MEAN])
    if law == _IV:
        return smoothed_coulomb(f, distance)
    # The laws know surfaces that roll, and the same way, so v_e >= v_s; beyond, they are held. Teeth that
    # vibration brings to rest would have any slide-to-roll ratio.
    rolling = max(rolling, sliding, f[SLOWEST_ROLLING])
    radius = reduced_radius(rho_p, rho_g)
    if law == _V:
        film = film_parameter(f, rolling, radius, w)
        law = _IV if film < f[BOUNDARY] else _II if film < f[MIXED] else _III
    if law == _II:
        return float(min(max(benedict_kelley(f, sliding, rolling, w), 0.0), f[MAXIMUM]))
    if law == _III:
        return xu_kahraman(f, sliding, rolling, radius, w)
    return smoothed_coulomb(f, distance)
