"""The HTML page, by a jinja2 template that escapes everything."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined

from lumped import GearPair
from validation.reporting.blocks import Answer, Badge, Block, Facts, Picture, Quantity, Table
from validation.reporting.chapter import Written
from validation.reporting.formatting import cell


def render(
    pair: GearPair,
    answers: Mapping[str, Answer],
    chapters: tuple[Written, ...],
    images: Mapping[str, str],
    data: Mapping[str, Any],
) -> str:
    """Return the page as text.

    Parameters
    ----------
    pair : the gear pair
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
    environment.filters["kind"] = _kind
    environment.filters["numeric_columns"] = _numeric_columns
    environment.tests["badge"] = lambda value: isinstance(value, Badge)
    environment.tests["numeric"] = _is_numeric
    template = environment.get_template("report.html")
    return template.render(pair=pair, answers=answers, chapters=chapters, images=images, data=data)


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
