"""Rows of what cannot exist: limits that follow from several numbers of a pair."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from typing import Any

import numpy as np

from lumped import GearPair
from lumped.faults.crack import root_section
from lumped.lubrication.viscosity import viscosity_index
from multibody.gears.undercut import undercut_edge
from tests.guards.by_hand import ByHand, inv, root_of
from tests.guards.guard import MATE, Changes, Choice, Guard, curve, friction, relief

SMALL = "contact_ratio_1_1_large_shifts"
LONG = "contact_ratio_2_3_on_shafts"
RELIEVED = "heavily_relieved_under_load"
FAST, RACK_25, UNLIKE_TEETH = (
    "larger_gear_drives_contact_lost", "rack_25_degrees_always_pushing", "unlike_teeth_finite_elements",
)  # fmt: skip


def of(value: Callable[[ByHand], float]) -> Callable[[GearPair, str], float]:
    """A limit from the lengths of the gear in question."""
    return lambda pair, gear: value(ByHand(pair, gear))


# ---- gear_geometry: circles and line of action ------------------------------------------------------------


def _centre_of(line: float, base_radii: float) -> float:
    """Centre distance at which the tangent points are so far apart."""
    return math.hypot(line, base_radii)


def _wedged(hand: ByHand) -> float:
    """Involute of the operating pressure angle at which teeth overlap by 1e-4 of a module.

    Backlash along the line of action: p_b - 2 sum(r_b psi_b) + 2 sum(r_b) inv(alpha_w) + thinning.
    """
    thickness = 2.0 * (hand.r_b * hand.psi_b + hand.mate.r_b * hand.mate.psi_b)
    thinned = 1e3 * hand.pair.mesh.backlash
    return (thickness - hand.base_pitch - thinned - 1e-4 * hand.m) / (2.0 * hand.base_radii)


def _wedged_centre(hand: ByHand) -> float:
    involute = _wedged(hand)
    return hand.base_radii / math.cos(root_of(lambda angle: inv(angle) - involute, 0.0, 1.4))


def _wedged_shift(hand: ByHand) -> float:
    """Own shift with that overlap: r_b psi_b grows by x m sin(alpha)."""
    play = 2.0 * hand.base_radii * (inv(hand.operating_angle) - _wedged(hand))
    return hand.x + play / (2.0 * hand.m * math.sin(hand.alpha))


def _least_shift(hand: ByHand) -> float:
    """Own shift with which the operating pressure angle is 0: 2 sum(x) tan(alpha)/sum(z) = -inv(alpha)."""
    return -0.5 * (hand.z + hand.mate.z) * inv(hand.alpha) / math.tan(hand.alpha) - hand.mate.x


def _distance_of(hand: ByHand, shift: float) -> float:
    """Centre distance without backlash of a sum of profile shifts [mm]."""
    involute = inv(hand.alpha) + 2.0 * shift * math.tan(hand.alpha) / (hand.z + hand.mate.z)
    return hand.base_radii / math.cos(root_of(lambda angle: inv(angle) - involute, 0.0, 1.4))


def _alone(pair: GearPair, gear: str, value: float) -> Changes:
    """A centre distance beside the profile shift of the mate alone."""
    return {"centre_distance": value, f"{gear}.profile_shift": None}


def _widest(hand: ByHand) -> float:
    """Centre distance at which the teeth as they are cut have a normal backlash of 0.2 modules [mm]."""
    thickness = 2.0 * (hand.r_b * hand.psi_b + hand.mate.r_b * hand.mate.psi_b)
    involute = (thickness - hand.base_pitch + 0.2 * hand.m) / (2.0 * hand.base_radii)
    return hand.base_radii / math.cos(root_of(lambda angle: inv(angle) - involute, 0.0, 1.4))


def _edge(hand: ByHand) -> float:
    """Length [mm] at which the undercut ends the flank, by the drawing of the multibody model."""
    return 1e3 * undercut_edge(hand.pair.basic_rack, hand.z, hand.x)


def _deepest_tip(hand: ByHand) -> float:
    """Tip radius of the mate with which its corner is 1e-4 modules in the tooth, at some angle [mm].

    The corner's path in axes that turn with the gear, beside the cuts of the rack's tip: a point of the path
    at the radius R is compared with the cut there, both as angles from the middle of the space.
    """
    mate = hand.mate
    r = hand.r
    m = hand.m
    tip_centre_down = m * (hand.dedendum - hand.fillet - hand.x)
    tip_centre_across = m * (0.25 * math.pi - (hand.dedendum - hand.fillet) * math.tan(hand.alpha))
    tip_centre_across -= m * hand.fillet / math.cos(hand.alpha)
    roll = np.linspace(
        tip_centre_across / r, tip_centre_across / r - tip_centre_down / (r * math.tan(hand.alpha)), 4001
    )
    stretch = 1.0 + m * hand.fillet / np.hypot(tip_centre_across - r * roll, tip_centre_down)
    cut = ((tip_centre_across - r * roll) * stretch + 1j * (r - tip_centre_down * stretch)) * np.exp(
        -1j * roll
    )
    radii = np.abs(cut)
    cut_at = np.arctan2(cut.real, cut.imag)
    centre = hand.base_radii / math.cos(hand.operating_angle)
    play = math.pi / hand.z - (hand.psi_b - inv(hand.operating_angle))
    play -= (mate.psi_b - inv(hand.operating_angle)) * mate.z / hand.z  # to the driving flank from the middle

    def depth(tip: float) -> float:
        half = mate.psi_b - inv(math.acos(mate.r_b / tip))
        turn = np.linspace(-0.2, 0.6, 40001)
        corner = centre - tip * np.exp(1j * (turn + half))
        angles = np.abs(np.angle(corner) + turn * mate.z / hand.z) + play
        in_space = (np.abs(corner) > radii[0]) & (np.abs(corner) < math.hypot(hand.r_b, _edge(hand)))
        clearances = np.interp(np.abs(corner[in_space]), radii, cut_at) - angles[in_space]
        return float(-(np.abs(corner[in_space]) * clearances).min()) - 1e-4 * m

    return root_of(depth, mate.r_a, mate.r_a + 0.5 * m)


_GEOMETRY = "lumped/gear_geometry/geometry.py"
_SHIFT = "lumped/gear_geometry/profile_shift.py"
_FEW = {
    "pinion.teeth": 11, "gear.teeth": 61, "pinion.profile_shift": 0.0, "gear.profile_shift": 0.0,
    "centre_distance": None, "pinion.addendum": None, "gear.addendum": None, "pinion.tip_diameter": None,
    "gear.tip_diameter": None, "basic_rack.dedendum_coefficient": 1.4,
    "basic_rack.fillet_radius_coefficient": 0.25, "basic_rack.addendum_coefficient": 1.0,
}  # fmt: skip
_MANY = {
    "pinion.teeth": 150, "gear.teeth": 161, "shafts": None, "basic_rack.pressure_angle": 14.5,
    "basic_rack.addendum_coefficient": 1.2, "basic_rack.dedendum_coefficient": 2.0,
    "basic_rack.fillet_radius_coefficient": 0.1,
}  # fmt: skip
GEOMETRY = (
    Guard(_SHIFT, "centre_distance", RACK_25, "cos(alpha_w) = sum of base radii over centre distance < 1",
          least=of(lambda h: h.base_radii), says="the sum of the base radii", beside=True),
    Guard(_GEOMETRY, "{gear}.tip_diameter", RACK_25, "an involute begins at the base circle",
          least=of(lambda h: 2.0 * h.r_b), says="Raise the tip diameter", beside=True),
    Guard(_SHIFT, "centre_distance", FAST, "a shift that follows from the centre distance is one of a gear",
          most=of(lambda h: _distance_of(h, 2.0 + h.mate.x)), sets=_alone, beside=True,
          says="-1.5 to 2 for each"),
    Guard(_SHIFT, "pinion.profile_shift", RACK_25, "inv(alpha_w) >= 0 (ISO 21771)",
          least=of(_least_shift), sets="{gear}.profile_shift", says="sum >", beside=True,
          after={"pinion.teeth": 14, "gear.teeth": 19}),
    Guard(_GEOMETRY, "basic_rack.module", FAST, "the square of a length is a float",
          most=lambda pair, gear: 2e3 * math.sqrt(sys.float_info.max), sets="{gear}.tip_diameter",
          says="squares are no numbers", beside=True),
    Guard(_GEOMETRY, "operating.pinion_speed", FAST, "the mesh period 2 pi/(z omega) is a float",
          # So small a speed has few digits.
          least=lambda pair, gear: 2.0 * math.pi / pair.pinion.teeth / sys.float_info.max, near=1e-6,
          sets=lambda pair, gear, value: {"operating.pinion_speed": f"{value!r} rad/s"}),
    Guard(_GEOMETRY, "contact_ratio", SMALL, "one pair of teeth touches at any time: epsilon >= 1",
          least=of(lambda h: h.tip_diameter(h.base_pitch + h.line - h.mate.tip_length)),
          sets="{gear}.tip_diameter", says="1 to 3"),
    Guard(_GEOMETRY, "contact_ratio", LONG, "up to three pairs of teeth are in the model: epsilon <= 3",
          most=of(lambda h: h.tip_diameter(3.0 * h.base_pitch + h.line - h.mate.tip_length)),
          sets="{gear}.tip_diameter", after=_MANY, says="1 to 3"),
    *(Guard(_GEOMETRY, "{gear}.tip_diameter", base,
            "no contact beyond the mate's tangent point: interference",
            most=of(lambda h: h.tip_diameter(h.line)), says="involute interference", beside=True)
      for base in (SMALL, FAST)),
    Guard(_GEOMETRY, "{gear}.profile_shift", RACK_25,
          "contact ends above the rack's fillet; 1e-9 of a module is rounding",
          most=of(lambda h: h.mate.tip_diameter(h.line - h.form_length)), near=1e-8,
          sets="{mate}.tip_diameter", says="contact above the form circle", beside=True),
    Guard(_GEOMETRY, "contact_ratio", SMALL, "undercut ends the flank before the tip does: epsilon >= 1",
          least=of(lambda h: h.tip_diameter(h.base_pitch + _edge(h))), sets="pinion.tip_diameter",
          says="Undercut shortens", after=_FEW),
    Guard(_GEOMETRY, "pinion.profile_shift", SMALL,
          "the mate's tip corner may overlap the undercut tooth by 1e-4 of a module as both turn",
          most=of(lambda h: 2.0 * _deepest_tip(h)), sets="gear.tip_diameter", near=1e-4,
          says="although the rack undercuts", after=_FEW),
    Guard(_GEOMETRY, "{gear}.tip_diameter", RELIEVED, "clearance to the mate's root, a - r_a - r_f >= 0",
          most=of(lambda h: 2.0 * (_centre_of(h.line, h.base_radii) - h.mate.r_f)),
          says="hit the mate's root", beside=True),
    Guard(_GEOMETRY, "{gear}.tip_diameter", SMALL, "the flanks of a tooth meet where inv(alpha_a) = psi_b",
          most=of(lambda h: 2.0 * h.pointed_radius), says="pointed", beside=True,
          after={"basic_rack.dedendum_coefficient": 1.9, "basic_rack.fillet_radius_coefficient": 0.1}),
    Guard(_GEOMETRY, "{gear}.bore", UNLIKE_TEETH, "a gear has a rim: d_f = m (z - 2 h_f + 2 x) (ISO 21771)",
          most=of(lambda h: 2.0 * h.r_f), says="< root diameter"),
    Guard(_GEOMETRY, "centre_distance", RACK_25,
          "teeth overlap by 1e-4 of a module at most: drawings are rounded",
          least=of(_wedged_centre), says="normal backlash >= 0"),
    Guard(_GEOMETRY, "centre_distance", FAST, "the same, by the shift of one gear",
          most=of(_wedged_shift), sets="{gear}.profile_shift", says="normal backlash >= 0",
          after={"centre_distance": 64.6, "pinion.addendum": 1.6, "gear.addendum": 1.7}),
)  # fmt: skip


# ---- schema -----------------------------------------------------------------------------------------------


def _disc(pair: GearPair, gear: str) -> float:
    """Mass of the solid disc of the reference diameter [kg]."""
    own = getattr(pair, gear)
    radius = 0.5e-3 * ByHand(pair, gear).m * getattr(pair, gear).teeth
    return float(own.density * math.pi * radius**2 * own.face_width)


def _disc_inertia(pair: GearPair, gear: str) -> float:
    return 0.5 * _disc(pair, gear) * (1e-3 * ByHand(pair, gear).r) ** 2


def _length(pair: GearPair, gear: str) -> float:
    """Length of the shaft of a gear [mm]."""
    assert pair.shafts is not None
    return sum(1e3 * one.length for one in getattr(pair.shafts, gear).segments)


def _values(field: str) -> Callable[[GearPair, str, int], Changes]:
    return lambda pair, gear, count: {f"{gear}.deviations": {field: [0.5] * count}}


def _teeth(pair: GearPair, gear: str) -> int:
    return int(getattr(pair, gear).teeth)


def _room(pair: GearPair) -> float:
    """Of the rack's tooth at its tip, half width over module: pi/4 - h_f tan(alpha)."""
    rack = pair.basic_rack
    return 0.25 * math.pi - rack.dedendum_coefficient * math.tan(rack.pressure_angle)


