"""Blocks of the report: texts, tables and pictures, as plain data that becomes HTML, JSON and CSV.

Chapters show numbers only through these blocks. The page therefore shows no number that is missing in
report.json. Numbers are in SI, or in the unit that stands beside the number ("rpm", "°", "%").
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar

import xarray as xr

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: State of a badge -> class in the page, which sets the colour. The word of the badge is always printed too.
STATES = {
    "ok": "good",
    "agrees": "good",
    "stable": "good",
    "neutral": "good",
    "warning": "fair",
    "differs": "fair",
    "undecided": "fair",
    "violated": "bad",
    "failed": "bad",
    "unstable": "bad",
    "plain": "plain",
}


@dataclass(frozen=True)
class Badge:
    """A verdict in one word. ``state`` is a key of ``STATES``; ``text`` replaces the word."""

    state: str
    text: str = ""

    @property
    def tone(self) -> str:
        """Class of the badge: good, fair, bad or plain."""
        return STATES[self.state]

    @property
    def label(self) -> str:
        """Words of the badge."""
        return self.text or self.state


@dataclass(frozen=True)
class Quantity:
    """A number with its unit: an SI unit, or "rpm", "°" or "%"; "1" for a ratio. The page adds a prefix."""

    value: float
    unit: str


Cell = str | int | float | bool | Quantity | Badge | None
T = TypeVar("T")


@dataclass(frozen=True)
class Column(Generic[T]):
    """A column of a table. A chapter declares the column here and nowhere else.

    report.json, the CSV file, the workbook and the page read name, heading and unit from this declaration.
    The tests recompute every column; see "Add a column" in CONTRIBUTING.md.

    Attributes
    ----------
    name : name in report.json, in the CSV file and in the tests
    heading : heading on the page
    read : function from the item of a row to the value in this column
    unit : unit of the value, SI or "rpm", "°", "%"; "1" for a ratio. Empty: ``read`` returns words, a
        count, a badge, or a `Quantity` whose unit differs from row to row
    """

    name: str
    heading: str
    read: Callable[[T], Cell]
    unit: str = ""

    def cell(self, item: T) -> Cell:
        """Cell of the row of an item. A value that is None stays None: the cell is empty."""
        value = self.read(item)
        if not self.unit or value is None:
            return value
        if isinstance(value, (str, bool, Quantity, Badge)):
            raise TypeError(f"column {self.name} has the unit {self.unit}, but {value!r} is no number")
        return Quantity(float(value), self.unit)


@dataclass(frozen=True)
class Table:
    """A table of the report.

    Attributes
    ----------
    key : name in report.json, of the CSV file and of the sheet
    caption : sentence above the table
    columns : name of each column -> heading
    rows : cells, row by row
    note : sentence below the table
    """

    key: str
    caption: str
    columns: Mapping[str, str]
    rows: tuple[tuple[Cell, ...], ...]
    note: str = ""


def table_of(
    key: str, caption: str, items: Iterable[T], columns: Sequence[Column[T]], note: str = ""
) -> Table:
    """Return the table with one row for each item. Each column reads its cell from the item."""
    headings = {column.name: column.heading for column in columns}
    rows = tuple(tuple(column.cell(item) for column in columns) for item in items)
    return Table(key, caption, headings, rows, note)


class NamedNumber(NamedTuple):
    """A row of a table of named numbers: name, value, unit of the value as in `Quantity`, and a note."""

    name: str
    value: float
    unit: str
    note: str = ""


def named_numbers(
    key: str, caption: str, numbers: Iterable[NamedNumber], *more: Column[NamedNumber]
) -> Table:
    """Return a table of named numbers. ``more``: further columns, between the value and the note."""
    return table_of(
        key,
        caption,
        numbers,
        (
            Column("name", "", lambda number: number.name),
            Column("value", "value", lambda number: Quantity(float(number.value), number.unit)),
            *more,
            Column("note", "", lambda number: number.note),
        ),
    )


@dataclass(frozen=True)
class Picture:
    """A figure and the dataset that the figure draws.

    Attributes
    ----------
    key : name of the figure file and of the CSV file of the dataset
    caption : sentence below the figure
    data : dataset; every variable has a unit attribute
    draw : function from the dataset to the figure
    """

    key: str
    caption: str
    data: xr.Dataset
    draw: Callable[[xr.Dataset], Figure]

    def figure(self) -> Figure:
        """Draw the figure."""
        return self.draw(self.data)


@dataclass(frozen=True)
class Text:
    """A paragraph, or a list where ``items`` are given."""

    text: str
    items: tuple[str, ...] = ()


Block = Text | Table | Picture


@dataclass(frozen=True)
class Content:
    """A written chapter.

    Attributes
    ----------
    result : the result of the chapter in one sentence
    blocks : texts, tables and pictures below the sentence
    """

    result: str
    blocks: tuple[Block, ...]


def plain(value: Cell) -> Any:
    """Return a cell as JSON data. A number that is not finite becomes null."""
    if isinstance(value, Badge):
        return {"state": value.state, "text": value.label}
    if isinstance(value, Quantity):
        return {"value": plain(value.value), "unit": value.unit}
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    return value


#: Keys of a chapter's data that hold no results: words, and which figures there are.
REMARKS = ("text", "figures", "captions", "tables")


def chapter_data(title: str, content: Content) -> dict[str, Any]:
    """Return all texts, tables and captions of a chapter as JSON data."""
    data: dict[str, Any] = {"title": title, "text": [[content.result]]}
    for block in content.blocks:
        if isinstance(block, Table):
            data[block.key] = [dict(zip(block.columns, map(plain, row), strict=True)) for row in block.rows]
            about = {"caption": block.caption} | ({"note": block.note} if block.note else {})
            data.setdefault("tables", {})[block.key] = about
        elif isinstance(block, Picture):
            data.setdefault("figures", []).append(block.key)
            data.setdefault("captions", {})[block.key] = block.caption
        else:
            data["text"].append([block.text, *block.items])
    return data
