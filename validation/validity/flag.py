"""One checked assumption of the model: its state in numbers, and what it is for in words.

Sources: docs/theory/validity.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

State = Literal["ok", "warning", "violated"]

#: Key of a flag -> its plain name, unit of its number, what it is for, and what to do where it is raised.
_ABOUT: dict[str, tuple[str, str, str, str]] = {
    "contact_loss": (
        "Teeth stay in contact",
        "N",
        "The equations let a tooth pair pull. A negative load means the teeth separate in reality, and the "
        "motion after that is not the one predicted.",
        "Raise the torque or the damping, leave the resonance, or use the exact multibody model, which lets "
        "teeth separate.",
    ),
    "sliding_reversal": (
        "Sliding keeps its direction",
        "m",
        "The model takes the direction of friction from the nominal rotation. Where vibration reverses the "
        "sliding, the friction force has the wrong sign and feeds energy in.",
        "Use the exact multibody model, which takes friction from the actual sliding velocity; low speeds "
        "and resonances cause this.",
    ),
    "contact_ratio": (
        "Contact ratio",
        "1",
        "Below 1.1 deflection and tolerances leave moments without a loaded pair; above 3 the model does "
        "not apply.",
        "Lengthen the addendum or reduce the centre distance.",
    ),
    "friction_law_range": (
        "Friction law inside its range",
        "1",
        "An empirical law says nothing outside the conditions in which it was fitted.",
        "Choose a law that covers the conditions, or take the friction as an assumption.",
    ),
    "stiffness_range": (
        "Stiffness model inside its range",
        "1",
        "The standard's stiffness and the deflection of the gear body are fits. Outside their range the "
        "stiffness is an extrapolation.",
        'Take the stiffness from finite elements or a measurement (model "table"), or see how far the '
        "results depend on it.",
    ),
    "film_parameter": (
        "Lubrication regime suits the law",
        "1",
        "Laws II and III describe mixed and elastohydrodynamic contacts; in boundary lubrication the "
        "surfaces themselves carry the friction.",
        "Use law V (composite) or a Coulomb law with a measured coefficient.",
    ),
    "torque_balance": (
        "Torques balance",
        "1",
        "Friction takes power. Without the balancing torque the mean speed would drift, and there would be "
        "no periodic motion.",
        'Set operating.brake_torque = "balanced", or correct one of the torques.',
    ),
    "speed_drift": (
        "Mean speed is steady",
        "1",
        "Coefficients repeat with the nominal speed. A drifting speed makes the prediction wrong, not "
        "transient.",
        "Balance the torques.",
    ),
    "solution_error": (
        "Periodic motion is accurate",
        "1",
        "A numerical error must stay far below every difference that is discussed.",
        "Check for extreme stiffness, damping or speed.",
    ),
    "stability": (
        "Periodic motion is stable",
        "1",
        "A multiplier outside the unit circle grows from mesh cycle to mesh cycle: the periodic motion then "
        "exists on paper only.",
        "Raise the mesh or bearing damping, or leave the speed range of the tongue.",
    ),
}


@dataclass(frozen=True)
class Flag:
    """One assumption of the model, checked.

    Attributes
    ----------
    key : stable name for programs
    name : plain name
    state : "ok", "warning" or "violated"
    value, unit : the number that decides ("1" for a ratio); None where a text says it all
    detail : where and how much
    meaning : what the assumption is for
    action : what to do; empty where nothing needs doing
    """

    key: str
    name: str
    state: State
    value: float | None
    unit: str
    detail: str
    meaning: str
    action: str


def worst_state(flags: Sequence[Flag]) -> State:
    """Most serious state among flags."""
    order: tuple[State, ...] = ("ok", "warning", "violated")
    return max((flag.state for flag in flags), key=order.index, default="ok")


def flag(key: str, state: State, value: float | None, detail: str) -> Flag:
    """The flag of a key of ``_ABOUT``; it tells what to do only where something needs doing."""
    name, unit, meaning, action = _ABOUT[key]
    return Flag(key, name, state, value, unit, detail, meaning, "" if state == "ok" else action)
