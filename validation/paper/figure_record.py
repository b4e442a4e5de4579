"""What every figure module returns: data, text and numbers; pictures are drawn from the data elsewhere."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr


@dataclass(frozen=True)
class Number:
    """A value with its unit; "" where it has none. As text it has three figures."""

    value: float
    unit: str = ""

    def __str__(self) -> str:
        size = abs(self.value)
        text = "none" if not np.isfinite(size) else f"{self.value:.{'3g' if size < 1000 else '0f'}}"
        return text if self.unit in ("", "1") else f"{text} {self.unit}"


@dataclass(frozen=True, eq=False)
class FigureRecord:
    """A reproduced figure.

    Attributes
    ----------
    number : of the figure in the paper
    title, text : caption
    numbers : what can be read off it
    data : labelled data by part of the figure
    """

    number: str
    title: str
    text: str
    numbers: Mapping[str, Number]
    data: Mapping[str, xr.Dataset]

    def write(self, folder: Path) -> tuple[Path, ...]:
        """Write the data as NetCDF, and as one CSV per set of dimensions; returns the files."""
        folder.mkdir(parents=True, exist_ok=True)
        files: list[Path] = []
        for part, data in self.data.items():
            stem = f"figure{self.number}_{part}"
            path = folder / f"{stem}.nc"
            data.to_netcdf(path, engine="h5netcdf")
            files.append(path)
            groups: dict[tuple[str, ...], list[str]] = {}
            for name, values in data.data_vars.items():
                if values.ndim:
                    groups.setdefault(tuple(map(str, values.dims)), []).append(str(name))
            for dims, names in groups.items():
                suffix = "" if len(groups) == 1 else "_by_" + "_".join(dims)
                path = folder / f"{stem}{suffix}.csv"
                table = data[names].to_dataframe().reset_index()
                table.to_csv(path, index=False, float_format="%.9g", lineterminator="\n")
                files.append(path)
        return tuple(files)
