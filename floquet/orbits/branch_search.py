"""The search for branches: the first ones, those that double, and isolated ones from settled runs.

Sources: docs/theory/orbits.md, "Branches" and "Jumps within a time".
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial
from itertools import groupby

import numpy as np

from floquet.orbits.attractors import Attractor, Motion, Survey
from floquet.orbits.bifurcations import Bifurcation, bifurcations, doubling_direction, with_bifurcations
from floquet.orbits.branch import Continuation, End, Limits, Path
from floquet.orbits.closing import close_orbit, closing_residual, primitive
from floquet.orbits.deadline import ENDLESS, Deadline, OutOfTimeError
from floquet.orbits.long_run import LongRun, grown
from floquet.orbits.orbit import Orbit, same_motion
from floquet.orbits.response import Branch, Member, Response, lost_stability
from lumped.errors import NumericalError
from lumped.typing import FloatArray, Progress

#: Speeds in an octave at which Newton's method starts. They are powers of a ratio times the fastest natural
#: frequency, so that what is looked for at a speed does not depend on the range.
STARTS = 12
#: Least number of such speeds in a window.
_LEAST_STARTS = 3
#: Part of a speed that is rounding; speeds of the grid in an octave, at most.
_SAME = 1e-9
_EVEN = 10_000
_SUBHARMONICS = 10
#: Motions of each branch of a neighbour from which Newton's method starts.
_NEIGHBOURS = 6
#: Runs at each speed, evenly spread by an additive recurrence (Roberts 2018), the same at every run.
_RUNS = 32
_FILL = np.array([0.7548776662466927, 0.5698402909980532])
#: Parts of the time that is left: for a window beside others, for one branch of many, for following within
#: those (what remains is for refining what was found), and for one run of many.
_WINDOW = 0.5
_BRANCH = 0.25
_FOLLOWING = 0.5
_RUN = 0.5

Window = tuple[float, float]


@dataclass(frozen=True)
class Agenda:
    """Where a search looks, and in which order.

    Attributes
    ----------
    reported : slowest and fastest 1/T whose jumps are of interest [1/s]
    windows : ranges of 1/T in which motions may be another than the linear one [1/s]
    above : 1/T up to which large motions start that reach down into the range [1/s]
    reach : part of its speed to which a branch that is not followed may lead down
    first : 1/T of most interest [1/s]
    """

    reported: Window
    windows: tuple[Window, ...]
    above: float
    reach: float
    first: float

    def away(self, rate: float) -> float:
        """Distance of a speed from the one of most interest, in logarithms."""
        return abs(float(np.log(rate / self.first)))


def find_branches(
    member: Member, *, periods: Collection[int] = (1, 2, 3), seeds: int = 20,
    progress: Progress | None = None, agenda: Agenda | None = None, deadline: Deadline = ENDLESS,
) -> Response:  # fmt: skip
    """Return the branches of motions of some periods over a range of speeds.

    First those from the motion while all contacts hold, at 12 speeds an octave; then those behind period
    doublings; then isolated ones from runs that settled, at ``seeds`` speeds an octave.

    With an ``agenda`` only its windows are looked at, and branches from them as far as they lead. With a
    ``deadline`` what runs do behind the loss of stability is looked at as well, for each branch after it was
    found, and `Response.open` says where the time did not suffice.
    """
    search = _Search(member, set(periods), agenda, deadline)
    search.explore(seeds, progress)
    return search.response


def find_branches_of_stack(
    members: Sequence[Member],
    *,
    periods: Collection[int] = (1, 2),
    seeds: int = 0,
    progress: Progress | None = None,
) -> list[Response]:
    """Return the branches of several systems, for example over a second parameter.

    Each search also starts from motions of the neighbouring systems. An isolated branch found in one system
    is therefore also found in the neighbours.
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


