"""Validity ranges of empirical laws as data, and violations of these ranges."""

from __future__ import annotations

import contextlib
import math
import warnings
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from lumped.arguments import real_array
from lumped.errors import LawRangeWarning, refuse
from lumped.typing import FloatArray

#: Source text of a range that the sources at hand do not give.
NOT_STATED = "not stated"


@dataclass(frozen=True)
class ValidityRange:
    """Range of one argument of an empirical law, in the law's own unit ("1" for a ratio).

    A limit is None where there is none or where ``source`` is ``NOT_STATED``.
    """

    quantity: str
    unit: str
    low: float | None
    high: float | None
    source: str

    @property
    def stated(self) -> bool:
        """Whether the source gives a limit at all."""
        return self.low is not None or self.high is not None

    @property
    def words(self) -> str:
        """The quantity in words."""
        return self.quantity.replace("_", " ")

    def __str__(self) -> str:
        unit = "" if self.unit == "1" else f" {self.unit}"
        if not self.stated:
            return f"{self.words}: {NOT_STATED}"
        if self.high is None:
            return f"{self.words} >= {self.low:g}{unit}"
        if self.low is None:
            return f"{self.words} <= {self.high:g}{unit}"
        return f"{self.words} {self.low:g} to {self.high:g}{unit}"


@dataclass(frozen=True)
class RangeViolation:
    """An argument of a law outside its validity range.

    Attributes
    ----------
    law, range : name of the law, and the range of the argument
    minimum, maximum : extreme values of the argument, in the range's unit
    share : fraction of the positions that lie outside
    largest : largest friction coefficient at these positions; NaN where the law is no friction law
    """

    law: str
    range: ValidityRange
    minimum: float
    maximum: float
    share: float
    largest: float = math.nan

    def __str__(self) -> str:
        unit = "" if self.range.unit == "1" else f" {self.range.unit}"
        low = f"{self.minimum:.4g}"
        high = f"{self.maximum:.4g}"
        values = f"is {low}" if low == high else f"runs from {low} to {high}"
        friction = "" if math.isnan(self.largest) else f", where mu is up to {self.largest:.2g}"
        return (
            f"{self.law}: {self.range.words} {values}{unit}, outside {self.range} over "
            f"{100 * self.share:.3g} % of the positions{friction} ({self.range.source})"
        )


def range_violations(
    law: str, ranges: Iterable[ValidityRange], values: Mapping[str, ArrayLike], friction: ArrayLike = math.nan
) -> tuple[RangeViolation, ...]:
    """Compare the arguments of a law with its validity ranges.

    Parameters
    ----------
    law : name of the law
    ranges : validity ranges of the law
    values : arguments by quantity, of any shape, in the units of the ranges
    friction : friction coefficient at the same positions [-]; NaN where the law is no friction law
    """
    result = []
    for limits in ranges:
        if not limits.stated or limits.quantity not in values:
            continue
        value = np.asarray(values[limits.quantity], dtype=float)
        outside = np.zeros(value.shape, dtype=bool)
        if limits.low is not None:
            outside |= value < limits.low
        if limits.high is not None:
            outside |= value > limits.high
        if outside.any():
            largest = float(np.max(np.where(outside, np.abs(friction), 0.0)))
            share = float(outside.mean())
            result.append(RangeViolation(law, limits, float(value.min()), float(value.max()), share, largest))
    return tuple(result)


def warn_violations(violations: Iterable[RangeViolation]) -> None:
    """Issue one ``LawRangeWarning`` per violation."""
    for violation in violations:
        subject = f"{violation.law}: {violation.range.quantity}"
        warnings.warn(LawRangeWarning(str(violation), subject, violation.largest), stacklevel=3)


def warnings_are_heard() -> bool:
    """Whether a ``LawRangeWarning`` can reach anybody: no filter that comes first ignores all of them."""
    for action, message, category, module, line in warnings.filters:
        if issubclass(LawRangeWarning, category):
            return action != "ignore" or message is not None or module is not None or line != 0
    return True


@contextlib.contextmanager
def warned_once() -> Iterator[None]:
    """Issue one ``LawRangeWarning`` per law and quantity at the end: the one with the largest coefficient."""
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always", LawRangeWarning)
        yield
    worst: dict[str, warnings.WarningMessage] = {}
    for one in warned:
        subject = str(getattr(one.message, "subject", one.message))
        worst_so_far = worst.setdefault(subject, one)
        if getattr(one.message, "largest", 0.0) > getattr(worst_so_far.message, "largest", 0.0):
            worst[subject] = one
    for one in worst.values():
        warnings.warn_explicit(one.message, one.category, one.filename, one.lineno)


def checked(field: str, value: ArrayLike, unit: str, *, allow_zero: bool = False) -> FloatArray:
    """Return an argument of a law as a float array, or refuse it.

    Values that are not finite or negative are refused, and zero where ``allow_zero`` is false.
    """
    array = real_array(field, value, finite=False)
    # Two reductions settle the usual case; laws are evaluated thousands of times in a chart.
    if array.size == 0:
        return array
    low = array.min()
    if (low > 0.0 or (allow_zero and low == 0.0)) and array.max() < np.inf:
        return array
    good = np.isfinite(array) & ((array >= 0.0) if allow_zero else (array > 0.0))
    offender = array[~good].flat[0]
    allowed = f"finite and {'>=' if allow_zero else '>'} 0 {unit}"
    raise refuse(field, f"{offender:g} {unit}", allowed, "Check its sign and unit.")