def _full_radius(pair: GearPair, gear: str) -> float:
    return _room(pair) / math.tan(0.25 * math.pi - 0.5 * pair.basic_rack.pressure_angle)


def _bearing(position: float, **more: float) -> dict[str, float]:
    return {"position": position, "loa_stiffness": 2e8, "oloa_stiffness": 3e8} | more


def _two_bearings(pair: GearPair, gear: str, apart: float) -> Changes:
    return {f"shafts.{gear}.bearings": [_bearing(20.0), _bearing(20.0 + apart)]}


def _one_segment(long: bool) -> Callable[[GearPair, str, float], Changes]:
    """Shaft with gear and bearings. The shaft has one segment; the value is length over diameter."""

    def sets(pair: GearPair, gear: str, ratio: float) -> Changes:
        diameter = 2.0 if long else 300.0
        length = ratio * diameter
        on_it = {"gear_position": 0.5 * length, "bearings": [_bearing(0.0), _bearing(length)]}
        shaft = on_it | {"segments": [{"length": length, "diameter": diameter}]}
        return {
            "shafts.motor": None,
            "shafts.load": None,
            **{f"shafts.{gear}.{k}": v for k, v in shaft.items()},
        }

    return sets


_PAIR = "lumped/schema/pair.py"
_GEAR = "lumped/schema/gear.py"
_CONTACT = "lumped/schema/contact.py"
_FRICTION = "lumped/schema/friction.py"
_SHAFTS = "lumped/schema/shafts.py"
_TEETH = "lumped/schema/teeth.py"
_BEARINGS = "lumped/schema/bearings.py"
_BALLS = {"type": "ball", "number": 8, "size": 6.0}
_BLANK = {"teeth": 33, "face_width": 15, "roughness": 0.4}
SCHEMA = (
    Guard(_PAIR, "{gear}.mass", RACK_25, "1e-4 of the solid disc: less is a unit error",
          least=lambda pair, gear: 1e-4 * _disc(pair, gear)),
    Guard(_PAIR, "{gear}.inertia", RACK_25, "1e-4 of the solid disc: less is a unit error",
          least=lambda pair, gear: 1e-4 * _disc_inertia(pair, gear)),
    Guard(_PAIR, "mesh.first_teeth", SMALL, "teeth are counted from 1 to z", most=_teeth, whole=True,
          sets=lambda pair, gear, tooth: {
              "mesh.first_teeth": [tooth, 1] if gear == "pinion" else [1, tooth]
          }),
    Guard(_GEAR, "basic_rack.dedendum_coefficient", RACK_25,
          "the rack's tooth has a tip: h_f <= pi/4 cot(alpha)",
          most=lambda pair, gear: 0.25 * math.pi / math.tan(pair.basic_rack.pressure_angle),
          sets=lambda pair, gear, value: {"basic_rack.dedendum_coefficient": value, gear + ".bore": 0.0},
          after={"basic_rack.fillet_radius_coefficient": 0.0}, beside=True, says="pointed above their tips"),
    Guard(_GEAR, "basic_rack.fillet_radius_coefficient", RACK_25,
          "full tip radius: rho (1 - sin(alpha))/cos(alpha) fills half the rack's tip",
          most=_full_radius),
    Guard(_GEAR, "{gear}.faults.0.tooth", FAST, "teeth are counted from 1 to z", most=_teeth, whole=True,
          sets=lambda pair, gear, tooth: {
              f"{gear}.faults": [{"kind": "crack", "tooth": tooth, "depth": 0.1}]
          }),
    *(Guard(_TEETH, f"{{gear}}.deviations.{field}", RELIEVED, "one value a tooth", **{end: _teeth},
            whole=True, sets=_values(field))
      for field in ("index", "profile_slope", "tip_relief") for end in ("least", "most")),
    Guard(_SHAFTS, "shafts.{gear}.gear_position", LONG, "on the shaft, up to the rounding of lengths",
          most=lambda pair, gear: _length(pair, gear) * (1.0 + 1e-9), near=1e-10),
    *(Guard(_SHAFTS, f"shafts.{{gear}}.bearings.{number}.position", LONG, "on the shaft",
            most=lambda pair, gear: _length(pair, gear) * (1.0 + 1e-9), near=1e-10) for number in (0, 1)),
    *(Guard(_SHAFTS, f"shafts.{end}.position", LONG, "on the shaft of its own gear",
            most=lambda pair, _, own=own: _length(pair, own) * (1.0 + 1e-9), near=1e-10)
      for end, own in (("motor", "pinion"), ("load", "gear"))),
    Guard(_SHAFTS, "shafts.{gear}.segments.0.bore", LONG,
          "a wall of a hundredth of the diameter keeps its form",
          most=lambda pair, gear: 0.98e3 * getattr(pair.shafts, gear).segments[0].diameter),
    Guard(_SHAFTS, "shafts.{gear}.segments", LONG, "a thousand times as long as thick is a rope",
          most=1000.0, sets=_one_segment(long=True)),
    Guard(_SHAFTS, "shafts.{gear}.segments", LONG, "a thousand times as thick as long is a membrane",
          least=1e-3, sets=_one_segment(long=False)),
    Guard(_SHAFTS, "shafts.{gear}.bearings", LONG, "bearings a thousandth of the shaft apart hold it",
          least=lambda pair, gear: 1e-3 * _length(pair, gear), sets=_two_bearings, says="two bearings"),
    Choice(_SHAFTS, "shafts.{gear}.bearings", LONG, "a shaft in one bearing turns about it",
           {"shafts.{gear}.bearings": [_bearing(50.0)]},
           {"shafts.{gear}.bearings": [_bearing(50.0, tilt_stiffness=1e-3)]}, says="two bearings"),
    Guard(_PAIR, "centre_distance", FAST, "twice the largest allowance of ISO/TR 10064-2: a contradiction",
          most=of(_widest), says="normal backlash >= 0 and <= 0.2 modules"),
    Choice(_BEARINGS, "bearings.{gear}.loa_stiffness", FAST, "springs or rolling bearings: neither",
           {"bearings.{gear}": {"loa_damping_ratio": 0.05, "oloa_damping_ratio": 0.05}},
           {"bearings.{gear}": _BALLS}, says="either loa_stiffness"),
    Choice(_BEARINGS, "bearings.{gear}.oloa_stiffness", FAST, "springs or rolling bearings: both",
           {"bearings.{gear}": _BALLS | {"oloa_stiffness": 1e8}},
           {"bearings.{gear}": _BALLS}, says="either loa_stiffness"),
    Choice(_GEAR, "{gear}.tip_diameter", FAST, "one tip",
           {"{gear}": _BLANK | {"addendum": 2.0, "tip_diameter": 70.0}},
           {"{gear}": _BLANK | {"tip_diameter": 70.0}},
           says="one of addendum, tip_diameter, tip_alteration"),
    Choice(_GEAR, "{gear}.tip_alteration", FAST, "one tip",
           {"{gear}": _BLANK | {"addendum": 2.0, "tip_alteration": -0.1}},
           {"{gear}": _BLANK | {"tip_alteration": -0.1}},
           says="one of addendum, tip_diameter, tip_alteration"),
    Choice(_GEAR, "{gear}.mounting.eccentricity", UNLIKE_TEETH, "the first harmonic of the deviations is one",
           {"{gear}.mounting": {"eccentricity": 1e-6}},
           {"{gear}.mounting": {"eccentricity": 1e-6}, "{gear}.deviations.first_order": "steps"},
           says="one source"),
    Choice(_TEETH, "{gear}.deviations.index", UNLIKE_TEETH, "a class draws the list",
           {"{gear}.deviations": {"tolerance_class": 6, "index": [1.0] * 20}},
           {"{gear}.deviations": {"tolerance_class": 6}}),
    Choice(_TEETH, "{gear}.deviations.seed", UNLIKE_TEETH, "a seed draws within a class",
           {"{gear}.deviations": {"seed": 3}}, {"{gear}.deviations": {"seed": 3, "tolerance_class": 6}}),
    Choice(_TEETH, "{gear}.deviations.tolerance_class", UNLIKE_TEETH, "deviations are drawn or given",
           {"{gear}.deviations": {}}, {"{gear}.deviations": {"tolerance_class": 11}}),
    Choice(_TEETH, "{gear}.deviations.tip_relief", FAST, "more relief needs the shape of one",
           {"{gear}.deviations": {"tip_relief": [0.5] * 22}, "pinion.teeth": 22, "gear.teeth": 22},
           {"{gear}.deviations": {"profile_slope": [0.5] * 22}, "pinion.teeth": 22, "gear.teeth": 22}),
    Choice(_CONTACT, "lubricant.viscosity", RACK_25, "one viscosity",
           {"lubricant": {"viscosity": 9.0, "viscosity_law": {"iso_vg": 100, "temperature": 60.0}}},
           {"lubricant": {"viscosity_law": {"iso_vg": 100, "temperature": 60.0}}}, says="both"),
    Choice(_CONTACT, "lubricant.viscosity", RACK_25, "one viscosity", {"lubricant": {}},
           {"lubricant": {"viscosity": 9.0}}, says="neither"),
    *(Choice(_CONTACT, "lubricant.viscosity_law.iso_vg", RACK_25, "a grade, or two viscosities",
             {"lubricant": {"viscosity_law": law | {"temperature": 60.0}}},
             {"lubricant": {"viscosity_law": {"iso_vg": 100, "temperature": 60.0}}})
      for law in ({}, {"iso_vg": 90}, {"iso_vg": 100, "kinematic_viscosity_40": 100.0},
                  {"kinematic_viscosity_40": 100.0}, {"kinematic_viscosity_100": 10.0})),
    Choice(_FRICTION, "friction.table", RACK_25, "the law 'table' has one", {"friction.law": "table"},
           {"friction.law": "table", "friction.table": {"points": [0, 9, 18, 50],
           "coefficient": [0.05] * 4}}),
    *(Choice(_FRICTION, "friction.thresholds", RELIEVED, "regimes follow each other over the film parameter",
             {"friction.thresholds": wrong}, {"friction.thresholds": right})
      for wrong, right in (([0.0, 4.0, 10.0], [1e-9, 4.0, 10.0]), ([4.0, 4.0, 10.0], [4.0, 4.0 + 1e-9, 10.0]),
                           ([1.0, 10.0, 10.0], [1.0, 10.0, 10.0 + 1e-9]), ([1.0, 4.0], [1.0, 4.0, 10.0]),
                           ([1.0, 4.0, math.inf], [1.0, 4.0, 1e300]), ([True, 4.0, 10.0], [1, 4, 10]))),
    Choice("lumped/fields/units.py", "operating.speed_range", FAST, "from a lower to a higher speed",
           {"operating.speed_range": [2000.0, 2000.0]}, {"operating.speed_range": [2000.0, 2000.000001]}),
)  # fmt: skip


