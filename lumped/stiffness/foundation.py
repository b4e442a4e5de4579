"""Deflection of a tooth by the elasticity of the gear body it stands on (fillet foundation).

P. Sainsot, P. Velex, O. Duverger, Contribution of gear body to tooth deflections: a new bidimensional
analytical formula, J. Mech. Des. 126 (2004) 748-752: an elastic ring, clamped at its bore, with a linear and
a constant stress distribution on the root circle below one tooth, fitted by polynomials. The body carries one
loaded tooth; what the load of a neighbouring tooth adds (structural coupling) is not in the formula.

The formula contains the twist of the whole ring against its clamped bore, a rotation that all pairs share. It
is no part of a tooth: Lame's solution gives it in closed form (``torsional_stiffness``), and it belongs
between the gear and its shaft. What remains of the formula, the local deflection, hardly depends on the bore.
It is taken at one body for every gear, bored or solid (docs/theory/mesh_physics.md, "Gear body").
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from lumped.ranges import ValidityRange
from lumped.typing import FloatArray

#: A to F of X* = A/theta^2 + B h^2 + C h/theta + D/theta + E h + F; rows L*, M*, P*, Q*.
COEFFICIENTS = np.array(
    [
        [-5.574e-5, -1.9986e-3, -2.3015e-4, 4.7702e-3, 0.0271, 6.8045],
        [60.111e-5, 28.100e-3, -83.431e-4, -9.9256e-3, 0.1624, 0.9086],
        [-50.952e-5, 185.50e-3, 0.0538e-4, 53.300e-3, 0.2895, 0.9236],
        [-6.2042e-5, 9.0889e-3, -4.0964e-4, 7.8297e-3, -0.1472, 0.6904],
    ]
)
COEFFICIENTS.setflags(write=False)

_SOURCE = "Sainsot, Velex and Duverger (2004)"
#: Half tooth angle on the root circle: the polynomials were fitted up to 0.12, and plane finite elements of
#: whole gears find them as good up to 0.30, ten teeth (docs/theory/elasticity.md, "The gate").
HALF_ANGLE = ValidityRange(
    "half tooth angle on the root circle", "rad", 0.01, 0.30, f"{_SOURCE}, plane finite elements above 0.12"
)
#: Body ratio at which the local part is taken: the middle of the fit's range 1.4 to 7, where it is flattest.
LOCAL_RATIO = 4.0
#: Thinner rims bend between the teeth: body and support then decide, and no formula here holds.
BODY_RATIO = ValidityRange(
    "root radius over bore radius", "1", 2.0, None, "plane finite elements of the gear body"
)


def coefficients(ratio: ArrayLike, half_angle: ArrayLike) -> FloatArray:
    """L*, M*, P*, Q* of the formula; (4, ...) [-].

    Parameters
    ----------
    ratio : h_f, root over bore radius [-], any shape
    half_angle : theta_f [rad], same shape

    Examples
    --------
    >>> coefficients(4.0, 0.05).round(4).tolist()
    [6.9356, 1.3823, 5.9122, 0.346]
    """
    h, theta = np.asarray(ratio, dtype=float), np.asarray(half_angle, dtype=float)
    terms = np.stack([1.0 / theta**2, h**2, h / theta, 1.0 / theta, h, np.ones_like(h)])
    return np.tensordot(COEFFICIENTS, terms, axes=1)


def torsional_stiffness(root_radius: float, bore_radius: float, modulus: float, poisson: float) -> float:
    """Torsional stiffness of the ring from bore to root circle over face width, 4 pi G/(1/r_i^2 - 1/r_f^2).

    Lame's solution. A solid gear has no bore to turn against: infinite.

    Parameters
    ----------
    root_radius, bore_radius : r_f, r_i >= 0 [m]
    modulus, poisson : E [Pa], nu [-]

    Returns
    -------
    torque per angle and face width [N/rad]

    Examples
    --------
    >>> f"{torsional_stiffness(0.04, 0.01, 206e9, 0.3):.4e}"
    '1.0620e+08'
    """
    if bore_radius == 0.0:
        return math.inf
    shear_modulus = modulus / (2.0 * (1.0 + poisson))
    return 4.0 * math.pi * shear_modulus / (bore_radius**-2 - root_radius**-2)


def published_compliance(
    base_radius: float,
    root_radius: float,
    ratio: float,
    half_angle: float,
    load_angle: FloatArray,
    modulus: float,
) -> FloatArray:
    """Deflection of the tooth by the gear body along the line of action, the published formula.

    Parameters
    ----------
    base_radius, root_radius : [m]
    ratio : h, root over bore radius, 1.4 to 7 [-]
    half_angle : theta_f, half the tooth's angle on the root circle, 0.01 to 0.12 [rad]
    load_angle : angle a between the load and the normal to the tooth's centre line [rad], any shape
    modulus : E [Pa]

    Returns
    -------
    compliance times face width [m^2/N], shape of ``load_angle``:
        cos^2(a)/E (L* (u/S)^2 + M* u/S + P* (1 + Q* tan^2(a))), where u is the distance from the root circle
        to the load's line on the centre line, r_b/cos(a) - r_f, and S = 2 r_f theta_f
    """
    lever = (base_radius / np.cos(load_angle) - root_radius) / (2.0 * root_radius * half_angle)
    l_, m_, p_, q_ = coefficients(ratio, half_angle)
    shape = l_ * lever**2 + m_ * lever + p_ * (1.0 + q_ * np.tan(load_angle) ** 2)
    return np.asarray(np.cos(load_angle) ** 2 / modulus * shape, dtype=np.float64)


def foundation_compliance(
    base_radius: float,
    root_radius: float,
    half_angle: float,
    load_angle: FloatArray,
    modulus: float,
    poisson: float,
) -> FloatArray:
    """Deflection of the tooth by the gear body without the body's twist: the local part of the formula.

    Parameters
    ----------
    base_radius, root_radius, half_angle, load_angle, modulus : as in ``published_compliance``
    poisson : nu [-]

    Returns
    -------
    compliance times face width [m^2/N], shape of ``load_angle``
    """
    whole = published_compliance(base_radius, root_radius, LOCAL_RATIO, half_angle, load_angle, modulus)
    twist = torsional_stiffness(root_radius, root_radius / LOCAL_RATIO, modulus, poisson)
    return whole - base_radius**2 / twist
