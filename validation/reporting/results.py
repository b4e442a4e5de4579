"""Shared results of the chapters of the report. Each result is computed at the first use."""

from __future__ import annotations

import math
from contextlib import suppress
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, Self, TypeVar, overload

import numpy as np
import xarray as xr

import floquet
import lumped
import multibody
from floquet.engine.many_multipliers import quick_multipliers
from floquet.gear.axes import chart_axes, operating_rpm, speed_range
from floquet.gear.jump_search import JumpSearch, contact_loss_windows, search_jumps
from floquet.gear.motions import GearOrbit
from lumped.errors import NumericalError, ParameterError
from lumped.labelling import labelled_dataset
from lumped.model.averaged import Mode, modes
from lumped.model.periodic_system import LTVSystem, without_shafts
from lumped.model.propagation import fastest_frequency
from lumped.model.steady import solutions_over_speed
from lumped.model.sweep import resolved_sweep, systems_over_speed
from lumped.outcomes import Absent, Outcome
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray, IntArray, Progress
from validation.cross_check.comparison import CrossCheck, crosscheck
from validation.prediction.assumed_teeth import WIDENED, drawn_machines, results_of_machines, widened
from validation.prediction.budget import error_budget
from validation.prediction.inputs import given_and_assumed, uncertain_inputs
from validation.prediction.motion import (
    ORDERS,
    Motion,
    Prediction,
    measured,
    mesh_orders,
    predicted,
)
from validation.prediction.resonance import Resonance, nearest_resonance
from validation.prediction.static import StaticPair
from validation.prediction.uncertainty import (
    LEAST_BAND,
    LONG_STEP,
    STEP,
    Sampled,
    Varied,
    joined,
    least_samples,
    parts_of,
    peaks_over_speed,
    range_over_speed,
    sampled_predictions,
    teeth_band,
    uncertainty,
)
from validation.reporting.effort import Effort
from validation.reporting.hazards import Hazard, beats_and_chaos, nearest_of
from validation.reporting.second_process import WORK, SecondProcess, warn_again
from validation.signals.findings import TeethFindings
from validation.validity.flags import Flag, validity_flags
from validation.validity.plausibility import parameter_warnings

if TYPE_CHECKING:
    from validation.check.curves import Curves
    from validation.check.ladder import Ladder
    from validation.check.problem import Problem
    from validation.check.record.comparison import RecordComparison

#: Relative rounding of a result.
_ROUNDING = 1e-9
#: Number of page 1 -> its name in a sentence.
SHORT = {
    "dte_peak_to_peak": "transmission error",
    "dynamic_factor": "dynamic factor",
    "tooth_load": "largest tooth load",
    "bearing_rms": "bearing force",
    "efficiency": "efficiency",
}
#: Another motion counts where its peak to peak differs by at least this share from the prediction.
_APART = 0.25
#: Jumps are searched within this share of the operating speed where contact is lost there although the linear
#: motion keeps contact.
_ABOUT = 0.1
#: With more vibrations in a mesh cycle than this, half of the samples and half of the speeds are
#: computed: each costs more time, and no resonance shows any more.
_MANY = 300.0
#: Parts of the range over speed and of the machines with drawn teeth. Each is computed by the process that
#: has nothing else to do, in its share of the processor time. A part begins one machine at least.
_BAND_PARTS = 4
_TEETH_PARTS = 2
#: Output times in a mesh cycle of the second program on shafts.
_SAMPLES = 512


T = TypeVar("T")


class computed_once(cached_property[T]):
    """A property that is computed at the first use, by the second process where the results have one.

    A NumericalError is kept as well, and raised again.
    """

    @overload
    def __get__(self, instance: None, owner: type[Any] | None = None) -> Self: ...
    @overload
    def __get__(self, instance: object, owner: type[Any] | None = None) -> T: ...
    def __get__(self, instance: Any, owner: type[Any] | None = None) -> Any:
        """Return the value, or raise the error of the first use."""
        if instance is None:
            return self
        failures: dict[str, NumericalError] = instance.__dict__.setdefault("_failures", {})
        name = str(self.attrname)
        if name in failures:
            raise failures[name]
        try:
            if instance.from_second_process(name):
                return instance.__dict__[name]
            value = super().__get__(instance, owner)
        except NumericalError as error:
            failures[name] = error
            raise
        if instance.process is not None:
            instance.process.give(name, value)
        return value


