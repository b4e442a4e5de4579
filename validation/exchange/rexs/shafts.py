"""The shafts of a REXS stage with their bearings, where the file has all that beams in springs need."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from lumped.errors import ParameterError
from lumped.schema.pair import GearPair
from validation.exchange.rexs.assumptions import ASSUMED
from validation.exchange.rexs.gears import MATERIAL
from validation.exchange.rexs.model import Component
from validation.exchange.rexs.said import Reading, Said
from validation.exchange.rexs.vocabulary import ATTRIBUTES, derived_number

#: Damping ratio of the modes of shafts on rolling bearings, which REXS does not have.
_DAMPING_RATIO = 0.02
#: Gap or overlap of neighbouring sections that is rounding [m].
_GAP = 1e-6
_SECTION = ("outer_diameter_begin", "outer_diameter_end", "inner_diameter_begin", "inner_diameter_end")


class _LeftOut(Exception):
    """Why the shafts are left out."""


def read_shafts(said: Said, pinion: Component, gear: Component, validated: Callable[[], GearPair]) -> None:
    """Read the shafts of both gears, or note in one line what is missing; a file without any says nothing.

    Parameters
    ----------
    said : collects what is found
    pinion, gear : components
    validated : validates all that was read; shafts that it refuses are left out
    """
    gears = {"pinion": pinion, "gear": gear}
    carriers = {
        which: said.model.related(g, "assembly", "part", "assembly", "shaft") for which, g in gears.items()
    }
    if not any(_sections(said, shaft) for shafts in carriers.values() for shaft in shafts):
        return
    values, sources = dict(said.values), dict(said.sources)
    try:
        for which, component in gears.items():
            if len(carriers[which]) != 1:
                raise _LeftOut(f"{component.label} is on no shaft, or on several")
            _read_shaft(said, f"shafts.{which}", carriers[which][0], component)
        said.put("shafts.damping_ratio", _DAMPING_RATIO, f"{ASSUMED}: usual for shafts on rolling bearings")
        try:
            validated()
        except ParameterError as error:
            first = error.problems[0]
            raise _LeftOut(f"{first.field} is {first.value}, allowed is {first.allowed}") from None
    except _LeftOut as reason:
        said.values, said.sources = values, sources
        said.note(f"shafts of the file are left out: {reason}")


def _read_shaft(said: Said, path: str, shaft: Component, gear: Component) -> None:
    others = [
        c for c in said.model.together(shaft, "cylindrical_gear", "ring_gear", "bevel_gear") if c != gear
    ]
    if others:
        raise _LeftOut(
            f"{shaft.label} carries {others[0].label} too, whose mass and forces are not in the pair"
        )
    start = _read_segments(said, path, shaft)
    begin, width = _needed(said, gear, "u_coordinate_on_shaft"), _needed(said, gear, "face_width")
    middle = Reading(begin.si + 0.5 * width.si - start, f"{begin.where}, and half the face width")
    said.put(f"{path}.gear_position", derived_number(middle.si, "mm"), middle.where)
    _read_bearings(said, path, shaft, start)
    for material in said.model.related(shaft, "reference", "origin", "referenced", "material"):
        said.take_all(path, material, MATERIAL)


def _sections(said: Said, shaft: Component) -> list[Component]:
    return said.model.related(shaft, "assembly", "assembly", "part", "shaft_section")


def _read_segments(said: Said, path: str, shaft: Component) -> float:
    """Read the sections in their order on the shaft; return where the first begins [m]."""
    found = [(_needed(said, s, "u_coordinate_on_shaft").si, s) for s in _sections(said, shaft)]
    if not found:
        raise _LeftOut(f"{shaft.label} has no shaft_section")
    found.sort(key=lambda entry: entry[0])
    start = end = found[0][0]
    rows: list[dict[str, Any]] = []
    for number, (begin, section) in enumerate(found):
        if abs(begin - end) > _GAP:
            raise _LeftOut(f"{section.label} does not begin where the section before it ends")
        length = _needed(said, section, "length")
        outer, outer_end, inner, inner_end = (_needed(said, section, name) for name in _SECTION)
        if abs(outer.si - outer_end.si) > _GAP or abs(inner.si - inner_end.si) > _GAP:
            raise _LeftOut(f"{section.label} is conical, and segments are of constant section")
        end = begin + length.si
        readings = {"length": length, "diameter": outer, "bore": inner}
        rows.append(_row(said, f"{path}.segments.{number}", readings))
    said.values[f"{path}.segments"] = rows
    return start


def _read_bearings(said: Said, path: str, shaft: Component, start: float) -> None:
    """Read the bearings between a shaft and the casing; one spring holds in all radial directions."""
    rows: list[dict[str, Any]] = []
    for side, other in (("inner", "outer"), ("outer", "inner")):
        for bearing in said.model.related(shaft, "side", f"{side}_part", "assembly"):
            if "bearing" not in bearing.type:
                continue
            if said.model.related(bearing, "side", "assembly", f"{other}_part", "shaft"):
                raise _LeftOut(f"{bearing.label} bears a shaft on another shaft")
            if "radial_stiffness" not in ATTRIBUTES.get(bearing.type, {}):
                raise _LeftOut(f"{bearing.label} is of a type that is not read")
            middle = _needed(said, bearing, f"u_coordinate_on_shaft_{side}_side")
            radial = _needed(said, bearing, "radial_stiffness")
            readings = {
                "position": Reading(middle.si - start, middle.where),
                "loa_stiffness": radial,
                "oloa_stiffness": radial,
            }
            tilt = said.number(bearing, "bending_stiffness")
            if tilt is not None:
                readings["tilt_stiffness"] = tilt
            rows.append(_row(said, f"{path}.bearings.{len(rows)}", readings))
    if len(rows) < 2:
        raise _LeftOut(f"{shaft.label} has fewer than two bearings")
    said.values[f"{path}.bearings"] = rows


def _row(said: Said, path: str, readings: dict[str, Reading]) -> dict[str, Any]:
    """Put the fields of one table of a list, and take them back as the table."""
    row = {}
    for key, reading in readings.items():
        said.take(f"{path}.{key}", Reading(float(f"{reading.si:.12g}"), reading.where))
        row[key] = said.values.pop(f"{path}.{key}")
    return row


def _needed(said: Said, component: Component, attribute: str) -> Reading:
    found = said.number(component, attribute)
    if found is None:
        raise _LeftOut(f"{component.label} states no {attribute}")
    return found
