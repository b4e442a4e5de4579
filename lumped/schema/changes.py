"""Changes of a pair by field names and short names, for ``with_``, ``new_pair`` and --set."""

from __future__ import annotations

import copy
import re
from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from lumped.errors import ParameterError, quoted, refuse
from lumped.fields.refusals import field_of, unknown_key
from lumped.fields.scope import about_teeth
from lumped.fields.section import Section
from lumped.schema.assumed import ABOUT, WORDS, inside_any, within
from lumped.schema.bearings import ROLLING, STIFFNESSES, RollingBearing
from lumped.schema.contact import Mesh, without_assumed_defaults
from lumped.schema.oil_grade import grade_of
from lumped.schema.relief import STARTS

_GEARS = ("pinion", "gear")
#: Short name -> the fields that it sets.
SHORT_NAMES = {
    "speed": ("operating.pinion_speed",),
    "torque": ("operating.pinion_torque",),
    "power": ("operating.pinion_power",),
    "range": ("operating.speed_range",),
    "law": ("friction.law",),
    "stiffness": ("mesh.stiffness",),
    "damping": ("mesh.damping_ratio",),
    "module": ("basic_rack.module",),
    "pressure_angle": ("basic_rack.pressure_angle",),
    "viscosity": ("lubricant.viscosity",),
    "oil": ("lubricant.viscosity_law.iso_vg",),
    "temperature": ("lubricant.viscosity_law.temperature",),
    "teeth": tuple(f"{gear}.teeth" for gear in _GEARS),
    "face_width": tuple(f"{gear}.face_width" for gear in _GEARS),
    "roughness": tuple(f"{gear}.roughness" for gear in _GEARS),
    **{
        start + key: tuple(f"bearings.{g}.{line}_{key}" for g in _GEARS for line in ("loa", "oloa"))
        for key in ("stiffness", "damping_ratio")
        for start in ("bearings.", "bearing_")
    },
}
_TEETH = re.compile(r"\s*[(\[]?\s*(\d{1,4})\s*[/:x,]\s*(\d{1,4})\s*[)\]]?\s*")

#: Another model of stiffness starts with the defaults of this model: each model has other keys.
_SECTION = "mesh.stiffness"
_STIFFNESS = "mesh.stiffness.model"
#: Groups of alternative fields: a change of one field removes the other fields of the group.
_ALTERNATIVES = (
    *((f"{gear}.addendum", f"{gear}.tip_diameter", f"{gear}.tip_alteration") for gear in _GEARS),
    ("lubricant.viscosity", "lubricant.viscosity_law"),
    ("operating.pinion_torque", "operating.pinion_power"),
    *(
        tuple(f"{gear}.{end}_relief.{start}" for start in STARTS)
        for gear in ("pinion", "gear")
        for end in ("tip", "root")
    ),
)
#: Source of a value that the user changed.
BY_THE_USER = "varied by the user"
#: Field whose default follows from other fields, and these other fields.
_FILLET = "basic_rack.fillet_radius_coefficient"
_OF_FILLET = ("basic_rack.pressure_angle", "basic_rack.dedendum_coefficient")


def fields_of(name: str) -> tuple[str, ...]:
    """Return the fields of a short name or a path. ``gears.`` in front of a path means both gears."""
    section, _, key = name.partition(".")
    return SHORT_NAMES.get(name) or (
        tuple(f"{gear}.{key}" for gear in _GEARS) if section == "gears" and key else (name,)
    )


def by_fields(request: Mapping[str, Any]) -> dict[str, Any]:
    """Return field path -> value; teeth may be "19/41" or a tuple, oil "ISO VG 220", "vg220" or 220."""
    values: dict[str, Any] = {}
    for name, value in request.items():
        if name == "teeth":
            text = value if isinstance(value, str) else quoted(value)
            if (teeth := _TEETH.fullmatch(text)) is None:
                action = about_teeth(text) or "For example 19/41."
                raise refuse("teeth", value, "PINION/GEAR", action)
            values |= dict(zip(fields_of(name), map(int, teeth.groups()), strict=True))
        elif name == "oil":
            values[SHORT_NAMES[name][0]] = grade_of(value, "oil")
        else:
            values |= dict.fromkeys(fields_of(name), value)
    return values


