"""Geometry of a spur gear pair from plain numbers: circles, line of action, contact ratio; what can mesh.

Sources: ISO 21771 for the circles, the operating pressure angle, the contact ratio and the backlash; the
points A to D of the line of action as in docs/theory/equations.md, "Frame"; undercut and interference as in
docs/theory/mesh_physics.md; pointed teeth are elementary.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import ClassVar, Literal

from lumped.display.result import DisplayedResult
from lumped.errors import FieldProblem, refuse
from lumped.gear_geometry.interference import tip_clearance
from lumped.gear_geometry.profile_shift import distance_without_backlash, operating_pressure_angle
from lumped.gear_geometry.tooth_profile import ToothProfile, tooth_half_angle


@dataclass(frozen=True)
class Wheel:
    """One gear as cut, SI.

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


@dataclass(frozen=True, repr=False)
class Geometry(DisplayedResult):
    """Lengths and angles of a gear pair, SI.

    X and Y are the tangent points of the line of action on the pinion's and the gear's base circle; A, B, P,
    C, D are start of contact, lowest point of single contact, pitch point, highest point of single contact
    and end of contact. Contact starts and ends at the mate's tip circle; on an undercut flank contact starts
    or ends at the edge of the undercut. B and C are one pitch from D and A, also at a contact ratio of 2 or
    more.

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
    undercut_pinion, undercut_gear : length on the own base tangent at which an undercut ends the flank in an
        edge [m]; 0 without undercut
    centre_distance : [m]
    operating_pressure_angle : [rad]
    normal_backlash : along the line of action [m]
    face_width : common to both gears [m]
    L_XA, L_XB, L_XP, L_XC, L_XD, L_XY : from X along the line of action [m]
    omega_pinion, omega_gear : nominal speeds [rad/s]
    mesh_period : T_m [s]
    """

    shown: ClassVar = (
        "contact_ratio",
        "base_pitch",
        "centre_distance",
        "operating_pressure_angle",
        "normal_backlash",
        "face_width",
        "base_radius_pinion",
        "base_radius_gear",
        "tip_radius_pinion",
        "tip_radius_gear",
        "L_XA",
        "L_XP",
        "L_XD",
        "L_XY",
        "omega_pinion",
        "omega_gear",
        "mesh_period",
    )

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
    undercut_pinion: float
    undercut_gear: float
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
    def tip_length_pinion(self) -> float:
        """Distance along the line of action from X to the pinion's tip circle [m].

        Where the gear is undercut, contact ends before this circle.
        """
        return math.sqrt(self.tip_radius_pinion**2 - self.base_radius_pinion**2)

    @property
    def tip_length_gear(self) -> float:
        """Distance along the line of action from Y to the gear's tip circle [m].

        Where the pinion is undercut, contact begins after this circle.
        """
        return math.sqrt(self.tip_radius_gear**2 - self.base_radius_gear**2)

    @property
    def tip_contact_ratio(self) -> float:
        """Contact ratio from the tip circles alone: ``contact_ratio`` without undercut [-]."""
        return (self.tip_length_pinion + self.tip_length_gear - self.L_XY) / self.base_pitch

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes for the reader of the drawing: a sentence where undercut shortens the contact."""
        lost = {
            "start": self.L_XA - (self.L_XY - self.tip_length_gear),
            "end": self.tip_length_pinion - self.L_XD,
        }
        parts = [f"{1e3 * length:.3g} mm at its {end}" for end, length in lost.items() if length > 0.0]
        if not parts:
            return ()
        ratios = f"contact ratio {self.contact_ratio:.3f} instead of {self.tip_contact_ratio:.3f}"
        return (f"undercut shortens contact by {' and '.join(parts)}: {ratios}",)

    @property
    def mesh_frequency(self) -> float:
        """Mesh cycles per second [Hz]."""
        return 1.0 / self.mesh_period

    @property
    def pitch_line_velocity(self) -> float:
        """Speed of the operating pitch circles [m/s]."""
        return self.omega_pinion * self.operating_radius_pinion

    def at_speed(self, omega_pinion: float) -> Geometry:
        """The same gears at another speed of the pinion [rad/s]."""
        return replace(
            self,
            omega_pinion=omega_pinion,
            omega_gear=omega_pinion * self.base_radius_pinion / self.base_radius_gear,
            mesh_period=self.base_pitch / (omega_pinion * self.base_radius_pinion),
        )


@lru_cache(maxsize=256)  # samples of uncertain tips have a few tips in common
def build_geometry(
    pinion: Wheel, gear: Wheel, centre_distance: float | None, backlash: float, pinion_speed: float
) -> Geometry:
    """Return the geometry of two gears cut by racks of the same module and pressure angle.

    ``existence_problems`` says whether the gears can mesh. Only gears without a geometry are refused here,
    under the names of the schema.

    Parameters
    ----------
    centre_distance : centre distance [m]; None: the distance without backlash for these profile shifts
    backlash : backlash by thinning of the teeth, along the line of action [m]
    pinion_speed : speed of the pinion [rad/s]
    """
    try:
        return _build(pinion, gear, centre_distance, backlash, pinion_speed)
    except (OverflowError, ZeroDivisionError):
        text = "module, tip diameters and centre_distance so far apart that their squares are no numbers"
        raise refuse("basic_rack.module", text, "lengths of one gear pair", "Check their units.") from None


def theoretical_backlash(pinion: Wheel, gear: Wheel, pressure_angle: float) -> float:
    """Backlash along the line of action of teeth as the rack cuts them [m]; negative: the teeth would wedge.

    ``pressure_angle`` is the operating pressure angle [rad].
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
    alpha = rack.pressure_angle
    m = rack.module
    r_bp = pinion.tooth.base_radius
    r_bg = gear.tooth.base_radius
    r_ap = pinion.tip_radius
    r_ag = gear.tip_radius
    centre, alpha_w = _centre_distance(pinion.tooth, gear.tooth, centre_distance)
    for name, tip, base in (("pinion", r_ap, r_bp), ("gear", r_ag, r_bg)):
        if tip <= base:
            allowed = f"> {2e3 * base:.4f} mm"
            raise refuse(f"{name}.tip_diameter", f"{2e3 * tip:.6g} mm", allowed, "Raise the tip diameter.")
    base_pitch = math.pi * m * math.cos(alpha)
    l_xy = centre * math.sin(alpha_w)
    l_xa = max(l_xy - math.sqrt(r_ag**2 - r_bg**2), pinion.tooth.undercut_length)
    l_xd = min(math.sqrt(r_ap**2 - r_bp**2), l_xy - gear.tooth.undercut_length)
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
        undercut_pinion=pinion.tooth.undercut_length,
        undercut_gear=gear.tooth.undercut_length,
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
    teeth = pinion.teeth + gear.teeth
    module = pinion.module
    alpha = pinion.pressure_angle
    if distance is None:
        distance = distance_without_backlash(teeth, module, alpha, pinion.profile_shift + gear.profile_shift)
    return distance, operating_pressure_angle(teeth, module, alpha, distance)