# ---- faults -----------------------------------------------------------------------------------------------


def _fault(**values: Any) -> Callable[[GearPair, str, float], Changes]:
    """A fault of the gear in which one value, None here, is set."""

    def sets(pair: GearPair, gear: str, value: float) -> Changes:
        return {f"{gear}.faults": [{k: value if v is None else v for k, v in values.items()}]}

    return sets


def _root(pair: GearPair, gear: str) -> float:
    """Thickness of the root where the fillet is at 30 degrees [mm], which test_compliance judges."""
    return 2e3 * root_section(pair.wheels[0 if gear == "pinion" else 1].tooth)[1]


def _common_width(pair: GearPair, gear: str) -> float:
    return 1e3 * min(pair.pinion.face_width, pair.gear.face_width)


FAULTS = (
    *(Guard("lumped/faults/crack.py", "{gear}.faults.0.depth", UNLIKE_TEETH,
            "half the root at right angles to it: beyond, no strip is left",
            most=lambda pair, gear, angle=angle: 0.5 * _root(pair, gear) / math.sin(math.radians(angle)),
            sets=_fault(kind="crack", tooth=7, depth=None, angle=angle)) for angle in (90, 50)),
    Guard("lumped/faults/spall.py", "{gear}.faults.0.width", RACK_25, "within the face width common to both",
          most=_common_width,
          sets=_fault(kind="spall", tooth=7, start_roll_angle=18, end_roll_angle=22, width=None)),
    Guard("lumped/faults/spall.py", "{gear}.faults.0.end_roll_angle", RACK_25, "it ends after it starts",
          least=18.0, sets=_fault(kind="spall", tooth=7, start_roll_angle=18, end_roll_angle=None)),
    Guard("lumped/faults/chip.py", "{gear}.faults.0.roll_angle", FAST, "an edge on the flank: below the tip",
          most=of(lambda h: h.roll(h.tip_length)), sets=_fault(kind="chip", tooth=7, roll_angle=None)),
    Guard("lumped/faults/chip.py", "{gear}.faults.0.roll_angle", FAST,
          "an edge on the flank: above its start",
          least=of(lambda h: h.roll(h.start_length)), sets=_fault(kind="chip", tooth=7, roll_angle=None)),
)  # fmt: skip


