"""The mesh frequency that the samples of another model show, beside the mesh frequency of the pair.

The mesh frequency is the frequency whose first orders carry most of the variation. The search is over a
factor on the frequency of the pair: near 1, and near the factors by which users mistake speeds and times.

Sources: docs/how_to/check_your_model.md, "Period".
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize_scalar

from lumped.schema.pair import GearPair
from lumped.typing import FloatArray, IntArray
from validation.check.curves import Channel, Curves

#: Largest difference between the mesh frequency of the samples and that of the pair without a word.
SAME = 0.005
#: Mesh orders by which the mesh frequency is found.
_FIRST = 6
#: Mistakes by which the speed is half or twice that of the pair.
HALF = "half of the speed, as by pi/60 for pi/30"
TWICE = "twice the speed, as by pi/15 for pi/30"
#: Trials in a wave of the last of these orders.
_TRIALS = 4.0
#: Mesh cycles of the first search; later searches take four times as many each.
_SHORT = 64.0
#: The orders must carry this share more at another frequency than at that of the pair.
_BETTER = 1e-3
#: Change over one mesh cycle, over the variance, of curves that repeat; and the least share of the change at
#: another frequency that is no better.
_REPEATS = 1e-4
_REPEATS_BETTER = 0.25
#: A mistaken speed or time must carry this share of the variation, and this many times as much as the pair's.
_MOST = 0.5
_TIMES = 4.0
#: The orders at half of the speed carry this many times as much as those at the speed of the pair: 2 to 13
#: times in nine of eleven pairs of all kinds at half of their speed, at most 1.02 times at their own speed.
_TIMES_HALF = 2.0
#: Share that is enough where the motion repeats at the mistaken frequency, and not at that of the pair: a
#: motion with many orders has half of its variation above the first ones.
_ENOUGH = 0.25
#: Change over a mesh cycle, over the variance, of curves that repeat there and not at the frequency of the
#: pair: at most the first number, and the second number times the change at the frequency of the pair.
_SMALL_CHANGE = 0.05
_SMALLER = 0.1
#: The first orders at the frequency of the pair carry little below this share of the variation.
_LITTLE = 0.5
#: A known factor is the one found where it is this near to it, and changes at most this many times as much.
_NEAR_KNOWN = 2e-3
_AS_WELL = 1.5
#: Another mesh frequency of a model is searched within this share.
_WIDE = 0.2
#: Another speed of a record is searched within this share of the stated speed.
_FAR = 0.05
#: Fewest mesh cycles that tell one frequency from another.
_FEWEST = 1.5


class Frequency(NamedTuple):
    """The mesh frequency of the samples.

    Attributes
    ----------
    factor : mesh frequency of the samples over that of the pair
    cause : what mistakes the frequency, a key of ``mistaken_factors``; empty: the frequency is that of the
        pair
    """

    factor: float
    cause: str


def mistaken_factors(pair: GearPair) -> dict[str, float]:
    """Return mistakes of speed or time, and the factor of each on the mesh frequency."""
    ratio = pair.gear.teeth / pair.pinion.teeth
    factors = {
        "the speed is that of the gear": ratio,
        "the pinion turns at the speed of the gear": 1.0 / ratio,
        "rpm were taken for rad/s": 30.0 / math.pi,
        "rad/s were taken for rpm": math.pi / 30.0,
        "turns per second were taken for rad/s": 1.0 / (2.0 * math.pi),
        "rad/s were taken for turns per second": 2.0 * math.pi,
        HALF: 0.5,
        TWICE: 2.0,
    } | factors_of_times(pair)
    return {cause: factor for cause, factor in factors.items() if abs(factor - 1.0) > SAME}


def factors_of_times(pair: GearPair) -> dict[str, float]:
    """Return mistakes of the time alone, the motion being at the speed of the pair, and their factors."""
    g = pair.geometry
    return {
        "times are in milliseconds": 1e-3,
        "times are in microseconds": 1e-6,
        "times are a thousandth of seconds": 1e3,
        "times are angles of the pinion in radians": 1.0 / g.omega_pinion,
        "times are angles of the pinion in degrees": math.pi / (180.0 * g.omega_pinion),
        "times are angles of the gear in radians": 1.0 / g.omega_gear,
        "times are turns of the pinion": 2.0 * math.pi / g.omega_pinion,
        "times are mesh cycles": g.mesh_period,
    }


def nominal_cycles(curves: Curves, pair: GearPair) -> FloatArray:
    """Return the mesh cycles (k,) of the samples at the mesh frequency of the pair, from 0 on."""
    cycles = curves.places
    if curves.abscissa == "time":
        cycles = curves.places / pair.geometry.mesh_period
    return np.asarray(cycles - cycles[0], dtype=np.float64)


def mesh_frequency(curves: Curves, pair: GearPair, *, mistakes: bool = True) -> Frequency:
    """Return the mesh frequency of the samples.

    Curves over mesh cycles, and curves too short to tell one frequency from another, have that of the pair.

    Parameters
    ----------
    curves : curves at one speed
    pair : the gear pair at this speed
    mistakes : whether the frequencies of ``mistaken_factors`` are searched too
    """
    carried = _Carried.of(curves, pair)
    if curves.abscissa != "time" or carried is None:
        return Frequency(1.0, "")
    trials = mistaken_factors(pair) if mistakes else {}
    near = carried.refined(1.0)
    at_pair = carried(near, carried.reach)
    best = Frequency(near, "")
    for cause, factor in trials.items():
        # The last of the first orders has at least two samples in a wave.
        if not _FEWEST <= carried.reach * factor <= carried.samples / (2.0 * _FIRST):
            continue
        trial = carried.refined(factor)
        most = carried(trial, carried.reach)
        # Multiples of the true frequency carry a part of the orders, fractions carry all of them.
        more = most > _MOST and most > _TIMES * max(at_pair, 1e-3)
        # A frequency with orders in common carries much of the motion too, but the motion does not repeat.
        # A subharmonic motion at the right speed repeats in two cycles, too, but keeps its mesh orders.
        enough = max(_ENOUGH, _TIMES_HALF * at_pair) if cause == HALF else _ENOUGH
        repeats = most > enough and carried.repeats(trial, best.factor)
        if (more or repeats) and not _is_multiple(trial, best):
            best, at_pair = Frequency(trial, cause), most / _TIMES
    if not best.cause and mistakes and at_pair < _LITTLE:
        return _elsewhere(carried, best, circular_over_base(pair))
    return best


def circular_over_base(pair: GearPair) -> tuple[float, float]:
    """Return cos(alpha) of operation and of the rack, factors on a mesh frequency by the circular pitch."""
    return math.cos(pair.geometry.operating_pressure_angle), math.cos(pair.basic_rack.pressure_angle)


def _elsewhere(carried: _Carried, best: Frequency, known: Sequence[float]) -> Frequency:
    """The mesh frequency within a fifth of that of the pair at which the curves repeat, else ``best``.

    A known factor that repeats about as well as the best one is taken.
    """
    length = min(_SHORT, carried.reach)
    rough, _ = carried.strongest(1.0, _WIDE, length)
    factor = carried.refined(rough)
    if factor == rough:  # few cycles
        factor = carried.best_repeat(rough)
    for one in (*known, *(1.0 / cosine for cosine in known)):
        about_as_well = carried.change(one) < _AS_WELL * carried.change(factor)
        if abs(factor / one - 1.0) < _NEAR_KNOWN and about_as_well:
            factor = one
    if carried(factor, carried.reach) > _MOST and carried.repeats(factor, best.factor):
        return Frequency(factor, "the speed or the sampling rate is another one")
    return best


def shown_speed(curves: Curves, pair: GearPair) -> float | None:
    """Return the speed that the samples show over that of the pair, where it differs by 0.5 to 5 %.

    None: the mesh orders of the pair's own speed carry more than a quarter of what any other speed carries.
    """
    carried = _Carried.of(curves, pair)
    if carried is None or curves.abscissa != "time":
        return None
    length = min(_SHORT, carried.reach)
    other, _ = carried.strongest(1.0, _FAR, length)
    near, _ = carried.strongest(1.0, SAME, length)
    most = carried(other, length)
    return other if most > _MOST and most > _TIMES * carried(near, length) else None


def _is_multiple(trial: float, best: Frequency) -> bool:
    """Whether a trial that is a fraction of the frequency of a mistake only repeats that mistake."""
    return bool(best.cause) and trial < best.factor


@dataclass(frozen=True, eq=False)
class _Carried:
    """Share of the variation that the first mesh orders carry, over a factor on the mesh frequency."""

    cycles: FloatArray
    values: FloatArray
    orders: IntArray

    @classmethod
    def of(cls, curves: Curves, pair: GearPair) -> _Carried | None:
        """Return the share for the channels that belong to no tooth pair. None: no channel varies."""
        values = [channel.values for channel in _of_whole_mesh(curves) if np.ptp(channel.values) > 0.0]
        if not values:
            return None
        cycles = nominal_cycles(curves, pair)
        trend = np.polynomial.polynomial.polyfit(cycles, np.stack(values).T, 1)
        flat = np.stack(values) - np.polynomial.polynomial.polyval(cycles, trend)
        return cls(cycles, flat, np.arange(1, _FIRST + 1))

    @property
    def reach(self) -> float:
        """Mesh cycles of the samples, at the frequency of the pair."""
        return float(self.cycles[-1])

    @property
    def samples(self) -> int:
        """Number of samples."""
        return int(self.cycles.size)

    def __call__(self, factor: float, length: float) -> float:
        """Return the mean share of all channels over the first ``length`` mesh cycles."""
        count = int(np.searchsorted(self.cycles, length, side="right"))
        part = self.values[:, :count] - self.values[:, :count].mean(axis=1, keepdims=True)
        power = np.maximum(np.sum(part**2, axis=1), 1e-300)
        first = np.exp(-2j * np.pi * factor * self.cycles[:count])
        power_of_orders = sum(np.abs(part @ first**m) ** 2 for m in self.orders)
        return float(np.mean(2.0 * power_of_orders / (count * power)))

    def refined(self, factor: float) -> float:
        """Return the factor near ``factor`` with the largest share, else ``factor`` itself."""
        reach = self.reach * factor
        if reach * SAME * _TRIALS < 0.5:
            return self._repeating(factor) if reach >= _FEWEST else factor
        best = factor
        width = SAME * factor
        length = min(_SHORT, reach)
        while True:
            best, width = self.strongest(best, width, length / factor)
            if length >= reach:
                break
            length = min(4.0 * length, reach)
        fine = minimize_scalar(
            lambda trial: -self(float(trial), self.reach), bounds=(best - width, best + width),
            method="bounded", options={"xatol": 1e-3 * width},
        )  # fmt: skip
        better = -float(fine.fun) > (1.0 + _BETTER) * self(factor, self.reach)
        return float(fine.x) if better else factor

    def _repeating(self, factor: float) -> float:
        """Return the factor near ``factor`` at which the curves repeat best; for curves of few mesh cycles.

        In few cycles the first orders also gain by a wrong frequency that takes a part of higher orders.
        """
        at_factor = self.change(factor)
        if at_factor < _REPEATS:
            return factor
        best = self.best_repeat(factor)
        return best if self.change(best) < _REPEATS_BETTER * at_factor else factor

    def best_repeat(self, factor: float) -> float:
        """Return the factor within 0.5 % of another one at which the curves repeat best."""
        ends = (factor * (1.0 - SAME), factor * (1.0 + SAME))
        fine = minimize_scalar(self.change, bounds=ends, method="bounded", options={"xatol": 1e-6 * factor})
        return float(fine.x)

    def change(self, factor: float) -> float:
        """Return the mean square of the change over one mesh cycle, over the variance.

        NaN where the curves are no longer than a mesh cycle: they neither repeat nor fail to.
        """
        first = self.cycles <= self.cycles[-1] - 1.0 / factor
        if not first.any():
            return math.nan
        later = self.cycles[first] + 1.0 / factor
        differences = [np.interp(later, self.cycles, row) - row[first] for row in self.values]
        power = np.maximum(np.mean(self.values**2, axis=1), 1e-300)
        return float(np.mean([np.mean(row**2) for row in differences] / power))

    def repeats(self, factor: float, other: float) -> bool:
        """Return whether the curves repeat at a factor, and do not at another one."""
        change = self.change(factor)
        return change < min(_SMALL_CHANGE, _SMALLER * self.change(other))

    def strongest(self, about: float, width: float, length: float) -> tuple[float, float]:
        """Return the factor with the largest share, within ``about`` +- ``width``; then the step."""
        step = 1.0 / (_TRIALS * float(self.orders[-1]) * length)
        trials = about + step * np.arange(-np.floor(width / step), np.floor(width / step) + 1)
        return float(trials[int(np.argmax([self(float(trial), length) for trial in trials]))]), step


def _of_whole_mesh(curves: Curves) -> Sequence[Channel]:
    """The channels that belong to no tooth pair."""
    return [channel for channel in curves.channels if channel.tooth_pair is None]
