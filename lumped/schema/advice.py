"""Which number of teeth, profile shift or tip would let gears mesh that do not."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import Any, Protocol

from lumped.errors import FieldProblem
from lumped.gear_geometry.geometry import MATE, Name, ToothProblem, Wheel
from lumped.schema.gear import BasicRack, Gear

#: Gear -> its fields -> other values, in SI.
Changes = Mapping[Name, Mapping[str, Any]]


class Tried(Protocol):
    """A pair of gears that can be tried with other values."""

    @property
    def basic_rack(self) -> BasicRack: ...
    @property
    def pinion(self) -> Gear: ...
    @property
    def gear(self) -> Gear: ...
    @property
    def centre_distance(self) -> float | None: ...
    @property
    def wheels(self) -> tuple[Wheel, Wheel]: ...

    def meshes_with(self, changes: Changes) -> bool:
        """Whether the pair has no problem of existence with other values of its gears' fields."""


#: Profile shifts and tips are tried in hundredths of a module: so many of them, and so many at a time.
_HUNDREDTHS = 80
_STRIDE = 5
#: The same of teeth.
_TEETH = 30
_TEETH_STRIDE = 4
_LARGEST_SHIFT = 2.0
_MOST_TEETH = 1000


def advised(pair: Tried, problems: list[FieldProblem]) -> list[FieldProblem]:
    """The problems of a pair. A problem of teeth names a solution, unless the teeth also wedge."""
    if any(one.field == "centre_distance" for one in problems):
        return problems
    return [
        replace(one, action=f"{one.action} {would}")
        if isinstance(one, ToothProblem) and (would := what_would_mesh(pair, one.gear, one.sense))
        else one
        for one in problems
    ]


def what_would_mesh(pair: Tried, name: Name, sense: int = 1) -> str:
    """Sentence with changes that let the gears mesh, for example "pinion.profile_shift = 0.24 would do."

    Each change alone is sufficient. The search tries steps of 0.01 modules and of one tooth, and takes the
    first value of a field with which the gears mesh. Empty: there is no such value.

    Parameters
    ----------
    name : gear whose profile shift and teeth are tried first
    sense : first direction of the search for a profile shift, 1: upwards
    """
    values = list(_alone(pair, name, sense)) or list(_beside_the_mate(pair, name, sense))
    return f"{', or '.join(values)} would do." if values else ""


def _alone(pair: Tried, name: Name, sense: int) -> Iterator[str]:
    shift = _shift(pair, name)
    teeth = getattr(pair, name).teeth

    def toothed(step: int) -> Changes:
        return {name: {"teeth": teeth + step}}

    for direction in (sense, -sense):

        def shifted(step: int, direction: int = direction) -> Changes:
            return {name: {"profile_shift": _hundredth(shift, direction * step)}}

        if step := _first(pair, shifted, _HUNDREDTHS, _STRIDE):
            yield f"{name}.profile_shift = {_hundredth(shift, direction * step):g}"
            break
    free = pair.centre_distance is None and getattr(pair, name).tip_diameter is None
    if free and (step := _first(pair, toothed, _TEETH, _TEETH_STRIDE)):
        yield f"{name}.teeth = {teeth + step}"


def _beside_the_mate(pair: Tried, name: Name, sense: int) -> Iterator[str]:
    mate = MATE[name]
    shift = _shift(pair, name)
    shift_of_mate = _shift(pair, mate)
    for opposite in (-1, 1):  # the first keeps the sum of the shifts, and so a given centre distance

        def both(step: int, opposite: int = opposite) -> Changes:
            shifts = _hundredth(shift, sense * step), _hundredth(shift_of_mate, opposite * sense * step)
            return {name: {"profile_shift": shifts[0]}, mate: {"profile_shift": shifts[1]}}

        if step := _first(pair, both, _HUNDREDTHS, _STRIDE):
            values = both(step)
            yield " with ".join(f"{one}.profile_shift = {values[one]['profile_shift']:g}" for one in values)
            return
    module = pair.basic_rack.module
    tip = pair.wheels[mate == "gear"].tip_radius
    other_forms = [field for field in ("addendum", "tip_alteration") if field in type(pair.gear).model_fields]

    def diameter(step: int) -> float:
        return float(2.0 * (math.floor(100.0 * tip / module) - step) * 0.01 * module)

    def lowered(step: int) -> Changes:
        return {mate: {"tip_diameter": diameter(step)} | dict.fromkeys(other_forms)}

    if step := _first(pair, lowered, _HUNDREDTHS, _STRIDE):
        yield f"{mate}.tip_diameter = {1e3 * diameter(step):.6g} mm"


def _shift(pair: Tried, name: Name) -> float:
    return pair.wheels[name == "gear"].tooth.profile_shift


def _hundredth(value: float, steps: int) -> float:
    """A value moved by steps of 0.01, on whole hundredths."""
    start = math.floor(100.0 * value + 1e-9) if steps > 0 else math.ceil(100.0 * value - 1e-9)
    return (start + steps) / 100.0


def _first(pair: Tried, changes: Callable[[int], Changes], most: int, stride: int) -> int:
    """First number of steps >= 1 with which the pair meshes. 0: the pair meshes with no number of steps.

    Multiples of ``stride`` are tried first, then bisection between the first multiple that meshes and the
    multiple before.
    """
    for high in range(stride, most + stride, stride):
        if _meshes(pair, changes(high)):
            low = high - stride
            while high - low > 1:
                middle = (low + high) // 2
                low, high = (low, middle) if _meshes(pair, changes(middle)) else (middle, high)
            return high
    return 0


def _meshes(pair: Tried, changes: Changes) -> bool:
    """Whether the gears mesh with changes, and the changes are values that a file may have."""
    for fields in changes.values():
        if abs(fields.get("profile_shift", 0.0)) > _LARGEST_SHIFT or fields.get("teeth", 0) > _MOST_TEETH:
            return False
    return pair.meshes_with(changes)