@dataclass(eq=False)
class _Trace:
    """A branch as it is followed: paths up and down from its first motion, and what was refined of it.

    ``down`` is None where the path closes, or where it starts at a period doubling, which is ``first_end``.
    ``left`` are intervals between points that are still to be looked at.
    """

    along: Continuation
    up: Path
    down: Path | None
    first_end: End
    found: list[Bifurcation]
    left: list[int]

    @property
    def path(self) -> Path:
        """All points in order."""
        if self.down is None:
            return self.up
        return Path(
            [*self.down.X[:0:-1], *self.up.X],
            [*self.down.orbits[:0:-1], *self.up.orbits],
            [*(-tangent for tangent in self.down.tangents[:0:-1]), *self.up.tangents],
            self.up.end,
        )

    @property
    def ends(self) -> tuple[End, End]:
        """Reasons of the ends at the first and at the last motion."""
        return self.first_end if self.down is None else self.down.end, self.up.end

    @property
    def unfinished(self) -> bool:
        """Whether it goes on, or has intervals that were not looked at."""
        return "time" in self.ends or bool(self.left)

    def extend(self, deadline: Deadline) -> None:
        """Follow it on where it ended for want of time."""
        before = len(self.path.orbits)
        down = 0 if self.down is None else len(self.down.orbits)
        for path, limit in ((self.up, deadline.share(0.5)), (self.down, deadline)):
            if path is not None and path.end == "time":
                self.along.extend(path, limit)
        # Points before the first one move the others' indices.
        shift = 0 if self.down is None else len(self.down.orbits) - down
        self.found = [replace(b, place=b.place + shift) for b in self.found]
        self.left = [j + shift for j in self.left] + list(range(shift))
        self.left += range(shift + before - 1, len(self.path.orbits) - 1)

    def refine(self, away: Callable[[float], float], deadline: Deadline) -> None:
        """Find the bifurcations in the intervals that are left, the nearest to a speed first."""
        path = self.path
        order = sorted(self.left, key=lambda j: away(1.0 / path.orbits[j].period))
        found, self.left = bifurcations(self.along, path, order, deadline)
        self.found = sorted([*self.found, *found], key=lambda b: int(b.place))

    def branch(self) -> Branch:
        """The branch as far as it was followed."""
        orbits = tuple(with_bifurcations(self.along, self.path, self.found))
        return Branch(self.along.family, self.along.n, orbits, tuple(self.found), self.ends)


def merged(parts: Iterable[Window], inside: Window) -> tuple[Window, ...]:
    """Ranges within one range, in order and without overlap."""
    result = list[Window]()
    for one, two in sorted(parts):
        start, end = max(one, inside[0]), min(two, inside[1])
        if start >= end:
            continue
        if result and start <= result[-1][1]:
            result[-1] = result[-1][0], max(end, result[-1][1])
        else:
            result.append((start, end))
    return tuple(result)


def _tell(report: Callable[[float], None], before: float, share: float, done: float) -> None:
    """Report the finished fraction of a part."""
    report(before + share * done)


