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
    if length >= 0.0:
        return length
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
    r_base = 0.5 * module * teeth * math.cos(pressure_angle)

    def gap(roll: FloatArray) -> tuple[FloatArray, FloatArray]:
        # Positive where the trochoid has cut beyond the involute; defined above the base circle only.
        radius, angle = trochoid(roll, module, teeth, pressure_angle, profile_shift, dedendum, fillet)
        ratio = np.minimum(r_base / radius, 1.0)
        profile = np.arccos(ratio)
        reference = (0.5 * math.pi + 2.0 * profile_shift * math.tan(pressure_angle)) / teeth
        half = reference + involute(pressure_angle) - (np.tan(profile) - profile)
        return angle - (math.pi / teeth - half), radius

    roll = np.linspace(-1.5, 1.5, 3001) * max(1.0, 20.0 / teeth)
    excess, radius = gap(roll)
    cut = (excess > 0) & (radius > r_base)
    if not cut.any():
        return 0.0
    highest = int(np.flatnonzero(cut)[np.argmax(radius[cut])])
    for neighbour in (highest - 1, highest + 1):
        if 0 <= neighbour < roll.size and excess[neighbour] <= 0 and radius[neighbour] > radius[highest]:
            root = brentq(lambda s: float(gap(np.array([s]))[0][0]), roll[highest], roll[neighbour])
            end = float(gap(np.array([root]))[1][0])
            return math.sqrt(end**2 - r_base**2)
    return math.sqrt(float(radius[highest]) ** 2 - r_base**2)
