"""Assumed values of a pair: the record of the table ``[assumed]`` in a parameter file.

A field is assumed where the table has the path of the field with the present value of the field. A field
without an entry in the table is known. A field whose value was changed since the table was written is known
too. Text in ``[sources]`` decides nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from enum import Enum
from functools import lru_cache
from typing import Annotated, Any

from pydantic import PlainSerializer, PlainValidator

from lumped.errors import FieldProblem, ParameterError, refuse, shown
from lumped.fields.refusals import field_of, models_in
from lumped.fields.section import Section
from lumped.fields.units import Quantity, to_file, to_si

#: A value of a parameter file. A list is a tuple here.
Value = float | int | bool | str | tuple[Any, ...]
#: Tables of a pair about fields. These tables are no values of the pair.
ABOUT = ("sources", "assumed", "uncertainty", "posterior")
#: Fields that are words for the reader.
WORDS = ("name", "description")


class State(Enum):
    """Whether a value is known or assumed. The value of a member is the word for the reader."""

    KNOWN = "known"
    ASSUMED = "assumed"


class Assumed(Mapping[str, Value]):
    """Field path -> assumed value in file units, in the order of the paths. Frozen and hashable."""

    __slots__ = ("_hash", "_values")

    def __init__(self, values: Mapping[str, Value] | None = None) -> None:
        self._values: dict[str, Value] = dict(sorted((values or {}).items()))
        self._hash = hash(tuple(self._values.items()))

    def __getitem__(self, path: str) -> Value:
        """Return the assumed value of a field."""
        return self._values[path]

    def __iter__(self) -> Iterator[str]:
        """Iterate over the paths of the fields."""
        return iter(self._values)

    def __len__(self) -> int:
        """Return the number of fields."""
        return len(self._values)

    def __hash__(self) -> int:
        """Return the hash: pairs are keys of caches."""
        return self._hash

    def __repr__(self) -> str:
        """Return the record as the text of a dictionary."""
        return repr(self._values)

    def without(self, *paths: str) -> Assumed:
        """Return the record without the fields and sections ``paths``."""
        gone = set(inside_any(self, paths))
        return Assumed({path: one for path, one in self.items() if path not in gone}) if gone else self

    def to_mapping(self) -> dict[str, Any]:
        """Return plain data for a file."""
        return {path: list(one) if isinstance(one, tuple) else one for path, one in self.items()}


def within(path: str, section: str) -> bool:
    """Whether a path is the path of a field or section, or of a field inside the section."""
    return path == section or path.startswith(f"{section}.")


def inside_any(paths: Iterable[str], sections: Sequence[str]) -> list[str]:
    """Return the paths that are ``within`` any of the fields or sections."""
    exact = frozenset(sections)
    starts = tuple(f"{section}." for section in sections)
    return [path for path in paths if path in exact or path.startswith(starts)]


def _parsed(table: object) -> Assumed:
    """The record of a table. Keys without quotation marks make tables inside the table: they are joined."""
    if isinstance(table, Assumed):
        return table
    if not isinstance(table, Mapping):
        allowed = "a table: path of a field = the value that is assumed"
        raise refuse("", shown(table), allowed, 'For example [assumed] with "mesh.backlash" = 0.1.')
    values: dict[str, Value] = {}

    def walk(inside: Mapping[Any, Any], prefix: str) -> None:
        for key, value in inside.items():
            if isinstance(value, Mapping):
                walk(value, f"{prefix}{key}.")
            else:
                values[f"{prefix}{key}"] = _frozen(value)

    walk(table, "")
    return Assumed(values)


def _frozen(value: Any) -> Any:
    return tuple(map(_frozen, value)) if isinstance(value, (list, tuple)) else value


#: The field ``assumed`` of a pair.
AssumedTable = Annotated[
    Assumed,
    PlainValidator(
        _parsed, json_schema_input_type=dict[str, float | bool | str | list[float | str | list[float]]]
    ),
    PlainSerializer(Assumed.to_mapping, return_type=dict[str, Any]),
]


def problems_of(root: type[Section], written: Assumed) -> Iterator[FieldProblem]:
    """Problems of entries with a path of no field of ``root``, or with a value that the field cannot have."""
    for path, value in written.items():
        field = f"assumed.{path}"
        try:
            unit, allowed = _kind(root, path)
        except ParameterError as error:
            yield FieldProblem(field, "unknown key", error.problems[0].allowed, error.problems[0].action)
            continue
        if unit is not None and not isinstance(value, tuple) and _si(value, unit) is None:
            word = isinstance(value, str) and not any(sign.isdigit() for sign in value)
            if not (word and f"'{value}'" in allowed):
                action = "Write the value that the field has, or delete the line: then the field is known."
                yield FieldProblem(field, shown(repr(value)), allowed, action)


@lru_cache(maxsize=1024)
def _kind(root: type[Section], path: str) -> tuple[str | None, str]:
    """Unit of a field, and allowed values as text. A section is refused."""
    info = field_of(root, path)
    if path.split(".")[0] in (*ABOUT, *WORDS):
        raise refuse(path, "unknown key", "a field with a value", "Delete the line.")
    if inside := models_in(info.annotation):
        names = ", ".join(f"{path}.{name}" for name in inside[0].model_fields)
        raise refuse(path, "unknown key", "a field with a value", f"Name its fields: {names}.")
    marker = next((m for m in info.metadata if isinstance(m, Quantity)), None)
    return (marker.unit, marker.allowed) if marker else (None, "")


def recorded(pair: Section, written: Assumed, derived: Mapping[str, Value]) -> Assumed:
    """The record of a pair: entries of the written table that are still valid, and defaults.

    An entry is valid where the field still has the value of the entry. A field that is not in the file is
    assumed at the default of the schema. ``derived`` has the defaults that follow from other fields.
    """
    defaults = dict(_defaults_taken(pair, ""))
    values = {path: _value_at(pair, path) for path in (*written, *defaults)}
    root = type(pair)
    return Assumed(
        {
            path: value
            for path, value in values.items()
            if value is not None and (path in defaults or _same(root, path, written[path], value))
        }
        | dict(derived)
    )


def _defaults_taken(section: Section, prefix: str) -> Iterator[tuple[str, None]]:
    """Paths of all fields of a section, and of the sections inside, without a value from file or caller."""
    for name in type(section).model_fields:
        path = f"{prefix}{name}"
        value = getattr(section, name)
        if path in ABOUT or path in WORDS:
            continue
        if isinstance(value, Section):
            yield from _defaults_taken(value, f"{path}.")
        elif isinstance(value, tuple) and value and isinstance(value[0], Section):
            for number, one in enumerate(value):
                yield from _defaults_taken(one, f"{path}.{number}.")
        elif name not in section.model_fields_set and value not in (None, ()):
            yield path, None


def _value_at(pair: Section, path: str) -> Value | None:
    """Value of a field in file units; None: the pair has no value for the field."""
    *parents, leaf = path.split(".")
    node: Any = pair
    for part in parents:
        if isinstance(node, tuple):
            node = node[int(part)] if part.isdigit() and int(part) < len(node) else None
        else:
            node = (
                getattr(node, part) if isinstance(node, Section) and part in type(node).model_fields else None
            )
    if not isinstance(node, Section) or leaf not in type(node).model_fields:
        return None
    value = getattr(node, leaf)
    if value is None or isinstance(value, Section):
        return None
    unit = _kind(type(pair), path)[0]
    if isinstance(value, tuple):
        return tuple(_in_file(one, unit) for one in value)
    one: Value = _in_file(value, unit)
    return one


def _in_file(value: Any, unit: str | None) -> Any:
    return value if unit is None or isinstance(value, str) else to_file(value, unit)


def _same(root: type[Section], path: str, written: Value, value: Value) -> bool:
    """Whether a value in the table equals the value of the field."""
    if written == value:
        return type(written) is not bool or type(value) is bool
    unit = _kind(root, path)[0]
    if unit is None:
        return False
    if isinstance(written, tuple) and isinstance(value, tuple):
        return [_si(one, unit) for one in written] == [_si(one, unit) for one in value]
    number = _si(written, unit)
    return number is not None and number == _si(value, unit)


def _si(value: object, unit: str) -> float | None:
    """A number or a text with a unit, in SI; None for anything else."""
    if isinstance(value, bool) or not isinstance(value, (int, float, str)):
        return None
    try:
        return to_si(value, unit)
    except (ValueError, OverflowError):
        return None
