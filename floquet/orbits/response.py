"""Branches over the speed: the first ones, those that double, and isolated ones from settled runs.

Sources: docs/theory/orbits.md, "Branches".
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

import numpy as np

from floquet.orbits.attractors import Attractor, Motion, Survey
from floquet.orbits.bifurcations import Bifurcation, bifurcations, doubling_direction, with_bifurcations
from floquet.orbits.branch import Continuation, End, Family, Limits, Path
from floquet.orbits.long_run import LongRun, grown, long_run
from floquet.orbits.orbit import Orbit, find_orbit, one_pass, primitive, same_motion, state_scale
from floquet.orbits.settling import alike
from lumped.errors import NumericalError
from lumped.typing import FloatArray, Progress

#: T [s] -> (state, parameter) to start from: the motion while all contacts hold.
Start = Callable[[float], tuple[FloatArray, float]]

#: Speeds in an octave at which Newton's method starts. They are powers of a ratio times the fastest natural
#: frequency, so that what is looked for at a speed does not depend on the range.
STARTS = 12
#: Part of a step of the grid of speeds that is rounding; speeds of the grid in an octave, at most.
_SAME, _EVEN = 1e-6, 10_000
_SUBHARMONICS = 10
#: Motions of each branch of a neighbour from which Newton's method starts.
_NEIGHBOURS = 6
#: Runs at each speed. They start apart from the motion while all contacts hold: by displacements in lengths,
#: and by phase rates in lengths times those of the fastest natural motion, evenly spread over a rectangle by
#: an additive recurrence (Roberts 2018), the same at every run.
_RUNS = 32
_FILL = np.array([0.7548776662466927, 0.5698402909980532])
_SPREAD = np.array([[-8.0, 5.0], [-6.5, 6.5]])
#: Distance from a stable motion, over its size, within which a settled run has come to it.
_CLOSE = 0.03
#: Cycles that a run which has settled settles once more, and is observed; cycles of a motion for which Newton
#: looks near a run that has not come to one yet.
_AGAIN, _OBSERVE, _MOST_CYCLES = 40, 400, 4


@dataclass(frozen=True, eq=False)
class Branch:
    """Periodic motions of n cycles along one curve.

    Attributes
    ----------
    family : the system over its period
    n : cycles
    orbits : in order along the branch, those of the bifurcations among them
    bifurcations : in order along the branch
    ends : why it ends at its first and at its last orbit
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
        away = self.rates - 1.0 / period
        system, result = self.family.at(period), list[Orbit]()
        for j in np.flatnonzero(away[:-1] * away[1:] <= 0.0):
            one, two = self.orbits[j], self.orbits[j + 1]
            part = away[j] / (away[j] - away[j + 1]) if away[j] != away[j + 1] else 0.5
            start = (1.0 - part) * one.start + part * two.start
            parameter = (1.0 - part) * one.parameter + part * two.parameter
            try:
                orbit = find_orbit(system, start, period, self.n, parameter)
            except NumericalError:
                continue
            if not any(same_motion(orbit, other) for other in result):
                result.append(orbit)
        return result


@dataclass(frozen=True, eq=False)
class Response:
    """What was found over a range of speeds.

    Attributes
    ----------
    branches : curves of periodic motions
    settled : (T [s], what runs settled to) at the speeds that were tried
    attractors : what does not repeat after the cycles looked for, over speed
    runs : how many runs settled
    """

    branches: tuple[Branch, ...]
    settled: tuple[tuple[float, LongRun], ...]
    attractors: tuple[Attractor, ...]
    runs: int

    def at(self, period: float) -> list[Orbit]:
        """All orbits that were found at a period, of few cycles first."""
        result: list[Orbit] = []
        for branch in sorted(self.branches, key=lambda branch: branch.n):
            result += [o for o in branch.at(period) if not any(same_motion(o, other) for other in result)]
        return result

    def basins(self, member: Member, rate: float, places: FloatArray) -> list[tuple[LongRun, int]]:
        """To what runs from places (k, 2) of the unit square settle at a speed, and how many of them."""
        survey = Survey(member.family, member.limits, np.array([rate]), member.apart(rate, places))
        orbits, result = self.at(1.0 / rate), list[tuple[Motion, int]]()
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
    """Whether two that were identified at one speed are one motion."""
    a, b = one.run.orbit, other.run.orbit
    if a is None or b is None:
        return a is b and alike(one.size, other.size)
    return a.n == b.n and same_motion(a, b)


