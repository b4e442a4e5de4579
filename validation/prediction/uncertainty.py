"""Range of the prediction with its uncertain inputs: samples, percentiles, swing of each input.

A sample is a possible machine. A limit of processor time may end the samples. The first points of a Sobol
sequence fill the space already, so fewer points are still a valid set. A sample that has begun is finished
and counts: slow samples are those that lose contact, and without them the range would be too narrow.

Sources: scrambled Sobol points, A. B. Owen, J. Complexity 14 (1998) 466; intervals of percentiles from the
binomial distribution of order statistics, David and Nagaraja, Order Statistics, 2003, section 7.1.
"""

from __future__ import annotations

import functools
import itertools
import math
import threading
import warnings
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
import xarray as xr
from scipy.special import bdtr

import lumped
from floquet.orbits.deadline import Deadline
from lumped.arguments import real_number, whole_number
from lumped.calls import checked_executor, results_of
from lumped.display.progress import reported_to, shows_progress
from lumped.errors import LawRangeWarning, NumericalError, SpurcheckError, refuse
from lumped.labelling import Variable, labelled_dataset, provenance
from lumped.model.periodic_system import Supports, supports_of, with_supports
from lumped.model.steady import solutions_over_speed
from lumped.model.sweep import systems_over_speed
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.meeting_teeth import period_of
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray, ProgressRequest
from validation.prediction.inputs import SEED_FIELDS, forms_beside, uncertain_inputs
from validation.prediction.machines import errors_of, with_errors
from validation.prediction.motion import ORDERS, QUANTITIES, Motion, Prediction, predicted
from validation.prediction.sobol import SEED, sobol_points
from validation.prediction.uncertain_input import Input
from validation.signals.averages import GEARS, sidebands

#: Percentiles of a range. The swing of an input runs from the first to the last.
PERCENTILES = (5.0, 50.0, 95.0)
#: Probability that a percentile lies in its interval.
_SURE = 0.9
#: Share of the samples that must have a motion.
_LEAST = 0.5
#: Least number of samples of a range where the time limit ended the samples: with 32 samples the interval
#: of a percentile contains a quarter of them. Half of the requested samples, if that is fewer.
LEAST_SAMPLES = 32
#: The same for ranges from 32 samples: over speed, of unlike teeth, beside a record.
LEAST_BAND = 8
#: Share of the time limit for inputs that are varied alone; the rest is for the samples.
ALONE = 1.0 / 3.0
#: Times in a mesh cycle of motions over speed, and the largest angle of a step [rad]. The step is twice
#: as long as for other results: the error of a peak to peak is 4e-4, a hundredth of the range (19/41, 145
#: to 2900 rpm). With ``LONG_STEP`` the error is 4e-4 too where a mesh cycle has hundreds of vibrations
#: (21/23 and 16/32, 12 to 240 rpm).
_TIMES = 32
STEP = 1.0
LONG_STEP = 2.0
#: Further quantities of unlike teeth, in the linear form: unit and plain name.
TEETH = {
    "revolution_dte_peak_to_peak": ("m", "transmission error over the period of the teeth, peak to peak"),
    "sideband_ratio": ("1", "largest sideband of the mesh frequency in the transmission error, over it"),
}
#: Samples of the motion of unlike teeth in a mesh cycle.
TEETH_SAMPLES = 32
#: Least and most machines with unlike teeth in a range, and the most mesh cycles of all of them together.
_LEAST_DRAWN = LEAST_BAND
_MOST_DRAWN = 32
_ALL_CYCLES = 30_000
#: Flags of a sample, in the last columns of the table.
FLAGS = ("contact_lost", "unstable", "linear")
_ORDER_NAMES = tuple(f"bearing_order_{m}" for m in range(1, ORDERS + 1))
#: Warning filters belong to the process, so the threads of one process take turns.
ONE_AT_A_TIME = threading.Lock()
T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class Sampled(Generic[T]):
    """Results at samples of the inputs.

    Attributes
    ----------
    results : results of the samples that have a motion
    taken : number of samples that began before the time limit
    asked : number of requested samples
    """

    results: tuple[T, ...]
    taken: int
    asked: int


