"""Stability over the period at one damping, proven outwards from one period until an unstable one is proven.

Patches of periods adjoin each other on both sides of the first period. On each patch the monodromy matrix is
a polynomial with a bound on its error. Intervals of the patch are halved until each of them is proven or very
narrow. Intervals that stay undecided are part of the result.

Sources: docs/theory/proven_bounds.md, "The nearest unstable speed".
"""

from __future__ import annotations

import math
from bisect import bisect_left
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from floquet.rank_one.boxes import (
    Factors,
    FlowPolynomial,
    GainDeviation,
    IntervalBoxes,
    NodeCounts,
    PatchSize,
    decided_intervals,
)
from floquet.rank_one.kernels.gains import Problem
from floquet.rank_one.system import RankOneSystem
from lumped.typing import FloatArray, IntArray

_NODES = NodeCounts(24, 1)
_DAMPING = np.ones(2)  # the damping of the system
#: Largest error of the polynomial of a patch, by gains that deviate, and of its matrices in each step.
_TOLERANCE = 1e-8
_DEVIATION_TOLERANCE = 1e-5
_STEP_TOLERANCE = 1e-13
#: Largest ratio of the error by gains that deviate at the end of a patch to that at its beginning, and how
#: often a patch is halved for this error.
_DEVIATION_GROWTH = 4.0
_NARROWINGS = 6
#: Widths of a patch over its first period, of which the largest is taken that the tolerance allows.
_WIDTHS = np.geomspace(1e-5, 1.0, 81)
#: An interval narrower than this part of its period is not halved.
_NARROWEST = 1e-7
#: Places in a patch at which single periods are judged before intervals are halved.
_LOOKS = np.array([-0.9, -0.3, 0.1, 0.5, 0.95])
_FIRST_GROWTH = 2.0
_LARGEST_GROWTH = 10.0
#: Patches on each side that are decided together, at most.
_TOGETHER = 8


class PatchSystem(NamedTuple):
    """A system that holds for a patch of periods.

    Attributes
    ----------
    system, problem : the system, and the same in the form of the kernels
    factors : on the varied gains, powers of the period or linear in its logarithm
    deviation : of the gains that are meant
    work : 1, or more where the system was fitted for this patch
    """

    system: RankOneSystem
    problem: Problem
    factors: Factors
    deviation: GainDeviation
    work: int = 1


class SystemOverPeriod(Protocol):
    """Systems for patches of periods.

    Attributes
    ----------
    widest : largest width of a patch over its shorter period
    """

    widest: float

    def __call__(self, shortest: float, longest: float) -> PatchSystem | None:
        """The system for all periods of a patch [s]; None: no system is known for the patch."""
        ...


class Effort(NamedTuple):
    """Largest amount of work of a search.

    Attributes
    ----------
    vibrations : sum over all patches of the vibrations of the fastest mode in their longest period
    intervals : number of intervals that are judged
    patches : sum of the work of all patches, see `PatchSystem`
    """

    vibrations: float
    intervals: int
    patches: int


class PeriodVerdicts(NamedTuple):
    """Verdicts of adjoining intervals of periods, increasing.

    Attributes
    ----------
    low, high : (k,) ends [s]
    verdict : (k,) 1 stable, -1 unstable everywhere in the interval, 0 not proven
    """

    low: FloatArray
    high: FloatArray
    verdict: IntArray


def no_verdicts() -> PeriodVerdicts:
    """Verdicts of no interval at all."""
    return PeriodVerdicts(np.empty(0), np.empty(0), np.empty(0, dtype=np.intp))


