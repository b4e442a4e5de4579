"""Sentences of a check."""

from __future__ import annotations

from typing import TYPE_CHECKING

from validation.check.curves import Role
from validation.files.formatting import percent, quantity

if TYPE_CHECKING:
    from validation.check.static import StaticRow

__all__ = ["percent", "static_words", "subject"]


def subject(role: Role) -> str:
    """Return the grammatical subject of the sentences."""
    return "Your model" if role == "model" else "The record"


def static_words(row: StaticRow) -> str:
    """Return a static quantity that differs, with both values: "contact ratio 1.71, spurcheck 1.64"."""
    return f"{row.name} {quantity(row.theirs, row.unit, 4)}, spurcheck {quantity(row.ours, row.unit, 4)}"