@dataclass(frozen=True, eq=False)
class Varied:
    """Predictions with like teeth.

    Attributes
    ----------
    given : prediction with the inputs as given
    samples : predictions with varied inputs
    taken : number of samples that began before the time limit
    asked : number of requested samples; 0 without a time limit
    """

    given: Prediction
    samples: tuple[Prediction, ...]
    taken: int = 0
    asked: int = 0


@shows_progress("uncertain inputs")
def uncertainty(
    pair: AnyPair,
    samples: int = 128,
    seed: int = 1,
    *,
    supports: Supports | None = None,
    seconds: float | None = None,
    executor: Executor | None = None,
    progress: ProgressRequest = None,
) -> xr.Dataset:
    """Return how the prediction varies when every uncertain input takes any value of its range.

    Parameters
    ----------
    pair : the gear pair; its inputs vary as ``[uncertainty]`` states, and by documented defaults where a
        value is assumed
    samples : number of predictions, 16 to 65536; powers of two fill the space most evenly
    seed : seed of the scrambled Sobol points
    supports : "springs" leaves shafts and their inputs out; by default the shafts of a pair that has them
    seconds : processor time after which no further sample begins [s]; a third of the time is for the inputs
        alone. None: all samples are computed
    executor : what computes the predictions: a cluster of ``open_cluster``, or any executor of
        ``concurrent.futures``. The result is the same. None: this process
    progress : True (a bar), False (none), None (a bar where the call takes over two seconds), or a function
        that is called with the finished fraction

    Returns
    -------
    xarray.Dataset over ``sample``, ``percentile``, ``input`` and ``form``. Each quantity q of the
    prediction is in SI. ``q`` (sample) has the samples. ``q_percentile`` (percentile) has the percentiles,
    ``q_interval`` (percentile, end) the interval of each percentile with a probability of 0.9. ``q_swing``
    (input, end) is the result with one input alone at 5 % and 95 %, for a choice the smallest and the
    largest result. ``q_rank_correlation`` (input) is Spearman's coefficient. ``q_form`` (form) is the
    result in another form of the model, with the inputs as given.

    ``value`` (input, sample) has the value of each input in the unit of its field; for a choice the number
    of the choice, for fields that move together the value of the first field. Unlike teeth also have the
    quantities ``TEETH``; the teeth of a tolerance class are drawn anew in every sample.

    Attributes: ``given_q``, the result with the inputs as given; ``asked`` and ``taken``, the numbers of
    requested and of computed samples; ``refused``, the number of samples without a prediction, which are
    left out; the numbers of samples with ``contact_lost``, ``unstable``, ``lost_or_unstable``, and
    ``linear``, where the linear motion stands in; ``alone``, the number of inputs that were varied alone;
    ``seconds``, the time limit; ``seed``.

    Where the time limit ended the computation, the missing swings and forms are NaN. With fewer than
    ``LEAST_SAMPLES`` samples, or half of the requested samples if that is fewer, there is no range:
    percentiles, intervals and rank correlations are NaN

    Raises
    ------
    ParameterError : a spread that cannot be read, or no uncertain input
    NumericalError : the pair as given has no prediction, or fewer than half of the samples have one
    """
    progress = reported_to(progress)
    pair = with_supports(load_gear_pair(pair), supports)
    samples = whole_number("samples", samples, 16, 65536)
    inputs = uncertain_inputs(pair)
    if not inputs:
        action = "State ranges in [uncertainty], or in [assumed] what is assumed."
        raise refuse("uncertainty", "none", "at least one uncertain input", action)
    checked_executor(executor)
    if seconds is not None and executor is not None:
        action = "Leave it out, and state the number of samples."
        raise refuse("seconds", seconds, "none with an executor, on which all samples are computed", action)
    deadline = Deadline(
        None if seconds is None else real_number("seconds", seconds, 0.0, above=True, unit="s")
    )
    forms = forms_beside(pair)
    total = samples + sum(len(end_shares(one)) for one in inputs) + len(forms) + 1
    done = 0

    def count(number: int = 1) -> None:
        nonlocal done
        done += number
        if progress is not None:
            progress(done / total)

    nominal = _numbers(pair, ())
    count()
    if nominal is None:
        raise NumericalError("The pair has no prediction with its inputs as given.")
    first = deadline.share(ALONE)
    rows_alone: list[list[FloatArray | None]] = []
    calls = ((pair, one) for one in inputs)
    for rows_of_input in results_of(_numbers_alone, calls, executor, lambda: first.passed):
        count(len(rows_of_input))
        rows_alone.append(rows_of_input)
    alone = len(rows_alone)
    ends = _ends(inputs, rows_alone, nominal.size)
    points = sobol_points(importance_of(ends), samples, seed)
    rows = list[FloatArray | None]()
    changes = ([(one, float(u)) for one, u in zip(inputs, point, strict=True)] for point in points)
    for row in results_of(_numbers, ((pair, one) for one in changes), executor, lambda: deadline.passed):
        count()
        rows.append(row)
    has_motion = np.array([dataset is not None for dataset in rows], dtype=bool)
    enough = has_motion.sum() >= least_samples(samples)
    if has_motion.sum() < _LEAST * len(rows) and (enough or len(rows) == samples):
        raise NumericalError(
            f"Only {has_motion.sum()} of {len(rows)} samples have a prediction: narrow the ranges in "
            "[uncertainty]."
        )
    table = np.array([dataset for dataset in rows if dataset is not None]).reshape(-1, nominal.size)
    dataset = _dataset(pair, inputs, points[: len(rows)][has_motion], table, ends, enough=bool(enough))
    other_forms = np.full((len(forms), nominal.size), np.nan)
    form_calls = ((pair.with_(form), ()) for form in forms.values())
    for number, row in enumerate(results_of(_numbers, form_calls, executor, lambda: deadline.passed)):
        count()
        if row is not None:
            other_forms[number] = row
    labels = {name: dataset[name].attrs for name in QUANTITIES}
    # All at once: each assignment copies the dataset.
    dataset = dataset.assign(
        {
            f"{name}_form": (
                "form",
                other_forms[:, column],
                labels[name] | {"long_name": f"{labels[name]['long_name']}, inputs as given"},
            )
            for column, name in enumerate(QUANTITIES)
        }
    ).assign_coords(form=("form", list(forms), {"units": "1", "long_name": "form of the model"}))
    names = (name for name in dataset.data_vars if dataset[name].dims == ("sample",))
    dataset.attrs |= {f"given_{name}": float(value) for name, value in zip(names, nominal, strict=False)}
    dataset.attrs |= {"taken": len(rows), "asked": samples, "refused": len(rows) - len(table), "seed": seed}
    dataset.attrs |= {"alone": alone, "seconds": math.inf if seconds is None else float(seconds)}
    attributes = {
        "supports": supports_of(pair, None),
        "teeth": "alike" if pair.healthy is pair else "as given",
    }
    return dataset.assign_attrs(provenance(pair, samples=samples, seed=seed) | attributes)