@dataclass(frozen=True)
class Member:
    """A system over a range of speeds: one of a stack.

    Attributes
    ----------
    family : the system over its period
    limits : range of speeds, sizes and amplitude
    start : from where to look for the first motions
    """

    family: Family
    limits: Limits
    start: Start

    def grid(self, count: int) -> FloatArray:
        """Speeds 1/T of the range, ``count`` an octave, the fastest natural frequency among them."""
        limits = self.limits
        low, high = (count * np.log2(rate / limits.frequency) for rate in (limits.slowest, limits.fastest))
        steps = np.arange(np.ceil(low - _SAME), np.floor(high + _SAME) + 1.0)
        return np.asarray(limits.frequency * 2.0 ** (steps / count))

    def apart(self, rate: float, places: FloatArray) -> list[tuple[float, FloatArray, float]]:
        """Starts apart from the motion while all contacts hold, at places (k, 2) of the unit square."""
        state, parameter = self.start(1.0 / rate)
        half, limits = state.size // 2, self.limits
        lengths = _SPREAD[:, 0] + places * np.diff(_SPREAD, axis=1)[:, 0]
        states = np.tile(state, (len(places), 1))
        states[:, [0, half]] += lengths * limits.length * [1.0, 2.0 * np.pi * limits.frequency / rate]
        return [(rate, one, parameter) for one in states]

    def exactly(self, motion: Motion, orbits: list[Orbit]) -> LongRun:
        """What a settled run has come to: one of the orbits that were found there, or something else."""
        period = 1.0 / motion.rate
        for orbit in orbits:
            close = _CLOSE * state_scale(motion.state)
            if orbit.stable and any((np.abs(s - motion.state) <= close).all() for s in orbit.shifted()):
                return LongRun("periodic", orbit, np.nan, np.nan, orbit.run, orbit.parameter)
        return long_run(
            self.family.at(period), motion.state, period, motion.parameter,
            settle=_AGAIN, observe=_OBSERVE, most_cycles=_MOST_CYCLES, amplitude=self.limits.amplitude,
        )  # fmt: skip


def find_response(
    member: Member, *, periods: Collection[int] = (1, 2, 3), seeds: int = 20, progress: Progress | None = None
) -> Response:
    """Return the branches of motions of some periods over a range of speeds.

    First those from the motion while all contacts hold, at 12 speeds an octave; then those behind period
    doublings; then isolated ones from runs that settled, at ``seeds`` speeds an octave.
    """
    search = _Search(member, set(periods))
    search.explore(seeds, progress)
    return search.response


def find_stack(
    members: Sequence[Member],
    *,
    periods: Collection[int] = (1, 2),
    seeds: int = 0,
    progress: Progress | None = None,
) -> list[Response]:
    """Return the branches of several systems, as over a second parameter, each also from its neighbours.

    So an isolated branch is found wherever it exists once one member has shown it.
    """
    searches: list[_Search] = []
    for j, member in enumerate(members):
        search = _Search(member, set(periods))
        if searches:
            search.from_neighbour(searches[-1])
        search.explore(seeds)
        searches.append(search)
        if progress is not None:
            progress((j + 1) / (len(members) + 1))
    for search, behind in zip(searches[-2::-1], searches[:0:-1], strict=True):
        search.from_neighbour(behind)
        search.doublings()
    if progress is not None:
        progress(1.0)
    return [search.response for search in searches]


