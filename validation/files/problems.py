"""Refusals of study and record files in the user's words: field, value, what is allowed, next action."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from lumped.errors import MOST_PROBLEMS, FieldProblem, ParameterError, quoted, shown
from lumped.fields.refusals import unknown_key

#: What pydantic puts into a place for the parts of a union.
_UNION_PARTS = {"int", "float", "str", "function-before[_pair_in(), GearPair]"}


def translated(error: ValidationError, root: type[BaseModel]) -> list[FieldProblem]:
    """Return pydantic's findings as the tool's own; the parts of a union are one finding.

    Parameters
    ----------
    error : what pydantic raised
    root : the model that was validated
    """
    problems: dict[str, FieldProblem] = {}
    for item in error.errors(include_url=False)[:MOST_PROBLEMS]:
        location = [str(part) for part in item["loc"] if str(part) not in _UNION_PARTS]
        path = ".".join(location) or "file"
        context = item.get("ctx", {})
        cause = context.get("error")
        if isinstance(cause, ParameterError):
            prefix = f"{path}." if location else ""
            for p in cause.problems:
                problems[prefix + p.field] = FieldProblem(prefix + p.field, p.value, p.allowed, p.action)
        elif item["type"] == "quantity":
            problems[path] = FieldProblem(path, context["value"], context["allowed"], context["action"])
        elif item["type"] == "extra_forbidden":
            problems[path] = unknown_key(path, list(_fields(root, location)), location[-1])
        elif item["type"] == "missing":
            problems[path] = FieldProblem(path, "missing", _description(root, location), "Add it.")
        else:
            problems.setdefault(
                path,
                FieldProblem(
                    path, shown(quoted(item.get("input"))), _plainly(item["msg"]), "Correct the value."
                ),
            )
    # A list whose items are refused is also "too short" for pydantic; the items are the reason.
    return [p for path, p in problems.items() if not any(other.startswith(f"{path}.") for other in problems)]


def _plainly(message: str) -> str:
    """Return pydantic's rule as what is allowed."""
    if found := re.fullmatch(r"Tuple should have (at \w+ \d+ items?) after validation, not (\d+)", message):
        return f"{found[1]} instead of {found[2]}"
    for start in ("Input should be ", "Value should be ", "Input should ", "Value should "):
        message = message.removeprefix(start)
    return message


def _fields(root: type[BaseModel], location: list[str]) -> Mapping[str, FieldInfo]:
    """Fields of the section that a place is in."""
    fields: Mapping[str, FieldInfo] = root.model_fields
    for part in location[:-1]:
        if part in fields:
            section = _section(fields[part].annotation)
            fields = section.model_fields if section is not None else {}
    return fields


def _section(annotation: Any) -> type[BaseModel] | None:
    """Return the section that a field holds, by itself or in a list."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((found for part in get_args(annotation) if (found := _section(part)) is not None), None)


def _description(root: type[BaseModel], location: list[str]) -> str:
    info = _fields(root, location).get(location[-1])
    return (info.description if info else None) or "a value"