@dataclass
class _Side:
    """Patches on one side of the first period, from the inside outwards.

    Attributes
    ----------
    front, end : where the next patch begins, and where the last patch ends [s]
    growth : bound on all flows of the last patch
    """

    front: float
    end: float
    growth: float = _FIRST_GROWTH

    @property
    def done(self) -> bool:
        return self.front == self.end

    def ends(self, width: float) -> FloatArray:
        """Ends (2,) of a patch, increasing, of a width over the shorter period."""
        if self.end > self.front:
            return np.array([self.front, min(self.front * (1.0 + width), self.end)])
        return np.array([max(self.front / (1.0 + width), self.end), self.front])

    def next_ends(self, inner: PatchSystem, widest: float) -> FloatArray:
        """Ends (2,) of the next patch, the widest of small error if flows grow as in the last patch.

        ``inner``: the system at the front.
        """
        size = PatchSize(inner.problem, self.growth)
        widths = np.append(_WIDTHS[widest > _WIDTHS], widest)
        at_front = self.by_deviation(self.ends(0.0), inner)
        largest = max(_DEVIATION_TOLERANCE, _DEVIATION_GROWTH * at_front)

        def error(width: float) -> float:
            ends = self.ends(width)
            by_polynomial = size.error(ends, _DAMPING, nodes=_NODES)
            return max(by_polynomial / _TOLERANCE, self.by_deviation(ends, inner) / largest)

        index = bisect_left(range(widths.size), 1.0, key=lambda i: error(float(widths[i])))
        return self.ends(float(widths[max(index - 1, 0)]))

    def by_deviation(self, ends: FloatArray, patch: PatchSystem) -> float:
        """Error of the monodromy matrix of a patch by gains that deviate, if factors do not change."""
        size = PatchSize(patch.problem, self.growth)
        no_change = np.zeros((len(patch.system.parts), 1))
        return size.deviation(ends, _DAMPING, no_change, patch.deviation)


class _Patch(NamedTuple):
    """A patch of periods: its ends (2,) [s], and the monodromy matrix."""

    ends: FloatArray
    polynomial: FlowPolynomial


class _Search:
    """The search of `proven_periods`.

    Attributes
    ----------
    decided : intervals that are proven, or not halved any more, in no order
    nearest : distance of the nearest unstable interval
    """

    def __init__(self, systems: SystemOverPeriod, start: float, effort: Effort) -> None:
        self.systems = systems
        self.start = start
        self.effort = effort
        self.vibrations = 0.0
        self.intervals = 0
        self.patches = 0
        self.decided: list[PeriodVerdicts] = []
        self.nearest = math.inf

    def distance(self, low: FloatArray, high: FloatArray) -> FloatArray:
        """Distance (k,) of intervals of periods from the first period, as a distance of speeds [1/s]."""
        inverse = 1.0 / self.start
        return np.asarray(np.maximum(np.maximum(1.0 / high - inverse, inverse - 1.0 / low), 0.0))

    def patch(self, side: _Side) -> _Patch | None:
        """The next patch of a side; None: no system is known beyond, and the side ends."""
        inner = self.systems(side.front, side.front)
        if inner is None:
            return None
        ends = side.next_ends(inner, self.systems.widest)
        of_patch = self.systems(*ends.tolist())
        largest = _DEVIATION_GROWTH * max(_DEVIATION_TOLERANCE, side.by_deviation(ends, inner))
        for _ in range(_NARROWINGS):  # beyond the front a law may change faster
            if of_patch is not None and side.by_deviation(ends, of_patch) <= largest:
                break
            ends = side.ends(0.5 * float(ends[1] / ends[0] - 1.0))
            of_patch = self.systems(*ends.tolist())
        if of_patch is None:
            return None
        polynomial = FlowPolynomial.of(
            of_patch.system, of_patch.problem, ends, _DAMPING, of_patch.factors, _NODES,
            tolerance=_STEP_TOLERANCE, deviation=of_patch.deviation,
        )  # fmt: skip
        if polynomial is None:
            return None
        self.vibrations += float(of_patch.problem.omega.max() * ends[1]) / (2.0 * math.pi)
        self.patches += inner.work + of_patch.work - 1
        side.growth = min(1.1 * polynomial.growth, _LARGEST_GROWTH)
        return _Patch(ends, polynomial)

    def next_patches(self, sides: list[_Side], most: int) -> list[_Patch]:
        """Patches of each side, nearer than the nearest unstable interval.

        A side ends at a patch in which none of some single periods is decided: no interval would be either.
        """
        patches = []
        for side in sides:
            for _ in range(most):
                front = np.array([side.front])
                if side.done or float(self.distance(front, front)[0]) >= self.nearest:
                    break
                patch = self.patch(side)
                if patch is None or not _decided_somewhere(patch.polynomial):
                    side.end = side.front
                    break
                side.front = float(patch.ends[1] if side.end > side.front else patch.ends[0])
                patches.append(patch)
        return patches

    def decide(self, patches: list[_Patch]) -> None:
        """Judge intervals of patches, and halve those that are not decided."""
        ends = np.array([patch.ends for patch in patches])
        polynomials = [patch.polynomial for patch in patches]
        count = len(patches)
        boxes = IntervalBoxes(np.arange(count), np.full(count, -1.0), np.ones(count))
        while boxes.patch.size:
            verdict = decided_intervals(polynomials, boxes)
            self.intervals += verdict.size
            first, last = ends[boxes.patch].T
            middle = 0.5 * (first + last)
            half = 0.5 * (last - first)
            low = np.where(boxes.low == -1.0, first, middle + half * boxes.low)
            high = np.where(boxes.high == 1.0, last, middle + half * boxes.high)
            distance = self.distance(low, high)
            self.nearest = min(self.nearest, float(distance[verdict < 0].min(initial=math.inf)))
            divided = (verdict == 0) & (distance < self.nearest) & (high - low > _NARROWEST * high)
            divided &= self.intervals < self.effort.intervals
            self.decided.append(PeriodVerdicts(low[~divided], high[~divided], verdict[~divided]))
            boxes = _halves(IntervalBoxes(*(values[divided] for values in boxes)))

    @property
    def spent(self) -> bool:
        """Whether the effort is spent."""
        vibrations, intervals, patches = self.effort
        return self.vibrations >= vibrations or self.intervals >= intervals or self.patches >= patches


