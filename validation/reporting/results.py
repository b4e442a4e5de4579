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
from floquet.gear.jump_search import JumpSearch, contact_loss_windows, search_jumps
from floquet.gear.motions import GearOrbit
from lumped.errors import NumericalError, ParameterError
from lumped.labelling import labelled_dataset
from lumped.model.averaged import Mode, modes
from lumped.model.periodic_system import LTVSystem, without_shafts
from lumped.model.propagation import fastest_frequency
from lumped.model.steady import periodic_solution, sample_times
from lumped.model.sweep import resolved_sweep, systems_over_speed
from lumped.outcomes import Absent, Outcome
from lumped.schema.pair import GearPair
from lumped.typing import IntArray, Progress
from validation.cross_check.comparison import CrossCheck, crosscheck
from validation.cross_check.verdict import Verdict
from validation.cross_check.words import loss_difference, share
from validation.files.formatting import quantity
from validation.measurements.comparing import compare_record
from validation.measurements.record import Measurement
from validation.measurements.record_comparison import RecordComparison
from validation.prediction.budget import error_budget
from validation.prediction.inputs import given_and_assumed, uncertain_inputs
from validation.prediction.motion import (
    NOTHING,
    ORDERS,
    QUANTITIES,
    Motion,
    Prediction,
    measured,
    mesh_orders,
    predicted,
)
from validation.prediction.resonance import Resonance, nearest_resonance
from validation.prediction.uncertainty import (
    LEAST_BAND,
    LONG_STEP,
    STEP,
    Varied,
    least_samples,
    sampled_predictions,
    speed_band,
    teeth_band,
    uncertainty,
)
from validation.signals.findings import TeethFindings
from validation.validity.flags import Flag, validity_flags
from validation.validity.plausibility import parameter_warnings

#: Rounding that a relation may be off by.
_SLACK = 1e-9
#: A curve over speed passes through the table's value within this share: it is computed with other samples.
_SAME = 2e-3
#: Numbers of page 1 in a sentence.
SHORT = {
    "dte_peak_to_peak": "transmission error",
    "dynamic_factor": "dynamic factor",
    "tooth_load": "largest tooth load",
    "bearing_rms": "bearing force",
    "efficiency": "efficiency",
}
#: Numbers of page 1 by which both programs are compared.
_COMPARED = ("dte_peak_to_peak", "dynamic_factor", "tooth_load", "bearing_rms")
#: Share of its peak to peak by which another motion differs from the prediction at least.
_APART = 0.25
#: Share of the speed to either side within which jumps are searched where contact is lost at the operating
#: point and the linear motion does not say so.
_ABOUT = 0.1
#: Vibrations in a mesh cycle beyond which half of the samples, and of the speeds of their range, are taken:
#: each costs as much more, and no resonance is left to be seen.
_MANY = 300.0
#: Times in a mesh cycle of the second program on shafts.
_SAMPLES = 512


@dataclass(frozen=True)
class Effort:
    """How finely the report samples: inputs (0: not varied), speeds of each curve, nodes of the chart.

    ``jump_seconds``: processor time of the search for jumps; ``jump_seeds``: speeds an octave at which runs
    settle, to find isolated motions, beats and chaos; ``sample_seconds`` and ``band_seconds``: processor time
    of the samples, and of each of the ranges that ``band_samples`` give; ``name``: what a reader calls it.
    """

    samples: int
    band_samples: int
    band_speeds: int
    sweep_speeds: int
    chart_speeds: int
    chart_dampings: int
    orders_speeds: int
    jump_seconds: float
    jump_seeds: int
    name: str
    sample_seconds: float = 30.0
    band_seconds: float = 10.0


