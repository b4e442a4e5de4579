"""The involute function and the thickness of an involute tooth (rad)."""

from __future__ import annotations

import math

from scipy.optimize import brentq


def involute(angle: float) -> float:
    """Return inv(angle) = tan(angle) - angle [rad].

    Examples
    --------
    >>> round(involute(math.radians(20.0)), 6)
    0.014904
    """
    return math.tan(angle) - angle


def inverse_involute(value: float) -> float:
    """Return the angle [rad] in [0, 1.5] whose involute is ``value`` >= 0.

    Examples
    --------
    >>> round(math.degrees(inverse_involute(0.014904)), 3)
    20.0
    """
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
