"""Motions to which runs settle at speeds of a grid. Motions that do not repeat are followed over the speed.

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

#: Largest relative change of the size of a motion from one speed of the grid to the next.
_FOLLOWS = 0.2
#: Steps of the speed between two speeds of the grid in the search for the end of a motion.
_STEPS = 32
#: Number of runs that follow a motion, and relative difference of their starts. A motion does not last where
#: two of the runs leave the motion at a speed of the grid within ``_LONG`` times the cycles of settling.
_REPLICAS = 16
_MOVED = 1e-6
_LONG = 4
#: Largest number of different motions at one speed.
_MOST = 12
_NONE = np.zeros(3)


@dataclass(eq=False)
class Motion:
    """A motion to which runs at one speed have settled.

    Attributes
    ----------
    rate : 1/T [1/s]
    state, parameter : state at phase 0, and the free parameter
    size : approximate root mean square, smallest and largest value of the output
    next : direction (+1, -1) of the speed -> motion at the next speed of the grid; None: the motion grows
    starts : number of runs from the starts of the survey that have settled to the motion
    identified : the exact motion; None: not yet computed
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
        """The exact motion, or the exponent of a motion that does not repeat."""
        assert self.identified is not None
        return self.identified

    def identify(self, run: LongRun) -> None:
        """Store the exact motion and the size of this motion."""
        self.identified = run
        if run.run is not None:
            self.size = np.array([run.run.rms, run.run.least, run.run.most])


@dataclass(frozen=True, eq=False)
class AttractorEnd:
    """End of a motion that does not repeat.

    Attributes
    ----------
    rate, size : 1/T [1/s] and `Motion.size` of the last motion before the end
    behind : T of the first run beyond the end [s]
    after : the motion at ``behind``
    """

    rate: float
    size: FloatArray
    behind: float
    after: LongRun


