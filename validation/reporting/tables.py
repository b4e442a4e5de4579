"""Tables and figures of a report as CSV files, and all tables in one workbook."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pandas as pd
import xarray as xr

from validation.reporting.blocks import Picture, Quantity, Table, plain

#: Longest name of a sheet that the format allows.
_LONGEST = 31


def frame(table: Table) -> pd.DataFrame:
    """Return a table as a data frame with numbers in the unit of their column.

    The unit of a column stands in the heading: an SI unit, or "rpm", "°", "%". If a column has several
    units, a column ``<name> unit`` follows.
    """
    columns: dict[str, list[object]] = {}
    for place, name in enumerate(table.columns):
        cells = [row[place] for row in table.rows]
        units = {one.unit for one in cells if isinstance(one, Quantity)}
        values: list[object] = []
        for one in cells:
            value = plain(one)
            if isinstance(value, dict):
                value = value["value"] if "value" in value else value["text"]
            values.append(value)
        only = next(iter(units)) if len(units) == 1 else ""
        columns[f"{name} [{only}]" if only and only != "1" else name] = values
        if len(units) > 1:
            columns[f"{name} unit"] = [one.unit if isinstance(one, Quantity) else "" for one in cells]
    return pd.DataFrame(columns)


def write_tables(tables: Sequence[Table], pictures: Sequence[Picture], folder: Path) -> None:
    """Write each table and the data of each figure as CSV, and all tables as ``tables.xlsx``."""
    with pd.ExcelWriter(folder / "tables.xlsx", engine="openpyxl") as book:
        for table in tables:
            data = frame(table)
            data.to_csv(folder / f"{table.key}.csv", index=False, lineterminator="\n")
            data.to_excel(book, sheet_name=table.key[:_LONGEST], index=False)
    for picture in pictures:
        groups: dict[tuple[str, ...], list[str]] = {}
        for name, variable in picture.data.data_vars.items():
            groups.setdefault(tuple(map(str, variable.dims)), []).append(str(name))
        for number, names in enumerate(groups.values()):
            data = picture.data[names].to_dataframe()[names].rename(columns=_heading(picture.data, names))
            suffix = f"_{number + 1}" if number else ""
            data.to_csv(folder / f"figure_{picture.key}{suffix}.csv", lineterminator="\n")


def _heading(data: xr.Dataset, names: list[str]) -> dict[str, str]:
    """Variable -> name with unit."""
    units = {name: str(data[name].attrs["units"]) for name in names}
    return {name: name if unit == "1" else f"{name} [{unit}]" for name, unit in units.items()}
