"""Why a result is not there: a code with a text, in the place of strings and None.

A function that may have no result returns ``A | Absent``. The code is for programs, the text for people.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Outcome(Enum):
    """Codes; the value is the text that a reader gets."""

    CONTACT_NOT_LOST = "Contact is never lost, so the linear motion is the motion."
    FAILED = "The computation failed."
    NOT_ASKED = "It was not asked for."
    NO_SHAFTS = "No shafts are given."

    @property
    def text(self) -> str:
        """The meaning, as a sentence."""
        return self.value


@dataclass(frozen=True)
class Absent:
    """A result that is not there: the code, and what else is known, e.g. the message of the error."""

    outcome: Outcome
    detail: str = ""

    def __str__(self) -> str:
        """Return the text, then the detail."""
        return f"{self.outcome.text} {self.detail}".strip()
