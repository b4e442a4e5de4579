"""What is wrong with curves that agree at every order: what the comparison leaves out says it.

Compared are the mesh orders of the last half of the curves, rotations without their drift. A transient
before, a drift, a motion at other frequencies and the scatter of samples are no part of the misfit, and no
step of a ladder finds them.

Sources: docs/how_to/check_your_model.md, "Explanations".
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from lumped.schema.bodies import bodies_of
from validation.check.curve_orders import drift, rate_of_drift, uniform_rate, white_noise
from validation.check.explanations.left_out import (
    BRAKE,
    CHANGES,
    EXPORT,
    FEW_DIGITS,
    INTEGRATION,
    NOT_SETTLED,
)
from validation.check.ladder import Explanation
from validation.check.misfit import ChannelMisfit
from validation.check.problem import Problem
from validation.check.samples import difference_at_no_order
from validation.files.formatting import percent

#: Scatter over the rms of the motion that is worth a word, over the limit of the misfit.
_SCATTERS = 2.0
#: A rotation drifts where it leaves its constant speed by this share of its vibration.
_DRIFTS = 0.1
#: A rotation whose speed is within this factor of the nominal speed has the uniform rotation in it.
_UNIFORM = 2.0
#: A change between the first block of cycles and the last one above this share is a transient.
TRANSIENT = 0.1
#: A motion at no mesh order that falls to this share from the first half to the last one decays.
_DECAYS = 0.7
#: A brake torque whose loss is this share of the loss at constant speed, or less, has no loss.
_NO_LOSS = 0.2


def drifting(problem: Problem) -> list[ChannelMisfit]:
    """Return the rotations that leave their constant speed, because the torques do not balance."""
    used = problem.settled.used
    return [
        row
        for row in problem.misfit.channels
        if row.channel.channel.kind.is_rotation
        and drift(problem.cycles[used], row.channel.channel.values[used]) > _DRIFTS * row.scale
    ]


def turning(problem: Problem) -> list[str]:
    """Return the names of the rotations that have the uniform rotation of their gear in them."""
    used = problem.settled.used
    names = []
    for row in problem.misfit.channels:
        channel = row.channel.channel
        if channel.kind.is_rotation:
            gear = problem.pair.pinion if channel.kind.variable == "theta_p" else problem.pair.gear
            rate = abs(uniform_rate(problem.cycles[used], channel.values[used])) * gear.teeth
            if 1.0 / _UNIFORM < rate / (2.0 * math.pi) < _UNIFORM:
                names.append(channel.name)
    return names


def without_means(problem: Problem) -> list[str]:
    """Return the names of the channels whose means were removed."""
    return [
        row.channel.channel.name
        for row in problem.misfit.channels
        if problem.means and row.channel.channel.kind.has_mean and not row.compares_mean
    ]


def of_agreeing(problem: Problem, limit: float) -> tuple[Explanation, ...]:
    """Return the explanation of what the comparison leaves out of curves that agree; none: nothing.

    One explanation: the first of a brake torque, a transient, few digits, errors of the integration and the
    form of the export. A     record of a rig has none of them.
    """
    if problem.curves.role != "model":
        return ()
    return tuple(_found(problem, limit))[:1]


def _found(problem: Problem, limit: float) -> Iterator[Explanation]:
    """All explanations of what the comparison leaves out."""
    yield from _brake(problem)
    rests = {
        row.channel.channel.name: difference_at_no_order(problem, row, typical=True)
        for row in problem.misfit.channels
    }
    # Jumps between samples are at orders above those that are compared: few samples, alike in every cycle.
    changes = problem.settled.change > CHANGES
    names = [name for name, rest in rests.items() if changes and rest > limit]
    decays = bool(names) and _fades(problem, names)
    transient = problem.settled.transient
    calms = problem.settled.change < _DECAYS * transient
    if decays or (calms and transient > max(TRANSIENT, limit)):
        size = max([rests[name] for name in names] if decays else [transient])
        yield Explanation(
            NOT_SETTLED.name,
            "not settled" if decays else "at the start",
            problem.misfit.value,
            "Compatible with a motion that has not settled where the curves begin: "
            f"{percent(size)} of it are free vibrations that decay",
        )
    yield from _few_digits(problem, limit)
    if names:
        yield Explanation(
            INTEGRATION.name,
            ", ".join(names),
            problem.misfit.value,
            f"Compatible with errors of an integration with coarse tolerances in {', '.join(names)}: the "
            f"motion at no mesh order is {percent(max(rests[name] for name in names))} of the motion, and "
            "does not decay",
        )
    if names := without_means(problem):
        yield Explanation(
            EXPORT.name,
            "without means",
            problem.misfit.value,
            f"Compatible with values without their means: {', '.join(names)}",
        )


def _fades(problem: Problem, names: list[str]) -> bool:
    """Whether the motion at no mesh order decays from the first half of the compared samples to the last."""
    shares = []
    for row in problem.misfit.channels:
        if row.channel.channel.name in names:
            first, last = (difference_at_no_order(problem, row, half, typical=True) for half in (0, 1))
            shares.append(last / max(first, 1e-300))
    return float(np.median(shares)) < _DECAYS


def _brake(problem: Problem) -> Iterator[Explanation]:
    """A brake torque that does not hold the mean speed: the drift of a rotation tells its value."""
    rows = drifting(problem)
    if not rows:
        return
    pair, used = problem.pair, problem.settled.used
    g, bodies = pair.geometry, bodies_of(pair)
    ratio = pair.gear.teeth / pair.pinion.teeth
    channel = rows[0].channel.channel
    curvature = rate_of_drift(problem.cycles[used], channel.values[used])
    acceleration = 2.0 * curvature / g.mesh_period**2 / (1.0 if channel.quantity.endswith("_g") else ratio)
    held = float(problem.motion.motion.attrs["brake_torque"])
    value = held - (bodies.inertia_gear + bodies.inertia_pinion * ratio**2) * acceleration
    without_loss = pair.operating.pinion_torque * ratio
    words = ""
    if abs(value - without_loss) < _NO_LOSS * abs(held - without_loss):
        words = ", the torque of the pinion times the ratio: the loss of friction is forgotten"
    yield Explanation(
        BRAKE.name,
        value,
        problem.misfit.value,
        f"Compatible with a brake torque of {value:.5g} N m{words}; {held:.5g} N m holds the mean speed",
    )


def _few_digits(problem: Problem, limit: float) -> Iterator[Explanation]:
    """Curves of a model that scatter: a model has no noise. The scatter is that of third differences."""
    shares = {}
    for row in problem.misfit.channels:
        channel = row.channel.channel
        size = row.channel.orders.size / math.sqrt(2.0)
        if channel.tooth_pair is None and size > 0.0:
            shares[channel.name] = white_noise(channel.values[problem.used(channel)]) / size
    names = [name for name, share in shares.items() if share > _SCATTERS * limit]
    if names:
        yield Explanation(
            FEW_DIGITS.name,
            ", ".join(names),
            problem.misfit.value,
            f"Compatible with few digits in {', '.join(names)}, as of angles in single precision: the "
            f"samples scatter by {percent(max(shares[name] for name in names))} of the motion",
        )
