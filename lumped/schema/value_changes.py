"""Other values in fields that a pair has already, without a new check of the whole pair.

Samples of uncertain inputs, speeds and torques change numbers in fields that have numbers. Then most of a
pair stays as it is: only the changed values are read, and only the rules of the sections around them are
checked. `value_changes` says whether a request is of this kind. Every other request, and every value that is
refused, goes through the plain data of the whole pair (``lumped.schema.changes.changed``).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np

from lumped.errors import ParameterError
from lumped.fields.section import OneOf, Section
from lumped.fields.units import Quantity
from lumped.schema.assumed import inside_any, within
from lumped.schema.changes import BY_THE_USER, alternatives_of, reads

#: Sections in which a value decides the default of another field.
_DECIDES_DEFAULTS = ("basic_rack", "mesh.stiffness")


@dataclass(frozen=True, eq=False)
class ValueChanges:
    """Other values in fields of a pair.

    Attributes
    ----------
    sections : field of the pair -> the changed section, or the changed number
    sources : the table ``sources`` of the changed pair
    outdated : paths whose assumed values no longer hold
    """

    sections: dict[str, Any]
    sources: tuple[tuple[str, str], ...]
    outdated: tuple[str, ...]


def value_changes(pair: Section, changes: Mapping[str, Any]) -> ValueChanges | None:
    """Return what changes of the fields of a pair do, where they change values alone.

    None: the whole pair must be read again. This is so where a change adds or removes a section, where a
    value decides a default, and where a value or its section is refused, as a field beside an alternative.

    Parameters
    ----------
    pair : the gear pair
    changes : field path -> value as a parameter file states it
    """
    tree: dict[str, Any] = {}
    outdated: list[str] = []
    varied: list[str] = []
    assumed: Mapping[str, object] = pair.__dict__["assumed"]
    try:
        for path, request in changes.items():
            value = request.item() if isinstance(request, np.generic) else request
            field = _field(path)
            marker = None if value is None else _marker(pair, field)
            if marker is None:
                return None
            if path not in assumed and reads(pair, path, value):
                continue
            if isinstance(marker, Quantity):
                value = marker.parse(value)
            elif value not in marker.names:
                return None
            node = tree
            for part in field.parents:
                node = node.setdefault(part, {})
            node[field.name] = value
            varied.append(path)
            outdated += field.outdated
        sections = {name: _with(pair.__dict__[name], inside) for name, inside in tree.items()}
    except ParameterError:
        return None
    sources = dict(pair.__dict__["sources"])
    for one in inside_any(sources, outdated):
        del sources[one]
    sources |= dict.fromkeys(varied, BY_THE_USER)
    return ValueChanges(sections, tuple(sorted(sources.items())), tuple(outdated))


@dataclass(frozen=True, eq=False)
class _Field:
    """A path of a field, taken apart.

    Attributes
    ----------
    parents, name : sections around the field, and its name in them
    outdated : paths whose source, and whose assumed value, no longer hold where the field is changed
    decides : whether the value decides the default of another field
    """

    parents: tuple[str, ...]
    name: str
    outdated: tuple[str, ...]
    decides: bool


@lru_cache(maxsize=1024)  # every variation of a pair has the same paths
def _field(path: str) -> _Field:
    *parents, name = path.split(".")
    alternatives = [one for group in alternatives_of(path) for one in group]
    decides = any(within(path, one) for one in _DECIDES_DEFAULTS)
    return _Field(tuple(parents), name, (path, *alternatives), decides)


def _marker(pair: Section, field: _Field) -> Quantity | OneOf | None:
    """How the value of a field is read. None: the field may not be changed alone."""
    section = _at(pair, field.parents)
    if field.decides or not isinstance(section, Section) or field.name in section.derived_fields:
        return None
    return _reader(type(section), field.name)


def _at(pair: Section, parts: tuple[str, ...]) -> Any:
    """What stands at a place in sections and tuples of sections; None: there is nothing."""
    node: Any = pair
    for part in parts:
        if isinstance(node, Section):
            node = node.__dict__.get(part)
        elif isinstance(node, tuple) and part in map(str, range(len(node))):
            node = node[int(part)]
        else:
            return None
    return node


@lru_cache(maxsize=1024)
def _reader(section: type[Section], name: str) -> Quantity | OneOf | None:
    """What alone reads the value of a field; None: a rule of its own, or no field."""
    info = section.model_fields.get(name)
    if info is None or len(info.metadata) != 1:
        return None
    marker = info.metadata[0]
    alone = type(marker) is Quantity or (isinstance(marker, OneOf) and info.annotation is str)
    return marker if alone else None


def _with(node: Any, inside: Any) -> Any:
    """A section with other values, checked by its own rules; ``inside``: its fields, or the value itself."""
    if isinstance(node, tuple):
        return tuple(_with(one, inside[str(n)]) if str(n) in inside else one for n, one in enumerate(node))
    if not isinstance(node, Section):
        return inside
    return node.with_values({name: _with(node.__dict__[name], one) for name, one in inside.items()})
