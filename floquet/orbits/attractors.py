"""Motions to which runs settle at speeds of a grid, and those that do not repeat followed over the speed.

Sources: docs/theory/orbits.md, "Motions that do not repeat".
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from floquet.orbits.branch import Family, Limits
from floquet.orbits.deadline import ENDLESS, Deadline
from floquet.orbits.long_run import LongRun, grown
from floquet.orbits.settling import Settled, alike, settle
from lumped.typing import BoolArray, FloatArray

#: Change of size from one speed of the grid to the next that one motion may make.
_FOLLOWS = 0.2
#: Steps between two speeds of the grid in which an end is looked for.
_STEPS = 32
#: Runs that follow a motion, whose starts differ by this part. Where two of them leave it, at a speed of the
#: grid within so many times the cycles of settling, it does not last.
_REPLICAS = 16
_MOVED = 1e-6
_LONG = 4
#: Motions that are told apart at one speed.
_MOST = 12
_NONE = np.zeros(3)


@dataclass(eq=False)
class Motion:
    """A motion to which runs at one speed have settled.

    Attributes
    ----------
    rate : 1/T [1/s]
    state, parameter : at phase 0, and the free parameter
    size : root mean square, smallest and largest value of the output, about
    next : way (+1, -1) -> what it becomes at the next speed of the grid that way; None: it grows
    starts : how many of the runs that started apart have come to it
    identified : what it is exactly, once that was looked at
    """

    rate: float
    state: FloatArray
    parameter: float
    size: FloatArray
    next: dict[int, Motion | None] = field(default_factory=dict)
    starts: int = 0
    identified: LongRun | None = None

    @property
    def run(self) -> LongRun:
        """The exact motion, or its exponent where the motion does not repeat."""
        assert self.identified is not None
        return self.identified

    def identify(self, run: LongRun) -> None:
        """Store the exact motion, and its size."""
        self.identified = run
        if run.run is not None:
            self.size = np.array([run.run.rms, run.run.least, run.run.most])


@dataclass(frozen=True, eq=False)
class AttractorEnd:
    """Where a motion that does not repeat ends.

    Attributes
    ----------
    rate, size : 1/T of the last one found [1/s], and what `Motion` has as its size
    behind : T of the next one looked at [s]
    after : what it becomes there
    """

    rate: float
    size: FloatArray
    behind: float
    after: LongRun


@dataclass(frozen=True, eq=False)
class Attractor:
    """A motion that does not repeat after the cycles looked for, over the speed.

    Attributes
    ----------
    rates : 1/T at which it was found, increasing [1/s]
    runs : what it is at each
    ends : at low and at high speed; None: it goes on to the end of the range
    """

    rates: FloatArray
    runs: tuple[LongRun, ...]
    ends: tuple[AttractorEnd | None, AttractorEnd | None]


class Survey:
    """Steady motions at each of k increasing speeds.

    A motion found at one speed is also followed to the next lower and higher speed. ``starts`` are the rate,
    state and parameter of each run; each rate is one of ``rates``. ``grown`` are the starts from which runs
    grow. ``report`` is called with the finished fraction. OutOfTimeError: the deadline has passed.
    """

    def __init__(
        self, family: Family, limits: Limits, rates: FloatArray,
        starts: list[tuple[float, FloatArray, float]],
        report: Callable[[float], object] = lambda done: None, deadline: Deadline = ENDLESS,
    ) -> None:  # fmt: skip
        self.family = family
        self.limits = limits
        self.rates = rates
        self.deadline = deadline
        self.levels: list[list[Motion]] = [[] for _ in rates]
        self.grown = list[Motion]()
        for j, rate in enumerate(rates):
            motions = [Motion(at, state, parameter, _NONE) for at, state, parameter in starts if at == rate]
            result, grows = self._settle(motions, np.full(len(motions), rate))
            for i, motion in enumerate(motions):
                if grows[i]:
                    self.grown.append(motion)
                else:
                    self._enter(j, result, i, motion.parameter).starts += 1
            report((j + 1) / rates.size)
        while sum(self._carry(j, way) for way in (1, -1) for j in range(rates.size)[::way]):
            pass

    def _settle(self, motions: list[Motion], rates: FloatArray) -> tuple[Settled, BoolArray]:
        """Settle from motions at speeds; the runs, and which of them grow."""
        self.deadline.check()
        result = settle(
            self.family, self.limits, np.array([motion.state for motion in motions]), 1.0 / rates,
            np.array([motion.parameter for motion in motions]),
        )  # fmt: skip
        return result, result.grown(self.limits.amplitude)

    def _enter(self, j: int, result: Settled, i: int, parameter: float) -> Motion:
        """The motion at speed j that is like run i.

        Without such a motion: a new one, or the motion nearest in size where the level is full.
        """
        level = self.levels[j]
        size = result.sizes[i]
        like = [motion for motion in level if alike(motion.size, size)]
        if like or len(level) >= _MOST:
            return min(like or level, key=lambda motion: abs(float(motion.size[0] - size[0])))
        level.append(Motion(float(self.rates[j]), result.states[i], parameter, size))
        return level[-1]

    def _carry(self, j: int, way: int) -> bool:
        """Let motions at speed j run on at the next speed; return whether there was one that had not yet."""
        waiting = [motion for motion in self.levels[j] if way not in motion.next]
        if not waiting or not 0 <= j + way < self.rates.size:
            return False
        result, grows = self._settle(waiting, np.full(len(waiting), self.rates[j + way]))
        for i, motion in enumerate(waiting):
            motion.next[way] = None if grows[i] else self._enter(j + way, result, i, motion.parameter)
        return True

    def attractors(
        self, wanted: Callable[[LongRun], bool], identify: Callable[[Motion], LongRun]
    ) -> tuple[Attractor, ...]:
        """Follow what is ``wanted`` from speed to speed, all motions being identified, and find its ends."""
        self.wanted = wanted
        self.identify = identify
        left = [
            [motion for motion in level if wanted(motion.run) and self._lasts(motion)]
            for level in self.levels
        ]
        result = list[Attractor]()
        for j, level in enumerate(left):
            while level:
                chain = [level.pop(0)]
                ends = list[AttractorEnd | None]()
                for way in (-1, 1):
                    at = j
                    last = chain[0 if way < 0 else -1]
                    end = None
                    while 0 <= at + way < self.rates.size and end is None:
                        last, end = self._onward(last, way, at + way, left[at + way])
                        at += way
                        if end is None:
                            chain.insert(0 if way < 0 else len(chain), last)
                    ends.append(end)
                rates = np.array([motion.rate for motion in chain])
                result.append(Attractor(rates, tuple(motion.run for motion in chain), (ends[0], ends[1])))
        return tuple(result)

    def _onward(
        self, last: Motion, way: int, to: int, level: list[Motion]
    ) -> tuple[Motion, AttractorEnd | None]:
        """The motion at the next speed to which the last motion leads, removed from the level of that speed.

        Where the last motion ends before the next speed: the place of this end as well.
        """
        for other in level:
            linked = last.next.get(way) is other or other.next.get(-way) is last
            if linked and alike(last.size, other.size, _FOLLOWS):
                level.remove(other)
                return other, None
        motion, end = self._walk(last, float(self.rates[to]))
        for other in level:
            if end is None and alike(motion.size, other.size, _FOLLOWS):
                level.remove(other)
                return other, None
        return motion, end

    def _walk(self, last: Motion, rate: float) -> tuple[Motion, AttractorEnd | None]:
        """Follow a motion in small steps to another speed; return the last motion, and its end or None."""
        good = last
        states = self._replicas(last)
        for step in last.rate * (rate / last.rate) ** (np.arange(1.0, _STEPS + 1.0) / _STEPS):
            result, left = self._left(states, float(step), good)
            if np.count_nonzero(left) > 1:
                i = int(np.flatnonzero(left)[0])
                gone = Motion(float(step), result.states[i], good.parameter, result.sizes[i])
                after = self.identify(gone) if np.isfinite(gone.size).all() else grown(good.parameter)
                return good, AttractorEnd(good.rate, good.size, 1.0 / float(step), after)
            stay = np.flatnonzero(~left)
            states = result.states[np.where(left, stay[0], np.arange(_REPLICAS))]
            good = Motion(float(step), states[0], good.parameter, result.sizes[stay].mean(axis=0))
        size = good.size
        good.identify(self.identify(good))
        if self.wanted(good.run) and alike(size, good.size, _FOLLOWS):
            return good, None
        return good, AttractorEnd(good.rate, size, 1.0 / good.rate, good.run)

    def _lasts(self, motion: Motion) -> bool:
        """Whether runs stay on a motion. Runs leave some chaos soon, on their way to another motion."""
        states = self._replicas(motion)
        count = 0
        for _ in range(_LONG):
            result, left = self._left(states, motion.rate, motion)
            states = result.states[~left]
            count = count + int(np.count_nonzero(left))
            if count > 1:
                return False
        return True

    def _left(self, states: FloatArray, rate: float, motion: Motion) -> tuple[Settled, BoolArray]:
        """Settled runs at a speed, and which runs are no longer like a motion."""
        result, grows = self._settle(
            [Motion(rate, state, motion.parameter, motion.size) for state in states],
            np.full(len(states), rate),
        )
        apart = [not alike(motion.size, size, _FOLLOWS) for size in result.sizes]
        return result, grows | np.array(apart)

    @staticmethod
    def _replicas(motion: Motion) -> FloatArray:
        """(R, 2m) the state, slightly moved: chaos takes them apart."""
        return np.asarray(motion.state * (1.0 + _MOVED * np.arange(_REPLICAS))[:, None])
