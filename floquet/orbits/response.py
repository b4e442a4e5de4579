"""Branches over the speed: the first ones, those that double, and isolated ones from settled runs.

Sources: docs/theory/orbits.md, "Branches".
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

import numpy as np

from floquet.orbits.bifurcations import (
    Bifurcation,
    bifurcations,
    doubling_direction,
    with_bifurcations,
)
from floquet.orbits.branch import Continuation, End, Family, Limits, Path
from floquet.orbits.long_run import LongRun, long_run
from floquet.orbits.orbit import Orbit, find_orbit, one_pass, primitive, same_motion
from lumped.errors import NumericalError
from lumped.typing import FloatArray, Progress

#: T [s] -> (state, parameter) to start from: the motion while all contacts hold.
Start = Callable[[float], tuple[FloatArray, float]]

_STARTS = 24
_SETTLE = 60
_SUBHARMONICS = 10
#: Motions of each branch of a neighbour from which Newton's method starts.
_NEIGHBOURS = 6
#: Starts apart from all motions, two a speed: displacements and phase rates in lengths, by an additive
#: recurrence that fills the square evenly (Roberts 2018), the same at every run.
_APART = 2
#: Where no motion found loses contact, every so many of these speeds.
_HELD = 2
_FILL = np.array([0.7548776662466927, 0.5698402909980532])
_SPREAD = np.array([[-8.0, 5.0], [-40.0, 40.0]])


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
        system, found = self.family.at(period), list[Orbit]()
        for j in np.flatnonzero(away[:-1] * away[1:] <= 0.0):
            one, two = self.orbits[j], self.orbits[j + 1]
            part = away[j] / (away[j] - away[j + 1]) if away[j] != away[j + 1] else 0.5
            try:
                orbit = find_orbit(
                    system,
                    (1.0 - part) * one.start + part * two.start,
                    period,
                    self.n,
                    (1.0 - part) * one.parameter + part * two.parameter,
                )
            except NumericalError:
                continue
            if not any(same_motion(orbit, other) for other in found):
                found.append(orbit)
        return found


@dataclass(frozen=True, eq=False)
class Response:
    """What was found over a range of speeds.

    Attributes
    ----------
    branches : curves of periodic motions
    settled : (T [s], what a run settled to) at the speeds that were tried
    """

    branches: tuple[Branch, ...]
    settled: tuple[tuple[float, LongRun], ...]

    def at(self, period: float) -> list[Orbit]:
        """All orbits that were found at a period, of few cycles first."""
        found: list[Orbit] = []
        for branch in sorted(self.branches, key=lambda branch: branch.n):
            found += [o for o in branch.at(period) if not any(same_motion(o, other) for other in found)]
        return found


def find_response(
    family: Family,
    limits: Limits,
    start: Start,
    *,
    periods: Collection[int] = (1, 2, 3),
    seeds: int = 40,
    progress: Progress | None = None,
) -> Response:
    """Return the branches over a range of speeds.

    Branches of one cycle are looked for from the motion while all contacts hold, at 24 speeds; those of
    twice the cycles leave period doublings; isolated ones start from runs that settled, at ``seeds`` speeds,
    on running up, on running down and from two starts apart. Where all motions found so far are stable and
    have some load at every moment, runs settle from starts apart only, at every other speed.

    Parameters
    ----------
    family : the system over its period
    limits : range of speeds, sizes and amplitude
    start : from where to look for the first motions
    periods : numbers of cycles of the motions wanted
    seeds : speeds at which runs settle
    progress : called with the finished fraction
    """
    search = _Search(family, limits, start, set(periods))
    search.explore(seeds, progress)
    return search.response


@dataclass(frozen=True)
class Member:
    """A system of a stack: what `find_response` takes."""

    family: Family
    limits: Limits
    start: Start


def find_stack(
    members: Sequence[Member],
    *,
    periods: Collection[int] = (1, 2),
    seeds: int = 0,
    progress: Progress | None = None,
) -> list[Response]:
    """Return the branches of several systems, each near the one before it, as over a second parameter.

    Each is looked at by itself as in `find_response`, and from motions of its neighbours on both sides, so
    that an isolated branch is found wherever it exists once one member has shown it.
    """
    searches: list[_Search] = []
    for j, member in enumerate(members):
        search = _Search(member.family, member.limits, member.start, set(periods))
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

    def __init__(self, family: Family, limits: Limits, start: Start, periods: set[int]) -> None:
        self.family, self.limits, self.start, self.periods = family, limits, start, periods
        self.branches: list[Branch] = []
        self.settled: list[tuple[float, LongRun]] = []
        self._done: set[int] = set()

    @property
    def response(self) -> Response:
        return Response(tuple(self.branches), tuple(self.settled))

    def explore(self, seeds: int, progress: Progress | None = None) -> None:
        """Look everywhere: see `find_response`."""
        limits, report = self.limits, progress or (lambda done: None)
        for j, rate in enumerate(np.linspace(limits.fastest, limits.slowest, _STARTS)):
            self.from_start(1.0 / float(rate))
            report(0.4 * (j + 1) / _STARTS)
        self.doublings()
        self.subharmonics()
        report(0.5)
        rates = np.linspace(limits.slowest, limits.fastest, seeds)
        if self.held:  # runs up and down would stay on the motions that are there
            rates = rates[::_HELD]
        for k, way in enumerate(() if self.held else (rates, rates[::-1])):
            state: FloatArray | None = None
            for j, rate in enumerate(way):
                run = self.settle(1.0 / float(rate), state)
                state = None if run.run is None else run.run.end
                report(0.5 + 0.15 * (k + (j + 1) / seeds))
        for j, rate in enumerate(rates):
            for k in range(_APART):
                place = np.mod(0.5 + (_APART * j + k) * _FILL, 1.0)
                apart = _SPREAD[:, 0] + place * np.diff(_SPREAD, axis=1)[:, 0]
                self.settle(1.0 / float(rate), None, apart)
            report(0.8 + 0.2 * (j + 1) / rates.size)
        self.doublings()
        report(1.0)

    @property
    def held(self) -> bool:
        """Whether all motions found so far are stable and have some load at every moment."""
        orbits = [orbit for branch in self.branches for orbit in branch.orbits]
        return bool(orbits) and all(o.stable and o.run.least_load > 0.0 for o in orbits)

    def from_neighbour(self, other: _Search) -> None:
        """Look for the branches of a neighbouring system, lengths in proportion."""
        for branch in list(other.branches):
            for part in range(_NEIGHBOURS):
                orbit = branch.orbits[(2 * part + 1) * len(branch.orbits) // (2 * _NEIGHBOURS)]
                start = orbit.start * (self.limits.length / other.limits.length)
                parameter = orbit.parameter * self.limits.parameter / other.limits.parameter
                system = self.family.at(orbit.period)
                try:
                    found = find_orbit(system, start, orbit.period, orbit.n, parameter)
                except NumericalError:
                    continue
                if primitive(found) is found:
                    self.both_ways(found)

    def known(self, orbit: Orbit) -> bool:
        """Whether a motion lies on a branch that was found."""
        return any(
            same_motion(orbit, other, 1e-5)
            for branch in self.branches
            if branch.n == orbit.n
            for other in branch.at(orbit.period)
        )

    def from_start(self, period: float) -> None:
        """Follow the motion of one cycle near the one while all contacts hold."""
        state, parameter = self.start(period)
        try:
            orbit = find_orbit(self.family.at(period), state, period, 1, parameter)
        except NumericalError:
            return
        self.both_ways(orbit)

    def settle(self, period: float, state: FloatArray | None, apart: FloatArray | None = None) -> LongRun:
        """Let a run settle, and follow the motion it comes to where it is new."""
        held, parameter = self.start(period)
        state = held if state is None else state
        if apart is not None:
            state = state.copy()
            state[[0, state.size // 2]] += apart * self.limits.length
        run = long_run(
            self.family.at(period), state, period, parameter,
            settle=_SETTLE, observe=400, amplitude=self.limits.amplitude,
        )  # fmt: skip
        if run.orbit is not None:
            self.from_settled(run.orbit)
        elif run.run is not None:
            self.near_beats(run.run.end, period, run.parameter)
        self.settled.append((period, run))
        return run

    def near_beats(self, state: FloatArray, period: float, parameter: float) -> None:
        """Look for motions, mostly unstable there, to which beats or chaos come near."""
        for n in sorted(self.periods - {1}):
            try:
                orbit = find_orbit(self.family.at(period), state, period, n, parameter)
            except NumericalError:
                continue
            if primitive(orbit) is orbit:
                self.both_ways(orbit)

    def from_settled(self, orbit: Orbit) -> None:
        """Follow a stable motion, or the one that it has doubled from where it has too many cycles."""
        for n in sorted((n for n in self.periods if orbit.n % n == 0), reverse=True):
            try:
                relative = find_orbit(orbit.system, orbit.start, orbit.period, n, orbit.parameter)
            except NumericalError:
                continue
            if primitive(relative) is relative:
                self.both_ways(relative)
            return

    def subharmonics(self) -> None:
        """Look for motions of n cycles in those of one cycle at 1/n of the speed.

        A large motion that hardly sees the coefficients change is nearly one of n cycles at n times the
        speed.
        """
        singles = [branch for branch in self.branches if branch.n == 1]
        for n in sorted(self.periods - {1}):
            for branch in singles:
                parting = [o for o in branch.orbits if o.parts and n / o.period <= self.limits.fastest]
                for single in parting[:: max(1, len(parting) // _SUBHARMONICS)]:
                    half = single.start.size // 2
                    start = single.start * np.repeat([1.0, 1.0 / n], half)
                    period = single.period / n
                    try:
                        orbit = find_orbit(self.family.at(period), start, period, n, single.parameter)
                    except NumericalError:
                        continue
                    if primitive(orbit) is orbit:
                        self.both_ways(orbit)

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
        found = bifurcations(along, path)
        orbits = tuple(with_bifurcations(along, path, found))
        self.branches.append(Branch(self.family, along.n, orbits, tuple(found), (first_end, path.end)))

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
