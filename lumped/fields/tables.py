"""Tables over the path of contact in CSV files: two columns with their units in the header."""

from __future__ import annotations

import itertools
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike
from pydantic import ValidationInfo

from lumped.errors import FieldProblem, refuse, shown
from lumped.fields.text_file import read_text
from lumped.fields.units import to_si
from lumped.typing import FloatArray

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

#: Column -> (axis of the table, unit of its numbers).
AXES = {"position": ("position_mm", "mm"), "roll_angle": ("roll_angle_deg", "deg"), "phase": ("phase", "1")}
#: A table may miss the ends of the path of contact by this fraction of the path.
_END_GAP = 0.02
_HEADER = re.compile(r"(\w+)\s*(?:\[([^\]]*)\])?")
_MAX_BYTES = 10_000_000


def read_columns(file: object, folder: object, quantity: tuple[str, str]) -> dict[str, object]:
    """Read a table from a CSV file: ``axis``, ``points`` and the quantity, as fields of the schema.

    The file has a header with a column ``position``, ``roll_angle`` or ``phase`` and a column of the
    quantity, each with its unit in brackets (none for ratios), in any order; lines that start with # are
    comments.
    """
    if not isinstance(file, str):
        raise refuse("file", file, "the name of a CSV file", "Write the name as text.")
    path = Path(str(folder)) / file
    text = read_text(path, _MAX_BYTES, kind="CSV file")
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    if len(lines) < 2:
        raise refuse("file", path, _format(quantity), "Give two columns and at least four rows.")
    try:
        columns = np.loadtxt(lines[1:], delimiter=",", quotechar='"', comments=None, ndmin=2).T
        first, second = columns
    except ValueError as error:
        action = f"A row is no pair of numbers: {shown(str(error))}."
        raise refuse("file", path, _format(quantity), action) from None
    heads = [cell.strip(' \t"') for cell in lines[0].split(",")]
    return table_of(dict(zip(heads, (first, second), strict=False)), quantity, "file", path, len(heads))


def with_file(data: Any, info: ValidationInfo, quantity: tuple[str, str]) -> Any:
    """Replace ``file`` in a section by the content of the file.

    A relative path starts at the parameter file.
    """
    if not isinstance(data, dict) or "file" not in data:
        return data
    folder = (info.context or {}).get("folder", ".")
    rest = {key: value for key, value in data.items() if key != "file"}
    return rest | read_columns(data["file"], folder, quantity)


def table_of(
    columns: Mapping[str, ArrayLike], quantity: tuple[str, str], field: str, where: object, count: int = 2
) -> dict[str, object]:
    """Return two named columns as ``axis``, ``points`` and the quantity (name, unit), in stated units."""
    matches = [_HEADER.fullmatch(str(head).strip()) for head in columns]
    names = [match[1].lower() for match in matches if match]
    if (
        not count == len(matches) == len(set(names)) == 2
        or not {*names} <= {*AXES, quantity[0]}
        or (quantity[0] not in names)
    ):
        action = f"The header is '{shown(', '.join(map(str, columns)))}'."
        raise refuse(field, where, _format(quantity), action)
    table: dict[str, object] = {}
    for name, match, values in zip(names, matches, columns.values(), strict=True):
        assert match is not None  # it has a name
        axis, stated = AXES.get(name, quantity)
        _, unit = match.groups()
        factor = _factor(unit or "", stated, name, field, where)
        scaled = tuple((np.asarray(values, dtype=float) * factor).tolist())
        table |= {axis: scaled} if name == quantity[0] else {"axis": axis, "points": scaled}
    return table


def check_points(
    points: Sequence[float], values: Sequence[float], quantity: tuple[str, str], largest: float, action: str
) -> None:
    """Refuse unequal lengths, points that do not increase, and values outside 0 to ``largest``.

    Values of a quantity with a unit must be above 0. ``action`` is the advice on a refused value.
    """
    field, unit = quantity
    if len(points) != len(values):
        allowed = f"one per point, {len(points)}"
        raise refuse(field, f"{len(values)} values", allowed, "Complete the table.")
    for before, point in itertools.pairwise(points):
        if not point > before:
            sort = "Sort the rows and remove repeated points."
            raise refuse("points", f"{point:g} after {before:g}", "increasing", sort)
    for value in values:
        if not 0.0 <= value <= largest or (value == 0.0 and unit != "1"):
            allowed = f"0 to {largest:g}" if unit == "1" else f"> 0 and <= {largest:g} {unit}"
            raise refuse(field, f"{value:g}" if unit == "1" else f"{value:g} {unit}", allowed, action)


def uncovered(x: FloatArray, low: float, high: float, field: str) -> FieldProblem | None:
    """Problem of a table over xi (n,) [m] that does not reach from A to D; None: the table does."""
    gap = _END_GAP * (high - low)
    if x[0] <= low + gap and x[-1] >= high - gap:
        return None
    value = f"{x[0] * 1e3:.4f} to {x[-1] * 1e3:.4f} mm from X"
    allowed = f"at least {low * 1e3:.4f} to {high * 1e3:.4f} mm, A to D"
    return FieldProblem(field, value, allowed, "Extend the table, or check its axis and unit.")


def positions(points: ArrayLike, axis: str, base_radius: float) -> FloatArray:
    """Points of a table as xi [m]: of an axis in mm, or in degrees of the pinion's roll angle."""
    values = np.asarray(points, dtype=np.float64)
    return values * 1e-3 if axis == "position_mm" else np.deg2rad(values) * base_radius


def spline(x: FloatArray, y: FloatArray, interpolation: str) -> PPoly:
    """Interpolate: "monotone" or "cubic"."""
    from scipy.interpolate import CubicSpline, PchipInterpolator, PPoly

    result = PchipInterpolator(x, y) if interpolation == "monotone" else CubicSpline(x, y)
    return PPoly(result.c, result.x)


def _format(quantity: tuple[str, str]) -> str:
    name, unit = quantity
    head = name if unit == "1" else f"{name} [{unit}]"
    return f"a header such as 'position [mm], {head}', then one row of two numbers per point"


def _factor(unit: str, stated: str, column: str, field: str, where: object) -> float:
    """Number of stated units in one unit of the column."""
    if stated == "1":
        if unit.strip() not in ("", "1"):
            raise refuse(field, where, f"{column} without a unit", f"It has the unit [{unit}].")
        return 1.0
    try:
        return to_si(f"1 {unit}", stated) / to_si(1.0, stated)
    except ValueError as error:
        raise refuse(field, where, f"{column} with its unit in brackets", f"{error}.") from None
