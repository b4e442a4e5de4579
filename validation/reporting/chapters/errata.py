"""Errata of the paper's print, each shown by computation with this gear pair."""

from __future__ import annotations

from functools import partial

from validation.reporting.blocks import Badge, Block, Content, Fact, Facts, Picture, Text, table_of
from validation.reporting.chapter import Chapter
from validation.reporting.paper_results import PaperResults
from validation.reporting.results import Results
from validation.reporting.words import cautions


def write(results: Results) -> Content | None:
    """Write the chapter; None where the comparison with the paper was not asked for."""
    if not isinstance(results.paper, PaperResults):
        return None
    from validation.paper import draw_errata  # most reports do without the paper

    chapter = results.paper.errata
    blocks: list[Block] = [
        *cautions(results),
        Text(chapter.text),
        Facts("conditions", tuple(Fact(name, name, value) for name, value in chapter.conditions.items())),
        table_of(
            "errata",
            "Misprints and their repair.",
            chapter.errata,
            {
                "equation": ("equation", lambda e: e.equation),
                "printed": ("printed", lambda e: e.printed),
                "repaired": ("repaired", lambda e: e.repaired),
                "verdict": ("the print is", lambda e: Badge("misprint", e.verdict)),
                "text": ("what shows it", lambda e: e.text),
            },
        ),
        Picture(
            "errata",
            "Transmission error and motion of the gear along and off the line of action, repaired and with "
            "each printed sign put back alone.",
            partial(draw_errata, chapter),
        ),
        table_of(
            "evidence",
            "The computations.",
            [(e.equation, one) for e in chapter.errata for one in e.evidence],
            {
                "equation": ("equation", lambda item: item[0]),
                "quantity": ("quantity", lambda item: item[1].quantity),
                "printed": ("as printed", lambda item: item[1].printed),
                "repaired": ("repaired", lambda item: item[1].repaired),
                "unit": ("unit", lambda item: item[1].unit or "–"),
                "requirement": ("must hold", lambda item: item[1].requirement or None),
            },
        ),
    ]
    return Content(tuple(blocks))


CHAPTER = Chapter("errata", "Errata of the paper", write)
