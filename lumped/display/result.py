"""Results that people read: a short text at the prompt, a table with a picture in a notebook.

A result is a dataclass that inherits from ``DisplayedResult``. Words and units of its table come from the
docstrings of its attributes, so that they stand in one place. See ``pictures`` for the figure beside the
table.
"""

from __future__ import annotations

import dataclasses
import difflib
import html
from collections.abc import Mapping
from enum import Enum
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np

from lumped.display.described import description
from lumped.display.formatting import MINUS, SPACE, number, quantity
from lumped.display.pictures import element_of, figure_of
from lumped.errors import ParameterError, SpurcheckError, refuse

#: Most lines of a table of a result.
MOST_ROWS = 18
#: Longest value and longest line of the text, and longest value and meaning in a notebook [characters].
_LONGEST_VALUE = 44
_LONGEST_LINE = 110
_LONGEST_CELL = 240
#: Numbers of an array that are shown.
_SHOWN_NUMBERS = 4
_CELL = "padding:1px 12px 1px 0;vertical-align:top;border:none;text-align:left;background:none"


if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Row(NamedTuple):
    """One line of the table of a result.

    Attributes
    ----------
    name : name of the attribute
    value : value with its unit, as text
    words : what the attribute means
    """

    name: str
    value: str
    words: str


def no_variables(variables: tuple[object, ...]) -> None:
    """Refuse arguments of the method ``plot`` of a result: a result has one figure."""
    if variables:
        action = "Leave it out; xarray draws one variable of a dataset: prediction.cycle['dte'].plot()."
        raise refuse("plot", variables[0], "no argument", action)


class DisplayedResult:
    """Base of results: a text of at most 20 lines, a table in notebooks, and advice on unknown names.

    Attributes
    ----------
    shown : names of the attributes in the table, in order; empty: all fields of the dataclass
    instead : name that users try -> what to write instead, after the name of the result
    """

    shown: ClassVar[tuple[str, ...]] = ()
    instead: ClassVar[Mapping[str, str]] = {}

    @property
    def heading(self) -> str:
        """Name of the kind of result, and the pair."""
        pair = self.__dict__.get("pair")
        kind = type(self).__name__
        return kind if pair is None else f"{kind} of {str(pair)[1:-1].removeprefix('GearPair ')}"

    def plot(self, *variables: object) -> Figure:
        """Draw the figure of this kind of result.

        Raises
        ------
        ParameterError : this kind of result has no figure, or a variable is named
        """
        no_variables(variables)
        return figure_of(self)

    def __repr__(self) -> str:
        """Return heading and table as text."""
        rows, left = rows_of(self, _LONGEST_VALUE)
        names = max((len(row.name) for row in rows), default=0)
        values = max((len(row.value) for row in rows), default=0)
        lines = [f"<{_shortened(self.heading, _LONGEST_LINE)}"]
        lines += [
            _shortened(f"  {r.name:<{names}}  {r.value:<{values}}  {r.words}".rstrip(), _LONGEST_LINE)
            for r in rows
        ]
        if left:
            lines.append(_shortened(f"  and: {', '.join(left)}", _LONGEST_LINE))
        return "\n".join(lines) + ">"

    def _repr_html_(self) -> str:
        """Return heading, table and picture as HTML, for notebooks."""
        rows, left = rows_of(self, _LONGEST_CELL)
        table = "".join(
            "<tr>"
            f'<td style="{_CELL}"><code>{html.escape(row.name)}</code></td>'
            f'<td style="{_CELL}">{html.escape(row.value)}</td>'
            f'<td style="{_CELL};opacity:.75">{html.escape(row.words)}</td></tr>'
            for row in rows
        )
        rest = f'<div style="opacity:.6">and: {html.escape(", ".join(left))}</div>' if left else ""
        return (
            '<div style="font-size:90%"><div style="border-bottom:1px solid #8884;padding-bottom:3px;'
            f'margin-bottom:4px"><b>{html.escape(type(self).__name__)}</b>'
            f"{html.escape(self.heading.removeprefix(type(self).__name__))}</div>"
            '<div style="display:flex;gap:20px;align-items:flex-start">'
            f'<table style="border-collapse:collapse;margin:0">{table}</table>{_picture(self)}</div>'
            f"{rest}</div>"
        )

    if not TYPE_CHECKING:  # a checker knows the attributes

        def __getattr__(self, name: str) -> Any:
            """Refuse a name that is no attribute, with the attribute that was probably meant."""
            if name.startswith("_"):
                raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
            raise AttributeError(f"a {type(self).__name__} has no {name!r}{_advice(self, name)}")


class Table(NamedTuple):
    """The table of a result.

    Attributes
    ----------
    rows : lines of the table
    left : names of public attributes without a line
    """

    rows: list[Row]
    left: list[str]


