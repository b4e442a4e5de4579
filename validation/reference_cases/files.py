"""Files of the reference cases: statement, parameter file of the pair, curves, and the index of checksums.

The curves are a table of comma-separated values. The head of a column is the name of a quantity and its unit
in brackets. The first column is the time.
"""

from __future__ import annotations

import hashlib
import tomllib
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from lumped.errors import StorageError
from lumped.typing import FloatArray
from validation.check.curves import Channel, Curves
from validation.check.quantities import QUANTITIES

#: Folder of the files.
DATA = Path(__file__).with_name("data")
#: File with the checksum of every other file, and file of the licence.
INDEX = "index.toml"
LICENCE_FILE = "LICENSE"
#: Layout of the statements. The number rises with every change that breaks programs that read them.
SCHEMA_VERSION = 1
#: Digits of the numbers in a table of curves: a channel is resolved to 1e-8 of its peak to peak or better by
#: a factor of 10. Times have two digits more.
DIGITS = 8
#: Unit of a column -> its size in SI.
UNITS: Mapping[str, float] = {
    "us": 1e-6,
    "um": 1e-6,
    "um/s": 1e-6,
    "urad": 1e-6,
    "N": 1.0,
    "N/um": 1e6,
}
#: SI unit of a quantity -> unit of its column.
_COLUMN_UNITS: Mapping[str, str] = {"m": "um", "m/s": "um/s", "rad": "urad", "N": "N", "N/m": "N/um"}


def case_file(name: str) -> str:
    """Return the name of the file that states a case."""
    return f"{name}.case.toml"


def pair_file(name: str) -> str:
    """Return the name of the parameter file of a case; a case with one degree of freedom has none."""
    return f"{name}.toml"


def curves_file(name: str) -> str:
    """Return the name of the file with the curves of a case."""
    return f"{name}.csv"


def column_unit(quantity: str) -> str:
    """Return the unit of a column of this quantity."""
    return _COLUMN_UNITS[QUANTITIES[quantity].unit]


def curves_text(time: FloatArray, channels: Mapping[str, FloatArray]) -> str:
    """Return the table of curves.

    Parameters
    ----------
    time : (k,) [s]
    channels : name of a quantity -> (k,) in SI
    """
    heads = ["time [us]", *(f"{name} [{column_unit(name)}]" for name in channels)]
    columns = [[f"{value:.{DIGITS + 2}g}" for value in time / UNITS["us"]]]
    columns += [_numbers(values / UNITS[column_unit(name)]) for name, values in channels.items()]
    lines = [",".join(heads), *(",".join(row) for row in zip(*columns, strict=True))]
    return "\n".join(lines) + "\n"


def _numbers(values: FloatArray) -> list[str]:
    """Return values (k,) as text with as many decimals as resolve their peak to peak."""
    size = float(np.ptp(values)) or float(np.abs(values).max()) or 1.0
    decimals = max(DIGITS - 1 - int(np.floor(np.log10(size))), 0)
    return [_short(f"{value:.{decimals}f}") for value in values]


def _short(text: str) -> str:
    """Return a decimal number without zeros at its end, and zero without a sign."""
    short = text.rstrip("0").rstrip(".") if "." in text else text
    return "0" if short in ("-0", "") else short


def read_curves(
    text: str, name: str, *, pinion_speed: float | None = None, pinion_torque: float | None = None
) -> Curves:
    """Return the curves of a table.

    Parameters
    ----------
    text : the table
    name : name of the case
    pinion_speed : [rad/s]
    pinion_torque : [N m]
    """
    head, _, body = text.partition("\n")
    names, units = zip(*(column.rstrip("]").split(" [") for column in head.split(",")), strict=True)
    values = np.loadtxt(body.splitlines(), delimiter=",", ndmin=2).T
    time, *columns = [row * UNITS[unit] for row, unit in zip(values, units, strict=True)]
    channels = tuple(Channel(one, one, row) for one, row in zip(names[1:], columns, strict=True))
    return Curves(name, "time", time, channels, pinion_speed=pinion_speed, pinion_torque=pinion_torque)


def checksum(content: bytes) -> str:
    """Return the SHA-256 of a file as hexadecimal digits."""
    return hashlib.sha256(content).hexdigest()


@cache
def index() -> Mapping[str, str]:
    """Return file -> checksum of all files, in the order in which the cases are listed."""
    return {
        str(file): str(digits)
        for file, digits in tomllib.loads((DATA / INDEX).read_text(encoding="utf-8"))["sha256"].items()
    }


def case_names() -> tuple[str, ...]:
    """Return the names of all cases, from the simple to the rich."""
    ending = case_file("")
    return tuple(file.removesuffix(ending) for file in index() if file.endswith(ending))


def checked_text(file: str) -> str:
    """Return the text of a file whose checksum is that of the index.

    Raises StorageError : the file was changed
    """
    content = (DATA / file).read_bytes()
    if checksum(content) != index()[file]:
        raise StorageError(
            f"The reference data {file} was changed since it was published: install spurcheck again."
        )
    return content.decode("utf-8")


def statement(name: str) -> Mapping[str, Any]:
    """Return what the file of a case states."""
    return tomllib.loads(checked_text(case_file(name)))
