"""Geometry of a spur gear pair: circles, line of action, contact ratio; and whether the pair can exist.

Sources: ISO 21771 for the circles, the operating pressure angle, the contact ratio and the backlash; the
points A to D of the line of action as in docs/theory/equations.md, "Frame".
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from lumped.errors import FieldProblem, ParameterError
from lumped.gear_geometry.involute import RackTooth, inverse_involute, involute, tooth_half_angle

if TYPE_CHECKING:
    from lumped.schema.pair import Gear, GearPair

#: Teeth of rounded published data may overlap by this much of a module before the pair is refused.
_WEDGE_TOLERANCE = 1e-4


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


def geometry(pair: GearPair) -> Geometry:
    """Return the geometry of a gear pair.

    Parameters
    ----------
    pair : a validated gear pair

    Raises
    ------
    ParameterError : the gears cannot mesh; never for a pair that was validated
    """
    try:
        result, problems = _build(pair)
    except (OverflowError, ZeroDivisionError):
        text = "module, tip diameters and centre_distance so far apart that their squares are no numbers"
        problem = FieldProblem("basic_rack.module", text, "lengths of one gear pair", "Check their units.")
        raise ParameterError([problem], pair.name) from None
    if problems:
        raise ParameterError(problems, pair.name)
    return result


def _tip_radius(gear: Gear, pair: GearPair) -> float:
    rack = pair.basic_rack
    if gear.tip_diameter is not None:
        return 0.5 * gear.tip_diameter
    default = rack.module * (rack.addendum_coefficient + gear.profile_shift)
    return 0.5 * rack.module * gear.teeth + (default if gear.addendum is None else gear.addendum)


def _build(pair: GearPair) -> tuple[Geometry, list[FieldProblem]]:
    rack, pinion, gear = pair.basic_rack, pair.pinion, pair.gear
    alpha, m = rack.pressure_angle, rack.module
    r_p, r_g = 0.5 * m * pinion.teeth, 0.5 * m * gear.teeth
    r_bp, r_bg = r_p * math.cos(alpha), r_g * math.cos(alpha)
    centre, alpha_w = _centre_distance(pair)
    r_ap, r_ag = _tip_radius(pinion, pair), _tip_radius(gear, pair)
    for name, tip, base in (("pinion", r_ap, r_bp), ("gear", r_ag, r_bg)):
        if tip <= base:
            raise _refused(
                pair, f"{name}.tip_diameter", 2 * tip, f"> {2e3 * base:.4f} mm", "Raise the tip diameter."
            )
    base_pitch = math.pi * m * math.cos(alpha)
    l_xy = centre * math.sin(alpha_w)
    l_xa = l_xy - math.sqrt(r_ag**2 - r_bg**2)
    l_xd = math.sqrt(r_ap**2 - r_bp**2)
    r_wp, r_wg = r_bp / math.cos(alpha_w), r_bg / math.cos(alpha_w)
    half = [tooth_half_angle(g.teeth, g.profile_shift, alpha, alpha_w) for g in (pinion, gear)]
    pitch = 2.0 * math.pi * r_wp / pinion.teeth
    theoretical = (pitch - 2.0 * (r_wp * half[0] + r_wg * half[1])) * math.cos(alpha_w)
    forms = [
        RackTooth(
            g.teeth, m, alpha, g.profile_shift, rack.dedendum_coefficient, rack.fillet_radius_coefficient
        ).form_length
        for g in (pinion, gear)
    ]
    omega_p = pair.operating.pinion_speed
    result = Geometry(
        base_pitch=base_pitch,
        contact_ratio=(l_xd - l_xa) / base_pitch,
        base_radius_pinion=r_bp,
        base_radius_gear=r_bg,
        reference_radius_pinion=r_p,
        reference_radius_gear=r_g,
        operating_radius_pinion=r_wp,
        operating_radius_gear=r_wg,
        tip_radius_pinion=r_ap,
        tip_radius_gear=r_ag,
        root_radius_pinion=r_p - m * (rack.dedendum_coefficient - pinion.profile_shift),
        root_radius_gear=r_g - m * (rack.dedendum_coefficient - gear.profile_shift),
        form_radius_pinion=math.hypot(r_bp, forms[0]),
        form_radius_gear=math.hypot(r_bg, forms[1]),
        centre_distance=centre,
        operating_pressure_angle=alpha_w,
        normal_backlash=max(theoretical + pair.mesh.backlash, 0.0),
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
    return result, _problems(pair, result, forms, theoretical)


def _centre_distance(pair: GearPair) -> tuple[float, float]:
    """Centre distance [m] and operating pressure angle [rad]."""
    rack, teeth = pair.basic_rack, pair.pinion.teeth + pair.gear.teeth
    alpha = rack.pressure_angle
    base = 0.5 * rack.module * teeth * math.cos(alpha)
    if pair.centre_distance is None:
        shift = pair.pinion.profile_shift + pair.gear.profile_shift
        value = involute(alpha) + 2.0 * shift / teeth * math.tan(alpha)
        if value < 0.0:
            raise ParameterError(
                [
                    FieldProblem(
                        "pinion.profile_shift",
                        f"sum {shift:g}",
                        f"sum > {-0.5 * teeth * involute(alpha) / math.tan(alpha):.4g}",
                        "Raise the profile shifts or give centre_distance.",
                    )
                ]
            )
        alpha_w = inverse_involute(value)
        return base / math.cos(alpha_w), alpha_w
    if pair.centre_distance <= base:
        raise _refused(
            pair,
            "centre_distance",
            pair.centre_distance,
            f"> {base * 1e3:.4f} mm, the sum of the base radii",
            "Raise the centre distance.",
        )
    return pair.centre_distance, math.acos(base / pair.centre_distance)


def _refused(pair: GearPair, field: str, value: float, allowed: str, action: str) -> ParameterError:
    return ParameterError([FieldProblem(field, f"{value * 1e3:.6g} mm", allowed, action)], pair.name)


def _problems(pair: GearPair, g: Geometry, forms: list[float], theoretical: float) -> list[FieldProblem]:
    """Reasons why the pair cannot exist, each with the field to change."""
    problems: list[FieldProblem] = []
    m = pair.basic_rack.module

    def add(field: str, value: str, allowed: str, action: str) -> None:
        problems.append(FieldProblem(field, value, allowed, action))

    if not math.isfinite(g.mesh_period):
        add(
            "operating.pinion_speed",
            f"{g.omega_pinion:g} rad/s",
            "a mesh period in seconds that is a number",
            "Raise the speed.",
        )
    if not 1.0 <= g.contact_ratio <= 3.0:
        add(
            "contact_ratio",
            f"{g.contact_ratio:.4f}",
            "1 to 3",
            "Change the tip diameters, centre distance, tooth numbers or pressure angle.",
        )
    ends = (
        ("gear.tip_diameter", 2 * g.tip_radius_gear, math.hypot(g.base_radius_gear, g.L_XY), g.L_XA),
        (
            "pinion.tip_diameter",
            2 * g.tip_radius_pinion,
            math.hypot(g.base_radius_pinion, g.L_XY),
            g.L_XY - g.L_XD,
        ),
    )
    for field, value, limit, room in ends:
        if room < 0.0:
            add(
                field,
                f"{value * 1e3:.4f} mm",
                f"<= {2e3 * limit:.4f} mm",
                "The tip would pass the mate's tangent point (involute interference): "
                "lower it or shift the profiles.",
            )
    starts = (("pinion", g.L_XA, forms[0]), ("gear", g.L_XY - g.L_XD, forms[1]))
    for (name, start, form), base in zip(starts, (g.base_radius_pinion, g.base_radius_gear), strict=True):
        if 0.0 <= start < form - 1e-9 * m:
            add(
                f"{name}.profile_shift",
                f"{getattr(pair, name).profile_shift:g} with contact down to diameter "
                f"{2e3 * math.hypot(base, start):.4f} mm",
                f"contact above the form circle, diameter {2e3 * math.hypot(base, form):.4f} mm",
                "The rack has cut the involute away there (undercut or fillet): raise the profile shift, "
                "lower the mate's tip diameter or take more teeth.",
            )
    for name, tip, root in (
        ("pinion", g.tip_radius_pinion, g.root_radius_gear),
        ("gear", g.tip_radius_gear, g.root_radius_pinion),
    ):
        this = getattr(pair, name)
        if g.centre_distance - tip - root < 0.0:
            add(
                f"{name}.tip_diameter",
                f"{2e3 * tip:.4f} mm",
                f"<= {2e3 * (g.centre_distance - root):.4f} mm",
                "The tip would hit the mate's root: lower it or raise the centre distance.",
            )
        base = g.base_radius_pinion if name == "pinion" else g.base_radius_gear
        top = tooth_half_angle(
            this.teeth, this.profile_shift, pair.basic_rack.pressure_angle, math.acos(min(1.0, base / tip))
        )
        if top <= 0.0:
            add(
                f"{name}.tip_diameter",
                f"{2e3 * tip:.4f} mm",
                "tip thickness > 0",
                "The tooth is pointed below its tip circle: lower the tip diameter or the profile shift.",
            )
        if this.bore >= 2.0 * (g.root_radius_pinion if name == "pinion" else g.root_radius_gear):
            add(f"{name}.bore", f"{this.bore * 1e3:g} mm", "< root diameter", "Lower the bore.")
    if theoretical + pair.mesh.backlash < -_WEDGE_TOLERANCE * m:
        add(
            "centre_distance",
            f"{g.centre_distance * 1e3:.6g} mm (backlash {(theoretical + pair.mesh.backlash) * 1e3:.4f} mm)",
            "normal backlash >= 0",
            "The teeth would wedge: raise the centre distance or mesh.backlash, or lower the profile shifts.",
        )
    return problems