# ---- quasi_static: relief ---------------------------------------------------------------------------------

RELIEF = tuple(
    Guard("lumped/schema/relief.py", f"{{gear}}.{which}_relief.start_roll_angle", RACK_25,
          "it starts on the flank in contact", judge=relief,
          **{end: of(lambda h, at=at: h.roll(getattr(h, at)))},
          sets=lambda pair, gear, value, which=which: {
              f"{gear}.{which}_relief": {"amount": 9.0, "start_roll_angle": value}
          })
    for which in ("tip", "root") for end, at in (("least", "start_length"), ("most", "tip_length"))
) + tuple(
    Guard("lumped/schema/relief.py", f"{{gear}}.{which}_relief.start_diameter", UNLIKE_TEETH,
          "it starts on the flank in contact; r = sqrt(r_b^2 + L^2)",
          **{end: of(lambda h, at=at: h.tip_diameter(getattr(h, at)))},
          sets=lambda pair, gear, value, which=which: {
              f"{gear}.{which}_relief": {"amount": 7.0, "start_diameter": value}
          })
    for which in ("tip", "root") for end, at in (("least", "start_length"), ("most", "tip_length"))
) + tuple(
    Guard("lumped/schema/relief.py", f"{{gear}}.{which}_relief.length", RELIEVED,
          "it is shorter than the flank in contact",
          most=of(lambda h: h.tip_length - h.start_length),
          sets=lambda pair, gear, value, which=which: {
              f"{gear}.{which}_relief": {"amount": 7.0, "length": value}
          })
    for which in ("tip", "root")
)  # fmt: skip


