"""A REXS model as plain records: components with attributes, relations between them, load cases."""

from __future__ import annotations

from dataclasses import dataclass, field

from lumped.errors import ParameterError, refuse, shown

Scalar = str | int | float | bool


@dataclass(frozen=True)
class Attribute:
    """One attribute: its value as the file has it, and its unit.

    Attributes
    ----------
    value : text (XML) or number, text, flag (JSON); a tuple of numbers when written; None for a table or for
        an attribute without a value
    unit : REXS unit, "" where the file leaves it out
    """

    value: Scalar | tuple[float, ...] | None
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
class Relation:
    """One relation: which components play which roles."""

    type: str
    refs: tuple[tuple[str, int], ...]
    order: int | None = None

    def all(self, role: str) -> tuple[int, ...]:
        """Component ids in a role."""
        return tuple(component for name, component in self.refs if name == role)


@dataclass(frozen=True)
class LoadCase:
    """One load case: attributes of components that hold in it."""

    id: int
    components: tuple[Component, ...]


@dataclass(frozen=True)
class RexsModel:
    """A REXS model.

    Attributes
    ----------
    file : name of the file, for sources
    version, application : as the file says
    components : by id, in the order of the file
    relations : in the order of the file
    load_cases : of the load spectrum
    """

    file: str
    version: str
    application: str
    components: dict[int, Component]
    relations: tuple[Relation, ...]
    load_cases: tuple[LoadCase, ...] = ()

    def of_type(self, *types: str) -> list[Component]:
        """Components of some types, in the order of the file."""
        return [c for c in self.components.values() if c.type in types]

    def related(
        self, component: Component, kind: str, own_role: str, role: str, *types: str
    ) -> list[Component]:
        """Components that a relation of some kind puts into ``role`` where this one is in ``own_role``."""
        found = []
        for relation in self.relations:
            if relation.type == kind and component.id in relation.all(own_role):
                partners = [self.components[i] for i in relation.all(role)]
                found += [c for c in partners if not types or c.type in types]
        return found

    def together(self, component: Component, *types: str) -> list[Component]:
        """Components of some types that share any relation with this one, each once."""
        found: dict[int, Component] = {}
        for relation in self.relations:
            ids = [i for _, i in relation.refs]
            if component.id in ids:
                found |= {i: self.components[i] for i in ids if self.components[i].type in types}
        return list(found.values())


def assembled(
    file: str,
    head: dict[str, str],
    components: list[Component],
    relations: list[Relation],
    load_cases: list[LoadCase],
) -> RexsModel:
    """Put a model together after checking what the schema demands: unique ids, and references that exist.

    Raises
    ------
    ParameterError : it does not
    """
    table: dict[int, Component] = {}
    for component in components:
        if component.id in table:
            raise broken(file, f"two components have the id {component.id}")
        table[component.id] = component
    of_relations = [number for relation in relations for _, number in relation.refs]
    for number in [*of_relations, *(component.id for case in load_cases for component in case.components)]:
        if number not in table:
            raise broken(file, f"component {number} is referred to but does not exist")
    version = head.get("version", "")
    application = f"{head.get('applicationId', '')} {head.get('applicationVersion', '')}".strip()
    return RexsModel(file, version, application, table, tuple(relations), tuple(load_cases))


def broken(file: str, reason: str) -> ParameterError:
    """Build the refusal of a file that is no REXS model."""
    action = f"The file is refused: {reason}."
    return refuse("REXS file", shown(file), "a REXS model", action)
