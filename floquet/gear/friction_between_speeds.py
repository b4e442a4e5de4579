"""Friction everywhere between two speeds: a sum of fitted functions with factors, and what mu deviates from it.

`floquet.gear.axes.friction_families` compares laws at single speeds. Proofs over intervals of speed need a bound
at all speeds of an interval. Sources: docs/theory/proven_bounds.md, "The nearest unstable speed".
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np

from floquet.gear.axes import GearVariation, LawOverSpeed, depends_on_speed, operating_rpm
from lumped.friction.base import FIT_TOLERANCE, FrictionLaw
from lumped.friction.registry import law_of
from lumped.typing import FloatArray

#: Ratio of neighbouring reference speeds where mu has no factors over speed.
_RATIO = 1.01
#: Largest deviation of law II from a sum of two functions, over the mean of |mu| times the path, before a
#: reference speed of its own serves.
_LARGEST_DEVIATION = 1e-4
#: Ratio of neighbouring speeds at which the mean of law II is computed, and the largest deviation of this mean
#: from lines in between, over the mean times the path; the fits of law II alone cause some 1e-8.
_ANCHORS = 1.5
_LARGEST_LINE_DEVIATION = 1e-7
_EQUAL = 1e-12  # values of mu that are the same, relative
#: Of the mean of law II at an end of an interval and at the reference speed, both computed from fits.
_FIT_ERRORS = 4.0 * FIT_TOLERANCE


class SpeedPatch(NamedTuple):
    """Friction at all speeds of an interval.

    Attributes
    ----------
    reference : speed of the fit [rpm]
    level : as in `FrictionFamily`
    factors : speeds (k,) [rpm] -> factors (k, 1 or 2) as in `FrictionFamily`
    deviation : bound, at every speed, on the integral over the path of |mu less the sum with factors| [m]
    """

    reference: float
    level: float | None
    factors: Callable[[FloatArray], FloatArray]
    deviation: float


class ClippedLengths(NamedTuple):
    """Lengths [m] of the path on which law II is at its upper bound, and on which it is 0."""

    upper: float
    zero: float


class FrictionBetweenSpeeds:
    """The friction law of a variation between any two speeds.

    Parameters
    ----------
    variation : its operating speed is the reference wherever mu is a sum of functions with factors
    """

    def __init__(self, variation: GearVariation) -> None:
        pair = variation.pair
        self.reference = operating_rpm(pair)
        self.constant = not depends_on_speed(pair)
        self.none = pair.friction.law == "none"
        if not self.constant:
            self.law = LawOverSpeed.of(variation)
            self.in_force = self.law.in_force(self.reference)
            self.length = self.law.ends[1] - self.law.ends[0]
        #: Largest width of an interval over its lower speed.
        self.widest = 1.0 if self.constant or self.in_force is not None else _RATIO - 1.0

    def patch(self, low: float, high: float) -> SpeedPatch | None:
        """Friction from a speed to another speed [rpm]; None: no bound is known."""
        if self.constant:
            return SpeedPatch(self.reference, None, lambda speeds: np.ones((speeds.size, 1)), 0.0)
        in_force = self.in_force
        # The film grows with speed everywhere, so that a law in force at both ends is in force in between.
        if in_force is None or any(self.law.in_force(rpm) is not in_force for rpm in (low, high)):
            return None
        if self.law.mean_is_of_law_two(self.reference):
            return self._by_the_mean(in_force, low, high)
        if in_force.factor is not None:
            return SpeedPatch(self.reference, None, self._power(in_force), 0.0)
        return None if in_force.shift is None else self._shifted(in_force, low, high)

    def bounds(self, low: float, high: float) -> SpeedPatch | None:
        """Friction with factors that lie between the factors at both ends; None: no bound is known."""
        patch = self.patch(low, high)
        if patch is None or self.constant or not self.law.mean_is_of_law_two(self.reference):
            return patch
        # The mean of law II falls with speed.
        return patch._replace(deviation=_FIT_ERRORS * self.length)

    def _factor(self, law: FrictionLaw, rpm: float) -> float:
        assert law.factor is not None
        unit = law.factor(self.law.at(self.reference), self.law.settings)
        return law.factor(self.law.at(rpm), self.law.settings) / unit if unit else 1.0

    def _power(self, law: FrictionLaw) -> Callable[[FloatArray], FloatArray]:
        return lambda speeds: np.array([[self._factor(law, float(rpm))] for rpm in speeds])

    def _by_the_mean(self, law: FrictionLaw, low: float, high: float) -> SpeedPatch:
        """Laws I and IV: between the anchors around an interval, if mu deviates little there; else in it."""
        first = math.floor(math.log(low / self.reference) / math.log(_ANCHORS))
        end = max(math.ceil(math.log(high / self.reference) / math.log(_ANCHORS)), first + 1)
        wide = self._line_of_the_mean(law, self.reference * _ANCHORS**first, self.reference * _ANCHORS**end)
        if wide.deviation <= _LARGEST_LINE_DEVIATION * self.law.mean(self.reference) * self.length:
            return wide
        return self._line_of_the_mean(law, low, high)

    @cache  # noqa: B019, an instance serves one search
    def _line_of_the_mean(self, law: FrictionLaw, low: float, high: float) -> SpeedPatch:
        """Laws I and IV: mu is proportional to the mean of law II, nearly a line over log speed.

        The slope of this mean is the slope of law II times the share of the path on which law II is not
        clipped. This share has bounds, because the zero part of the path grows with speed and the part at the
        upper bound does not. So the mean deviates from the line through both ends by half the difference of
        the slopes times the length of the interval at most.
        """
        ends = [self._factor(law, rpm) for rpm in (low, high)]
        width = math.log(high / low)
        slope = (ends[1] - ends[0]) / width if width else 0.0

        def factors(speeds: FloatArray) -> FloatArray:
            return np.asarray(ends[0] + slope * np.log(speeds / low)[:, None])

        law_two = self.law.law_two()
        at_low, at_high = (self.clipped(law_two, rpm) for rpm in (low, high))
        share = (at_low.upper + max(at_high.zero - at_low.zero, 0.0)) / (law_two.ends[1] - law_two.ends[0])
        rise = abs(self._rise(law_two, low, high))
        of_mean = 0.5 * rise * share + _FIT_ERRORS
        return SpeedPatch(self.reference, None, factors, law.average_slope * of_mean * self.length)

    @staticmethod
    def _rise(law_two: LawOverSpeed, low: float, high: float) -> float:
        """By how much |mu| of law II rises from a speed to another speed where it is not clipped."""
        shift = law_two.law.shift
        assert shift is not None
        return shift(law_two.at(high), law_two.settings) - shift(law_two.at(low), law_two.settings)

    def _shifted(self, law: FrictionLaw, low: float, high: float) -> SpeedPatch:
        """Law II: |mu| rises as a whole, but where it is clipped at the speed or at the reference speed.

        There |mu| rises by less. The reference is the operating speed, or else a speed near the interval.
        """
        patch = self._shifted_from(self.reference, law, low, high)
        if patch.deviation > _LARGEST_DEVIATION * self.law.mean(self.reference) * self.length:
            middle = math.sqrt(low * high)
            steps = round(math.log(middle / self.reference) / math.log(_RATIO))
            patch = self._shifted_from(self.reference * _RATIO**steps, law, low, high)
        return patch

    def _shifted_from(self, reference: float, law: FrictionLaw, low: float, high: float) -> SpeedPatch:
        at_reference = LawOverSpeed(
            self.law.path, self.law.ends, self.law.settings, law, to_mean=False
        )
        mean = at_reference.mean(reference)

        def factors(speeds: FloatArray) -> FloatArray:
            rises = np.array([self._rise(at_reference, reference, float(rpm)) for rpm in speeds])
            return at_reference.factors(reference, True, np.stack([np.ones_like(rises), rises], axis=1))

        rise = max(abs(self._rise(at_reference, reference, rpm)) for rpm in (low, high))
        upper = self.clipped(at_reference, min(low, reference)).upper
        zero = self.clipped(at_reference, max(high, reference)).zero
        deviation = rise * (upper + zero) + _FIT_ERRORS * self.length
        return SpeedPatch(reference, mean, factors, deviation)

    def clipped(self, law_two: LawOverSpeed, rpm: float) -> ClippedLengths:
        """Where law II is at its bounds at a speed, between its switches and the pitch point."""
        low, high = law_two.ends
        _, switches = law_two.values(rpm)
        breaks = np.array([low, *sorted(xi for xi in switches if low < xi < high), high])
        width = np.diff(breaks)
        share = np.array([0.3, 0.7])
        positions = breaks[:-1, None] + width[:, None] * share
        mu = np.abs(law_two.law.signed(positions, *law_two.where_friction_acts(rpm)))
        zero = (mu == 0.0).all(axis=1)
        upper = ~zero & (np.abs(np.diff(mu, axis=1)[:, 0]) <= _EQUAL * mu[:, 0])
        return ClippedLengths(float(width[upper].sum()), float(width[zero].sum()))
