"""What removes the jumps of a gear pair: values of a parameter beyond which no stable motion has a fold.

Sources: docs/theory/orbits.md, "Fold curves".
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

import numpy as np

from floquet.gear.axes import operating_rpm
from floquet.gear.jump_map import JUMP_AXES, checked_axis, pair_at
from floquet.gear.response import ResponseBranches, lost_stability, member
from floquet.gear.unilateral import unilateral_family
from floquet.orbits.branch import Continuation, Family, Limits
from floquet.orbits.folds import FoldContinuation
from floquet.orbits.orbit import Orbit
from floquet.orbits.response import Response, find_response
from lumped.arguments import real_array
from lumped.errors import NumericalError, refuse
from lumped.schema.pair import GearPair

#: Part of the range by which the value is passed before all branches are looked at again, doubled each time.
_BEYOND = 1e-3
_MOST_ROUNDS = 10
#: The range is left by steps and differences, the axis is not: least value over the lower end.
_LEAST = 1e-3


@dataclass(frozen=True)
class JumpRemoval:
    """The value of a parameter nearest to the pair's own at which no fold of a stable motion is left.

    Attributes
    ----------
    axis : name out of `JUMP_AXES`
    direction : "larger" or "smaller" values than the pair's own
    own : value of the pair, in the units of the axis
    limit : end of the range that was searched
    value : the value; NaN where folds are left up to the limit
    error : half the width of the interval that has folds at its one end and none at its other
    speed_rpm : where the last folds meet or leave the range of speeds [rpm]; NaN where there is none
    """

    axis: str
    direction: Literal["larger", "smaller"]
    own: float
    limit: float
    value: float
    error: float
    speed_rpm: float

    @property
    def found(self) -> bool:
        """Whether there is such a value within the range."""
        return bool(np.isfinite(self.value))


def jumps_removed_by(
    branches: ResponseBranches, axis: str, within: tuple[float, float] | None = None
) -> tuple[JumpRemoval, ...]:
    """Values of a parameter, on either side of the pair's own, beyond which stable motions have no folds.

    The curve of each fold over the parameter is followed until two folds meet (a cusp, or an island that
    shrinks to a point) or leave the range of speeds. Behind the last one all branches are followed again;
    folds that are found there are followed in their turn.

    Parameters
    ----------
    branches : motions of the pair over a range of speeds
    axis : name out of `JUMP_AXES`
    within : range to search, with the pair's own value; None: a quarter to four times it for torque, from
        it to four times it, at least 0.2, for damping, zero to three times it for tip relief

    Returns
    -------
    For larger values and for smaller ones, where the range goes there; empty where the pair has no folds.

    Raises
    ------
    ParameterError : unknown axis, a pair without tip relief, or a range without the pair's own value
    """
    checked_axis(branches.pair, axis)
    own = float(JUMP_AXES[axis].own(branches.pair))
    low, high = _range(axis, own, within)
    if not _folds(branches.response):
        return ()
    search = _Removal(branches, axis, low, high)
    ways: list[tuple[Literal["larger", "smaller"], float]] = [("larger", high), ("smaller", low)]
    return tuple(
        JumpRemoval(axis, way, own, limit, *search.beyond(own, limit)) for way, limit in ways if limit != own
    )


def _range(axis: str, own: float, within: tuple[float, float] | None) -> tuple[float, float]:
    if within is None:
        return {
            "torque": (0.25 * own, 4.0 * own),
            "damping_ratio": (own, min(1.0, max(0.2, 4.0 * own))),
            "tip_relief": (0.0, 3.0 * own),
        }[axis]
    request = np.atleast_1d(real_array("within", within))
    if request.size != 2 or not request[0] <= own <= request[1] or request[0] == request[1]:
        raise refuse("within", within, f"a range around the pair's own value, {own:g}", "Give (low, high).")
    JUMP_AXES[axis].check(axis, request)
    return float(request[0]), float(request[1])


def _folds(response: Response) -> list[tuple[int, Orbit]]:
    """Cycles and motion of the folds at which a stable motion ends."""
    ends = [(branch.n, b) for branch in response.branches for b, _ in lost_stability(branch)]
    return [(n, b.orbit) for n, b in ends if b.kind == "fold"]


class _Removal:
    """The search along one axis."""

    def __init__(self, branches: ResponseBranches, axis: str, low: float, high: float) -> None:
        self.branches, self.axis, self.low, self.high = branches, axis, low, high
        self.cycle = branches.pair.geometry.mesh_period * operating_rpm(branches.pair)
        self.periods = {branch.n for branch in branches.branches}
        self.limits = member(branches.pair, *branches.speeds_rpm).limits
        self.at = lru_cache(maxsize=32)(self._at)

    def varied(self, value: float) -> GearPair:
        """The pair at a value, or at the end of the axis next to it."""
        axis = JUMP_AXES[self.axis]
        inside = float(np.clip(value, max(axis.low, _LEAST * self.low), axis.high))
        return pair_at(self.branches.pair, self.axis, inside)

    def _at(self, value: float) -> tuple[Family, Limits]:
        there, here = self.varied(value), self.limits
        ratio = there.operating.pinion_torque / self.branches.pair.operating.pinion_torque
        sizes = replace(here, length=here.length * ratio, parameter=here.parameter * ratio)
        return unilateral_family(there, *self.branches.speeds_rpm), sizes

    def beyond(self, own: float, limit: float) -> tuple[float, float, float]:
        """Value, error and speed [rpm] on the way from the pair's own value to a limit."""
        sign, margin = float(np.sign(limit - own)), _BEYOND * (self.high - self.low)
        value, folds = own, _folds(self.branches.response)
        for _ in range(_MOST_ROUNDS):
            last, speed = max((self._end(*fold, value, sign) for fold in folds), key=lambda x: x[0] * sign)
            value = last + sign * margin
            if (limit - value) * sign <= 0.0:
                break
            here = member(self.varied(value), *self.branches.speeds_rpm)
            folds = _folds(find_response(here, periods=self.periods, seeds=0))
            if not folds:
                return value - 0.5 * sign * margin, 0.5 * margin, speed
            margin *= 2.0
        return float("nan"), float("nan"), float("nan")

    def _end(self, n: int, orbit: Orbit, value: float, sign: float) -> tuple[float, float]:
        """Where a fold ends: the value, and the speed [rpm]."""

        def along(at: float) -> Continuation:
            family, limits = self.at(at)
            return Continuation(family, n, limits)

        try:
            curve = FoldContinuation(along, self.low, self.high).follow(value, orbit, sign)
        except NumericalError:
            return value, self.cycle / orbit.period
        fold = max(curve.points, key=lambda point: point.value * sign)
        return fold.value, self.cycle / fold.orbit.period
