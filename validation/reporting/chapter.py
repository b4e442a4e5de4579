"""A chapter of the report: its key, its title and the function that writes the chapter."""

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
    key : anchor on the page and name in report.json
    title : heading
    write : function from the results to the written chapter; None: the report leaves the chapter out
    seconds : approximate time of the chapter, for the progress bar [s]
    needs_motion : whether a pair without a motion has no such chapter
    """

    key: str
    title: str
    write: Callable[[Results], Content | None]
    seconds: float = 0.1
    needs_motion: bool = True


#: A chapter with its contents for a gear pair.
Written = tuple[Chapter, Content]
