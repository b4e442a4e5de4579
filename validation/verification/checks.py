"""What verification returns: numbers with the limits that they are judged by."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from validation.files.tables import read_table


@dataclass(frozen=True)
class Check:
    """A computed number and what it must be.

    Attributes
    ----------
    key : stable name for programs
    subject : the code that is checked
    exact : what it must equal, and where that comes from
    value : error, relative where not said otherwise; or an observed order
    limit : largest error that passes; or largest distance of the order from theory
    reason : why the limit is what it is
    theory : the order that theory gives; None: ``value`` is an error
    """

    key: str
    subject: str
    exact: str
    value: float
    limit: float
    reason: str = ""
    theory: float | None = None

    @property
    def passes(self) -> bool:
        """Whether the number is one and within its limit."""
        return math.isfinite(self.value) and abs(self.value - (self.theory or 0.0)) <= self.limit

    @property
    def wanted(self) -> str:
        """What the number must be, in words."""
        if self.theory is None:
            return f"≤ {self.limit:g}"
        return f"{self.theory - self.limit:g} to {self.theory + self.limit:g}"


#: "check" or "refinement" -> key -> words, limit and reason.
_STATED = read_table("validation.verification", "checks.toml")


def _row(kind: str, key: str, numbers: dict[str, object]) -> dict[str, Any]:
    """Words and limit of a key, with the numbers put in."""
    row = _STATED[kind][key].items()
    return {k: v.format(**numbers) if isinstance(v, str) else v for k, v in row}


def check(key: str, value: float, **numbers: object) -> Check:
    """Check of a key of ``checks.toml``.

    Parameters
    ----------
    key : in the table "check"
    value : what was computed
    **numbers : those that its words have in braces
    """
    return Check(key=key, value=float(value), **_row("check", key, numbers))


def rows_check(key: str, rows: ArrayLike) -> Check:
    """Check of the largest relative difference between numbers (rows, 2): found, and what they must be."""
    found, wanted = np.asarray(rows, dtype=float).T
    return check(key, np.max(np.abs(found - wanted) / np.maximum(np.abs(wanted), 1e-300)))


@dataclass(frozen=True)
class Level:
    """One resolution of a refinement.

    Attributes
    ----------
    setting : the resolution in words
    error : difference from the finest one, see ``Refinement.measure``
    used : whether the report's numbers are computed with it
    """

    setting: str
    error: float
    used: bool = False


@dataclass(frozen=True)
class Refinement:
    """One solution of this gear pair at several resolutions.

    Attributes
    ----------
    key : stable name for programs
    subject : the solution
    measure : what the error is of, and relative to what
    levels : from coarse to fine
    limit : largest error of the resolution that is used
    reason : why the limit is what it is
    """

    key: str
    subject: str
    measure: str
    levels: tuple[Level, ...]
    limit: float
    reason: str

    @property
    def error(self) -> float:
        """Error of the resolution that is used."""
        return next(level.error for level in self.levels if level.used)

    @property
    def passes(self) -> bool:
        """Whether the used resolution is within its limit and refining has brought the error down to it."""
        first, used = self.levels[0].error, self.error
        return math.isfinite(used) and used <= self.limit and used <= max(first, self.limit)


def refinement(key: str, levels: Sequence[Level], **numbers: object) -> Refinement:
    """Refinement of a key of ``checks.toml``; ``numbers`` are those that its words have in braces."""
    return Refinement(key=key, levels=tuple(levels), **_row("refinement", key, numbers))


#: Relative error of a peak to peak that is read off samples: half a unit of the third digit, the last shown.
