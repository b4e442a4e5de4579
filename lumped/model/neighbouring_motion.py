"""The stable motion of a pair that is followed from a neighbouring torque or speed.

Stable motions may coexist with chaos or with a motion of many mesh cycles, and a run from the linear motion
comes to one of them. A motion at a neighbouring torque or speed is near a motion of the pair:
`followed_motion` finds it near the linear motion there, and follows it to the pair in steps that become
shorter where Broyden's method fails.

Sources: docs/theory/validity.md, "Prediction".
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace

import numpy as np

from lumped.errors import NumericalError, ParameterError, UnsettledError
from lumped.model.periodic_system import Supports
from lumped.model.revolution_motion import Origin, RevolutionMotion
from lumped.model.steady import UNSTABLE, periodic_solution
from lumped.model.unilateral_motion import Shooting, unilateral_motion
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray, Progress, unheard

#: Neighbours: torque and speed over those of the pair, the nearest first.
NEIGHBOURS = ((1.25, 1.0), (1.0, 0.95), (1.0, 1.05), (1.6, 1.0), (0.8, 1.0), (1.0, 0.9), (1.0, 1.1))
#: First and shortest step, as shares of the way from the neighbour to the pair.
_FIRST_STEP = 0.25
_SHORTEST_STEP = 1.0 / 64.0


def unilateral_or_followed_motion(
    pair: GearPair, samples: int, supports: Supports = "springs", progress: Progress = unheard
) -> RevolutionMotion:
    """Periodic motion with unilateral contact; where no run of like teeth settles, one of a neighbour.

    Arguments and errors as for `unilateral_motion`.
    """
    try:
        return unilateral_motion(pair, samples, supports, progress=progress)
    except UnsettledError:
        followed = followed_motion(pair, lambda of_pair: Shooting.of(of_pair, samples, supports))
        if followed is None:
            raise
        return followed


def followed_motion(pair: GearPair, search: Callable[[GearPair], Shooting]) -> RevolutionMotion | None:
    """Return a stable motion of like teeth that is followed from a neighbour, or None.

    Parameters
    ----------
    pair : a pair with like teeth
    search : the search for a motion of a pair, as `Shooting.of` with samples and supports
    """
    for torque, speed in NEIGHBOURS:
        with suppress(NumericalError, ParameterError):  # a neighbour may be out of range
            motion = _followed(pair, torque, speed, search)
            if motion is not None and motion.spectral_radius <= UNSTABLE:
                return replace(motion, origin=Origin.NEIGHBOUR)
    return None


def _followed(
    pair: GearPair, torque: float, speed: float, search: Callable[[GearPair], Shooting]
) -> RevolutionMotion | None:
    """Follow the motion near the linear one from a neighbour to the pair; None where it ends before.

    ``torque``, ``speed``: of the neighbour, over those of the pair.
    """

    def on_the_way(share: float) -> Shooting:
        """The search at a share of the way that is left: 1 at the neighbour, 0 at the pair."""
        return search(between(pair, torque**share, speed**share))

    unknowns = _near_linear(on_the_way(1.0))
    if unknowns is None:
        return None
    share, step = 1.0, _FIRST_STEP
    while share > 0.0:
        following = max(share - step, 0.0)
        shooting = on_the_way(following)
        try:
            closed = shooting.closed(unknowns, shooting.derivatives(unknowns))
        except NumericalError:
            step *= 0.5
            if step < _SHORTEST_STEP:
                return None
            continue
        unknowns, share = closed.unknowns, following
    return shooting.motion(closed)


def between(pair: GearPair, torque: float, speed: float) -> GearPair:
    """Return the pair at other torques and another speed, both over those of the pair."""
    if torque == speed == 1.0:
        return pair
    operating = pair.operating
    changes = {
        "operating.pinion_speed": f"{operating.pinion_speed * speed!r} rad/s",
        "operating.pinion_torque": f"{operating.pinion_torque * torque!r} N*m",
    }
    if operating.brake_torque != "balanced":
        changes["operating.brake_torque"] = f"{operating.brake_torque * torque!r} N*m"
    return pair.with_(changes)


def _near_linear(shooting: Shooting) -> FloatArray | None:
    """Unknowns of the motion near the linear one, stable or not; None where there is none."""
    shooting = shooting.with_fitted_laws()
    linear = periodic_solution(shooting.system, np.zeros(1), estimate_error=False)
    start = shooting.unknowns(linear.states[0], linear.pinion_torque, linear.brake_torque)
    closed, _ = shooting.near(start, linear)
    return None if closed is None else closed.unknowns
