"""The report as one self-contained HTML file: page 1, then the chapters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files
from typing import Any

import jinja2

from validation.files.formatting import common_exponent, number, prose, quantity
from validation.reporting.blocks import Badge, Block, Cell, Picture, Quantity, Table
from validation.reporting.chapter import Written
from validation.reporting.page_one import PageOne


@dataclass(frozen=True)
class Part:
    """A chapter on the page: anchor, number, title, result in a sentence, and blocks."""

    anchor: str
    number: int
    title: str
    result: str
    blocks: tuple[Block, ...]


def render(
    first: PageOne,
    pictures: tuple[Picture, ...],
    chapters: tuple[Written, ...],
    images: Mapping[str, str],
    data: Mapping[str, Any],
) -> str:
    """Return index.html. ``images``: key of a picture -> data URI; ``data``: report.json."""
    parts = tuple(
        Part(chapter.key, number, chapter.title, content.result, content.blocks)
        for number, (chapter, content) in enumerate(chapters, 1)
    )
    shown = [block for part in parts for block in part.blocks]
    numbers = {
        id(block): count
        for kind, start in ((Picture, len(pictures) + 1), (Table, 1))
        for count, block in enumerate((b for b in shown if isinstance(b, kind)), start)
    }
    return (
        environment()
        .get_template("report.html")
        .render(
            first=first,
            pictures=pictures,
            parts=parts,
            numbers=numbers,
            images=images,
            data=data,
            limits=limits(),
        )
    )


def limits() -> list[str]:
    """Return the limits of the program, one or two sentences each. docs/limits.md has the same text."""
    text = files("validation").joinpath("templates/limits.md").read_text(encoding="utf-8")
    return [" ".join(entry.split()) for entry in text.removeprefix("- ").split("\n- ")]


@lru_cache(maxsize=1)
def environment() -> jinja2.Environment:
    """Return the templates, with the filters for blocks."""
    templates = jinja2.Environment(
        loader=jinja2.PackageLoader("validation", "templates"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    templates.filters |= {
        "shown_rows": shown_rows,
        "prose": prose,
        "id": id,
        "kind": lambda block: type(block).__name__,
        "numeric_columns": _numeric_columns,
    }
    templates.tests |= {"badge": lambda value: isinstance(value, Badge), "numeric": _is_numeric}
    return templates


def _is_numeric(value: object) -> bool:
    return isinstance(value, (int, float, Quantity)) and not isinstance(value, bool)


def _numeric_columns(table: Table) -> list[bool]:
    """Whether each column has a number in any row. Headings and gaps of these columns are right-aligned."""
    return [any(_is_numeric(row[k]) for row in table.rows) for k in range(len(table.columns))]


def shown_rows(table: Table) -> list[list[str | Badge]]:
    """Return the texts and badges of the cells. All numbers of a unit in a column have one prefix."""
    columns = zip(*table.rows, strict=True)
    exponents = [_exponents(column) for column in columns]
    return [
        [
            value if isinstance(value, Badge) else cell(value, exponents=exponents_of_column)
            for value, exponents_of_column in zip(row, exponents, strict=True)
        ]
        for row in table.rows
    ]


def _exponents(column: Sequence[Cell]) -> dict[str, int]:
    """Unit -> exponent of ten of its prefix in a column."""
    sizes: dict[str, list[float]] = {}
    for value in column:
        if isinstance(value, Quantity):
            sizes.setdefault(value.unit, []).append(value.value)
    exponents = {unit: common_exponent(values) for unit, values in sizes.items()}
    return {unit: exponent for unit, exponent in exponents.items() if exponent is not None}


def cell(value: Cell, digits: int = 4, exponents: Mapping[str, int] | None = None) -> str:
    """Return the text of a cell. ``exponents``: unit -> exponent of ten of the prefix of all its numbers."""
    if value is None:
        return "–"
    if isinstance(value, Badge):
        return value.label
    if isinstance(value, Quantity):
        return quantity(value.value, value.unit, digits, exponent=(exponents or {}).get(value.unit))
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return number(value, digits)
    if isinstance(value, int):
        return str(value).replace("-", "\u2212")
    return prose(str(value))