def changed(pair: Section, changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return the plain data of a pair with changed fields.

    The changed values are known, with the user as source. A change to the present value makes an assumed
    value known. Another stiffness decides anew on contact and relief, where both are assumed.
    """
    data = pair.to_mapping()
    if any(within(path, _SECTION) for path in changes):
        mesh: Mesh = pair.__dict__["mesh"]
        unchanged = {
            name: value for name, value in mesh.by_stiffness.items() if f"mesh.{name}" not in changes
        }
        data = without_assumed_defaults(data, unchanged)
    sources: dict[str, str] = data.setdefault("sources", {})
    assumed: dict[str, Any] = data.setdefault("assumed", {})
    for gear in _GEARS:
        _other_bearing(pair, data, gear, changes)
    rack: Any = pair.__dict__["basic_rack"]
    if any(path in changes for path in _OF_FILLET) and assumed.get(_FILLET) == rack.assumed_fillet:
        del assumed[_FILLET], data["basic_rack"]["fillet_radius_coefficient"]  # the default of the new rack
    # The model first: it decides which other keys its table may have.
    for path, request in sorted(changes.items(), key=lambda change: change[0] != _STIFFNESS):
        value = request.item() if isinstance(request, np.generic) else request
        if reads(pair, path, value) and not inside_any(assumed, [path]):
            continue
        outdated = [path]
        if path == _STIFFNESS:
            outdated.append(_SECTION)
            _assign(type(pair), data, outdated[-1], {})
        for group in alternatives_of(path) if value is not None else ():
            outdated += group
            for other in group:
                if not path.startswith(f"{other}.") and other not in changes:
                    _assign(type(pair), data, other, None)
        _assign(type(pair), data, path, value)
        for table in (sources, assumed):
            for one in inside_any(table, outdated):
                del table[one]
        if path not in (*WORDS, *ABOUT) and value is not None:
            sources[path] = BY_THE_USER
    return data


@lru_cache(maxsize=1024)  # every variation of a pair has the same paths
def alternatives_of(path: str) -> tuple[tuple[str, ...], ...]:
    """Return the groups of alternative fields to which a field, or a field around it, belongs."""
    return tuple(group for group in _ALTERNATIVES if any(within(path, one) for one in group))


def _other_bearing(pair: Section, data: dict[str, Any], gear: str, changes: Mapping[str, Any]) -> None:
    """Change the kind of a gear's bearings.

    A change of a stiffness replaces rolling bearings by springs. A change of type, number or size replaces
    springs by rolling bearings. In a direction that the change does not name, springs have the stiffness of
    the bearings at the pair's load.
    """
    start = f"bearings.{gear}."
    named = {path.removeprefix(start) for path in changes if path.startswith(start)}
    springs = not named.isdisjoint(STIFFNESSES)
    rolling = not named.isdisjoint(ROLLING)
    section: dict[str, Any] = data["bearings"][gear]
    bearing = getattr(pair.__dict__["bearings"], gear)
    outdated: tuple[str, ...]
    if springs and not rolling and isinstance(bearing, RollingBearing):
        data["bearings"][gear] = bearing.springs
        outdated = ROLLING
    elif rolling and not springs and not isinstance(bearing, RollingBearing):
        for key in STIFFNESSES:
            section.pop(key, None)
        outdated = STIFFNESSES
    else:
        return
    for table in (data["sources"], data.get("uncertainty", {})):
        for key in outdated:
            table.pop(start + key, None)


def reads(pair: Section, path: str, value: object) -> bool:
    """Return whether a field already reads as a value."""
    result: object = pair
    for part in path.split("."):
        if isinstance(result, tuple) and _is_entry(result, part):
            result = result[int(part)]
        elif isinstance(result, Section) and part in type(result).model_fields:
            result = getattr(result, part)
        else:
            return False
    return type(result) is type(value) and repr(result) == repr(value)


def _assign(root: type[Section], data: dict[str, Any], path: str, value: Any) -> None:
    *parents, leaf = path.split(".")
    node: Any = data
    for part in parents:
        node = _inside(node, path, part)
    if isinstance(node, list):
        if value is None:
            raise refuse(path, "None", "a table of keys and values", "Give the list without this entry.")
        if not _is_entry(node, leaf):
            raise ParameterError([unknown_key(path, list(map(str, range(len(node)))), leaf)])
        node[int(leaf)] = _plain(value)
    elif value is None:
        field_of(root, path)  # a name that does not exist is an error also where nothing is set
        node.pop(leaf, None)
    else:
        node[leaf] = _plain(value)


def _inside(node: Any, path: str, part: str) -> Any:
    """The table, or the list of tables, under a key of a table or at an entry of a list."""
    if isinstance(node, dict):
        inner = node.setdefault(part, {})
    else:
        inner = node[int(part)] if _is_entry(node, part) else None
    if isinstance(inner, dict) or (isinstance(inner, list) and inner and isinstance(inner[0], dict)):
        return inner
    keys = list(node) if isinstance(node, dict) else list(map(str, range(len(node))))
    raise ParameterError([unknown_key(path, keys, part)])


def _is_entry(node: Sequence[Any], part: str) -> bool:
    return part in map(str, range(len(node)))


def _plain(value: Any) -> Any:
    if isinstance(value, Section):
        return value.to_mapping()
    return [_plain(entry) for entry in value] if isinstance(value, (list, tuple)) else copy.deepcopy(value)
