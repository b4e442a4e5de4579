"""The base of every part of the schema, and its fields of text."""

from __future__ import annotations

import unicodedata
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Annotated, Any, Self

from pydantic import AfterValidator, BaseModel, ConfigDict, GetCoreSchemaHandler
from pydantic_core import core_schema

from lumped.arguments import nearest
from lumped.errors import refuse
from lumped.fields.units import Quantity, to_file


class Section(BaseModel):
    """Base of every part of the schema: frozen, unknown keys are errors, defaults are as a file says them."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False, validate_default=True)

    def __setattr__(self, name: str, value: Any) -> None:
        """Refuse: a pair does not change."""
        if name in type(self).model_fields:
            action = "Parameters do not change. Make a variation: pair.with_(speed=2000)."
            raise refuse(name, value, "a value of pair.with_(...)", action)
        super().__setattr__(name, value)

    if not TYPE_CHECKING:  # a checker knows the fields

        def __getattr__(self, name: str) -> Any:
            """Refuse a name that is no attribute, with the field that was probably meant."""
            if name.startswith("_"):
                return super().__getattr__(name)
            fields = list(type(self).model_fields)
            advice = nearest(name, fields) or f"It has {', '.join(fields)}."
            raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}. {advice}")

    def __dir__(self) -> list[str]:
        """Return the names for users: fields, properties and methods of this program."""
        library = {name for name in dir(BaseModel) if not name.startswith("__")}
        return sorted(set(super().__dir__()) - library)

    @property
    def derived_fields(self) -> tuple[str, ...]:
        """Fields whose values follow from others: a file does not have them."""
        return ()

    def with_values(self, values: dict[str, Any]) -> Self:
        """Return the section with other values in SI, after the rules of the section alone.

        Raises
        ------
        ParameterError : values that the section cannot have together
        """
        changed = self.model_copy(update=dict.fromkeys(self.derived_fields) | values)
        for rule in _rules(type(self)):
            getattr(changed, rule)()
        return changed

    def to_mapping(self) -> dict[str, Any]:
        """Return nested plain data in file units; None is left out, as a file cannot say it."""
        result: dict[str, Any] = {}
        derived = self.derived_fields
        for name, unit in _stated_units(type(self)):
            value = None if name in derived else getattr(self, name)
            if isinstance(value, tuple):
                if value:  # an empty list says nothing
                    result[name] = [_plain(one, unit) for one in value]
            elif value is not None:
                result[name] = _plain(value, unit)
        return result


@lru_cache(maxsize=256)
def _rules(section: type[Section]) -> tuple[str, ...]:
    """Names of the rules that check the values of a section together."""
    rules = section.__pydantic_decorators__.model_validators
    return tuple(name for name, rule in rules.items() if rule.info.mode == "after")


@lru_cache(maxsize=256)
def _stated_units(section: type[Section]) -> tuple[tuple[str, str | None], ...]:
    """Name of each field of a section, and its stated unit; None: the field has no unit."""
    return tuple(
        (name, next((marker.unit for marker in info.metadata if isinstance(marker, Quantity)), None))
        for name, info in section.model_fields.items()
    )


def _plain(value: Any, unit: str | None) -> Any:
    if isinstance(value, Section):
        return value.to_mapping()
    return value if unit is None or isinstance(value, str) else to_file(value, unit)


@dataclass(frozen=True)
class OneOf:
    """Annotation of a text field with one of several names, for example the names of a registry.

    ``spelling`` turns another spelling into a name. None: there are no other spellings.
    """

    names: tuple[str, ...]
    spelling: Callable[[object], object] | None = None

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        """Validate and describe the field like a ``Literal`` of pydantic."""
        names = core_schema.literal_schema(list(self.names))
        if self.spelling is None:
            return names
        return core_schema.no_info_before_validator_function(self.spelling, names)


def _readable(text: str) -> str:
    if any(unicodedata.category(c) == "Cc" and c not in "\t\n\r" for c in text):
        raise refuse("", ascii(text)[:60], "text without control characters", "Remove them.")
    return text


#: Free text. Terminals obey control characters, and result files cannot hold them all.
Text = Annotated[str, AfterValidator(_readable)]
