"""Reading gear pairs from presets, files and mappings; the schema and the fields of a pair as plain data."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator, Mapping
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

from lumped.arguments import nearest
from lumped.errors import OldFormatWarning, refuse, shown
from lumped.fields.text_file import parse_toml, read_text
from lumped.fields.units import to_file
from lumped.gear_geometry.geometry import Geometry
from lumped.schema.old_formats import FORMAT
from lumped.schema.pair import GearPair, validated

#: What stands for a gear pair: a preset name, the path of a TOML file, parameters in file units, or the pair.
AnyPair = GearPair | str | Path | Mapping[str, Any]

#: Largest parameter file read, a bound against a wrong path rather than a limit of the format.
MAX_FILE_BYTES = 1_000_000

#: Section that only another kind of file has -> what that is.
_OTHER_FILES = {
    "gear_pair": "a study: run it with 'spurcheck sweep'",
    "channel": "a measured record: give it to 'spurcheck report --record'",
}

#: Suffix of a file that is no TOML -> what to do with it.
_NO_PAIRS = {
    ".nc": "This is a result: name the parameter file it was computed from; 'spurcheck export' makes tables.",
    ".csv": "This is a table: name a parameter file; name the description of a measured record by --record.",
    ".json": "Name the parameter file; of a report it is data/parameters.toml.",
    **dict.fromkeys((".xlsx", ".xls", ".ods"), "Copy its values into a parameter file: 'spurcheck init'."),
} | dict.fromkeys((".rexs", ".rexsj", ".rexsz"), "Make a parameter file of it: 'spurcheck init --from-rexs'.")

#: Numbers of teeth, as ``new_pair`` takes them, where a file is asked for.
_TEETH = re.compile(r"\s*\d+\s*/\s*\d+\s*")
#: Alteration over module that changes no result anybody reads.
_SMALL = 1e-3


@cache
def preset_names() -> tuple[str, ...]:
    """Return the names of the built-in gear pairs."""
    folder = resources.files("lumped") / "presets"
    return tuple(sorted(f.name.removesuffix(".toml") for f in folder.iterdir() if f.name.endswith(".toml")))


def preset_text(name: str) -> str:
    """Return the TOML text of a built-in gear pair; of an unknown name the nearest is suggested."""
    if name not in preset_names():
        allowed = "a file that exists or one of " + ", ".join(preset_names())
        action = nearest(name, preset_names()) or "Check the path, or see 'spurcheck presets'."
        raise refuse("preset", shown(repr(name)), allowed, action)
    return (resources.files("lumped") / "presets" / f"{name}.toml").read_text(encoding="utf-8")


def load_gear_pair(source: AnyPair) -> GearPair:
    """Read a gear pair from a preset name, a TOML file or a mapping, and validate it.

    Every function with a gear pair as argument calls this function first. All these functions therefore take
    a name, a file or a mapping.

    Parameters
    ----------
    source : preset name, path of a TOML file, nested mapping in file units, or a GearPair (returned as is)

    Raises
    ------
    ParameterError : everything that is refused, with field, value, allowed range and next action
    """
    if isinstance(source, GearPair):
        return source
    if isinstance(source, (str, Path)):
        return _from_file(source)
    if not isinstance(source, Mapping) or hasattr(source, "dims"):  # a dataset is a mapping, too
        allowed = "a preset name, a TOML file, a mapping or a GearPair"
        action = "Give one of these."
        if isinstance(source, (list, tuple)):
            action = "Give one pair: [function(one) for one in pairs], or compare(*pairs)."
        raise refuse("pair", type(source).__name__, allowed, action)
    return validated(source, "mapping")


def geometry(pair: AnyPair) -> Geometry:
    """Return the geometry of a gear pair, as ``pair.geometry``."""
    return load_gear_pair(pair).geometry


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema of a parameter file; every quantity carries ``unit`` and ``si_unit``."""
    schema = GearPair.model_json_schema()
    words = "format of the file; a file without it is of format 1, which means other defaults"
    schema["properties"] |= {"format": {"enum": [1, FORMAT], "default": 1, "description": words}}
    for section in (schema, *schema["$defs"].values()):
        for field in section["properties"].values():
            if field.get("default") in (None, []):  # held so inside, but nothing that a file can say
                field.pop("default", None)
    return schema


def _from_file(source: str | Path) -> GearPair:
    """The pair of a preset or a file; a name that can be no file is taken for a preset's."""
    path = Path(source)
    suffix = Path(source).suffix.lower()
    named = isinstance(source, str) and source in preset_names()
    if named or (suffix not in (".toml", *_NO_PAIRS) and "/" not in str(source) and not _exists(path)):
        text = preset_text(str(source))
        name = f"preset {source}"
        folder = Path()
    else:
        if suffix in _NO_PAIRS:
            raise refuse("file", path, "the parameters of a gear pair, a .toml file", _NO_PAIRS[suffix])
        instead = ", or a preset: " + ", ".join(preset_names())
        action = "Check the path, or start from 'spurcheck init'."
        if _TEETH.fullmatch(str(source)):
            action = (
                "Teeth alone are no pair: spurcheck.new_pair("
                f"{str(source)!r}, module=..., face_width=..., speed=..., torque=...) assumes the rest."
            )
        text = read_text(path, MAX_FILE_BYTES, kind="TOML file", instead=instead, action=action)
        name = str(path)
        folder = path.parent
    data = parse_toml(text, name)
    for key, other in _OTHER_FILES.items():
        if key in data and "pinion" not in data:
            raise refuse("file", path, "the parameters of a gear pair", f"This is {other}.")
    data = {"format": 1} | data
    pair = validated(data, name, folder)
    if data["format"] != FORMAT:
        for difference in _changes_since(data, pair):
            text = (
                f"{name} is of format {data['format']}: {difference}. Write format = {FORMAT} at its top for "
                "that; write 0 to keep what it means."
            )
            warnings.warn(text, OldFormatWarning, stacklevel=3)
    return pair


def _changes_since(data: Mapping[str, Any], pair: GearPair) -> Iterator[str]:
    """Yield one sentence for each difference between the meaning of a file in format 1 and in today's format.

    Parameters
    ----------
    data : the data of the file
    pair : the pair from these data
    """
    written = {name: data[name] for name in ("pinion", "gear")}
    if pair.centre_distance is not None and not any("profile_shift" in gear for gear in written.values()):
        today = pair.with_({f"{name}.profile_shift": None for name in written})
        if any(abs(one) > _SMALL for one in today.profile_shifts):
            shifts = " and ".join(f"{one:.4f}" for one in today.profile_shifts)
            yield f"no profile shifts are written and 0 is taken; the centre distance asks for {shifts}"
    unwritten = [
        name
        for name, gear in written.items()
        if not any(key in gear for key in ("tip_alteration", "tip_diameter", "addendum"))
    ]
    alteration = pair.tip_alteration
    if unwritten and abs(alteration) > _SMALL * pair.basic_rack.module:
        fields = " and ".join(f"{name}.tip_alteration" for name in unwritten)
        value = to_file(alteration, "mm")
        yield f"tips are not altered; to keep the clearance takes {fields} = {value:.4g} mm"


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except OSError:  # such as a name that is too long
        return False
