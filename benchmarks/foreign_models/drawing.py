"""Numbers that the user copied from the parameter file of a pair, and the line of action of the gears.

Nothing here calls a function of the packages. Involutes, tips and centre distance by ISO 21771.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

MM = 1e-3
UM = 1e-6
GPA = 1e9
RPM = math.pi / 30.0


@dataclass(frozen=True)
class Wheel:
    """Numbers of one gear and of its bearings, SI."""

    teeth: int
    shift: float
    tip_radius: float
    width: float
    bore: float
    density: float
    modulus: float
    poisson: float
    roughness: float
    loa_stiffness: float
    oloa_stiffness: float
    loa_damping: float
    oloa_damping: float
    mass: float | None = None
    inertia: float | None = None


@dataclass(frozen=True)
class Drawing:
    """Numbers of a gear pair and of its operating point, SI."""

    module: float
    pressure_angle: float
    dedendum: float
    centre_distance: float
    pinion: Wheel
    gear: Wheel
    mesh_damping: float
    stiffness: Mapping[str, Any]
    stiffness_factor: float
    friction: Mapping[str, Any]
    viscosity: float
    speed: float
    torque: float
    parameters: Mapping[str, Any]

    @property
    def width(self) -> float:
        """Face width that both gears share [m]."""
        return min(self.pinion.width, self.gear.width)


@dataclass(frozen=True)
class Line:
    """Places on the line of action from the tangent point X on the pinion, base radii, base pitch [m]."""

    base_radius_p: float
    base_radius_g: float
    base_pitch: float
    start: float
    pitch_point: float
    end: float
    length: float

    @property
    def contact_ratio(self) -> float:
        return (self.end - self.start) / self.base_pitch


def involute(angle: float) -> float:
    return math.tan(angle) - angle


def angle_of_involute(value: float) -> float:
    """Solve tan a - a = value by Newton's method."""
    angle = (3.0 * value) ** (1.0 / 3.0)
    for _ in range(30):
        angle -= (involute(angle) - value) / math.tan(angle) ** 2
    return angle


def working_angle(alpha: float, teeth: int, shifts: float) -> float:
    """Operating pressure angle of gears without backlash [rad]; teeth and shifts of both gears in sum."""
    return angle_of_involute(involute(alpha) + 2.0 * shifts * math.tan(alpha) / teeth)


def drawing_of(pair: Mapping[str, Any]) -> Drawing:
    """Copy the numbers of a parameter file; bare numbers in the units of the file."""
    rack = pair["basic_rack"]
    module = rack["module"] * MM
    alpha = math.radians(rack.get("pressure_angle", 20.0))
    addendum = rack.get("addendum_coefficient", 1.0)
    sides = pair["pinion"], pair["gear"]
    teeth = sum(side["teeth"] for side in sides)
    shifts = sum(side.get("profile_shift", 0.0) for side in sides)
    reference = 0.5 * module * teeth
    without_backlash = reference * math.cos(alpha) / math.cos(working_angle(alpha, teeth, shifts))
    distance = pair["centre_distance"] * MM if "centre_distance" in pair else without_backlash
    alteration = distance - reference - module * shifts

    def wheel(name: str) -> Wheel:
        side = pair[name]
        shift = side.get("profile_shift", 0.0)
        km = side["tip_alteration"] * MM if "tip_alteration" in side else alteration
        tip = 0.5 * module * side["teeth"] + module * (addendum + shift) + km
        bearing = pair["bearings"][name]
        return Wheel(
            teeth=side["teeth"],
            shift=shift,
            tip_radius=0.5 * side["tip_diameter"] * MM if "tip_diameter" in side else tip,
            width=side["face_width"] * MM,
            bore=side.get("bore", 0.0) * MM,
            density=side.get("density", 7850.0),
            modulus=side.get("youngs_modulus", 206.0) * GPA,
            poisson=side.get("poisson_ratio", 0.3),
            roughness=side["roughness"] * UM,
            loa_stiffness=bearing["loa_stiffness"],
            oloa_stiffness=bearing["oloa_stiffness"],
            loa_damping=bearing["loa_damping_ratio"],
            oloa_damping=bearing["oloa_damping_ratio"],
            mass=side.get("mass"),
            inertia=side.get("inertia"),
        )

    mesh = pair["mesh"]
    return Drawing(
        module=module,
        pressure_angle=alpha,
        dedendum=rack.get("dedendum_coefficient", 1.25),
        centre_distance=distance,
        pinion=wheel("pinion"),
        gear=wheel("gear"),
        mesh_damping=mesh["damping_ratio"],
        stiffness=mesh["stiffness"],
        stiffness_factor=mesh.get("stiffness_factor", 1.0),
        friction=pair["friction"],
        viscosity=pair["lubricant"].get("viscosity", 10.0) * 1e-3,
        speed=pair["operating"]["pinion_speed"] * RPM,
        torque=pair["operating"]["pinion_torque"],
        parameters=pair,
    )


def line_of_action(drawing: Drawing) -> Line:
    """Tangent points, start, pitch point and end of contact."""
    pinion, gear = drawing.pinion, drawing.gear
    reference_p = 0.5 * drawing.module * pinion.teeth
    reference_g = 0.5 * drawing.module * gear.teeth
    base_p = reference_p * math.cos(drawing.pressure_angle)
    base_g = reference_g * math.cos(drawing.pressure_angle)
    angle = math.acos((base_p + base_g) / drawing.centre_distance)
    length = drawing.centre_distance * math.sin(angle)
    return Line(
        base_radius_p=base_p,
        base_radius_g=base_g,
        base_pitch=math.pi * drawing.module * math.cos(drawing.pressure_angle),
        start=length - math.sqrt(gear.tip_radius**2 - base_g**2),
        pitch_point=base_p * math.tan(angle),
        end=math.sqrt(pinion.tip_radius**2 - base_p**2),
        length=length,
    )