class _Search:
    """The branches found so far."""

    def __init__(self, member: Member, periods: set[int]) -> None:
        self.member, self.periods = member, periods
        self.family, self.limits, self.start = member.family, member.limits, member.start
        self.branches: list[Branch] = []
        self.settled: list[tuple[float, LongRun]] = []
        self.attractors: tuple[Attractor, ...] = ()
        self.runs = 0
        self._done: set[int] = set()

    @property
    def response(self) -> Response:
        return Response(tuple(self.branches), tuple(self.settled), self.attractors, self.runs)

    def explore(self, seeds: int, progress: Progress | None = None) -> None:
        """Look everywhere: see `find_response`."""
        report = progress or (lambda done: None)
        rates = self.member.grid(STARTS)
        for j, rate in enumerate(map(float, rates[::-1])):
            state, parameter = self.start(1.0 / rate)
            self.follow_near(state, 1.0 / rate, 1, parameter)
            report(0.4 * (j + 1) / rates.size)
        self.doublings()
        self.subharmonics()
        report(0.5)
        if seeds:
            self.settle(self.member.grid(seeds), report)
            self.doublings()
        report(1.0)

    def settle(self, rates: FloatArray, report: Callable[[float], None]) -> None:
        """Let runs settle at the speeds, follow the motions to which they come where they are new."""
        starts = []
        for rate in map(float, rates):
            # The same numbers at a speed, whatever the range.
            first = _RUNS * round(_EVEN * np.log2(rate / self.limits.frequency))
            places = np.mod(0.5 + (first + np.arange(_RUNS))[:, None] * _FILL, 1.0)
            starts += self.member.apart(rate, places)
        self.runs += len(starts)
        survey = Survey(self.family, self.limits, rates, starts, lambda done: report(0.5 + 0.2 * done))
        self.settled += [(1.0 / start.rate, grown(start.parameter)) for start in survey.grown]
        for j, level in enumerate(survey.levels):
            for motion in level:
                motion.identify(self.identify(motion))
                self.settled.append((1.0 / motion.rate, motion.run))
            report(0.7 + 0.2 * (j + 1) / rates.size)
        self.attractors = survey.attractors(self.unlisted, self.identify)

    def unlisted(self, run: LongRun) -> bool:
        """Whether a run has come to a motion that no branch can have."""
        return run.run is not None and (run.orbit is None or run.orbit.n not in self.periods)

    def identify(self, motion: Motion) -> LongRun:
        """What a settled run has come to exactly; where it repeats and is new its branch is followed."""
        known = self.response.at(1.0 / motion.rate)
        run = self.member.exactly(motion, known)
        if run.orbit is not None and run.orbit not in known:
            self.from_settled(run.orbit)
        elif run.orbit is None and run.run is not None:  # unstable motions to which beats or chaos come near
            for n in sorted(self.periods - {1}):
                self.follow_near(run.run.end, 1.0 / motion.rate, n, run.parameter)
        return run

    def from_neighbour(self, other: _Search) -> None:
        """Look for the branches of a neighbouring system, lengths in proportion."""
        for branch in list(other.branches):
            for part in range(_NEIGHBOURS):
                orbit = branch.orbits[(2 * part + 1) * len(branch.orbits) // (2 * _NEIGHBOURS)]
                start = orbit.start * (self.limits.length / other.limits.length)
                parameter = orbit.parameter * self.limits.parameter / other.limits.parameter
                self.follow_near(start, orbit.period, orbit.n, parameter)

    def known(self, orbit: Orbit) -> bool:
        """Whether a motion lies on a branch that was found."""
        return any(
            same_motion(orbit, other, 1e-5)
            for branch in self.branches
            if branch.n == orbit.n
            for other in branch.at(orbit.period)
        )

    def follow_near(self, start: FloatArray, period: float, n: int, parameter: float) -> bool:
        """Whether there is a motion near a start; its branch is followed unless it has fewer cycles."""
        try:
            orbit = find_orbit(self.family.at(period), start, period, n, parameter)
        except NumericalError:
            return False
        if primitive(orbit) is orbit:
            self.both_ways(orbit)
        return True

    def from_settled(self, orbit: Orbit) -> None:
        """Follow a stable motion, or the one that it has doubled from where it has too many cycles."""
        for n in sorted((n for n in self.periods if orbit.n % n == 0), reverse=True):
            if self.follow_near(orbit.start, orbit.period, n, orbit.parameter):
                return

    def subharmonics(self) -> None:
        """Look for motions of n cycles near large ones of one cycle at 1/n of the speed."""
        singles = [branch for branch in self.branches if branch.n == 1]
        for n in sorted(self.periods - {1}):
            for branch in singles:
                beyond = [o for o in branch.orbits if o.contact_lost and n / o.period <= self.limits.fastest]
                for single in beyond[:: max(1, len(beyond) // _SUBHARMONICS)]:
                    start = single.start * np.repeat([1.0, 1.0 / n], single.start.size // 2)
                    self.follow_near(start, single.period / n, n, single.parameter)

    def both_ways(self, orbit: Orbit) -> None:
        """Add the branch through an orbit unless it is known."""
        if self.known(orbit):
            return
        along = Continuation(self.family, orbit.n, self.limits)
        try:
            up = along.follow(orbit, 1.0)
            if up.end == "closed":
                self.add(along, up, "closed")
                return
            down = along.follow(orbit, -1.0)
        except NumericalError:
            return
        path = Path(
            [*down.X[:0:-1], *up.X],
            [*down.orbits[:0:-1], *up.orbits],
            [*(-tangent for tangent in down.tangents[:0:-1]), *up.tangents],
            up.end,
        )
        self.add(along, path, down.end)

    def add(self, along: Continuation, path: Path, first_end: End) -> None:
        """Keep a path as a branch, unless it turns out to be one that is known.

        Near a fold `known` may miss a motion, but not at all places of a branch.
        """
        inner = [path.orbits[part * len(path.orbits) // 4] for part in (1, 2, 3)]
        if sum(self.known(orbit) for orbit in inner) > 1:
            return
        result = bifurcations(along, path)
        orbits = tuple(with_bifurcations(along, path, result))
        self.branches.append(Branch(self.family, along.n, orbits, tuple(result), (first_end, path.end)))

    def doublings(self) -> None:
        """Follow the branches that leave period doublings, as long as their cycles are wanted."""
        for index in range(10_000):
            if index >= len(self.branches):
                return
            branch = self.branches[index]
            if index in self._done or 2 * branch.n not in self.periods:
                continue
            self._done.add(index)
            along = Continuation(self.family, 2 * branch.n, self.limits)
            for point in branch.bifurcations:
                if point.kind == "period doubling" and point.sharp:
                    self._double(along, point.orbit)

    def _double(self, along: Continuation, single: Orbit) -> None:
        run = one_pass(single.system, single.start, single.period, along.n, single.parameter)[2]
        twice = Orbit(single.system, single.period, along.n, single.parameter, run)
        try:
            path = along.follow(twice, tangent=doubling_direction(along, single))
        except NumericalError:
            return
        self.add(along, path, "doubling")
