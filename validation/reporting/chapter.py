"""What a chapter of the report is, before it is written for a gear pair."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from validation.reporting.blocks import Content
from validation.reporting.results import Results


@dataclass(frozen=True)
class Chapter:
    """A chapter of the report.

    Attributes
    ----------
    key : anchor in the page and name in report.json
    title : heading
    write : computes what the chapter alone needs and writes it; None where the report leaves the chapter out
    seconds : about how long that takes in a full report, for the progress bar [s]
    """

    key: str
    title: str
    write: Callable[[Results], Content | None]
    seconds: float = 0.1


#: A chapter with what it says about a gear pair.
Written = tuple[Chapter, Content]