def _decided_somewhere(polynomial: FlowPolynomial) -> bool:
    """Whether any of some single periods of a patch is decided."""
    boxes = IntervalBoxes(np.zeros(_LOOKS.size, dtype=np.intp), _LOOKS, _LOOKS)
    return bool(decided_intervals([polynomial], boxes).any())


def _halves(boxes: IntervalBoxes) -> IntervalBoxes:
    """Both halves of each interval."""
    patch, low, high = boxes
    middle = 0.5 * (low + high)
    return IntervalBoxes(
        np.concatenate([patch, patch]), np.concatenate([low, middle]), np.concatenate([middle, high])
    )


def proven_periods(
    systems: SystemOverPeriod, ends: tuple[float, float], start: float, slow: float, effort: Effort
) -> PeriodVerdicts:
    """PROVEN verdicts of intervals of periods about ``start``, up to the nearest unstable one.

    Distances are distances of speed, 1/T. Intervals beyond the nearest unstable period are left out, and so
    are intervals beyond the largest effort.

    Parameters
    ----------
    systems : the systems, with the damping that they have
    ends : shortest and longest period [s]
    start : period [s] between the ends
    slow : period [s] from which on the system is stable, of `slow_period`; inf: no such period is known
    effort : largest amount of work
    """
    search = _Search(systems, start, effort)
    slow = max(slow, start)
    sides = [_Side(start, ends[0]), _Side(start, min(slow, ends[1]))]
    if slow < ends[1]:
        search.decided.append(PeriodVerdicts(np.array([slow]), np.array([ends[1]]), np.array([1])))
    together = 1
    while not search.spent:
        patches = search.next_patches(sides, together)
        if not patches:
            break
        search.decide(patches)
        together = min(2 * together, _TOGETHER)
    return _about_start(search)


def _about_start(search: _Search) -> PeriodVerdicts:
    """Intervals that adjoin each other about the first period, no farther than the nearest unstable one."""
    if not search.decided:
        return no_verdicts()
    everything = (np.concatenate(values) for values in zip(*search.decided, strict=True))
    low, high, verdict = everything
    order = np.argsort(low)
    order = order[search.distance(low, high)[order] <= search.nearest]
    low, high, verdict = low[order], high[order], verdict[order]
    group = np.cumsum(np.append(True, low[1:] != high[:-1]))
    about = (low <= search.start) & (search.start <= high)
    if not about.any():
        return no_verdicts()
    chosen = group == group[about.argmax()]
    return PeriodVerdicts(low[chosen], high[chosen], verdict[chosen])
