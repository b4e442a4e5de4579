"""Geometry of a spur gear pair from plain numbers: circles, line of action, contact ratio.

Sources: ISO 21771 for the circles, the operating pressure angle, the contact ratio and the backlash; the
points A to D of the line of action as in docs/theory/equations.md, "Frame".
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from lumped.errors import refuse
from lumped.gear_geometry.tooth_profile import ToothProfile, inverse_involute, involute, tooth_half_angle


@dataclass(frozen=True)
class Wheel:
    """One gear as it is cut, SI.

    Attributes
    ----------
    tooth : what the rack leaves of the blank
    tip_radius, face_width : [m]
    bore : diameter [m], 0 for a solid gear
    """

    tooth: ToothProfile
    tip_radius: float
    face_width: float
    bore: float


@dataclass(frozen=True)
class Geometry:
    """Lengths and angles of a gear pair, SI.

    X and Y are the tangent points of the line of action on the pinion's and the gear's base circle; A, B, P,
    C, D are start of contact, lowest point of single contact, pitch point, highest point of single contact
    and end of contact. B and C are the pitch-spaced counterparts of D and A also when the contact ratio is 2
    or more.

    Attributes
    ----------
    base_pitch : of both gears, lambda [m]
    contact_ratio : (L_XD - L_XA)/base_pitch [-]
    base_radius_pinion, base_radius_gear : r_bp, r_bg [m]
    reference_radius_pinion, reference_radius_gear : half the module times the number of teeth [m]
    operating_radius_pinion, operating_radius_gear : of the pitch circles at this centre distance [m]
    tip_radius_pinion, tip_radius_gear : [m]
    root_radius_pinion, root_radius_gear : [m]
    form_radius_pinion, form_radius_gear : where the involute starts above the rack's fillet [m]
    centre_distance : [m]
    operating_pressure_angle : [rad]
    normal_backlash : along the line of action [m]
    face_width : common to both gears [m]
    L_XA, L_XB, L_XP, L_XC, L_XD, L_XY : from X along the line of action [m]
    omega_pinion, omega_gear : nominal speeds [rad/s]
    mesh_period : T_m [s]
    """

    base_pitch: float
    contact_ratio: float
    base_radius_pinion: float
    base_radius_gear: float
    reference_radius_pinion: float
    reference_radius_gear: float
    operating_radius_pinion: float
    operating_radius_gear: float
    tip_radius_pinion: float
    tip_radius_gear: float
    root_radius_pinion: float
    root_radius_gear: float
    form_radius_pinion: float
    form_radius_gear: float
    centre_distance: float
    operating_pressure_angle: float
    normal_backlash: float
    face_width: float
    L_XA: float
    L_XB: float
    L_XP: float
    L_XC: float
    L_XD: float
    L_XY: float
    omega_pinion: float
    omega_gear: float
    mesh_period: float

    @property
    def pairs(self) -> int:
        """Largest number of tooth pairs in contact at once, floor(contact ratio) + 1."""
        return math.floor(self.contact_ratio) + 1

    @property
    def mesh_frequency(self) -> float:
        """Mesh cycles per second [Hz]."""
        return 1.0 / self.mesh_period

    @property
    def pitch_line_velocity(self) -> float:
        """Speed of the operating pitch circles [m/s]."""
        return self.omega_pinion * self.operating_radius_pinion


def build_geometry(
    pinion: Wheel, gear: Wheel, centre_distance: float | None, backlash: float, pinion_speed: float
) -> Geometry:
    """Return the geometry of two gears cut by racks of the same module and pressure angle.

    Whether they can mesh is for ``lumped.gear_geometry.existence``; only what has no geometry is refused
    here, under the names of the schema.

    Parameters
    ----------
    centre_distance : [m]; None: that of no backlash for these profile shifts
    backlash : by which the teeth are thinner than the rack leaves them, along the line of action [m]
    pinion_speed : [rad/s]
    """
    try:
        return _build(pinion, gear, centre_distance, backlash, pinion_speed)
    except (OverflowError, ZeroDivisionError):
        text = "module, tip diameters and centre_distance so far apart that their squares are no numbers"
        raise refuse("basic_rack.module", text, "lengths of one gear pair", "Check their units.") from None


def theoretical_backlash(pinion: Wheel, gear: Wheel, pressure_angle: float) -> float:
    """Backlash along the line of action that the rack leaves [m]; negative where the teeth would wedge.

    ``pressure_angle`` is the operating one [rad].
    """
    radii = [wheel.tooth.base_radius / math.cos(pressure_angle) for wheel in (pinion, gear)]
    halves = [
        tooth_half_angle(w.tooth.teeth, w.tooth.profile_shift, w.tooth.pressure_angle, pressure_angle)
        for w in (pinion, gear)
    ]
    pitch = 2.0 * math.pi * radii[0] / pinion.tooth.teeth
    return (pitch - 2.0 * (radii[0] * halves[0] + radii[1] * halves[1])) * math.cos(pressure_angle)


def _build(
    pinion: Wheel, gear: Wheel, centre_distance: float | None, backlash: float, omega_p: float
) -> Geometry:
    rack = pinion.tooth
    alpha, m = rack.pressure_angle, rack.module
    r_bp, r_bg = pinion.tooth.base_radius, gear.tooth.base_radius
    r_ap, r_ag = pinion.tip_radius, gear.tip_radius
    centre, alpha_w = _centre_distance(pinion.tooth, gear.tooth, centre_distance)
    for name, tip, base in (("pinion", r_ap, r_bp), ("gear", r_ag, r_bg)):
        if tip <= base:
            allowed = f"> {2e3 * base:.4f} mm"
            raise refuse(f"{name}.tip_diameter", f"{2e3 * tip:.6g} mm", allowed, "Raise the tip diameter.")
    base_pitch = math.pi * m * math.cos(alpha)
    l_xy = centre * math.sin(alpha_w)
    l_xa = l_xy - math.sqrt(r_ag**2 - r_bg**2)
    l_xd = math.sqrt(r_ap**2 - r_bp**2)
    return Geometry(
        base_pitch=base_pitch,
        contact_ratio=(l_xd - l_xa) / base_pitch,
        base_radius_pinion=r_bp,
        base_radius_gear=r_bg,
        reference_radius_pinion=pinion.tooth.reference_radius,
        reference_radius_gear=gear.tooth.reference_radius,
        operating_radius_pinion=r_bp / math.cos(alpha_w),
        operating_radius_gear=r_bg / math.cos(alpha_w),
        tip_radius_pinion=r_ap,
        tip_radius_gear=r_ag,
        root_radius_pinion=pinion.tooth.root_radius,
        root_radius_gear=gear.tooth.root_radius,
        form_radius_pinion=math.hypot(r_bp, pinion.tooth.form_length),
        form_radius_gear=math.hypot(r_bg, gear.tooth.form_length),
        centre_distance=centre,
        operating_pressure_angle=alpha_w,
        normal_backlash=max(theoretical_backlash(pinion, gear, alpha_w) + backlash, 0.0),
        face_width=min(pinion.face_width, gear.face_width),
        L_XA=l_xa,
        L_XB=l_xd - base_pitch,
        L_XP=r_bp * math.tan(alpha_w),
        L_XC=l_xa + base_pitch,
        L_XD=l_xd,
        L_XY=l_xy,
        omega_pinion=omega_p,
        omega_gear=omega_p * r_bp / r_bg,
        mesh_period=base_pitch / (omega_p * r_bp),
    )


def _centre_distance(pinion: ToothProfile, gear: ToothProfile, distance: float | None) -> tuple[float, float]:
    """Centre distance [m] and operating pressure angle [rad]."""
    teeth, alpha = pinion.teeth + gear.teeth, pinion.pressure_angle
    base = 0.5 * pinion.module * teeth * math.cos(alpha)
    if distance is not None:
        if distance <= base:
            allowed = f"> {base * 1e3:.4f} mm, the sum of the base radii"
            raise refuse("centre_distance", f"{distance * 1e3:.6g} mm", allowed, "Raise the centre distance.")
        return distance, math.acos(base / distance)
    shift = pinion.profile_shift + gear.profile_shift
    value = involute(alpha) + 2.0 * shift / teeth * math.tan(alpha)
    if value < 0.0:
        allowed = f"sum > {-0.5 * teeth * involute(alpha) / math.tan(alpha):.4g}"
        action = "Raise the profile shifts or give centre_distance."
        raise refuse("pinion.profile_shift", f"sum {shift:g}", allowed, action)
    alpha_w = inverse_involute(value)
    return base / math.cos(alpha_w), alpha_w