# ---- stiffness --------------------------------------------------------------------------------------------

_RAMP = "mesh.stiffness.ramp_length"
_TABLE = "lumped/stiffness/table.py"


def _path(hand: ByHand) -> tuple[float, float]:
    """A and D as distances from X [mm]."""
    pinion = hand if hand.gear == "pinion" else hand.mate
    return pinion.start_length, pinion.tip_length


def _half_path(pair: GearPair, gear: str) -> float:
    low, high = _path(ByHand(pair, "pinion"))
    return 0.5 * (high - low)


def _ramp(model: str, **more: Any) -> Callable[[GearPair, str, float], Changes]:
    return lambda pair, gear, value: {"mesh.stiffness": {"model": model, "ramp_length": value, **more}}


_TOTAL = {"kind": "total", "axis": "phase", "points": [0.0, 0.25, 0.5, 0.75, 1.0], "stiffness": [2e8] * 5}


_WHOLE = {"model": "table"} | _TOTAL


def _reaching(first: bool, model: str) -> Callable[[GearPair, str, float], Changes]:
    """A table from A to D [mm] of which one end is elsewhere."""

    def sets(pair: GearPair, gear: str, end: float) -> Changes:
        low, high = _path(ByHand(pair, "pinion"))
        points = np.linspace(*((end, high) if first else (low, end)), 30).tolist()
        if model == "friction":
            return {"friction.law": "table", "friction.table": {"points": points, "coefficient": [0.06] * 30}}
        table = {"model": "table", "axis": "position_mm", "points": points, "stiffness": [3e8] * 30}
        return {"mesh.stiffness": table}

    return sets


