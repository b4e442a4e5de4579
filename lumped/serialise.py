"""Reading and writing the schema: files and mappings in, plain data out, refusals in the user's words."""

from __future__ import annotations

import copy
import difflib
import tomllib
from collections.abc import Mapping
from functools import cache
from importlib import resources
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from lumped.errors import FieldProblem, ParameterError
from lumped.parameters import GearPair
from lumped.units import Quantity, to_file

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
                    repr(name),
                    "a file that exists or one of " + ", ".join(preset_names()),
                    _nearest(name, preset_names()) or "Check the path, or see 'spurcheck presets'.",
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
    path = Path(source)
    if isinstance(source, str) and source in preset_names():
        return _validated(_parsed(preset_text(source), f"preset {source}"), f"preset {source}")
    if path.suffix.lower() != ".toml" and not path.exists() and "/" not in str(source):
        preset_text(str(source))
    return _validated(_parsed(_read(path), str(path)), str(path), path.parent)


def to_mapping(pair: GearPair) -> dict[str, Any]:
    """Return a gear pair as nested plain data in file units; defaults that are None are left out."""
    return _plain(pair)


def json_schema() -> dict[str, Any]:
    """Return the JSON Schema of a parameter file; every quantity carries ``unit`` and ``si_unit``."""
    return GearPair.model_json_schema()


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
        for group in _ALTERNATIVES:
            if path in group and value is not None:
                for other in group:
                    _assign(data, other, None)
        _assign(data, path, value)
        for known in [key for key in sources if key == path or key.startswith(f"{path}.")]:
            del sources[known]
        if path not in ("name", "description", "sources") and value is not None:
            sources[path] = "varied by the user"
    return _validated(data, f"{pair.name} varied")


def field_at(path: str) -> FieldInfo:
    """Return pydantic's description of a field by dotted path (through every member of a union).

    Raises
    ------
    ParameterError : no such field; the nearest is suggested
    """
    models: list[type[BaseModel]] = [GearPair]
    info: FieldInfo | None = None
    for part in path.split("."):
        names = {name: field for model in models for name, field in model.model_fields.items()}
        if part not in names:
            raise ParameterError([_unknown(path, list(names), part)])
        info = names[part]
        models = _models_in(info.annotation)
    assert info is not None  # "".split(".") has one part, which is unknown
    return info


def _models_in(annotation: Any) -> list[type[BaseModel]]:
    origin = get_origin(annotation)
    if origin is Annotated:
        return _models_in(get_args(annotation)[0])
    if origin in (Union, UnionType):
        return [model for part in get_args(annotation) for model in _models_in(part)]
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return []


def _assign(data: dict[str, Any], path: str, value: Any) -> None:
    *parents, leaf = path.split(".")
    node = data
    for part in parents:
        inner = node.setdefault(part, {})
        if not isinstance(inner, dict):
            raise ParameterError([_unknown(path, list(node), part)])
        node = inner
    if value is None:
        node.pop(leaf, None)
    else:
        node[leaf] = _plain(value) if isinstance(value, BaseModel) else value


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


def _read(path: Path) -> str:
    try:
        if path.stat().st_size > MAX_FILE_BYTES:
            raise ParameterError(
                [FieldProblem("file", str(path), f"<= {MAX_FILE_BYTES} bytes", "Is this a parameter file?")]
            )
        return path.read_text(encoding="utf-8")
    except FileNotFoundError:
        raise ParameterError(
            [
                FieldProblem(
                    "file",
                    str(path),
                    "a TOML file that exists, or a preset: " + ", ".join(preset_names()),
                    "Check the path, or start from 'spurcheck init'.",
                )
            ]
        ) from None
    except (OSError, UnicodeDecodeError, ValueError) as error:
        if isinstance(error, ParameterError):
            raise
        raise ParameterError(
            [FieldProblem("file", str(path), "a readable UTF-8 TOML file", f"It cannot be read: {error}.")]
        ) from None


def _parsed(text: str, source: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError, ValueError) as error:
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
        raise ParameterError(_translated(error, data), source) from None


def _translated(error: ValidationError, data: Mapping[str, Any]) -> list[FieldProblem]:
    problems: list[FieldProblem] = []
    for item in error.errors(include_url=False):
        location = [str(p) for p in item["loc"] if str(p) not in _UNION_TAGS]
        path = ".".join(location) or "file"
        context = item.get("ctx", {})
        cause = context.get("error")
        if isinstance(cause, ParameterError):
            prefix = f"{path}." if location else ""
            problems += [
                FieldProblem(f"{prefix}{p.field}" if not p.field.startswith(prefix) else p.field, *_rest(p))
                for p in cause.problems
            ]
        elif item["type"] == "quantity":
            problems.append(FieldProblem(path, context["value"], context["allowed"], context["action"]))
        elif item["type"] == "extra_forbidden":
            problems.append(_unknown(path, _siblings(location), location[-1]))
        elif item["type"] == "missing":
            problems.append(
                FieldProblem(path, "missing", _description(path), "Add it to the parameter file.")
            )
        else:
            problems.append(FieldProblem(path, repr(item.get("input")), item["msg"], "Correct the value."))
    return problems


_UNION_TAGS = {"rectangular", "parabolic", "energy", "table"}


def _rest(problem: FieldProblem) -> tuple[str, str, str]:
    return problem.value, problem.allowed, problem.action


def _siblings(location: list[str]) -> list[str]:
    models: list[type[BaseModel]] = [GearPair]
    if len(location) > 1:
        models = _models_in(field_at(".".join(location[:-1])).annotation)
    return [name for model in models for name in model.model_fields]


def _description(path: str) -> str:
    info = field_at(path)
    quantity = next((m for m in info.metadata if isinstance(m, Quantity)), None)
    text = info.description or "a section of the parameter file"
    return f"{quantity.allowed} ({text})" if quantity else text


def _nearest(name: str, known: tuple[str, ...] | list[str]) -> str:
    close = difflib.get_close_matches(name, known, n=1, cutoff=0.5)
    return f"Did you mean '{close[0]}'?" if close else ""


def _unknown(path: str, known: list[str], part: str) -> FieldProblem:
    action = _nearest(part, known) or "Remove the key, or correct its name."
    return FieldProblem(path, "unknown key", "one of " + ", ".join(known), action)
