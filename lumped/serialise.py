"""Reading and writing the schema: files and mappings in, plain data out, refusals in the user's words."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from lumped.errors import FieldProblem, ParameterError, shown
from lumped.parameters import STORED_AS, GearPair
from lumped.schema_errors import field_at, nearest, translated, unknown_key
from lumped.text_file import parse_toml, read_text
from lumped.units import Quantity, to_file, to_stated

#: Largest parameter file read, a bound against a wrong path rather than a limit of the format.
MAX_FILE_BYTES = 1_000_000
_ALTERNATIVES = (
    ("basic_rack.module", "basic_rack.diametral_pitch"),
    ("pinion.addendum", "pinion.tip_diameter"),
    ("gear.addendum", "gear.tip_diameter"),
    ("lubricant.viscosity", "lubricant.viscosity_law"),
)


@cache
def preset_names() -> tuple[str, ...]:
    """Return the names of the built-in gear pairs."""
    folder = resources.files("lumped") / "presets"
    return tuple(sorted(f.name.removesuffix(".toml") for f in folder.iterdir() if f.name.endswith(".toml")))


def preset_text(name: str) -> str:
    """Return the TOML text of a built-in gear pair.

    Raises
    ------
    ParameterError : unknown name; the nearest one is suggested
    """
    if name not in preset_names():
        raise ParameterError(
            [
                FieldProblem(
                    "preset",
                    shown(repr(name)),
                    "a file that exists or one of " + ", ".join(preset_names()),
                    nearest(name, preset_names()) or "Check the path, or see 'spurcheck presets'.",
                )
            ]
        )
    return (resources.files("lumped") / "presets" / f"{name}.toml").read_text(encoding="utf-8")


def load_gear_pair(source: str | Path | Mapping[str, Any] | GearPair) -> GearPair:
    """Read a gear pair from a preset name, a TOML file or a mapping, and validate it.

    Parameters
    ----------
    source : preset name, path of a TOML file, nested mapping in file units, or a GearPair (returned as is)

    Raises
    ------
    ParameterError : everything that is refused, with field, value, allowed range and next action
    """
    if isinstance(source, GearPair):
        return source
    if isinstance(source, Mapping):
        return _validated(dict(source), "mapping")
    if not isinstance(source, (str, Path)):
        allowed = "a preset name, a TOML file, a mapping or a GearPair"
        raise ParameterError([FieldProblem("pair", shown(source), allowed, "Give one of these.")])
    path = Path(source)
    if isinstance(source, str) and source in preset_names():
        return _validated(_parsed(preset_text(source), f"preset {source}"), f"preset {source}")
    if path.suffix.lower() != ".toml" and not _exists(path) and "/" not in str(source):
        preset_text(str(source))
    return _validated(_parsed(_read(path), str(path)), str(path), path.parent)


def to_mapping(pair: GearPair) -> dict[str, Any]:
    """Return a gear pair as nested plain data in file units; defaults that are None are left out."""
    return _plain(pair)


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema of a parameter file; every quantity carries ``unit`` and ``si_unit``.

    A default is what the file would say: a bare number in the stated unit.
    """
    schema = GearPair.model_json_schema()
    for section in (schema, *schema["$defs"].values()):
        for field in section["properties"].values():
            default = field.get("default")
            if default in (None, []):  # held so inside, but nothing that a file can say
                field.pop("default", None)
            elif "unit" in field and not isinstance(default, str):
                field["default"] = to_stated(default, field["unit"])
    return schema


def leaf_paths(pair: GearPair) -> dict[str, Any]:
    """Return every set field of a pair as dotted path -> value in file units, ``sources`` apart."""
    found: dict[str, Any] = {}

    def walk(data: Mapping[str, Any], prefix: str) -> None:
        for key, value in data.items():
            path = f"{prefix}{key}"
            if isinstance(value, Mapping):
                walk(value, f"{path}.")
            else:
                found[path] = value

    walk({k: v for k, v in to_mapping(pair).items() if k != "sources"}, "")
    return found


def varied(pair: GearPair, changes: Mapping[str, Any]) -> GearPair:
    """Return a validated variation of a pair; see ``GearPair.with_``."""
    data = copy.deepcopy(to_mapping(pair))
    sources: dict[str, str] = data.setdefault("sources", {})
    for path, value in changes.items():
        outdated = [path]
        for group in _ALTERNATIVES:
            if path in group and value is not None:
                outdated += group
                for other in group:
                    _assign(data, other, None)
        _assign(data, path, value)
        for known in [key for key in sources if any(key == p or key.startswith(f"{p}.") for p in outdated)]:
            del sources[known]
        if path not in ("name", "description", "sources") and value is not None:
            sources[STORED_AS.get(path, path)] = "varied by the user"
    return _validated(data, f"{pair.name} varied")


def _assign(data: dict[str, Any], path: str, value: Any) -> None:
    *parents, leaf = path.split(".")
    node = data
    for part in parents:
        inner = node.setdefault(part, {})
        if not isinstance(inner, dict):
            raise ParameterError([unknown_key(path, list(node), part)])
        node = inner
    if value is None:
        if path not in STORED_AS:
            field_at(path)  # a name that does not exist is an error also where nothing is set
        node.pop(leaf, None)
    else:
        node[leaf] = _plain(value) if isinstance(value, BaseModel) else copy.deepcopy(value)


def _plain(model: BaseModel) -> dict[str, Any]:
    result: dict[str, Any] = {}
    for name, info in type(model).model_fields.items():
        value = getattr(model, name)
        if value is None:
            continue
        quantity = next((m for m in info.metadata if isinstance(m, Quantity)), None)
        if isinstance(value, BaseModel):
            result[name] = _plain(value)
        elif quantity is not None:
            result[name] = to_file(value, quantity.unit)
        elif name == "sources":
            if value:
                result[name] = dict(value)
        elif isinstance(value, tuple):
            result[name] = list(value)
        else:
            result[name] = value
    return result


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except OSError:  # such as a name that is too long
        return False


def _read(path: Path) -> str:
    try:
        return read_text(path, MAX_FILE_BYTES)
    except FileNotFoundError:
        raise ParameterError(
            [
                FieldProblem(
                    "file",
                    shown(str(path)),
                    "a TOML file that exists, or a preset: " + ", ".join(preset_names()),
                    "Check the path, or start from 'spurcheck init'.",
                )
            ]
        ) from None
    except (OSError, UnicodeDecodeError, ValueError) as error:
        if isinstance(error, ParameterError):
            raise
        raise ParameterError(
            [
                FieldProblem(
                    "file",
                    shown(str(path)),
                    "a readable UTF-8 TOML file",
                    f"It cannot be read: {getattr(error, 'strerror', None) or error}.",
                )
            ]
        ) from None


def _parsed(text: str, source: str) -> dict[str, Any]:
    try:
        return parse_toml(text)
    except (RecursionError, ValueError) as error:
        raise ParameterError(
            [FieldProblem("file", source, "well-formed TOML", f"The TOML is malformed: {error}.")]
        ) from None


def _validated(data: Mapping[str, Any], source: str, folder: Path = Path()) -> GearPair:
    """Validate; data files that the parameters name are read relative to ``folder``."""
    try:
        return GearPair.model_validate(data, context={"folder": folder})
    except ParameterError as error:
        raise ParameterError(list(error.problems), error.source or source) from None
    except ValidationError as error:
        raise ParameterError(translated(error, data), source) from None
