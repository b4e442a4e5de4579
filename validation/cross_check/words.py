"""What several chapters and commands say about the cross-check of both models."""

from __future__ import annotations

import numpy as np
import xarray as xr

import multibody
from lumped import NumericalError
from multibody.run.effects import CAUSES
from validation.cross_check.comparison import CrossCheck
from validation.cross_check.verdict import Judgement
from validation.files.formatting import number, quantity

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

#: What differences from the exact model are measured by, for readers.
MEASURES = (
    "A difference is measured by the peak to peak of the lumped motion. Displacements along the line of "
    "action are measured by that of the transmission error, the load by the force that bends the teeth by "
    "it, and the mean off the line of action by the deflection under the friction force, where these are "
    "larger."
)
#: Swing of the rotation, over the base pitch, that moves the contact in time; and what a machine has.
_TURNS = 0.01
_INERTIA = (
    "motor and brake hold a real machine steadier: add their inertia to pinion.inertia and gear.inertia."
)
_UNILATERAL = (
    "The lumped motion has the places of contact of the mean load; in the exact contact they follow the "
    "momentary load, the rotations and the centres."
)


def failed_checks(check: CrossCheck, most: int = 3) -> str:
    """The first checks that fail, with value and limit."""
    failed = check.failures
    first = [_failed(j) for j in failed[:most]]
    more = [f"and {len(failed) - most} more"] if len(failed) > most else []
    return "; ".join(first + more)


def _failed(judgement: Judgement) -> str:
    """One check that fails; a difference of the motions in words."""
    check = judgement.check.removeprefix("variant: ")
    kind, _, name = check.partition(": ")
    if kind != "same equations":
        return f"{judgement.check} {number(judgement.value, 2)}, limit {number(judgement.limit, 2)}"
    of = " of its asymmetric variant" if check != judgement.check else ""
    value, limit = percent(judgement.value), percent(judgement.limit)
    return f"{NAMES[name]}{of} {value} off with the same equations, limit {limit}"


def same_equations(check: CrossCheck) -> str:
    """How well the multibody model agrees when it holds the equations of the lumped model."""
    worst = check.worst("linear")
    verb = "agrees" if worst.within else "does not agree"
    return (
        f"With the same equations the multibody model {verb}: {NAMES[worst.quantity]} to "
        f"{number(worst.difference, 2)} of its peak to peak, limit {number(worst.limit, 2)}."
    )


def whole_difference(check: CrossCheck) -> str:
    """How much the exact model differs: in the transmission error, and in what uses most of its limit."""
    dte = next(a for a in check.of("exact") if a.quantity == "dte")
    worst = check.worst("exact")
    (own, other), swings = (
        [quantity(value, a.unit, 3) for value in (a.peak_to_peak, a.peak_to_peak_multibody)]
        for a in (dte, worst)
    )
    whole = (
        f"The transmission error of the multibody model is {other} peak to peak beside {own}, and differs by "
        f"at most {share(dte.difference)} of that"
    )
    if worst.quantity == "dte":
        return f"{whole}, limit {percent(dte.limit)}."
    name, limit = NAMES[worst.quantity], percent(worst.limit)
    return f"{whole}; {name}, {swings[1]} beside {swings[0]}, by {share(worst.difference)}, limit {limit}."


def attribution(check: CrossCheck) -> xr.Dataset | None:
    """Effects of the exact model one by one; None where contact is lost, teeth differ, or nothing repeats."""
    if check.orbit is not None or check.pair.healthy is not check.pair:
        return None
    try:
        return multibody.attribution(check.pair)
    except NumericalError:
        return None


def cause_of_difference(check: CrossCheck, found: xr.Dataset | None = None) -> str:
    """What explains most of the difference in what uses most of its limit; empty where that is not known.

    That is an effect of the exact model, or where contact is lost what both motions have not in common.
    ``found`` is the ``attribution``, where it is known already.
    """
    if check.orbit is not None:
        return _UNILATERAL
    found = attribution(check) if found is None else found
    if found is None:
        return ""
    name = {"x_p": "x_p", "x_g": "x_p", "y_p": "y_p", "y_g": "y_p"}.get(check.worst("exact").quantity, "dte")
    parts = found["cause"].values.tolist().index("all")  # what stands below is no part of it
    alone = found["alone"].sel(quantity=name)[:parts]
    if alone.isnull().all():  # it does not move without effects
        alone = found["alone"].sel(quantity="dte")[:parts]
    cause = str(alone.idxmax("cause").item())
    words = f"Most of it comes from one effect: {CAUSES[cause]}, alone {share(float(alone.max()))}."
    g = check.pair.geometry
    turn = float(np.ptp(check.multibody["exact"]["theta_p"].to_numpy())) * g.base_radius_pinion / g.base_pitch
    if cause == "contact" and turn > _TURNS:
        words += f" Friction turns the free shafts to and fro by {percent(turn)} of a base pitch; {_INERTIA}"
    return words


def share(ratio: float) -> str:
    """A ratio in percent, one above 1 as a multiple."""
    return percent(ratio) if ratio <= 1.0 else f"{number(ratio, 2)} times"


def percent(ratio: float) -> str:
    """A ratio in percent, two digits."""
    return quantity(100 * ratio, "%", 2)