def _end(share: float) -> Callable[[GearPair, str], float]:
    def limit(pair: GearPair, gear: str) -> float:
        low, high = _path(ByHand(pair, "pinion"))
        return low + share * (high - low)

    return limit


def _gap(kind: str) -> Callable[[GearPair, str, float], Changes]:
    """A table over phase with one gap of this size between its points."""

    def sets(pair: GearPair, gear: str, gap: float) -> Changes:
        points = [0.0, 0.2, 0.4, 0.4 + gap, *np.arange(0.8, 2.6 if kind == "pair" else 1.0, 0.2)]
        table = {"kind": kind, "axis": "phase", "points": points, "stiffness": [2e8] * len(points)}
        return {"mesh.stiffness": {"model": "table"} | table}

    return sets


def _again(pair: GearPair, gear: str, other: float) -> Changes:
    """A total over one period whose ends differ."""
    values = {"stiffness": [2e8 * (1.0 + other), 2e8, 2e8, 2e8, 2e8]}
    return {"mesh.stiffness": {"model": "table"} | _TOTAL | values}


def _one_value(pair: GearPair, gear: str, value: float) -> Changes:
    return {"mesh.stiffness": {"model": "table"} | _TOTAL | {"stiffness": [2e8, 2e8, value, 2e8, 2e8]}}


