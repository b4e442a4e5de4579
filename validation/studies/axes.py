"""An axis of a study: the fields that vary, and their values in the unit of the field."""

from __future__ import annotations

import math
import types
import typing
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import BeforeValidator, Field, StrictFloat, StrictInt, model_validator

from floquet.gear.axes import GEAR_AXES
from lumped.errors import ParameterError, refuse, shown
from lumped.fields.section import Section
from lumped.fields.units import Quantity, to_si, to_stated
from lumped.schema.pair import field_at

AxisValue = int | float | str
#: Every integer below this is a floating-point number.
_EXACT = 2**53
_FLOQUET_ONLY = ("friction_coefficient", "stiffness_variation")


@dataclass(frozen=True)
class Target:
    """Target of an axis: a field of the gear pair, or an axis of a stability chart.

    Attributes
    ----------
    unit : stated unit; empty for a field without a unit
    long_name : description
    kind : kind of the values, "float", "int" or "other", a choice
    floquet_only : whether only the stability analysis has this target
    """

    unit: str
    long_name: str
    kind: str
    floquet_only: bool = False


def target_of(path: str) -> Target:
    """Return the target of a dotted field path or of the name of an axis of a stability chart."""
    if path in GEAR_AXES:
        axis = GEAR_AXES[path]
        return Target(axis.units, axis.long_name, "float", path in _FLOQUET_ONLY)
    if len(path) > 200 or path.split(".")[0] in ("name", "description", "sources"):
        allowed = "a gear-pair field by dotted path, or " + ", ".join(GEAR_AXES)
        raise refuse("field", repr(path[:80]), allowed, "Correct the path.")
    info = field_at(path)
    for marker in info.metadata:
        if type(marker) is Quantity:
            return Target(marker.unit, info.description or path, "float")
    return Target("", info.description or path, "int" if _is_integer(info.annotation) else "other")


_Bound = Quantity("1", optional=True, action="Give the number in the axis' unit.")


def _plain_values(values: object) -> object:
    """Refuse the first value that is no number and no text; pydantic would list all of them."""
    for value in values if isinstance(values, (list, tuple)) else ():
        number = isinstance(value, (int, float)) and not isinstance(value, bool) and abs(value) < 2.0**63
        if not number and not isinstance(value, str):
            raise refuse("", value, "finite numbers or text with a unit", "Correct the value.")
    return values


def _single(value: object) -> object:
    return (value,) if isinstance(value, str) else value


