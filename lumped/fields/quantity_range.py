"""Two quantities of one unit that span a range: ``[200, 3000]``, or as text ``"200..3000"``."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from lumped.errors import shown
from lumped.fields.units import UNITS, Quantity, Read

if TYPE_CHECKING:
    from pydantic.json_schema import JsonSchemaValue

_NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*")


@dataclass(frozen=True)
class QuantityRange(Read):
    """Annotation of a field that holds the lower and the upper end of a range, or None.

    Attributes
    ----------
    end : what each end may be
    action : what to do when the range is refused
    """

    end: Quantity
    action: str

    @property
    def unit(self) -> str:
        """Stated unit of a bare number."""
        return self.end.unit

    @property
    def allowed(self) -> str:
        """The allowed ranges as text."""
        return f"two increasing values FROM..TO, each {self.end.allowed}"

    def parse(self, value: object) -> tuple[float, float] | None:
        """Read two ends, or text FROM..TO, into SI, or raise pydantic's error."""
        if value is None:
            return None
        ends = _ends(value) if isinstance(value, str) else value
        if not isinstance(ends, (list, tuple)) or len(ends) != 2:
            raise self._refusal(shown(value), self.action)
        low, high = (self.end.parse(end) for end in ends)
        if low is None or high is None or low >= high:
            raise self._refusal(shown(value), self.action)
        return low, high

    def json_schema(self) -> JsonSchemaValue:
        """Two ends, or text."""
        ends = {"type": "array", "items": self.end.json_schema(), "minItems": 2, "maxItems": 2}
        text = {"type": "string", "examples": ["200..3000"]}
        si = UNITS[self.unit][0]
        return {"anyOf": [ends, text], "unit": self.unit, "si_unit": si}


def _ends(text: str) -> list[float | str]:
    """Ends of "FROM..TO": bare numbers as numbers; a first end without a unit has that of the second."""
    if text.count("..") != 1:
        return []
    low, high = text.split("..")
    number = _NUMBER.match(high)
    unit = high[number.end() :] if number else ""
    if _NUMBER.fullmatch(low):
        low = f"{low.strip()} {unit}"
    return [float(end) if _NUMBER.fullmatch(end) else end.strip() for end in (low, high)]
