"""What a chapter of the report is, before it is written for a gear pair."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from validation.reporting.blocks import Answer, Content
from validation.reporting.results import Results


@dataclass(frozen=True)
class Chapter:
    """A chapter of the report.

    Attributes
    ----------
    key : anchor in the page and name in report.json
    title : heading
    write : computes what the chapter alone needs and writes it; None where the report leaves the chapter out
    answer : to one of the questions at the top of the report, if the chapter decides it
    front : keys of the blocks for the reader who decides, with the text before the first of them; the rest
        of the chapter, or all of it, is evidence
    seconds : about how long that takes in a full report, for the progress bar [s]
    """

    key: str
    title: str
    write: Callable[[Results], Content | None]
    answer: Callable[[Results], Answer] | None = None
    front: tuple[str, ...] = ()
    seconds: float = 0.1


#: A chapter with what it says about a gear pair.
Written = tuple[Chapter, Content]
