"""Errata of the paper's print, each shown by computation with this gear pair."""

from __future__ import annotations

from functools import partial

from validation.paper import draw_errata
from validation.reporting.blocks import Badge, Block, Content, Fact, Facts, Picture, Rows, Table, Text
from validation.reporting.chapter import Chapter
from validation.reporting.paper_results import PaperResults
from validation.reporting.results import Results
from validation.reporting.words import unstable_warning


def write(results: Results) -> Content | None:
    """Write the chapter; None where the comparison with the paper was not asked for."""
    if not isinstance(results.paper, PaperResults):
        return None
    chapter = results.paper.errata
    rows: Rows = [
        (e.equation, e.printed, e.repaired, Badge("misprint", e.verdict), e.text) for e in chapter.errata
    ]
    evidence: Rows = [
        (e.equation, v.quantity, v.printed, v.repaired, v.unit or "–", v.requirement or None)
        for e in chapter.errata
        for v in e.evidence
    ]
    blocks: list[Block] = [
        *unstable_warning(results),
        Text(chapter.text),
        Facts("conditions", tuple(Fact(name, name, value) for name, value in chapter.conditions.items())),
        Table(
            "errata",
            "Misprints and their repair.",
            {
                "equation": "equation",
                "printed": "printed",
                "repaired": "repaired",
                "verdict": "the print is",
                "text": "what shows it",
            },
            tuple(rows),
        ),
        Picture(
            "errata",
            "Transmission error and motion of the gear along and off the line of action, repaired and with "
            "each printed sign put back alone.",
            partial(draw_errata, chapter),
        ),
        Table(
            "evidence",
            "The computations.",
            {
                "equation": "equation",
                "quantity": "quantity",
                "printed": "as printed",
                "repaired": "repaired",
                "unit": "unit",
                "requirement": "must hold",
            },
            tuple(evidence),
        ),
    ]
    return Content(tuple(blocks))


CHAPTER = Chapter("errata", "Errata of the paper", write)