class _Search:
    """The branches found so far."""

    def __init__(
        self, member: Member, periods: set[int], agenda: Agenda | None = None, deadline: Deadline = ENDLESS
    ) -> None:
        self.member = member
        self.periods = periods
        self.family = member.family
        self.limits = member.limits
        self.start = member.start
        self.agenda = agenda
        self.deadline = deadline
        whole = self.limits.slowest, self.limits.fastest
        self.reported: Window = agenda.reported if agenda else whole
        self.asked: list[Window] = sorted(agenda.windows, key=self._from_first) if agenda else [whole]
        self.branches: list[Branch] = []
        self.settled: list[tuple[float, LongRun]] = []
        self.attractors: list[Attractor] = []
        self.behind: dict[Orbit, LongRun] = {}
        self.runs = 0
        #: Time for what is done at present, and for the part of it that follows branches.
        self.slot = self.following = deadline
        self._doubled: set[Orbit] = set()
        self._cut: dict[int, _Trace] = {}
        #: Windows and speeds 1/T at which something is left to do.
        self._late: set[Window] = set()
        self._left: list[float] = []
        self._losses: dict[Branch, list[tuple[Bifurcation, float]]] = {}

    @property
    def response(self) -> Response:
        windows = self.windows()
        return Response(
            branches=tuple(self.branches),
            settled=tuple(self.settled),
            attractors=tuple(self.attractors),
            runs=self.runs,
            behind=self.behind,
            windows=windows,
            open=self._open(windows),
            limited=self.deadline.limited,
        )

    # Windows and what is left of them.

    def windows(self) -> tuple[Window, ...]:
        """The windows of the agenda and the speeds to which branches have led, without overlap."""
        if self.agenda is None:
            return (self.reported,)
        parts = [*self.asked]
        for branch in self.branches:
            for far, orbits in groupby(branch.orbits, key=lambda o: branch.n > 1 or not self._calm(o)):
                rates = [1.0 / orbit.period for orbit in orbits]
                parts += [(min(rates) * (1.0 - _SAME), max(rates) * (1.0 + _SAME))] if far else []
        return merged(parts, self.reported)

    def _open(self, windows: tuple[Window, ...]) -> tuple[Window, ...]:
        """Ranges of 1/T with unfinished work, and ranges to which unfinished branches may lead."""
        if not self.deadline.limited:
            return ()
        high = self.reported[1]
        behind = [1.0 / b.orbit.period for b, _ in self._unknown_behind()]
        late = [*self._late, *((rate, rate) for rate in self._left)]
        late += [(1.0 / b.orbit.period, 1.0 / b.orbit.period) for _, b in self._undoubled()]
        for trace in self._cut.values():
            rates = [1.0 / o.period for o in trace.path.orbits]
            late.append((min(rates), max(rates)))
        reach = self.agenda.reach if self.agenda else 0.0
        parts = [(rate * (1.0 - _SAME), rate * (1.0 + _SAME)) for rate in behind]
        for one, two in late:
            # Up to the next window, in which motions of their own start.
            above = min((w[0] for w in windows if w[0] > two), default=high)
            parts.append((min(one, reach * two), max(two, above)))
        touched = [w for w in windows if any(one <= w[1] and two >= w[0] for one, two in parts)]
        return merged([*parts, *touched], self.reported)

    def _calm(self, orbit: Orbit) -> bool:
        return self.limits.calm is not None and self.limits.calm(orbit)

    def _from_first(self, window: Window) -> float:
        """Distance of a window from the speed of most interest."""
        if self.agenda is None or window[0] <= self.agenda.first <= window[1]:
            return 0.0
        return min(map(self.agenda.away, window))

    def _away(self, rate: float) -> float:
        """Distance of a speed from that of most interest; without one all are as near."""
        return self.agenda.away(rate) if self.agenda else 0.0

    def _inside(self, rate: float) -> bool:
        return self.reported[0] <= rate <= self.reported[1]

    # The order of the search.

    def explore(self, seeds: int, progress: Progress | None = None) -> None:
        """Look everywhere: see `find_branches`."""
        report = progress or (lambda done: None)
        self.primaries(report)
        self.slot = self.deadline.share(_WINDOW)
        self.look_behind()
        self.doublings()
        self.subharmonics()
        self.finish()
        report(0.5)
        if seeds:
            windows = [(0.0, np.inf)] if self.agenda is None else sorted(self.windows(), key=self._from_first)
            rates = self.member.grid(seeds)
            for j, window in enumerate(windows):
                inside = rates[(rates >= window[0]) & (rates <= window[1])]
                tell = partial(_tell, report, 0.5 + 0.45 * j / len(windows), 0.45 / len(windows))
                try:
                    if inside.size:
                        self.slot = self.following = self.deadline
                        self.settle(inside, tell)
                except OutOfTimeError:
                    self._late.add(window)
                self.slot = self.deadline
                self.look_behind()
            self.doublings()
            self.finish()
        report(1.0)

    def primaries(self, report: Callable[[float], None]) -> None:
        """Follow the branches through the motion while all contacts hold, in one window after the other."""
        pending = [*self.asked]
        if self.agenda is not None and self.agenda.above > self.reported[1]:
            pending.append((self.reported[1], self.agenda.above))
        count = len(pending)
        while pending and not self.deadline.passed:
            again = list[Window]()
            for j, window in enumerate(pending):
                self.slot = self.deadline.share(max(_WINDOW, 1.0 / (len(pending) - j)))
                self.following = self.slot.share(_FOLLOWING)
                for trace in [*self._cut.values()]:
                    if self._touches(trace, window):
                        self._resume(trace)
                whole = self.from_linear(window, partial(_tell, report, 0.0, 0.4 / count))
                self.look_behind(folds=True)
                touched = any(self._touches(trace, window) for trace in self._cut.values())
                again += [] if whole and not touched else [window]
            pending = again
            report(0.4 * (1.0 - len(pending) / count))
        self._late.update(pending)

    def finish(self) -> None:
        """Go on with what was cut, as long as there is time."""
        while self._cut and not self.deadline.passed:
            index = min(
                self._cut, key=lambda i: min(self._away(1.0 / o.period) for o in self.branches[i].orbits)
            )
            self.slot = self.deadline.share(_WINDOW)
            self.following = self.slot.share(_FOLLOWING)
            self._resume(self._cut[index])
        self.slot = self.deadline
        self.look_behind()

    @staticmethod
    def _touches(trace: _Trace, window: Window) -> bool:
        return any(window[0] <= 1.0 / o.period <= window[1] for o in trace.path.orbits)

    def from_linear(self, window: Window, report: Callable[[float], None] = lambda done: None) -> bool:
        """Follow what starts at the motion while all contacts hold; whether there was time for all starts."""
        rates = self.member.grid(STARTS)[::-1]
        if self.agenda is not None:
            rates = rates[(rates >= window[0]) & (rates <= window[1])]
            if rates.size < _LEAST_STARTS:
                rates = np.append(rates, np.geomspace(*window, _LEAST_STARTS + 2)[1:-1])
            if window[0] <= self.agenda.first <= window[1]:
                rates = np.append(rates, self.agenda.first)
            rates = np.array(sorted(rates, key=self._away))
        found = False
        for j, rate in enumerate(map(float, rates)):
            # A branch that was cut may lead to where the next motion starts.
            if self.following.passed or any(self._touches(trace, window) for trace in self._cut.values()):
                return False
            state, parameter = self.start(1.0 / rate)
            found |= self.follow_near(state, 1.0 / rate, 1, parameter)
            report((j + 1) / rates.size)
        if not found:  # no claim about a window without any motion
            self._left += map(float, rates)
        return True

    def look_behind(self, folds: bool = False) -> None:
        """Let runs say what happens behind each loss of stability, or behind folds alone.

        Folds come first: most jumps are there. A search without limit leaves it to who asks for the jumps.
        """
        if not self.deadline.limited:
            return

        def urgency(one: tuple[Bifurcation, float]) -> tuple[bool, float]:
            return one[0].kind != "fold", self._away(1.0 / one[0].orbit.period)

        for b, period in sorted(self._unknown_behind(), key=urgency):
            if self.slot.passed or (folds and b.kind != "fold"):
                return
            with suppress(OutOfTimeError, NumericalError):
                self.behind[b.orbit] = self.member.leads_to(b.orbit, period, self.slot.share(_RUN))

    def response_at(self, period: float) -> list[Orbit]:
        """All orbits that were found at a period."""
        return Response(tuple(self.branches), (), (), 0).at(period)

    def _unknown_behind(self) -> list[tuple[Bifurcation, float]]:
        """Losses of stability in the range of which nobody has looked at what comes behind."""
        return [
            (b, period)
            for branch in self.branches
            for b, period in self._of(branch)
            if b.orbit not in self.behind
        ]

    def _of(self, branch: Branch) -> list[tuple[Bifurcation, float]]:
        """Losses of stability of a branch in the range, looked for once."""
        if branch not in self._losses:
            losses = lost_stability(branch)
            self._losses[branch] = [one for one in losses if self._inside(1.0 / one[0].orbit.period)]
        return self._losses[branch]

    # Isolated motions.

    def settle(self, rates: FloatArray, report: Callable[[float], None]) -> None:
        """Let runs settle at some speeds, and follow the branches of new motions."""
        starts = []
        for rate in map(float, rates):
            # The same numbers at a speed, whatever the range.
            first = _RUNS * round(_EVEN * np.log2(rate / self.limits.frequency))
            places = np.mod(0.5 + (first + np.arange(_RUNS))[:, None] * _FILL, 1.0)
            starts += self.member.apart(rate, places)
        survey = Survey(
            self.family, self.limits, rates, starts, lambda done: report(0.4 * done), self.deadline
        )
        self.runs += len(starts)
        self.settled += [(1.0 / start.rate, grown(start.parameter)) for start in survey.grown]
        for j, level in enumerate(survey.levels):
            for motion in level:
                motion.identify(self.identify(motion))
                self.settled.append((1.0 / motion.rate, motion.run))
            report(0.4 + 0.4 * (j + 1) / rates.size)
        self.attractors += survey.attractors(self.unlisted, self.identify)

    def unlisted(self, run: LongRun) -> bool:
        """Whether a run has come to a motion that no branch can have."""
        return run.run is not None and (run.orbit is None or run.orbit.n not in self.periods)

    def identify(self, motion: Motion) -> LongRun:
        """The exact motion of a settled run. The branch of a new periodic motion is followed."""
        known = self.response_at(1.0 / motion.rate)
        run = self.member.exactly(motion, known, self.deadline)
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

    def subharmonics(self) -> None:
        """Look for motions of n cycles near large ones of one cycle at 1/n of the speed."""
        singles = [branch for branch in self.branches if branch.n == 1]
        for n in sorted(self.periods - {1}):
            for branch in singles:
                beyond = [o for o in branch.orbits if o.contact_lost and n / o.period <= self.reported[1]]
                for single in beyond[:: max(1, len(beyond) // _SUBHARMONICS)]:
                    if self.deadline.passed:
                        self._left += [1.0 / single.period, n / single.period]
                        continue
                    self.slot = self.deadline.share(_BRANCH)
                    self.following = self.slot.share(_FOLLOWING)
                    start = single.start * np.repeat([1.0, 1.0 / n], single.start.size // 2)
                    self.follow_near(start, single.period / n, n, single.parameter)
                    self.look_behind(folds=True)

    # Single branches.

    def known(self, orbit: Orbit, besides: Branch | None = None) -> bool:
        """Whether a motion lies on a branch that was found, besides one."""
        return any(
            same_motion(orbit, other, 1e-5)
            for branch in self.branches
            if branch.n == orbit.n and branch is not besides
            for other in branch.at(orbit.period)
        )

    def twice(self, orbits: Sequence[Orbit], besides: Branch | None = None) -> bool:
        """Whether the motions of a path are on other branches.

        Near a fold `known` may miss a motion, but not at all places of a branch.
        """
        inner = [orbits[part * len(orbits) // 4] for part in (1, 2, 3)]
        return sum(self.known(orbit, besides) for orbit in inner) > 1

    def follow_near(self, start: FloatArray, period: float, n: int, parameter: float) -> bool:
        """Whether there is a motion near a start; its branch is followed unless it has fewer cycles."""
        try:
            orbit = close_orbit(self.family.at(period), start, period, n, parameter)
        except NumericalError:
            return False
        if primitive(orbit) is orbit and not (n == 1 and self._calm(orbit)):
            self.both_ways(orbit)
        return True

    def from_settled(self, orbit: Orbit) -> None:
        """Follow a stable motion. With too many cycles: the motion from which it has doubled."""
        for n in sorted((n for n in self.periods if orbit.n % n == 0), reverse=True):
            if self.follow_near(orbit.start, orbit.period, n, orbit.parameter):
                return

    def both_ways(self, orbit: Orbit) -> None:
        """Add the branch through an orbit unless it is known."""
        if self.known(orbit):
            return
        along = Continuation(self.family, orbit.n, self._limits(orbit.n))
        try:
            up = along.follow(orbit, 1.0, deadline=self.following.share(0.5))
            if up.end == "closed":
                self.add(_Trace(along, up, None, "closed", [], []))
                return
            down = along.follow(orbit, -1.0, deadline=self.following)
        except NumericalError:
            return
        self.add(_Trace(along, up, down, down.end, [], []))

    def _limits(self, n: int) -> Limits:
        """Motions of several cycles are followed in the range of interest alone."""
        if self.agenda is None or n == 1:
            return self.limits
        step = 2.0 ** (1.0 / STARTS)
        return replace(self.limits, fastest=min(self.limits.fastest, step * self.reported[1]))

    def add(self, trace: _Trace) -> None:
        """Add a path to the branches, unless its motions lie on a branch found before."""
        orbits = trace.path.orbits
        if self.twice(orbits):
            return
        trace.left = list(range(len(orbits) - 1))
        self.branches.append(self._refined(trace))
        if trace.unfinished:
            self._cut[len(self.branches) - 1] = trace

    def _refined(self, trace: _Trace) -> Branch:
        trace.refine(self._away, self.slot.share(_FOLLOWING))
        return trace.branch()

    def _resume(self, trace: _Trace) -> None:
        """Continue a branch that the deadline has cut, or drop it where it repeats another branch."""
        index = next(i for i, other in self._cut.items() if other is trace)
        if not self.twice(trace.path.orbits, self.branches[index]):
            try:
                trace.extend(self.following)
            except NumericalError:
                trace.up.end = "lost"
            self.branches[index] = self._refined(trace)
            if trace.unfinished:
                return
        del self._cut[index]
        if self.twice(trace.path.orbits, self.branches[index]):
            del self.branches[index]
            self._cut = {i - (i > index): other for i, other in self._cut.items()}

    def doublings(self) -> None:
        """Follow the branches that leave period doublings, as long as their cycles are wanted."""
        while not self.deadline.passed:
            points: Iterable[tuple[Branch, Bifurcation]] = self._undoubled()
            branch, point = min(
                points, key=lambda one: self._away(1.0 / one[1].orbit.period), default=(None, None)
            )
            if branch is None or point is None:
                return
            self._doubled.add(point.orbit)
            self.slot = self.deadline.share(_BRANCH)
            self.following = self.slot.share(_FOLLOWING)
            self._double(Continuation(self.family, 2 * branch.n, self._limits(2 * branch.n)), point.orbit)
            self.look_behind(folds=True)

    def _undoubled(self) -> list[tuple[Branch, Bifurcation]]:
        """Period doublings in the range whose branches were not followed."""
        return [
            (branch, point)
            for branch in self.branches
            if 2 * branch.n in self.periods
            for point in branch.bifurcations
            if point.kind == "period doubling" and point.sharp and point.orbit not in self._doubled
            if self._inside(1.0 / point.orbit.period)
        ]

    def _double(self, along: Continuation, single: Orbit) -> None:
        run = closing_residual(single.system, single.start, single.period, along.n, single.parameter)[2]
        twice = Orbit(single.system, single.period, along.n, single.parameter, run)
        try:
            path = along.follow(twice, tangent=doubling_direction(along, single), deadline=self.following)
        except NumericalError:
            return
        self.add(_Trace(along, path, None, "doubling", [], []))
