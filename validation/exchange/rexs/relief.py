"""Tip and root relief of a REXS stage, as amount at the flank's end and roll angle of the start."""

from __future__ import annotations

import math

from lumped.fields.units import to_file
from lumped.gear_geometry.geometry import Geometry
from validation.exchange.rexs.gears import flanks_of, gear_data_of
from validation.exchange.rexs.model import Component
from validation.exchange.rexs.said import Said
from validation.exchange.rexs.vocabulary import NOT_TAKEN, derived_number

KINDS = ("tip_relief", "root_relief")
_REFERENCE = ("reference", "origin", "referenced")


def read_reliefs(said: Said, stage: Component, gears: dict[str, Component], geometry: Geometry) -> None:
    """Read the reliefs of both gears.

    Parameters
    ----------
    said : collects what is found
    stage : the stage
    gears : "pinion" and "gear" -> component
    geometry : of the pair, whose circles turn diameters into roll angles
    """
    for which, gear in gears.items():
        flank = _working_flank(said, stage, gear)
        if flank is None:
            continue
        for other in said.model.related(flank, *_REFERENCE, *NOT_TAKEN):
            said.note(f"{other.label} of {flank.label} is left out: spurcheck has no such modification")
        for kind in KINDS:
            found = said.model.related(flank, *_REFERENCE, kind)
            if len(found) > 1:
                said.note(f"{flank.label} has {len(found)} components {kind}: all are left out")
            elif found:
                _take(said, which, found[0], geometry)


def end_of_flank(geometry: Geometry, which: str, kind: str) -> float:
    """Roll angle where the amount of a relief holds: of the tip, or of the start of the active flank [rad].

    Parameters
    ----------
    geometry : of the pair
    which : "pinion" or "gear"
    kind : "tip_relief" or "root_relief"
    """
    g = geometry
    if which == "pinion":
        return (g.L_XD if kind == "tip_relief" else g.L_XA) / g.base_radius_pinion
    return (g.L_XY - (g.L_XA if kind == "tip_relief" else g.L_XD)) / g.base_radius_gear


def _working_flank(said: Said, stage: Component, gear: Component) -> Component | None:
    """Return the flank that carries load; where the file does not say, the left one."""
    flanks = flanks_of(said, gear)
    for data in gear_data_of(said, stage, gear):
        side = said.text(data, "loaded_tooth_flank")
        for name, flank in flanks:
            if name == side:
                return flank
    if not flanks:
        return None

    def modifications(flank: Component) -> list[tuple[str, object]]:
        found = said.model.related(flank, *_REFERENCE, *KINDS, *NOT_TAKEN)
        return sorted((c.type, sorted(c.attributes.items(), key=str)) for c in found)

    if any(modifications(flank) != modifications(flanks[0][1]) for _, flank in flanks):
        said.note(
            f"{gear.label}: its flanks are modified differently and the file does not say which one carries "
            "load (loaded_tooth_flank); the left one is taken (assumed)"
        )
    return flanks[0][1]


def _take(said: Said, which: str, relief: Component, geometry: Geometry) -> None:
    """Take one relief; a depth stated at another diameter is carried to the end along the relief's shape."""
    kind = relief.type
    depth = said.number(relief, f"{kind}_depth")
    start = said.number(relief, f"{kind}_datum_diameter")
    stated_at = said.number(relief, f"{kind}_evaluation_reference")
    shape = said.text(relief, "shape_of_relief") or "linear"
    base = 2.0 * (geometry.base_radius_pinion if which == "pinion" else geometry.base_radius_gear)
    if depth is None or start is None or start.si <= base or shape not in ("linear", "parabolic"):
        said.note(
            f"{relief.label} is left out: a depth, the diameter of its start above the base circle and a "
            "linear or parabolic shape are needed"
        )
        return
    begin = roll_angle(start.si, base)
    end = end_of_flank(geometry, which, kind)
    remark = ""
    amount = depth.si
    if stated_at is not None and stated_at.si > base:
        stated = roll_angle(stated_at.si, base)
        # The same diameter printed with 15 digits is not carried: that would only add rounding.
        if not math.isclose(stated, end, rel_tol=1e-9) and (stated - begin) * (end - begin) > 0.0:
            amount *= ((end - begin) / (stated - begin)) ** (1 if shape == "linear" else 2)
            remark = f", carried from {kind}_evaluation_reference to the end of the flank"
    path = f"{which}.{kind}"
    said.put(f"{path}.shape", shape, said.where(relief, "shape_of_relief"))
    number = derived_number(amount, "um") if remark else to_file(amount, "um")
    said.put(f"{path}.amount", number, depth.where + remark)
    said.put(f"{path}.start_roll_angle", derived_number(begin, "deg"), f"{start.where}, as roll angle")


def roll_angle(diameter: float, base: float) -> float:
    """Roll angle of a circle [rad]: the tangent of its pressure angle.

    Parameters
    ----------
    diameter, base : of the circle and of the base circle [m]
    """
    return math.sqrt((diameter / base) ** 2 - 1.0)


def diameter_at(roll: float, base: float) -> float:
    """Diameter of the circle at a roll angle [m]: the inverse of ``roll_angle``."""
    return base * math.hypot(1.0, roll)
