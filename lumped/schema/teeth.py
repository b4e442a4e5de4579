"""Schema of teeth that differ: deviations of a gear's teeth, its mounting, ripple of the torques.

Sources: docs/theory/teeth.md.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, ValidationInfo, model_validator

from lumped.errors import FieldProblem, refuse, shown
from lumped.fields.section import Section
from lumped.fields.text_file import read_text
from lumped.fields.units import Quantity, QuantityList
from lumped.schema.tolerances import tolerance_class_of

#: Column of a file of measured deviations -> field; lengths in um.
_COLUMNS = {"index_um": "index", "profile_slope_um": "profile_slope", "tip_relief_um": "tip_relief"}
#: A semicolon or tab between the columns goes with decimal commas, as spreadsheets write in many countries.
_FORMAT = "a header tooth,index_um[,profile_slope_um][,tip_relief_um], then a row for each tooth: 1, 2, ..."
_MAX_BYTES = 1_000_000

_Class = Annotated[int, Field(ge=1, le=11)] | str | None
_LIST = QuantityList("um", at_least=-1000, at_most=1000)


class Deviations(Section):
    """Deviations of the teeth of one gear: drawn within a tolerance class, or lists of one value a tooth."""

    tolerance_class: Annotated[
        Annotated[int, Field(ge=1, le=11, strict=True)] | None,
        BeforeValidator(tolerance_class_of, json_schema_input_type=_Class),
    ] = Field(
        None,
        description="ISO 1328-1:2013, 1 to 11, also as 'ISO 6' or 'DIN 6': pitch deviations are drawn within "
        "its tolerances",
    )
    seed: int = Field(1, ge=0, le=2**53, strict=True, description="of the draw; the same gear for each seed")
    index: Annotated[tuple[float, ...] | None, _LIST] = Field(
        None,
        description="index (cumulative pitch) deviations of the loaded flanks, one a tooth in order of "
        "engagement; positive further along the count. Or file = 'x.csv' with the columns tooth, index_um",
    )
    profile_slope: Annotated[tuple[float, ...] | None, _LIST] = Field(
        None, description="profile slope deviations f_Halpha, one a tooth; positive: material at the tip"
    )
    tip_relief: Annotated[tuple[float, ...] | None, _LIST] = Field(
        None, description="tip relief beyond that of the section tip_relief, with its shape and start"
    )
    counted: Literal["with", "against"] = Field(
        "with", description="'against': teeth of the lists are numbered against the order of engagement"
    )
    first_order: Literal["eccentricity", "steps"] = Field(
        "eccentricity",
        description="'eccentricity': the first harmonic of the index deviations turns as an eccentric gear; "
        "'steps': it stays in the list",
    )

    @model_validator(mode="before")
    @classmethod
    def _read_file(cls, data: Any, info: ValidationInfo) -> Any:
        """Replace ``file = "pinion.csv"`` by its columns; a relative path is beside the parameter file."""
        if not isinstance(data, dict) or "file" not in data:
            return data
        folder = (info.context or {}).get("folder", ".")
        return {key: value for key, value in data.items() if key != "file"} | read_deviations(
            data["file"], folder
        )

    @model_validator(mode="after")
    def _one_source(self) -> Self:
        lists = [self.index, self.profile_slope, self.tip_relief]
        stated = [one for one in lists if one is not None]
        if self.tolerance_class is not None and self.index is not None:
            action = "Remove one: a tolerance class draws the index deviations."
            raise refuse("index", f"{len(self.index)} values", "tolerance_class, index or file", action)
        if self.tolerance_class is None and self.seed != 1:
            action = "Give the class too, or leave the seed out."
            raise refuse("seed", str(self.seed), "a tolerance_class whose teeth it draws", action)
        if self.tolerance_class is None and not stated:
            raise refuse("tolerance_class", "missing", "tolerance_class, index or file", "Give one of them.")
        return self

    def problems(self, teeth: int, relieved: bool) -> Iterator[FieldProblem]:
        """Problems of lists that do not fit the number of teeth, or a gear without tip relief."""
        for name in ("index", "profile_slope", "tip_relief"):
            values = getattr(self, name)
            if values is not None and len(values) != teeth:
                action = "Complete the list, or correct the number of teeth."
                yield FieldProblem(name, f"{len(values)} values", f"one a tooth, {teeth}", action)
        if self.tip_relief is not None and not relieved:
            action = "Give the gear the section tip_relief, whose shape and start hold."
            yield FieldProblem(
                "tip_relief", f"{len(self.tip_relief)} values", "a gear with tip relief", action
            )


class Mounting(Section):
    """Position of a gear on the shaft."""

    eccentricity: Annotated[float, Quantity("um", at_least=0, at_most=1000)] = Field(
        0.0, description="of the base circle's centre from the axis of rotation"
    )
    phase: Annotated[float, Quantity("deg", at_least=0, at_most=360)] = Field(
        0.0,
        description="of the error along the line of action, eccentricity cos(rotation + phase), "
        "positive where the teeth come too late",
    )


class TorqueRipple(Section):
    """A harmonic of the torque of one shaft."""

    shaft: Literal["pinion", "gear"] = Field(
        description="the shaft on which it acts and whose turns it counts"
    )
    order: Annotated[int, Field(ge=1, le=1000, strict=True)] = Field(
        description="periods a turn of the shaft"
    )
    amplitude: Annotated[float, Quantity("N*m", at_least=0, at_most=1e9)] = Field(
        description="of the torque, amplitude cos(order rotation + phase); driving pinion, braking gear"
    )
    phase: Annotated[float, Quantity("deg", at_least=0, at_most=360)] = Field(
        0.0, description="where tooth 1 is at the start of contact A"
    )


def read_deviations(file: object, folder: str | Path = ".") -> dict[str, object]:
    """Read measured deviations: the lists of the schema in um, in the order of the teeth."""
    if not isinstance(file, str):
        raise refuse("file", file, "the name of a CSV file", "Write the name as text.")
    path = Path(folder) / file
    text = read_text(path, _MAX_BYTES, kind="CSV file")
    lines = [line.strip() for line in text.splitlines() if line.strip() and line.lstrip()[0] != "#"]
    mark = next((one for one in ";\t" if lines and one in lines[0]), ",")
    if mark != ",":  # a spreadsheet with decimal commas
        lines = [line.replace(",", ".").rstrip(mark) for line in lines]
    rows = list(csv.reader(lines, delimiter=mark))
    names = [name.strip().lower() for name in rows[0]] if rows else []
    allowed_names = {"tooth", *_COLUMNS}
    if not {"tooth"} < {*names} <= allowed_names or len(names) != len({*names}) or len(rows) < 2:
        raise refuse("file", path, _FORMAT, f"The header is '{shown(','.join(names))}'.")
    try:
        table = [[float(cell) for cell in row] for row in rows[1:]]
        columns = dict(zip(names, zip(*table, strict=True), strict=True))
    except ValueError as error:
        action = f"A row is no row of numbers: {shown(str(error))}."
        raise refuse("file", path, _FORMAT, action) from None
    if sorted(columns["tooth"]) != list(range(1, len(table) + 1)):
        action = "Number the teeth, each once."
        raise refuse("file", path, f"teeth 1 to {len(table)} in the column tooth", action)
    order = sorted(range(len(table)), key=lambda row: columns["tooth"][row])
    return {
        field: [columns[name][row] for row in order] for name, field in _COLUMNS.items() if name in columns
    }
