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
from floquet.gear.gains import Intervals
from lumped.friction.base import FIT_TOLERANCE, FrictionLaw
from lumped.path_function import PathFunction
from lumped.path_of_contact.friction import fit_law
from lumped.typing import BoolArray, FloatArray, IntArray

#: Ratios of neighbouring speeds between which one reference serves; narrow where the bound is large.
_WIDE = 1.5
_MIDDLE = 1.1
_NARROW = 1.01
#: Largest deviations between wide speeds, over the mean of |mu| times the path; the fits cause some 1e-8.
_LARGEST_DEVIATION = 1e-7
_LARGEST_MIDDLE_DEVIATION = 1e-5
_AT_BOUND = 1e-8  # least relative change of mu on a part of the path where law II is not at a bound
_LITTLE_CLIPPED = 0.25  # largest share of the path
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
    acts : intervals of the path on which the level acts; None: everywhere
    """

    reference: float
    level: float | None
    factors: Callable[[FloatArray], FloatArray]
    deviation: float
    acts: Intervals | None = None


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
        self.power_of_speed = cache(self._power_of_speed)
        self.line_of_the_mean = cache(self._line_of_the_mean)
        self.shifted = cache(self._shifted)
        self.bounded_change = cache(self._bounded_change)

    @property
    def widest(self) -> float:
        """Largest width of an interval over its lower speed."""
        return 1.0 if self.constant or self._in_force(self.reference) is not None else _NARROW - 1.0

    def _in_force(self, rpm: float) -> FrictionLaw | None:
        return self.law.in_force(rpm)

    def one_law(self, low: float, high: float) -> bool:
        """Whether the law of the reference speed is in force everywhere on the path at all speeds between."""
        # The film grows with speed everywhere, so that a law in force at both ends is in force in between.
        law = self._in_force(self.reference)
        return law is not None and all(self._in_force(rpm) is law for rpm in (low, high))

    def patch(self, low: float, high: float, looseness: float = 1.0) -> SpeedPatch | None:
        """Friction from a speed to another speed [rpm]; None: no bound is known.

        With a ``looseness`` above 1 one patch serves wider intervals and deviates more.
        """
        if self.constant:
            return SpeedPatch(self.reference, None, _one_factor, 0.0)
        law = self._in_force(self.reference)
        if law is None or not self.one_law(low, high):
            return self.bounded_change(self._around(low, high, _NARROW))
        if self.law.mean_is_of_law_two(self.reference):
            return self._nearly_exact(self.line_of_the_mean, law, Speeds(low, high), looseness)
        if law.factor is not None:
            return self.power_of_speed(law)
        if law.shift is None:
            return self.bounded_change(self._around(low, high, _NARROW))
        return self._nearly_exact(self.shifted, law, Speeds(low, high), looseness)

    def bounds(self, low: float, high: float) -> SpeedPatch | None:
        """Friction with factors that lie between the factors at both ends; None: no bound is known."""
        if self.constant:
            return self.patch(low, high)
        law = self._in_force(self.reference)
        if law is None or not self.one_law(low, high):
            return None
        if self.law.mean_is_of_law_two(self.reference):  # which falls with speed
            deviation = law.change_by_average(self.law.path) * _FIT_ERRORS * self.length
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
        self,
        between: Callable[[FrictionLaw, Speeds], SpeedPatch],
        law: FrictionLaw,
        speeds: Speeds,
        looseness: float,
    ) -> SpeedPatch:
        """Friction between the widest speeds of a small deviation."""
        for ratio, largest in ((_WIDE, _LARGEST_DEVIATION), (_MIDDLE, _LARGEST_MIDDLE_DEVIATION)):
            patch = between(law, self._around(*speeds, ratio))
            if patch.deviation <= looseness * largest * self.mean * self.length:
                return patch
        return between(law, self._around(*speeds, _NARROW))

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

    def _power_of_speed(self, law: FrictionLaw) -> SpeedPatch:
        """Laws III and ISO/TR 14179-2: mu is the same function at all speeds, times a power of the speed."""
        return SpeedPatch(self.reference, None, self._power(law), 0.0)

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
        deviation = law.change_by_average(self.law.path) * of_mean * self.length
        return SpeedPatch(self.reference, None, factors, deviation)

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
        """Law V where several laws are in force: mu at the middle speed, a rise, and how far mu is from it.

        The rise is that of law II. It acts where at the middle speed law II or IV is in force and not at a
        bound: there mu rises as a whole, or nearly so. None: between two speeds some place of the path passes
        through three laws.
        """
        if self.law.law.parts is None:
            return None
        reference = math.sqrt(speeds.low * speeds.high)
        low, high = self.law.ends
        sections = {low, self.law.path.L_XP, high}
        breaks = set(sections)
        fits = []
        for rpm in (speeds.low, reference, speeds.high):
            _, switches = self.law.values(rpm)
            fits.append(fit_law(*self.law.where_friction_acts(rpm), self.law.law.name))
            breaks.update(float(xi) for xi in (*switches, *fits[-1].breaks) if low < xi < high)
            if rpm == reference:
                sections.update(float(xi) for xi in switches if low < xi < high)
        xi = np.array(sorted(breaks))
        at_low, at_middle, at_high = (
            self._at_speed(fit, xi, rpm)
            for fit, rpm in zip(fits, (speeds.low, reference, speeds.high), strict=True)
        )
        clipped = self._clipped_share(speeds)
        rising = self._rising(at_middle, xi, np.array(sorted(sections)), clipped)
        sides = [self._deviations(at_middle, at_end, rising, clipped) for at_end in (at_low, at_high)]
        total = max(float(of_side @ np.diff(xi)) for of_side in sides) * (1.0 + 1e-6)
        if not math.isfinite(total):
            return None
        level = float(at_middle.largest.mean())
        at_reference = self._law_two.rise(*self.law.where_friction_acts(reference))
        to_end = self._law_two.rise(*self.law.where_friction_acts(speeds.high)) - at_reference
        each = to_end / math.log(speeds.high / reference)

        def factors(rpm: FloatArray) -> FloatArray:
            rises = each * np.log(rpm / reference)
            return np.stack([np.ones_like(rises), 1.0 + rises / level], axis=1)

        acts = tuple((float(a), float(b)) for a, b in zip(xi[:-1][rising], xi[1:][rising], strict=True))
        return SpeedPatch(reference, level, factors, total + _FIT_ERRORS * self.length, _joined(acts))

    @cached_property
    def _law_two(self) -> FrictionLaw:
        """The part of law V that rises as a whole."""
        return next(law for law, _ in self._parts(np.empty(0), self.reference) if law.shift is not None)

    def _clipped_share(self, speeds: Speeds) -> float:
        """Bound on the share of the path on which law II is at its bounds at some speed of an interval."""
        law_two = self.law.law_two()
        at_low, at_high = (clipped_lengths(law_two, rpm) for rpm in speeds)
        return (at_low.upper + at_high.zero) / (law_two.ends[1] - law_two.ends[0])

    def _at_speed(self, fit: PathFunction, xi: FloatArray, rpm: float) -> FrictionAtSpeed:
        """Friction at a speed between positions (k+1,), all breaks of the fit among them."""
        middle = 0.5 * (xi[1:] + xi[:-1])
        masks = [inside for _, inside in self._parts(middle, rpm)]
        return FrictionAtSpeed(rpm, np.argmax(masks, axis=0), *_ranges(fit, xi))

    def _rising(
        self, reference: FrictionAtSpeed, xi: FloatArray, sections: FloatArray, clipped: float
    ) -> BoolArray:
        """Where the rise acts (k,): on whole sections between switches of mu at the reference speed.

        The mean of law II rises nearly as law II where little of the path is clipped.
        """
        laws = [law for law, _ in self._parts(np.empty(0), reference.rpm)]
        by_mean = clipped < _LITTLE_CLIPPED
        rising = np.array([law.shift is not None or (by_mean and self._follows_mean(law)) for law in laws])
        of_part = rising[reference.law] & reference.moves
        section = np.searchsorted(sections, 0.5 * (xi[1:] + xi[:-1])) - 1
        some = np.zeros(sections.size, dtype=bool)
        np.logical_or.at(some, section, of_part)
        return np.asarray(some[section] & rising[reference.law])

    def _follows_mean(self, law: FrictionLaw) -> bool:
        """Whether a law is a function of the position times the mean of law II."""
        return law.coefficient and self.law.settings.coefficient is None

    def _deviations(
        self, reference: FrictionAtSpeed, end: FrictionAtSpeed, rising: BoolArray, clipped: float
    ) -> FloatArray:
        """Bounds (k,) on what mu deviates from mu at the reference and the rise, at all speeds up to an end.

        Where one law is in force at both speeds, this law changes with speed. Elsewhere mu at a speed is that
        of the law of either speed: the difference of both laws, plus what speed changes the law of the end;
        or what speed changes the law of the reference. inf: three laws.
        """
        laws = [law for law, _ in self._parts(np.empty(0), reference.rpm)]
        changes = [self._change(law, end.rpm, reference.rpm) for law in laws]
        back = [self._change(law, reference.rpm, end.rpm) for law in laws]
        rise = next(c.shift for law, c in zip(laws, changes, strict=True) if law is self._law_two)
        moved = np.where(rising, rise, 0.0)
        exact = rising & reference.moves & (end.law == reference.law) & end.moves
        deviation = np.zeros(reference.law.size)
        difference = np.maximum(reference.largest - end.least, end.largest - reference.least)
        for number, law in enumerate(laws):
            # Both the law and the rise change mu in the same direction: the larger one, at most.
            by_law = np.maximum(changes[number].of(reference.largest), moved)
            if law is self._law_two:
                by_law = np.where(exact, 0.0, by_law)
            elif self._follows_mean(law):
                by_law = np.where(
                    rising, np.minimum(_by_mean(changes[number], rise, clipped, reference), by_law), by_law
                )
            # |mu| of one law falls with speed: without a rise it changes most up to the end.
            steady = (end.law == number) & ~rising
            by_law = np.where(steady, np.minimum(by_law, difference), by_law)
            deviation = np.where(reference.law == number, by_law, deviation)
        for number in range(len(laws)):
            of_end = (end.law == number) & (reference.law != number)
            from_end = difference + back[number].of(end.largest) + moved
            deviation = np.where(of_end, np.maximum(deviation, from_end), deviation)
        return np.where(np.abs(reference.law - end.law) > 1, np.inf, deviation)

    def _parts(self, xi: FloatArray, rpm: float) -> list[tuple[FrictionLaw, BoolArray]]:
        assert self.law.law.parts is not None
        return self.law.law.parts(xi, *self.law.where_friction_acts(rpm))

    def _change(self, law: FrictionLaw, rpm: float, reference: float) -> Change:
        """Bound on the change of |mu| of one law from a reference speed to a speed and in between."""
        path, settings = self.law.where_friction_acts(rpm)
        reference_path, _ = self.law.where_friction_acts(reference)
        if law.shift is not None:
            return Change(0.0, abs(law.rise(path, settings) - law.rise(reference_path, settings)))
        if law.factor is None:
            return Change(math.inf, 0.0)
        unit = law.factor(reference_path, settings)
        return Change(abs(law.factor(path, settings) / unit - 1.0) if unit else 0.0, 0.0)


class FrictionAtSpeed(NamedTuple):
    """Friction at a speed on k parts of the path.

    Attributes
    ----------
    rpm : speed [rpm]
    law : (k,) number of the law in force, in the order in which the film grows
    least, largest : (k,) bounds on |mu|
    """

    rpm: float
    law: IntArray
    least: FloatArray
    largest: FloatArray

    @property
    def moves(self) -> BoolArray:
        """Where mu changes along the path and is not 0, (k,): not at a bound of law II."""
        return np.asarray((self.least > 0.0) & (self.largest > (1.0 + _AT_BOUND) * self.least))


def _by_mean(change: Change, rise: float, clipped: float, reference: FrictionAtSpeed) -> FloatArray:
    """Bound (k,) on what a law that goes with the mean of law II deviates from a rise of the whole of it.

    The law is mu f, f - 1 = change of the mean over the mean. With m = rise/(f - 1) at the end, mu (f - 1) is
    off m (f - 1) by |mu - m| |f - 1|. The mean changes by what law II rises times the share of the path on
    which law II is not at a bound, so that m (f - 1) is off the rise by rise clipped/(1 - clipped) at most.
    """
    if not change.share > 0.0 or clipped >= 0.5:
        return np.full(reference.law.size, np.inf)
    m = rise / change.share
    distance = np.maximum(np.abs(reference.largest - m), np.abs(reference.least - m))
    return distance * change.share + rise * clipped / (1.0 - clipped)


def _joined(intervals: Intervals) -> Intervals:
    """Intervals that adjoin each other as one."""
    joined: list[tuple[float, float]] = []
    for low, high in intervals:
        if joined and joined[-1][1] == low:
            joined[-1] = joined[-1][0], high
        else:
            joined.append((low, high))
    return tuple(joined)


class Change(NamedTuple):
    """Bound on the change of |mu|: a share of |mu|, and a number."""

    share: float
    shift: float

    def of(self, mu: FloatArray) -> FloatArray:
        """The bound where |mu| is at most so much."""
        return self.share * mu + self.shift


def _ranges(fit: PathFunction, xi: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Bounds (k,) on |mu| of a fit between positions (k+1,) within its pieces: least and largest.

    By the powers about the middle of each part, which synthetic division gives.
    """
    middle = 0.5 * (xi[1:] + xi[:-1])
    half = 0.5 * np.diff(xi)
    piece = np.clip(np.searchsorted(fit.breaks, middle, side="right") - 1, 0, fit.breaks.size - 2)
    rows = fit.coefficients[:, piece].copy()  # highest power first
    place = middle - fit.breaks[piece]
    terms = np.abs(rows) * (np.abs(place) + half) ** np.arange(len(rows))[::-1, None]
    rounding = 1e-12 * terms.sum(axis=0)
    for last in range(len(rows), 0, -1):
        for k in range(1, last):
            rows[k] += place * rows[k - 1]
    spread = (np.abs(rows[:-1]) * half ** np.arange(len(rows))[:0:-1, None]).sum(axis=0) + rounding
    size = np.abs(rows[-1])
    return np.maximum(size - spread, 0.0), size + spread


def _rise(law_two: LawOverSpeed, low: float, high: float) -> float:
    """By how much |mu| of law II rises from a speed to another speed where it is not clipped."""
    at_low, at_high = (law_two.law.rise(law_two.at(rpm), law_two.settings) for rpm in (low, high))
    return at_high - at_low


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
