"""Check curves of another model, or a measured record, against both programs.

Sources: docs/how_to/check_your_model.md.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from lumped.arguments import real_number
from lumped.display.progress import reported_to, shows_progress
from lumped.display.result import DisplayedResult, no_variables
from lumped.errors import NumericalError, refuse
from lumped.labelling import labelled_dataset
from lumped.model.averaged import natural_frequencies
from lumped.model.periodic_system import Supports, with_supports
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import ProgressRequest
from validation.check.agreeing import TRANSIENT, drifting, of_agreeing, turning, without_means
from validation.check.curves import Curves, Role, ValuesOverSpeed
from validation.check.digits import coarse_step
from validation.check.explanations.left_out import CHANGES
from validation.check.ladder import Explanation, Ladder, climb
from validation.check.mesh_frequency import SAME
from validation.check.misfit import LIMIT, Misfit
from validation.check.motion_curves import MotionCurves
from validation.check.origin import origin
from validation.check.over_speed import SpeedMisfit, speed_misfit
from validation.check.overlay import figure_data
from validation.check.problem import Problem
from validation.check.reading.other_model import OtherModel, other_model
from validation.check.reading.reader import read
from validation.check.reference import REFERENCE_SAMPLES, lumped_motion, multibody_motion
from validation.check.samples import difference_at_no_order, peaks_to_peak
from validation.check.static import StaticRung, static_rung
from validation.check.words import (
    ladder_words,
    low_speed_failure,
    motion_failure,
    percent,
    speed_failure,
    static_failure,
    subject,
)
from validation.files.formatting import quantity

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

#: Default processor time of the search for explanations [s].
BUDGET = 40.0
#: A change of the motion with half the step above this share: the step is too long.
_RESOLVED = 0.01
#: Mesh frequency of the rung at low speed over the lowest natural frequency: the motion is nearly static.
_LOW = 1.0 / 12.0
#: Unit attribute of a variable whose channels differ in their unit.
_BY_CHANNEL = "SI, by channel"


class Verdict(Enum):
    """Verdict of a check. The value is the word that a user reads."""

    AGREES = "agrees"
    DIFFERS = "differs"
    NOT_COMPARABLE = "not comparable"


class Rung(Enum):
    """Part of a check, from the simplest to the whole motion. The first rung that fails is the verdict."""

    STATIC = "static"
    LOW_SPEED = "low speed"
    MOTION = "motion"
    OVER_SPEED = "over speed"


@dataclass(frozen=True, eq=False, repr=False)
class Check(DisplayedResult):
    """Another model of a gear pair beside both programs.

    Attributes
    ----------
    pair : gear pair of the reference, at the speed and torque of the curves
    name : name of the other model or record
    role : "model" or "measurement"
    limit : misfit up to which the curves agree, a share of the motion
    static : static quantities that the other model states or shows
    low_speed : motion of a model that can be called, at a speed at which the motion is nearly static
    problem : the curves and our motion of the pair; None: no curves at one speed
    over_speed : values over speed beside ours; None: none were given
    second : misfit of the curves and the motion of the multibody model; None: it has no motion there
    discrepancy : misfit of the multibody model and our motion, at the channels of the curves; NaN: no motion
    ladder : search for explanations; None: the motion agrees, or no explanations were asked for. A motion
        that agrees has one where what is not compared shows a mistake, such as a transient
    remarks : sentences on the curves: what was assumed, what was not compared
    """

    shown: ClassVar = (
        "verdict",
        "misfit",
        "limit",
        "failed",
        "name",
        "role",
        "discrepancy",
        "explanations",
        "remarks",
    )

    pair: GearPair
    name: str
    role: Role
    limit: float
    static: StaticRung
    low_speed: Problem | None
    problem: Problem | None
    over_speed: SpeedMisfit | None
    second: Misfit | None
    discrepancy: float
    ladder: Ladder | None
    remarks: tuple[str, ...]

    @property
    def misfit(self) -> float:
        """Misfit of the motion or of the values over speed, against the nearer of both programs.

        NaN: only static quantities were given.
        """
        if self.over_speed is not None:
            return self.over_speed.value
        return math.nan if self.problem is None else self.nearer.value

    @property
    def nearer(self) -> Misfit:
        """Misfit of the channels against the nearer of both programs.

        Raises
        ------
        ParameterError : no curves at one speed
        """
        if self.problem is None:
            raise refuse(
                "nearer", "no curves at one speed", "a check of curves", "Read .static or .over_speed."
            )
        first = self.problem.misfit
        return first if self.second is None or first.value <= self.second.value else self.second

    @property
    def failed(self) -> Rung | None:
        """The first rung that fails; None: no rung fails."""
        if not self.static.agrees:
            return Rung.STATIC
        if self.low_speed is not None and self.low_speed.misfit.value > self.limit:
            return Rung.LOW_SPEED
        if self.problem is not None:
            time_is_right = abs(self.problem.frequency.factor - 1.0) <= SAME
            return None if self.misfit <= self.limit and time_is_right else Rung.MOTION
        return Rung.OVER_SPEED if self.over_speed is not None and self.misfit > self.limit else None

    @property
    def verdict(self) -> Verdict:
        """AGREES where no rung fails; NOT_COMPARABLE where both programs differ by more than the curves."""
        if self.failed is None:
            return Verdict.AGREES
        within = self.failed is Rung.MOTION and self.limit < self.misfit <= self.discrepancy
        return Verdict.NOT_COMPARABLE if within else Verdict.DIFFERS

    @property
    def agrees(self) -> bool:
        """Whether the verdict is AGREES."""
        return self.verdict is Verdict.AGREES

    @property
    def explanations(self) -> tuple[Explanation, ...]:
        """Steps of the ladder, in the order in which they were taken."""
        return () if self.ladder is None else self.ladder.steps

    @property
    def words(self) -> str:
        """The verdict in sentences: misfit and limit, what fails, what the curves are compatible with."""
        who = subject(self.role)
        verb = "agrees" if self.agrees else "differs"
        size = (
            "" if math.isnan(self.misfit) else f": misfit {percent(self.misfit)}, limit {percent(self.limit)}"
        )
        if self.verdict is Verdict.NOT_COMPARABLE:
            sentence = (
                f"Not comparable: {who[0].lower()}{who[1:]} differs by {percent(self.misfit)}, but both "
                f"programs of spurcheck differ by {percent(self.discrepancy)} here."
            )
            explained = self.ladder is not None and self.ladder.steps
            return (
                f"{sentence} {ladder_words(self.ladder, self.limit)}"
                if explained and self.ladder
                else sentence
            )
        sentences = [f"{who} {verb}{size}."]
        if self.failed is Rung.STATIC:
            sentences.append(static_failure(self.static))
        elif self.failed is Rung.LOW_SPEED and self.low_speed is not None:
            sentences.append(low_speed_failure(self.low_speed))
        elif self.failed is Rung.MOTION and self.problem is not None:
            sentences.append(motion_failure(self.nearer, self.limit))
        elif self.failed is Rung.OVER_SPEED and self.over_speed is not None:
            sentences.append(speed_failure(self.over_speed))
        if self.ladder is not None and self.agrees:
            sentences += [f"{step.sentence}." for step in self.ladder.steps]
        elif self.ladder is not None and (self.ladder.steps or self.failed is Rung.MOTION):
            sentences.append(ladder_words(self.ladder, self.limit))
        return " ".join(sentences)

    @cached_property
    def channels(self) -> xr.Dataset:
        """Dataset over ``channel``: peaks to peak, means, misfits, and the order that differs most."""
        if self.problem is None:
            raise refuse(
                "channels", "no curves at one speed", "a check of curves", "Read .static or .over_speed."
            )
        rows = self.problem.misfit.channels
        by_second = [math.nan] * len(rows)
        if self.second is not None:
            by_second = [row.total for row in self.second.channels]
        peaks = [peaks_to_peak(self.problem, row) for row in rows]
        worst = [int(np.abs(row.channel.orders.values - row.ours.values).argmax()) for row in rows]
        columns = {
            "quantity": ([row.channel.channel.quantity for row in rows], "1", "quantity"),
            "units": ([row.channel.channel.kind.unit for row in rows], "1", "SI unit of the channel"),
            "their_peak_to_peak": ([peak.theirs for peak in peaks], _BY_CHANNEL, "theirs"),
            "our_peak_to_peak": ([peak.ours for peak in peaks], _BY_CHANNEL, "ours"),
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
            "at_no_order": (
                [difference_at_no_order(self.problem, row) for row in rows],
                "1",
                "difference at none of the compared orders, over the motion; no part of the misfit",
            ),
        }
        return labelled_dataset(
            {name: ("channel", values, unit, words) for name, (values, unit, words) in columns.items()},
            {"channel": ([row.channel.channel.name for row in rows], "1", "channel")},
            origin(self.pair)
            | {"contact": self.problem.motion.motion.attrs["contact"]}
            | {"shift": self.problem.misfit.shift, "misfit": self.misfit, "verdict": self.verdict.value},
        )

    def plot(self, *variables: object) -> Figure:
        """Draw both motions over the mesh phase, or both values over speed.

        Raises
        ------
        ParameterError : only static quantities were given
        """
        no_variables(variables)
        from validation.plots.check import motion_figure, speed_figure

        if self.problem is not None:
            return motion_figure(figure_data(self.problem))
        if self.over_speed is not None:
            return speed_figure(self.over_speed.table)
        raise refuse("plot", "static quantities only", "a check of curves", "Read .static.table.")

    def __str__(self) -> str:
        return self.words


@shows_progress("check")
def check(
    pair: AnyPair,
    theirs: Any,
    *,
    limit: float = LIMIT,
    explain: bool = True,
    budget: float = BUDGET,
    phase: float | None = None,
    supports: Supports | None = None,
    progress: ProgressRequest = None,
) -> Check:
    """Check curves of another model, or a measured record, against both programs.

    Parameters
    ----------
    pair : gear pair, preset name or parameter file, at the speed and torque of the curves
    theirs : a file (CSV, xlsx, .mat, NetCDF, .toml that describes a record, .fmu, "model.py:function"), a
        mapping from names to arrays, a pandas or xarray object, or a function of the parameters that returns
        such a mapping; see docs/how_to/own_model_files.md
    limit : misfit up to which the curves agree; 0.05 is 5 %
    explain : whether explanations of a difference are searched
    budget : processor time of this search [s]
    phase : mesh cycles from the moment when pair A was at A to the first sample; default: by correlation
    supports : "springs", the four of ``bearings``, or "shafts", the elastic ones of ``shafts``; by default
        the shafts of a pair that has them
    progress : True (a bar), False (none), None (a bar where the call takes over two seconds), or a function
        that is called with the finished fraction

    Returns
    -------
    Check: ``verdict``, ``misfit``, ``words``, ``channels``, ``explanations``, ``static``, ``plot()``

    Raises
    ------
    ParameterError : curves that cannot be read or compared; the text says what to change
    NumericalError : no motion of the pair is found
    """
    progress = reported_to(progress)
    gear_pair = with_supports(load_gear_pair(pair), supports)
    allowed = real_number("limit", limit, 0.0, 1.0, above=True, action="Give a share: 5 % is 0.05.")
    seconds = real_number("budget", budget, 0.0, unit="s")
    shift = None if phase is None else real_number("phase", phase, unit="mesh cycles")
    model = other_model(theirs)
    source = read(theirs, gear_pair) if model is None else model.curves(gear_pair)
    if isinstance(source, ValuesOverSpeed):
        return _of_values_over_speed(gear_pair, source, allowed, progress)
    at_curves = source.at(gear_pair)
    static = static_rung(source, at_curves)
    # The mesh stiffness is no motion: the static rung compares it.
    moving = tuple(channel for channel in source.channels if channel.quantity != "mesh_stiffness")
    result = Check(
        pair=at_curves,
        name=source.name,
        role=source.role,
        limit=allowed,
        static=static,
        low_speed=None,
        problem=None,
        over_speed=None,
        second=None,
        discrepancy=math.nan,
        ladder=None,
        remarks=source.remarks,
    )
    if not moving:
        return result
    curves = replace(source, channels=moving)
    motion = lumped_motion(at_curves, curves.recurrence, samples=REFERENCE_SAMPLES)
    problem = Problem.of(at_curves, curves, motion, shift)
    more: tuple[str, ...] = ()
    if model is not None:
        refined = _refined(model, at_curves, moving)
        problem = replace(problem, refined=refined)
        more = _resolution_remarks(problem)
        result = replace(result, low_speed=_low_speed(model, at_curves, source))
    second, discrepancy = _second(problem, motion)
    result = replace(
        result,
        problem=problem,
        second=second,
        discrepancy=discrepancy,
        remarks=(*source.remarks, *_remarks(problem), *_remark_on_no_order(problem, allowed), *more),
    )
    agree = result.failed is None and all(row.total <= allowed for row in result.nearer.channels)
    if explain and agree and (steps := of_agreeing(problem, allowed)):
        left_out = Ladder(problem.misfit.value, steps, motion, runs=0, complete=True)
        return replace(result, ladder=left_out)
    if not explain or agree:
        return result
    return replace(result, ladder=climb(problem, limit=allowed, budget=seconds))


def _of_values_over_speed(
    pair: GearPair, theirs: ValuesOverSpeed, limit: float, progress: Callable[[float], None] | None
) -> Check:
    """Check of values over speed."""
    return Check(
        pair=pair,
        name=theirs.name,
        role=theirs.role,
        limit=limit,
        static=StaticRung(pair, ()),
        low_speed=None,
        problem=None,
        over_speed=speed_misfit(theirs, pair, progress),
        second=None,
        discrepancy=math.nan,
        ladder=None,
        remarks=theirs.remarks,
    )


def _refined(model: OtherModel, pair: GearPair, channels: tuple[Any, ...]) -> Curves | None:
    """Curves of a model that can halve its step, with the same channels. None: the model cannot."""
    if not model.can_refine:
        return None
    refined = model.curves(pair, refine=2)
    if isinstance(refined, ValuesOverSpeed):
        return None
    names = {channel.name for channel in channels}
    return replace(refined, channels=tuple(channel for channel in refined.channels if channel.name in names))


def _low_speed(model: OtherModel, pair: GearPair, at_speed: Curves) -> Problem | None:
    """The transmission error of a model that can be called, where the motion is nearly static.

    ``at_speed``: curves of the model at the speed of the pair. None: the model fails at low speed, gives no
    transmission error, or does not read the speed.
    """
    lowest = float(natural_frequencies(pair.healthy)[0])
    rpm = 60.0 * _LOW * lowest / pair.pinion.teeth
    slow = pair.with_({"operating.pinion_speed": f"{rpm!r} rpm"})
    try:
        curves = model.curves(slow)
        if isinstance(curves, ValuesOverSpeed) or not curves.of_quantity("dte"):
            return None
        if np.array_equal(curves.places, at_speed.places):  # the function does not read the speed
            return None
        problem = Problem.of(
            slow,
            replace(curves, channels=curves.of_quantity("dte")),
            lumped_motion(slow, samples=REFERENCE_SAMPLES),
        )
        return problem if np.isfinite(problem.misfit.value) else None
    except (ValueError, NumericalError, ArithmeticError):
        return None


def _resolution_remarks(problem: Problem) -> tuple[str, ...]:
    """Sentence on a model whose motion changes with half the step."""
    if problem.refined is None:
        return ()
    other = Problem.of(problem.pair, problem.refined, problem.motion, problem.given_shift)
    change = abs(other.misfit.value - problem.misfit.value)
    if change <= _RESOLVED:
        return ()
    return (f"The step is too long: with half the step the misfit is {percent(other.misfit.value)}.",)


def _second(problem: Problem, motion: MotionCurves) -> tuple[Misfit | None, float]:
    """Misfit of the curves against the multibody model, and of both programs of ours."""
    other = multibody_motion(problem.pair, motion)
    if other is None:
        return None, math.nan
    misfit = problem.misfit_with(other)
    rows = problem.misfit.channels
    ours = tuple(row.channel._replace(orders=row.ours) for row in rows)
    return misfit, problem.misfit_with(other, ours).value


def _remark_on_no_order(problem: Problem, limit: float) -> tuple[str, ...]:
    """Sentence on channels that agree at the compared orders, and differ at none of them by the limit."""
    rests = [
        (row.channel.channel.name, difference_at_no_order(problem, row))
        for row in problem.misfit.channels
        if row.total <= limit
    ]
    above = [f"{name} by {percent(rest)}" for name, rest in rests if rest > limit]
    if not above:
        return ()
    return (
        f"At frequencies that are none of the compared mesh orders, {problem.orders.min():.3g} to "
        f"{problem.orders.max():.3g}, the motions differ too: {', '.join(above)}. This is no part of "
        "the misfit.",
    )


def _remarks(problem: Problem) -> tuple[str, ...]:
    """Sentences on the curves: not settled, means that were removed."""
    remarks = []
    period = problem.motion.mesh_cycles
    change = problem.settled.change
    if change > CHANGES:
        remarks.append(
            f"The motion has not settled: the last cycles change by {percent(change)}. Run it longer."
        )
    elif problem.settled.transient > TRANSIENT:
        remarks.append(
            f"The curves begin with a transient: its orders differ by {percent(problem.settled.transient)}. "
            f"Compared are the last {problem.settled.compared * period} of {problem.settled.cycles * period} "
            "mesh cycles."
        )
    whole = turning(problem)
    if whole:
        remarks.append(f"Whole angles, compared without their uniform rotation: {', '.join(whole)}.")
    drifts = [row.channel.channel.name for row in drifting(problem)]
    if drifts:
        brake = float(problem.motion.motion.attrs["brake_torque"])
        remarks.append(
            f"{', '.join(drifts)}: the speed drifts, because the torques do not balance. A brake torque of "
            f"{brake:.5g} N m holds it. The drift is not compared."
        )
    for channel in problem.curves.channels:
        if step := coarse_step(channel.values):
            remarks.append(
                f"{channel.name} is written in steps of {quantity(step, channel.kind.unit, 3)}, "
                f"{percent(step / float(np.ptp(channel.values)))} of its peak to peak. Write more digits."
            )
    removed = without_means(problem)
    if removed:
        remarks.append(f"Without their means, which were removed: {', '.join(removed)}.")
    shown = {row.channel.channel.name for row in problem.misfit.channels}
    unseen = [channel.name for channel in problem.curves.channels if channel.name not in shown]
    if unseen:
        remarks.append(f"Not compared, no whole engagement in the samples: {', '.join(unseen)}.")
    return tuple(remarks)
