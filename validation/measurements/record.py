"""A measured record: its samples in SI, and how it is read from CSV."""

from __future__ import annotations

import hashlib
import io
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from lumped.errors import ParameterError, refuse, shown
from lumped.fields.text_file import read_text
from lumped.typing import FloatArray
from validation.measurements.specification import (
    QUANTITIES,
    MeasurementSpec,
    read_specification,
    si_factor,
)

if TYPE_CHECKING:
    import pandas as pd

_MAX_BYTES = 2_000_000_000
#: Values whose squares can be summed.
_LARGEST = 1e100


@dataclass(frozen=True, eq=False)
class Measurement:
    """Samples of a record, everything in SI.

    Attributes
    ----------
    spec : the description it was read with
    abscissa : (k,) times [s], or pinion roll angles of pair A [rad], increasing
    channels : channel name -> (k,) values in the SI unit of its quantity
    noise : channel name -> standard deviation of its noise in that unit, or None where it is not known
    sha256 : hash of the data file, "" where the record was not read from one
    """

    spec: MeasurementSpec
    abscissa: FloatArray
    channels: dict[str, FloatArray]
    noise: dict[str, float | None]
    sha256: str = ""

    def named(self, quantity: str) -> list[tuple[str, str | None]]:
        """Names and pair labels of the channels of a quantity."""
        return [(c.name, c.pair) for c in self.spec.channel if c.quantity == quantity]


def load_measurement(source: str | Path | Mapping[str, Any]) -> Measurement:
    """Read a measured record.

    Parameters
    ----------
    source : the TOML description (see ``MeasurementSpec``), as a file or as a mapping; it names the CSV file

    Raises
    ------
    ParameterError : the description or the data file cannot be used; the text names field, row or column
    """
    spec, folder = read_specification(source)
    if not spec.data:
        raise refuse("data", "", "the CSV file of the record", "Name it in the description.")
    path = folder / spec.data
    text = read_text(path, _MAX_BYTES, field="data", kind="CSV file")
    try:
        return parse_measurement(spec, text)
    except ParameterError as error:
        raise ParameterError(list(error.problems), str(path)) from None


def parse_measurement(spec: MeasurementSpec, text: str) -> Measurement:
    """Read the samples of a record from CSV text: optional # lines, one line of headings, then numbers."""
    cells = _cells(spec, text)
    columns = _columns([str(heading) for heading in cells.columns])
    wanted = [(c.column, f"channel.{c.name}.column") for c in spec.channel]
    if spec.abscissa.column is not None:
        wanted.insert(0, (spec.abscissa.column, "abscissa.column"))
    for column, field in wanted:
        if column not in columns:
            known = ", ".join(map(shown, columns))
            raise refuse(field, shown(column), f"one of {known}", "Correct the column's name.")
    table = _numbers(spec, cells.iloc[:, [columns[column][0] for column, _ in wanted]])
    if table.shape[0] < 8:
        raise refuse("data", f"{table.shape[0]} rows", ">= 8 rows", "Check the file.")
    units = [columns[column][1] for column, _ in wanted]
    if spec.abscissa.column is not None:
        abscissa = _abscissa(spec, table[:, 0], units.pop(0))
        table = table[:, 1:]
    else:
        assert spec.abscissa.sampling_rate is not None  # the description asks for it
        abscissa = np.arange(table.shape[0]) / spec.abscissa.sampling_rate
    channels: dict[str, FloatArray] = {}
    noise: dict[str, float | None] = {}
    for j, channel in enumerate(spec.channel):
        field = f"channel.{channel.name}.unit"
        unit = _unit(channel.unit, units[j], field)
        factor = channel.gain * si_factor(unit, QUANTITIES[channel.quantity][0], field)
        with np.errstate(over="ignore", invalid="ignore"):
            channels[channel.name] = values = factor * (table[:, j] - channel.zero)
        if not (np.abs(values) < _LARGEST).all():
            largest = f"up to {np.abs(values).max():g} in SI units"
            raise refuse(f"channel.{channel.name}", largest, f"< {_LARGEST:g}", "Check gain, zero and unit.")
        noise[channel.name] = None if channel.noise is None else abs(factor) * channel.noise
    return Measurement(spec, abscissa, channels, noise, hashlib.sha256(text.encode()).hexdigest())


