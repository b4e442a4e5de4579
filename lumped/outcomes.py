"""Reasons why a result is missing: a code with a text, instead of strings and None.

A function that may have no result returns ``A | Absent``. The code is for programs, the text for people.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Outcome(Enum):
    """Codes of the reasons. The value of a code is its text for a reader."""

    CONTACT_NOT_LOST = "Contact is never lost, so the linear motion is the motion."
    FAILED = "The computation failed."
    NOT_ASKED = "This computation does not include it."
    QUICK = "A quick report does not compute it. Run without --quick."
    ALIKE = "All teeth of a gear are alike."
    KNOWN = "No input is assumed or has a range."
    NO_SHAFTS = "No shafts are given."

    @property
    def text(self) -> str:
        """The meaning, as a sentence."""
        return self.value


@dataclass(frozen=True)
class Absent:
    """A missing result: the code, and a detail, e.g. the message of the error."""

    outcome: Outcome
    detail: str = ""

    def __str__(self) -> str:
        """Return the text, then the detail."""
        return f"{self.outcome.text} {self.detail}".strip()
