"""Reading and checking a stiffness table: a CSV file with named columns and their units."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from pathlib import Path

from lumped.errors import refuse, shown
from lumped.fields.text_file import read_text
from lumped.fields.units import to_si

#: Column name -> (axis of the table, unit that its points get, unit of lumped.fields.units for the
#: conversion).
_AXES = {
    "position": ("position_mm", "mm"),
    "roll_angle": ("roll_angle_deg", "deg"),
    "phase": ("phase", "1"),
}
_HEADER = re.compile(r"(\w+)\s*(?:\[([^\]]*)\])?")
_FORMAT = "a header such as 'position [mm], stiffness [N/um]', then one row of two numbers per point"
_MAX_BYTES = 10_000_000
#: Largest stiffness of a spur gear mesh that is taken for real [N/m].
_LARGEST = 1e12


def read_stiffness_table(file: object, folder: str | Path = ".") -> dict[str, object]:
    """Read a stiffness table.

    The file has a header with a column ``position``, ``roll_angle`` or ``phase`` and a column ``stiffness``,
    each with its unit in brackets (none for phase), in any order; lines that start with # are comments.

    Parameters
    ----------
    file : name of the CSV file
    folder : where a relative name starts

    Returns
    -------
    ``axis``, ``points`` and ``stiffness`` as the schema takes them (mm, deg or cycles; N/m)

    Raises
    ------
    ParameterError : no such file, wrong columns, units or numbers
    """
    if not isinstance(file, str):
        raise refuse("file", file, "the name of a CSV file", "Write the name as text.")
    path = Path(folder) / file
    text = read_text(path, _MAX_BYTES, kind="CSV file")
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    if not lines:
        raise refuse("file", path, _FORMAT, "The file is empty.")
    try:
        rows = list(csv.reader(lines))
    except csv.Error as error:
        raise refuse("file", path, _FORMAT, f"It cannot be read: {error}.") from None
    names, units = _header(rows[0], path)
    try:
        columns = list(
            zip(*((float(row[0]), float(row[1])) for row in rows[1:] if len(row) == 2), strict=True)
        )
    except ValueError as error:
        raise refuse("file", path, _FORMAT, f"A row is no pair of numbers: {shown(str(error))}.") from None
    if len(columns) != 2 or any(len(row) != 2 for row in rows[1:]):
        raise refuse("file", path, _FORMAT, "Give two columns and at least four rows.")
    values = dict(zip(names, columns, strict=True))
    unit = dict(zip(names, units, strict=True))
    column = next(name for name in names if name != "stiffness")
    axis, stated = _AXES[column]
    return {
        "axis": axis,
        "points": tuple(v * _factor(unit[column], stated, column, path) for v in values[column]),
        "stiffness": tuple(
            v * _factor(unit["stiffness"], "N/m", "stiffness", path) for v in values["stiffness"]
        ),
    }


def check_stiffness_table(points: Sequence[float], stiffness: Sequence[float]) -> None:
    """Refuse a table that is no stiffness curve.

    Raises
    ------
    ParameterError : unequal lengths, points that do not increase, stiffness that is not finite and positive
    """
    if len(points) != len(stiffness):
        raise refuse(
            "stiffness", f"{len(stiffness)} values", f"one per point, {len(points)}", "Complete the table."
        )
    for i in range(1, len(points)):
        if not points[i] > points[i - 1]:
            raise refuse(
                "points",
                f"{points[i]:g} after {points[i - 1]:g}",
                "increasing",
                "Sort the rows and remove repeated points.",
            )
    for value in stiffness:
        if not 0.0 < value <= _LARGEST:
            raise refuse(
                "stiffness",
                f"{value:g} N/m",
                f"> 0 and <= {_LARGEST:g} N/m",
                "Check the unit and the sign; leave out points without contact.",
            )


def _header(row: list[str], path: Path) -> tuple[list[str], list[str]]:
    matches = [_HEADER.fullmatch(cell.strip()) for cell in row]
    found = [(m.group(1).lower(), m.group(2) or "") for m in matches if m is not None]
    names = [name for name, _ in found]
    known = len(row) == 2 and len(found) == 2 and "stiffness" in names and any(n in _AXES for n in names)
    if not known:
        raise refuse("file", path, _FORMAT, f"The header is '{shown(', '.join(row))}'.")
    return names, [unit for _, unit in found]


def _factor(unit: str, stated: str, column: str, path: Path) -> float:
    """Number of stated units in one unit of the file."""
    if stated == "1":
        if unit.strip() not in ("", "1"):
            raise refuse("file", path, "phase without a unit, in mesh cycles", f"It has the unit [{unit}].")
        return 1.0
    try:
        return to_si(f"1 {unit}", stated) / to_si(1.0, stated)
    except ValueError as error:
        raise refuse("file", path, f"{column} with its unit in brackets", f"{error}.") from None
