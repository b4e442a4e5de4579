"""The chapters of the report, one module each, in their order: nine, and one where teeth differ.

A module writes ``CHAPTER``.
"""

from validation.reporting.chapter import Chapter
from validation.reporting.chapters import (
    contact_loss,
    evidence,
    forces,
    how_sure,
    inputs,
    losses,
    response,
    second_program,
    stability,
    teeth,
)

CHAPTERS: tuple[Chapter, ...] = tuple(
    module.CHAPTER
    for module in (
        response,
        forces,
        contact_loss,
        stability,
        teeth,
        losses,
        how_sure,
        second_program,
        inputs,
        evidence,
    )
)
