"""The HTML page, by a jinja2 template that escapes everything."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from lumped import GearPair
from validation.reporting.blocks import Answer, Badge, Block, Facts, Picture, Quantity, Table, Text
from validation.reporting.chapter import Chapter, Written
from validation.reporting.formatting import cell, prose


def render(
    pair: GearPair,
    answer_figure: Picture,
    answers: Mapping[str, Answer],
    chapters: tuple[Written, ...],
    images: Mapping[str, str],
    data: Mapping[str, Any],
) -> str:
    """Return the page as text.

    Parameters
    ----------
    pair : the gear pair
    answer_figure : the figure of the first page
    answers : key of the chapter that says why -> answer at the top
    chapters : content
    images : figure key -> data URI
    data : what report.json holds, for verdict, dates and mode
    """
    environment = Environment(
        loader=PackageLoader("validation", "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["cell"] = cell
    environment.filters["prose"] = prose
    environment.filters["kind"] = _kind
    environment.filters["id"] = id
    environment.filters["numeric_columns"] = _numeric_columns
    environment.tests["badge"] = lambda value: isinstance(value, Badge)
    environment.tests["numeric"] = _is_numeric
    template = environment.get_template("report.html")
    front, evidence = layers(chapters)
    return template.render(
        pair=pair,
        answer_figure=answer_figure,
        tone=max(
            *(a.badge.tone for a in answers.values()),
            "fair" if data["doubts"] else "plain",
            key=_TONES.index,
        ),
        answers=answers,
        front=front,
        evidence=evidence,
        numbers=numbered((*front, *evidence)),
        images=images,
        data=data,
    )


@dataclass(frozen=True)
class Part:
    """What one layer of the page shows of a chapter.

    Attributes
    ----------
    anchor : its id in the page
    number : of the chapter in its layer
    chapter : title, key
    badge : verdict beside the heading
    blocks : in order
    """

    anchor: str
    number: str
    chapter: Chapter
    badge: Badge | None
    blocks: tuple[Block, ...]


def layers(chapters: tuple[Written, ...]) -> tuple[tuple[Part, ...], tuple[Part, ...]]:
    """The chapters for the reader who decides, then the evidence; every block is in one of them."""
    front: list[Part] = []
    evidence: list[Part] = []
    for chapter, content in chapters:
        shown = [block for block in content.blocks if getattr(block, "key", None) in chapter.front]
        if shown:
            first = content.blocks.index(shown[0])
            shown = [b for b in content.blocks[:first] if isinstance(b, Text)] + shown
            front.append(Part(chapter.key, str(len(front) + 1), chapter, content.badge, tuple(shown)))
        rest = tuple(block for block in content.blocks if not any(block is one for one in shown))
        if rest:
            anchor = f"{chapter.key}-evidence" if shown else chapter.key
            evidence.append(Part(anchor, f"A{len(evidence) + 1}", chapter, content.badge, rest))
    return tuple(front), tuple(evidence)


def numbered(parts: tuple[Part, ...]) -> dict[int, int]:
    """Number of every figure, and of every table, in the order of the page, by the block's identity."""
    numbers: dict[int, int] = {}
    for kind in (Picture, Table):
        shown = (block for part in parts for block in part.blocks if isinstance(block, kind))
        numbers |= {id(block): count for count, block in enumerate(shown, 2 if kind is Picture else 1)}
    return numbers


#: Tones of badges, the worst last.
_TONES = ("plain", "good", "fair", "bad")


def _kind(block: Block) -> str:
    if isinstance(block, Facts):
        return "facts"
    if isinstance(block, Table):
        return "table"
    return "picture" if isinstance(block, Picture) else "text"


def _is_numeric(value: object) -> bool:
    return isinstance(value, (int, float, Quantity)) and not isinstance(value, bool)


def _numeric_columns(table: Table) -> list[bool]:
    """Which columns hold numbers, at least in one row: their headings and gaps stand to the right too."""
    return [any(_is_numeric(row[k]) for row in table.rows) for k in range(len(table.columns))]