FULL = Effort(128, 32, 41, 160, 1601, 101, 61, 30.0, 8, "full report")
QUICK = Effort(0, 0, 0, 96, 401, 41, 25, 5.0, 0, "quick report")


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
        self.given = pair
        self.pair = pair.healthy
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
        return uncertainty(self.pair, self.samples, seconds=self.effort.sample_seconds, progress=stage)

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
    def inputs(self) -> tuple[int, int]:
        """Number of inputs that are known, and of those that are assumed; see ``given_and_assumed``."""
        return given_and_assumed(self.given, contact_lost=self.prediction.contact_lost)

    @cached_property
    def varies(self) -> bool:
        """Whether inputs are uncertain."""
        return bool(uncertain_inputs(self.given))

    @cached_property
    def sweep(self) -> xr.Dataset:
        """Linear motion on springs over speed."""
        stage = self.stage("response over speed")
        most = self.effort.sweep_speeds
        return resolved_sweep(self.pair_on_springs, self.speeds, most=most, progress=stage)

    @cached_property
    def band(self) -> xr.Dataset | Absent:
        """Range of the transmission error on springs over speed with the uncertain inputs."""
        if isinstance(self.uncertainty, Absent):
            return self.uncertainty
        self.stage("range over speed")
        # Resonances are wider the faster the pair runs.
        low, high = self.speeds
        slow = self.vibrations > _MANY
        count = self.effort.band_speeds
        speeds = np.linspace(low**0.5, high**0.5, count // 2 if slow else count) ** 2
        step = LONG_STEP if slow else STEP
        samples = self.effort.band_samples
        seconds = self.effort.band_seconds
        return speed_band(self.pair_on_springs, speeds, self.uncertainty, samples, step, seconds)

    @cached_property
    def teeth_band(self) -> xr.Dataset | None:
        """See ``teeth_band``; None of like teeth, or without samples."""
        if self.teeth is None or isinstance(self.uncertainty, Absent):
            return None
        self.stage("range of teeth that differ")
        return teeth_band(self.given, self.uncertainty, self.effort.band_seconds)

    @cached_property
    def record_samples(self) -> Varied | None:
        """Motions at samples of the inputs beside a record; None without one, or without samples."""
        known = self.uncertainty
        if self.record is None or isinstance(known, Absent):
            return None
        self.stage("the record, with uncertain inputs")
        effort = self.effort
        return sampled_predictions(self.pair, known, effort.band_samples, effort.band_seconds)

    @property
    def contact_lost(self) -> bool:
        """Whether contact is lost at the operating point."""
        return self.prediction.contact_lost

    @cached_property
    def other_motions(self) -> tuple[GearOrbit, ...]:
        """Further stable motions that were found at the operating speed, by size; see ``jump_search``."""
        if self.pair.shafts is not None:
            return ()  # the search is on springs
        own = self.like.peak_to_peak
        stable = [one for one in self.jump_search.at(self.operating_rpm) if one.stable]
        others = [one for one in stable if abs(one.peak_to_peak - own) > _APART * own]
        return tuple(sorted(others, key=lambda one: one.peak_to_peak))

    @property
    def teeth_apart(self) -> int:
        """At how many pairs of teeth contact is lost where teeth differ."""
        return 0 if self.teeth is None else len(self.teeth.contact_lost)

    @cached_property
    def contact_loss_windows(self) -> tuple[tuple[float, float], ...]:
        """Speeds [rpm] at which like teeth on springs can lose contact, within ``speeds``."""
        windows = contact_loss_windows(self.sweep, self.speeds)
        own = self.operating_rpm
        if not self.like.contact_lost or any(low <= own <= high for low, high in windows):
            return windows
        ends = max((1.0 - _ABOUT) * own, self.speeds[0]), min((1.0 + _ABOUT) * own, self.speeds[1])
        return tuple(sorted((*windows, ends)))

    @cached_property
    def jump_search(self) -> JumpSearch:
        """Motions beyond contact loss on springs over ``speeds``, within the effort's processor time."""
        windows = self.contact_loss_windows
        return search_jumps(
            self.pair_on_springs,
            windows,
            seconds=self.effort.jump_seconds,
            seeds=self.effort.jump_seeds,
            first=self.operating_rpm,
            progress=self.stage("contact loss") if windows else None,
        )

    @property
    def searched(self) -> tuple[float, float] | None:
        """Widest range about the operating speed in which all jumps were searched [rpm]; None: none."""
        own, (low, high) = self.operating_rpm, self.speeds
        for start, end in self.jump_search.open:
            if start <= own <= end:
                return None
            low, high = (max(low, end), high) if end < own else (low, min(high, start))
        return low, high

    @cached_property
    def resonance(self) -> Resonance | None:
        """The resonance nearest to the operating speed, on the supports of the prediction."""
        self.stage("resonances")
        return nearest_resonance(self.pair, self.speeds)

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

    @cached_property
    def same_equations(self) -> float | None:
        """Largest difference of the same equations in both programs, over peak to peak."""
        agreements = () if isinstance(self.check, Absent) else self.check.of("linear")
        return max((a.difference for a in agreements if a.quantity in ("dte", "x_p", "x_g")), default=None)

    @cached_property
    def measured_error(self) -> RecordComparison | None:
        """The prediction beside a measured record; None without one."""
        if self.record is None:
            return None
        errors = [float(one.attrs.get("error_estimate", math.nan)) for one in self._motions]
        share = next((one for one in errors if math.isfinite(one)), 0.0)
        varied = self.record_samples
        if varied is not None and len(varied.samples) < least_samples(varied.asked, LEAST_BAND):
            varied = None
        return compare_record(self.record, self.prediction, numerical=share, varied=varied)

    @property
    def _motions(self) -> tuple[xr.Dataset, ...]:
        """Motions that may say their numerical error; an orbit has no steps and says none."""
        linear = self.linear
        return (self.prediction.cycle, *(() if isinstance(linear, Absent) else (linear,)))

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
        """Whether both programs agree, in a sentence; by the numbers of page 1 that differ most."""
        words = self._second_words
        return words if self.teeth is None else f"With like teeth, {words[0].lower()}{words[1:]}"

    @property
    def _second_words(self) -> str:
        check = self.check
        second = self.second
        if isinstance(check, Absent) or isinstance(second, Absent):
            return "Not checked: the second program does not run here; its chapter says why."
        if check.verdict is Verdict.NOT_CHECKED:
            return "The equations are; the second program has no motion to compare."
        if check.verdict is Verdict.FAILS:
            return "No: a check of the program fails."
        apart = f"{self._most_apart(second)}{'' if self.pair.shafts is None else ' on the shafts'}"
        if check.verdict is Verdict.AGREES:
            return f"Yes: a second program agrees{self.in_place_of_shafts}. Its {apart}."
        if all(a.within for a in check.of("exact")):
            return f"Yes, but of the second program, whose motion agrees: {loss_difference(check)}"
        own = check.worst("exact")
        swings = (quantity(v, own.unit, 3) for v in (own.peak_to_peak_multibody, own.peak_to_peak))
        return (
            f"Yes, but the second program, with exact contact, differs{self.in_place_of_shafts}: "
            f"{own.long_name}, {' beside '.join(swings)}, by {share(own.difference)}. Its {apart}."
        )

    def _most_apart(self, second: Prediction) -> str:
        """The number of page 1 that differs most by the second program; of the efficiency the loss."""
        one, other = self.like, second
        numbers = {name: (one.numbers[name], other.numbers[name]) for name in _COMPARED}
        sizes = {name: abs(there / here - 1.0) for name, (here, there) in numbers.items() if here}
        name = max(sizes, key=sizes.__getitem__)
        unit, _ = QUANTITIES[name]
        shown = " beside ".join(quantity(value, unit, 3) for value in reversed(numbers[name]))
        return f"{SHORT[name]} differs most: {shown}, by {share(sizes[name])}"

    def spread(self, name: str) -> tuple[float, float] | None:
        """5 and 95 % of a number of page 1, relative to its result; None without enough samples."""
        found = self.uncertainty
        if self.teeth is not None:
            if name != "dte_peak_to_peak" or self.teeth_band is None:
                return None
            low, high = self.teeth_band["revolution_dte_peak_to_peak"].to_numpy().tolist()
        elif isinstance(found, Absent):
            return None
        else:
            low, _, high = found[f"{name}_percentile"].to_numpy().tolist()
        result = self.prediction.numbers[name]
        return (low / result - 1.0, high / result - 1.0) if result and math.isfinite(low) else None

    def rank(self, name: str) -> float:
        """Share of the samples below the result as given [-]; NaN where no samples tell it."""
        found = self.uncertainty
        if self.teeth is not None or isinstance(found, Absent) or self.spread(name) is None:
            return math.nan
        values = found[name].to_numpy()
        result = self.prediction.numbers[name]
        slack = _SLACK * abs(result)
        return float(0.5 * (np.mean(values < result - slack) + np.mean(values <= result + slack)))

    @cached_property
    def budget(self) -> xr.Dataset:
        """Every error of the prediction, in one table."""
        self.stage("error budget")
        return error_budget(self)

    @cached_property
    def roaming(self) -> tuple[Hazard, ...]:
        """Beats and chaos: what runs settle to, and what a pair does where a motion loses its stability."""
        own = self.operating_rpm
        search = self.jump_search
        settled = [
            Hazard(min(max(own, one.low_rpm), one.high_rpm), str(one.kind), "possible")
            for one in search.attractors
        ]
        behind = [
            Hazard(one.speed_rpm, str(one.after), "possible")
            for one in search.losses
            if one.after in ("beats", "chaos")
        ]
        return (*settled, *behind)

    @property
    def nearest_hazard(self) -> Hazard | None:
        """The unstable speed, jump, beats or chaos nearest to the operating speed."""
        edge = float(self.chart.attrs["nearest_edge_speed_rpm"])
        own = self.operating_rpm
        found = [] if math.isnan(edge) else [Hazard(edge, "unstable speed")]
        if self.multipliers.verdict == "unstable":
            found = [Hazard(own, "unstable speed")]
        found += [
            Hazard(jump.speed_rpm, "jump", f"running {'up' if jump.rising else 'down'}")
            for jump in self.jump_search.jumps
        ]
        return min([*found, *self.roaming], key=lambda one: abs(one.speed_rpm - own), default=None)


#: Kind of a hazard -> the hazard with its article.
_NOUNS = {
    "jump": "a jump",
    "unstable speed": "an unstable speed",
    "periodic": "a motion of many mesh cycles",
}


@dataclass(frozen=True)
class Hazard:
    """A speed at which the pair must not run.

    Attributes
    ----------
    speed_rpm : pinion speed [rpm]
    kind : "unstable speed", "jump", "beats", "chaos", or "periodic", a motion of many mesh cycles
    how : how it happens
    """

    speed_rpm: float
    kind: str
    how: str = ""

    @property
    def noun(self) -> str:
        """The hazard with its article."""
        return _NOUNS.get(self.kind, self.kind)

    @property
    def words(self) -> str:
        """The hazard and how it happens."""
        kind = "motion of many mesh cycles" if self.kind == "periodic" else self.kind
        return f"{kind}{',' if self.kind == 'jump' else ''} {self.how}".strip()


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
    dte = prediction.cycle["dte"].to_numpy()
    sampled = float(np.ptp(dte))
    rounding = NOTHING * float(np.abs(dte).max())
    if not sampled * (1.0 - _SLACK) - rounding <= prediction.peak_to_peak <= 1.05 * sampled + 1e-12:
        yield "the peak to peak is not that of the motion"
    rms = numbers["bearing_rms"]
    orders = prediction.bearing_orders
    if np.sum(orders**2) / 2.0 > rms**2 * (1.0 + 1e-6) + (NOTHING * prediction.static_force) ** 2:
        yield "the orders of the bearing force carry more than its rms"
    linear = results.linear
    if not isinstance(linear, Absent) and results.pair.shafts is None:
        at = results.sweep.interp(speed=results.operating_rpm)["dte_peak_to_peak"]
        given = float(linear.attrs["dte_peak_to_peak"])
        if abs(float(at) - given) > _SAME * given + rounding:
            yield "the curve over speed misses the value at the operating speed"
    found = results.uncertainty
    if isinstance(found, xr.Dataset):
        for name, value in results.like.numbers.items():
            if abs(found.attrs[f"given_{name}"] - value) > _SLACK * max(abs(value), 1e-300):
                yield f"the samples were taken about another {name}"
            low, middle, high = found[f"{name}_percentile"].to_numpy()
            if math.isfinite(middle) and not low <= middle <= high:
                yield f"the percentiles of {name} are not in order"
