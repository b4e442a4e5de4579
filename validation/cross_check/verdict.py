"""Decisions of the cross-check: single checks against limits, and the verdict on all checks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from types import MappingProxyType


class Verdict(Enum):
    """The outcome of a cross-check: a word for programs and a text for people."""

    AGREES = ("agrees", "the multibody model has the motion of the lumped model, within the limits")
    DIFFERS = (
        "differs",
        "the program is in order, and the multibody model has another motion than the lumped model: a "
        "finding about the lumped model",
    )
    NOT_CHECKED = (
        "not checked",
        "the program is in order, but the multibody model has no periodic motion that could be compared",
    )
    FAILS = ("fails", "a check of the program fails: do not rely on its results")

    def __init__(self, word: str, text: str) -> None:
        self.word = word
        self.text = text

    def __str__(self) -> str:
        """Return the word."""
        return self.word


@dataclass(frozen=True)
class Judgement:
    """A value against a limit. ``check`` is the name of the check, as "variant: same equations: dte"."""

    check: str
    value: float
    limit: float
    reason: str

    @property
    def within(self) -> bool:
        """Whether the value is within the limit. NaN is not within the limit."""
        return self.value <= self.limit


#: Largest difference from the exact model over the peak to peak: of quantities that the tooth load drives
#: (``crosscheck(limit=...)`` sets another), and of those that friction drives.
LOAD_LIMIT = 0.05
FRICTION_LIMIT = 0.20
_INTEGRATION = "the same equations, assembled and integrated independently: only integration error may remain"
_SMALL = f"{_INTEGRATION}; the quantity is about mu times the loads that carry the error, so ten times more"
#: Quantities that friction drives.
_BY_FRICTION = ("y_p", "y_g", "friction_force")
#: Compared quantity -> limit of its largest difference over its peak to peak with the same equations.
SAME_EQUATIONS: Mapping[str, float] = MappingProxyType(
    {
        "dte": 1e-6,
        "x_p": 1e-6,
        "x_g": 1e-6,
        "y_p": 1e-5,
        "y_g": 1e-5,
        "normal_load": 1e-6,
        "friction_force": 1e-5,
    }
)


def limit_of(quantity: str, fidelity: str, limit: float = LOAD_LIMIT) -> tuple[float, str]:
    """Limit of the largest difference over the peak to peak of a quantity at a fidelity, and why.

    limit : limit at "exact" of the quantities that the tooth load drives
    """
    by_friction = quantity in _BY_FRICTION
    if fidelity == "linear":
        return SAME_EQUATIONS[quantity], _SMALL if by_friction else _INTEGRATION
    if by_friction:
        return FRICTION_LIMIT, "driven by friction, whose published coefficients differ by more"
    return (
        limit,
        "small beside what the inputs leave open: damping, relief and torque change a motion by more",
    )