def _one_mu(pair: GearPair, gear: str, value: float) -> Changes:
    changes = dict(_reaching(first=True, model="friction")(pair, gear, _path(ByHand(pair, "pinion"))[0]))
    changes["friction.table"] = dict(changes["friction.table"], coefficient=[value] + [0.05] * 29)
    return changes


_TABLES = "lumped/fields/tables.py"
STIFFNESS = (
    *(Guard("lumped/stiffness/base.py", _RAMP, base, "two ramps fit into the path of contact",
            most=_half_path,
            sets=_ramp(model, **more), judge=curve)
      for base, model, more in ((RACK_25, "parabolic", {}), (FAST, "energy", {}), (SMALL, "table", _TOTAL))),
    *(Guard("lumped/stiffness/base.py", _RAMP, base, "positions have digits enough on the ramp",
            least=lambda pair, gear: 2e-4 * _half_path(pair, gear), sets=_ramp(model), judge=curve)
      for base, model in ((RACK_25, "parabolic"), (FAST, "energy"))),
    Guard(_TABLES, "mesh.stiffness.points", RACK_25, "a table begins at A, but for 2 % of the path",
          most=_end(0.02), sets=_reaching(first=True, model="stiffness"), judge=curve, says="A to D"),
    Guard(_TABLES, "mesh.stiffness.points", RACK_25, "a table ends at D, but for 2 % of the path",
          least=_end(0.98), sets=_reaching(first=False, model="stiffness"), judge=curve, says="A to D"),
    Guard(_TABLES, "friction.table.points", FAST, "a table begins at A, but for 2 % of the path",
          most=_end(0.02), sets=_reaching(first=True, model="friction")),
    Guard(_TABLES, "friction.table.points", FAST, "a table ends at D, but for 2 % of the path",
          least=_end(0.98), sets=_reaching(first=False, model="friction")),
    *(Guard(_TABLE, "mesh.stiffness.points", FAST, "a quarter of a mesh cycle between points is sampled",
            most=0.25, sets=_gap(kind), judge=curve, says="mesh cycles between points")
      for kind in ("total", "pair")),
    Guard(_TABLE, "mesh.stiffness.stiffness", FAST, "equal phases have equal values, to a part in a thousand",
          most=1e-3, sets=_again, judge=curve, near=1e-2),
    Choice("lumped/schema/contact.py", "mesh.contact", FAST, "load over transmission error has contact in it",
           {"mesh.stiffness": _WHOLE, "mesh.contact": "loaded"}, {"mesh.stiffness": _WHOLE},
           says="whole mesh"),
    Choice("lumped/schema/pair.py", "mesh.relief", RELIEVED, "load over transmission error has relief in it",
           {"mesh.stiffness": _WHOLE, "mesh.relief": "static"},
           {"mesh.stiffness": _WHOLE, "mesh.relief": "static",
            **{f"{gear}.{end}_relief": None for gear in ("pinion", "gear") for end in ("tip", "root")}},
           says="whole mesh"),
    Guard(_TABLES, "mesh.stiffness.stiffness", FAST, "1000 N/um is no spur gear mesh", most=1e12,
          sets=_one_value),
    Guard(_TABLES, "mesh.stiffness.stiffness", FAST, "teeth resist: above 0", least=0.0, near=1e-300,
          sets=_one_value),
    Guard(_TABLES, "friction.table.coefficient", FAST, "friction never exceeds the normal load", most=1.0,
          sets=_one_mu),
    Guard(_TABLES, "friction.table.coefficient", FAST, "a magnitude: 0 and more", least=0.0, sets=_one_mu),
    *(Choice(_TABLES, f"{section}.{field}", FAST, source, {f"{section}": table | wrong}, {section: table})
      for section, value, table in (
          ("mesh.stiffness", "stiffness", {"model": "table"} | _TOTAL),
          ("friction.table", "coefficient", {"points": [0, 6, 12, 18, 50], "coefficient": [0.05] * 5}))
      for field, source, wrong in (
          (value, "one value a point", {value: [0.05] * 6}),
          (value, "one value a point", {value: [0.05] * 4}),
          ("points", "in order", {"points": [0.0, 6.0, 5.0, 18.0, 50.0]}),
          ("points", "each once", {"points": [0.0, 6.0, 6.0, 18.0, 50.0]}))),
)  # fmt: skip


