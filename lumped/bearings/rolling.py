"""Stiffness of rolling bearings from type, number, size and load of the elements, and bearings for a torque.

The stiffness is the slope dF/d(delta) of the radial load over the displacement, in its direction (along) and
at right angles to it (across). Lengths in m, forces in N.

Sources: E. Kraemer, Dynamics of Rotors and Foundations, 1993; M. I. Friswell, J. E. T. Penny, S. D. Garvey
and A. W. Lees, Dynamics of Rotating Machines, 2010, pages 182 to 185, as in the rotor library ROSS.
Both stiffnesses follow from Palmgren's compliance of one contact and Stribeck's load distribution. The
constants are derived in docs/theory/bearings.md.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

#: Types of rolling bearings.
BALL = "ball"
ROLLER = "roller"
TYPES = (BALL, ROLLER)
#: Number of rolling elements -> stiffness across the load over that along it.
_ACROSS: Mapping[str, Mapping[int, float]] = {
    BALL: {8: 0.46, 12: 0.64, 16: 0.73},
    ROLLER: {8: 0.49, 12: 0.66, 16: 0.74},
}
#: Shear stress of a shaft under its torque [Pa]; size of a rolling element over the diameter of the shaft.
_TORSION = 30e6
_ELEMENT = 0.3
#: Diameter of a shaft from which on it runs in rollers [m].
_ROLLERS_FROM = 0.05
#: Number of rolling elements of a bearing that is assumed.
_NUMBER = {BALL: 8, ROLLER: 12}


def ball_stiffness(number: int, diameter: float, load: float, contact_angle: float = 0.0) -> float:
    """Stiffness of one ball bearing along its radial load [N/m].

    k = 13e6 n^(2/3) d^(1/3) F^(1/3) cos(alpha)^(5/3)

    Parameters
    ----------
    number : of balls
    diameter : of a ball [m]
    load : static radial load of the bearing [N]
    contact_angle : [rad]

    Notes
    -----
    The constant has the unit N^(2/3) m^(-4/3): steel, no clearance, no preload.
    """
    return float(13e6 * number ** (2 / 3) * (diameter * load) ** (1 / 3) * math.cos(contact_angle) ** (5 / 3))


def roller_stiffness(number: int, length: float, load: float, contact_angle: float = 0.0) -> float:
    """Stiffness of one roller bearing along its radial load [N/m].

    k = 1e9 n^0.9 l^0.8 F^0.1 cos(alpha)^1.9, arguments as of ``ball_stiffness`` with the length of a roller.
    The constant has the unit N^0.9 m^(-1.8).
    """
    return float(1e9 * number**0.9 * length**0.8 * load**0.1 * math.cos(contact_angle) ** 1.9)


def stiffness_along(kind: str, number: int, size: float, load: float, contact_angle: float = 0.0) -> float:
    """Stiffness of one bearing of a type along its load [N/m]: ``ball_stiffness`` or ``roller_stiffness``."""
    law = {BALL: ball_stiffness, ROLLER: roller_stiffness}[kind]
    return law(number, size, load, contact_angle)


def across_ratio(kind: str, number: int) -> float:
    """Ratio of the stiffness across the load to the stiffness along the load.

    The ratio is published for 8, 12 and 16 rolling elements. Between these numbers it is interpolated by
    straight lines. Fewer than 8 elements have the ratio of 8, more than 16 the ratio of 16.
    """
    published = _ACROSS[kind]
    return float(np.interp(number, list(published), list(published.values())))


def shaft_diameter(torque: float) -> float:
    """Diameter of a solid shaft that a torque [N m] loads by 30 MPa in torsion [m]: d^3 = 16 T / (pi tau)."""
    return float((16.0 * torque / (math.pi * _TORSION)) ** (1 / 3))


def assumed_bearing(torque: float, kind: str | None = None) -> tuple[str, int, float]:
    """Type, number of rolling elements and their size [m] of a bearing on a shaft of this torque [N m].

    Thin shafts run in ball bearings and thick ones in rollers, where ``kind`` does not say it. An element has
    0.3 of the shaft's diameter, as balls have (6203: 8 of 6.75 mm on 17 mm; 6205: 9 of 7.94 mm on 25 mm).
    """
    diameter = shaft_diameter(torque)
    kind = kind or (ROLLER if diameter >= _ROLLERS_FROM else BALL)
    return kind, _NUMBER[kind], _ELEMENT * diameter
