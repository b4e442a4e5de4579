"""Parameter files as text to edit: from any parameters, or for a new pair from the values of a drawing."""

from __future__ import annotations

import re
import textwrap
import tomllib
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

import tomli_w

from lumped.bearings.rolling import across_ratio, assumed_bearing
from lumped.errors import ParameterError, refuse
from lumped.fields.units import to_si
from lumped.friction.registry import LAWS
from lumped.schema.assumed import ABOUT, WORDS, within
from lumped.schema.bearings import STIFFNESSES
from lumped.schema.changes import by_fields, fields_of
from lumped.schema.files import load_gear_pair
from lumped.schema.gear import STANDARD_FILLET
from lumped.schema.old_formats import FORMAT
from lumped.schema.operating import torque_of
from lumped.schema.own_laws import is_own
from lumped.schema.pair import GearPair, leaf_paths, stated_unit
from lumped.stiffness.foundation import thin_rims

GIVEN = "given by the user"
#: End of the path of a field -> reason for the assumed value. The first entry that fits is used.
_WHY = {
    "_stiffness": "of rolling bearing, shaft and housing together; see the guide on bearings",
    **dict.fromkeys(("pinion.type", "gear.type"), "balls on shafts up to 50 mm, else rollers"),
    **dict.fromkeys(("pinion.number", "gear.number"), "8 balls or 12 rollers"),
    **dict.fromkeys(("pinion.size", "gear.size"), "0.3 of a shaft that the torque loads by 30 MPa"),
    "contact_angle": "radial bearings",
    **dict.fromkeys(("pinion.bearings", "gear.bearings"), "a shaft in two bearings"),
    **dict.fromkeys(
        ("pinion.stiffness_factor", "gear.stiffness_factor"), "that of the bearings alone, in a rigid housing"
    ),
    "mesh.damping_ratio": "usual for steel gears, 0.03 to 0.17",
    "damping_ratio": "shaft on rolling bearings; see the guide on bearings",
    "roughness": "ground flanks",
    **dict.fromkeys(
        ("pressure_angle", "addendum_coefficient", "dedendum_coefficient", "fillet_radius_coefficient"),
        "standard basic rack, ISO 53",
    ),
    "profile_shift": "what the centre distance asks for, shared between both gears; none without one",
    "tip_alteration": "keeps the clearance of the basic rack",
    "bore": "solid disc",
    "viscosity_law.density": "mineral oil",
    **dict.fromkeys(("density", "youngs_modulus", "poisson_ratio"), "steel"),
    "stiffness.model": "computed from the form of both gears by plane finite elements",
    "stiffness.plane": "usual for gears; 'strain' for wide ones",
    "stiffness.support": "deflections count from the mean motion of the gear",
    "backlash": "least by ISO/TR 10064-2 for module and centre distance, up to a tenth of the module",
    "viscosity": "oil warm from running",
    "temperature": "sump of an enclosed gear",
    **dict.fromkeys(("viscosity_index", "pressure_viscosity_k", "pressure_viscosity_s"), "mineral oil"),
    "law": f"law {LAWS['iso_14179'].title}, which knows load, speed, oil and roughness; between two others",
    "relief": "tip and root relief act where they are given",
    "contact": "a tooth pair touches where the mean load closes its gap",
    "sharpness": "read by law IV alone",
    "maximum": "bounds law II near the pitch point",
    "thresholds": "read by law V alone",
    "film_length": "usual cut-off",
    "brake_torque": "steady mean speed",
    "pinion_torque": "tangential load over face width and module of 20 N/mm^2",
    "pinion_speed": "a round number",
}
_OF_THIN_RIMS = "as of a solid body: what holds a thin rim decides its stiffness, and is not known"
_SECTION = re.compile(r"(\[\[?)([\w.]+)\]\]?$")
_ENTRY = re.compile(r"(\w+) = ")
_COLUMN = 40


