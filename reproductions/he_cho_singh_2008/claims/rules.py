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
    """One statement of the paper, how its number is computed and when it holds.

    Attributes
    ----------
    numbers : names among the claim numbers of ``numbers.measure``
    combine : "min", "max" or "mean", where there are several
    factor : value of the claim over the number
    limits : name of a claim number, or "value" -> the tests that it must pass, "at_least", "above", "at_most"
    details : further numbers, name -> (claim number, factor, unit)
    remark, otherwise : on the outcome where the criterion is met, and why where it is not
    figure : "4" or "7" where the number is of the motion in that figure, which must then be stable and in
        contact; "" where it is of the laws alone
    unpublished : why the claim cannot be judged from what was published; "" where it can
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
        known = {**stated, "value": self.value(stated)}
        return all(
            _TESTS[test](known[name], limit)
            for name, tests in self.limits.items()
            for test, limit in tests.items()
        )

    def further(self, stated: Numbers) -> dict[str, Number]:
        """The further numbers, by name."""
        return {
            name: Number(factor * stated[key], unit) for name, (key, factor, unit) in self.details.items()
        }

    def unusable(self, stated: Numbers) -> str:
        """Why the motion that the number is of does not count; "" where it does or none is needed."""
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
