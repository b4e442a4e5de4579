"""Branches over the speed, results of a search for branches, and the system of the search.

Sources: docs/theory/orbits.md, "Branches".
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np

from floquet.orbits.attractors import Attractor, Motion, Survey
from floquet.orbits.bifurcations import Bifurcation
from floquet.orbits.branch import End, Family, Limits
from floquet.orbits.closing import close_orbit
from floquet.orbits.deadline import ENDLESS, Deadline
from floquet.orbits.long_run import LongRun, grown, long_run
from floquet.orbits.orbit import Orbit, same_motion, state_scale
from floquet.orbits.settling import alike
from lumped.errors import NumericalError
from lumped.typing import FloatArray

#: T [s] -> start (state, parameter): the motion while all contacts hold.
Start = Callable[[float], tuple[FloatArray, float]]

#: Rounding, as part of a step of the grid of speeds.
_SAME = 1e-6
#: Runs start apart from the motion while all contacts hold: by displacements in lengths, and by phase rates
#: in lengths times those of the fastest natural motion, in this rectangle.
_SPREAD = np.array([[-8.0, 5.0], [-6.5, 6.5]])
#: Distance of a settled run from a stable motion, over the size of the motion, within which both are one
#: motion.
_CLOSE = 0.03
#: Cycles for which a settled run settles once more, cycles for which a run is observed, and most cycles of a
#: motion that Newton's method looks for near a run.
_AGAIN = 40
_OBSERVE = 400
_MOST_CYCLES = 4
#: Cycles in which a run leaves a motion that has lost stability, before the run is compared with itself.
_AWAY = 100
#: Largest modulus of the multipliers of a stable motion. A bifurcation, whose modulus is one but for
#: rounding, counts as stable.
MARGINAL = 1.0 + 1e-6
#: Part of the speed behind a bifurcation where a run shows what happens there.
_BEYOND = 1e-3
_CORNER = 1e-6


@dataclass(frozen=True, eq=False)
class Branch:
    """Periodic motions of n cycles along one curve.

    Attributes
    ----------
    family : the system over its period
    n : cycles after which the motions repeat
    orbits : motions in order along the branch, with the motions of the bifurcations
    bifurcations : bifurcations in order along the branch
    ends : reason of the end at the first orbit, and at the last orbit
    """

    family: Family
    n: int
    orbits: tuple[Orbit, ...]
    bifurcations: tuple[Bifurcation, ...]
    ends: tuple[End, End]

    @property
    def rates(self) -> FloatArray:
        """1/T of the orbits [1/s]."""
        return np.array([1.0 / orbit.period for orbit in self.orbits])

    def at(self, period: float) -> list[Orbit]:
        """All orbits of the branch at a period, by Newton's method from the neighbours."""
        distance = self.rates - 1.0 / period
        system = self.family.at(period)
        result = list[Orbit]()
        for j in np.flatnonzero(distance[:-1] * distance[1:] <= 0.0):
            one = self.orbits[j]
            two = self.orbits[j + 1]
            differ = distance[j] != distance[j + 1]
            part = distance[j] / (distance[j] - distance[j + 1]) if differ else 0.5
            start = (1.0 - part) * one.start + part * two.start
            parameter = (1.0 - part) * one.parameter + part * two.parameter
            try:
                orbit = close_orbit(system, start, period, self.n, parameter)
            except NumericalError:
                continue
            if not any(same_motion(orbit, other) for other in result):
                result.append(orbit)
        return result


@dataclass(frozen=True, eq=False)
class Response:
    """Motions that a search has found over a range of speeds.

    Attributes
    ----------
    branches : curves of periodic motions
    settled : (T [s], motion to which runs have settled) at the speeds of the runs
    attractors : motions over speed that do not repeat within the cycles of the search
    runs : number of runs
    behind : orbit at which a branch loses stability -> motion of a run just beyond; only for the orbits from
        which a run was started
    windows : ranges of 1/T that were searched, and ranges to which branches have led [1/s]
    open : parts of the windows for which the time did not suffice [1/s]
    limited : whether the search had a limit of time
    """

    branches: tuple[Branch, ...]
    settled: tuple[tuple[float, LongRun], ...]
    attractors: tuple[Attractor, ...]
    runs: int
    behind: Mapping[Orbit, LongRun] = field(default_factory=dict)
    windows: tuple[tuple[float, float], ...] = ()
    open: tuple[tuple[float, float], ...] = ()
    limited: bool = False

    def at(self, period: float) -> list[Orbit]:
        """All orbits at a period, in order of their numbers of cycles."""
        result: list[Orbit] = []
        for branch in sorted(self.branches, key=lambda branch: branch.n):
            result += [o for o in branch.at(period) if not any(same_motion(o, other) for other in result)]
        return result

    def basins(self, member: Member, rate: float, places: FloatArray) -> list[tuple[LongRun, int]]:
        """Motions to which runs from places (k, 2) of the unit square settle at a speed.

        Each motion has the number of the runs that settle to it. The most frequent motion comes first.
        """
        survey = Survey(member.family, member.limits, np.array([rate]), member.apart(rate, places))
        orbits = self.at(1.0 / rate)
        result = list[tuple[Motion, int]]()
        for motion in survey.levels[0]:
            motion.identify(member.exactly(motion, orbits))
            same = [j for j, (other, _) in enumerate(result) if _same(motion, other)]
            for j in same[:1]:
                result[j] = result[j][0], result[j][1] + motion.starts
            result += [] if same else [(motion, motion.starts)]
        shares = [(motion.run, count) for motion, count in result]
        shares += [(grown(survey.grown[0].parameter), len(survey.grown))] if survey.grown else []
        return sorted(shares, key=lambda share: -share[1])


