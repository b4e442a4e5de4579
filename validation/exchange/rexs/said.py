"""What a REXS file says, as parameters of spurcheck: values and the places they come from."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from lumped.errors import FieldProblem, shown
from lumped.fields.units import to_file
from lumped.schema.pair import stated_unit
from validation.exchange.rexs.model import Attribute, Component, RexsModel
from validation.exchange.rexs.vocabulary import ATTRIBUTES, si_from_rexs

#: Numbers beyond these are no measure of a gear in any unit, and products of them would overflow.
_SMALLEST, _LARGEST = 1e-30, 1e30
#: Joins the source of a value and why it is doubtful.
DOUBTFUL = "; doubtful: "


@dataclass(frozen=True)
class Reading:
    """One number of the file in SI, and where it stands."""

    si: float
    where: str


@dataclass
class Said:
    """Collector of one import.

    Attributes
    ----------
    model : the file
    values : field path -> value in file units
    sources : field path -> component and attribute
    notes : what a user should know about the import
    problems : what makes it impossible
    """

    model: RexsModel
    values: dict[str, Any] = field(default_factory=dict)
    sources: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    problems: list[FieldProblem] = field(default_factory=list)

    def where(self, component: Component, attribute: str, case: int | None = None) -> str:
        """Name a place in the file as a source: "REXS gearbox.rexs cylindrical_gear 5/face_width"."""
        inside = "" if case is None else f" (load case {case})"
        return f"REXS {self.model.file} {component.label}/{attribute}{inside}"

    def raw(self, component: Component, attribute: str) -> Attribute | None:
        """Return an attribute that has a value."""
        if attribute not in ATTRIBUTES[component.type]:
            raise KeyError(f"{component.type}/{attribute} is not in the table of checked attributes")
        found = component.attributes.get(attribute)
        return None if found is None or found.value is None else found

    def number(self, component: Component, attribute: str, case: int | None = None) -> Reading | None:
        """Read a number; what is no finite number becomes a problem."""
        found = self.raw(component, attribute)
        if found is None:
            return None
        where = self.where(component, attribute, case)
        try:
            if isinstance(found.value, bool) or not isinstance(found.value, (str, int, float)):
                raise ValueError
            value = float(found.value)
            sensible = value == 0.0 or _SMALLEST < abs(value) < _LARGEST  # false also for NaN
            if not sensible or "_" in str(found.value):
                raise ValueError
        except (ValueError, OverflowError):
            given = shown(str(found.value))
            self.problems.append(FieldProblem(where, given, "a finite number of a gear", "Correct the file."))
            return None
        known = ATTRIBUTES[component.type][attribute]
        if known.unit == "kW":  # power has no unit among the parameters
            return Reading(1e3 * value, where)
        return Reading(si_from_rexs(value, found.unit, known.unit, where), where)

    def flag(self, component: Component, attribute: str) -> bool | None:
        """Read true or false."""
        found = self.raw(component, attribute)
        if found is None:
            return None
        return {"true": True, "1": True, "false": False, "0": False}.get(str(found.value).lower())

    def text(self, component: Component, attribute: str) -> str | None:
        """Read a text or an enumerated value."""
        found = self.raw(component, attribute)
        return None if found is None else str(found.value)

    def take(self, path: str, reading: Reading | None, remark: str = "") -> None:
        """Make a number the value of a field."""
        if reading is not None:
            unit = stated_unit(path)
            self.put(path, to_file(reading.si, unit or "1"), reading.where + remark)

    def take_all(self, section: str, component: Component, attributes: Mapping[str, str]) -> None:
        """Make attributes of a component the values of fields of a section: field -> attribute."""
        for key, attribute in attributes.items():
            self.take(f"{section}.{key}", self.number(component, attribute))

    def put(self, path: str, value: Any, where: str) -> None:
        """Make anything the value of a field."""
        self.values[path] = value
        self.sources[path] = where

    def note(self, text: str) -> None:
        """Add a note, once."""
        if text not in self.notes:
            self.notes.append(text)

    def doubt(self, paths: Sequence[str], text: str) -> None:
        """Mark the lines of some fields as doubtful, and note why."""
        for path in paths:
            self.sources[path] = f"{self.sources.get(path, 'assumed')}{DOUBTFUL}{text}"
        self.note(f"doubtful: {', '.join(paths)}: {text}")

    def agreed(self, readings: list[Reading | None], what: str) -> Reading | None:
        """Return the one value that all places which have one agree on; a disagreement is a problem."""
        present = [r for r in readings if r is not None]
        if not present:
            return None
        first = present[0]
        for other in present[1:]:
            # Programs print twelve digits or more; a difference beyond 1e-9 is meant.
            if not math.isclose(other.si, first.si, rel_tol=1e-9, abs_tol=1e-12):
                self.problems.append(
                    FieldProblem(
                        other.where, f"{other.si:.9g} (SI)", f"{first.si:.9g} as in {first.where}", what
                    )
                )
                return None
        return first
