"""The unstable speed nearest to the operating speed, and the speeds in between: proven, not sampled.

Sources: docs/theory/proven_bounds.md, "The nearest unstable speed".
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from floquet.gear.axes import GearVariation, checked_range, operating_rpm, speed_range
from floquet.gear.systems_between_speeds import SystemsBetweenSpeeds
from floquet.rank_one.period_search import Effort, PeriodVerdicts, no_verdicts, proven_periods
from lumped.errors import refuse
from lumped.model.periodic_system import Supports
from lumped.schema.files import AnyPair
from lumped.typing import FloatArray, IntArray

#: Some tenths of a second; see docs/verification/floquet.md.
_EFFORT = Effort(vibrations=1500.0, intervals=2000, patches=100)


@dataclass(frozen=True, eq=False)
class StabilityOverSpeed:
    """What is proven about the stability of the linear motion with like teeth about the operating speed.

    Attributes
    ----------
    operating_rpm : operating speed of the pinion [rpm]
    speed_rpm : range that was to be searched [rpm]
    low, high : (k,) ends of adjoining intervals [rpm], increasing, about the operating speed
    verdict : (k,) 1 stable, -1 unstable everywhere in the interval, 0 undecided
    """

    operating_rpm: float
    speed_rpm: tuple[float, float]
    low: FloatArray
    high: FloatArray
    verdict: IntArray

    @property
    def searched_rpm(self) -> tuple[float, float]:
        """Lowest and highest speed of the intervals [rpm]; both the operating speed: no interval is known.

        The search ends at the distance of the nearest unstable speed, or where its effort is spent.
        """
        if not self.low.size:
            return self.operating_rpm, self.operating_rpm
        return float(self.low[0]), float(self.high[-1])

    @property
    def unstable_rpm(self) -> float:
        """The nearest speed that is proven unstable [rpm]; NaN: none is known."""
        unstable = self.verdict < 0
        if not unstable.any():
            return math.nan
        nearest = np.clip(self.operating_rpm, self.low[unstable], self.high[unstable])
        return float(nearest[np.abs(nearest - self.operating_rpm).argmin()])

    @cached_property
    def stable_rpm(self) -> tuple[float, float]:
        """Ends [rpm] of the range about the operating speed in which no interval is unstable.

        All speeds of this range are proven stable, but for the intervals that are undecided. Both ends are
        the operating speed where the operating speed itself is not in an interval that is proven stable.
        """
        about = (self.low <= self.operating_rpm) & (self.operating_rpm <= self.high) & (self.verdict > 0)
        if not about.any():
            return self.operating_rpm, self.operating_rpm
        stable = np.flatnonzero(self.verdict > 0)
        barriers = np.flatnonzero(self.verdict < 0)
        place = int(about.argmax())
        first = int(barriers[barriers < place].max(initial=-1)) + 1
        end = int(barriers[barriers > place].min(initial=self.verdict.size))
        inside = stable[(stable >= first) & (stable < end)]
        return float(self.low[inside[0]]), float(self.high[inside[-1]])

    @property
    def widest_undecided(self) -> float:
        """Largest width of adjoining undecided intervals within ``stable_rpm`` [rpm]; 0: there are none.

        An unstable zone within ``stable_rpm`` is narrower: it has no speed in an interval that is proven
        stable.
        """
        first, last = self.stable_rpm
        widest = width = 0.0
        for low, high, verdict in zip(self.low, self.high, self.verdict, strict=True):
            inside = verdict == 0 and low >= first and high <= last
            width = width + float(high - low) if inside else 0.0
            widest = max(widest, width)
        return widest

    @property
    def complete(self) -> bool:
        """Whether the search ended at a speed that is proven unstable, or at both ends of its range."""
        slack = 1e-9 * self.speed_rpm[1]
        low, high = self.searched_rpm
        whole_range = low <= self.speed_rpm[0] + slack and high >= self.speed_rpm[1] - slack
        return whole_range or not math.isnan(self.unstable_rpm)


def nearest_unstable_speed(
    pair: AnyPair,
    speed_rpm: tuple[float, float] | None = None,
    *,
    supports: Supports | None = None,
) -> StabilityOverSpeed:
    """Search the unstable speed nearest to the operating speed, of the linear form with like teeth.

    Every interval of speed between the operating speed and the nearest unstable speed is proven stable, or
    stays undecided and is part of the result: no zone between the nodes of a grid is missed. The damping is
    that of the pair. Sources: docs/theory/proven_bounds.md, "The nearest unstable speed".

    Parameters
    ----------
    pair : the gear pair
    speed_rpm : slowest and fastest speed [rpm], with the operating speed in between; default
        ``operating.speed_range``, or to twice the operating speed
    supports : "springs", the pair's ``bearings``, or its "shafts" with the modes that count most; by default
        the shafts of a pair that has them

    Raises
    ------
    ParameterError : a range without the operating speed
    NumericalError : a monodromy matrix cannot be computed; the text says what to try

    Examples
    --------
    >>> import floquet
    >>> result = floquet.nearest_unstable_speed("nasa_28_28")
    >>> result.complete, result.unstable_rpm, result.widest_undecided
    (True, nan, 0.0)
    """
    variation = GearVariation.of(pair, supports)
    rpm = operating_rpm(variation.pair)
    low, high = checked_range("speed_rpm", speed_range(variation.pair) if speed_rpm is None else speed_rpm)
    if not low <= rpm <= high:
        allowed = f"a range with the operating speed, {rpm:g} rpm"
        raise refuse("speed_rpm", f"({low:g}, {high:g})", allowed, "Give a wider range.")
    systems = SystemsBetweenSpeeds(variation)
    turns = 60.0 / variation.pair.pinion.teeth  # period [s] times speed [rpm]
    verdicts = no_verdicts()
    # Motions that the mesh does not couple must die out: else no speed is stable but for the neutral ones.
    if systems.separate_fade:
        slow = systems.slow_period(turns / high, turns / low)
        verdicts = proven_periods(systems, (turns / high, turns / low), turns / rpm, slow, _EFFORT)
    return _over_speed(verdicts, turns, rpm, (low, high))


def _over_speed(
    verdicts: PeriodVerdicts, turns: float, rpm: float, speeds: tuple[float, float]
) -> StabilityOverSpeed:
    """Verdicts of intervals of speed, which increases where the period decreases."""
    low, high = turns / verdicts.high[::-1], turns / verdicts.low[::-1]
    return StabilityOverSpeed(rpm, speeds, low, high, verdicts.verdict[::-1])
