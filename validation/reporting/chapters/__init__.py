"""The chapters of the report, one module each, in their order. A module defines ``CHAPTER``.

The chapters at rest, on unlike teeth and on a record are left out where they do not apply.
"""

from validation.reporting.chapter import Chapter
from validation.reporting.chapters import (
    at_rest,
    contact_loss,
    evidence,
    forces,
    how_sure,
    inputs,
    losses,
    record,
    response,
    second_program,
    stability,
    teeth,
)

CHAPTERS: tuple[Chapter, ...] = tuple(
    module.CHAPTER
    for module in (
        at_rest,
        response,
        forces,
        contact_loss,
        stability,
        teeth,
        losses,
        how_sure,
        record,
        second_program,
        inputs,
        evidence,
    )
)
