"""A number of the evidence, and what it must be."""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike


@dataclass(frozen=True)
class Check:
    """A computed number: ``value`` is an error, or, where ``theory`` is given, an observed order."""

    subject: str  # what is checked
    exact: str  # what it must equal, and where that comes from
    value: float  # error, relative where not said otherwise; or an observed order
    limit: float  # largest error that passes; or largest distance of the order from theory
    theory: float | None = None  # the order that theory gives

    @property
    def passes(self) -> bool:
        """Whether the number is one and within its limit."""
        return math.isfinite(self.value) and abs(self.value - (self.theory or 0.0)) <= self.limit


def rows(subject: str, exact: str, limit: float, values: ArrayLike) -> Check:
    """Largest relative difference between numbers (rows, 2): found, and what they must be."""
    computed, wanted = np.asarray(values, dtype=float).T
    error = np.max(np.abs(computed - wanted) / np.maximum(np.abs(wanted), 1e-300))
    return Check(subject, exact, float(error), limit)


def order(subject: str, value: float, theory: float, limit: float) -> Check:
    """An observed order against theory."""
    return Check(subject, f"observed order, theory {theory:g}", float(value), limit, theory)


def failing(checks: Iterable[Check]) -> list[Check]:
    """Those that do not pass."""
    return [check for check in checks if not check.passes]
