"""Sentences of a check."""

from __future__ import annotations

from typing import TYPE_CHECKING

from validation.check.curves import Role
from validation.files.formatting import percent, quantity

if TYPE_CHECKING:
    from validation.check.check import Check
    from validation.check.static import StaticRow

__all__ = ["channel_words", "differs_words", "percent", "static_words", "subject"]

#: Most static quantities, and most channels, in a sentence.
_MOST = 3


def subject(role: Role) -> str:
    """Return the grammatical subject of the sentences."""
    return "Your model" if role == "model" else "The record"


def differs_words(check: Check) -> str:
    """Return the sentences on what differs and what the curves are compatible with, with a blank before.

    Empty: nothing differs.
    """
    from validation.check.check import Rung

    if check.failed is None:
        return ""
    parts = []
    if check.failed is Rung.STATIC:
        parts.append(
            f"Before anything moves: {'; '.join(static_words(row) for row in check.static.wrong[:_MOST])}."
        )
    if check.failed is Rung.LOW_SPEED and check.low_speed is not None:
        size = percent(check.low_speed.misfit.value)
        rpm = check.low_speed.pair.operating.pinion_speed * 9.549296585513721
        parts.append(
            f"Already at {rpm:.0f} rpm the transmission error differs by {size}: look at the statics first."
        )
    if check.failed is Rung.MOTION:
        parts.append(f"{channel_words(check)}.")
    if check.failed is Rung.OVER_SPEED and check.over_speed is not None:
        rpm = check.over_speed.worst_speed * 9.549296585513721
        parts.append(f"The largest difference is at {rpm:.0f} rpm.")
    if check.explanations:
        first = check.explanations[0]
        parts.append(f"{first.sentence}: the misfit is then {percent(first.misfit)}.")
        parts += [
            f"Then {step.sentence[0].lower()}{step.sentence[1:]}: {percent(step.misfit)}."
            for step in check.explanations[1:]
        ]
    elif check.ladder is not None and check.failed is Rung.MOTION:
        parts.append("No named explanation makes the difference much smaller.")
    return "".join(f" {part}" for part in parts)


def static_words(row: StaticRow) -> str:
    """Return a static quantity that differs, with both values: "contact ratio 1.71, spurcheck 1.64"."""
    return f"{row.name} {quantity(row.theirs, row.unit, 4)}, spurcheck {quantity(row.ours, row.unit, 4)}"


def channel_words(check: Check) -> str:
    """Return the channels that differ most, with their misfits."""
    rows = sorted(check.nearer.channels, key=lambda row: -row.total)
    wrong = [row for row in rows if row.total > check.limit][:_MOST] or rows[:1]
    names = ", ".join(f"{row.channel.channel.name} {percent(row.total)}" for row in wrong)
    return f"Most in {names}"
