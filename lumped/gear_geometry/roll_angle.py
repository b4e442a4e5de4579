"""Places on an involute: diameter, roll angle and roll length, each from the others in closed form.

The tangent from a point at radius r to the base circle has the length L = sqrt(r^2 - r_b^2), which is the
roll length of a profile chart, and L = r_b phi for the roll angle phi. While the gear turns by d phi, the
point of contact moves by r_b d phi along the line of action, so a difference of roll lengths is a length
along the path of contact.

Sources: ISO 21771 (roll angle and roll length); ISO 1328-1 (the length axis of a profile chart).
"""

from __future__ import annotations

import math


def roll_angle_of(diameter: float, base_radius: float) -> float:
    """Roll angle of the involute's point at a diameter [m], which is at least that of the base circle [rad].

    >>> round(math.degrees(roll_angle_of(2.0, math.cos(math.radians(20.0)))), 3)  # tan(20 deg) in degrees
    20.854
    """
    base = 2.0 * base_radius
    return math.sqrt((diameter - base) * (diameter + base)) / base


def diameter_of(roll_angle: float, base_radius: float) -> float:
    """Diameter of the involute's point at a roll angle [m]."""
    return 2.0 * base_radius * math.hypot(1.0, roll_angle)
