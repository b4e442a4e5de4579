"""Outline of a tooth as the rack cuts it, drawn by formulas of this package.

The fillet is written over the angle of its normal, after Z. Chen and Y. Shao (Eng. Fail. Anal. 18 (2011)
2149-2164); the involute in polar coordinates, after ISO 21771. Nothing is read from ``lumped.gear_geometry``.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from multibody.gears.cut_teeth import profile_shifts
from multibody.gears.undercut import undercut_edge

#: Points of the sum over the area of a tooth.
_AREA_POINTS = 201


class Outline(NamedTuple):
    """One tooth in its axes: u from the gear's centre along the tooth, h across the tooth.

    Attributes
    ----------
    teeth : number of teeth
    reference_radius, base_radius, root_radius : [m]
    base_half_angle, root_half_angle : half the tooth as an angle at the gear's centre, on the base circle and
        on the root circle [rad]
    rounding : tip radius of the rack [m]
    rounding_centre : distance of the centre of the rounding from the middle of the rack's tooth, along the
        pitch line [m]
    rounding_depth : depth of the centre of the rounding below the pitch line [m]
    fillet_end : angle of the fillet's normal where the involute begins [rad]; pi/2 is on the root circle
    form_length : length on the base tangent where the involute begins [m]
    """

    teeth: int
    reference_radius: float
    base_radius: float
    root_radius: float
    base_half_angle: float
    root_half_angle: float
    rounding: float
    rounding_centre: float
    rounding_depth: float
    fillet_end: float
    form_length: float


class Section(NamedTuple):
    """Points of an outline, each array of one shape [m].

    Attributes
    ----------
    height : u of the points
    half_thickness : h of the points
    rise : rate of u with the parameter of the points
    """

    height: FloatArray
    half_thickness: FloatArray
    rise: FloatArray


def outline(pair: GearPair, number: int) -> Outline:
    """Outline of a tooth of the pinion (0) or the gear (1), without the thinning for backlash."""
    rack = pair.basic_rack
    angle = rack.pressure_angle
    module = rack.module
    gear = (pair.pinion, pair.gear)[number]
    shift = profile_shifts(pair)[number]
    reference = 0.5 * module * gear.teeth
    base = reference * math.cos(angle)
    rounding = rack.fillet_radius_coefficient * module
    depth = (rack.dedendum_coefficient - shift) * module - rounding
    straight = (rack.dedendum_coefficient - rack.fillet_radius_coefficient) * module
    centre = 0.25 * math.pi * module - straight * math.tan(angle) - rounding / math.cos(angle)
    half_pitch_tooth = (0.5 * math.pi + 2.0 * shift * math.tan(angle)) / gear.teeth
    drawn = Outline(
        teeth=gear.teeth,
        reference_radius=reference,
        base_radius=base,
        root_radius=reference - depth - rounding,
        base_half_angle=half_pitch_tooth + math.tan(angle) - angle,
        root_half_angle=math.pi / gear.teeth - centre / reference,
        rounding=rounding,
        rounding_centre=centre,
        rounding_depth=depth,
        fillet_end=angle,
        form_length=0.0,
    )
    edge = undercut_edge(rack, gear.teeth, shift)
    if edge > 0.0:
        return drawn._replace(fillet_end=_normal_at_edge(drawn, math.hypot(base, edge)), form_length=edge)
    joint = fillet(drawn, np.array(angle))
    squared = float(joint.height**2 + joint.half_thickness**2) - base**2
    return drawn._replace(form_length=math.sqrt(max(squared, 0.0)))


def fillet(tooth: Outline, normal: FloatArray) -> Section:
    """Points of the fillet whose normal makes the angles ``normal`` with the rack's pitch line [rad].

    The normal of a cut point passes through the pitch point, so the roll of the gear follows from the angle.
    """
    sine = np.sin(normal)
    cosine = np.cos(normal)
    reach = tooth.rounding_depth / sine + tooth.rounding  # from the pitch point to the cut point
    reach_rate = -tooth.rounding_depth * cosine / sine**2
    across = reach * cosine
    along = tooth.reference_radius - reach * sine
    across_rate = reach_rate * cosine - reach * sine
    along_rate = -reach_rate * sine - reach * cosine
    roll = (tooth.rounding_centre - tooth.rounding_depth * cosine / sine) / tooth.reference_radius
    roll_rate = tooth.rounding_depth / (sine**2 * tooth.reference_radius)
    turn = math.pi / tooth.teeth - roll  # from the pitch point to the middle of the tooth
    height = along * np.cos(turn) + across * np.sin(turn)
    half_thickness = along * np.sin(turn) - across * np.cos(turn)
    rise = along_rate * np.cos(turn) + across_rate * np.sin(turn) + half_thickness * roll_rate
    return Section(height, half_thickness, rise)


def involute(tooth: Outline, length: FloatArray) -> Section:
    """Points of the involute at lengths on the base tangent [m]; the rate is that with the length."""
    roll = length / tooth.base_radius
    radius = np.hypot(tooth.base_radius, length)
    half_angle = tooth.base_half_angle - roll + np.arctan(roll)
    return Section(
        height=radius * np.cos(half_angle),
        half_thickness=radius * np.sin(half_angle),
        rise=roll * np.cos(load_angle(tooth, length)),
    )


def load_angle(tooth: Outline, length: FloatArray) -> FloatArray:
    """Angle between a load on the flank and the normal of the tooth's middle, at lengths on the tangent."""
    return np.asarray(length / tooth.base_radius - tooth.base_half_angle, dtype=np.float64)


class TeethMasses(NamedTuple):
    """Mass and polar inertia of all teeth for an angle of one radian, over density and face width.

    Lengths are over the root radius.
    """

    mass: float
    inertia: float


def teeth_masses(tooth: Outline, reach: float) -> TeethMasses:
    """Mass and inertia of all teeth outside the root circle, from the area of one tooth.

    The flank ends at the length ``reach`` on the base tangent [m].
    """
    normals = np.linspace(0.5 * math.pi, tooth.fillet_end, _AREA_POINTS)
    lengths = np.linspace(tooth.form_length, reach, _AREA_POINTS)
    area = moment = 0.0
    for section, steps in ((fillet(tooth, normals), normals), (involute(tooth, lengths), lengths)):
        strip = 2.0 * section.half_thickness * section.rise
        area += float(np.trapezoid(strip, steps))
        arm = section.height**2 + section.half_thickness**2 / 3.0
        moment += float(np.trapezoid(strip * arm, steps))
    share = tooth.teeth / (2.0 * math.pi)
    return TeethMasses(share * area / tooth.root_radius**2, share * moment / tooth.root_radius**4)


def _normal_at_edge(tooth: Outline, radius: float) -> float:
    """Angle of the fillet's normal at the edge of an undercut, which stands at a radius [m]."""

    def beyond(normal: float) -> float:
        point = fillet(tooth, np.array(normal))
        return float(np.hypot(point.height, point.half_thickness)) - radius

    return float(brentq(beyond, tooth.fillet_end, 0.5 * math.pi, xtol=1e-14))