@dataclass(frozen=True, eq=False)
class Attractor:
    """A motion over the speed that does not repeat within the cycles of the search.

    Attributes
    ----------
    rates : increasing 1/T at which the motion was found [1/s]
    runs : the motion at each of the rates
    ends : end at low and end at high speed; None: the motion continues to the end of the range
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
            motions = [
                Motion(start_rate, state, parameter, _NONE)
                for start_rate, state, parameter in starts
                if start_rate == rate
            ]
            result, grows = self._settle(motions, np.full(len(motions), rate))
            for i, motion in enumerate(motions):
                if grows[i]:
                    self.grown.append(motion)
                else:
                    self._enter(j, result, i, motion.parameter).starts += 1
            report((j + 1) / rates.size)
        while sum(self._carry(j, step) for step in (1, -1) for j in range(rates.size)[::step]):
            pass

    def _settle(self, motions: list[Motion], rates: FloatArray) -> tuple[Settled, BoolArray]:
        """Let runs from motions settle at speeds. Returns the settled runs, and whether each run grows."""
        self.deadline.check()
        result = settle(
            self.family, self.limits, np.array([motion.state for motion in motions]), 1.0 / rates,
            np.array([motion.parameter for motion in motions]),
        )  # fmt: skip
        return result, result.grown(self.limits.amplitude)

    def _enter(self, j: int, result: Settled, i: int, parameter: float) -> Motion:
        """Return the motion at speed j that is like run i.

        No motion is like the run: a new motion is added. Where the level is full, the motion nearest in size
        is returned.
        """
        level = self.levels[j]
        size = result.sizes[i]
        like = [motion for motion in level if alike(motion.size, size)]
        if like or len(level) >= _MOST:
            return min(like or level, key=lambda motion: abs(float(motion.size[0] - size[0])))
        level.append(Motion(float(self.rates[j]), result.states[i], parameter, size))
        return level[-1]

    def _carry(self, j: int, step: int) -> bool:
        """Follow the motions at speed j to the speed j + step. Returns whether there was a new motion."""
        waiting = [motion for motion in self.levels[j] if step not in motion.next]
        if not waiting or not 0 <= j + step < self.rates.size:
            return False
        result, grows = self._settle(waiting, np.full(len(waiting), self.rates[j + step]))
        for i, motion in enumerate(waiting):
            motion.next[step] = None if grows[i] else self._enter(j + step, result, i, motion.parameter)
        return True

    def attractors(
        self, wanted: Callable[[LongRun], bool], identify: Callable[[Motion], LongRun]
    ) -> tuple[Attractor, ...]:
        """Follow the ``wanted`` motions from speed to speed, and find the ends of each of these motions.

        All motions of the survey must be identified before.
        """
        self.wanted = wanted
        self.identify = identify
        unlinked = [
            [motion for motion in level if wanted(motion.run) and self._lasts(motion)]
            for level in self.levels
        ]
        result = list[Attractor]()
        for j, level in enumerate(unlinked):
            while level:
                chain = [level.pop(0)]
                ends = list[AttractorEnd | None]()
                for step in (-1, 1):
                    k = j
                    last = chain[0 if step < 0 else -1]
                    end = None
                    while 0 <= k + step < self.rates.size and end is None:
                        k += step
                        last, end = self._onward(last, step, k, unlinked[k])
                        if end is None:
                            chain.insert(0 if step < 0 else len(chain), last)
                    ends.append(end)
                rates = np.array([motion.rate for motion in chain])
                result.append(Attractor(rates, tuple(motion.run for motion in chain), (ends[0], ends[1])))
        return tuple(result)

    def _onward(
        self, last: Motion, step: int, k: int, level: list[Motion]
    ) -> tuple[Motion, AttractorEnd | None]:
        """Follow the last motion by one step of the grid to the speed k.

        Returns the motion at the speed k, which is removed from the ``level`` of this speed, and None. Where
        the last motion ends before: the motion just before the end, and the end.
        """
        for other in level:
            linked = last.next.get(step) is other or other.next.get(-step) is last
            if linked and alike(last.size, other.size, _FOLLOWS):
                level.remove(other)
                return other, None
        motion, end = self._walk(last, float(self.rates[k]))
        for other in level:
            if end is None and alike(motion.size, other.size, _FOLLOWS):
                level.remove(other)
                return other, None
        return motion, end

    def _walk(self, last: Motion, rate: float) -> tuple[Motion, AttractorEnd | None]:
        """Follow a motion in small steps to another speed. Returns the last motion, and the end or None."""
        good = last
        states = self._replicas(last)
        for step in last.rate * (rate / last.rate) ** (np.arange(1.0, _STEPS + 1.0) / _STEPS):
            result, departed = self._settle_replicas(states, float(step), good)
            if np.count_nonzero(departed) > 1:
                i = int(np.flatnonzero(departed)[0])
                beyond = Motion(float(step), result.states[i], good.parameter, result.sizes[i])
                after = self.identify(beyond) if np.isfinite(beyond.size).all() else grown(good.parameter)
                return good, AttractorEnd(good.rate, good.size, 1.0 / float(step), after)
            staying = np.flatnonzero(~departed)
            states = result.states[np.where(departed, staying[0], np.arange(_REPLICAS))]
            good = Motion(float(step), states[0], good.parameter, result.sizes[staying].mean(axis=0))
        size = good.size
        good.identify(self.identify(good))
        if self.wanted(good.run) and alike(size, good.size, _FOLLOWS):
            return good, None
        return good, AttractorEnd(good.rate, size, 1.0 / good.rate, good.run)

    def _lasts(self, motion: Motion) -> bool:
        """Whether runs stay on a motion. Some chaos is transient: runs soon leave it for another motion."""
        states = self._replicas(motion)
        count = 0
        for _ in range(_LONG):
            result, departed = self._settle_replicas(states, motion.rate, motion)
            states = result.states[~departed]
            count = count + int(np.count_nonzero(departed))
            if count > 1:
                return False
        return True

    def _settle_replicas(self, states: FloatArray, rate: float, motion: Motion) -> tuple[Settled, BoolArray]:
        """Let runs settle at a speed.

        Returns the settled runs, and whether each has departed from a motion.
        """
        result, grows = self._settle(
            [Motion(rate, state, motion.parameter, motion.size) for state in states],
            np.full(len(states), rate),
        )
        apart = [not alike(motion.size, size, _FOLLOWS) for size in result.sizes]
        return result, grows | np.array(apart)

    @staticmethod
    def _replicas(motion: Motion) -> FloatArray:
        """(R, 2m) copies of the state with small differences, which chaos makes grow."""
        return np.asarray(motion.state * (1.0 + _MOVED * np.arange(_REPLICAS))[:, None])
