"""Sentences of a check."""

from __future__ import annotations

from lumped.fields.units import to_stated
from validation.check.curves import Role
from validation.check.ladder import Ladder
from validation.check.misfit import Misfit
from validation.check.over_speed import SpeedMisfit
from validation.check.problem import Problem
from validation.check.static import StaticRow, StaticRung
from validation.files.formatting import percent, quantity

__all__ = [
    "FAR",
    "ladder_words",
    "low_speed_failure",
    "motion_failure",
    "percent",
    "speed_failure",
    "static_failure",
    "static_words",
    "subject",
]

#: Explanations that leave more than this many times the limit explain little.
FAR = 3.0
#: Most static quantities, and most channels, in a sentence.
_MOST = 3


def subject(role: Role) -> str:
    """Return the grammatical subject of the sentences."""
    return "Your model" if role == "model" else "The record"


def static_failure(rung: StaticRung) -> str:
    """Return the sentence on static quantities that differ."""
    return f"Before anything moves: {'; '.join(static_words(row) for row in rung.wrong[:_MOST])}."


def low_speed_failure(problem: Problem) -> str:
    """Return the sentence on a transmission error that differs where the motion is nearly static."""
    rpm = to_stated(problem.pair.operating.pinion_speed, "rpm")
    size = percent(problem.misfit.value)
    return f"Already at {rpm:.0f} rpm the transmission error differs by {size}: look at the statics first."


def motion_failure(misfit: Misfit, limit: float) -> str:
    """Return the sentence on the channels that differ most, with their misfits."""
    rows = sorted(misfit.channels, key=lambda row: -row.total)
    wrong = [row for row in rows if row.total > limit][:_MOST] or rows[:1]
    names = ", ".join(f"{row.channel.channel.name} {percent(row.total)}" for row in wrong)
    return f"Most in {names}."


def speed_failure(misfit: SpeedMisfit) -> str:
    """Return the sentence on the speed at which values over speed differ most."""
    return f"The largest difference is at {to_stated(misfit.worst_speed, 'rpm'):.0f} rpm."


def ladder_words(ladder: Ladder, limit: float) -> str:
    """Return the sentences on the steps of the ladder, and whether they bring the misfit below the limit."""
    if not ladder.steps:
        return "No named explanation makes the difference much smaller."
    last = ladder.steps[-1].misfit
    first = ladder.steps[0]
    if last > FAR * limit:
        causes = "; ".join(step.sentence.removeprefix("Compatible with ") for step in ladder.steps)
        return f"No named explanation brings the misfit below {percent(last)}; the nearest is {causes}."
    sentences = [f"{first.sentence}: the misfit is then {percent(first.misfit)}."]
    sentences += [
        f"Then {step.sentence[0].lower()}{step.sentence[1:]}: {percent(step.misfit)}."
        for step in ladder.steps[1:]
    ]
    if last > limit:
        sentences.append("The misfit stays above the limit: something else differs too.")
    return " ".join(sentences)


def static_words(row: StaticRow) -> str:
    """Return a static quantity that differs, with both values: "contact ratio 1.71, spurcheck 1.64"."""
    return f"{row.name} {quantity(row.theirs, row.unit, 4)}, spurcheck {quantity(row.ours, row.unit, 4)}"
