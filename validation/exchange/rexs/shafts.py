"""The shafts of a REXS stage with their bearings, where the file has all that beams in springs need."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from lumped.errors import ParameterError
from lumped.schema.pair import GearPair
from validation.exchange.rexs.draft import ASSUMED, Draft, Reading
from validation.exchange.rexs.gears import MATERIAL
from validation.exchange.rexs.model import Component
from validation.exchange.rexs.vocabulary import BEARINGS, derived_number

#: Damping ratio of the modes of shafts on rolling bearings, which REXS does not have.
_DAMPING_RATIO = 0.02
#: Gap or overlap of neighbouring sections that is rounding [m].
_GAP = 1e-6
_SECTION = (
    "length", "outer_diameter_begin", "outer_diameter_end", "inner_diameter_begin", "inner_diameter_end",
)  # fmt: skip


class _LeftOut(Exception):
    """Why the shafts are left out."""


def read_shafts(draft: Draft, gears: dict[str, Component], validated: Callable[[], GearPair]) -> None:
    """Read the shafts of "pinion" and "gear", or note in one line what is missing.

    ``validated`` validates all that was read; shafts that it refuses are left out. A file without shafts
    says nothing.
    """
    carriers = {
        which: draft.model.related(gear, "assembly", "part", "assembly", "shaft")
        for which, gear in gears.items()
    }
    if not any(_sections(draft, shaft) for shafts in carriers.values() for shaft in shafts):
        return
    values, sources = dict(draft.values), dict(draft.sources)
    try:
        for which, gear in gears.items():
            if len(carriers[which]) != 1:
                raise _LeftOut(f"{gear.label} is on no shaft, or on several")
            _read_shaft(draft, f"shafts.{which}", carriers[which][0], gear)
        draft.put("shafts.damping_ratio", _DAMPING_RATIO, f"{ASSUMED}: usual for shafts on rolling bearings")
        try:
            validated()
        except ParameterError as error:
            first = error.problems[0]
            raise _LeftOut(f"{first.field} is {first.value}, allowed is {first.allowed}") from None
    except _LeftOut as reason:
        draft.values, draft.sources = values, sources
        draft.note(f"shafts of the file are left out: {reason}")


def _sections(draft: Draft, shaft: Component) -> list[Component]:
    return draft.model.related(shaft, "assembly", "assembly", "part", "shaft_section")


def _read_shaft(draft: Draft, path: str, shaft: Component, gear: Component) -> None:
    for other in draft.model.neighbours(shaft, "cylindrical_gear", "ring_gear", "bevel_gear"):
        if other != gear:
            text = f"{shaft.label} carries {other.label} too"
            raise _LeftOut(f"{text}, whose mass and forces are not in the pair")
    start = _read_segments(draft, path, shaft)
    begin, width = _needed(draft, gear, "u_coordinate_on_shaft"), _needed(draft, gear, "face_width")
    middle = derived_number(begin.si + 0.5 * width.si - start, "mm")
    draft.put(f"{path}.gear_position", middle, f"{begin.where}, and half the face width")
    _read_bearings(draft, path, shaft, start)
    for material in draft.model.referenced(shaft, "material"):
        draft.take_all(path, material, MATERIAL)


def _read_segments(draft: Draft, path: str, shaft: Component) -> float:
    """Read the sections in their order on the shaft; return where the first begins [m]."""
    sections = [(_needed(draft, s, "u_coordinate_on_shaft").si, s) for s in _sections(draft, shaft)]
    if not sections:
        raise _LeftOut(f"{shaft.label} has no shaft_section")
    sections.sort(key=lambda entry: entry[0])
    start = end = sections[0][0]
    rows = []
    for begin, section in sections:
        if abs(begin - end) > _GAP:
            raise _LeftOut(f"{section.label} does not begin where the section before it ends")
        length, outer, outer_end, inner, inner_end = (_needed(draft, section, name) for name in _SECTION)
        if abs(outer.si - outer_end.si) > _GAP or abs(inner.si - inner_end.si) > _GAP:
            raise _LeftOut(f"{section.label} is conical, and segments are of constant section")
        end = begin + length.si
        rows.append({"length": length, "diameter": outer, "bore": inner})
    _put_rows(draft, f"{path}.segments", rows)
    return start


def _read_bearings(draft: Draft, path: str, shaft: Component, start: float) -> None:
    """Read the bearings between a shaft and the casing; one spring holds in all radial directions."""
    rows = []
    for side, other in (("inner", "outer"), ("outer", "inner")):
        for bearing in draft.model.related(shaft, "side", f"{side}_part", "assembly"):
            if "bearing" not in bearing.type:
                continue
            if draft.model.related(bearing, "side", "assembly", f"{other}_part", "shaft"):
                raise _LeftOut(f"{bearing.label} bears a shaft on another shaft")
            if bearing.type not in BEARINGS:
                raise _LeftOut(f"{bearing.label} is of a type that is not read")
            middle = _needed(draft, bearing, f"u_coordinate_on_shaft_{side}_side")
            row = {"position": Reading(middle.si - start, middle.where)}
            row |= dict.fromkeys(
                ("loa_stiffness", "oloa_stiffness"), _needed(draft, bearing, "radial_stiffness")
            )
            if (tilt := draft.number(bearing, "bending_stiffness")) is not None:
                row["tilt_stiffness"] = tilt
            rows.append(row)
    if len(rows) < 2:
        raise _LeftOut(f"{shaft.label} has fewer than two bearings")
    _put_rows(draft, f"{path}.bearings", rows)


def _put_rows(draft: Draft, path: str, rows: list[dict[str, Reading]]) -> None:
    """Put a list of tables: each field has its source, the list its value."""
    tables: list[dict[str, Any]] = [{} for _ in rows]
    for number, row in enumerate(rows):
        for key, reading in row.items():
            field = f"{path}.{number}.{key}"
            draft.take(field, Reading(float(f"{reading.si:.12g}"), reading.where))
            tables[number][key] = draft.values.pop(field)
    draft.values[path] = tables


def _needed(draft: Draft, component: Component, attribute: str) -> Reading:
    if (result := draft.number(component, attribute)) is None:
        raise _LeftOut(f"{component.label} states no {attribute}")
    return result