def new_pair(
    teeth: str | tuple[int, int],
    module: float | str,
    face_width: float | str,
    speed: float | str,
    torque: float | str | None = None,
    changes: Mapping[str, Any] | None = None,
    name: str = "",
    **fields: Any,
) -> GearPair:
    """Return a pair from the values on its drawing. Missing values are assumed, see ``pair.assumed``.

    Parameters
    ----------
    teeth : of pinion and gear, "19/41"
    module : [mm]
    face_width : of both gears [mm]
    speed : of the pinion [rpm]
    torque : on the pinion [N m]; None: ``power=`` states the driving power [kW] instead
    changes : further known values, by the names and paths of ``pair.with_``: ``{"oil": "vg220",
        "pinion.profile_shift": 0.4}``. Assumed values of the basic rack follow from known values: the fillet
        radius from pressure angle and dedendum, the dedendum from the addendum
    name : name of the pair; default from the numbers of teeth
    **fields : the same as ``changes``: ``oil="vg220"``, ``pinion__profile_shift=0.4``

    Raises
    ------
    ParameterError : what is malformed, or a pair that cannot exist
    """
    request = {
        "teeth": teeth,
        "gears.face_width": face_width,
        "module": module,
        "speed": speed,
        **({} if torque is None else {"torque": torque}),
        **(changes or {}),
        **{key.replace("__", "."): value for key, value in fields.items()},
    }
    stated = by_fields(request)
    if not any(path in stated for path in _LOADS):
        action = "Give the torque on the pinion [N m], or the driving power: power='5 kW'."
        raise refuse("torque", "missing", "a torque or a power", action)
    name_of_pair = name or "pair_" + "_".join(str(stated[path]) for path in fields_of("teeth"))
    user_laws = {path: stated.pop(path) for path in list(stated) if is_own(path, stated[path])}
    pair = load_gear_pair(tomllib.loads(new_pair_text(name_of_pair, stated)))
    return pair.with_(user_laws) if user_laws else pair


#: Fields that state the load of the pair.
_LOADS = ("operating.pinion_torque", "operating.pinion_power")
#: Tangential load over face width and module where a file has no torque [N/m^2]: a moderate load of hardened
#: steel gears of any size.
_LOAD_INTENSITY = 20e6
#: Damping ratio of a gear on its bearings: the formula c = 1.25e-5 s k gives 0.03 to 0.25 for most pairs, but
#: it was measured below the frequencies of gears (docs/theory/bearings.md).
_BEARING_DAMPING = 0.05
_FILLET = "basic_rack.fillet_radius_coefficient"
_DEDENDUM = "basic_rack.dedendum_coefficient"
#: Clearance of the standard basic rack over module (ISO 53).
_CLEARANCE = 0.25
#: Field -> value in file units that stands in where a file has none.
_STAND_INS: dict[str, Any] = {
    "pinion.roughness": 0.4,
    "gear.roughness": 0.4,
    **{
        f"bearings.{gear}.{line}_damping_ratio": _BEARING_DAMPING
        for gear in ("pinion", "gear")
        for line in ("loa", "oloa")
    },
    "mesh.damping_ratio": 0.05,
    "mesh.stiffness.model": "finite_elements",
    "friction.law": "iso_14179",
    "operating.pinion_speed": 1000.0,
}
#: Oil temperature where a file has viscosities but no temperature [degC], and dynamic viscosity where it has
#: none [mPa s].
_TEMPERATURE = 70.0
_VISCOSITY = 10.0


def new_pair_text(name: str, request: Mapping[str, Any]) -> str:
    """Return a complete parameter file as text. A comment marks every assumed value and gives the reason.

    ``request``: path of the field -> value, for the arguments of ``new_pair``.
    """
    values = _with_torque(_values(request))
    pair = _filled({"name": name}, values)
    by_user = [path for path in leaf_paths(pair) if any(within(path, one) for one in values)]
    pair = marked(pair, dict.fromkeys(by_user, GIVEN))
    stated_count = len(pair.sources)
    assumed_count = len(pair.assumed)
    notes = [
        "A bare number means the unit in the comment; text may carry any unit of that kind: '700 in-lb'.",
        f"{stated_count} values are given, {assumed_count} assumed: replace what you know, first bearings.",
        "An assumed value stands in the table [assumed], too. It is known when you change it here, or, where "
        "it is right as it is, when you delete its line there.",
        *(f"{note[0].upper()}{note[1:]}." for note in pair.geometry.notes),
    ]
    return parameter_text(pair.to_mapping(), notes)


def marked(pair: GearPair, sources: Mapping[str, str]) -> GearPair:
    """Return the pair with these sources. Every field without a source is marked as assumed."""
    assumed = {path: v for path, v in leaf_paths(pair).items() if path not in (*WORDS, *sources)}
    return load_gear_pair(pair.to_mapping() | {"sources": dict(sources), "assumed": assumed})


#: Fields without which no load is assumed.
_SIZE = {"basic_rack.module", "pinion.face_width", "pinion.teeth"}


