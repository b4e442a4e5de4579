"""Refusals of the schema in the user's words: field, value, range and action for each error of pydantic."""

from __future__ import annotations

import difflib
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from types import UnionType
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin

from pydantic import BaseModel, TypeAdapter, ValidationError
from pydantic.fields import FieldInfo

from lumped.arguments import nearest
from lumped.errors import MOST_PROBLEMS, FieldProblem, ParameterError, quoted, shown
from lumped.fields.hints import hint_of
from lumped.fields.scope import about_key, about_teeth
from lumped.fields.section import OneOf
from lumped.fields.units import Quantity

Model = TypeVar("Model", bound=BaseModel)
#: Parts of pydantic's location that name a member of a union of plain types.
_UNION_PARTS = {"int", "float", "str"}
_NO_TABLE = {"model_type", "model_attributes_type", "dict_type"}


def made_of(root: type[Model], data: Mapping[str, Any], source: str, folder: Path = Path()) -> Model:
    """Make a model from plain data in file units, or refuse the data. ``source`` is the origin of the data.

    Data files named in the data are read relative to ``folder``.
    """
    try:
        reader: TypeAdapter[Model] = _reader(root)
        return reader.validate_python(data, context={"folder": folder})
    except ParameterError as error:
        raise ParameterError(list(error.problems), source) from None
    except ValidationError as error:
        raise ParameterError(translated(error, root), source) from None


@cache
def _reader(root: type[Model]) -> TypeAdapter[Model]:
    return TypeAdapter(root)


def translated(error: ValidationError, root: type[BaseModel]) -> list[FieldProblem]:
    """Return one problem for each field that pydantic has refused in the model ``root``."""
    items = error.errors(include_url=False)[:MOST_PROBLEMS]
    result = [problem for item in items for problem in _problems(item, root)]
    first: dict[str, FieldProblem] = {}
    for problem in result:
        first.setdefault(problem.field, problem)
    # A list whose items are refused is also "too short" for pydantic; the items are the reason.
    return [p for path, p in first.items() if not any(other.startswith(f"{path}.") for other in first)]


def field_of(root: type[BaseModel], path: str) -> FieldInfo:
    """Return pydantic's description of a field by dotted path (through every member of a union)."""
    models = [root]
    info: FieldInfo | None = None
    for part in path.split("."):
        if part.isdigit() and info is not None and _is_list(info):
            continue
        names = {name: field for model in models for name, field in model.model_fields.items()}
        if part not in names:
            raise ParameterError([unknown_key(path, list(names), part, root)])
        info = names[part]
        models = models_in(info.annotation)
    assert info is not None  # "".split(".") has one part, which is unknown
    return info


def models_in(annotation: Any) -> list[type[BaseModel]]:
    """Schema sections that a field with this annotation may hold."""
    origin = get_origin(annotation)
    if origin is Annotated:
        return models_in(get_args(annotation)[0])
    if origin in (Union, UnionType, tuple, list):
        return [model for part in get_args(annotation) for model in models_in(part)]
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return []


def _is_list(info: FieldInfo) -> bool:
    return get_origin(info.annotation) in (tuple, list)


def unknown_key(path: str, keys: list[str], part: str, root: type[BaseModel] | None = None) -> FieldProblem:
    """Return the problem of a key ``part`` that the schema does not have beside ``keys``.

    The action names a near key, also a key in a section of ``root``.
    """
    names = list(dict.fromkeys(keys))
    allowed = "one of " + ", ".join(names) if names else "no key below a value"
    below = _below(root, path) if root is not None else ""
    close = nearest(part, names)
    guess = below or close if path == part else close or below  # names of sections are like no field's
    hint = hint_of(part)
    if hint is not None and names and not about_key(part):
        return FieldProblem(shown(path), "unknown key", hint.named(path), hint.sentence)
    action = about_key(part) or guess or "Remove the key, or correct its name."
    return FieldProblem(shown(path) or "(empty)", "unknown key", allowed, action)


def _below(root: type[BaseModel], path: str) -> str:
    """A question with fields of inner sections whose name is near to the last part of a path, or contains it.

    Empty: there is no such field.
    """
    *parents, part = path.split(".")
    paths = [repr(one) for one in fields_named(root, part, parents)]
    return f"Did you mean {' or '.join(paths)}?" if paths else ""


def fields_named(root: type[BaseModel], part: str, parents: Sequence[str] = ()) -> list[str]:
    """Return paths of fields in inner sections whose name is near to a word, or contains the word.

    Parameters
    ----------
    root : model of the whole file
    part : the word
    parents : section in which to look
    """
    fields: dict[str, list[str]] = {}
    owners = [root]
    for parent in parents:
        inside = [one.model_fields[parent] for one in owners if parent in one.model_fields]
        owners = [model for info in inside for model in models_in(info.annotation)]
    for section, info in [item for one in owners for item in one.model_fields.items()]:
        for key in {key: None for model in models_in(info.annotation) for key in model.model_fields}:
            fields.setdefault(key, []).append(".".join((*parents, section, key)))
    keys = [part] if part in fields else [key for key in fields if part in key.split("_")]
    close = keys or difflib.get_close_matches(part[:80], fields, n=1, cutoff=0.8)
    return [path for key in close for path in fields[key]]


