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

from lumped.ranges import RangeViolation, ValidityRange, range_violations
from lumped.stiffness.base import MeshingPair
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
    """L*, M*, P*, Q* of the formula at root over bore radius h_f and half angle theta_f [rad]; (4, ...).

    >>> coefficients(4.0, 0.05).round(4).tolist()
    [6.9356, 1.3823, 5.9122, 0.346]
    """
    h = np.asarray(ratio, dtype=float)
    theta = np.asarray(half_angle, dtype=float)
    terms = np.stack([1.0 / theta**2, h**2, h / theta, 1.0 / theta, h, np.ones_like(h)])
    return np.tensordot(COEFFICIENTS, terms, axes=1)


def torsional_stiffness(root_radius: float, bore_radius: float, modulus: float, poisson: float) -> float:
    """Torsional stiffness of the ring from bore to root circle over face width, 4 pi G/(1/r_i^2 - 1/r_f^2).

    Lame's solution, in torque per angle and face width [N/rad]. A solid gear has no bore to turn against:
    infinite.

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
    """Deflection of the tooth by the gear body along the line of action, the published formula [m^2/N].

    cos^2(a)/E (L* (u/S)^2 + M* u/S + P* (1 + Q* tan^2(a))), times face width, where u is the distance from
    the root circle to the load's line on the centre line, r_b/cos(a) - r_f, and S = 2 r_f theta_f. The fit
    holds for ``ratio`` h from 1.4 to 7 and ``half_angle`` theta_f from 0.01 to 0.12 rad; ``load_angle`` a of
    any shape is between the load and the normal to the tooth's centre line.
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
    """Deflection by the gear body without its twist, times face width: the local part [m^2/N]."""
    published = published_compliance(base_radius, root_radius, LOCAL_RATIO, half_angle, load_angle, modulus)
    twist = torsional_stiffness(root_radius, root_radius / LOCAL_RATIO, modulus, poisson)
    return published - base_radius**2 / twist


def body_twist(pair: MeshingPair) -> tuple[float, float]:
    """Torsional stiffness of both gear bodies from root circle to bore [N m/rad]; infinite without a bore.

    The angles of the model are those of the rims. Between rim and shaft acts this spring, in series with the
    shaft: no part of the tooth stiffness, as all pairs share it. Over the square of the base radius it is a
    stiffness along the line of action.
    """
    pinion, gear = (
        wheel.face_width
        * torsional_stiffness(
            wheel.tooth.root_radius, 0.5 * wheel.bore, body.youngs_modulus, body.poisson_ratio
        )
        for wheel, body in zip(pair.wheels, (pair.pinion, pair.gear), strict=True)
    )
    return pinion, gear


def thin_rims(pair: MeshingPair) -> tuple[RangeViolation, ...]:
    """Bored gears whose rim is too thin for the stiffness of a solid body."""
    result: list[RangeViolation] = []
    for name, wheel in zip(("pinion", "gear"), pair.wheels, strict=True):
        if wheel.bore > 0.0:
            ratio = {BODY_RATIO.quantity: wheel.tooth.root_radius / (0.5 * wheel.bore)}
            result += range_violations(f"rim of the {name}", (BODY_RATIO,), ratio)
    return tuple(result)