class RecordExplanations(NamedTuple):
    """What a record is compatible with: record and motion, search, and the limit of the misfit."""

    problem: Problem
    ladder: Ladder
    limit: float


class Results:
    """Shared results of one gear pair.

    Parameters
    ----------
    pair : the gear pair. Only ``prediction`` and ``teeth`` are about unlike teeth; all other results are
        about the twin with like teeth. Prediction, second program, uncertainty and teeth are on the shafts
        of a pair that has shafts; all other results are on the springs of ``bearings``, of
        ``pair_on_springs``
    effort : how finely the report samples
    name : how a command names the pair: a file or a preset
    progress : called with the finished fraction and the name of the present computation
    record : a measured record of the pair at its operating point
    process : a second process, which computes a part of the results. None: this process computes them all

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
        record: Curves | None = None,
        process: SecondProcess | None = None,
    ) -> None:
        self.given = pair
        self.pair = pair.healthy
        self.pair_on_springs = without_shafts(self.pair)
        self.record = record
        self.effort = effort
        self.name = name or pair.name
        self.progress: Progress = progress or (lambda fraction, stage="", /: None)
        self.process = process
        if process is not None:
            process.begin(pair, effort, self.name)

    def from_second_process(self, name: str) -> bool:
        """Take a result of the second process, or raise its NumericalError. False: compute it here.

        While the second process computes the result, this one computes others that are needed later.
        """
        if self.process is None or name not in WORK:
            return False
        while self.process.computes(name) and (other := self.process.spare(vars(self))) is not None:
            with suppress(NumericalError):  # it is kept, and raised where the result is used
                getattr(self, other)
        answer = self.process.fetch(name, self.progress)
        if answer is None:
            return False
        warn_again(answer)
        if answer.error is not None:
            raise answer.error
        vars(self)[name] = answer.value
        return True

    def stage(self, name: str) -> Progress:
        """Report the start of a computation. Return the function that takes the finished fraction."""
        self.progress(0.0, name)
        return lambda fraction, _="", /: self.progress(fraction, name)

    @property
    def operating_rpm(self) -> float:
        """Pinion speed [rpm]."""
        return operating_rpm(self.pair)

    @computed_once
    def speeds(self) -> tuple[float, float]:
        """Range of pinion speeds of all results over speed [rpm]."""
        return speed_range(self.pair)

    @computed_once
    def prediction(self) -> Prediction:
        """The motion at the operating point of the pair as given."""
        if self.given is self.pair:
            return self.like
        self.stage("teeth that differ")
        return predicted(self.given)

    @computed_once
    def like(self) -> Prediction:
        """The motion at the operating point with like teeth."""
        self.stage("motion")
        return predicted(self.pair)

    @computed_once
    def like_loses_contact(self) -> bool:
        """Whether like teeth lose contact at the operating point."""
        return self.like.contact_lost

    @property
    def without_motion(self) -> NumericalError | None:
        """Why the pair has no motion of either form. None: the pair has a motion."""
        try:
            self.prediction  # noqa: B018  (computed at the first use)
        except NumericalError as error:
            return error
        return None

    @computed_once
    def static(self) -> StaticPair:
        """The pair at rest under its torque, with like teeth."""
        return StaticPair(self.pair)

    @computed_once
    def teeth(self) -> TeethFindings | None:
        """Motion and signals of unlike teeth. None: all teeth are alike."""
        if self.given is self.pair:
            return None
        return TeethFindings(self.given, motion=self.prediction.cycle)

    @computed_once
    def linear(self) -> xr.Dataset | Absent:
        """The linear motion on springs, whose stability and response over speed are charted."""
        try:
            return lumped.steady_state(self.pair_on_springs)
        except NumericalError as error:
            return Absent(Outcome.FAILED, str(error))

    @computed_once
    def check(self) -> CrossCheck | Absent:
        """Cross-check of both programs on springs. Absent: the second program refuses the speed, or fails."""
        try:
            return crosscheck(self.pair_on_springs, cycles=6, progress=self.stage("second program"))
        except (NumericalError, ParameterError) as error:
            return Absent(Outcome.FAILED, str(error))

    @computed_once
    def second(self) -> Prediction | Absent:
        """The motion of the second program at the operating point, on shafts where the pair has shafts."""
        if self.pair.shafts is not None:
            machine = self.run_on_shafts
            return machine if isinstance(machine, Absent) else measured(self.pair, machine, Motion.SECOND)
        if isinstance(self.check, Absent):
            return self.check
        run = self.check.multibody.get("exact")
        if run is None:
            return Absent(Outcome.NOT_ASKED)
        if not self.check.periodic:
            # One mesh cycle of a run that beats or is chaotic is no motion; it may not even touch.
            return Absent(Outcome.FAILED, "The run of the second program comes to no motion that repeats.")
        period = self.pair.geometry.mesh_period
        last = run.sel(time=slice(float(run["time"][-1]) - 1.000001 * period, None)).isel(time=slice(1, None))
        return measured(self.pair, last, Motion.SECOND)

    @computed_once
    def run_on_shafts(self) -> xr.Dataset | Absent:
        """Run of the second program on the shafts of the pair. Absent: it has none, or the run fails."""
        if self.pair.shafts is None:
            return Absent(Outcome.NOT_ASKED)
        self.stage("second program on the shafts")
        try:
            return multibody.steady_state(self.pair, supports="shafts", samples_per_cycle=_SAMPLES)
        except (NumericalError, ParameterError) as error:
            return Absent(Outcome.FAILED, str(error))

    @computed_once
    def uncertainty(self) -> xr.Dataset | Absent:
        """Samples of the prediction with varied inputs. Absent: the inputs are not varied."""
        if not self.effort.samples:
            return Absent(Outcome.QUICK)
        if not uncertain_inputs(self.pair):
            return Absent(Outcome.KNOWN)
        stage = self.stage("uncertain inputs")
        return uncertainty(self.pair, self.samples, seconds=self.effort.sample_seconds, progress=stage)

    @property
    def samples(self) -> int:
        """Number of samples of the uncertain inputs."""
        return self.effort.samples // (2 if self.vibrations > _MANY else 1)

    @computed_once
    def vibrations(self) -> float:
        """Upper bound of the vibrations of the fastest mode in a mesh cycle, on springs."""
        system = LTVSystem.of(self.pair, "full", supports="springs")
        return fastest_frequency(system) * system.period / (2.0 * math.pi)

    @computed_once
    def inputs(self) -> tuple[int, int]:
        """Number of known inputs and number of assumed inputs, see ``given_and_assumed``."""
        return given_and_assumed(self.given, contact_lost=self.backlash_counts)

    @computed_once
    def varies(self) -> bool:
        """Whether any input is uncertain."""
        return bool(uncertain_inputs(self.given))

    @computed_once
    def sweep(self) -> xr.Dataset:
        """Linear motion on springs over speed."""
        stage = self.stage("response over speed")
        most = self.effort.sweep_speeds
        return resolved_sweep(self.pair_on_springs, self.speeds, most=most, progress=stage)

    @computed_once
    def band(self) -> xr.Dataset | Absent:
        """Range of the transmission error on springs over speed with the uncertain inputs."""
        parts = [self.band_1, self.band_2, self.band_3, self.band_4]
        sampled = joined([part for part in parts if not isinstance(part, Absent)])
        return parts[0] if isinstance(parts[0], Absent) else range_over_speed(self._band_speeds, sampled)

    @property
    def _band_speeds(self) -> FloatArray:
        """Speeds of the range over speed [rpm]."""
        # Resonances are wider the faster the pair runs.
        low, high = self.speeds
        count = self.effort.band_speeds // (2 if self.vibrations > _MANY else 1)
        return np.linspace(low**0.5, high**0.5, count) ** 2

    def _part_of_band(self, number: int) -> Sampled[FloatArray] | Absent:
        """Peaks to peaks over speed of a part of the samples."""
        if isinstance(self.uncertainty, Absent):
            return self.uncertainty
        self.stage("range over speed")
        samples = self.effort.band_samples
        return peaks_over_speed(
            self.pair_on_springs,
            self._band_speeds,
            self.uncertainty,
            samples,
            LONG_STEP if self.vibrations > _MANY else STEP,
            self.effort.band_seconds / _BAND_PARTS,
            parts_of(samples, _BAND_PARTS)[number],
        )

    band_1 = computed_once(lambda self: self._part_of_band(0))
    band_2 = computed_once(lambda self: self._part_of_band(1))
    band_3 = computed_once(lambda self: self._part_of_band(2))
    band_4 = computed_once(lambda self: self._part_of_band(3))

    @computed_once
    def teeth_band(self) -> xr.Dataset | None:
        """Range of the results of unlike teeth. None: the teeth are alike, or the inputs are not varied."""
        if self.given is self.pair or isinstance(self.uncertainty, Absent):
            return None
        self.stage("range of teeth that differ")
        return teeth_band(self.given, self.uncertainty, self.effort.band_seconds)

    @computed_once
    def assumed_teeth(self) -> xr.Dataset | None:
        """Machines with teeth drawn of an assumed class, where the file states no tooth errors.

        None: the file states tooth errors, every input is known, the report draws no teeth, or like teeth
        lose contact, so that no ratio to them says what the errors do.
        """
        parts = [self.teeth_1, self.teeth_2]
        sampled = joined([part for part in parts if part is not None])
        varied_inputs = not isinstance(self.uncertainty, Absent)
        return None if parts[0] is None else results_of_machines(self.pair, sampled, varied=varied_inputs)

    def _part_of_teeth(self, number: int) -> Sampled[list[float]] | None:
        """A part of the machines with drawn teeth. None as for ``assumed_teeth``."""
        machines = self.effort.drawn_machines
        if self.given is not self.pair or not machines or not self.varies or self.like_loses_contact:
            return None
        samples = self.uncertainty
        self.stage("teeth of an assumed class")
        varied_inputs = None if isinstance(samples, Absent) else samples
        seconds = self.effort.drawn_seconds / _TEETH_PARTS
        part = parts_of(machines, _TEETH_PARTS)[number]
        return drawn_machines(self.pair, varied_inputs, machines, seconds, part)

    teeth_1 = computed_once(lambda self: self._part_of_teeth(0))
    teeth_2 = computed_once(lambda self: self._part_of_teeth(1))

    @computed_once
    def record_samples(self) -> Varied | None:
        """Motions at samples of the inputs. None: there is no record, or the inputs are not varied."""
        samples = self.uncertainty
        if self.record is None or isinstance(samples, Absent):
            return None
        self.stage("the record, with uncertain inputs")
        effort = self.effort
        return sampled_predictions(self.pair, samples, effort.band_samples, effort.band_seconds)

    @property
    def backlash_counts(self) -> bool:
        """Whether the results depend on the backlash: contact is lost. A pair without a motion keeps it."""
        return self.without_motion is None and self.prediction.contact_lost

    @property
    def contact_lost(self) -> bool:
        """Whether contact is lost at the operating point."""
        return self.prediction.contact_lost

    @computed_once
    def other_motions(self) -> tuple[GearOrbit, ...]:
        """Stable motions at the operating speed other than the prediction, the smallest first."""
        if self.pair.shafts is not None:
            return ()  # the search is on springs
        predicted_size = self.like.peak_to_peak
        stable = [orbit for orbit in self.jump_search.at(self.operating_rpm) if orbit.stable]
        others = [
            orbit for orbit in stable if abs(orbit.peak_to_peak - predicted_size) > _APART * predicted_size
        ]
        return tuple(sorted(others, key=lambda orbit: orbit.peak_to_peak))

    @property
    def teeth_apart(self) -> int:
        """Number of pairs of unlike teeth that lose contact."""
        return 0 if self.teeth is None else len(self.teeth.contact_lost)

    @computed_once
    def contact_loss_windows(self) -> tuple[tuple[float, float], ...]:
        """Ranges of speed [rpm] in which like teeth on springs can lose contact, within ``speeds``."""
        windows = contact_loss_windows(self.sweep, self.speeds)
        speed = self.operating_rpm
        if not self.like_loses_contact or any(low <= speed <= high for low, high in windows):
            return windows
        lowest, highest = self.speeds
        about = max((1.0 - _ABOUT) * speed, lowest), min((1.0 + _ABOUT) * speed, highest)
        return tuple(sorted((*windows, about)))

    @computed_once
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
        """Widest range about the operating speed in which the search for jumps is complete [rpm].

        None: the search about the operating speed is not complete.
        """
        speed = self.operating_rpm
        low, high = self.speeds
        for start, end in self.jump_search.open:
            if start <= speed <= end:
                return None
            if end < speed:
                low = max(low, end)
            else:
                high = min(high, start)
        return low, high

    @computed_once
    def resonance(self) -> Resonance | None:
        """The resonance nearest to the operating speed, on the supports of the prediction."""
        self.stage("resonances")
        return nearest_resonance(self.pair, self.speeds)

    @computed_once
    def modes(self) -> tuple[Mode, ...]:
        """Modes of the averaged pair on springs. Empty: a mode is overdamped and has no frequency."""
        try:
            return modes(self.pair, "springs")
        except NumericalError:
            return ()

    @computed_once
    def multipliers(self) -> floquet.GearPairMultipliers:
        """Floquet multipliers of the linear motion on springs at the operating point."""
        return floquet.gear_pair_multipliers(self.pair, supports="springs")

    @property
    def stability_line(self) -> IntArray:
        """Verdicts of the stability chart over speed, at the damping of the pair."""
        nearest = int(np.abs(self.chart["damping_ratio"].to_numpy() - self.pair.mesh.damping_ratio).argmin())
        return np.asarray(self.chart["verdict"].isel(damping_ratio=nearest).to_numpy(), dtype=np.int64)

    @computed_once
    def eigenvalue_kernel(self) -> None:
        """Compile or load the kernel of all multipliers, which depends on no pair."""
        quick_multipliers(np.eye(2)[None], np.zeros(1))

    @computed_once
    def chart(self) -> xr.Dataset:
        """Stability on springs over speed and mesh damping."""
        axes = chart_axes(self.pair, self.effort.chart_speeds, self.effort.chart_dampings)
        progress = self.stage("stability chart")
        return floquet.stability_chart(self.pair, axes, supports="springs", progress=progress)

    @computed_once
    def proven_stability(self) -> floquet.StabilityOverSpeed:
        """What is proven on unstable speeds next to the operating speed, of the linear motion on springs."""
        self.stage("nearest unstable speed")
        low, high = self.speeds
        range_rpm = min(low, self.operating_rpm), max(high, self.operating_rpm)
        return floquet.nearest_unstable_speed(self.pair, range_rpm, supports="springs")

    @property
    def chart_step(self) -> float:
        """Largest distance of neighbouring speeds of the stability chart [rpm]."""
        return float(np.diff(self.chart["speed_rpm"].to_numpy()).max())

    @property
    def unstable_rpm(self) -> float:
        """Nearest unstable speed at the damping of the pair [rpm]; NaN: none is known.

        Proven; beyond the speeds of the proof a node of the stability chart.
        """
        proven = self.proven_stability
        if proven.complete:
            return proven.unstable_rpm
        nodes = self.chart["speed_rpm"].to_numpy()[self.stability_line < 0]
        return float(nodes[np.abs(nodes - self.operating_rpm).argmin()]) if nodes.size else math.nan

    @computed_once
    def orders_over_speed(self) -> xr.Dataset:
        """Amplitudes of the pinion bearing force by mesh order and speed, linear motion on springs."""
        self.stage("orders over speed")
        speeds = np.linspace(*self.speeds, self.effort.orders_speeds)
        pairs = [self.pair.at_speed(float(rpm)) for rpm in speeds]
        rows = np.full((speeds.size, ORDERS), np.nan)
        systems = systems_over_speed(pairs, "springs", warn=False)
        for row, solution in zip(rows, solutions_over_speed(systems, 128), strict=True):
            if solution is not None:
                run = solution.values
                row[:] = np.hypot(*(mesh_orders(run[f"bearing_force_{line}_p"]) for line in "xy"))
        return labelled_dataset(
            {"amplitude": (("speed_rpm", "order"), rows, "N", "force on the pinion bearings")},
            {
                "speed_rpm": (speeds, "rpm", "pinion speed"),
                "order": (np.arange(1, ORDERS + 1), "1", "mesh order"),
            },
        )

    @computed_once
    def flags(self) -> tuple[Flag, ...]:
        """Assumptions of the lumped model, checked on the linear motion."""
        return (
            ()
            if isinstance(self.linear, Absent)
            else validity_flags(self.pair, self.linear, self.multipliers)
        )

    @computed_once
    def warnings(self) -> tuple[str, ...]:
        """Sentences on implausible values of the parameter file."""
        return tuple(parameter_warnings(self.pair))

    @computed_once
    def same_equations(self) -> float | None:
        """Largest difference between both programs with the same equations, over the peak to peak."""
        agreements = () if isinstance(self.check, Absent) else self.check.of("linear")
        return max((a.difference for a in agreements if a.quantity in ("dte", "x_p", "x_g")), default=None)

    @computed_once
    def measured_error(self) -> RecordComparison | None:
        """Comparison of the prediction with a measured record. None: there is no record."""
        if self.record is None:
            return None
        from validation.check.record.compare import compare_record

        errors = [float(motion.attrs.get("error_estimate", math.nan)) for motion in self._motions]
        numerical = next((error for error in errors if math.isfinite(error)), 0.0)
        varied = self.record_samples
        if varied is not None and len(varied.samples) < least_samples(varied.asked, LEAST_BAND):
            varied = None
        return compare_record(self.record, self.prediction, numerical=numerical, varied=varied)

    @computed_once
    def record_explanations(self) -> RecordExplanations | None:
        """What a record that contradicts the prediction is compatible with. None: no record contradicts."""
        if self.record is None or self.measured_error is None:
            return None
        if not self.measured_error.contradicts:
            return None
        from validation.check.ladder import climb
        from validation.check.misfit import LIMIT
        from validation.check.motion_curves import MotionCurves
        from validation.check.problem import Problem

        self.stage("what would explain the record")
        prediction = self.prediction
        again = self.record.recurrence or prediction.pair.pinion.teeth
        motion = MotionCurves.of(prediction.pair, prediction.cycle, prediction.mesh_cycles, again)
        problem = Problem.of(prediction.pair, self.record, motion)
        ladder = climb(problem, limit=LIMIT, budget=self.effort.explain_seconds)
        return RecordExplanations(problem, ladder, LIMIT)

    @property
    def _motions(self) -> tuple[xr.Dataset, ...]:
        """Motions that may have an estimate of the numerical error. An orbit has no steps and no estimate."""
        linear = self.linear
        return (self.prediction.cycle, *(() if isinstance(linear, Absent) else (linear,)))

    @computed_once
    def outside(self) -> tuple[Flag, ...]:
        """Violated assumptions, but for contact and stability: effects that the model does not have."""
        skip = ("contact_loss", "stability")
        return tuple(f for f in self.flags if f.state == "violated" and f.key not in skip)

    @property
    def in_place_of_shafts(self) -> str:
        """Words behind a result on springs of a pair that has shafts; empty for a pair without shafts."""
        return "" if self.pair.shafts is None else ", on the springs of [bearings]"

    @property
    def on_springs(self) -> str:
        """Words behind a result on stability and jumps, which are on springs and with like teeth."""
        like = "" if self.teeth is None else ", with like teeth"
        return f"{like}{self.in_place_of_shafts}"

    def spread(self, name: str) -> tuple[float, float] | None:
        """5 % and 95 % of a number of page 1, relative to the result. None: there are too few samples.

        For like teeth the ranges of forces have the teeth of an assumed class.
        """
        samples = self.uncertainty
        if self.teeth is not None:
            if name != "dte_peak_to_peak" or self.teeth_band is None:
                return None
            low, high = self.teeth_band["revolution_dte_peak_to_peak"].to_numpy().tolist()
        elif isinstance(samples, Absent):
            return None
        else:
            low, _, high = samples[f"{name}_percentile"].to_numpy().tolist()
            if name in WIDENED and self.assumed_teeth is not None:
                low, high = widened(samples, self.assumed_teeth, name)
        result = self.prediction.numbers[name]
        return (low / result - 1.0, high / result - 1.0) if result and math.isfinite(low) else None

    def rank(self, name: str) -> float:
        """Share of the samples below the result with the inputs as given [-]; NaN: too few samples."""
        samples = self.uncertainty
        if self.teeth is not None or isinstance(samples, Absent) or self.spread(name) is None:
            return math.nan
        values = samples[name].to_numpy()
        result = self.prediction.numbers[name]
        slack = _ROUNDING * abs(result)
        return float(0.5 * (np.mean(values < result - slack) + np.mean(values <= result + slack)))

    @computed_once
    def budget(self) -> xr.Dataset:
        """All errors of the prediction."""
        self.stage("error budget")
        return error_budget(self)

    @computed_once
    def roaming(self) -> tuple[Hazard, ...]:
        """Speeds of beats and chaos in the search for jumps."""
        return beats_and_chaos(self.jump_search, self.operating_rpm)

    @property
    def nearest_hazard(self) -> Hazard | None:
        """The unstable speed, jump, beats or chaos nearest to the operating speed; None: there is none."""
        return nearest_of(
            self.unstable_rpm,
            self.multipliers,
            self.jump_search,
            self.operating_rpm,
            roams=self.prediction.roams,
        )
