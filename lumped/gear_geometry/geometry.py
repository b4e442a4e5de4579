"""Geometry of a spur gear pair from plain numbers: circles, line of action, contact ratio; what can mesh.

Sources: ISO 21771 for the circles, the operating pressure angle, the contact ratio and the backlash; the
points A to D of the line of action as in docs/theory/equations.md, "Frame"; interference, undercut and
pointed teeth are elementary.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

from lumped.errors import FieldProblem, refuse
from lumped.gear_geometry.profile_shift import distance_without_backlash, operating_pressure_angle
from lumped.gear_geometry.tooth_profile import ToothProfile, tooth_half_angle


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

    Whether they can mesh is for ``existence_problems``; only what has no geometry is refused
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
    teeth, module, alpha = pinion.teeth + gear.teeth, pinion.module, pinion.pressure_angle
    if distance is None:
        distance = distance_without_backlash(teeth, module, alpha, pinion.profile_shift + gear.profile_shift)
    return distance, operating_pressure_angle(teeth, module, alpha, distance)


#: Teeth of rounded published data may overlap by this much of a module before the pair is refused.
_WEDGE_TOLERANCE = 1e-4
_THROUGH_TANGENT_POINT = (
    "The tip would pass the mate's tangent point (involute interference): lower it, or raise the mate's "
    "profile_shift."
)
_CUT_AWAY = (
    "The rack has cut the involute away there (undercut or fillet): raise the profile shift, "
    "lower the mate's tip diameter or take more teeth."
)
_POINTED = "The tooth is pointed below its tip circle: lower the tip diameter or the profile shift."
_WEDGE = "The teeth would wedge: raise the centre distance or mesh.backlash, or lower the profile shifts."


def existence_problems(pinion: Wheel, gear: Wheel, g: Geometry, backlash: float) -> list[FieldProblem]:
    """Return the reasons why a pair cannot exist, each with the field of the schema to change.

    ``backlash`` is how much the teeth are thinner than the rack leaves them [m].
    """
    problems = list(_of_the_pair(g))
    # Distance from the tangent point on the own base circle to the last and to the first contact.
    last, first = g.L_XD, g.L_XA
    for name, wheel, tip, start in (
        ("gear", gear, g.L_XY - first, g.L_XY - last),
        ("pinion", pinion, last, first),
    ):
        problems += _of_one_gear(name, wheel, tip, start, g)
    play = theoretical_backlash(pinion, gear, g.operating_pressure_angle) + backlash
    if play < -_WEDGE_TOLERANCE * pinion.tooth.module:
        value = f"{g.centre_distance * 1e3:.6g} mm (backlash {play * 1e3:.4f} mm)"
        problems.append(FieldProblem("centre_distance", value, "normal backlash >= 0", _WEDGE))
    return problems


def _of_the_pair(g: Geometry) -> Iterator[FieldProblem]:
    if not math.isfinite(g.mesh_period):
        yield FieldProblem(
            "operating.pinion_speed",
            f"{g.omega_pinion:g} rad/s",
            "a mesh period in seconds that is a number",
            "Raise the speed.",
        )
    if not 1.0 <= g.contact_ratio <= 3.0:
        yield FieldProblem(
            "contact_ratio",
            f"{g.contact_ratio:.4f}",
            "1 to 3",
            "Change the tip diameters, centre distance, tooth numbers or pressure angle.",
        )


def _of_one_gear(name: str, wheel: Wheel, tip: float, start: float, g: Geometry) -> Iterator[FieldProblem]:
    """Problems of one gear whose flank is in contact from `start` to `tip` beyond its tangent point [m]."""
    tooth, base = wheel.tooth, wheel.tooth.base_radius
    diameter = 2e3 * wheel.tip_radius
    mate_root = g.root_radius_gear if name == "pinion" else g.root_radius_pinion
    own_root = g.root_radius_pinion if name == "pinion" else g.root_radius_gear

    def tip_problem(allowed: str, action: str) -> FieldProblem:
        return FieldProblem(f"{name}.tip_diameter", f"{diameter:.4f} mm", allowed, action)

    if tip > g.L_XY:
        yield tip_problem(f"<= {2e3 * math.hypot(base, g.L_XY):.4f} mm", _THROUGH_TANGENT_POINT)
    form = tooth.form_length
    if 0.0 <= start < form - 1e-9 * tooth.module:
        contact = (
            f"{tooth.profile_shift:g} with contact down to diameter {2e3 * math.hypot(base, start):.4f} mm"
        )
        allowed = f"contact above the form circle, diameter {2e3 * math.hypot(base, form):.4f} mm"
        yield FieldProblem(f"{name}.profile_shift", contact, allowed, _CUT_AWAY)
    if g.centre_distance - wheel.tip_radius - mate_root < 0.0:
        action = "The tip would hit the mate's root: lower it or raise the centre distance."
        yield tip_problem(f"<= {2e3 * (g.centre_distance - mate_root):.4f} mm", action)
    profile = math.acos(min(1.0, base / wheel.tip_radius))
    if tooth_half_angle(tooth.teeth, tooth.profile_shift, tooth.pressure_angle, profile) <= 0.0:
        yield tip_problem("tip thickness > 0", _POINTED)
    if wheel.bore >= 2.0 * own_root:
        yield FieldProblem(f"{name}.bore", f"{wheel.bore * 1e3:g} mm", "< root diameter", "Lower the bore.")