def _columns(headings: list[str]) -> dict[str, tuple[int, str | None]]:
    """Name -> (place, unit in the heading), for headings such as ``normal A [N]``."""
    found: dict[str, tuple[int, str | None]] = {}
    for place, heading in enumerate(headings):
        name, unit = _name_and_unit(heading.strip())
        found.setdefault(name, (place, unit))
        found.setdefault(heading.strip(), (place, unit))
    return found


def _name_and_unit(heading: str) -> tuple[str, str | None]:
    """Split ``force A [N]`` or ``force A (N)``; in one pass, however many blanks there are."""
    if heading.endswith(("]", ")")):
        start = max(heading.rfind("]", 0, -1), heading.rfind(")", 0, -1)) + 1
        opened = [at for at in (heading.find("[", start), heading.find("(", start)) if at >= 0]
        if opened:
            return heading[: min(opened)].strip(), heading[min(opened) + 1 : -1]
    return heading, None


def _cells(spec: MeasurementSpec, text: str) -> pd.DataFrame:
    """Read the table; a column that holds anything but numbers stays one of texts."""
    import pandas as pd

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", pd.errors.ParserWarning)  # lines longer than the headings
            return pd.read_csv(
                io.StringIO(text),
                sep=spec.delimiter,
                decimal=spec.decimal,
                comment="#",
                skipinitialspace=True,
                index_col=False,
                low_memory=False,
            )
    except pd.errors.EmptyDataError:
        raise refuse("data", "empty", "a line of headings and numbers", "Check the file.") from None
    except (ValueError, OverflowError, pd.errors.ParserWarning) as error:
        allowed = "a finite number in every cell of a named column"
        raise refuse("data", "a line", allowed, f"{shown(str(error).strip())}.") from None


def _numbers(spec: MeasurementSpec, cells: pd.DataFrame) -> FloatArray:
    """Numbers of the named columns (rows, columns); the first cell that is none is refused by its place."""
    import pandas as pd

    def numbers(column: pd.Series[Any]) -> pd.Series[Any]:
        if column.dtype.kind in "iuf":
            return column
        return pd.to_numeric(column.astype(str).str.replace(spec.decimal, ".", regex=False), errors="coerce")

    table = cells.apply(numbers).to_numpy(dtype=np.float64)
    bad = np.argwhere(~np.isfinite(table))
    if bad.size:
        row, column = bad[0]
        raise refuse(
            "data",
            f"{shown(str(cells.iloc[row, column]))} in row {row + 1} after the headings, "
            f"column {shown(str(cells.columns[column]))}",
            "a finite number in every cell of a named column",
            "Remove or repair the row; gaps are not filled.",
        )
    return np.asarray(table, dtype=np.float64)


def _unit(stated: str | None, heading: str | None, field: str) -> str:
    unit = stated or heading
    if unit is None:
        raise refuse(field, "none", "a unit, here or in the column's heading", "State the unit.")
    # Two names may still be one unit; two different units are a mistake somewhere.
    if stated and heading and stated != heading and si_factor(stated, heading, field) != 1.0:
        raise refuse(field, stated, f"the heading's unit {heading}", "Correct one of the two.")
    return unit


def _abscissa(spec: MeasurementSpec, cells: FloatArray, heading: str | None) -> FloatArray:
    unit = _unit(spec.abscissa.unit, heading, "abscissa.unit")
    values = cells * si_factor(unit, "s" if spec.abscissa.kind == "time" else "rad", "abscissa.unit")
    back = np.flatnonzero(np.diff(values) <= 0.0)
    if back.size:
        raise refuse(
            "abscissa.column",
            f"row {back[0] + 2} is not beyond the row before",
            "increasing values",
            "Sort or cut the record.",
        )
    return np.asarray(values, dtype=np.float64)
