"""The paper's statements as rules: which number, which criterion. They are data, in ``claims.toml``.

The criteria put numbers on words such as "much", "negligible" or "abrupt" that the paper does not quantify;
they are stated with every claim, and its number beside them, so that a reader with other criteria can judge
anew.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from statistics import mean
from typing import Literal

from lumped.model.steady import UNSTABLE
from reproductions.he_cho_singh_2008.records import Number, Statement
from validation.files.formatting import read_table
from validation.validity.flags import LOAD_NOISE

Numbers = Mapping[str, float]
_COMBINE: dict[str, Callable[[list[float]], float]] = {"min": min, "max": max, "mean": mean}
_TESTS = {"at_least": operator.ge, "above": operator.gt, "at_most": operator.le}


@dataclass(frozen=True, kw_only=True)
class ClaimRule(Statement):
    """One statement of the paper, with the computation of its number and the criterion.

    Attributes
    ----------
    numbers : names of claim numbers of ``numbers.measure``
    combine : "min", "max" or "mean"; combines several numbers
    factor : value of the claim over the number
    limits : name of a claim number, or "value" -> tests to pass: "at_least", "above", "at_most"
    details : further numbers, name -> (claim number, factor, unit)
    remark : text on the outcome if the criterion is met
    otherwise : reason if the criterion is not met
    figure : "4" or "7" if the number is of the motion in this figure; the motion must be stable and in
        contact. "" if the number is of the laws alone
    unpublished : reason why the paper has too little information to judge the claim; "" if the claim can be
        judged
    """

    numbers: Sequence[str]
    combine: Literal["min", "max", "mean"] = "min"
    factor: float = 1.0
    limits: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    details: Mapping[str, tuple[str, float, str]] = field(default_factory=dict)
    remark: str = ""
    otherwise: str = ""
    figure: Literal["", "4", "7"] = ""
    unpublished: str = ""

    def value(self, stated: Numbers) -> float:
        """The number that stands for the claim."""
        return self.factor * float(_COMBINE[self.combine]([stated[name] for name in self.numbers]))

    def holds(self, stated: Numbers) -> bool:
        """Whether the criterion is met."""
        numbers = {**stated, "value": self.value(stated)}
        return all(
            _TESTS[test](numbers[name], limit)
            for name, tests in self.limits.items()
            for test, limit in tests.items()
        )

    def further(self, stated: Numbers) -> dict[str, Number]:
        """The further numbers, by name."""
        return {
            name: Number(factor * stated[key], unit) for name, (key, factor, unit) in self.details.items()
        }

    def unusable(self, stated: Numbers) -> str:
        """Reason why the motion behind the number is not usable. "": usable, or no motion is needed."""
        if not self.figure:
            return ""
        radius = stated[f"radius_{self.figure}"]
        load = stated[f"min_load_{self.figure}"]
        if radius > UNSTABLE:
            return (
                f"The periodic motion of Fig. {self.figure} is unstable here (largest multiplier "
                f"{radius:.3g}): a gear pair would leave it."
            )
        if load < -LOAD_NOISE:
            return (
                f"The teeth separate in the motion of Fig. {self.figure} here (smallest load {load:.2g} of "
                "the static load), so the lumped model does not hold."
            )
        return ""


RULES = tuple(
    ClaimRule(**row) for row in read_table("reproductions.he_cho_singh_2008.claims", "claims.toml")["claim"]
)
