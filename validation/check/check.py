"""Check curves of another model, or a measured record, against both programs.

Sources: docs/how_to/check_your_model.md.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from lumped.arguments import real_number
from lumped.labelling import labelled_dataset, provenance
from lumped.model.periodic_system import Supports, with_supports
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from validation.check.curves import Curves
from validation.check.ladder import Explanation, Ladder, climb
from validation.check.mesh_frequency import SAME
from validation.check.misfit import Misfit
from validation.check.motion_curves import MotionCurves
from validation.check.problem import Problem
from validation.check.reference import lumped_motion, multibody_motion

if TYPE_CHECKING:
    import xarray as xr

#: Default limit of the misfit.
LIMIT = 0.05
#: Default processor time of the search for explanations [s].
BUDGET = 60.0
#: A change between the last two blocks of cycles above this share of the motion is no settled motion.
_SETTLED = 0.01
#: Unit attribute of a variable whose channels differ in their unit.
_BY_CHANNEL = "SI, by channel"


class Verdict(Enum):
    """Verdict of a check. The value is the word that a user reads."""

    AGREES = "agrees"
    DIFFERS = "differs"
    NOT_COMPARABLE = "not comparable"


@dataclass(frozen=True, eq=False)
class Check:
    """Another model of a gear pair beside both programs.

    Attributes
    ----------
    problem : the curves and our motion of the pair
    limit : misfit up to which the curves agree
    second : misfit of the curves and the motion of the multibody model; None: it has no motion there
    discrepancy : misfit of the multibody model and our motion, at the channels of the curves; NaN: no motion
    ladder : search for explanations
    remarks : sentences on the curves: what was assumed, what was not compared
    """

    problem: Problem
    limit: float
    second: Misfit | None
    discrepancy: float
    ladder: Ladder
    remarks: tuple[str, ...]

    @property
    def pair(self) -> GearPair:
        """The gear pair of the reference."""
        return self.problem.pair

    @property
    def misfit(self) -> float:
        """Misfit of the curves, against the nearer of both programs."""
        return min(self.problem.misfit.value, math.inf if self.second is None else self.second.value)

    @property
    def verdict(self) -> Verdict:
        """AGREES up to the limit. NOT_COMPARABLE where both programs differ by more than the curves do."""
        time_is_right = abs(self.problem.frequency.factor - 1.0) <= SAME
        if self.misfit <= self.limit:
            return Verdict.AGREES if time_is_right else Verdict.DIFFERS
        return Verdict.NOT_COMPARABLE if self.misfit <= self.discrepancy else Verdict.DIFFERS

    @property
    def explanations(self) -> tuple[Explanation, ...]:
        """Steps of the ladder, in the order in which they were taken."""
        return self.ladder.steps

    @cached_property
    def channels(self) -> xr.Dataset:
        """Dataset over ``channel``: peaks to peak, means, misfits, and the order that differs most."""
        rows = self.problem.misfit.channels
        by_second = [math.nan] * len(rows)
        if self.second is not None:
            by_second = [row.total for row in self.second.channels]
        worst = [int(np.abs(row.channel.orders.values - row.ours.values).argmax()) for row in rows]
        columns = {
            "quantity": ([row.channel.channel.quantity for row in rows], "1", "quantity"),
            "units": ([row.channel.channel.kind.unit for row in rows], "1", "SI unit of the channel"),
            "their_peak_to_peak": (
                [row.channel.orders.peak_to_peak for row in rows],
                _BY_CHANNEL,
                "their peak to peak",
            ),
            "our_peak_to_peak": ([row.ours.peak_to_peak for row in rows], _BY_CHANNEL, "our peak to peak"),
            "their_mean": ([row.channel.orders.mean for row in rows], _BY_CHANNEL, "their mean"),
            "our_mean": ([row.ours.mean for row in rows], _BY_CHANNEL, "our mean"),
            "misfit": ([row.total for row in rows], "1", "misfit of orders and mean"),
            "misfit_of_mean": (
                [row.mean for row in rows],
                "1",
                "difference of the means over the static value",
            ),
            "second": (by_second, "1", "misfit against the multibody model"),
            "worst_order": (
                [float(row.ours.orders[j]) for row, j in zip(rows, worst, strict=True)],
                "1",
                "mesh order that differs most",
            ),
        }
        return labelled_dataset(
            {name: ("channel", values, unit, words) for name, (values, unit, words) in columns.items()},
            {"channel": ([row.channel.channel.name for row in rows], "1", "channel")},
            provenance(self.pair)
            | {name: self.problem.motion.motion.attrs[name] for name in ("teeth", "contact", "supports")}
            | {"shift": self.problem.misfit.shift, "misfit": self.misfit},
        )


def check(
    pair: AnyPair,
    theirs: Any,
    *,
    limit: float = LIMIT,
    explain: bool = True,
    budget: float = BUDGET,
    supports: Supports | None = None,
) -> Check:
    """Check curves of another model, or a measured record, against both programs.

    Parameters
    ----------
    pair : gear pair, preset name or parameter file, at the speed and torque of the curves
    theirs : the curves
    limit : misfit up to which the curves agree; 0.05 is 5 %
    explain : whether explanations of a difference are searched
    budget : processor time of this search [s]
    supports : "springs", the four of ``bearings``, or "shafts", the elastic ones of ``shafts``; by default
        the shafts of a pair that has them

    Returns
    -------
    Check: ``verdict``, ``misfit``, ``channels``, ``explanations``

    Raises
    ------
    ParameterError : curves that cannot be read or compared; the text says what to change
    """
    gear_pair = with_supports(load_gear_pair(pair), supports)
    allowed = real_number("limit", limit, 0.0, 1.0, above=True, action="Give a share: 5 % is 0.05.")
    seconds = real_number("budget", budget, 0.0, unit="s")
    if not isinstance(theirs, Curves):
        raise NotImplementedError
    motion = lumped_motion(gear_pair, theirs.recurrence)
    problem = Problem.of(gear_pair, theirs, motion)
    second, discrepancy = _second(problem, motion)
    ladder = Ladder(problem.misfit.value, (), motion, 0, complete=True)
    differs = min(problem.misfit.value, math.inf if second is None else second.value) > allowed
    if explain and (differs or abs(problem.frequency.factor - 1.0) > SAME):
        ladder = climb(problem, limit=allowed, budget=seconds)
    return Check(problem, allowed, second, discrepancy, ladder, _remarks(problem))


def _second(problem: Problem, motion: MotionCurves) -> tuple[Misfit | None, float]:
    """Misfit of the curves against the multibody model, and of both programs of ours."""
    other = multibody_motion(problem.pair, motion)
    if other is None:
        return None, math.nan
    misfit = problem.misfit_with(other)
    names = [row.channel for row in problem.misfit.channels]
    ours = tuple(
        one._replace(orders=row.ours) for one, row in zip(names, problem.misfit.channels, strict=True)
    )
    return misfit, problem.misfit_with(other, ours).value


def _remarks(problem: Problem) -> tuple[str, ...]:
    """Sentences on the curves: not settled, means that were removed, few orders."""
    remarks = []
    change = problem.settled.change
    if change > _SETTLED:
        remarks.append(
            f"The motion has not settled: the last cycles change by {100.0 * change:.2g} %. Run it longer."
        )
    removed = [
        row.channel.channel.name
        for row in problem.misfit.channels
        if problem.means and row.channel.channel.kind.has_mean and not row.compares_mean
    ]
    if removed:
        remarks.append(f"Without their means, which were removed: {', '.join(removed)}.")
    return tuple(remarks)