Name = Literal["pinion", "gear"]
MATE: dict[Name, Name] = {"pinion": "gear", "gear": "pinion"}
#: Teeth of rounded published data may overlap by this much of a module before the pair is refused.
_WEDGE_TOLERANCE = 1e-4
#: Rounding of the length at which the involute begins, in modules.
_FORM_TOLERANCE = 1e-9
_THROUGH_TANGENT_POINT = (
    "The tip would pass the mate's tangent point (involute interference): lower it, or raise the mate's "
    "profile_shift."
)
_ON_THE_FILLET = (
    "The tip of the mate would cut into the fillet that the rack leaves there (interference): raise the "
    "profile shift, lower the mate's tip diameter or take more teeth."
)
_IN_THE_TOOTH = (
    "The tip of the mate would cut into the tooth as both turn (interference), although the rack undercuts "
    "it: raise the profile shift, lower the mate's tip diameter or take more teeth."
)
_POINTED = "The tooth is pointed below its tip circle: lower the tip diameter or the profile shift."
_WEDGE = "The teeth would wedge: raise the centre distance or mesh.backlash, or lower the profile shifts."
_SHORT = "Change the tip diameters, centre distance, tooth numbers or pressure angle."
_SHORT_BY_UNDERCUT = (
    "Undercut shortens the contact; by the tip circles it would be {:.4f}: raise the profile shift or take "
    "more teeth."
)


@dataclass(frozen=True)
class ToothProblem(FieldProblem):
    """A problem that another number of teeth or profile shift of one gear may solve.

    Attributes
    ----------
    gear : "pinion" or "gear"
    sense : direction of the change of the profile shift, 1: larger
    """

    gear: Name = "pinion"
    sense: int = 1


@lru_cache(maxsize=256)
def existence_problems(pinion: Wheel, gear: Wheel, g: Geometry, backlash: float) -> tuple[FieldProblem, ...]:
    """Return the reasons why a pair cannot exist, each with the field of the schema to change.

    ``backlash`` is the backlash by thinning of the teeth [m].
    """
    problems = list(_of_the_pair(g))
    problems += _of_one_gear("gear", gear, pinion, g)
    problems += _interference("gear", gear, pinion, g)
    problems += _of_one_gear("pinion", pinion, gear, g)
    problems += _interference("pinion", pinion, gear, g)
    play = theoretical_backlash(pinion, gear, g.operating_pressure_angle) + backlash
    if play < -_WEDGE_TOLERANCE * pinion.tooth.module:
        value = f"{g.centre_distance * 1e3:.6g} mm (backlash {play * 1e3:.4f} mm)"
        problems.append(FieldProblem("centre_distance", value, "normal backlash >= 0", _WEDGE))
    return tuple(problems)


