"""Slices of a chart: points that differ in speed, mesh damping and mean friction only share one fit.

Sources: docs/theory/floquet.md, "Computing M".
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from floquet.engine.chart import NodeResults, Wanted, node_results
from floquet.gear.axes import (
    GEAR_AXES,
    FrictionFamily,
    GearVariation,
    friction_families,
    operating_rpm,
    vary,
)
from floquet.gear.cells_of_moving_friction import (
    CellParts,
    CellsOfMovingFriction,
    fades,
    finer,
    moving_friction_is_bounded,
    verdicts_of_cells,
)
from floquet.gear.multipliers import (
    Feedback,
    FeedbackMultipliers,
    OffLineOfAction,
    corners_push_apart,
    feedback_system,
    fitted_block,
    stays_bounded,
    stays_symmetric,
)
from floquet.rank_one.batch import fast_multipliers
from floquet.rank_one.boxes import proven_cells
from floquet.rank_one.system import RankOneSystem
from lumped.typing import FloatArray, IntArray, Progress

#: Of a chart with proven cells; a part is proven as a whole.
_FEWEST_PARTS = CellParts(800, 200)


class SlicePart(NamedTuple):
    """Some points of a slice.

    Attributes
    ----------
    slice_number : number of the slice in the chart
    point : values of the axes that all points of the slice share
    places : (k,) places of the points in the chart
    indices : inner axis -> (k,) indices of its values
    """

    slice_number: int
    point: Mapping[str, float]
    places: IntArray
    indices: Mapping[str, IntArray]


class _FamilyBlock(NamedTuple):
    """Common data of all speeds of one friction family.

    Attributes
    ----------
    system : the feedback block
    separate : motions that the mesh does not couple
    levels : number of the parts of the gains that have a factor of friction
    period_times_rpm : mesh period [s] times pinion speed [rpm]
    feedback : the coordinates of the system
    """

    system: RankOneSystem
    separate: OffLineOfAction
    levels: int
    period_times_rpm: float
    feedback: Feedback


class ChartSlice:
    """Points of a chart that differ in speed, mesh damping and mean friction only.

    Damping only scales wd. The mean friction coefficient only scales the part of w by friction. Speed only
    changes the period; with many friction laws speed scales friction too. Therefore one fit of the feedback
    block serves all points of the slice.

    Parameters
    ----------
    variation : of the chart
    grid : name -> values of its axes
    inner : names of the axes along which points of the slice differ
    point : values of the other axes
    """

    def __init__(
        self,
        variation: GearVariation,
        grid: Mapping[str, FloatArray],
        inner: list[str],
        point: Mapping[str, float],
    ) -> None:
        largest_friction = (
            float(grid["friction_coefficient"].max()) if "friction_coefficient" in inner else 1.0
        )
        # Damping and friction of the reference, to which the factors of the slice relate.
        references = {"damping_ratio": 1.0, "friction_coefficient": largest_friction}
        self.reference = vary(variation, {**point, **{n: references[n] for n in inner if n in references}})
        operating_speed = np.array([operating_rpm(self.reference.pair)])
        self.speeds = grid["speed_rpm"] if "speed_rpm" in inner else operating_speed
        self.damping = grid["damping_ratio"] if "damping_ratio" in inner else np.ones(1)
        self.friction = (
            grid["friction_coefficient"] / largest_friction if "friction_coefficient" in inner else np.ones(1)
        )
        self._blocks: dict[int, _FamilyBlock] = {}

    @cached_property
    def families(self) -> list[FrictionFamily]:
        """Families of speeds. Friction needs only one fit for a family."""
        return friction_families(self.reference, self.speeds)

    @cached_property
    def _rows(self) -> tuple[IntArray, IntArray]:
        """Number of the family of each speed, and the row of the speed in this family."""
        family = np.empty(self.speeds.size, dtype=np.intp)
        row = np.empty(self.speeds.size, dtype=np.intp)
        for k, one in enumerate(self.families):
            family[one.members] = k
            row[one.members] = np.arange(one.members.size)
        return family, row

    def _block(self, k: int, rtol: float) -> _FamilyBlock:
        """Fit the feedback block of family k once."""
        if k not in self._blocks:
            family = self.families[k]
            variation = GEAR_AXES["speed_rpm"].apply(self.reference, family.speed_rpm)
            feedback = feedback_system(variation)
            levels = [] if variation.pair.friction.law == "none" else [0.0]
            levels += [] if family.level is None else [family.level]
            block = fitted_block(feedback, variation.stiffness_variation, max(0.01 * rtol, 1e-12), levels)
            period_times_rpm = block.period * operating_rpm(variation.pair)
            self._blocks[k] = _FamilyBlock(
                block, OffLineOfAction.of(feedback), len(levels), period_times_rpm, feedback
            )
        return self._blocks[k]

    def cells(self, rtol: float, progress: Progress | None) -> IntArray:
        """Verdicts (N-1, M-1) of the cells between neighbouring speeds and damping ratios, `proven_cells`.

        Between speeds of one family of friction, between which factors are smooth, the gains are known
        exactly. Between other speeds breaks of the gains move with friction, and a bound on the deviation of
        the gains counts, see `CellsOfMovingFriction`.
        """
        order = np.argsort(self.speeds)
        speeds = self.speeds[order]
        damping = np.sort(self.damping)
        verdict = np.zeros((speeds.size - 1, damping.size - 1), dtype=np.intp)
        smooth = np.zeros(speeds.size - 1, dtype=bool)
        # Motions that the mesh does not couple must die out, too: else only instability can be proven.
        separate_fade = fades(self._block(0, rtol).separate)
        fewest = _FEWEST_PARTS if separate_fade else CellParts(1, 1)
        parts = CellParts(*(-(-n // (v.size - 1)) for n, v in zip(fewest, (speeds, damping), strict=True)))
        ratios = finer(damping, parts.damping)
        family_of_speed = self._rows[0][order]
        for i, j in self._smooth_runs(speeds, family_of_speed):
            family = self.families[family_of_speed[i]]
            block = self._block(int(family_of_speed[i]), rtol)

            def factors(
                T: FloatArray, block: _FamilyBlock = block, family: FrictionFamily = family
            ) -> FloatArray | None:
                result = family.factors_at(block.period_times_rpm / T)
                return None if result is None else result[:, : block.levels]

            periods = block.period_times_rpm / finer(speeds[i:j], parts.speed)[::-1]
            result = proven_cells(block.system, periods, ratios, factors, progress)[::-1]
            verdict[i : j - 1] = verdicts_of_cells(result, parts)
            smooth[i : j - 1] = True
        if not smooth.all() and moving_friction_is_bounded(self.reference):
            moving = CellsOfMovingFriction(self.reference, ratios, parts)
            verdict[~smooth] = moving.verdicts(speeds, np.flatnonzero(~smooth))
        return verdict if separate_fade else np.minimum(verdict, 0)

    def _smooth_runs(self, speeds: FloatArray, family_of_speed: IntArray) -> Iterator[tuple[int, int]]:
        """First index and end of runs of two or more neighbouring speeds in which factors are smooth."""
        for i, j in _runs(family_of_speed):
            family = self.families[family_of_speed[i]]
            for first, end in _runs(family.smooth_groups(speeds[i:j])):
                if end - first > 1:
                    yield i + first, i + end

    def solve(
        self, places: IntArray, indices: Mapping[str, IntArray], wanted: Wanted, rtol: float
    ) -> Iterator[NodeResults]:
        """Yield the results at places (k,), one record for each family of friction.

        ``indices`` maps each inner axis to the indices (k,) of its values.
        """
        zeros = np.zeros(places.size, dtype=np.intp)
        speed = indices.get("speed_rpm", zeros)
        damping = self.damping[indices.get("damping_ratio", zeros)]
        friction = self.friction[indices.get("friction_coefficient", zeros)]
        family_of_speed, row_in_family = self._rows
        for number in np.unique(family_of_speed[speed]):
            members = np.flatnonzero(family_of_speed[speed] == number)
            family = self.families[number]
            block = self._block(int(number), rtol)
            T = block.period_times_rpm / self.speeds[speed[members]]
            factors = friction[members, None] * family.factors[row_in_family[speed[members]]]
            result = fast_multipliers(
                block.system, T, damping[members], factors[:, : block.levels], tolerance=2e-4 * rtol
            )
            separate, separate_errors = block.separate.multipliers(T)
            values = np.concatenate([result.multipliers, separate], axis=1)
            errors = np.concatenate([result.errors, separate_errors], axis=1)
            undamped = damping[members] * self.reference.pair.mesh.damping_ratio == 0.0
            rubs = factors[:, : block.levels].any(axis=1)
            symplectic = undamped & stays_symmetric(block.feedback, self.reference.supports, rubs)
            feedback = FeedbackMultipliers(result.multipliers, result.errors, symplectic)
            driven = corners_push_apart(block.feedback)
            neutral = stays_bounded(feedback, block.separate, T, driven=driven)
            coupled = result.multipliers.shape[1]
            yield node_results(places[members], values, errors, True, wanted, coupled, neutral)


def _runs(numbers: IntArray) -> Iterator[tuple[int, int]]:
    """First index and end of runs of equal numbers."""
    return pairwise([0, *(1 + np.flatnonzero(np.diff(numbers))).tolist(), numbers.size])


def solve_slice(
    variation: GearVariation,
    grid: Mapping[str, FloatArray],
    inner: list[str],
    point: Mapping[str, float],
    places: IntArray,
    indices: Mapping[str, IntArray],
    wanted: Wanted,
    rtol: float,
) -> list[NodeResults]:
    """Results of some points of a slice, see `ChartSlice`."""
    return list(ChartSlice(variation, grid, inner, point).solve(places, indices, wanted, rtol))
