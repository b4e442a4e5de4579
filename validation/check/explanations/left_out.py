"""Explanations of what the comparison of settled mesh orders leaves out: a transient, few digits, a drift.

Where curves differ the ladder tries those with choices; where they agree ``validation.check.agreeing`` finds
all of them.

Sources: docs/how_to/check_your_model.md, "Explanations".
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from validation.check.explanations.cause import Cause, Choice, Kind, Variant
from validation.check.problem import Problem

#: A change of the last cycles above this share of the motion is seen in the curves alone.
CHANGES = 0.01
#: A change of the last cycles up to this share of the motion is a motion that repeats.
_REPEATS = 1e-3


def _reading(label: str, words: str, **changes: Any) -> Choice:
    """A fixed value that changes the reading."""
    return Choice(label, words, lambda variant: variant.with_reading(replace(variant.reading, **changes)))


def _not_settled(problem: Problem, variant: Variant) -> list[Choice]:
    # Its waves have many free amplitudes: where the last cycles repeat, they fit what other causes leave.
    settled = problem.settled.change <= _REPEATS
    if variant.reading.decaying or problem.curves.role != "model" or settled:
        return []
    words = "a motion that has not settled: free vibrations still decay"
    shown = problem.settled.change > CHANGES
    return [_reading("not settled", words, decaying=True)._replace(shown=shown)]


def _few_digits(problem: Problem, variant: Variant) -> list[Choice]:
    """Samples that are written in steps: ours are rounded as theirs are."""
    if not problem.steps:
        return []
    names = ", ".join(problem.steps)
    words = f"few digits in {names}: all samples are multiples of a coarse step"
    return [_reading(names, words, rounded=True)]


#: Free vibrations that decay. Where the compared cycles agree, and those before do not,
#: ``validation.check.agreeing`` finds them.
NOT_SETTLED = Cause(
    "not settled", Kind.READING, "free vibrations that still decay", "not settled; at the start", _not_settled
)
#: Values of few digits, where steps show. Where they agree at every order and scatter
#: ``validation.check.agreeing`` finds them.
FEW_DIGITS = Cause(
    name="few digits",
    kind=Kind.READING,
    meaning="a channel in few digits: values in coarse steps, or angles in single precision, which scatter",
    span="steps above 1 % of the peak to peak; scatter above twice the limit",
    choices=_few_digits,
)
#: A brake torque that does not hold the speed. The drift is no part of the misfit:
#: ``validation.check.agreeing`` finds it.
BRAKE = Cause(
    name="brake torque",
    kind=Kind.INPUT,
    meaning="a brake torque that does not hold the mean speed, such as one without the loss of friction",
    span="from the drift of a rotation",
)
#: Errors of an integration. They are at no mesh order: ``validation.check.agreeing`` finds them.
INTEGRATION = Cause(
    name="errors of the integration",
    kind=Kind.READING,
    meaning="an integration with coarse tolerances: it agrees at the mesh orders, and moves at others too",
    span="motion at no mesh order above the limit that does not decay",
)
#: What an export has left out: it is no difference. (Whole angles leave nothing out, and a note tells them.)
EXPORT = Cause(
    name="form of the export",
    kind=Kind.READING,
    meaning="curves that agree but for means that the export has removed",
    span="without means",
)

#: Causes of what the comparison leaves out.
LEFT_OUT = (NOT_SETTLED, FEW_DIGITS, BRAKE, INTEGRATION, EXPORT)
