"""A table of columns: what every file and every object becomes before its headings are understood."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lumped.errors import ParameterError

#: Most columns of a source.
MOST_COLUMNS = 4096


@dataclass(frozen=True, eq=False)
class Column:
    """One column.

    Attributes
    ----------
    heading : heading as written in the source, without surrounding blanks
    values : (k,) real or complex numbers in the unit of the source
    unit : unit that the source states beside the heading; None: the heading may contain a unit
    tooth_pair : label of the tooth pair where the source states it beside the heading
    damage : refusal of the first cell without a number, raised where the column is used
    """

    heading: str
    values: NDArray[Any]
    unit: str | None = None
    tooth_pair: str | None = None
    damage: ParameterError | None = None


@dataclass(frozen=True, eq=False)
class Table:
    """Columns of equal or different lengths, and values beside them.

    Attributes
    ----------
    name : short name of the source
    columns : columns with numbers
    stated : name -> value beside the columns: a number, text or array such as ``pinion_torque`` or ``M``
    recurrence : mesh cycles after which the same labelled tooth pair is in contact again; None: not stated
    remarks : sentences on how the source was read
    """

    name: str
    columns: tuple[Column, ...]
    stated: Mapping[str, Any] = field(default_factory=dict)
    recurrence: int | None = None
    remarks: tuple[str, ...] = ()


def numbers_of(values: Any) -> NDArray[Any] | None:
    """Return an array of real or complex numbers in double precision; None where values are anything else."""
    try:
        array = np.asarray(values)
    except (TypeError, ValueError, OverflowError, MemoryError):
        return None
    if array.dtype.kind in "iuf":
        return array.astype(np.float64, copy=False)
    return array.astype(np.complex128, copy=False) if array.dtype.kind == "c" else None


def listed(names: list[str] | tuple[str, ...], most: int = 8) -> str:
    """Return names with commas between them, at most ``most``."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more
