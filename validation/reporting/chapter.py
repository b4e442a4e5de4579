"""What a chapter of the report is, before it is written for a gear pair."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from validation.reporting.blocks import Content
from validation.reporting.results import Results


@dataclass(frozen=True)
class Chapter:
    """A chapter of the report; ``write`` gives None where the report leaves it out.

    ``key`` is its anchor and its name in report.json; ``seconds`` about what it takes, for the progress bar
    [s].
    """

    key: str
    title: str
    write: Callable[[Results], Content | None]
    seconds: float = 0.1


#: A chapter with what it says about a gear pair.
Written = tuple[Chapter, Content]
