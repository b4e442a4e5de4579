"""Statements with their numbers of every pair, and whether the criterion holds."""

from __future__ import annotations

import operator
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from reproductions.vaishya_singh_2001.gears import PAIRS, Gears
from reproductions.vaishya_singh_2001.numbers import NUMBERS
from validation.files.formatting import read_table

Verdict = Literal["reproduced", "not reproduced", "answered", "no common answer"]
_TESTS = {"at_least": operator.ge, "above": operator.gt, "at_most": operator.le, "below": operator.lt}
#: Preset of gears that are alike: their arms of friction do not change along the path.
_ALIKE = "nasa_28_28"


@dataclass(frozen=True, kw_only=True)
class Rule:
    """One statement or question of the abstracts, with the number and the criterion that judge it.

    Attributes
    ----------
    name : short name
    kind : "statement", which the abstract says; or "question", whose answer it does not give and the
        criterion is
    source : where it is said
    text : the statement or question in words of this project
    definition : of the number
    unit : of the value
    criterion : in words
    number : name of a function of numbers.py
    factor : value over the number
    limits : tests of the value: "at_least", "above", "at_most", "below" -> limit
    alike : why the criterion is not asked of gears that are alike; "" if it is
    remark : text on the outcome
    """

    name: str
    kind: Literal["statement", "question"]
    source: str
    text: str
    definition: str
    unit: str
    criterion: str
    number: str
    factor: float = 1.0
    limits: Mapping[str, float] = field(default_factory=dict)
    alike: str = ""
    remark: str = ""

    def holds(self, value: float) -> bool:
        """Whether a value meets the criterion."""
        return all(_TESTS[test](value, limit) for test, limit in self.limits.items())

    def verdict(self, values: Mapping[str, float]) -> Verdict:
        """Verdict by the values of all pairs of which the criterion is asked."""
        asked = {name: value for name, value in values.items() if not (self.alike and name == _ALIKE)}
        met = all(map(self.holds, asked.values()))
        if self.kind == "question":
            return "answered" if met else "no common answer"
        return "reproduced" if met else "not reproduced"


@dataclass(frozen=True)
class Judged:
    """A statement with its value for each pair, and the verdict."""

    rule: Rule
    values: Mapping[str, float]
    verdict: Verdict


RULES = tuple(
    Rule(**row) for row in read_table("reproductions.vaishya_singh_2001", "statements.toml")["statement"]
)


def judged(rule: Rule) -> Judged:
    """Judge one statement by the numbers of all pairs."""
    values = {name: rule.factor * NUMBERS[rule.number](Gears(name)) for name in PAIRS}
    return Judged(rule, values, rule.verdict(values))


def statements() -> tuple[Judged, ...]:
    """All statements and questions with their verdicts."""
    return tuple(map(judged, RULES))
