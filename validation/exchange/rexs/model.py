"""A REXS model: components with attributes, and relations between them.

One tree serves both encodings: the JSON document of the specification, as nested mappings and lists.
``model_of`` checks such a tree and gives the records that the import asks.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from lumped.errors import ParameterError, refuse, shown

#: The JSON document of REXS: a mapping with the one key "model".
Document = dict[str, Any]
#: Keys of an attribute whose value is one number, text or flag.
_SCALARS = (
    "floating_point", "integer", "boolean", "enum", "string", "reference_component", "file_reference",
    "date_time",
)  # fmt: skip


class Attribute(NamedTuple):
    """One attribute: its value as the file has it, None for a table; its unit, "" where it is left out."""

    value: str | int | float | bool | None
    unit: str = ""


@dataclass(frozen=True)
class Component:
    """One component: a machine element or a part of one."""

    id: int
    type: str
    name: str = ""
    attributes: dict[str, Attribute] = field(default_factory=dict)

    @property
    def label(self) -> str:
        """What messages and sources call it."""
        return f"{self.type} {self.id}"


@dataclass(frozen=True)
class RexsModel:
    """A REXS model.

    Attributes
    ----------
    file : name of the file, for sources
    version, application : as the file says
    components : by id, in the order of the file
    relations : (type, ((role, id of a component), ...)), in the order of the file
    load_cases : (id, components with the attributes that hold in it), of the load spectrum
    """

    file: str
    version: str
    application: str
    components: dict[int, Component]
    relations: tuple[tuple[str, tuple[tuple[str, int], ...]], ...]
    load_cases: tuple[tuple[int, tuple[Component, ...]], ...] = ()

    def of_type(self, *types: str) -> list[Component]:
        """Components of some types, in the order of the file."""
        return [c for c in self.components.values() if c.type in types]

    def related(self, component: Component, kind: str, own: str, role: str, *types: str) -> list[Component]:
        """Components that a relation of some kind puts into ``role`` where this one has the role ``own``."""
        partners = [
            self.components[number]
            for relation, refs in self.relations
            if relation == kind and (own, component.id) in refs
            for name, number in refs
            if name == role
        ]
        return [c for c in partners if not types or c.type in types]

    def referenced(self, component: Component, *types: str) -> list[Component]:
        """Components of some types that this one refers to."""
        return self.related(component, "reference", "origin", "referenced", *types)

    def neighbours(self, component: Component, *types: str) -> list[Component]:
        """Components of some types that share any relation with this one, each once."""
        shared = [refs for _, refs in self.relations if any(own == component.id for _, own in refs)]
        numbers = dict.fromkeys(number for refs in shared for _, number in refs)
        return [self.components[i] for i in numbers if self.components[i].type in types]


def model_of(document: Document, file: str) -> RexsModel:
    """Build the model of a tree; refuse one that is not of the form of REXS, its ids and its references."""
    try:
        model = document["model"]
        components = [_component(c) for c in model["components"]]
        relations = [
            (_text(r.get("type")), tuple((_text(ref.get("role")), _id(ref["id"])) for ref in r["refs"]))
            for r in model["relations"]
        ]
        spectra = model.get("load_spectrum") or []
        spectra = spectra if isinstance(spectra, list) else [spectra]
        cases = [case for spectrum in spectra for case in spectrum.get("load_cases") or ()]
        load_cases = [(_id(c["id"]), tuple(map(_component, c["components"]))) for c in cases]
        head = {key: value for key, value in model.items() if isinstance(value, str)}
    except KeyError as error:
        raise broken(file, f"it has no {error} where REXS has one") from None
    except (ValueError, TypeError, AttributeError) as error:
        raise broken(file, f"it is not of the form of REXS: {str(error)[:120]}") from None
    table: dict[int, Component] = {}
    for component in components:
        if table.setdefault(component.id, component) is not component:
            raise broken(file, f"two components have the id {component.id}")
    of_relations = [number for _, refs in relations for _, number in refs]
    for number in [*of_relations, *(c.id for _, case in load_cases for c in case)]:
        if number not in table:
            raise broken(file, f"component {number} is referred to but does not exist")
    application = f"{head.get('applicationId', '')} {head.get('applicationVersion', '')}".strip()
    version = head.get("version", "")
    return RexsModel(file, version, application, table, tuple(relations), tuple(load_cases))


def _component(node: dict[str, Any]) -> Component:
    attributes = {_text(a["id"]): _attribute(a) for a in node.get("attributes") or ()}
    return Component(_id(node["id"]), _text(node.get("type")), _text(node.get("name")), attributes)


def _attribute(node: dict[str, Any]) -> Attribute:
    value = next((node[key] for key in _SCALARS if key in node), None)
    if value is not None and not isinstance(value, (str, int, float, bool)):
        raise ValueError(f"attribute {node['id']!r} has a value that is no scalar")
    return Attribute(value, _text(node.get("unit")))


def _id(value: object) -> int:
    """Whole number; XML has it as text."""
    text = str(value)
    if isinstance(value, (str, int)) and re.fullmatch(r"-?[0-9]{1,19}", text):
        return int(text)
    raise ValueError(f"an id is {text[:40]!r} instead of a whole number")


def _text(value: object) -> str:
    if value is not None and not isinstance(value, str):
        raise ValueError(f"{str(value)[:40]!r} stands where text belongs")
    return value or ""


def broken(file: str, reason: str) -> ParameterError:
    """Build the refusal of a file that is no REXS model."""
    return refuse("REXS file", shown(file), "a REXS model", f"The file is refused: {reason}.")