def _same(one: Motion, other: Motion) -> bool:
    """Whether two identified motions at one speed are equal."""
    orbit = one.run.orbit
    other_orbit = other.run.orbit
    if orbit is None or other_orbit is None:
        return orbit is other_orbit and alike(one.size, other.size)
    return orbit.n == other_orbit.n and same_motion(orbit, other_orbit)


@dataclass(frozen=True)
class Member:
    """A system over a range of speeds; a stack of members varies a second parameter.

    Attributes
    ----------
    family : the system over its period
    limits : range of speeds, sizes and amplitude
    start : T -> start of the search for the first motions
    """

    family: Family
    limits: Limits
    start: Start

    def grid(self, count: int) -> FloatArray:
        """Speeds 1/T of the range, ``count`` in an octave.

        The fastest natural frequency is a speed of the grid.
        """
        limits = self.limits
        low, high = (count * np.log2(rate / limits.frequency) for rate in (limits.slowest, limits.fastest))
        steps = np.arange(np.ceil(low - _SAME), np.floor(high + _SAME) + 1.0)
        return np.asarray(limits.frequency * 2.0 ** (steps / count))

    def apart(self, rate: float, places: FloatArray) -> list[tuple[float, FloatArray, float]]:
        """Starts (1/T, state, parameter) at places (k, 2) of the unit square.

        The square covers states around the motion while all contacts hold.
        """
        state, parameter = self.start(1.0 / rate)
        half = state.size // 2
        limits = self.limits
        lengths = _SPREAD[:, 0] + places * np.diff(_SPREAD, axis=1)[:, 0]
        states = np.tile(state, (len(places), 1))
        states[:, [0, half]] += lengths * limits.length * [1.0, 2.0 * np.pi * limits.frequency / rate]
        return [(rate, one, parameter) for one in states]

    def leads_to(self, orbit: Orbit, period: float, deadline: Deadline = ENDLESS) -> LongRun:
        """The motion to which a run from an orbit settles at another period.

        The run is exact to rounding, unlike a run of `settle`, because basins beside a motion
        that doubles can be thin.
        """
        return long_run(
            self.family.at(period), orbit.start, period, orbit.parameter,
            settle=_AWAY, observe=_OBSERVE, most_cycles=_MOST_CYCLES, amplitude=self.limits.amplitude,
            deadline=deadline,
        )  # fmt: skip

    def exactly(self, motion: Motion, orbits: list[Orbit], deadline: Deadline = ENDLESS) -> LongRun:
        """The exact motion of a settled run: one of the ``orbits``, or the result of a longer run."""
        period = 1.0 / motion.rate
        for orbit in orbits:
            close = _CLOSE * state_scale(motion.state)
            if orbit.stable and any((np.abs(s - motion.state) <= close).all() for s in orbit.shifted()):
                return LongRun("periodic", orbit, np.nan, np.nan, orbit.run, orbit.parameter)
        return long_run(
            self.family.at(period), motion.state, period, motion.parameter,
            settle=_AGAIN, observe=_OBSERVE, most_cycles=_MOST_CYCLES, amplitude=self.limits.amplitude,
            deadline=deadline,
        )  # fmt: skip


def lost_stability(branch: Branch) -> list[tuple[Bifurcation, float]]:
    """Bifurcations at which a branch loses stability, each with the period T of a speed 0.1 % beyond."""
    result = []
    marginal = {id(b.orbit) for b in branch.bifurcations if b.kind != "grazing"}
    for b in branch.bifurcations:
        index = branch.orbits.index(b.orbit)
        before, after = (
            next((o.stable for o in side if id(o) not in marginal), None)
            for side in (branch.orbits[:index][::-1], branch.orbits[index + 1 :])
        )
        if b.kind == "grazing" or before is None or after is None or before == after:
            continue
        to_stable = 1 if after else -1
        # A corner is not the extreme of the speed to the last digit.
        ratios = (o.period / b.orbit.period for o in branch.orbits[index + to_stable :: to_stable])
        ratio = next((ratio for ratio in ratios if abs(ratio - 1.0) > _CORNER), 1.0)
        if ratio != 1.0:
            result.append((b, b.orbit.period * (1.0 - _BEYOND if ratio > 1.0 else 1.0 + _BEYOND)))
    return result
