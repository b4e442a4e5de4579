"""Two quantities of one unit that span a range: ``[200, 3000]``, or as text ``"200..3000"``."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from pydantic_core import PydanticCustomError, core_schema

from lumped.errors import shown
from lumped.fields.units import UNITS, Quantity

if TYPE_CHECKING:
    from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
    from pydantic.json_schema import JsonSchemaValue

_NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*")


@dataclass(frozen=True)
class QuantityRange:
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
            raise self._refusal(value)
        low, high = (self.end.parse(end) for end in ends)
        if low is None or high is None or low >= high:
            raise self._refusal(value)
        return low, high

    def _refusal(self, value: object) -> PydanticCustomError:
        return PydanticCustomError(
            "quantity",
            "{value}: allowed {allowed}. {action}",
            {"value": shown(value), "allowed": self.allowed, "action": self.action},
        )

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        """Validate by ``parse``."""
        return core_schema.no_info_plain_validator_function(self.parse)

    def __get_pydantic_json_schema__(
        self, schema: core_schema.CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
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
