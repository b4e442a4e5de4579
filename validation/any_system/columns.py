"""A(t) as columns of text: one row a time, t, A_1_1, A_1_2, ..., A_n_n."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from lumped.errors import ParameterError, refuse
from lumped.typing import FloatArray
from validation.check.reading.headings import readings
from validation.check.reading.table import Column, listed
from validation.check.reading.text_table import Purpose, read_text_table
from validation.check.reading.units import si_factor

#: A_1_2, A12, A(1,2), A[1,2], a12, and a unit in brackets behind.
_ENTRY = re.compile(
    r"[Aa]\s*(?:_(\d{1,3})_(\d{1,3})|(\d)(\d)|[(\[]\s*(\d{1,3})\s*,\s*(\d{1,3})\s*[)\]])\s*(?:[\[(](.*)[\])])?"
)
_TIMES = ("t", "time", "zeit", "temps")
#: Units of entries of A in SI: nothing is converted, because positions and rates may have any units.
_SI = ("", "-", "1", "s", "1/s", "1/s^2", "1/s**2", "s^-1", "s^-2")
_LAYOUT = "columns t, A_1_1, A_1_2, ..., A_n_n"


def read_columns(path: Path) -> dict[str, Any]:
    """Return times [s] and matrices of a file of columns as ``A_times`` and ``A_samples``.

    Raises
    ------
    ParameterError : no text with columns, a column without meaning, no column of times, a missing entry,
        entries whose unit is not in SI
    """
    purpose = Purpose(lambda heading: _ENTRY.fullmatch(heading.strip()), "t, A_1_1, A_1_2, A_2_1, A_2_2")
    table = read_text_table(path, field="path", purpose=purpose)
    try:
        return _arrays(table.columns)
    except ParameterError as error:
        raise ParameterError(list(error.problems), str(path)) from None


def _arrays(columns: tuple[Column, ...]) -> dict[str, Any]:
    times: FloatArray | None = None
    entries: dict[tuple[int, int], FloatArray] = {}
    for column in columns:
        if column.damage is not None:
            raise column.damage
        values = np.asarray(column.values, dtype=float)
        factor = _time_factor(column)
        if factor is not None and times is None:
            times = values * factor
            continue
        place = _place(column)
        if place in entries:
            raise refuse(column.heading, "two columns", "one column for each entry", "Remove one of them.")
        entries[place] = values
    if times is None:
        raise refuse("t", "missing", _LAYOUT, "Name the column of times t, in s, or t [ms].")
    n = max((max(place) for place in entries), default=0)
    missing = [f"A_{i}_{j}" for i in range(1, n + 1) for j in range(1, n + 1) if (i, j) not in entries]
    if missing or not n:
        value = "no column" if n else "no column of A"
        action = "Add the columns, also those that are 0 at all times."
        raise refuse(
            listed(missing) or "A_1_1", value, f"{_LAYOUT}, here with n = {n or 'the states'}", action
        )
    matrices = np.array([[entries[i, j] for j in range(1, n + 1)] for i in range(1, n + 1)])
    return {"A_times": times, "A_samples": np.moveaxis(matrices, -1, 0)}


def _time_factor(column: Column) -> float | None:
    """Factor of a column of times to seconds; None: the column has no times."""
    for heading in readings(column.heading):
        if heading.words.lower() in _TIMES:
            return si_factor(column.unit or heading.unit or "s", "s", column.heading)
    return None


def _place(column: Column) -> tuple[int, int]:
    """Row and column of the entry of A, counted from 1, that a column has."""
    match = _ENTRY.fullmatch(column.heading.strip())
    if match is None:
        raise refuse(column.heading, "a heading without meaning", _LAYOUT, "Correct or remove the column.")
    unit = (column.unit or match[7] or "").replace(" ", "").replace("²", "^2")
    if unit not in _SI:
        action = "Convert A to SI units, and leave the unit out."
        raise refuse(column.heading, f"the unit {unit}", "entries in SI units", action)
    first, second = (int(number) for number in match.groups()[:6] if number is not None)
    if not first or not second:
        raise refuse(column.heading, "row or column 0", "rows and columns from 1", "Add 1 to the numbers.")
    return first, second
