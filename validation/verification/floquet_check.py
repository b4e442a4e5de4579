"""One number of the verification of the Floquet engine, with the bounds it must keep."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Check:
    """One number of the verification.

    Attributes
    ----------
    name : what is checked
    value : the number found
    low, high : what it must lie between
    meaning : what the number is
    """

    name: str
    value: float
    low: float
    high: float
    meaning: str

    @property
    def passed(self) -> bool:
        """Whether the number keeps its bounds."""
        return bool(self.low <= self.value <= self.high)

    @property
    def wanted(self) -> str:
        """The bounds in words."""
        return f"≤ {self.high:g}" if self.low == 0.0 else f"{self.low:g} to {self.high:g}"


def error(name: str, value: float, bound: float, meaning: str) -> Check:
    """Check of an error against its bound."""
    return Check(name, float(value), 0.0, bound, meaning)


def order(name: str, value: float, expected: float, margin: float) -> Check:
    """Check of an observed order against theory."""
    return Check(
        name, float(value), expected - margin, expected + margin, f"observed order, theory {expected:g}"
    )
