"""What an explanation is: a cause, with values that it can have, that changes our model or the reading.

Sources: docs/how_to/check_your_model.md, "Explanations".
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import Any, NamedTuple

from lumped.schema.pair import GearPair
from validation.check.explanations.physics import UNALTERED, Physics
from validation.check.explanations.reading import AS_THEY_ARE, Reading
from validation.check.problem import Problem


class Kind(Enum):
    """What a cause changes. The value is the phrase that a user reads."""

    READING = "reading of the curves"
    INPUT = "inputs of the pair"
    PHYSICS = "equations of the model"


@dataclass(frozen=True)
class Variant:
    """Our model with changes, and a reading of the curves.

    Attributes
    ----------
    pair : the gear pair with changed inputs
    physics : alterations of the model
    reading : reading of the curves
    """

    pair: GearPair
    physics: Physics = UNALTERED
    reading: Reading = AS_THEY_ARE

    def with_inputs(self, changes: dict[str, Any]) -> Variant:
        """Return the variant with other inputs of the pair, by field."""
        return replace(self, pair=self.pair.with_(changes))

    def with_physics(self, **changes: Any) -> Variant:
        """Return the variant with other alterations of the model."""
        return replace(self, physics=replace(self.physics, **changes))

    def with_reading(self, reading: Reading) -> Variant:
        """Return the variant with another reading of the curves."""
        return replace(self, reading=reading)


class Choice(NamedTuple):
    """A fixed value of a cause.

    Attributes
    ----------
    label : value that a user reads: a number, or the name of a choice
    words : the explanation, behind "compatible with"
    variant : the variant with this value
    vague : whether many a cause has about this effect: the value is then accepted only where it brings the
        misfit below the limit
    shown : whether the curves alone, without our motion, show that the value is likely
    """

    label: float | str
    words: str
    variant: Callable[[Variant], Variant]
    vague: bool = False
    shown: bool = False


@dataclass(frozen=True)
class Cause:
    """An entry of the registry.

    Attributes
    ----------
    name : name of the explanation
    kind : what the cause changes
    meaning : the cause in words, for the table of the documentation
    span : values of the cause in words
    choices : fixed values at a variant; none for a free factor, or where the pair does not allow the cause
    grid : trial values of a free parameter, increasing, without ``neutral``; empty: the values are fixed
    neutral : value of the free parameter that changes nothing: 1 of a factor, whose scale is then
        logarithmic, or 0
    change : variant and free parameter -> variant
    words : explanation of a free parameter, behind "compatible with", with the place {value}
    shown : free parameter -> number that a user reads
    applies : whether the pair allows the free parameter
    describes : whether the cause is a course that many a mistake resembles, rather than a mistake
    narrow : whether a simpler cause, such as a stiffness, often has the same effect: it is then named first
    part : which one of several causes of this name, such as a channel; empty: the only one
    """

    name: str
    kind: Kind
    meaning: str
    span: str
    choices: Callable[[Problem, Variant], Sequence[Choice]] = field(default=lambda problem, variant: ())
    grid: tuple[float, ...] = ()
    neutral: float = 1.0
    change: Callable[[Variant, float], Variant] = field(default=lambda variant, value: variant)
    words: str = ""
    shown: Callable[[float], float] = field(default=lambda value: value)
    applies: Callable[[Problem, Variant], bool] = field(default=lambda problem, variant: True)
    describes: bool = False
    narrow: bool = False
    part: str = ""

    @property
    def free(self) -> bool:
        """Whether the cause has a free parameter."""
        return bool(self.grid)

    def coordinate(self, value: float) -> float:
        """Return the coordinate of a free parameter on the scale of the search; 0 changes nothing."""
        return math.log(value / self.neutral) if self.neutral > 0.0 else value

    def value(self, coordinate: float) -> float:
        """Return the free parameter at a coordinate."""
        return self.neutral * math.exp(coordinate) if self.neutral > 0.0 else coordinate

    @property
    def reach(self) -> tuple[float, float]:
        """Least and largest coordinate: a step of the grid beyond the grid."""
        places = sorted([0.0, *(self.coordinate(value) for value in self.grid)])
        low = places[0] + (places[0] - places[1]) * (places[0] < 0.0)
        return low, places[-1] + (places[-1] - places[-2]) * (places[-1] > 0.0)
