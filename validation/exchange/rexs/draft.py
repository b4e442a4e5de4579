"""Draft of a pair while a REXS file is read: values, sources of the values, notes and problems."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from lumped.errors import FieldProblem, shown
from lumped.fields.units import to_file, to_si
from lumped.schema.pair import stated_unit
from validation.exchange.new_pair_file import GIVEN
from validation.exchange.rexs.model import ATTRIBUTES, Component, RexsModel, si_from_rexs

#: Range of sensible numbers. Numbers outside are no measure of a gear in any unit; products would overflow.
_SMALLEST = 1e-30
_LARGEST = 1e30


class Reading(NamedTuple):
    """One number of the file in SI, and the place of the number in the file."""

    si: float
    where: str


@dataclass
class Draft:
    """Collector of one import.

    Attributes
    ----------
    model : the REXS model
    given : path of the field -> value of the user; replaces the value of the file
    values : path of the field -> value in file units
    sources : path of the field -> place in the REXS file
    notes : notes for the user
    problems : problems for which the import is refused later
    """

    model: RexsModel
    given: Mapping[str, Any] = field(default_factory=dict)
    values: dict[str, Any] = field(default_factory=dict)
    sources: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    problems: list[FieldProblem] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.values |= self.given
        self.sources |= dict.fromkeys(self.given, GIVEN)

    def where(self, component: Component, attribute: str) -> str:
        """Return the name of a place in the file: "REXS gearbox.rexs cylindrical_gear 5/face_width"."""
        return f"REXS {self.model.file} {component.label}/{attribute}"

    def number(self, component: Component, attribute: str) -> Reading | None:
        """Read a number. Any other value, or a number that is not finite, becomes a problem."""
        where = self.where(component, attribute)
        request = component.attributes.get(attribute)
        if request is None or request.value is None:
            return None
        try:
            value = math.nan if isinstance(request.value, bool) else float(request.value)
        except (ValueError, OverflowError):
            value = math.nan
        if not (value == 0.0 or _SMALLEST < abs(value) < _LARGEST) or "_" in str(request.value):
            self.problem(where, shown(str(request.value)), "a finite number of a gear")
            return None
        return Reading(si_from_rexs(value, request.unit, ATTRIBUTES[attribute], where), where)

    def first(self, places: Sequence[Component], attribute: str) -> Reading | None:
        """Read the first number that one of the components has, or else has in the first load case."""
        for component in places:
            if (result := self.number(component, attribute)) is not None:
                return result
        for number, parts in self.model.load_cases[:1]:
            of_case = {c.id: c.attributes for c in parts}
            for c in places:  # the JSON form leaves types out of load cases
                component_in_case = Component(c.id, c.type, c.name, of_case.get(c.id, {}))
                if (result := self.number(component_in_case, attribute)) is not None:
                    return Reading(result.si, f"{result.where} (load case {number})")
        return None

    def text(self, component: Component, attribute: str) -> str | None:
        """Read a text, an enumerated value or a flag."""
        result = component.attributes.get(attribute)
        return None if result is None or result.value is None else str(result.value)

    def take(self, path: str, reading: Reading | None, remark: str = "") -> None:
        """Make a number the value of a field."""
        if reading is not None:
            self.put(path, to_file(reading.si, stated_unit(path) or "1"), reading.where + remark)

    def take_all(self, section: str, component: Component, attributes: Mapping[str, str]) -> None:
        """Make attributes of a component the values of fields of a section: field -> attribute."""
        for key, attribute in attributes.items():
            self.take(f"{section}.{key}", self.number(component, attribute))

    def take_first(self, path: str, readings: Iterable[Reading | None]) -> None:
        """Take a value that both gears share in spurcheck.

        If the values of both gears differ, the first value (of the pinion) is used and a note says so.
        """
        present = [r for r in readings if r is not None]
        self.take(path, present[0] if present else None)
        if any(not math.isclose(r.si, present[0].si, rel_tol=1e-9) for r in present[1:]):
            values = ", ".join(f"{r.si:.6g} in {r.where}" for r in present[1:])
            self.note(f"{path}: the first value is used for both gears, the file also has {values}")

    def put(self, path: str, value: Any, where: str) -> None:
        """Set the value of a field, unless the user has given a value."""
        if path not in self.given:
            self.values[path] = value
            self.sources[path] = where

    def si(self, path: str) -> float | None:
        """Return the value of a field in SI. None: the field has no value, or the value is not a number."""
        try:
            return None if path not in self.values else to_si(self.values[path], stated_unit(path) or "1")
        except ValueError:  # refused with the whole pair
            return None

    def problem(self, where: str, value: str, allowed: str, action: str = "Correct the file.") -> None:
        """Add a problem once. The import is refused later with all problems."""
        new_problem = FieldProblem(where, value, allowed, action)
        if new_problem not in self.problems:
            self.problems.append(new_problem)

    def note(self, text: str) -> None:
        """Add a note, once."""
        if text not in self.notes:
            self.notes.append(text)

    def agreed(self, readings: Iterable[Reading | None], why: str) -> Reading | None:
        """Return the common value of several readings. Different values are a problem.

        ``why``: reason why the values must be equal, for the message.
        """
        present = [r for r in readings if r is not None]
        for other in present[1:]:
            first = present[0]
            # Programs print twelve digits or more; a difference beyond 1e-9 is meant.
            if not math.isclose(other.si, first.si, rel_tol=1e-9, abs_tol=1e-12):
                allowed = f"{first.si:.9g} as in {first.where}"
                self.problem(other.where, f"{other.si:.9g} (SI)", allowed, why)
                return None
        return present[0] if present else None
