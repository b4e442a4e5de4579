"""A measured record: the TOML description, and the samples in SI from the CSV file."""

from __future__ import annotations

import io
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from lumped.arguments import file_path
from lumped.errors import ParameterError, refuse, shown
from lumped.fields.refusals import made_of
from lumped.fields.section import OneOf, Section, Text
from lumped.fields.text_file import parse_toml, read_text
from lumped.fields.units import Quantity, to_si
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.check.curves import Channel as CurveChannel
from validation.check.curves import Curves

if TYPE_CHECKING:
    import pandas as pd

#: Quantity of a channel -> (SI unit, whether it belongs to one tooth pair). Names are those of the models'
#: results.
QUANTITIES: dict[str, tuple[str, bool]] = {
    **dict.fromkeys(("normal_load", "friction_force"), ("N", True)),
    **dict.fromkeys(("dte", "x_p", "x_g", "y_p", "y_g"), ("m", False)),
    **dict.fromkeys((f"bearing_force_{end}" for end in ("x_p", "x_g", "y_p", "y_g")), ("N", False)),
}
PAIR_LABELS = "ABCDEFGH"
#: Largest description and record read: a bound against a wrong path.
_MAX_FILE_BYTES = 1_000_000
_MAX_BYTES = 2_000_000_000
#: Values whose squares can be summed.
_LARGEST = 1e100


class Abscissa(Section):
    """Times of the samples: a column of times, or a constant sampling rate."""

    kind: Literal["time", "sampled"] = Field(description="a column of times, or equidistant samples in time")
    column: str | None = Field(None, description="column of the times")
    unit: str | None = Field(None, description="its unit")
    sampling_rate: Annotated[float | None, Quantity("Hz", above=0, optional=True)] = Field(
        None, description="samples per second, for kind 'sampled'"
    )

    @model_validator(mode="after")
    def _complete(self) -> Self:
        stated = {name for name in ("column", "unit", "sampling_rate") if getattr(self, name) is not None}
        wanted = {"sampling_rate"} if self.kind == "sampled" else {"column", "unit"}
        if stated != wanted:
            allowed = f"{' and '.join(sorted(wanted))} for kind '{self.kind}'"
            first = sorted(stated ^ wanted)[0]
            raise refuse(first, ", ".join(sorted(stated)), allowed, "Correct the abscissa.")
        return self


class Channel(Section):
    """One measured column; the physical value is gain * (cell - zero)."""

    name: str = Field(min_length=1, max_length=60, pattern=r"^\w+$", description="name in results")
    column: str = Field(min_length=1, description="heading of the column")
    quantity: Annotated[str, OneOf(tuple(QUANTITIES))] = Field(description="measured quantity")
    unit: str = Field(description="unit of the cells")
    pair: str | None = Field(
        None, pattern="^[A-H]$", description="tooth pair: A, or B that follows it one pitch later, ..."
    )
    gain: float = Field(1.0, description="factor on the cells; -1 turns the sign convention round")
    zero: float = Field(0.0, description="reading at zero load, in the cells' unit")
    noise: Annotated[float | None, Field(gt=0)] = Field(
        None, description="standard deviation of the sensor noise, in the cells' unit"
    )

    @model_validator(mode="after")
    def _pair_where_needed(self) -> Self:
        if QUANTITIES[self.quantity][1] != (self.pair is not None):
            wanted = "a label A to H" if QUANTITIES[self.quantity][1] else "none"
            raise refuse("pair", self.pair, f"{wanted} for {self.quantity}", "Correct the channel.")
        if self.gain == 0.0:
            raise refuse("gain", 0.0, "any number but 0", "Correct the channel.")
        return self


class MeasurementSpec(Section):
    """The description of one measured record."""

    name: Text = Field(min_length=1, max_length=120, description="short name")
    description: Text = Field("", description="what was measured and how")
    source: Text = Field(min_length=1, description="who measured it, where it was published")
    data: str = Field("", description="the CSV file, beside this file")
    delimiter: str = Field(",", min_length=1, max_length=1, description="between the cells")
    decimal: Literal[".", ","] = Field(".", description="decimal sign of the cells")
    pinion_speed: Annotated[float, Quantity("rpm", above=0)] = Field(description="pinion speed of the record")
    pinion_torque: Annotated[float, Quantity("N*m", above=0)] = Field(
        description="pinion torque of the record"
    )
    recurrence: Annotated[int, Field(ge=1, le=1_000_000)] | None = Field(
        None,
        description="mesh cycles after which the same labelled pair is in contact again; default the "
        "pinion's number of teeth (one instrumented pinion tooth)",
    )
    abscissa: Abscissa = Field(description="where the samples lie")
    channel: tuple[Channel, ...] = Field(min_length=1, max_length=64, description="the measured columns")

    @model_validator(mode="after")
    def _different(self) -> Self:
        names = [c.name for c in self.channel]
        if len(set(names)) != len(names):
            raise refuse("channel.name", ", ".join(names), "different names", "Rename one of the channels.")
        if self.decimal == self.delimiter:
            raise refuse("decimal", self.decimal, "not the delimiter", "Set delimiter = ';'.")
        return self