def _problems(item: Any, root: type[BaseModel]) -> list[FieldProblem]:
    parts, models = _location(item["loc"], root)
    path = ".".join(parts)
    kind = item["type"]
    context = item.get("ctx", {})
    cause = context.get("error")
    if isinstance(cause, ParameterError):
        return [
            p if p.field.startswith(f"{path}.") else replace(p, field=".".join(filter(None, (path, p.field))))
            for p in cause.problems
        ]
    value = shown(quoted(item.get("input")))
    if kind == "extra_forbidden":
        names = [name for model in models for name in model.model_fields]
        return [unknown_key(path, names, parts[-1], root)]
    if kind == "missing" and parts and parts[-1].isidentifier():
        return [FieldProblem(path, "missing", _description(field_of(root, path)), "Add it.")]
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        request = context.get("tag", "missing")
        tags = [str(tag) for model in models_in(field_of(root, path).annotation) for tag in _tags(model)]
        return [_choice(f"{path}.{context['discriminator'].strip(chr(39))}", request, tags)]
    if kind == "literal_error":
        info = field_of(root, path)
        marker = next((m for m in info.metadata if isinstance(m, OneOf)), None)
        names = list(marker.names) if marker else [str(name) for name in get_args(info.annotation)]
        return [_choice(path, item.get("input"), names)]
    if kind in _NO_TABLE:
        keys = [name for model in models for name in model.model_fields]
        listed = ", ".join(f"{path}.{key}" for key in keys)
        action = f"Set its keys one by one: {listed}." if parts and keys else "Write a section."
        return [FieldProblem(path or "file", value, "a table of keys and values", action)]
    if kind == "string_too_short":
        return [FieldProblem(path, value, "text that is not empty", "Write it.")]
    if parts and not models and field_of(root, path).annotation is int:
        point = isinstance(item.get("input"), float)
        action = "Write it without a point." if point else "Write a whole number in that range."
        if parts[-1] == "teeth":
            action = about_teeth(quoted(item.get("input"))) or action
        return [FieldProblem(path, value, _whole_number(field_of(root, path)), action)]
    allowed = item["msg"]
    if kind == "tuple_type":
        keys = [f"{name} = ..." for model in models[:1] for name in model.model_fields]
        allowed = f"a list of tables such as [{{ {', '.join(keys[:3])} }}]" if models else "a list"
    if count := re.fullmatch(r"Tuple should have (at \w+ \d+ items?) after validation, not (\d+)", allowed):
        allowed_count, actual_count = count.groups()
        allowed = f"{allowed_count} instead of {actual_count}"
    for start in ("Input should be ", "Value should be ", "Input should ", "Value should "):
        allowed = allowed.removeprefix(start)
    return [FieldProblem(path or "file", value, allowed, "Correct the value.")]


def _location(
    location: tuple[int | str, ...], root: type[BaseModel]
) -> tuple[list[str], list[type[BaseModel]]]:
    """Path of pydantic's location without union tags and tuple indices, and the sections at its end."""
    models = [root]
    parts: list[str] = []
    listed = False
    for item in location:
        part = str(item)
        tagged = [model for model in models if len(models) > 1 and part in _tags(model)]
        if tagged:
            models = tagged
            continue
        owner = [model for model in models if part in model.model_fields]
        index = listed and part.isdigit()
        if not owner and parts and (not models or part in _UNION_PARTS or "[" in part) and not index:
            continue  # an index into numbers or a member of a union: the field itself is named
        parts.append(part)
        if owner:
            models = [m for model in owner for m in models_in(model.model_fields[part].annotation)]
        listed = any(_is_list(model.model_fields[part]) for model in owner) and bool(models)
    return parts, models


def _tags(model: type[BaseModel]) -> tuple[Any, ...]:
    """Values of ``model`` or ``kind`` in a file that choose a member of a union, or the member's ``tag``."""
    if tag := getattr(model, "tag", None):
        return (tag,)
    info = model.model_fields.get("model") or model.model_fields.get("kind")
    return get_args(info.annotation) if info and get_origin(info.annotation) is Literal else ()


def _choice(path: str, value: object, names: list[str]) -> FieldProblem:
    action = nearest(str(value), names) or "Choose one of them."
    return FieldProblem(path, shown(value), "one of " + ", ".join(names), action)


def _whole_number(info: FieldInfo) -> str:
    limits = {type(marker).__name__: marker for marker in info.metadata}
    low = getattr(limits.get("Ge"), "ge", "-inf")
    high = getattr(limits.get("Le"), "le", "inf")
    return f"a whole number from {low} to {high}"


def _description(info: FieldInfo) -> str:
    quantity = next((m for m in info.metadata if isinstance(m, Quantity)), None)
    text = info.description or "a section of the parameter file"
    return f"{quantity.allowed} ({text})" if quantity else text
