"""What the report is made of: plain data that becomes HTML, JSON and CSV.

Chapters show numbers only through these blocks, so the page shows no number that report.json does not have. A
picture draws one dataset, which is written beside it.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeVar

import xarray as xr
from matplotlib.figure import Figure

#: State of a badge -> its class in the page. The words themselves always stand beside the colour.
STATES = {
    "ok": "good",
    "agrees": "good",
    "stable": "good",
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
T = TypeVar("T")


@dataclass(frozen=True)
class Table:
    """A table; ``key`` names it in report.json and its CSV file, ``columns`` are name -> heading."""

    key: str
    caption: str
    columns: Mapping[str, str]
    rows: tuple[tuple[Cell, ...], ...]
    note: str = ""


def table_of(
    key: str,
    caption: str,
    items: Sequence[T],
    columns: Mapping[str, tuple[str, Callable[[T], Cell]]],
    note: str = "",
) -> Table:
    """Table with one row per item; ``columns``: name in report.json -> heading, and the cell of an item."""
    return Table(
        key,
        caption,
        {name: heading for name, (heading, _) in columns.items()},
        tuple(tuple(cell(item) for _, cell in columns.values()) for item in items),
        note,
    )


def quantities(key: str, caption: str, *rows: tuple[str, float, str] | tuple[str, float, str, str]) -> Table:
    """Table of named numbers: a row is a label, a number, its unit in SI, and a note."""
    cells = tuple((row[0], Quantity(float(row[1]), row[2]), row[3] if len(row) > 3 else "") for row in rows)
    return Table(key, caption, {"name": "", "value": "value", "note": ""}, cells)


@dataclass(frozen=True)
class Picture:
    """A figure of one dataset, which is written as CSV beside it; ``key`` names both."""

    key: str
    caption: str
    data: xr.Dataset
    draw: Callable[[xr.Dataset], Figure]

    def figure(self) -> Figure:
        """The figure of its dataset."""
        return self.draw(self.data)


@dataclass(frozen=True)
class Text:
    """A paragraph, or a list where ``items`` are given."""

    text: str
    items: tuple[str, ...] = ()


Block = Text | Table | Picture


@dataclass(frozen=True)
class Content:
    """What a chapter says about one gear pair: its result in one sentence, then blocks."""

    result: str
    blocks: tuple[Block, ...]


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
