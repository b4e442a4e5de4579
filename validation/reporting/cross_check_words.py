"""What several chapters say about the cross-check of both models."""

from __future__ import annotations

from validation.cross_check.comparison import CrossCheck
from validation.cross_check.judgement import Judgement
from validation.reporting.formatting import number, quantity

#: Short names of the quantities that the models are compared by.
NAMES = {
    "dte": "transmission error",
    "x_p": "pinion x",
    "x_g": "gear x",
    "y_p": "pinion y",
    "y_g": "gear y",
    "normal_load": "normal load",
    "friction_force": "friction force",
}


#: Kind of a check that compares motions -> what its value is.
_DIFFERENCES = {
    "linear": "off with the same equations",
    "remainder": "off beyond what is understood",
    "same motion": "off, which is another motion",
}


def failed_checks(check: CrossCheck, most: int = 3) -> str:
    """The first checks that fail, with value and limit."""
    failed = check.failures
    told = [_failed(j) for j in failed[:most]]
    more = [f"and {len(failed) - most} more"] if len(failed) > most else []
    return "; ".join(told + more)


def _failed(judgement: Judgement) -> str:
    """One check that fails; a difference of the motions in words."""
    value, limit = judgement.value, judgement.limit
    check = judgement.check.removeprefix("twin: ")
    kind, _, quantity_name = check.partition(": ")
    if kind not in _DIFFERENCES or quantity_name not in NAMES:
        return f"{judgement.check} {number(value, 2)}, limit {number(limit, 2)}"
    of = " of its unlike twin" if check != judgement.check else ""
    return f"{NAMES[quantity_name]}{of} {percent(value)} {_DIFFERENCES[kind]}, limit {percent(limit)}"


def same_equations(check: CrossCheck) -> str:
    """How well the multibody model agrees when it holds the equations of the lumped model."""
    worst = check.worst("linear")
    verb = "agrees" if worst.within else "does not agree"
    return (
        f"With the same equations the multibody model {verb}: {NAMES[worst.quantity]} to "
        f"{number(worst.judged, 2)} of its peak to peak, tolerance {number(worst.tolerance.limit, 2)}."
    )


def finite_motions(check: CrossCheck) -> str:
    """How much the exact model differs, in the transmission error and in whatever differs most.

    The text also says how much of the difference follows from the lumped motion. A difference is stated
    whatever the verdict is: also one that is understood, and so within its tolerance.
    """
    exact = check.of("exact")
    # To the digits printed: the bodies of a 1:1 pair differ by rounding, and the first is named every time.
    largest = max(exact, key=lambda a: float(f"{a.relative_l2:.2g}"))
    dte = next((a for a in exact if a.quantity == "dte"), largest)
    most = ""
    if largest.quantity != dte.quantity:
        most = f" and {NAMES[largest.quantity]}, most of all, by {percent(largest.relative_l2)}"
    worst = check.worst("exact")
    left, limit = percent(worst.remainder_l2), percent(worst.tolerance.limit)
    accounts = f"accounts for all but {left} (tolerance {limit})"
    if worst.remainder_l2 > 0.5 * worst.relative_l2:
        accounts = f"does not account for this ({left} left, tolerance {limit})"
    return (
        f"Its contact follows the actual motion, which changes the {NAMES[dte.quantity]} by "
        f"{percent(dte.relative_l2)}{most} (rms of the change over rms of the motion); the lumped motion "
        f"alone {accounts}."
    )


def percent(ratio: float) -> str:
    """A ratio in percent, two digits."""
    return quantity(100 * ratio, "%", 2)