@dataclass(frozen=True, eq=False)
class Measurement:
    """Samples of a record, everything in SI.

    Attributes
    ----------
    spec : the description it was read with
    abscissa : (k,) times [s], increasing
    channels : channel name -> (k,) values in the SI unit of its quantity
    noise : channel name -> standard deviation of its noise in that unit, or None where it is not known
    """

    spec: MeasurementSpec
    abscissa: FloatArray
    channels: dict[str, FloatArray]
    noise: dict[str, float | None]

    def curves(self) -> Curves:
        """Return the record in the form of every comparison."""
        channels = tuple(
            CurveChannel(c.name, c.quantity, self.channels[c.name], c.pair, self.noise[c.name])
            for c in self.spec.channel
        )
        return Curves(
            name=self.spec.name,
            abscissa="time",
            places=self.abscissa,
            channels=channels,
            role="measurement",
            pinion_speed=self.spec.pinion_speed,
            pinion_torque=self.spec.pinion_torque,
            recurrence=self.spec.recurrence,
        )

    def at(self, pair: GearPair) -> GearPair:
        """Return the pair at the speed and the torque of the record."""
        speed = f"{float(self.spec.pinion_speed)!r} rad/s"
        torque = self.spec.pinion_torque
        return pair.with_({"operating.pinion_speed": speed, "operating.pinion_torque": torque})

    def named(self, quantity: str) -> list[tuple[str, str | None]]:
        """Return names and pair labels of the channels of a quantity."""
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
    if isinstance(source, Mapping):
        data = dict(source)
        folder = Path()
        name = "mapping"
    else:
        path = file_path("measurement", source)
        if path.suffix.lower() == ".csv":
            action = "Describe the table in a TOML file, whose field 'data' names it."
            raise refuse("measurement", path, "the description of a record, a .toml file", action)
        folder = path.parent
        name = str(path)
        data = parse_toml(read_text(path, _MAX_FILE_BYTES, kind="TOML file"), name)
    spec = made_of(MeasurementSpec, data, name)
    if not spec.data:
        raise refuse("data", "", "the CSV file of the record", "Name it in the description.")
    path = folder / spec.data
    text = read_text(path, _MAX_BYTES, field="data", kind="CSV file")
    try:
        return _parsed(spec, text)
    except ParameterError as error:
        raise ParameterError(list(error.problems), str(path)) from None


def _parsed(spec: MeasurementSpec, text: str) -> Measurement:
    """Read CSV text: optional # lines, one line of headings, then numbers."""
    cells = _cells(spec, text)
    columns = {str(heading).strip(): place for place, heading in enumerate(cells.columns)}
    wanted = [(c.column, f"channel.{c.name}.column") for c in spec.channel]
    if spec.abscissa.column is not None:
        wanted.append((spec.abscissa.column, "abscissa.column"))
    for column, field in wanted:
        if column not in columns:
            headings = ", ".join(map(shown, columns))
            raise refuse(field, shown(column), f"one of {headings}", "Correct the column's name.")
    table = _numbers(spec, cells.iloc[:, [columns[column] for column, _ in wanted]])
    if table.shape[0] < 8:
        raise refuse("data", f"{table.shape[0]} rows", ">= 8 rows", "Check the file.")
    if spec.abscissa.sampling_rate is not None:
        abscissa = np.arange(table.shape[0]) / spec.abscissa.sampling_rate
    else:
        abscissa = table[:, -1] * _si_factor(str(spec.abscissa.unit), "s", "abscissa.unit")
        if (back := np.flatnonzero(np.diff(abscissa) <= 0.0)).size:
            place = f"row {back[0] + 2} is not beyond the row before"
            raise refuse("abscissa.column", place, "increasing values", "Sort or cut the record.")
    channels: dict[str, FloatArray] = {}
    noise: dict[str, float | None] = {}
    for j, channel in enumerate(spec.channel):
        si_unit = QUANTITIES[channel.quantity][0]
        factor = channel.gain * _si_factor(channel.unit, si_unit, f"channel.{channel.name}.unit")
        with np.errstate(over="ignore", invalid="ignore"):
            channels[channel.name] = values = factor * (table[:, j] - channel.zero)
        if not (np.abs(values) < _LARGEST).all():
            largest = f"up to {np.abs(values).max():g} in SI units"
            raise refuse(f"channel.{channel.name}", largest, f"< {_LARGEST:g}", "Check gain, zero and unit.")
        noise[channel.name] = None if channel.noise is None else abs(factor) * channel.noise
    return Measurement(spec, abscissa, channels, noise)


def _cells(spec: MeasurementSpec, text: str) -> pd.DataFrame:
    """Read the table. A column with anything but numbers stays a column of texts."""
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
    """Numbers of the named columns (rows, columns). A cell without a number is refused with its place."""
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


def _si_factor(unit: str, si_unit: str, field: str) -> float:
    """Factor from a unit to an SI unit of the same dimension."""
    try:
        return to_si(f"1 {unit}", si_unit)
    except ValueError as error:
        raise refuse(field, unit, f"a unit that converts to {si_unit}", f"{error}.") from None
