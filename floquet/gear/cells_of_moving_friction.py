"""Cells of a chart between speeds at which breaks of the friction law move: proven by a bound on the gains.

Where a bound of law II or a regime of law V moves along the path, the monodromy matrix is no polynomial of
the speed. One fit of the gains then stands for an interval of speeds, and the integral of what mu deviates
from it is bounded (`FrictionBetweenSpeeds`). Where this bound leaves cells undecided, the interval is halved.

Sources: docs/theory/proven_bounds.md, "Between the nodes of a chart", "The nearest unstable speed".
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby, pairwise
from typing import NamedTuple

import numpy as np

from floquet.gear.axes import GEAR_AXES, GearVariation, LawOverSpeed
from floquet.gear.friction_between_speeds import Speeds
from floquet.gear.multipliers import OffLineOfAction
from floquet.gear.systems_between_speeds import SystemsBetweenSpeeds
from floquet.rank_one.boxes import PatchSize, proven_cells
from floquet.rank_one.period_search import PatchSystem
from lumped.friction.base import FrictionLaw
from lumped.typing import FloatArray, IntArray

#: An interval of speeds with several laws of friction is halved where the error of its matrices by gains that
#: deviate is above this, its width over its speed too, and more than this share of its parts is undecided.
_SMALL_ERROR = 1e-4
_NARROWEST = 5e-4
_WORTH = 0.05
#: Largest width over the speed of such an interval at first.
_WIDEST = 0.04
#: Where one law is in force: of the deviation, see `FrictionBetweenSpeeds.patch`. Cells need few digits.
_LOOSENESS = 30.0
_TYPICAL_GROWTH = 2.0  # of flows within a cycle


class CellParts(NamedTuple):
    """Numbers of parts along speed and along damping."""

    speed: int
    damping: int


def fades(off_line: OffLineOfAction) -> bool:
    """Whether all motions off the line of action die out: proven."""
    return bool((off_line.exponents.real + off_line.errors < 0.0).all())


def moving_friction_is_bounded(variation: GearVariation) -> bool:
    """Whether `SystemsBetweenSpeeds` has bounds for a variation: neither mean nor stiffness is varied."""
    return variation.friction_mean is None and variation.stiffness_variation == 1.0


def finer(values: FloatArray, count: int) -> FloatArray:
    """Increasing values with each interval cut into so many equal parts."""
    share = np.arange(count) / count
    parts = values[:-1, None] * (1.0 - share) + values[1:, None] * share
    return np.append(parts.ravel(), values[-1])


def verdicts_of_cells(of_parts: IntArray, parts: CellParts) -> IntArray:
    """Verdicts (N, M) of cells, each of which is cut into parts: the verdict of all parts, or 0."""
    n, m = of_parts.shape
    each = of_parts.reshape(n // parts.speed, parts.speed, m // parts.damping, parts.damping)
    lowest = each.min(axis=(1, 3))
    return np.asarray(np.where(lowest == each.max(axis=(1, 3)), lowest, 0))


class CellsOfMovingFriction:
    """Verdicts of cells between speeds whatever friction does in between.

    Parameters
    ----------
    variation : the pair; its mesh damping ratio is the unit of the damping
    ratios : (k,) ends of the parts of the damping
    parts : of each cell

    Attributes
    ----------
    narrowest : width over the speed of the interval with several laws that was proven last
    """

    def __init__(self, variation: GearVariation, ratios: FloatArray, parts: CellParts) -> None:
        self.variation = variation
        self.ratios = ratios
        self.parts = parts
        self.law = LawOverSpeed.of(variation)
        self.narrowest = _WIDEST
        self._systems: dict[FrictionLaw | None, SystemsBetweenSpeeds] = {}

    def verdicts(self, speeds: FloatArray, rows: IntArray) -> IntArray:
        """Verdicts (k, M) of the cells between speeds [i] and [i + 1] for all rows i (k,), increasing."""
        verdict = np.zeros((rows.size, self.parts.speed, self.ratios.size - 1), dtype=np.intp)
        for first, end in _adjoining(rows):
            edges = finer(speeds[rows[first] : rows[end - 1] + 2], self.parts.speed)
            verdict[first:end] = self.between(edges).reshape(verdict[first:end].shape)
        return verdicts_of_cells(verdict.reshape(-1, self.ratios.size - 1), self.parts)

    def between(self, speeds: FloatArray) -> IntArray:
        """Verdicts (k, parts of damping) between speeds (k+1,) that increase."""
        verdict = np.zeros((speeds.size - 1, self.ratios.size - 1), dtype=np.intp)
        at_speeds = [self.law.in_force(rpm) for rpm in speeds.tolist()]
        # The film grows with speed everywhere: a law in force at both ends is in force in between.
        laws = [low if low is high else None for low, high in pairwise(at_speeds)]
        first = 0
        for law, members in groupby(laws):
            end = first + len(list(members))
            each = self._of_one_law if law is not None else self._of_several_laws
            verdict[first:end] = each(speeds[first : end + 1])
            first = end
        return verdict

    def systems(self, law: FrictionLaw | None, rpm: float) -> SystemsBetweenSpeeds:
        """Systems where one law is in force, a speed of which is given; None: where several laws are."""
        if law not in self._systems:
            at_speed = GEAR_AXES["speed_rpm"].apply(self.variation, rpm)
            self._systems[law] = SystemsBetweenSpeeds(at_speed)
        return self._systems[law]

    def _of_one_law(self, speeds: FloatArray, looseness: float = _LOOSENESS) -> IntArray:
        """Verdicts between increasing speeds (k+1,) at all of which one law is in force.

        What wide intervals of speed leave undecided is proven again by narrow ones.
        """
        systems = self.systems(self.law.in_force(float(speeds[0])), float(speeds[0]))
        patches = [systems.friction.patch(*ends, looseness) for ends in pairwise(speeds.tolist())]
        verdict = np.zeros((len(patches), self.ratios.size - 1), dtype=np.intp)
        first = 0
        for _, members in groupby(patches, key=id):
            end = first + len(list(members))
            patch = patches[first]
            if patch is not None:
                ends = speeds[first : end + 1]
                of_patch = systems.of(patch)
                each = self.proven(systems, of_patch, ends)
                undecided = (each == 0).mean() > _WORTH
                if undecided and looseness > 1.0 and self._error(systems, of_patch, ends) > _SMALL_ERROR:
                    each = np.where(each == 0, self._of_one_law(ends, 1.0), each)
                verdict[first:end] = each
            first = end
        return verdict

    def _of_several_laws(self, speeds: FloatArray) -> IntArray:
        """Verdicts between increasing speeds (k+1,) where several laws are in force."""
        verdict = np.zeros((speeds.size - 1, self.ratios.size - 1), dtype=np.intp)
        first = 0
        width = _WIDEST
        while first < speeds.size - 1:
            end = int(np.searchsorted(speeds, speeds[first] * (1.0 + width), side="right")) - 1
            end = max(end, first + 1)
            verdict[first:end] = self._halved(speeds[first : end + 1])
            # Neighbouring intervals are likely to need the same width.
            width = min(2.0 * self.narrowest, _WIDEST)
            first = end
        return verdict

    def _halved(self, speeds: FloatArray) -> IntArray:
        """Verdicts between speeds (k+1,) by one fit; where too much is undecided, by one for each half."""
        systems = self.systems(None, float(speeds[0]))
        patch = systems.friction.bounded_change(Speeds(float(speeds[0]), float(speeds[-1])))
        verdict = np.zeros((speeds.size - 1, self.ratios.size - 1), dtype=np.intp)
        if patch is not None:
            of_patch = systems.of(patch)
            verdict = self.proven(systems, of_patch, speeds)
            self.narrowest = float(speeds[-1] / speeds[0]) - 1.0
            if (verdict == 0).mean() <= _WORTH or self._error(systems, of_patch, speeds) <= _SMALL_ERROR:
                return verdict
        if speeds[-1] <= speeds[0] * (1.0 + _NARROWEST):
            return verdict
        if speeds.size == 2:
            of_halves = verdicts_of_cells(self._in_halves(finer(speeds, 2)), CellParts(2, 1))
        else:
            of_halves = self._in_halves(speeds)
        return np.asarray(np.where(verdict == 0, of_halves, verdict))

    def _in_halves(self, speeds: FloatArray) -> IntArray:
        middle = speeds.size // 2
        return np.concatenate([self._halved(speeds[: middle + 1]), self._halved(speeds[middle:])])

    def proven(self, systems: SystemsBetweenSpeeds, of_patch: PatchSystem, speeds: FloatArray) -> IntArray:
        """Verdicts between increasing speeds (k+1,) that share one patch of friction."""
        periods = systems.period_times_rpm / speeds[::-1]
        factors, deviation = of_patch.factors, of_patch.deviation
        return proven_cells(of_patch.system, periods, self.ratios, factors, deviation=deviation)[::-1]

    def _error(self, systems: SystemsBetweenSpeeds, of_patch: PatchSystem, speeds: FloatArray) -> float:
        """What gains that deviate change in the matrices between speeds, about."""
        periods = systems.period_times_rpm / speeds[[-1, 0]]
        no_change = np.zeros((len(of_patch.system.parts), 1))
        size = PatchSize(of_patch.problem, _TYPICAL_GROWTH)
        return size.deviation(periods, self.ratios[[-1, -1]], no_change, of_patch.deviation)


def _adjoining(rows: IntArray) -> Iterator[tuple[int, int]]:
    """First index and end of runs of rows that follow each other."""
    return pairwise([0, *(1 + np.flatnonzero(np.diff(rows) > 1)).tolist(), rows.size])