def rows_of(result: DisplayedResult, longest: int) -> Table:
    """Return the table of a result. Texts are cut to ``longest`` characters; lines without a value are left
    out.
    """
    kind = type(result)
    names = kind.shown or tuple(name for name in _fields(kind) if name not in ("pair", "plain"))
    rows = [row for name in names[:MOST_ROWS] if (row := _row(result, name, longest)).value]
    left = [name for name in (*names[MOST_ROWS:], *public_names(kind)) if name not in names[:MOST_ROWS]]
    return Table(rows, list(dict.fromkeys(left)))


def public_names(kind: type) -> list[str]:
    """Return the names that a class of results has for users: fields, properties and methods."""
    hidden = {"heading", "shown", "instead"}
    members = [name for base in kind.__mro__[:-1] for name in vars(base)]
    return [
        name for name in dict.fromkeys((*_fields(kind), *members)) if name not in hidden and name[0] != "_"
    ]


def _fields(kind: type) -> list[str]:
    return [one.name for one in dataclasses.fields(kind)] if dataclasses.is_dataclass(kind) else []


def _row(result: DisplayedResult, name: str, longest: int) -> Row:
    kind: type = type(result)
    words, unit = description(kind, name)
    try:
        value = value_text(getattr(result, name), unit)
    except SpurcheckError as error:
        value = f"not available: {error}"
    return Row(name, _shortened(value, longest), _shortened(words, _LONGEST_CELL))


def value_text(value: object, unit: str = "") -> str:
    """Return a value of any kind as a short text.

    Parameters
    ----------
    value : number, array, text, member of an enum, dataset, result, or a collection of these
    unit : SI unit of numbers, for a prefix; "1" or empty: none
    """
    if value is None:
        return "none"
    if isinstance(value, bool | np.bool_):
        return "yes" if value else "no"
    if isinstance(value, Enum):
        return str(value.value[0] if isinstance(value.value, tuple) else value.value)
    if isinstance(value, int | np.integer):
        return f"{value}{SPACE}{unit}" if unit not in ("", "1") else str(value)
    if isinstance(value, float | np.floating):
        return quantity(float(value), unit or "1")
    if isinstance(value, complex | np.complexfloating):
        value = complex(value)
        return f"{number(value.real)} {'+' if value.imag >= 0.0 else MINUS} {number(abs(value.imag))}j"
    return _of_many(value, unit)


def _of_many(value: object, unit: str) -> str:
    """Text of a value with parts."""
    if isinstance(value, str):
        return value
    if isinstance(value, np.ndarray):
        if value.ndim != 1:
            return f"array {value.shape}"
        return _listed(value.tolist(), unit)
    if isinstance(value, DisplayedResult):
        return value.heading
    if dataclasses.is_dataclass(value):
        return type(value).__name__
    if isinstance(value, Mapping) and hasattr(value, "dims"):
        return f"dataset over {', '.join(map(str, value.dims))}"
    if isinstance(value, Mapping):
        parts = [f"{key}: {value_text(one, unit)}" for key, one in value.items()]
        return f"{len(parts)}: {', '.join(parts)}" if len(parts) > _SHOWN_NUMBERS else ", ".join(parts)
    if isinstance(value, (tuple, list, frozenset, set)):
        if any(dataclasses.is_dataclass(one) for one in value):
            return f"{len(value)} of {type(next(iter(value))).__name__}"
        return _listed(list(value), unit)
    return _shortened(repr(value), _LONGEST_VALUE)


def _listed(values: list[Any], unit: str) -> str:
    if not values:
        return "none"
    texts = [value_text(one, unit) for one in values[:_SHOWN_NUMBERS]]
    more = len(values) - len(texts)
    return ", ".join(texts) + (f", ... ({len(values)})" if more else "")


def _shortened(text: str, longest: int) -> str:
    """The text, cut to a length."""
    return text if len(text) <= longest else f"{text[: longest - 4].rstrip()} ..."


def _advice(result: DisplayedResult, name: str) -> str:
    """What to write in place of a name that a result does not have."""
    kind = type(result)
    if instead := kind.instead.get(name):
        return f": use {instead}"
    names = public_names(kind)
    contained = [one for one in names if f"_{name}_" in f"_{one}_"]
    close = contained or difflib.get_close_matches(name, names, n=1, cutoff=0.7)
    if close:
        return f". Did you mean {' or '.join(map(repr, close))}?"
    pair = result.__dict__.get("pair")
    if pair is not None and name in dir(pair):
        return f": read .pair.{name}"
    return f". It has {', '.join(names)}"


def _picture(result: DisplayedResult) -> str:
    try:
        return element_of(result.plot())
    except ParameterError:  # this kind of result has no figure
        return ""
