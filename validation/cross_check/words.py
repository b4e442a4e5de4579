"""What several chapters and commands say about the cross-check of both models."""

from __future__ import annotations

import numpy as np

import multibody
from lumped import NumericalError
from multibody.run.effects import CAUSES
from validation.cross_check.agreement import agreement
from validation.cross_check.comparison import CrossCheck
from validation.cross_check.motions import repeated
from validation.cross_check.verdict import Judgement, limit_of
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
#: Name of the power lost, beside these.
LOSS = "power lost"

#: What differences from the exact model are measured by, for readers.
MEASURES = (
    "A difference is measured by the peak to peak of the lumped motion. Displacements along the line of "
    "action are measured by that of the transmission error, the load by the force that bends the teeth by "
    "it, and the mean off the line of action by the deflection under the friction force, where these are "
    "larger."
)
#: Smallest swing of the rotation, over the base pitch, that the text names where teeth differ.
_TURNS = 0.01
#: Effect of the exact model -> the effect in words, and what to do. Beside both only the place of contact is
#: left.
_SWITCHED = {
    "rotation_phase": (
        "the free shafts turn to and fro by {turn} of a base pitch, and the contact moves with them",
        " Motor and brake hold a real machine steadier: add their inertia to those of pinion and gear.",
    ),
    "sliding_velocity": (CAUSES["sliding_velocity"], ""),
}
_CONTACT = (
    "The lumped motion has the places of contact of the mean load; in the exact contact they follow the "
    "momentary load and the centres."
)


def failed_checks(check: CrossCheck, most: int = 3) -> str:
    """The first checks that fail, with value and limit."""
    failed = check.failures
    first = [_failed(j) for j in failed[:most]]
    more = [f"and {len(failed) - most} more"] if len(failed) > most else []
    return "; ".join(first + more)


def _failed(judgement: Judgement) -> str:
    """A failed check in words."""
    check = judgement.check.removeprefix("variant: ")
    kind, _, name = check.partition(": ")
    if kind != "same equations":
        return f"{judgement.check} {number(judgement.value, 2)}, limit {number(judgement.limit, 2)}"
    variant = " of its asymmetric variant" if check != judgement.check else ""
    value = percent(judgement.value)
    limit = percent(judgement.limit)
    return f"{NAMES[name]}{variant} {value} off with the same equations, limit {limit}"


def same_equations(check: CrossCheck) -> str:
    """How well the multibody model agrees when it holds the equations of the lumped model."""
    worst = check.worst("linear")
    verb = "agrees" if worst.within else "does not agree"
    return (
        f"With the same equations the multibody model {verb}: {NAMES[worst.quantity]} to "
        f"{number(worst.difference, 2)} of its peak to peak, limit {number(worst.limit, 2)}."
    )


def loss_difference(check: CrossCheck) -> str:
    """Lost power of the multibody model beside the lumped model. Empty: the loss is not known."""
    loss = check.loss
    if loss is None:
        return ""
    lost, lost_multibody = (quantity(value, "W", 3) for value in (loss.total, loss.total_multibody))
    place = "by sliding " if set(loss.lumped) == {"sliding"} else ""
    verb = "agrees" if loss.within else "does not agree"
    return (
        f"It loses {lost_multibody} {place}beside {lost}, which {verb}: {share(loss.difference)}, limit "
        f"{percent(loss.limit)}."
    )


def whole_difference(check: CrossCheck) -> str:
    """Difference of the exact model: transmission error, and quantity with the largest share of a limit."""
    dte = next(a for a in check.of("exact") if a.quantity == "dte")
    worst = check.worst("exact")
    lumped = quantity(dte.peak_to_peak, dte.unit, 3)
    multibody = quantity(dte.peak_to_peak_multibody, dte.unit, 3)
    error = (
        f"The transmission error of the multibody model is {multibody} peak to peak beside {lumped}, and "
        f"differs by at most {share(dte.difference)} of that"
    )
    if worst.quantity == "dte":
        return f"{error}, limit {percent(dte.limit)}."
    name = NAMES[worst.quantity]
    limit = percent(worst.limit)
    lumped = quantity(worst.peak_to_peak, worst.unit, 3)
    multibody = quantity(worst.peak_to_peak_multibody, worst.unit, 3)
    return f"{error}; {name}, {multibody} beside {lumped}, by {share(worst.difference)}, limit {limit}."


def cause_of_difference(check: CrossCheck) -> str:
    """The effect behind most of the difference, for the quantity with the largest share of a limit.

    With unlike teeth: a swing of the free shafts, if the swing is large beside the base pitch; else empty.
    """
    g = check.pair.geometry
    turn = float(np.ptp(check.multibody["exact"]["theta_p"].to_numpy())) * g.base_radius_pinion / g.base_pitch
    if check.pair.healthy is not check.pair:
        more = _SWITCHED["rotation_phase"][1]
        swings = (
            f"Eccentric gears and torque ripples swing the free shafts by {percent(turn)} of a base pitch"
        )
        return f"{swings}, which the lumped contact follows to first order.{more}" if turn > _TURNS else ""
    worst = check.worst("exact")
    remaining = {effect: _without(check, worst.quantity, effect) for effect in _SWITCHED}
    effect = min(remaining, key=lambda name: remaining[name])
    if remaining[effect] > 0.5 * worst.difference:
        return f"No effect alone explains half of it. {_CONTACT}"
    words, more = _SWITCHED[effect]
    rest = f"Without it the {NAMES[worst.quantity]} differs by {share(remaining[effect])}.{more}"
    return f"Most of it comes from one effect: {words.format(turn=percent(turn))}. {rest}"


def _without(check: CrossCheck, quantity: str, effect: str) -> float:
    """The difference with one effect of the exact model switched off; infinite where no motion is found."""
    pair = check.pair
    orbit = check.orbit
    reference = check.lumped
    cycles = round(float(reference["time"][-1]) / pair.geometry.mesh_period)
    samples = (reference.sizes["time"] - 1) // cycles
    try:
        motion = multibody.steady_state(
            pair,
            samples_per_cycle=samples,
            initial=None if orbit is None else orbit.states[0],
            effects={effect: False} | ({} if orbit is None else {"clearance": True}),
            supports="springs",
        )
    except NumericalError:
        return np.inf
    last = reference.isel(time=slice(-samples - 1, None))
    limit = limit_of(quantity, "exact")
    return agreement(pair, quantity, "exact", repeated(motion, 1), last, limit).difference


def share(ratio: float) -> str:
    """A ratio in percent, one above 1 as a multiple."""
    return percent(ratio) if ratio <= 1.0 else f"{number(ratio, 2)} times"


def percent(ratio: float) -> str:
    """A ratio in percent, two digits."""
    return quantity(100 * ratio, "%", 2)