class Axis(Section):
    """A parameter that varies, or several fields that vary together, for example both face widths."""

    name: str = Field("", max_length=80, pattern=r"^\w*$", description="label; default the field's name")
    field: Annotated[
        tuple[str, ...], BeforeValidator(_single, json_schema_input_type=str | list[str]), Field(min_length=1)
    ] = Field(description="dotted path of a gear-pair field, several paths, or the name of a chart axis")
    values: Annotated[
        tuple[StrictInt | StrictFloat | str, ...] | None,
        BeforeValidator(_plain_values, json_schema_input_type=list[int | float | str]),
    ] = Field(None, min_length=1, max_length=10_000_000, description="the values, for a grid")
    low: Annotated[float | None, _Bound] = Field(None, description="lower end, in the field's stated unit")
    high: Annotated[float | None, _Bound] = Field(None, description="upper end, in the field's stated unit")
    count: Annotated[int | None, Field(ge=2, le=10_000_000, strict=True)] = Field(
        None, description="number of values from low to high, for a grid"
    )
    spacing: Literal["linear", "log"] = Field("linear", description="spacing or distribution, low to high")

    @model_validator(mode="after")
    def _complete(self) -> Self:
        for path in self.field:
            try:
                target_of(path)
            except ParameterError as error:
                (problem, *_) = error.problems
                raise refuse("field", shown(repr(path)), problem.allowed, problem.action) from None
        if self.values is not None:
            if self.low is not None or self.high is not None or self.count is not None:
                raise refuse("values", "with low, high or count", "one of the two ways", "Remove one.")
            return self
        if self.low is None or self.high is None:
            action = "Give the range or the list of the axis."
            raise refuse("low", str(self.low), "values, or low and high", action)
        if not self.low < self.high:
            raise refuse("high", f"{self.high:g}", f"> low = {self.low:g}", "Swap or correct the two.")
        if not math.isfinite(self.high - self.low):
            raise refuse("high", f"{self.high:g}", "a finite distance from low", "Narrow the range.")
        if self.spacing == "log" and self.low <= 0.0:
            raise refuse("low", f"{self.low:g}", "> 0 with spacing 'log'", "Use spacing = 'linear'.")
        return self

    @property
    def label(self) -> str:
        """Name of the axis in the results: ``name``, or the path with "_" for the dot."""
        return self.name or self.field[0].replace(".", "_")

    def listed(self) -> tuple[AxisValue, ...]:
        """Return the values of a listed axis in the stated unit of the field; () for a sampled range."""
        target = target_of(self.field[0])
        units = {target_of(path).unit for path in self.field}
        if len(units) > 1:
            stated = " and ".join(sorted(units))
            raise refuse("field", stated, "fields of the same unit", "Use separate axes.")
        if self.values is None:
            if target.kind == "other":
                raise refuse("field", repr(self.field[0]), "a number for a range", "List its values.")
            assert self.low is not None
            assert self.high is not None
            if target.kind == "int" and not -_EXACT < math.ceil(self.low) <= math.floor(self.high) < _EXACT:
                stated = f"{self.low:g} to {self.high:g}"
                raise refuse("low", stated, "a range with integers in it", "Correct the range.")
            return () if self.count is None else self.spaced(np.linspace(0.0, 1.0, self.count))
        values = tuple(_read(value, target) for value in self.values)
        if len(set(values)) < len(values):
            raise refuse("values", "a value twice", "values that all differ", "Remove the repetition.")
        return values

    def spaced(self, share: np.ndarray[Any, np.dtype[np.float64]]) -> tuple[AxisValue, ...]:
        """Return the values at shares, 0 to 1, of the way from low to high; integers for an integer field.

        In samples of an integer field both ends are as likely as the values between.
        """
        assert self.low is not None
        assert self.high is not None
        if target_of(self.field[0]).kind == "int":
            low = math.ceil(self.low)
            high = math.floor(self.high)
            if self.count is None:
                integers = np.minimum(low + np.floor(share * (high - low + 1)), high)
            else:
                integers = np.rint(low + share * (high - low))
                if np.unique(integers).size < integers.size:
                    raise refuse("count", self.count, f"<= {high - low + 1} integers", "Lower the count.")
            return tuple(int(v) for v in integers)
        if self.spacing == "log":
            low_log = np.log(self.low)
            high_log = np.log(self.high)
            values = np.exp(low_log + share * (high_log - low_log))  # the ratio itself may overflow
        else:
            values = self.low + share * (self.high - self.low)
        return tuple(float(v) for v in np.clip(values, self.low, self.high))


def _read(value: AxisValue, target: Target) -> AxisValue:
    if target.kind == "other":
        if not isinstance(value, str):
            raise refuse("values", value, "text, as in a parameter file", "Put it in quotes.")
        return value
    if isinstance(value, str):
        unit = target.unit.replace("N m", "N*m") or "1"
        try:
            return to_stated(to_si(value, unit), unit)
        except ValueError as error:
            raise refuse("values", repr(value[:80]), f"a number in {unit}", f"{error}.") from None
    if target.kind == "int":
        if value != int(value):
            raise refuse("values", value, "whole numbers", "Round them.")
        return int(value)
    return float(value)


def _is_integer(annotation: Any) -> bool:
    if typing.get_origin(annotation) in (typing.Union, types.UnionType, typing.Annotated):
        return any(_is_integer(part) for part in typing.get_args(annotation))
    return annotation is int
