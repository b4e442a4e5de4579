"""Clearance between the tip corner of one gear and the teeth of its mate, as both turn.

Source: docs/theory/mesh_physics.md, "Undercut and interference".
"""

from __future__ import annotations

import math

import numpy as np

from lumped.gear_geometry.tooth_profile import ToothProfile, tooth_half_angle
from lumped.typing import FloatArray

#: Points of fillet and of involute at which the clearance is taken.
_POINTS = 65


def tip_clearance(
    tooth: ToothProfile, tip: float, mate: ToothProfile, mate_tip: float, centre: float
) -> float:
    """Least clearance of the mate's tip corner from fillet and flank while the driving flanks touch [m].

    Centre distance, tip radius of the mate and the distance R of the corner from the gear's centre form a
    triangle. Both gears turn with the ratio of their teeth. At a distance R the corner therefore has one
    angle from the centre line of the tooth. The clearance is the arc between corner and tooth at this
    distance. The clearance is 0 where the corner rolls onto the involute, and negative where the corner would
    cut into the tooth.

    Parameters
    ----------
    tooth, tip : gear whose teeth the corner meets, and tip radius of this gear [m]
    mate, mate_tip : gear with the corner, and tip radius of this gear [m]
    centre : centre distance, above the sum of the base radii [m]
    """
    ratio = mate.teeth / tooth.teeth
    working = math.acos((tooth.base_radius + mate.base_radius) / centre)
    at_tip = math.acos(min(1.0, mate.base_radius / mate_tip))
    half, mate_half, corner_half = (
        tooth_half_angle(one.teeth, one.profile_shift, one.pressure_angle, angle)
        for one, angle in ((tooth, working), (mate, working), (mate, at_tip))
    )
    radius, outline = _outline(tooth, tip)
    reached = radius >= centre - mate_tip
    if not reached.any():
        return math.inf
    radius = radius[reached]
    outline = outline[reached]
    # Angles of the corner from the line of centres, about the mate's centre and about the gear's.
    mate_angle = _angle_between(centre, mate_tip, radius)
    gear_angle = _angle_between(centre, radius, mate_tip)
    # With the flanks touching at the pitch point, the corner is corner_half - mate_half off the line.
    path = half + ratio * (mate_angle + mate_half - corner_half) - gear_angle
    return float((radius * (path - outline)).min())


def _angle_between(one: float, other: FloatArray | float, opposite: FloatArray | float) -> FloatArray:
    """Angle of two sides of a triangle [rad], by ratios: squares of the least lengths are no numbers."""
    cosine = 0.5 * (one / other + other / one - (opposite / one) * (opposite / other))
    return np.asarray(np.arccos(np.clip(cosine, -1.0, 1.0)), dtype=np.float64)


def _outline(tooth: ToothProfile, tip: float) -> tuple[FloatArray, FloatArray]:
    """Radii [m] from root to tip circle, and half the tooth's thickness there as an angle [rad]."""
    bottom, joint = tooth.fillet_range
    # Closer where the fillet leaves the root circle.
    roll = bottom + (joint - bottom) * np.linspace(0.0, 1.0, _POINTS) ** 1.5
    x, y = tooth.trochoid(roll)
    end = math.sqrt(max(tip**2 - tooth.base_radius**2, tooth.form_length**2))
    angle = np.arctan(np.linspace(tooth.form_length, end, _POINTS) / tooth.base_radius)
    flank = tooth.base_half_angle - (np.tan(angle) - angle)
    fillet = math.pi / tooth.teeth - (np.arctan2(x, y) + roll)
    return np.append(np.hypot(x, y), tooth.base_radius / np.cos(angle)), np.append(fillet, flank)