def least_samples(requested: int, least: int = LEAST_SAMPLES) -> int:
    """Return the least number of samples of a range: ``least``, or half of the requested samples if fewer."""
    return min(least, requested // 2)


def transmission_error(dataset: xr.Dataset) -> str:
    """Return the name of the transmission error: for unlike teeth over the period of the teeth."""
    return "revolution_dte_peak_to_peak" if "revolution_dte_peak_to_peak" in dataset else "dte_peak_to_peak"


def speed_band(
    pair: GearPair,
    speeds_rpm: FloatArray,
    at_operating_speed: xr.Dataset,
    samples: int = 32,
    step_angle: float = STEP,
    seconds: float | None = None,
) -> xr.Dataset:
    """Return 5 and 95 % of the linear peak to peak on springs, ``low`` and ``high`` [m], over ``speed_rpm``.

    Parameters
    ----------
    at_operating_speed : result of ``uncertainty`` at the operating speed, which ranks the inputs
    samples : number of samples
    step_angle : largest angle of the fastest vibration in a step [rad]
    seconds : processor time after which no further sample begins [s]

    Returns
    -------
    xarray.Dataset with ``low`` and ``high``; NaN: fewer samples than ``least_samples`` of ``LEAST_BAND``
    have a motion. Attributes ``taken``, the number of begun samples, and ``asked``, the number of requested
    samples
    """
    sampled = peaks_over_speed(pair, speeds_rpm, at_operating_speed, samples, step_angle, seconds)
    return range_over_speed(speeds_rpm, sampled)


def peaks_over_speed(
    pair: GearPair,
    speeds_rpm: FloatArray,
    at_operating_speed: xr.Dataset,
    samples: int,
    step_angle: float,
    seconds: float | None,
    part: slice = slice(None),
) -> Sampled[FloatArray]:
    """Return the peaks to peaks (speed,) of each sample. Arguments as in `speed_band` and `each_sample`."""
    return each_sample(
        pair, at_operating_speed, samples, lambda one: _peaks(one, speeds_rpm, step_angle), seconds, part
    )


def range_over_speed(speeds_rpm: FloatArray, sampled: Sampled[FloatArray]) -> xr.Dataset:
    """Return the dataset of `speed_band`."""
    low = high = np.full(np.shape(speeds_rpm), np.nan)
    if len(sampled.results) >= least_samples(sampled.asked, LEAST_BAND):
        low, high = np.nanpercentile(np.array(sampled.results), PERCENTILES[::2], axis=0)
    text = "transmission error, peak to peak"
    return labelled_dataset(
        {
            "low": ("speed_rpm", low, "m", f"{text}, 5 % of the samples"),
            "high": ("speed_rpm", high, "m", f"{text}, 95 % of the samples"),
        },
        {"speed_rpm": (np.asarray(speeds_rpm), "rpm", "pinion speed")},
        _counts(sampled),
    )


def teeth_band(pair: GearPair, at_operating_speed: xr.Dataset, seconds: float | None = None) -> xr.Dataset:
    """Return 5 % and 95 % of the quantities ``TEETH`` of unlike teeth, over ``end``.

    The teeth of a tolerance class are drawn anew in each sample. ``at_operating_speed`` is the
    ``uncertainty`` of the twin with like teeth. ``seconds``, attributes and NaN are as in `speed_band`. A
    longer period has fewer samples.
    """
    samples = max(_LEAST_DRAWN, min(_MOST_DRAWN, _ALL_CYCLES // period_of(pair)))
    sampled = each_sample(pair, at_operating_speed, samples, of_teeth, seconds)
    ends = np.full((2, len(TEETH)), np.nan)
    if len(sampled.results) >= least_samples(sampled.asked, LEAST_BAND):
        ends = np.percentile(np.array(sampled.results), PERCENTILES[::2], axis=0)
    variables: dict[str, Variable] = {
        name: ("end", ends[:, column], unit, text)
        for column, (name, (unit, text)) in enumerate(TEETH.items())
    }
    return labelled_dataset(variables, {"end": (list(PERCENTILES[::2]), "%", "share of the samples below")},
                            _counts(sampled))  # fmt: skip


def sampled_predictions(
    pair: GearPair, at_operating_speed: xr.Dataset, samples: int = 32, seconds: float | None = None
) -> Varied:
    """Return predictions at samples of the inputs. ``at_operating_speed`` and ``seconds`` as in `speed_band`.

    The samples are fewer than in ``uncertainty``, which keeps numbers but no motions. 32 samples give a
    standard deviation to 13 %.
    """
    sampled = each_sample(
        pair, at_operating_speed, samples, lambda varied: predicted(varied.healthy), seconds
    )
    return Varied(predicted(pair.healthy), sampled.results, sampled.taken, sampled.asked)


def _counts(sampled: Sampled[T]) -> dict[str, int]:
    """Attributes of a range: number of samples in the range, of begun samples and of requested samples."""
    return {"samples": len(sampled.results), "taken": sampled.taken, "asked": sampled.asked}


def each_sample(
    pair: GearPair,
    at_operating_speed: xr.Dataset | None,
    samples: int,
    run: Callable[[GearPair], T],
    seconds: float | None,
    part: slice = slice(None),
) -> Sampled[T]:
    """Return results at samples of the inputs until the processor time [s] is over.

    ``run`` computes a machine. ``at_operating_speed`` as in `speed_band`; None: the teeth of a tolerance
    class alone are drawn, and all other inputs are as given. ``part``: the samples that are computed; the
    processor time is that of the part.
    """
    deadline = Deadline(seconds)
    inputs = uncertain_inputs(pair)
    seed = SEED
    if at_operating_speed is None:
        inputs = tuple(one for one in inputs if one.field in SEED_FIELDS)
        importance = np.ones(len(inputs))
    else:
        swing = np.ptp(np.nan_to_num(at_operating_speed["dte_peak_to_peak_swing"].to_numpy()), axis=1)
        by_name = dict(zip(at_operating_speed["input"].to_numpy().tolist(), swing, strict=True))
        importance = np.array([by_name.get(one.field, swing.max()) for one in inputs])
        seed = int(at_operating_speed.attrs["seed"])
    results = list[T]()
    taken = 0
    points = sobol_points(importance, samples, seed)[part]
    for point in points:
        if deadline.passed:
            break
        taken += 1
        try:
            results.append(run(varied(pair, [(one, float(u)) for one, u in zip(inputs, point, strict=True)])))
        except SpurcheckError:
            continue
    return Sampled(tuple(results), taken, len(points))


def parts_of(samples: int, parts: int) -> list[slice]:
    """Return the parts of the samples for ``each_sample``, of equal length to one sample."""
    ends = [samples * number // parts for number in range(parts + 1)]
    return [slice(low, high) for low, high in itertools.pairwise(ends)]


def joined(parts: Sequence[Sampled[T]]) -> Sampled[T]:
    """Return the results of all parts as if one call had computed them."""
    return Sampled(
        tuple(result for part in parts for result in part.results),
        sum(part.taken for part in parts),
        sum(part.asked for part in parts),
    )


def _peaks(pair: GearPair, speeds_rpm: FloatArray, step_angle: float) -> FloatArray:
    """Peak to peak of the linear transmission error at each speed [m]; NaN: there is no motion."""
    pairs = [pair.at_speed(float(rpm)) for rpm in speeds_rpm]
    sizes = np.full(len(pairs), np.nan)
    systems = systems_over_speed(pairs, "springs", warn=False)
    for j, motion in enumerate(solutions_over_speed(systems, _TIMES, step_angle=step_angle)):
        if motion is not None:
            sizes[j] = motion.peak_to_peak_of("dte")
    return sizes


def percentile_interval(count: int, percentile: float) -> tuple[int, int]:
    """Return the ranks, from 0, of the two samples between which a percentile lies.

    The number of samples below a percentile is binomial. The interval therefore holds for every distribution.
    """
    at_most = bdtr(np.arange(count + 1.0), count, percentile / 100.0)
    low, high = np.searchsorted(at_most, (0.5 - 0.5 * _SURE, 0.5 + 0.5 * _SURE)).tolist()
    return max(low - 1, 0), min(high, count - 1)


def end_shares(one: Input) -> list[float]:
    """Return the shares at which an input is varied alone: 5 % and 95 %, or the middle of every choice."""
    if one.choices:
        return [(k + 0.5) / len(one.choices) for k in range(len(one.choices))]
    return [PERCENTILES[0] / 100.0, PERCENTILES[-1] / 100.0]


def _ends(
    inputs: Sequence[Input], rows_alone: Sequence[Sequence[FloatArray | None]], columns: int
) -> FloatArray:
    """(input, end, column) results with each input alone at its ends; for a choice the extremes. NaN:
    refused.

    ``rows_alone``: for the first inputs, the results with this input alone at each of its ``end_shares``.
    """
    ends = np.full((len(inputs), 2, columns), np.nan)
    for j, (one, rows) in enumerate(zip(inputs, rows_alone, strict=False)):
        if of_input := [row for row in rows if row is not None]:
            ends[j] = (
                (np.min(of_input, axis=0), np.max(of_input, axis=0))
                if one.choices
                else (of_input[0], of_input[-1])
            )
    return ends


def importance_of(ends: FloatArray) -> FloatArray:
    """Return (input,) the largest swing of each input, over the largest swing of that result."""
    width = np.nan_to_num(np.abs(ends[:, 1] - ends[:, 0])[:, : len(QUANTITIES)])
    largest = width.max(axis=0)
    return np.asarray((width / np.where(largest > 0.0, largest, 1.0)).max(axis=1))


def varied(pair: GearPair, changes: Sequence[tuple[Input, float]]) -> GearPair:
    """Return the pair with inputs at shares of their distributions, 0 to 1.

    Raises
    ------
    ParameterError : values that no pair can have together
    """
    fields: dict[str, object] = {}
    for one, share in changes:
        fields |= one.changes(share)
    model = fields.get("mesh.stiffness")
    if isinstance(model, dict) and list(model) == ["model"]:
        # The rest then changes numbers alone. The pair's own model keeps the parameters of the file.
        del fields["mesh.stiffness"]
        if model["model"] != pair.mesh.stiffness.model:
            pair = _with_model(pair, model["model"])
    if "centre_distance" in fields:  # the gears stay as they are cut: another distance is another backlash
        for gear, shift in zip(("pinion", "gear"), pair.profile_shifts, strict=True):
            fields.setdefault(f"{gear}.profile_shift", shift)
    return pair.with_(fields) if fields else pair


@functools.lru_cache(maxsize=16)
def _with_model(pair: GearPair, name: str) -> GearPair:
    """The pair with another model of the tooth stiffness."""
    return pair.with_({"mesh.stiffness": {"model": name}})


def _numbers_alone(pair: GearPair, one: Input) -> list[FloatArray | None]:
    """Results of ``_numbers`` with an input alone at each of its ``end_shares``."""
    return [_numbers(pair, [(one, share)]) for share in end_shares(one)]


def _numbers(pair: GearPair, changes: Sequence[tuple[Input, float]]) -> FloatArray | None:
    """Quantities, orders of the bearing force, quantities of unlike teeth and ``FLAGS``. None: no motion."""
    try:
        with ONE_AT_A_TIME, warnings.catch_warnings():
            warnings.simplefilter("ignore", LawRangeWarning)
            sampled = varied(pair, changes)
            prediction = predicted(sampled.healthy)
            teeth = of_teeth(sampled)
    except SpurcheckError:
        return None
    errors = errors_of(changes)
    orders = np.zeros(ORDERS)
    orders[: prediction.bearing_orders.size] = prediction.bearing_orders
    orders *= 1.0 + errors.get("bearing_rms", 0.0)
    teeth[:1] = [one * (1.0 + errors.get("dte_peak_to_peak", 0.0)) for one in teeth[:1]]
    flags = [
        float(prediction.contact_lost),
        float(not prediction.stable),
        float(prediction.motion is Motion.LINEAR),
    ]
    return np.array([*with_errors(prediction.numbers, errors).values(), *orders, *teeth, *flags])


def of_teeth(pair: GearPair) -> list[float]:
    """Return the quantities ``TEETH``; empty for like teeth."""
    if pair.healthy is pair:
        return []
    motion = lumped.steady_state(pair, samples_per_cycle=TEETH_SAMPLES)
    beside = [sidebands(motion, gear, most=3)["ratio"][0].drop_sel(sideband=0) for gear in GEARS]
    return [float(motion.attrs["dte_peak_to_peak"]), max(float(one.max()) for one in beside)]


def _dataset(
    pair: GearPair,
    inputs: Sequence[Input],
    points: FloatArray,
    table: FloatArray,
    ends: FloatArray,
    *,
    enough: bool,
) -> xr.Dataset:
    """Dataset of the samples, with percentiles and the effect of each input alone.

    ``points`` (sample, input): shares of the distributions; ``table`` (sample, column): results; ``ends``
    (input, end, column): results of one input alone; ``enough``: there are enough samples for a range, else
    percentiles are NaN.
    """
    bearing = "force on the pinion bearings, mesh order"
    results = QUANTITIES | {name: ("N", f"{bearing} {m}") for m, name in enumerate(_ORDER_NAMES, 1)}
    results |= {} if pair.healthy is pair else TEETH
    shares, intervals = _percentiles(table, enough=enough)
    ranks = _ranks(points)
    variables: dict[str, Variable] = {}
    for column, (name, (unit, text)) in enumerate(results.items()):
        values = table[:, column]
        between = f"{text}, interval of the percentile"
        rank = _rank_correlation(ranks, values) if enough else np.full(len(inputs), np.nan)
        variables |= {
            name: ("sample", values, unit, text),
            f"{name}_percentile": ("percentile", shares[:, column], unit, text),
            f"{name}_interval": (("percentile", "end"), intervals[..., column], unit, between),
            f"{name}_swing": (
                ("input", "end"),
                ends[..., column],
                unit,
                f"{text}, one input alone at its ends",
            ),
            f"{name}_rank_correlation": ("input", rank, "1", f"{text}, rank correlation with the input"),
        }
    values = np.array([[_number(one, float(u)) for u in points[:, j]] for j, one in enumerate(inputs)])
    counts = {name: int(table[:, place - len(FLAGS)].sum()) for place, name in enumerate(FLAGS)}
    variables["value"] = (("input", "sample"), values, "1", "value of the input, in its own unit")
    return labelled_dataset(
        variables,
        {
            "percentile": (list(PERCENTILES), "%", "share of the samples below"),
            "input": ([one.field for one in inputs], "1", "uncertain input"),
        },
        counts
        | {
            "lost_or_unstable": int(np.any(table[:, -len(FLAGS) :][:, :2] > 0.0, axis=1).sum()),
            "written": [one.written for one in inputs],
            "reason": [one.reason for one in inputs],
        },
    )


def _percentiles(table: FloatArray, *, enough: bool) -> tuple[FloatArray, FloatArray]:
    """Percentiles (percentile, column) of the samples, and their intervals (percentile, end, column)."""
    count, columns = table.shape
    if not enough:
        return np.full((len(PERCENTILES), columns), np.nan), np.full((len(PERCENTILES), 2, columns), np.nan)
    places = np.array([percentile_interval(count, p) for p in PERCENTILES])
    return np.asarray(np.percentile(table, PERCENTILES, axis=0)), np.sort(table, axis=0)[places]


def _number(one: Input, share: float) -> float:
    """Value of an input at a share of the distribution; for a choice the number of the name."""
    value = one.at(share)
    return float(one.choices.index(value)) if isinstance(value, str) else value


def _ranks(columns: FloatArray) -> FloatArray:
    """Ranks of the values of each column, from 1; equal values have the mean of their ranks."""
    import pandas as pd  # xarray has imported it; scipy.stats would take a quarter of a second

    return np.asarray(pd.DataFrame(columns).rank().to_numpy(), dtype=np.float64)


def _rank_correlation(ranks: FloatArray, values: FloatArray) -> FloatArray:
    """Spearman's coefficient of the ranks (samples, inputs) of each input with a result; 0 for a constant."""
    result_ranks = _ranks(values[:, None])[:, 0]
    result_ranks = result_ranks - result_ranks.mean()
    ranks = ranks - ranks.mean(axis=0)
    size = np.sqrt((result_ranks @ result_ranks) * (ranks**2).sum(axis=0))
    coefficients = np.divide(result_ranks @ ranks, size, out=np.zeros(ranks.shape[1]), where=size > 0.0)
    return np.asarray(coefficients, dtype=np.float64)