def reasons(pair: GearPair) -> dict[str, str]:
    """Return assumed field -> reason for the value.

    Only fields are listed whose value `new_pair` would assume, too.
    """
    stated = {name: part for name, part in pair.to_mapping().items() if name not in (*WORDS, *ABOUT)}
    for path in pair.assumed:
        *parents, leaf = path.split(".")
        node: Any = stated
        for part in parents:
            node = node[int(part) if isinstance(node, list) else part]
        node.pop(leaf, None)  # a default that follows from other fields is not written
    known = _values(stated)
    if not known.keys() >= _SIZE and not any(path in known for path in _LOADS):
        return {}  # an example pair, all of which is assumed
    try:
        filled = _filled({"name": pair.name}, known)
    except ParameterError:  # such as a kind of stiffness that the program would not assume
        return {}
    assumptions = filled.assumed.to_mapping() | leaf_paths(filled)
    values = pair.assumed.to_mapping()
    return {path: _why(path, value) for path, value in values.items() if assumptions.get(path) == value}


def _why(path: str, value: object) -> str:
    if (path, value) == ("mesh.stiffness.model", "energy"):
        return _OF_THIN_RIMS
    if path == _FILLET and value != STANDARD_FILLET:
        return "0.95 of the largest that fits this pressure angle and dedendum"
    if path == _DEDENDUM and value != 1.0 + _CLEARANCE:
        return "the addendum and the clearance of the standard basic rack, ISO 53"
    return next((why for end, why in _WHY.items() if path.endswith(end)), "the default of a parameter file")


def _filled(named: dict[str, Any], values: dict[str, Any]) -> GearPair:
    """Return the pair with these values and assumptions for all other fields."""
    pair = load_gear_pair(named | completed(values))
    if "mesh.backlash" not in values:
        pair = pair.with_(mesh__backlash=_backlash(pair))
    if not any(path.startswith("mesh.stiffness.") for path in values):
        pair = pair.with_({"mesh.stiffness": {"model": stand_in_stiffness(pair)}})
    return pair


def stand_in_stiffness(pair: GearPair) -> str:
    """Return the stiffness model of a pair without a stated model: "finite_elements" or "energy" (thin rims).

    A free thin rim becomes oval, so that k depends on the support of the bore. A drawing does not state this
    support. The energy method assumes a solid body.
    """
    return "energy" if thin_rims(pair) else "finite_elements"


def _backlash(pair: GearPair) -> float:
    """Return the least normal backlash of industrial gears [mm].

    j = 2/3 (0.06 + 0.0005 a + 0.03 m) mm for centre distance a and module m from 1.5 mm on (ISO/TR 10064-2,
    annex A). For fine teeth a tenth of the module is less and is used instead.
    """
    module = 1e3 * pair.basic_rack.module
    centre = 1e3 * pair.geometry.centre_distance
    return round(min((0.06 + 0.0005 * centre + 0.03 * module) / 1.5, 0.1 * module), 4)


def _values(request: Mapping[str, Any]) -> dict[str, Any]:
    """Return path of the field -> value of a request. A section given as a table is split into its fields."""
    values: dict[str, Any] = {}
    for path, value in by_fields(request).items():
        if isinstance(value, dict):  # mesh.stiffness = {model = "energy"}
            values |= _values({f"{path}.{key}": part for key, part in value.items()})
        else:
            values[path] = value
    return values


