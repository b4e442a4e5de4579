"""What a measured record is: the small TOML file that names its columns, units and sampling."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import Field, ValidationError, model_validator

from lumped.arguments import file_path
from lumped.errors import ParameterError, refuse
from lumped.fields.refusals import translated
from lumped.fields.section import OneOf, Section, Text
from lumped.fields.text_file import parse_toml, read_text
from lumped.fields.units import Quantity, to_si

#: Quantity of a channel -> (SI unit, whether it belongs to one tooth pair). Names are those of the models'
#: results.
QUANTITIES: dict[str, tuple[str, bool]] = {
    "normal_load": ("N", True),
    "friction_force": ("N", True),
    "dte": ("m", False),
    "x_p": ("m", False),
    "x_g": ("m", False),
    "y_p": ("m", False),
    "y_g": ("m", False),
    "bearing_force_x_p": ("N", False),
    "bearing_force_x_g": ("N", False),
    "bearing_force_y_p": ("N", False),
    "bearing_force_y_g": ("N", False),
}
PAIR_LABELS = "ABCDEFGH"
#: Largest description read: a bound against a wrong path.
MAX_FILE_BYTES = 1_000_000


class Abscissa(Section):
    """Where the samples lie: a column of times or roll angles, or a constant sampling rate."""

    kind: Literal["time", "roll_angle", "sampled"] = Field(
        description="time, pinion roll angle at the contact of pair A, or equidistant samples in time"
    )
    column: str | None = Field(None, description="column of the times or roll angles")
    unit: str | None = Field(None, description="its unit; default the unit in the column's heading")
    sampling_rate: Annotated[float | None, Quantity("Hz", above=0, optional=True)] = Field(
        None, description="samples per second, for kind 'sampled'"
    )

    @model_validator(mode="after")
    def _complete(self) -> Self:
        if self.kind == "sampled":
            if self.sampling_rate is None or self.column is not None:
                raise refuse(
                    "sampling_rate",
                    self.sampling_rate,
                    "a rate and no column for kind 'sampled'",
                    "Give sampling_rate, or use kind 'time'.",
                )
        elif self.column is None or self.sampling_rate is not None:
            raise refuse(
                "column", self.column, f"a column and no rate for kind '{self.kind}'", "Name the column."
            )
        return self


class Channel(Section):
    """One measured column; the physical value is gain * (cell - zero)."""

    name: str = Field(min_length=1, max_length=60, pattern=r"^\w+$", description="name in results")
    column: str = Field(min_length=1, description="heading of the column, without its unit")
    quantity: Annotated[str, OneOf(tuple(QUANTITIES))] = Field(description="measured quantity")
    unit: str | None = Field(None, description="unit of the cells; default the unit in the column's heading")
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


def read_specification(source: str | Path | Mapping[str, Any]) -> tuple[MeasurementSpec, Path]:
    """Read the description of a record.

    Parameters
    ----------
    source : path of a TOML file, or its content as a mapping

    Returns
    -------
    the description and the folder its data file is relative to

    Raises
    ------
    ParameterError : no such file, malformed TOML, or a field that is wrong; all problems at once
    """
    if isinstance(source, Mapping):
        data, folder, name = dict(source), Path(), "mapping"
    else:
        path = file_path("measurement", source)
        folder, name = path.parent, str(path)
        data = parse_toml(read_text(path, MAX_FILE_BYTES, kind="TOML file"), name)
    try:
        return MeasurementSpec.model_validate(data), folder
    except ParameterError as error:
        raise ParameterError(list(error.problems), name) from None
    except ValidationError as error:
        raise ParameterError(translated(error, MeasurementSpec), name) from None


def si_factor(unit: str, si_unit: str, field: str) -> float:
    """Return the factor from a unit to an SI unit of the same dimension.

    Parameters
    ----------
    unit : as pint reads it
    si_unit : a key of ``lumped.fields.units.UNITS``
    field : place for the message

    Raises
    ------
    ParameterError : no unit, or another dimension
    """
    try:
        return to_si(f"1 {unit}", si_unit)
    except ValueError as error:
        raise refuse(field, unit, f"a unit that converts to {si_unit}", f"{error}.") from None
