"""Results that the report shares, each computed when it is first asked for."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import xarray as xr

import floquet
import lumped
import multibody
from floquet.gear.axes import chart_axes, operating_rpm, speed_range
from floquet.gear.motions import GearOrbit
from floquet.gear.response import ResponseBranches
from lumped.errors import NumericalError, ParameterError
from lumped.labelling import labelled_dataset
from lumped.model.averaged import Mode, modes
from lumped.model.periodic_system import LTVSystem, without_shafts
from lumped.model.propagation import fastest_frequency
from lumped.model.steady import periodic_solution, sample_times
from lumped.model.sweep import resolved_sweep, systems_over_speed
from lumped.outcomes import Absent, Outcome
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray, IntArray, Progress
from validation.cross_check.comparison import CrossCheck, crosscheck
from validation.cross_check.verdict import Verdict
from validation.cross_check.words import loss_difference, share
from validation.files.formatting import quantity
from validation.measurements.model_error import ModelError, model_error
from validation.measurements.record import Measurement
from validation.prediction.budget import error_budget
from validation.prediction.inputs import given_and_assumed, uncertain_inputs
from validation.prediction.motion import ORDERS, Motion, Prediction, measured, mesh_orders, predicted
from validation.prediction.uncertainty import LONG_STEP, STEP, speed_band, teeth_band, uncertainty
from validation.signals.findings import TeethFindings
from validation.validity.flags import Flag, validity_flags
from validation.validity.plausibility import parameter_warnings

#: Rounding that a relation may be off by.
_SLACK = 1e-9
#: A curve over speed passes through the table's value within this share: it is computed with other samples.
_SAME = 2e-3
#: Share of its peak to peak by which another motion differs from the prediction at least.
_APART = 0.25
#: Speeds of the motions beyond contact loss, over the operating speed.
BRANCH_SPEEDS = (0.8, 1.25)
#: Speeds an octave at which runs settle, to find beats and chaos.
_SEEDS = 8
#: Vibrations in a mesh cycle beyond which half of the samples, and of the speeds of their range, are taken:
#: each costs as much more, and no resonance is left to be seen.
_MANY = 300.0
#: Times in a mesh cycle of the second program on shafts.
_SAMPLES = 512


@dataclass(frozen=True)
class Effort:
    """How finely the report samples: inputs (0: not varied), speeds of each curve, nodes of the chart.

    ``full``: the budget has finite elements, and motions beyond contact loss are followed over speed.
    """

    samples: int
    band_samples: int
    band_speeds: int
    sweep_speeds: int
    chart_speeds: int
    chart_dampings: int
    orders_speeds: int
    full: bool


FULL = Effort(128, 32, 41, 160, 1601, 101, 61, full=True)
QUICK = Effort(0, 0, 0, 48, 401, 41, 25, full=False)


class Results:
    """Shared results of one gear pair.

    Parameters
    ----------
    pair : the gear pair; where its teeth differ, ``teeth`` has what that does, and all else is about its twin
        with like teeth. Prediction, second program, uncertainty and teeth are on the shafts of a pair that
        has them; all else is on the springs of ``bearings``, of ``pair_on_springs``
    effort : how finely
    name : how a command names the pair: its file, or the preset
    progress : called with the finished fraction of the present computation and its name
    record : a measured record of the pair at its operating point

    Raises
    ------
    NumericalError : from whichever result a model cannot compute; the text says what to try
    """

    def __init__(
        self,
        pair: GearPair,
        effort: Effort,
        name: str = "",
        progress: Progress | None = None,
        record: Measurement | None = None,
    ) -> None:
        self.given, self.pair = pair, pair.healthy
        self.pair_on_springs = without_shafts(self.pair)
        self.record = record
        self.effort = effort
        self.name = name or pair.name
        self.progress: Progress = progress or (lambda fraction, stage="", /: None)

    def stage(self, name: str) -> Progress:
        """Progress of one computation: tells its name at once, and takes its finished fraction."""
        self.progress(0.0, name)
        return lambda fraction, _="", /: self.progress(fraction, name)

    @property
    def operating_rpm(self) -> float:
        """Pinion speed [rpm]."""
        return operating_rpm(self.pair)

    @cached_property
    def speeds(self) -> tuple[float, float]:
        """Range of pinion speeds of everything over speed [rpm]."""
        return speed_range(self.pair)

    @cached_property
    def prediction(self) -> Prediction:
        """The motion at the operating point of the pair as given."""
        if self.given is self.pair:
            return self.like
        self.stage("teeth that differ")
        return predicted(self.given)

    @cached_property
    def like(self) -> Prediction:
        """The motion at the operating point with like teeth."""
        self.stage("motion")
        return predicted(self.pair)

    @cached_property
    def teeth(self) -> TeethFindings | None:
        """What teeth that differ do; None where they are alike."""
        if self.given is self.pair:
            return None
        return TeethFindings(self.given, motion=self.prediction.cycle)

    @cached_property
    def linear(self) -> xr.Dataset | Absent:
        """The linear motion on springs, whose stability and response over speed are charted."""
        try:
            return lumped.steady_state(self.pair_on_springs)
        except NumericalError as error:
            return Absent(Outcome.FAILED, str(error))

    @cached_property
    def check(self) -> CrossCheck | Absent:
        """The second program beside the lumped model on springs; absent at a speed that it refuses."""
        try:
            return crosscheck(self.pair_on_springs, cycles=6, progress=self.stage("second program"))
        except ParameterError as error:
            return Absent(Outcome.FAILED, str(error))

    @cached_property
    def second(self) -> Prediction | Absent:
        """The motion of the second program at the operating point, on the shafts where they are given."""
        if self.pair.shafts is not None:
            self.stage("second program on the shafts")
            try:
                machine = multibody.steady_state(self.pair, supports="shafts", samples_per_cycle=_SAMPLES)
            except (NumericalError, ParameterError) as error:
                return Absent(Outcome.FAILED, str(error))
            return measured(self.pair, machine, Motion.SECOND)
        if isinstance(self.check, Absent):
            return self.check
        run = self.check.multibody.get("exact")
        if run is None:
            return Absent(Outcome.NOT_ASKED)
        period = self.pair.geometry.mesh_period
        last = run.sel(time=slice(float(run["time"][-1]) - 1.000001 * period, None)).isel(time=slice(1, None))
        return measured(self.pair, last, Motion.SECOND)

    @cached_property
    def uncertainty(self) -> xr.Dataset | Absent:
        """How far the prediction moves with its uncertain inputs."""
        if not self.effort.samples or not uncertain_inputs(self.pair):
            return Absent(Outcome.NOT_ASKED)
        stage = self.stage("uncertain inputs")
        return uncertainty(self.pair, self.samples, progress=stage)

    @property
    def samples(self) -> int:
        """How many samples of the uncertain inputs are taken."""
        return self.effort.samples // (2 if self.vibrations > _MANY else 1)

    @cached_property
    def vibrations(self) -> float:
        """Bound on the vibrations of the fastest mode, on springs, in a mesh cycle."""
        system = LTVSystem.of(self.pair, "full", supports="springs")
        return fastest_frequency(system) * system.period / (2.0 * math.pi)

    @cached_property
    def inputs(self) -> tuple[int, int, str]:
        """Number of values that are known, of those that are assumed, and the word for these."""
        return *given_and_assumed(self.pair, contact_lost=self.like.contact_lost), "assumed"

    @cached_property
    def sweep(self) -> xr.Dataset:
        """Linear motion on springs over speed."""
        stage, most = self.stage("response over speed"), self.effort.sweep_speeds
        return resolved_sweep(self.pair_on_springs, self.speeds, most=most, progress=stage)

    @cached_property
    def band(self) -> xr.Dataset | Absent:
        """Range of the transmission error on springs over speed with the uncertain inputs."""
        if isinstance(self.uncertainty, Absent):
            return self.uncertainty
        self.stage("range over speed")
        # Resonances are wider the faster the pair runs.
        low, high = self.speeds
        slow, count = self.vibrations > _MANY, self.effort.band_speeds
        speeds = np.linspace(low**0.5, high**0.5, count // 2 if slow else count) ** 2
        step = LONG_STEP if slow else STEP
        return speed_band(self.pair_on_springs, speeds, self.uncertainty, self.effort.band_samples, step)

    @cached_property
    def teeth_band(self) -> FloatArray | None:
        """See ``teeth_band``; None of like teeth, or without samples."""
        if self.teeth is None or isinstance(self.uncertainty, Absent):
            return None
        self.stage("range of teeth that differ")
        return teeth_band(self.given, self.uncertainty)

    @property
    def contact_lost(self) -> bool:
        """Whether contact is lost at the operating point."""
        return self.prediction.contact_lost

    @cached_property
    def other_motions(self) -> tuple[GearOrbit, ...]:
        """Further stable motions that were found at the operating speed, by size; see ``branches``."""
        if not isinstance(self.branches, ResponseBranches) or self.pair.shafts is not None:
            return ()  # branches are those on springs
        own = self.like.peak_to_peak
        stable = [one for one in self.branches.at(self.operating_rpm) if one.stable]
        others = [one for one in stable if abs(one.peak_to_peak / own - 1.0) > _APART]
        return tuple(sorted(others, key=lambda one: one.peak_to_peak))

    @property
    def teeth_apart(self) -> int:
        """At how many pairs of teeth contact is lost where teeth differ."""
        return 0 if self.teeth is None else len(self.teeth.contact_lost)

    @cached_property
    def loses_contact(self) -> bool:
        """Whether contact is lost at the operating point or, by the linear motion, near it."""
        if self.like.contact_lost:
            return True
        speed = self.sweep["speed"].to_numpy()
        near = (speed > BRANCH_SPEEDS[0] * self.operating_rpm) & (
            speed < BRANCH_SPEEDS[1] * self.operating_rpm
        )
        return bool((self.sweep["normal_load_min"].to_numpy()[near] <= 0.0).any())

    @cached_property
    def branches(self) -> ResponseBranches | Absent:
        """Motions on springs with unilateral contact about the operating speed."""
        if not self.loses_contact:
            return Absent(Outcome.CONTACT_NOT_LOST)
        if not self.effort.full and not self.like.contact_lost:
            return Absent(Outcome.NOT_ASKED)
        low, high = (factor * self.operating_rpm for factor in BRANCH_SPEEDS)
        ends = max(low, self.speeds[0]), min(high, self.speeds[1])
        try:
            seeds = _SEEDS if self.effort.full else 0
            return floquet.response_branches(
                self.pair_on_springs, ends, seeds=seeds, progress=self.stage("contact loss")
            )
        except (NumericalError, ParameterError) as error:
            return Absent(Outcome.FAILED, str(error))

    @cached_property
    def modes(self) -> tuple[Mode, ...]:
        """Modes of the averaged pair on springs; empty where one is overdamped: it has no frequency."""
        try:
            return modes(self.pair, "springs")
        except NumericalError:
            return ()

    @cached_property
    def multipliers(self) -> floquet.GearPairMultipliers:
        """Floquet multipliers of the linear motion on springs at the operating point."""
        return floquet.gear_pair_multipliers(self.pair, supports="springs")

    @property
    def stability_line(self) -> IntArray:
        """Verdicts over speed at the given damping."""
        at = int(np.abs(self.chart["damping_ratio"].to_numpy() - self.pair.mesh.damping_ratio).argmin())
        return np.asarray(self.chart["verdict"].isel(damping_ratio=at).to_numpy(), dtype=np.int64)

    @cached_property
    def chart(self) -> xr.Dataset:
        """Stability on springs over speed and mesh damping."""
        axes = chart_axes(self.pair, self.effort.chart_speeds, self.effort.chart_dampings)
        tell = self.stage("stability chart")
        return floquet.stability_chart(self.pair, axes, supports="springs", progress=tell)

    @cached_property
    def orders_over_speed(self) -> xr.Dataset:
        """Amplitudes of the pinion's bearing force by mesh order over speed, linear motion on springs."""
        self.stage("orders over speed")
        speeds = np.linspace(*self.speeds, self.effort.orders_speeds)
        pairs = [self.pair.at_speed(float(rpm)) for rpm in speeds]
        rows = np.full((speeds.size, ORDERS), np.nan)
        for row, system in zip(rows, systems_over_speed(pairs, "springs", warn=False), strict=True):
            times = sample_times(system.period, 128)
            with suppress(NumericalError):
                run = periodic_solution(system, times, estimate_error=False).values
                row[:] = np.hypot(*(mesh_orders(run[f"bearing_force_{line}_p"]) for line in "xy"))
        return labelled_dataset(
            {"amplitude": (("speed_rpm", "order"), rows, "N", "force on the pinion bearings")},
            {
                "speed_rpm": (speeds, "rpm", "pinion speed"),
                "order": (np.arange(1, ORDERS + 1), "1", "mesh order"),
            },
        )

    @cached_property
    def flags(self) -> tuple[Flag, ...]:
        """Assumptions of the lumped model, checked on the linear motion."""
        return (
            ()
            if isinstance(self.linear, Absent)
            else validity_flags(self.pair, self.linear, self.multipliers)
        )

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """Sentences on given values that hardly can be meant."""
        return tuple(parameter_warnings(self.pair))

    @property
    def finite_elements(self) -> bool:
        """Whether the budget predicts the pair with tooth stiffness by finite elements."""
        return self.effort.full

    @cached_property
    def same_equations(self) -> float | None:
        """Largest difference of the same equations in both programs, over peak to peak."""
        agreements = () if isinstance(self.check, Absent) else self.check.of("linear")
        return max((a.difference for a in agreements if a.quantity in ("dte", "x_p", "x_g")), default=None)

    @cached_property
    def measured_error(self) -> ModelError | None:
        """The prediction against a measured record; None without one."""
        if self.record is None:
            return None
        simulated, linear = self.prediction.peak_to_peak, self.linear
        share = 0.0 if isinstance(linear, Absent) else float(linear.attrs["error_estimate"])
        return model_error(self.record, self.pair, simulated, share * simulated, self.uncertainty)

    @cached_property
    def outside(self) -> tuple[Flag, ...]:
        """What the model does not have and this pair needs."""
        skip = ("contact_loss", "stability")
        return tuple(f for f in self.flags if f.state == "violated" and f.key not in skip)

    @property
    def in_place_of_shafts(self) -> str:
        """Added to what is said of a pair with shafts where it is computed on springs."""
        return "" if self.pair.shafts is None else ", on the springs of [bearings]"

    @property
    def on_springs(self) -> str:
        """Added to what is said of stability and jumps of a pair with shafts, or with teeth that differ."""
        like = "" if self.teeth is None else ", with like teeth"
        return f"{like}{self.in_place_of_shafts}"

    @property
    def second_words(self) -> str:
        """Whether both programs agree, in a sentence; on the shafts by the peak to peak."""
        words = self._second_words
        if self.teeth is not None:
            words = f"With like teeth: {words[0].lower()}{words[1:]}"
        if self.pair.shafts is None or isinstance(self.second, Absent):
            return words
        more = self.second.peak_to_peak / self.like.peak_to_peak - 1.0
        size = f"{100.0 * abs(more):.2g} % {'larger' if more > 0.0 else 'smaller'}"
        return f"{words[:-1]} on springs; on the shafts its transmission error is {size}."

    @property
    def _second_words(self) -> str:
        check = self.check
        if isinstance(check, Absent):
            return "Not checked: the second program does not run here; its chapter says why."
        if check.verdict is Verdict.NOT_CHECKED:
            return "The equations are; the second program has no motion to compare."
        if check.verdict is Verdict.FAILS:
            return "No: a check of the program fails."
        worst = next(a for a in check.of("exact") if a.quantity == "dte")
        apart = f"{max(100.0 * worst.difference, 0.01):.2g} %"
        if check.verdict is Verdict.AGREES:
            return f"Yes: a second program agrees to {apart}."
        if all(a.within for a in check.of("exact")):
            return f"Yes, but of the second program, whose motion agrees to {apart}: {loss_difference(check)}"
        own = check.worst("exact")
        swings = (quantity(v, own.unit, 3) for v in (own.peak_to_peak_multibody, own.peak_to_peak))
        rest = "" if own is worst else f", the transmission error by {apart}"
        return (
            f"Yes, but the second program, with exact contact, differs: {own.long_name}, "
            f"{' beside '.join(swings)}, by {share(own.difference)}{rest}."
        )

    @cached_property
    def budget(self) -> xr.Dataset:
        """Every error of the prediction, in one table."""
        self.stage("error budget")
        return error_budget(self)

    @property
    def nearest_hazard(self) -> tuple[float, str] | None:
        """Speed [rpm] and kind of the unstable speed, jump, beats or chaos nearest to the operating speed."""
        edge = float(self.chart.attrs["nearest_edge_speed_rpm"])
        found = [] if math.isnan(edge) else [(edge, "unstable speed")]
        if self.multipliers.verdict == "unstable":
            found = [(self.operating_rpm, "unstable speed")]
        if isinstance(self.branches, ResponseBranches):
            found += [
                (jump.speed_rpm, f"jump, running {'up' if jump.rising else 'down'}")
                for jump in self.branches.jumps
            ]
            found += [
                (min(max(self.operating_rpm, one.low_rpm), one.high_rpm), f"{one.kind} possible")
                for one in self.branches.attractors
            ]
        return min(found, key=lambda one: abs(one[0] - self.operating_rpm), default=None)


