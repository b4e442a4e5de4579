"""Friction between two speeds: a sum of fitted functions with factors, and how far mu is from this sum.

`floquet.gear.axes.friction_families` compares laws at single speeds. Proofs over intervals of speed need a
bound at all speeds of an interval. Sources: docs/theory/proven_bounds.md, "The nearest unstable speed".
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache, cached_property
from typing import NamedTuple

import numpy as np

from floquet.gear.axes import GearVariation, LawOverSpeed, depends_on_speed, operating_rpm
from lumped.friction.base import FIT_TOLERANCE, FrictionLaw
from lumped.path_function import PathFunction
from lumped.path_of_contact.friction import fit_law
from lumped.typing import BoolArray, FloatArray

#: Ratios of neighbouring speeds between which one reference serves; narrow where the bound is large.
_WIDE = 1.5
_MIDDLE = 1.1
_NARROW = 1.01
#: Largest deviations between wide speeds, over the mean of |mu| times the path; the fits cause some 1e-8.
_LARGEST_DEVIATION = 1e-7
_LARGEST_MIDDLE_DEVIATION = 1e-5
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


class Speeds(NamedTuple):
    """An interval of speeds [rpm]."""

    low: float
    high: float


def _one_factor(speeds: FloatArray) -> FloatArray:
    return np.ones((speeds.size, 1))


class FrictionBetweenSpeeds:
    """The friction law of a variation between any two speeds; its deviations are PROVEN bounds.

    Parameters
    ----------
    variation : its operating speed is the reference wherever mu is a function with a factor
    """

    def __init__(self, variation: GearVariation) -> None:
        pair = variation.pair
        self.reference = operating_rpm(pair)
        self.constant = not depends_on_speed(pair)
        self.none = pair.friction.law == "none"
        if not self.constant:
            self.law = LawOverSpeed.of(variation)
            self.length = self.law.ends[1] - self.law.ends[0]
        # An instance serves one search: its results are kept as long.
        self.line_of_the_mean = cache(self._line_of_the_mean)
        self.shifted = cache(self._shifted)
        self.bounded_change = cache(self._bounded_change)

    @property
    def widest(self) -> float:
        """Largest width of an interval over its lower speed."""
        return 1.0 if self.constant or self._in_force(self.reference) is not None else _NARROW - 1.0

    def _in_force(self, rpm: float) -> FrictionLaw | None:
        return self.law.in_force(rpm)

    def patch(self, low: float, high: float) -> SpeedPatch | None:
        """Friction from a speed to another speed [rpm]; None: no bound is known."""
        if self.constant:
            return SpeedPatch(self.reference, None, _one_factor, 0.0)
        law = self._in_force(self.reference)
        # The film grows with speed everywhere, so that a law in force at both ends is in force in between.
        if law is None or any(self._in_force(rpm) is not law for rpm in (low, high)):
            return self.bounded_change(self._around(low, high, _NARROW))
        if self.law.mean_is_of_law_two(self.reference):
            return self._nearly_exact(self.line_of_the_mean, law, low, high)
        if law.factor is not None:
            return SpeedPatch(self.reference, None, self._power(law), 0.0)
        if law.shift is None:
            return self.bounded_change(self._around(low, high, _NARROW))
        return self._nearly_exact(self.shifted, law, low, high)

    def bounds(self, low: float, high: float) -> SpeedPatch | None:
        """Friction with factors that lie between the factors at both ends; None: no bound is known."""
        if self.constant:
            return self.patch(low, high)
        law = self._in_force(self.reference)
        if law is None or any(self._in_force(rpm) is not law for rpm in (low, high)):
            return None
        if self.law.mean_is_of_law_two(self.reference):  # which falls with speed
            deviation = law.average_slope * _FIT_ERRORS * self.length
            return SpeedPatch(self.reference, None, self._power(law), deviation)
        if law.shift is not None:
            return self._shifted(law, Speeds(low, high))
        return self.patch(low, high) if law.factor is not None else None

    def _around(self, low: float, high: float, ratio: float) -> Speeds:
        """The shortest interval of powers of a ratio times the reference around two speeds."""
        first, last = (math.log(rpm / self.reference) / math.log(ratio) for rpm in (low, high))
        start = math.floor(first)
        end = max(math.ceil(last), start + 1)
        return Speeds(min(self.reference * ratio**start, low), max(self.reference * ratio**end, high))

    def _nearly_exact(
        self, between: Callable[[FrictionLaw, Speeds], SpeedPatch], law: FrictionLaw, low: float, high: float
    ) -> SpeedPatch:
        """Friction between the widest speeds of a small deviation."""
        for ratio, largest in ((_WIDE, _LARGEST_DEVIATION), (_MIDDLE, _LARGEST_MIDDLE_DEVIATION)):
            patch = between(law, self._around(low, high, ratio))
            if patch.deviation <= largest * self.mean * self.length:
                return patch
        return between(law, self._around(low, high, _NARROW))

    @cached_property
    def mean(self) -> float:
        """Mean of |mu| at the operating speed."""
        return self.law.mean(self.reference)

    def _factor(self, law: FrictionLaw, rpm: float) -> float:
        assert law.factor is not None
        unit = law.factor(self.law.at(self.reference), self.law.settings)
        return law.factor(self.law.at(rpm), self.law.settings) / unit if unit else 1.0

    def _power(self, law: FrictionLaw) -> Callable[[FloatArray], FloatArray]:
        return lambda speeds: np.array([[self._factor(law, float(rpm))] for rpm in speeds])

    def _line_of_the_mean(self, law: FrictionLaw, speeds: Speeds) -> SpeedPatch:
        """Laws I and IV: mu is proportional to the mean of law II, nearly a line over log speed.

        The slope of this mean is the slope of law II times the share of the path on which law II is not
        clipped. This share has bounds, because the zero part of the path grows with speed and the part at the
        upper bound does not. So the mean deviates from the line through both ends by half the difference of
        the slopes times the length of the interval at most.
        """
        ends = [self._factor(law, rpm) for rpm in speeds]
        slope = (ends[1] - ends[0]) / math.log(speeds.high / speeds.low)

        def factors(rpm: FloatArray) -> FloatArray:
            return np.asarray(ends[0] + slope * np.log(rpm / speeds.low)[:, None])

        law_two = self.law.law_two()
        at_low, at_high = (clipped_lengths(law_two, rpm) for rpm in speeds)
        share = (at_low.upper + max(at_high.zero - at_low.zero, 0.0)) / (law_two.ends[1] - law_two.ends[0])
        of_mean = 0.5 * abs(_rise(law_two, *speeds)) * share + _FIT_ERRORS
        return SpeedPatch(self.reference, None, factors, law.average_slope * of_mean * self.length)

    def _shifted(self, law: FrictionLaw, speeds: Speeds) -> SpeedPatch:
        """Law II: |mu| rises as a whole, but where it is clipped at a speed or at the reference speed.

        There |mu| rises by less. The reference is in the middle of the interval.
        """
        reference = math.sqrt(speeds.low * speeds.high)
        shifting = LawOverSpeed(self.law.path, self.law.ends, self.law.settings, law, to_mean=False)
        level = shifting.mean(reference)

        each = _rise(shifting, *speeds) / math.log(speeds.high / speeds.low)

        def factors(rpm: FloatArray) -> FloatArray:
            rises = each * np.log(rpm / reference)
            return shifting.factors(reference, True, np.stack([np.ones_like(rises), rises], axis=1))

        rise = max(abs(_rise(shifting, reference, rpm)) for rpm in speeds)
        clipped = clipped_lengths(shifting, speeds.low).upper + clipped_lengths(shifting, speeds.high).zero
        return SpeedPatch(reference, level, factors, rise * clipped + _FIT_ERRORS * self.length)

    def _bounded_change(self, speeds: Speeds) -> SpeedPatch | None:
        """Law V where several laws are in force: mu at the middle speed, and how far mu is from it.

        Where one law is in force at both ends, mu changes by what speed changes this law. Where another law
        comes into force in between, mu changes by the largest |mu| of both laws at most.
        """
        if self.law.law.parts is None:
            return None
        reference = math.sqrt(speeds.low * speeds.high)
        low, high = self.law.ends
        breaks = {low, self.law.path.L_XP, high}
        for rpm in (*speeds, reference):
            _, switches = self.law.values(rpm)
            breaks.update(xi for xi in switches if low < xi < high)
        xi = np.array(sorted(breaks))
        at_low, at_middle, at_high = (
            _sizes(fit_law(*self.law.where_friction_acts(rpm), self.law.law.name), xi)
            for rpm in (speeds.low, reference, speeds.high)
        )
        middle = 0.5 * (xi[1:] + xi[:-1])
        change = np.zeros(middle.size)
        parts = zip(self._parts(middle, speeds.low), self._parts(middle, speeds.high), strict=True)
        for (law, inside_low), (_, inside_high) in parts:
            near = self._change(law, speeds.low, reference), self._change(law, speeds.high, reference)
            by_law = np.maximum(near[0].of(at_middle), near[1].of(at_middle))
            change = np.where(inside_low & inside_high, by_law, change)
            # |mu| of a law falls with speed: of the law at the high speed it is largest at the low speed.
            at_low_speed = at_high + self._change(law, speeds.low, speeds.high).of(at_high)
            change = np.where(inside_high & ~inside_low, np.maximum(at_low, at_low_speed), change)
        total = float((change * np.diff(xi)).sum()) * (1.0 + 1e-6)
        return SpeedPatch(reference, None, _one_factor, total + _FIT_ERRORS * self.length)

    def _parts(self, xi: FloatArray, rpm: float) -> list[tuple[FrictionLaw, BoolArray]]:
        assert self.law.law.parts is not None
        return self.law.law.parts(xi, *self.law.where_friction_acts(rpm))

    def _change(self, law: FrictionLaw, rpm: float, reference: float) -> Change:
        """Bound on the change of |mu| of one law from a reference speed to a speed and in between."""
        path, settings = self.law.where_friction_acts(rpm)
        reference_path, _ = self.law.where_friction_acts(reference)
        if law.shift is not None:
            return Change(0.0, abs(law.shift(path, settings) - law.shift(reference_path, settings)))
        if law.factor is None:
            return Change(math.inf, 0.0)
        unit = law.factor(reference_path, settings)
        return Change(abs(law.factor(path, settings) / unit - 1.0) if unit else 0.0, 0.0)


class Change(NamedTuple):
    """Bound on the change of |mu|: a share of |mu|, and a number."""

    share: float
    shift: float

    def of(self, mu: FloatArray) -> FloatArray:
        """The bound where |mu| is at most so much."""
        return self.share * mu + self.shift


def _sizes(fit: PathFunction, xi: FloatArray) -> FloatArray:
    """Bounds on |mu| of a fit between positions (k+1,), by the moduli of the terms of its pieces."""
    powers = np.arange(len(fit.coefficients))[::-1, None]
    of_piece = (np.abs(fit.coefficients) * np.diff(fit.breaks) ** powers).sum(axis=0)
    first = np.clip(np.searchsorted(fit.breaks, xi[:-1], side="right") - 1, 0, of_piece.size - 1)
    last = np.clip(np.searchsorted(fit.breaks, xi[1:], side="left") - 1, 0, of_piece.size - 1)
    return np.array([of_piece[a : max(a, b) + 1].max() for a, b in zip(first, last, strict=True)])


def _rise(law_two: LawOverSpeed, low: float, high: float) -> float:
    """By how much |mu| of law II rises from a speed to another speed where it is not clipped."""
    shift = law_two.law.shift
    assert shift is not None
    return shift(law_two.at(high), law_two.settings) - shift(law_two.at(low), law_two.settings)


def clipped_lengths(law_two: LawOverSpeed, rpm: float) -> ClippedLengths:
    """Where law II is at its bounds at a speed, between its switches and the pitch point."""
    low, high = law_two.ends
    _, switches = law_two.values(rpm)
    breaks = np.array([low, *sorted(xi for xi in switches if low < xi < high), high])
    width = np.diff(breaks)
    positions = breaks[:-1, None] + width[:, None] * np.array([0.3, 0.7])
    mu = np.abs(law_two.law.signed(positions, *law_two.where_friction_acts(rpm)))
    zero = (mu == 0.0).all(axis=1)
    upper = ~zero & (np.abs(np.diff(mu, axis=1)[:, 0]) <= _EQUAL * mu[:, 0])
    return ClippedLengths(float(width[upper].sum()), float(width[zero].sum()))
