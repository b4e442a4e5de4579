"""Involute and rack-generation formulas of spur gears, on plain numbers (SI, rad)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

FloatArray = NDArray[np.float64]


def involute(angle: float) -> float:
    """Return inv(angle) = tan(angle) - angle [rad]."""
    return math.tan(angle) - angle


def inverse_involute(value: float) -> float:
    """Return the angle [rad] in [0, 1.5] whose involute is ``value`` >= 0."""
    return float(brentq(lambda angle: involute(angle) - value, 0.0, 1.5, xtol=1e-15, rtol=1e-15))


def tooth_half_angle(teeth: int, profile_shift: float, pressure_angle: float, radius_angle: float) -> float:
    """Half the tooth's thickness as an angle at the gear centre, where the profile angle is ``radius_angle``.

    Parameters
    ----------
    teeth, profile_shift : z [-], x [-]
    pressure_angle : of the basic rack [rad]
    radius_angle : profile angle arccos(r_b / r) at the radius in question [rad]
    """
    reference = (0.5 * math.pi + 2.0 * profile_shift * math.tan(pressure_angle)) / teeth
    return reference + involute(pressure_angle) - involute(radius_angle)


def form_length(
    module: float,
    teeth: int,
    pressure_angle: float,
    profile_shift: float,
    dedendum_coefficient: float,
    fillet_radius_coefficient: float,
) -> float:
    """Length along the base tangent at which the involute of a rack-generated flank begins [m].

    The involute is usable for distances from the base circle's tangent point at or beyond this length; the
    form radius is sqrt(r_b^2 + length^2). Where the rack undercuts the flank, it is the crossing of the
    involute and the fillet's trochoid, found numerically.

    Parameters
    ----------
    module : [m]
    teeth : z
    pressure_angle : of the rack [rad]
    profile_shift : x
    dedendum_coefficient, fillet_radius_coefficient : of the rack, over module
    """
    sine, r = math.sin(pressure_angle), 0.5 * module * teeth
    flank_depth = dedendum_coefficient - fillet_radius_coefficient * (1.0 - sine)
    length = r * sine - (flank_depth - profile_shift) * module / sine
    if length >= -1e-4 * module:  # no longer than that: it moves the form radius by 1e-9 modules
        return max(length, 0.0)
    return _undercut_length(
        module, teeth, pressure_angle, profile_shift, dedendum_coefficient, fillet_radius_coefficient
    )


def trochoid(
    roll: FloatArray,
    module: float,
    teeth: int,
    pressure_angle: float,
    profile_shift: float,
    dedendum_coefficient: float,
    fillet_radius_coefficient: float,
) -> tuple[FloatArray, FloatArray]:
    """Fillet cut by the rack's rounded tip: radius [m] and angle from the space's centre line [rad].

    The rack's pitch line rolls on the reference circle. The envelope of the tip circle has its normal through
    the pitch point, so the cut point lies on the line from the pitch point through the tip circle's centre.

    Parameters
    ----------
    roll : (k,) generating roll angles, 0 where the rack tooth is centred in the space [rad]
    module, teeth, pressure_angle, profile_shift, dedendum_coefficient, fillet_radius_coefficient :
        as in ``form_length``
    """
    r = 0.5 * module * teeth
    rho = fillet_radius_coefficient * module
    depth = (dedendum_coefficient - profile_shift) * module - rho
    flat = dedendum_coefficient - fillet_radius_coefficient
    half_width = module * (0.25 * math.pi - flat * math.tan(pressure_angle)) - rho / math.cos(pressure_angle)
    along, down = half_width - r * roll, depth  # tip circle centre as seen from the pitch point
    distance = np.hypot(along, down)
    x = along * (1.0 + rho / distance)
    y = r - down * (1.0 + rho / distance)
    return np.hypot(x, y), np.arctan2(x, y) + roll


def _undercut_length(
    module: float, teeth: int, pressure_angle: float, profile_shift: float, dedendum: float, fillet: float
) -> float:
    """Length at which the fillet's trochoid crosses the involute, where the rack undercuts.

    The trochoid climbs from the root circle (roll angle ``bottom``) to its joint with the rack's straight
    flank, which lies beyond the tangent point here. Where it passes the base circle it is inside the tooth,
    at the joint outside: it crosses the involute once in between.
    """
    r = 0.5 * module * teeth
    r_base = r * math.cos(pressure_angle)
    half_width = 0.25 * math.pi - (dedendum - fillet) * math.tan(pressure_angle)
    bottom = module * (half_width - fillet / math.cos(pressure_angle)) / r
    joint = bottom - module * (dedendum - profile_shift - fillet) / (r * math.tan(pressure_angle))

    def point(roll: float) -> tuple[float, float]:
        radius, angle = trochoid(
            np.array([roll]), module, teeth, pressure_angle, profile_shift, dedendum, fillet
        )
        return float(radius[0]), float(angle[0])

    def depth(roll: float) -> float:
        """Angle by which the trochoid is inside the tooth."""
        radius, angle = point(roll)
        profile = math.acos(min(1.0, r_base / radius))
        half = tooth_half_angle(teeth, profile_shift, pressure_angle, profile)
        return angle - (math.pi / teeth - half)

    base = brentq(lambda roll: point(roll)[0] - r_base, bottom, joint, xtol=1e-15)
    if depth(base) <= 0.0:
        return 0.0
    # By rounding the depth may vanish at a joint that is all but on the base circle; so is the crossing then.
    crossing = joint if depth(joint) >= 0.0 else brentq(depth, base, joint, xtol=1e-15)
    return math.sqrt(max(point(crossing)[0] ** 2 - r_base**2, 0.0))
