"""What figures and chapters of the paper return: text, numbers, data, verdicts; no pictures."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
import xarray as xr

#: The paper that is reproduced.
PAPER = (
    "A. F. Abbas Al-Zubaidi, Alternate sliding friction formulations of elasto-hydrodynamic of spur gears, "
    "Journal of Engineering (Baghdad) 14(4), 2008"
)

ErratumVerdict = Literal["wrong", "incomplete", "misprinted symbol"]
ClaimVerdict = Literal["reproduced", "not reproduced", "cannot be judged"]


@dataclass(frozen=True)
class Number:
    """A value and a unit ("" for a number without unit). The text of a number has three figures."""

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


@dataclass(frozen=True)
class Evidence:
    """One number or test, with the equation as printed and as repaired.

    Attributes
    ----------
    quantity : what is computed, in plain words
    unit : of both values; "" for a statement
    printed, repaired : values, or short statements
    requirement : what holds for a right equation; "" where the row only shows the size of the effect
    """

    quantity: str
    unit: str
    printed: float | str
    repaired: float | str
    requirement: str = ""


@dataclass(frozen=True)
class Erratum:
    """One misprint, shown by computation.

    Attributes
    ----------
    equation : number in the paper
    printed, repaired : the disputed term
    verdict : "wrong", "incomplete" or "misprinted symbol"
    text : what the evidence shows
    evidence : the computations
    """

    equation: str
    printed: str
    repaired: str
    verdict: ErratumVerdict
    text: str
    evidence: tuple[Evidence, ...]


@dataclass(frozen=True)
class ErrataChapter:
    """The errata of the print with everything that shows them.

    Attributes
    ----------
    text : introduction
    conditions : operating point and assumptions of the computations, name -> value with unit
    errata : one per row of the table
    histories : dte, x_g and y_g over one mesh cycle, (variant, phase), "repaired" and each printed sign alone
    """

    text: str
    conditions: Mapping[str, str]
    errata: tuple[Erratum, ...]
    histories: xr.Dataset


@dataclass(frozen=True, kw_only=True)
class Statement:
    """One statement of the paper that can be judged by a number.

    Attributes
    ----------
    name : short name
    statement : what the paper says, in other words
    definition : how the number is computed
    unit : its unit
    criterion : when the statement counts as reproduced
    """

    name: str
    statement: str
    definition: str
    unit: str
    criterion: str


@dataclass(frozen=True, kw_only=True)
class Claim(Statement):
    """A statement with its number and its verdict.

    Attributes
    ----------
    value : the number at the stated assumptions
    verdict : "reproduced", "not reproduced" or "cannot be judged"
    reason : why it is not reproduced or cannot be judged; of a reproduced one a remark, or ""
    details : further numbers
    share : share of the usable samples of the assumptions in which the criterion holds; None where none was
        sampled or usable
    usable : samples in which the motion behind the number is stable and in contact
    low, high : 5th and 95th percentile of the number over these samples
    """

    value: float
    verdict: ClaimVerdict
    reason: str
    details: Mapping[str, Number]
    share: float | None
    usable: int
    low: float | None
    high: float | None


@dataclass(frozen=True)
class ClaimsTable:
    """All claims, and how the assumptions were varied.

    Attributes
    ----------
    text : introduction
    ranges : assumption -> range of the Latin hypercube, as text with unit
    samples : number of samples of the hypercube; 0 without it
    failed : samples in which a law or a periodic motion did not exist
    seed : of the hypercube
    claims : the rows
    """

    text: str
    ranges: Mapping[str, str]
    samples: int
    failed: int
    seed: int
    claims: tuple[Claim, ...]
