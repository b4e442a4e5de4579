"""A step of a ladder: a cause with its value, and how likely it is beside others with the same misfit.

Sources: docs/how_to/check_your_model.md, "Explanations".
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from validation.check.explanations.cause import Cause, Choice, Kind, Variant

#: A free parameter counts as this much worse than a fixed value with the same misfit.
FREE_IS_WORSE = 1.15
#: A course that many a mistake resembles, such as a slope, counts as this much worse than a mistake.
_DESCRIBES = 1.15
#: A mistake that the curves alone show counts as this much better.
_SHOWN = 0.6
#: A cause with a simpler one of about the same effect counts as this much worse than that.
_NARROW = 1.04
#: A free factor on an input that turns out as a usual one; how near its logarithm must be to that of one.
_ROUND_IS_WORSE = 1.05
_AS_ROUND = 2e-3
_ROUND = np.log([factor**sign for factor in (2.0, 4.0, 10.0, 100.0, 1e3) for sign in (1, -1)])
#: A free value below this share of the smallest trial value is slight.
_SLIGHT = 0.03
#: Free parameters nearer to neutral than this change nothing that is worth a sentence.
_LEAST_CHANGE = 1e-3


class Step(NamedTuple):
    """A cause with its value.

    Attributes
    ----------
    cause : the cause
    choice : the fixed value; None: the value is free
    coordinate : of the free parameter on the scale of the search
    """

    cause: Cause
    choice: Choice | None
    coordinate: float = 0.0

    @property
    def key(self) -> tuple[str, str]:
        """Name of the cause, and which of its values or parts; the number of a free value is left out."""
        return self.cause.name, self.cause.part if self.choice is None else str(self.choice.label)

    @property
    def label(self) -> float | str:
        """The value that a user reads."""
        if self.choice is not None:
            return self.choice.label
        return self.cause.shown(self.cause.value(self.coordinate))

    @property
    def price(self) -> float:
        """Factor on the misfit of a step that is less likely than a fixed value with the same misfit."""
        price = _DESCRIBES if self.cause.describes else _NARROW if self.cause.narrow else 1.0
        if self.choice is not None:
            return price * (_DESCRIBES if self.choice.vague else _SHOWN if self.choice.shown else 1.0)
        return price * (_ROUND_IS_WORSE if self.is_round else FREE_IS_WORSE)

    @property
    def is_round(self) -> bool:
        """Whether a free factor is one by which inputs are usually mistaken, such as 2 or 1000."""
        if self.cause.kind is not Kind.INPUT or self.cause.neutral <= 0.0:
            return False
        return bool(np.abs(self.coordinate - _ROUND).min() < _AS_ROUND)

    @property
    def slight(self) -> bool:
        """Whether a free value is so near to no change that it is no mistake of its own."""
        if self.choice is not None:
            return False
        return abs(self.coordinate) < _SLIGHT * min(abs(self.cause.coordinate(v)) for v in self.cause.grid)

    @property
    def changes(self) -> bool:
        """Whether the value changes anything that is worth a sentence."""
        return self.choice is not None or abs(self.coordinate) > _LEAST_CHANGE

    @property
    def sentence(self) -> str:
        """The explanation in words."""
        if self.choice is not None:
            return f"Compatible with {self.choice.words}"
        return f"Compatible with {self.cause.words.format(value=f'{float(self.label):.4g}')}"

    def of(self, variant: Variant) -> Variant:
        """Return the variant with this step."""
        if self.choice is not None:
            return self.choice.variant(variant)
        return self.cause.change(variant, self.cause.value(self.coordinate))