def failed_checks(results: Results) -> tuple[str, ...]:
    """Return the checks of the program that fail: same equations, conservation, relations between results."""
    failures = () if isinstance(results.check, Absent) else results.check.failures
    return (*(judgement.check for judgement in failures), *broken_relations(results))


def broken_relations(results: Results) -> tuple[str, ...]:
    """Return the relations between results that do not hold, as phrases."""
    return tuple(_broken(results))


def _broken(results: Results) -> Iterator[str]:
    prediction = results.prediction
    numbers = prediction.numbers
    if numbers["dynamic_factor"] < 1.0 - _SLACK:
        yield f"the dynamic factor {numbers['dynamic_factor']:.4g} is below 1"
    if not 0.0 <= numbers["least_force"] <= 1.0 + _SLACK:
        yield f"the smallest mesh force is {numbers['least_force']:.4g} of the static one"
    # Where the linear motion stands in, what pulling teeth do may be more than the shafts bring.
    if not prediction.reason and not 0.0 < numbers["efficiency"] <= 1.0 + _SLACK:
        yield f"the efficiency is {numbers['efficiency']:.4g}"
    sampled = float(np.ptp(prediction.cycle["dte"].to_numpy()))
    if not sampled * (1.0 - _SLACK) <= prediction.peak_to_peak <= 1.05 * sampled + 1e-12:
        yield "the peak to peak is not that of the motion"
    rms, orders = numbers["bearing_rms"], prediction.bearing_orders
    if np.sum(orders**2) / 2.0 > rms**2 * (1.0 + 1e-6):
        yield "the orders of the bearing force carry more than its rms"
    linear = results.linear
    if not isinstance(linear, Absent) and results.pair.shafts is None:
        at = results.sweep.interp(speed=results.operating_rpm)["dte_peak_to_peak"]
        given = float(linear.attrs["dte_peak_to_peak"])
        if abs(float(at) / given - 1.0) > _SAME:
            yield "the curve over speed misses the value at the operating speed"
    found = results.uncertainty
    if isinstance(found, xr.Dataset):
        for name, value in results.like.numbers.items():
            if abs(found.attrs[f"given_{name}"] - value) > _SLACK * max(abs(value), 1e-300):
                yield f"the samples were taken about another {name}"
            low, middle, high = found[f"{name}_percentile"].to_numpy()
            if not low <= middle <= high:
                yield f"the percentiles of {name} are not in order"
