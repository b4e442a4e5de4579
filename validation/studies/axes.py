"""What an axis of a study may vary, and its values in the unit of the field."""

from __future__ import annotations

import types
import typing
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from floquet.gear_axes import GEAR_AXES
from lumped.errors import refuse
from lumped.schema_errors import field_at
from lumped.units import Quantity, to_si, to_stated

if TYPE_CHECKING:
    from validation.studies.schema import Axis

AxisValue = int | float | str
_FLOQUET_ONLY = ("friction_coefficient", "stiffness_variation")


@dataclass(frozen=True)
class Target:
    """Where an axis acts.

    Attributes
    ----------
    unit : stated unit, "" where the field is no quantity
    long_name : description
    kind : "float", "int" or "other" (a choice, such as a friction law)
    floquet_only : whether only the stability analysis knows this axis
    """

    unit: str
    long_name: str
    kind: str
    floquet_only: bool = False


def target_of(path: str) -> Target:
    """Return what a dotted field path, or the name of a stability chart's axis, stands for.

    Raises
    ------
    ParameterError : no such field; the nearest is suggested
    """
    if path in GEAR_AXES:
        axis = GEAR_AXES[path]
        return Target(axis.units, axis.long_name, "float", path in _FLOQUET_ONLY)
    if len(path) > 200 or path.split(".")[0] in ("name", "description", "sources"):
        known = "a gear-pair field by dotted path, or " + ", ".join(GEAR_AXES)
        raise refuse("field", repr(path[:80]), known, "Correct the path.")
    info = field_at(path)
    for marker in info.metadata:
        if isinstance(marker, Quantity):
            return Target(marker.unit, info.description or path, "float")
    return Target("", info.description or path, "int" if _is_integer(info.annotation) else "other")


def checked_values(axis: Axis) -> tuple[AxisValue, ...]:
    """Values of a listed axis, or () for a range that is sampled; numbers are in the field's stated unit.

    Raises
    ------
    ParameterError : text where a number belongs or the reverse, values not of the field's unit or repeated
    """
    target = target_of(axis.field[0])
    units = {target_of(path).unit for path in axis.field}
    if len(units) > 1:
        raise refuse("field", " and ".join(sorted(units)), "fields of the same unit", "Use separate axes.")
    if axis.values is None:
        if target.kind == "other":
            raise refuse("field", repr(axis.field[0]), "a number for a range", "List its values.")
        if axis.count is None:
            return ()
        return spaced(axis, target.kind, np.linspace(0.0, 1.0, axis.count))
    values = tuple(_read(value, target) for value in axis.values)
    if len(set(values)) < len(values):
        raise refuse("values", "a value twice", "values that all differ", "Remove the repetition.")
    return values


def spaced(axis: Axis, kind: str, share: np.ndarray[Any, np.dtype[np.float64]]) -> tuple[AxisValue, ...]:
    """Values at the given shares, 0 to 1, of the way from low to high; integers for an integer field.

    Samples of an integer field give both ends the same chance as the values between.

    Raises
    ------
    ParameterError : an integer field gets the same value twice in a list of given length
    """
    assert axis.low is not None
    assert axis.high is not None
    if kind == "int":
        low, high = int(np.ceil(axis.low)), int(np.floor(axis.high))
        if axis.count is None:
            whole = np.minimum(low + np.floor(share * (high - low + 1)), high)
        else:
            whole = np.rint(low + share * (high - low))
            if np.unique(whole).size < whole.size:
                raise refuse("count", axis.count, f"<= {high - low + 1} integers", "Lower the count.")
        return tuple(int(v) for v in whole)
    if axis.spacing == "log":
        low, high = np.log(axis.low), np.log(axis.high)
        values = np.exp(low + share * (high - low))  # the ratio itself may overflow
    else:
        values = axis.low + share * (axis.high - axis.low)
    return tuple(float(v) for v in np.clip(values, axis.low, axis.high))


def _read(value: AxisValue, target: Target) -> AxisValue:
    if target.kind == "other":
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