# ---- lubrication ------------------------------------------------------------------------------------------

_VISCOSITY = "lumped/lubrication/viscosity.py"


def _oil(**values: Any) -> Callable[[GearPair, str, float], Changes]:
    """An oil in which one value, None here, is set."""
    return lambda pair, gear, value: {
        "lubricant": {"viscosity_law": {key: value if one is None else one for key, one in values.items()}}
    }


def _stiff_as_rock(pair: GearPair, gear: str) -> float:
    """Temperature [degC] below which 10^10^(A - B log10 T), through 20000 and 1 mm^2/s, is no float."""
    level = [math.log10(math.log10(nu + 0.7)) for nu in (20000.0, 1.0)]
    slope = (level[0] - level[1]) / math.log10(373.15 / 313.15)
    largest = math.log10(math.log10(sys.float_info.max))
    return float(313.15 * 10.0 ** ((level[0] - largest) / slope) - 273.15)


LUBRICATION = (
    Guard(_CONTACT, "lubricant.viscosity_law.temperature", RACK_25, "a viscosity is a number",
          least=_stiff_as_rock,
          sets=_oil(kinematic_viscosity_40=2e4, kinematic_viscosity_100=1.0, temperature=None)),
    Guard(_VISCOSITY, "lubricant.viscosity_law.kinematic_viscosity", RACK_25, "an oil is thinner at 100 degC",
          most=32.0, sets=_oil(kinematic_viscosity_40=32.0, kinematic_viscosity_100=None, temperature=60.0)),
    Guard(_VISCOSITY, "lubricant.viscosity_law.viscosity_index", RACK_25,
          "ASTM D2270 begins at 2 mm^2/s at 100 degC; test_film judges ``viscosity_index``",
          least=lambda pair, gear: viscosity_index(4.6, 2.0),
          sets=_oil(iso_vg=5, viscosity_index=None, temperature=60.0)),
)  # fmt: skip


# ---- friction ---------------------------------------------------------------------------------------------

FRICTION = (
    Guard("lumped/friction/benedict_kelley.py", "roughness", RACK_25,
          "1.13/(1.13 - S) has a pole; S is the mean of both gears' Ra",
          most=lambda pair, gear: 2.0 * 1.13 - 1e6 * getattr(pair, MATE[gear]).roughness,
          sets="{gear}.roughness", judge=friction, says="mean Ra of both gears"),
)  # fmt: skip

REFUSED = (*GEOMETRY, *SCHEMA, *FAULTS, *RELIEF, *STIFFNESS, *LUBRICATION, *FRICTION)
