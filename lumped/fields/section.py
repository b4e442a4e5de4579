"""The base of every part of the schema."""

from __future__ import annotations

import unicodedata
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any

from pydantic import AfterValidator, BaseModel, ConfigDict, GetCoreSchemaHandler
from pydantic_core import PydanticCustomError, core_schema

from lumped.fields.quantity_range import QuantityRange
from lumped.fields.units import Quantity, to_file


class Section(BaseModel):
    """Base of every part of the schema: frozen, unknown keys are errors, defaults are as a file says them."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, validate_default=True)

    def to_mapping(self) -> dict[str, Any]:
        """Return nested plain data in file units; None is left out, as a file cannot say it."""
        result: dict[str, Any] = {}
        for name, info in type(self).model_fields.items():
            value = getattr(self, name)
            quantity = next((m for m in info.metadata if isinstance(m, (Quantity, QuantityRange))), None)
            if isinstance(value, Section):
                result[name] = value.to_mapping()
            elif isinstance(value, tuple):
                result[name] = [
                    v.to_mapping()
                    if isinstance(v, Section)
                    else v
                    if quantity is None
                    else to_file(v, quantity.unit)
                    for v in value
                ]
            elif value is not None:
                result[name] = value if quantity is None else to_file(value, quantity.unit)
        return result


@dataclass(frozen=True)
class OneOf:
    """Annotation of a text field: one of these names. The names may come from a registry.

    Attributes
    ----------
    names : as they are kept
    kept : other spelling -> name, where there are others
    """

    names: tuple[str, ...]
    kept: Callable[[object], object] | None = None

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        """Validate and describe it as pydantic does a ``Literal``."""
        names = core_schema.literal_schema(list(self.names))
        return names if self.kept is None else core_schema.no_info_before_validator_function(self.kept, names)


def _readable(text: str) -> str:
    if any(unicodedata.category(c) == "Cc" and c not in "\t\n\r" for c in text):
        context = {"value": ascii(text)[:60], "allowed": "text without control characters"}
        raise PydanticCustomError(
            "quantity", "{value}: allowed {allowed}. {action}", {**context, "action": "Remove them."}
        )
    return text


#: Free text. Terminals obey control characters, and result files cannot hold them all.
Text = Annotated[str, AfterValidator(_readable)]
