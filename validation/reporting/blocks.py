"""What a chapter of the report is made of: plain data that becomes both HTML and JSON.

Chapters show numbers only through these blocks, and every block goes into report.json. The page therefore
shows no number that report.json does not have.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

import xarray as xr
from matplotlib.figure import Figure

#: State of a badge -> its class in the page. The words themselves always stand beside the colour.
STATES = {
    "ok": "good",
    "confirmed": "good",
    "agrees": "good",
    "stable": "good",
    "within": "good",
    "warning": "fair",
    "differs": "fair",
    "not checked": "fair",
    "undecided": "fair",
    "violated": "bad",
    "not confirmed": "bad",
    "fails": "bad",
    "unstable": "bad",
    "outside": "bad",
    "prediction": "plain",
}


@dataclass(frozen=True)
class Badge:
    """A verdict in a word; ``state`` is a key of ``STATES``."""

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
    """A number in SI with its unit ("1" for a ratio), shown with a prefix."""

    value: float
    unit: str


Cell = str | int | float | bool | Quantity | Badge | None
Rows = list[tuple[Cell, ...]]
T = TypeVar("T")


@dataclass(frozen=True)
class Table:
    """A table.

    Attributes
    ----------
    key : name in report.json
    caption : what it shows
    columns : name in report.json -> heading
    rows : cells, one per column
    marked : indices of rows to highlight
    note : remark below
    """

    key: str
    caption: str
    columns: Mapping[str, str]
    rows: tuple[tuple[Cell, ...], ...]
    marked: frozenset[int] = frozenset()
    note: str = ""


def table_of(
    key: str,
    caption: str,
    items: Sequence[T],
    columns: Mapping[str, tuple[str, Callable[[T], Cell]]],
    *,
    marked: Callable[[T], bool] = lambda item: False,
    note: str = "",
) -> Table:
    """Table with one row per item.

    Parameters
    ----------
    key, caption, note : of the table
    items : what the rows are about
    columns : name in report.json -> heading, and the cell of an item
    marked : whether to highlight an item's row
    """
    return Table(
        key,
        caption,
        {name: heading for name, (heading, _) in columns.items()},
        tuple(tuple(cell(item) for _, cell in columns.values()) for item in items),
        frozenset(place for place, item in enumerate(items) if marked(item)),
        note,
    )


@dataclass(frozen=True)
class Fact:
    """One named number or word with what it means."""

    key: str
    label: str
    value: Cell
    note: str = ""


@dataclass(frozen=True)
class Facts:
    """A list of facts."""

    key: str
    items: tuple[Fact, ...]


FactRow = tuple[str, str, Cell] | tuple[str, str, Cell, str] | tuple[str, str, Cell, str, str]


def facts(key: str, *rows: FactRow) -> Facts:
    """List of facts: a row is key, label and value, then the unit of a number ("" for none), then a note."""
    return Facts(key, tuple(map(_fact, rows)))


def _fact(row: FactRow) -> Fact:
    key, label, value, unit, note = (*row, "", "")[:5]
    return Fact(key, label, Quantity(float(value), unit) if unit else value, note)


@dataclass(frozen=True)
class Picture:
    """A figure, drawn when it is needed.

    Attributes
    ----------
    key : file name without suffix, and name in report.json
    caption : what it shows and what to see in it
    draw : makes the figure
    """

    key: str
    caption: str
    draw: Callable[[], Figure]


@dataclass(frozen=True)
class Text:
    """A paragraph, or a list where ``items`` are given."""

    text: str
    items: tuple[str, ...] = ()


Block = Text | Facts | Table | Picture


@dataclass(frozen=True)
class Answer:
    """A question that the reader has, answered at the top of the report.

    Attributes
    ----------
    question : in plain words
    badge : the verdict
    text : the answer in a line
    """

    question: str
    badge: Badge
    text: str


@dataclass(frozen=True)
class Content:
    """What a chapter says about one gear pair.

    Attributes
    ----------
    blocks : in order
    badge : verdict beside the heading, if the chapter has one
    data : file name below data/ without suffix -> dataset behind the figures
    write_more : writes further files into the folder data/
    """

    blocks: tuple[Block, ...]
    badge: Badge | None = None
    data: Mapping[str, xr.Dataset] = field(default_factory=dict)
    write_more: Callable[[Path], None] | None = None


def plain(value: Cell) -> Any:
    """Cell as JSON data; a number that is not finite becomes null."""
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
    """Everything a chapter shows, as JSON data."""
    data: dict[str, Any] = {"title": title}
    if content.badge is not None:
        data["verdict"] = plain(content.badge)
    for block in content.blocks:
        if isinstance(block, Facts):
            data[block.key] = {fact.key: _fact_data(fact) for fact in block.items}
        elif isinstance(block, Table):
            data[block.key] = [dict(zip(block.columns, map(plain, row), strict=True)) for row in block.rows]
            about = {"caption": block.caption} | ({"note": block.note} if block.note else {})
            data.setdefault("tables", {})[block.key] = about
        elif isinstance(block, Picture):
            data.setdefault("figures", []).append(block.key)
            data.setdefault("captions", {})[block.key] = block.caption
        else:
            data.setdefault("text", []).append([block.text, *block.items])
    return data


def _fact_data(fact: Fact) -> dict[str, Any]:
    data: dict[str, Any] = {"label": fact.label, "value": plain(fact.value)}
    return data | {"note": fact.note} if fact.note else data
