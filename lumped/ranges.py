"""Validity ranges of empirical laws as data, and what lies outside them."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
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

    def __str__(self) -> str:
        unit = "" if self.unit == "1" else f" {self.unit}"
        if not self.stated:
            return f"{self.quantity}: {NOT_STATED}"
        if self.high is None:
            return f"{self.quantity} >= {self.low:g}{unit}"
        if self.low is None:
            return f"{self.quantity} <= {self.high:g}{unit}"
        return f"{self.quantity} {self.low:g} to {self.high:g}{unit}"


@dataclass(frozen=True)
class RangeViolation:
    """One argument that left its range.

    ``minimum`` and ``maximum`` are the extreme values met, in the range's unit; ``share`` is the fraction of
    the positions that lie outside.
    """

    law: str
    range: ValidityRange
    minimum: float
    maximum: float
    share: float

    def __str__(self) -> str:
        unit = "" if self.range.unit == "1" else f" {self.range.unit}"
        return (
            f"{self.law}: {self.range.quantity} runs from {self.minimum:.4g} to {self.maximum:.4g}{unit}, "
            f"outside {self.range} over {100 * self.share:.3g} % of the positions ({self.range.source})"
        )


def range_violations(
    law: str, ranges: Iterable[ValidityRange], values: Mapping[str, ArrayLike]
) -> tuple[RangeViolation, ...]:
    """Compare a law's arguments by name, any shape, in the units of the ranges, with its validity ranges."""
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
            result.append(
                RangeViolation(law, limits, float(value.min()), float(value.max()), float(outside.mean()))
            )
    return tuple(result)


def warn_violations(violations: Iterable[RangeViolation]) -> None:
    """Issue one ``LawRangeWarning`` per violation."""
    for violation in violations:
        warnings.warn(str(violation), LawRangeWarning, stacklevel=3)


def checked(field: str, value: ArrayLike, unit: str, *, allow_zero: bool = False) -> FloatArray:
    """Return a law's argument as a float array, or refuse what no law can take.

    That is a value not finite, negative, or zero where ``allow_zero`` is false.
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
