"""A description in TOML says what the columns of a data file are: of a measured record or of a model."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from lumped.errors import refuse, shown
from lumped.fields.refusals import made_of
from lumped.fields.section import OneOf, Section, Text
from lumped.fields.text_file import parse_toml, read_text
from lumped.fields.units import Quantity
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.check.curves import FEWEST_SAMPLES, Channel, Curves, SpeedColumn, ValuesOverSpeed
from validation.check.quantities import QUANTITIES
from validation.check.reading.abscissa import SI_OF_ABSCISSA, Place, mesh_phases
from validation.check.reading.facts import Facts, finite, real_values, scaled
from validation.check.reading.interpretation import curves_over
from validation.check.reading.meaning import AbscissaKind
from validation.check.reading.over_speed import over_speed
from validation.check.reading.spectrum import OrderColumn, curves_of_parts
from validation.check.reading.table import Column, Table
from validation.check.reading.units import si_factor

#: Largest description: a bound against a wrong path.
_MAX_FILE_BYTES = 1_000_000
#: Kinds of the abscissa of a description.
_KINDS = Literal["time", "sampled", "pinion_angle", "gear_angle", "mesh_phase", "speed", "order"]


class AbscissaOfData(Section):
    """Places of the samples: a column, or a constant sampling rate."""

    kind: _KINDS = Field(
        description="a column of times, angles, phases, speeds or orders, or 'sampled' in time"
    )
    column: str | None = Field(None, description="column of the abscissa")
    unit: str | None = Field(None, description="its unit; '-' for mesh cycles and orders")
    sampling_rate: Annotated[float | None, Quantity("Hz", above=0, optional=True)] = Field(
        None, description="samples per second, for kind 'sampled'"
    )

    @model_validator(mode="after")
    def _complete(self) -> Self:
        stated = {name for name in ("column", "unit", "sampling_rate") if getattr(self, name) is not None}
        wanted = {"sampling_rate"} if self.kind == "sampled" else {"column", "unit"}
        if self.kind in ("mesh_phase", "order"):
            stated |= {"unit"}
        if stated != wanted:
            allowed = f"{' and '.join(sorted(wanted))} for kind '{self.kind}'"
            first = sorted(stated ^ wanted)[0]
            raise refuse(first, ", ".join(sorted(stated)), allowed, "Correct the abscissa.")
        return self


class ChannelOfData(Section):
    """One column; the physical value is gain * (cell - zero)."""

    name: str = Field(min_length=1, max_length=60, pattern=r"^\w+$", description="name in results")
    column: str = Field(min_length=1, description="heading of the column")
    quantity: Annotated[str, OneOf(tuple(QUANTITIES))] = Field(description="quantity of the column")
    unit: str = Field(description="unit of the cells")
    pair: str | None = Field(
        None, pattern="^[A-H]$", description="tooth pair: A, or B that follows it one pitch later, ..."
    )
    gain: float = Field(1.0, description="factor on the cells; -1 turns the sign convention round")
    zero: float = Field(0.0, description="reading at zero load, in the cells' unit")
    noise: Annotated[float | None, Field(gt=0)] = Field(
        None, description="standard deviation of the sensor noise, in the cells' unit"
    )
    value: Literal["peak_to_peak", "rms", "mean", "order"] | None = Field(
        None, description="value over speed, for an abscissa of kind 'speed'"
    )
    order: Annotated[float | None, Field(ge=0)] = Field(None, description="mesh order, for value 'order'")
    part: Literal["amplitude", "phase", "real", "imag"] | None = Field(
        None, description="part of the complex amplitude, for an abscissa of kind 'order'"
    )

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        of_pair = QUANTITIES[self.quantity].of_tooth_pair
        if of_pair != (self.pair is not None):
            wanted = "a label A to H" if of_pair else "none"
            raise refuse("pair", self.pair, f"{wanted} for {self.quantity}", "Correct the channel.")
        if self.gain == 0.0:
            raise refuse("gain", 0.0, "any number but 0", "Correct the channel.")
        if (self.value == "order") != (self.order is not None):
            wanted = "a mesh order" if self.value == "order" else f"none for value {self.value}"
            raise refuse("order", self.order, wanted, "Correct the channel.")
        return self


class Description(Section):
    """The description of a measured record or of the curves of a model."""

    name: Text = Field(min_length=1, max_length=120, description="short name")
    role: Literal["model", "measurement"] = Field("measurement", description="what the data are of")
    description: Text = Field("", description="what was measured or computed, and how")
    source: Text = Field("", description="who made it, where it was published; needed for a measurement")
    data: str = Field(
        "", description="the data file, beside this file: .csv, .txt, .xlsx, .mat, .nc, .npz, .fmu"
    )
    delimiter: str | None = Field(
        None, min_length=1, max_length=1, description="between the cells of a text; default: recognised"
    )
    decimal: Literal[".", ","] | None = Field(None, description="decimal sign of a text; default: recognised")
    pinion_speed: Annotated[float | None, Quantity("rpm", above=0, optional=True)] = Field(
        None, description="pinion speed of the data; needed for a measurement at one speed"
    )
    pinion_torque: Annotated[float | None, Quantity("N*m", above=0, optional=True)] = Field(
        None, description="pinion torque of the data; needed for a measurement"
    )
    recurrence: Annotated[int, Field(ge=1, le=1_000_000)] | None = Field(
        None,
        description="mesh cycles after which the same labelled pair is in contact again; default the "
        "pinion's number of teeth (one instrumented pinion tooth)",
    )
    abscissa: AbscissaOfData = Field(description="where the samples lie")
    channel: tuple[ChannelOfData, ...] = Field(min_length=1, max_length=64, description="the columns")

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        names = [c.name for c in self.channel]
        if len(set(names)) != len(names):
            raise refuse("channel.name", ", ".join(names), "different names", "Rename one of the channels.")
        if self.decimal is not None and self.decimal == self.delimiter:
            raise refuse("decimal", self.decimal, "not the delimiter", "Set delimiter = ';'.")
        if self.role == "measurement":
            self._complete_measurement()
        for channel in self.channel:
            self._suits_abscissa(channel)
        return self

    def _complete_measurement(self) -> None:
        if not self.source:
            raise refuse("source", "missing", "who measured it, where it was published", "Add it.")
        if self.pinion_torque is None:
            raise refuse("pinion_torque", "missing", "the pinion torque of the record", "Add it.")
        if self.pinion_speed is None and self.abscissa.kind != "speed":
            raise refuse("pinion_speed", "missing", "the pinion speed of the record", "Add it.")

    def _suits_abscissa(self, channel: ChannelOfData) -> None:
        place = f"channel.{channel.name}"
        kind = self.abscissa.kind
        if (kind == "speed") != (channel.value is not None):
            wanted = "peak_to_peak, rms, mean or order" if kind == "speed" else f"none for kind '{kind}'"
            raise refuse(f"{place}.value", channel.value, wanted, "Correct the channel.")
        if kind != "order" and channel.part is not None:
            raise refuse(f"{place}.part", channel.part, f"none for kind '{kind}'", "Remove it.")

    @property
    def columns(self) -> tuple[str, ...]:
        """Headings of the columns that the description names, without that of the abscissa."""
        return tuple(dict.fromkeys(channel.column for channel in self.channel))


def read_description(path: Path, field: str) -> Description:
    """Read a description.

    Raises
    ------
    ParameterError : the description cannot be used; the text names the field
    """
    data = parse_toml(read_text(path, _MAX_FILE_BYTES, field=field, kind="TOML file"), str(path))
    return described(data, str(path))


def described(data: dict[str, Any], name: str) -> Description:
    """Return the description of plain data in file units; ``name`` is the origin of the data."""
    description = made_of(Description, data, name)
    if not description.data:
        raise refuse("data", "", "the data file of the description", "Name it in the description.")
    return description


def curves_of_description(description: Description, table: Table, pair: GearPair) -> Curves | ValuesOverSpeed:
    """Return the curves of a table as the description says what its columns are."""
    remarks = [text for text in table.remarks if "not used" not in text]
    facts = Facts(
        description.name, description.role, description.pinion_speed, description.pinion_torque,
        description.recurrence, remarks=remarks,
    )  # fmt: skip
    columns = {column.heading.strip(): column for column in reversed(table.columns)}
    named = [(c.column, f"channel.{c.name}.column") for c in description.channel]
    if description.abscissa.column is not None:
        named.append((description.abscissa.column, "abscissa.column"))
    for heading, field in named:
        if heading not in columns:
            headings = ", ".join(map(shown, columns))
            raise refuse(field, shown(heading), f"one of {headings}", "Correct the column's name.")
        if sum(column.heading.strip() == heading for column in table.columns) > 1:
            raise refuse(field, shown(heading), "a heading of one column", "Rename one of the columns.")
    kind = description.abscissa.kind
    count = columns[description.channel[0].column].values.size
    if count < FEWEST_SAMPLES and kind not in ("speed", "order"):
        raise refuse("data", f"{count} rows", f">= {FEWEST_SAMPLES} rows", "Check the file.")
    place = _place(description.abscissa, columns, count)
    values = {channel.name: _si_values(channel, columns[channel.column]) for channel in description.channel}
    if kind == "speed":
        return over_speed(
            place.values, [_speed_column(c, values[c.name]) for c in description.channel], facts
        )
    if kind == "order":
        parts = [
            OrderColumn(c.name, c.quantity, c.pair, c.part or "amplitude", values[c.name])
            for c in description.channel
        ]
        return curves_of_parts(parts, place.values, facts, pair)
    channels = tuple(
        Channel(channel.name, channel.quantity, values[channel.name], channel.pair, _noise(channel))
        for channel in description.channel
    )
    return curves_over(place, channels, facts, pair)


def _place(abscissa: AbscissaOfData, columns: dict[str, Column], count: int) -> Place:
    """Places of the samples."""
    if abscissa.sampling_rate is not None:
        return Place("time", np.arange(count) / abscissa.sampling_rate, "sampling_rate")
    kind: AbscissaKind = abscissa.kind  # type: ignore[assignment]
    heading = str(abscissa.column)
    values = finite(real_values(columns[heading], "abscissa.column"), "abscissa.column")
    if kind == "mesh_phase":
        return Place(kind, mesh_phases(values, abscissa.unit, "abscissa.unit"), heading)
    factor = 1.0
    if abscissa.unit is not None:
        factor = si_factor(abscissa.unit, SI_OF_ABSCISSA[kind], "abscissa.unit")
    places = scaled(values, factor, "abscissa.column")
    if kind == "time" and (back := np.flatnonzero(np.diff(places) <= 0.0)).size:
        refused = f"row {back[0] + 2} is not beyond the row before"
        raise refuse("abscissa.column", refused, "increasing values", "Sort or cut the record.")
    return Place(kind, places, heading)


def _si_values(channel: ChannelOfData, column: Column) -> FloatArray:
    """Physical values of a channel in SI; in rad for a phase."""
    field = f"channel.{channel.name}"
    si = "rad" if channel.part == "phase" else QUANTITIES[channel.quantity].unit
    factor = si_factor(channel.unit, si, field)
    cells = finite(real_values(column, field), field)
    return scaled(cells - channel.zero, channel.gain * factor, field)


def _noise(channel: ChannelOfData) -> float | None:
    if channel.noise is None:
        return None
    factor = si_factor(channel.unit, QUANTITIES[channel.quantity].unit, f"channel.{channel.name}")
    return abs(channel.gain * factor) * channel.noise


def _speed_column(channel: ChannelOfData, values: FloatArray) -> SpeedColumn:
    assert channel.value is not None
    return SpeedColumn(
        channel.name, channel.quantity, channel.value, values, channel.order or 0.0, _noise(channel)
    )