def _of_the_pair(g: Geometry) -> Iterator[FieldProblem]:
    if not math.isfinite(g.mesh_period):
        yield FieldProblem(
            "operating.pinion_speed",
            f"{g.omega_pinion:g} rad/s",
            "a mesh period in seconds that is a number",
            "Raise the speed.",
        )
    ratio = f"{g.contact_ratio:.4f}"
    if g.contact_ratio < 1.0 <= g.tip_contact_ratio:
        of_pinion = g.undercut_pinion > g.L_XY - g.tip_length_gear
        action = _SHORT_BY_UNDERCUT.format(g.tip_contact_ratio)
        yield ToothProblem("contact_ratio", ratio, "1 to 3", action, "pinion" if of_pinion else "gear")
    elif not 1.0 <= g.contact_ratio <= 3.0:
        yield FieldProblem("contact_ratio", ratio, "1 to 3", _SHORT)


def _tip_length(wheel: Wheel) -> float:
    """From the own tangent point along the line of action to the tip circle [m]."""
    return math.sqrt(wheel.tip_radius**2 - wheel.tooth.base_radius**2)


def _of_one_gear(name: Name, wheel: Wheel, mate: Wheel, g: Geometry) -> Iterator[FieldProblem]:
    """Problems of the tip and the bore of one gear."""
    tooth = wheel.tooth
    base = wheel.tooth.base_radius
    mate_root = mate.tooth.root_radius
    value = f"{2e3 * wheel.tip_radius:.4f} mm"
    if _tip_length(wheel) > g.L_XY and mate.tooth.undercut_length == 0.0:
        allowed = f"<= {2e3 * math.hypot(base, g.L_XY):.4f} mm"
        yield ToothProblem(f"{name}.tip_diameter", value, allowed, _THROUGH_TANGENT_POINT, MATE[name])
    if g.centre_distance - wheel.tip_radius - mate_root < 0.0:
        action = "The tip would hit the mate's root: lower it or raise the centre distance."
        allowed = f"<= {2e3 * (g.centre_distance - mate_root):.4f} mm"
        yield FieldProblem(f"{name}.tip_diameter", value, allowed, action)
    profile = math.acos(min(1.0, base / wheel.tip_radius))
    if tooth_half_angle(tooth.teeth, tooth.profile_shift, tooth.pressure_angle, profile) <= 0.0:
        yield ToothProblem(f"{name}.tip_diameter", value, "tip thickness > 0", _POINTED, name, -1)
    if wheel.bore >= 2.0 * tooth.root_radius:
        yield FieldProblem(f"{name}.bore", f"{wheel.bore * 1e3:g} mm", "< root diameter", "Lower the bore.")


def _interference(name: Name, wheel: Wheel, mate: Wheel, g: Geometry) -> Iterator[FieldProblem]:
    """Where the mate's tip cuts into the teeth of a gear."""
    tooth = wheel.tooth
    base = wheel.tooth.base_radius
    form = wheel.tooth.form_length
    start = g.L_XY - _tip_length(mate)
    if tooth.undercut_length == 0.0 and start < form - _FORM_TOLERANCE * tooth.module:
        if start >= 0.0:  # else the mate's tip has passed the tangent point
            lowest, circle = (f"diameter {2e3 * math.hypot(base, length):.4f} mm" for length in (start, form))
            value = f"{tooth.profile_shift:g} with contact down to {lowest}"
            allowed = f"contact above the form circle, {circle}"
            yield ToothProblem(f"{name}.profile_shift", value, allowed, _ON_THE_FILLET, name)
        return
    if g.centre_distance - mate.tip_radius - tooth.root_radius < 0.0:
        return  # the mate's tip is below the root circle
    clearance = tip_clearance(tooth, wheel.tip_radius, mate.tooth, mate.tip_radius, g.centre_distance)
    if clearance < -_WEDGE_TOLERANCE * tooth.module:
        value = f"{tooth.profile_shift:g} with the mate's tip {-1e3 * clearance:.4f} mm deep in the tooth"
        action = _IN_THE_TOOTH if tooth.undercut_length > 0.0 else _ON_THE_FILLET
        allowed = "clearance of the mate's tip >= 0"
        yield ToothProblem(f"{name}.profile_shift", value, allowed, action, name)
