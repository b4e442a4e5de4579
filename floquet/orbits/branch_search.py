"""The search for branches: first branches, branches of period doublings, and isolated branches.

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
#: frequency, so that the search at a speed does not depend on the range.
STARTS = 12
#: Least number of such speeds in a window.
_LEAST_STARTS = 3
#: Rounding, as part of a speed, and most speeds of the grid in an octave.
_SAME = 1e-9
_EVEN = 10_000
_SUBHARMONICS = 10
#: Motions of each branch of a neighbour from which Newton's method starts.
_NEIGHBOURS = 6
#: Runs at each speed, evenly spread by an additive recurrence (Roberts 2018), the same at every run.
_RUNS = 32
_FILL = np.array([0.7548776662466927, 0.5698402909980532])
#: Parts of the remaining time: for one of several windows, for one of many branches, for following within
#: these times (the rest is for refining bifurcations), and for one of many runs.
_WINDOW = 0.5
_BRANCH = 0.25
_FOLLOWING = 0.5
_RUN = 0.5

Window = tuple[float, float]


@dataclass(frozen=True)
class Agenda:
    """Ranges of speeds for a search, and the order of the search.

    Attributes
    ----------
    reported : slowest and fastest 1/T whose jumps are of interest [1/s]
    windows : ranges of 1/T in which a motion may differ from the linear motion [1/s]
    above : 1/T up to which large motions start whose branches reach down into the range [1/s]
    reach : lowest speed that a branch may reach, over the speed at which the branch was cut
    first : 1/T of most interest [1/s]
    """

    reported: Window
    windows: tuple[Window, ...]
    above: float
    reach: float
    first: float

    def away(self, rate: float) -> float:
        """Distance of a speed from the speed of most interest, in logarithms."""
        return abs(float(np.log(rate / self.first)))


def find_branches(
    member: Member, *, periods: Collection[int] = (1, 2, 3), seeds: int = 20,
    progress: Progress | None = None, agenda: Agenda | None = None, deadline: Deadline = ENDLESS,
) -> Response:  # fmt: skip
    """Return the branches of motions of some periods over a range of speeds.

    The search first follows branches from the motion while all contacts hold, at 12 speeds an octave. Next
    come branches of period doublings. Last come isolated branches from settled runs, at ``seeds`` speeds an
    octave.

    With an ``agenda`` the search is limited to the windows of the agenda and to branches that lead out of
    these windows. With a ``deadline`` runs also show the motion beyond each loss of stability, and
    `Response.open` has the speeds for which the time did not suffice.
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
    """A branch during the search: paths up and down from the first motion, and refined bifurcations.

    ``down`` is None where the path closes, or where the path starts at a period doubling. ``first_end`` is
    then the reason of the end at the first motion. ``found`` are the refined bifurcations, ``left`` the
    intervals between points in which bifurcations are still to be found.
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
        """Whether the branch continues, or has intervals without a search for bifurcations."""
        return "time" in self.ends or bool(self.left)

    def extend(self, deadline: Deadline) -> None:
        """Continue the paths that the deadline has ended."""
        before = len(self.path.orbits)
        down = 0 if self.down is None else len(self.down.orbits)
        for path, limit in ((self.up, deadline.share(0.5)), (self.down, deadline)):
            if path is not None and path.end == "time":
                self.along.extend(path, limit)
        # New points before the first point shift the indices of all other points.
        shift = 0 if self.down is None else len(self.down.orbits) - down
        self.found = [replace(b, place=b.place + shift) for b in self.found]
        self.left = [j + shift for j in self.left] + list(range(shift))
        self.left += range(shift + before - 1, len(self.path.orbits) - 1)

    def refine(self, distance: Callable[[float], float], deadline: Deadline) -> None:
        """Find the bifurcations in the remaining intervals.

        ``distance`` of a speed gives the order: the nearest interval comes first.
        """
        path = self.path
        order = sorted(self.left, key=lambda j: distance(1.0 / path.orbits[j].period))
        refined, self.left = bifurcations(self.along, path, order, deadline)
        self.found = sorted([*self.found, *refined], key=lambda b: int(b.place))

    def branch(self) -> Branch:
        """The branch up to the last motion of the paths."""
        orbits = tuple(with_bifurcations(self.along, self.path, self.found))
        return Branch(self.along.family, self.along.n, orbits, tuple(self.found), self.ends)


def merged(parts: Iterable[Window], inside: Window) -> tuple[Window, ...]:
    """Ranges within the range ``inside``, in order and without overlap."""
    result = list[Window]()
    for one, two in sorted(parts):
        start = max(one, inside[0])
        end = min(two, inside[1])
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
        full_range = self.limits.slowest, self.limits.fastest
        self.reported: Window = agenda.reported if agenda else full_range
        self.asked: list[Window] = sorted(agenda.windows, key=self._from_first) if agenda else [full_range]
        self.branches: list[Branch] = []
        self.settled: list[tuple[float, LongRun]] = []
        self.attractors: list[Attractor] = []
        self.behind: dict[Orbit, LongRun] = {}
        self.runs = 0
        #: Time of the present step, and time for following branches within this step.
        self.slot = self.following = deadline
        self._doubled: set[Orbit] = set()
        self._cut: dict[int, _Trace] = {}
        #: Windows and speeds 1/T with unfinished work.
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

    # Windows, and the unfinished parts of windows.

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
            # Up to the next window, in which other motions start.
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
        """Distance of a speed from the speed of most interest; 0 without such a speed."""
        return self.agenda.away(rate) if self.agenda else 0.0

    def _inside(self, rate: float) -> bool:
        return self.reported[0] <= rate <= self.reported[1]

    # The order of the search.

    def explore(self, seeds: int, progress: Progress | None = None) -> None:
        """Carry out the whole search, see `find_branches`."""
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
        """Follow the branches through the motion while all contacts hold, window by window."""
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
                complete = self.from_linear(window, partial(_tell, report, 0.0, 0.4 / count))
                self.look_behind(folds=True)
                touched = any(self._touches(trace, window) for trace in self._cut.values())
                again += [] if complete and not touched else [window]
            pending = again
            report(0.4 * (1.0 - len(pending) / count))
        self._late.update(pending)

    def finish(self) -> None:
        """Continue the branches that a deadline has cut, as long as there is time."""
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
        """Follow the branches that start at the motion while all contacts hold.

        Returns whether there was time for all starts.
        """
        rates = self.member.grid(STARTS)[::-1]
        if self.agenda is not None:
            rates = rates[(rates >= window[0]) & (rates <= window[1])]
            if rates.size < _LEAST_STARTS:
                rates = np.append(rates, np.geomspace(*window, _LEAST_STARTS + 2)[1:-1])
            if window[0] <= self.agenda.first <= window[1]:
                rates = np.append(rates, self.agenda.first)
            rates = np.array(sorted(rates, key=self._away))
        any_motion = False
        for j, rate in enumerate(map(float, rates)):
            # A branch that was cut may lead to the next start.
            if self.following.passed or any(self._touches(trace, window) for trace in self._cut.values()):
                return False
            state, parameter = self.start(1.0 / rate)
            any_motion |= self.follow_near(state, 1.0 / rate, 1, parameter)
            report((j + 1) / rates.size)
        if not any_motion:  # no claim about a window without any motion
            self._left += map(float, rates)
        return True

    def look_behind(self, folds: bool = False) -> None:
        """Let runs show the motion beyond each loss of stability, or beyond folds alone.

        Folds come first, because most jumps are at folds. A search without a limit of time starts no runs
        here: `ResponseBranches.losses` starts the runs when the jumps are read.
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
        """Losses of stability in the range beyond which no run was started."""
        return [
            (b, period)
            for branch in self.branches
            for b, period in self._of(branch)
            if b.orbit not in self.behind
        ]

    def _of(self, branch: Branch) -> list[tuple[Bifurcation, float]]:
        """Losses of stability of a branch in the range, computed once."""
        if branch not in self._losses:
            losses = lost_stability(branch)
            self._losses[branch] = [one for one in losses if self._inside(1.0 / one[0].orbit.period)]
        return self._losses[branch]

    # Isolated motions.

    def settle(self, rates: FloatArray, report: Callable[[float], None]) -> None:
        """Let runs settle at some speeds, and follow the branches of new motions."""
        starts = []
        for rate in map(float, rates):
            # The numbers at a speed do not depend on the range.
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
        """Whether a run has settled to a motion that no branch can have."""
        return run.run is not None and (run.orbit is None or run.orbit.n not in self.periods)

    def identify(self, motion: Motion) -> LongRun:
        """The exact motion of a settled run. The branch of a new periodic motion is followed."""
        orbits = self.response_at(1.0 / motion.rate)
        run = self.member.exactly(motion, orbits, self.deadline)
        if run.orbit is not None and run.orbit not in orbits:
            self.from_settled(run.orbit)
        elif run.orbit is None and run.run is not None:  # beats and chaos come near to unstable motions
            for n in sorted(self.periods - {1}):
                self.follow_near(run.run.end, 1.0 / motion.rate, n, run.parameter)
        return run

    def from_neighbour(self, other: _Search) -> None:
        """Look for the branches of a neighbouring system, with lengths and parameter in proportion."""
        for branch in list(other.branches):
            for part in range(_NEIGHBOURS):
                orbit = branch.orbits[(2 * part + 1) * len(branch.orbits) // (2 * _NEIGHBOURS)]
                start = orbit.start * (self.limits.length / other.limits.length)
                parameter = orbit.parameter * self.limits.parameter / other.limits.parameter
                self.follow_near(start, orbit.period, orbit.n, parameter)

    def subharmonics(self) -> None:
        """Look for motions of n cycles near large motions of one cycle at 1/n of the speed."""
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
        """Whether a motion lies on a branch that was found. The branch ``besides`` does not count."""
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
        """Whether there is a motion near a start.

        The branch of the motion is followed, unless the motion repeats after fewer cycles.
        """
        try:
            orbit = close_orbit(self.family.at(period), start, period, n, parameter)
        except NumericalError:
            return False
        if primitive(orbit) is orbit and not (n == 1 and self._calm(orbit)):
            self.both_ways(orbit)
        return True

    def from_settled(self, orbit: Orbit) -> None:
        """Follow the branch of a stable motion.

        A motion with too many cycles: the branch of the motion with fewer cycles from which it has doubled.
        """
        for n in sorted((n for n in self.periods if orbit.n % n == 0), reverse=True):
            if self.follow_near(orbit.start, orbit.period, n, orbit.parameter):
                return

    def both_ways(self, orbit: Orbit) -> None:
        """Add the branch through an orbit, unless the orbit lies on a branch that was found."""
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
        """Limits for motions of n cycles: several cycles are followed in the range of interest alone."""
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
        """Continue a branch that the deadline has cut. A branch that repeats another branch is dropped."""
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
        """Follow the branches of period doublings, for the numbers of cycles in ``periods``."""
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
        _, _, run = closing_residual(single.system, single.start, single.period, along.n, single.parameter)
        twice = Orbit(single.system, single.period, along.n, single.parameter, run)
        try:
            path = along.follow(twice, tangent=doubling_direction(along, single), deadline=self.following)
        except NumericalError:
            return
        self.add(_Trace(along, path, None, "doubling", [], []))