def _with_torque(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the values with the torque in place of a stated power: the assumed bearings follow from it."""
    torque_path, power_path = _LOADS
    torque = torque_of(values.get(power_path), values.get("operating.pinion_speed"))
    if torque is None or torque_path in values:
        return dict(values)
    return {path: value for path, value in values.items() if path != power_path} | {torque_path: torque}


def parameter_text(mapping: Mapping[str, Any], notes: Sequence[str] = ()) -> str:
    """Write parameters as commented TOML.

    Parameters
    ----------
    mapping : nested parameters in file units
    notes : put above as comments

    Returns
    -------
    TOML text; reading it gives ``mapping`` back
    """
    pair = load_gear_pair(mapping)
    assumed = dict.fromkeys(pair.assumed, "assumed")
    assumed |= {path: f"assumed: {why}" for path, why in reasons(pair).items()}
    # A default that follows from other fields is written as a comment: a value would hinder later changes.
    follows = {path: value for path, value in pair.assumed.items() if path not in leaf_paths(pair)}
    section = ""
    entries: Counter[str] = Counter()  # section -> tables of its list that are written already
    lines = []
    for line in tomli_w.dumps({"format": FORMAT} | dict(mapping)).splitlines():
        if heading := _SECTION.match(line):
            brackets, section_path = heading.groups()
            section = f"{section_path}."
            if brackets == "[[":
                section += f"{entries[section]}."
                entries[f"{section_path}."] += 1
            lines.append(line)
            for path, value in follows.items():
                parent, _, field = path.rpartition(".")
                if parent == section_path:
                    lines.append(_commented(f"# {field} = {_short(value)}", path, assumed))
            continue
        elif entry := _ENTRY.match(line):  # the paths of [sources] and [assumed] have quotation marks
            line = _commented(line, f"{section}{entry[1]}", assumed)
        lines.append(line)
    head = [
        wrapped
        for note in notes
        for wrapped in textwrap.wrap(
            # A note may quote what a file from elsewhere says, control characters included.
            "".join(c if c.isprintable() else " " for c in note),
            100,
            initial_indent="# - ",
            subsequent_indent="#   ",
            break_long_words=False,
        )
    ]
    return "\n".join([*head, *([""] if head else []), *lines]) + "\n"


def _short(value: object) -> object:
    return f"{value:.6g}" if isinstance(value, float) else value


def _commented(line: str, path: str, assumed: Mapping[str, str]) -> str:
    try:
        unit = stated_unit(path)
    except ParameterError:  # a member of a choice of sections
        unit = None
    remarks = (
        [] if unit in (None, "1") or line.endswith('"') else [str(unit).replace("**", "^").replace("*", " ")]
    )
    if path in assumed:
        remarks.append(assumed[path])
    return f"{line:<{_COLUMN}} # {', '.join(remarks)}" if remarks else line


def completed(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return a full parameter mapping without name and description.

    ``values``: path of the field -> known value in file units. All other values are assumed.
    """
    full = _STAND_INS | _assumed_dedendum(values) | dict(values)
    if any(path.startswith("lubricant.viscosity_law") for path in full):
        full.setdefault("lubricant.viscosity_law.temperature", _TEMPERATURE)
    else:
        full.setdefault("lubricant.viscosity", _VISCOSITY)
    if not any(path in full for path in _LOADS):
        module, width = (to_si(full[path], "mm") for path in ("basic_rack.module", "pinion.face_width"))
        radius = 0.5 * module * full["pinion.teeth"]  # of the reference circle
        full["operating.pinion_torque"] = float(f"{_LOAD_INTENSITY * width * module * radius:.3g}")
    for gear in ("pinion", "gear"):
        full |= _assumed_bearing(gear, full)
    root: dict[str, Any] = {}
    for path, value in full.items():
        *parents, leaf = path.split(".")
        node = root
        for parent in parents:
            node = node.setdefault(parent, {})
        node[leaf] = value
    return root


def _assumed_dedendum(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the dedendum for a known addendum, with the clearance of the standard basic rack."""
    try:
        addendum = to_si(values["basic_rack.addendum_coefficient"], "1")
    except (ValueError, TypeError, KeyError):  # not known, or the pair refuses it
        return {}
    return {_DEDENDUM: round(addendum + _CLEARANCE, 9)}


def _assumed_bearing(gear: str, values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the missing fields of the bearings of one gear.

    If one of the two springs is known, the other spring follows from the ratio of a rolling bearing. If no
    spring is known, the rolling bearings are chosen for the torque of the shaft.
    """
    start = f"bearings.{gear}."
    stated = {path.removeprefix(start): value for path, value in values.items() if path.startswith(start)}
    try:
        torque = (
            to_si(values["operating.pinion_torque"], "N*m") * values[f"{gear}.teeth"] / values["pinion.teeth"]
        )
        kind, number, size = assumed_bearing(torque, stated.get("type"))
        ratio = across_ratio(kind, number)
        springs = {key: to_si(stated[key], "N/m") for key in STIFFNESSES if key in stated}
    except (ValueError, TypeError, KeyError, ZeroDivisionError):  # the pair refuses it, in the user's words
        kind, number, size = assumed_bearing(1.0)
        ratio = 1.0
        springs = {}
    if springs:
        along_line = springs.get(STIFFNESSES[0])
        across_line = springs.get(STIFFNESSES[1])
        missing_springs = {STIFFNESSES[0]: None if across_line is None else across_line / ratio}
        missing_springs |= {STIFFNESSES[1]: None if along_line is None else along_line * ratio}
        return {start + key: float(f"{missing_springs[key]:.3g}") for key in STIFFNESSES if key not in stated}
    rolling = {"type": kind, "number": number, "size": float(f"{min(max(1e3 * size, 0.01), 1e3):.3g}")}
    return {start + key: value for key, value in rolling.items() if key not in stated}
