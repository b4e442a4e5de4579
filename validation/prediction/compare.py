"""Is a variant better? All variants run in the same possible machines; the answer is a share of machines.

A possible machine has one value of every uncertain input. A shared input has the same value in all
variants. The difference between two variants is therefore a difference in one machine.

Sources: common random numbers, A. M. Law, Simulation Modeling and Analysis, 2015, section 11.2; interval of a
share, C. J. Clopper and E. S. Pearson, Biometrika 26 (1934) 404.
"""

from __future__ import annotations

import fnmatch
import itertools
import math
import warnings
from collections import defaultdict
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from string import ascii_uppercase
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from scipy.stats import binomtest

import lumped
from floquet.orbits.deadline import Deadline
from lumped.arguments import real_number, whole_number
from lumped.calls import checked_executor, results_of
from lumped.display.progress import reported_to, shows_progress
from lumped.errors import LawRangeWarning, NumericalError, SpurcheckError, refuse
from lumped.labelling import Variable, labelled_dataset, provenance
from lumped.model.periodic_system import Supports, supports_of, with_supports
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair, leaf_paths
from lumped.typing import FloatArray, ProgressRequest
from validation.files.formatting import side_by_side
from validation.prediction.inputs import uncertain_inputs
from validation.prediction.machines import errors_of, with_errors
from validation.prediction.motion import QUANTITIES, Motion, predicted
from validation.prediction.sobol import sobol_points
from validation.prediction.uncertain_input import Input
from validation.prediction.uncertainty import (
    ALONE,
    LEAST_SAMPLES,
    ONE_AT_A_TIME,
    PERCENTILES,
    TEETH,
    TEETH_SAMPLES,
    end_shares,
    importance_of,
    of_teeth,
    varied,
)

#: Result that is compared -> its short name.
RESULTS = {
    "dte_peak_to_peak": "transmission error",
    "dynamic_factor": "dynamic factor",
    "tooth_load": "tooth load factor",
    "bearing_rms": "bearing force",
    "efficiency": "efficiency",
}
#: Further result where a variant has unlike teeth -> short name.
OF_TEETH = {"revolution_dte_peak_to_peak": "transmission error over all teeth"}
#: Results of which a larger value is better; of all others a smaller value is better.
LARGER = frozenset({"efficiency"})
#: Probability that a share lies in its interval.
SURE = 0.9
#: A variant counts as better from this share of the machines; of two variants only machines in which they
#: differ count. Below this share the inputs show no difference.
CLEAR = 0.8
#: Two results are equal where they differ by no more than this share of the larger one.
_EQUAL = 1e-9
#: Share of the samples that must have a prediction in every variant.
_LEAST = 0.5
#: Fields of the machine round the gears and of the model. Variants share their deviation even where the
#: values differ. All other fields belong to a part: another value is another part with its own deviation.
_COMMON = ("operating.*", "lubricant.*", "friction.*", "mesh.stiffness*", "mesh.damping_ratio", "*.inertia")
#: Flag of a machine -> short name.
FLAGS = {
    "contact_lost": "contact is lost",
    "unstable": "unstable",
    "linear": "linear motion instead",
}


@dataclass
class _Draw:
    """One random number of a machine.

    Attributes
    ----------
    path : field of the input
    inputs : number of each variant that uses the random number -> the input of the variant
    """

    path: str
    inputs: dict[int, Input] = field(default_factory=dict)


@shows_progress("comparison")
def compare(
    pair: AnyPair,
    *others: AnyPair,
    names: Sequence[str] | None = None,
    samples: int = 128,
    seed: int = 1,
    supports: Supports | None = None,
    seconds: float | None = None,
    executor: Executor | None = None,
    progress: ProgressRequest = None,
) -> xr.Dataset:
    """Return the share of all possible machines in which one variant of a gear pair is better than another.

    Each sample is one machine, in which every variant runs. A shared input has the same value in all
    variants; docs/how_to/compare.md lists the shared inputs.

    Parameters
    ----------
    pair : the first variant, A: gear pair, preset name or parameter file
    others : one to 25 further variants, B, C, ...; teeth, speed and everything else may differ
    names : a text for each variant; default the names of the pairs
    samples : number of machines, 16 to 65536; powers of two fill the space most evenly
    seed : seed of the scrambled Sobol points
    supports : "springs" leaves shafts and their inputs out; by default the shafts of a variant that has them
    seconds : processor time after which no further machine begins [s]; a third of the time is for the inputs
        alone. ``LEAST_SAMPLES`` machines are always computed. None: all machines are computed
    executor : what computes the machines: a cluster of ``open_cluster``, or any executor of
        ``concurrent.futures``. The result is the same. None: this process
    progress : True (a bar), False (none), None (a bar where the call takes over two seconds), or a function
        that is called with the finished fraction

    Returns
    -------
    xarray.Dataset over ``variant`` and ``other``, letters, ``result`` and ``sample``. Smaller is better,
    for the efficiency larger. These variables are shares of the machines. ``holds`` (result): all variants
    rank as with the values as given. ``holds_interval`` (result, end): interval of this share with a
    probability of 0.9. ``better`` and ``equal`` (result, variant, other): the variant is better than the
    other, or equal. ``best`` (result, variant): no other variant is better. ``contact_lost``, ``unstable``
    and ``linear`` (variant): contact is lost, the motion is unstable, the linear motion stands in.

    ``place`` (result, variant) is the rank with the values as given; ``sentence`` (result) has the answer
    in words. Each result q is in SI: ``q`` (variant, sample), ``q_given`` (variant), and ``q_difference``
    (variant, other, percentile), the differences in the same machine. ``share`` (input, sample) has the
    drawn numbers.

    Attributes: ``asked`` and ``taken``, the numbers of requested and of computed machines; ``seconds``, the
    time limit; ``refused``, the number of samples in which a variant has no prediction, which do not count;
    ``remarks`` on inputs that vary in some variants only, and on ranges that hide a difference;
    ``parameters`` of A, ``parameters_B``, ...

    Raises
    ------
    ParameterError : fewer than two variants, two equal ones, a spread that cannot be read, no uncertain input
    NumericalError : a variant as given, or half of the samples, have no prediction
    """
    progress = reported_to(progress)
    pairs = [with_supports(load_gear_pair(one), supports) for one in (pair, *others)]
    texts = _names(pairs, names)
    samples = whole_number("samples", samples, 16, 65536)
    draws = common_draws(pairs)
    if not draws:
        action = "State ranges in [uncertainty], or sources that say what is assumed."
        raise refuse("uncertainty", "none", "at least one uncertain input", action)
    unlike_teeth = any(one.healthy is not one for one in pairs)
    checked_executor(executor)
    if seconds is not None and executor is not None:
        action = "Leave it out, and state the number of machines."
        raise refuse("seconds", seconds, "none with an executor, on which all machines are computed", action)
    deadline = Deadline(
        None if seconds is None else real_number("seconds", seconds, 0.0, above=True, unit="s")
    )
    alone = [end_shares(next(iter(draw.inputs.values()))) for draw in draws]
    total = len(pairs) * (1 + samples) + sum(map(len, alone))
    done = 0

    def count(number: int) -> None:
        nonlocal done
        done += number
        if progress is not None:
            progress(done / total)

    def variant(k: int, shares: Mapping[int, float]) -> _Variant:
        """Variant k of a machine. ``shares``: number of a draw -> share of the distribution."""
        changes = [(draws[n].inputs[k], share) for n, share in shares.items() if k in draws[n].inputs]
        return _Variant(pairs[k], tuple(changes))

    nominal = list[FloatArray | None]()
    for k in range(len(pairs)):
        nominal += _numbers_of([variant(k, {})], unlike_teeth)
        count(1)
    for k, one in enumerate(nominal):
        if one is None:
            name = f"{ascii_uppercase[k]} ({texts[k]})"
            raise NumericalError(f"{name} has no prediction with its values as given.")
    as_given = np.stack([one for one in nominal if one is not None])
    swings = np.full((len(draws), 2, as_given.shape[1]), np.nan)
    first = deadline.share(ALONE)
    calls = (
        ([variant(min(draw.inputs), {n: share}) for share in alone[n]], unlike_teeth)
        for n, draw in enumerate(draws)
    )
    for n, ends in enumerate(results_of(_numbers_of, calls, executor, lambda: first.passed)):
        count(len(ends))
        if valid_ends := [one for one in ends if one is not None]:
            swings[n] = np.min(valid_ends, axis=0), np.max(valid_ends, axis=0)
    points = sobol_points(importance_of(swings), samples, seed)
    machines: list[list[FloatArray | None]] = []
    calls = (
        ([variant(k, dict(enumerate(point.tolist()))) for k in range(len(pairs))], unlike_teeth)
        for point in points
    )

    def ends_here() -> bool:
        return len(machines) >= LEAST_SAMPLES and deadline.passed

    for machine in results_of(_numbers_of, calls, executor, ends_here):
        count(len(machine))
        machines.append(machine)
    complete = np.array([all(one is not None for one in machine) for machine in machines])
    if complete.sum() < _LEAST * len(machines):
        text = f"Only {complete.sum()} of {len(machines)} samples have a prediction in every variant"
        raise NumericalError(f"{text}: narrow the ranges in [uncertainty].")
    table = np.array(
        [machine for machine, is_complete in zip(machines, complete, strict=True) if is_complete]
    )
    results = (*RESULTS, *(OF_TEETH if unlike_teeth else ()))
    dataset = _dataset(results, as_given, np.moveaxis(table, 1, 0), points[: len(machines)][complete], draws)
    letters = list(map(str, dataset["variant"].to_numpy()))
    dataset["name"] = ("variant", texts, {"units": "1", "long_name": "what the variant is"})
    attributes = {
        "supports": supports_of(pairs[0], None),
        "teeth": "as given" if unlike_teeth else "alike",
        "taken": len(machines),
        "asked": samples,
        "seconds": math.inf if seconds is None else float(seconds),
        "refused": len(machines) - len(table),
        "seed": seed,
        "remarks": _remarks(draws, pairs, letters),
    }
    attributes |= {f"parameters_{k}": one.to_toml() for k, one in zip(letters[1:], pairs[1:], strict=True)}
    return dataset.assign_attrs(provenance(pairs[0], samples=samples, seed=seed) | attributes)


def _names(pairs: Sequence[GearPair], names: Sequence[str] | None) -> list[str]:
    """Name of each variant. Too few, too many and equal variants are refused."""
    if not 2 <= len(pairs) <= len(ascii_uppercase):
        allowed = f"2 to {len(ascii_uppercase)}"
        raise refuse("variants", len(pairs), allowed, "Give another pair, or pair.with_(...).")
    about = {"name": "variant", "description": "", "sources": {}, "uncertainty": {}, "posterior": {}}
    plain = [one.with_(about) for one in pairs]
    for k, one in enumerate(plain):
        if one in plain[:k]:
            both = f"{ascii_uppercase[plain.index(one)]} and {ascii_uppercase[k]}"
            action = "They are equal: leave one out, or change it."
            raise refuse("variants", both, "pairs that differ in some value", action)
    if names is not None and len(names) != len(pairs):
        raise refuse("names", list(names), f"{len(pairs)} texts, one a variant", "Give one for each.")
    if names is not None:
        return list(map(str, names))
    return [_name_of(one, next(other for other in pairs if other.name == one.name)) for one in pairs]


def _name_of(pair: GearPair, before: GearPair) -> str:
    """Name of a pair, with the fields in which the pair differs from an earlier pair of the same name."""
    if pair is before:
        return pair.name
    ours = leaf_paths(pair)
    theirs = leaf_paths(before)
    fields = [one for one in ours | theirs if ours.get(one) != theirs.get(one)]
    return f"{pair.name}, other {_listed(fields)}"


def common_draws(pairs: Sequence[GearPair]) -> list[_Draw]:
    """Return the random numbers of a machine, each with the inputs of the variants that use the number.

    Variants share the random number of a field where value and range are equal. Where the values differ,
    the part is another part and has its own number. A field of ``_COMMON`` belongs to the machine or to the
    model and has one number for all variants, unless the values differ and the ranges do not.
    """
    by_field: dict[str, dict[int, tuple[Input, Any]]] = defaultdict(dict)
    for k, pair in enumerate(pairs):
        values = leaf_paths(pair) | {"mesh.stiffness": pair.mesh.stiffness.model}
        for one in uncertain_inputs(pair):
            by_field[one.field][k] = one, _rounded(values.get(one.field))
    draws: list[_Draw] = []
    for name, inputs_of in by_field.items():
        ranges = {k: _range(one) for k, (one, _) in inputs_of.items()}
        fixed = len({(value, ranges[k]) for k, (_, value) in inputs_of.items()}) > len(set(ranges.values()))
        one_machine = any(fnmatch.fnmatchcase(name, pattern) for pattern in _COMMON) and not fixed
        groups: dict[Any, _Draw] = {}
        for k, (one, value) in inputs_of.items():
            key = None if one_machine else (value, ranges[k])
            groups.setdefault(key, _Draw(name)).inputs[k] = one
        draws += groups.values()
    return draws


def _rounded(value: Any) -> Any:
    """A value for comparison: 8 um and 0.008 mm are equal."""
    return float(f"{value:.12g}") if isinstance(value, float) else value


def _range(one: Input) -> tuple[Any, ...]:
    """A range for comparison: ends and choices, for teeth of a class the words of the class.

    The ends of a choice are NaN, which never equals NaN, and are left out.
    """
    ends = () if one.choices else (_rounded(one.low), _rounded(one.high))
    words = one.written if one.field.endswith(".seed") else ""
    return (*ends, frozenset(one.choices), words, one.rows, one.errors)


def _remarks(draws: Sequence[_Draw], pairs: Sequence[GearPair], letters: Sequence[str]) -> list[str]:
    """Sentences on inputs that do not vary alike in all variants."""
    fields: dict[str, dict[int, Input]] = defaultdict(dict)
    for draw in draws:
        fields[draw.path] |= draw.inputs
    only: dict[tuple[int, ...], list[str]] = defaultdict(list)
    for name, inputs in fields.items():
        if len(inputs) < len(pairs):
            only[tuple(sorted(inputs))].append(name)
    remarks = []
    for places, names in only.items():
        where = _all([letters[k] for k in places])
        text = f"{_listed(names)} {'vary' if len(names) > 1 else 'varies'} in {where} only"
        remarks.append(f"{text}: state ranges in [uncertainty] to vary them in every variant")
    for name, inputs in fields.items():
        values = {k: _rounded(leaf_paths(pairs[k]).get(name)) for k in inputs}
        ranges = {k: _range(one) for k, one in inputs.items()}
        if len(set(values.values())) > 1 and len(set(ranges.values())) == 1 and not name.endswith(".seed"):
            text = next(iter(inputs.values())).written
            remarks.append(
                f"{name} differs between variants and its range, {text}, does not: the samples do not show "
                "this difference. State '+- ...' in [uncertainty], or the source of the value"
            )
    return remarks


def _listed(names: Sequence[str]) -> str:
    """The first name and the number of the others."""
    return names[0] if len(names) == 1 else f"{names[0]} and {len(names) - 1} more"


class _Variant(NamedTuple):
    """A variant in one machine: the pair, and the inputs with the shares of their distributions."""

    pair: GearPair
    changes: tuple[tuple[Input, float], ...]


def _numbers_of(variants: Sequence[_Variant], unlike_teeth: bool) -> list[FloatArray | None]:
    """``_numbers`` of each variant."""
    return [_numbers(one.pair, one.changes, unlike_teeth=unlike_teeth) for one in variants]


def _numbers(
    pair: GearPair, changes: Sequence[tuple[Input, float]], *, unlike_teeth: bool
) -> FloatArray | None:
    """``RESULTS``, for unlike teeth ``OF_TEETH``, and ``FLAGS``. None: there is no motion."""
    try:
        with ONE_AT_A_TIME, warnings.catch_warnings():
            warnings.simplefilter("ignore", LawRangeWarning)
            sampled = varied(pair, changes)
            prediction = predicted(sampled.healthy)
            over_period = [_over_the_period(sampled)] if unlike_teeth else []
    except SpurcheckError:
        return None
    flags = [
        float(prediction.contact_lost),
        float(not prediction.stable),
        float(prediction.motion is Motion.LINEAR),
    ]
    errors = errors_of(changes)
    with_error = with_errors(prediction.numbers, errors)
    over_period = [one * (1.0 + errors.get("dte_peak_to_peak", 0.0)) for one in over_period]
    numbers = np.array([*(with_error[name] for name in RESULTS), *over_period, *flags])
    return numbers if np.isfinite(numbers).all() else None


def _over_the_period(pair: GearPair) -> float:
    """Peak to peak of the transmission error over the period of the teeth, in the linear form [m]."""
    if teeth := of_teeth(pair):
        return teeth[0]
    motion = lumped.steady_state(pair, samples_per_cycle=TEETH_SAMPLES)
    return float(motion.attrs["dte_peak_to_peak"])


def _dataset(
    results: tuple[str, ...],
    nominal: FloatArray,
    table: FloatArray,
    points: FloatArray,
    draws: Sequence[_Draw],
) -> xr.Dataset:
    """Shares and numbers of ``given`` (variant, column) and ``table`` (variant, sample, column)."""
    count, machines = table.shape[:2]
    letters = list(ascii_uppercase[:count])
    variables: dict[str, Variable] = {}
    shares = defaultdict(list)
    for column, name in enumerate(results):
        unit, text = (QUANTITIES | TEETH)[name]
        values = table[..., column]
        relation = _relation(values, name)
        as_given = _relation(nominal[:, column], name)
        holding = int((relation == as_given[..., None]).all(axis=(0, 1)).sum())
        interval = binomtest(holding, machines).proportion_ci(SURE, "exact")
        shares["holds"].append(holding / machines)
        shares["holds_interval"].append([interval.low, interval.high])
        shares["better"].append((relation > 0).mean(axis=-1))
        shares["equal"].append((relation == 0).mean(axis=-1))
        shares["best"].append((relation >= 0).all(axis=1).mean(axis=-1))
        shares["place"].append(1 + (as_given < 0).sum(axis=1))
        shares["sentence"].append(_sentence(name, nominal[:, column], shares, letters))
        between = np.percentile(differences(values, values), PERCENTILES, axis=-1)
        variables |= {
            name: (("variant", "sample"), values, unit, text),
            f"{name}_given": ("variant", nominal[:, column], unit, f"{text}, with the values as given"),
            f"{name}_difference": (
                ("variant", "other", "percentile"),
                np.moveaxis(between, 0, -1),
                unit,
                f"{text}, of the variant less that of the other in the same machine",
            ),
        }
    each: tuple[str, ...] = ("result", "variant", "other")
    words = {
        "holds": (each[:1], "share of the machines in which the ranking as given holds"),
        "holds_interval": (("result", "end"), "interval of this share, with a probability of 0.9"),
        "better": (each, "share of the machines in which the variant is better than the other"),
        "equal": (each, "share of the machines in which both are equal"),
        "best": (each[:2], "share of the machines in which no other variant is better"),
        "place": (each[:2], "rank with the values as given, 1 is best"),
        "sentence": (each[:1], "what the samples say"),
    }
    variables |= {name: (dims, np.array(shares[name]), "1", text) for name, (dims, text) in words.items()}
    flags = table[..., len(results) :].mean(axis=1)
    variables |= {name: ("variant", flags[:, k], "1", text) for k, (name, text) in enumerate(FLAGS.items())}
    variables["share"] = (("input", "sample"), points.T, "1", "share of the distribution below the value")
    labels = [_label(draw, draws, letters) for draw in draws]
    return labelled_dataset(
        variables,
        {
            "variant": (letters, "1", "variant"),
            "other": (letters, "1", "variant that it is compared with"),
            "result": (list(results), "1", "result"),
            "percentile": (list(PERCENTILES), "%", "share of the samples below"),
            "input": (labels, "1", "drawn number: field, with its variants where others have their own"),
        },
    )


def _label(draw: _Draw, draws: Sequence[_Draw], letters: Sequence[str]) -> str:
    """Field of a random number, with its variants where the field has several random numbers."""
    alone = sum(one.path == draw.path for one in draws) == 1
    return draw.path if alone else f"{draw.path} ({', '.join(letters[k] for k in draw.inputs)})"


def differences(values: FloatArray, others: FloatArray) -> FloatArray:
    """Return (variant, other, ...) ``values`` less ``others``; 0 where the two are equal but for rounding."""
    first = values[:, None]
    second = others[None]
    equal = np.abs(first - second) <= _EQUAL * np.maximum(np.abs(first), np.abs(second))
    return np.where(equal, 0.0, first - second)


def _relation(values: FloatArray, name: str) -> FloatArray:
    """(variant, variant, ...) 1 where the first variant is better than the second, -1 worse, 0 equal."""
    return np.sign(differences(values, values)) * (1.0 if name in LARGER else -1.0)


def of_hundred(share: float) -> int:
    """Return a share as a number of 100 machines. Only the shares 0 and 1 give 0 and 100."""
    return min(max(round(100.0 * share), 1 if share > 0.0 else 0), 99 if share < 1.0 else 100)


def as_read(
    name: str, values: FloatArray, digits: int = 3, beside: FloatArray | None = None
) -> tuple[list[str], str]:
    """Return the values of a result as texts with one prefix, and the unit. An efficiency is in per cent.

    ``beside``: values that set the prefix.
    """
    line = values if beside is None else beside
    if name == "efficiency":
        return side_by_side(100.0 * values, "%", digits + 1 if digits > 2 else digits, 100.0 * line)
    return side_by_side(values, (QUANTITIES | TEETH)[name][0], digits, line)


def ranking(places: Sequence[int], letters: Sequence[str]) -> str:
    """Return the variants from the best to the worst, "B, A"; equal variants as "A = B"."""
    order = sorted(zip(places, letters, strict=True))
    text = order[0][1]
    for (before, _), (place, letter) in itertools.pairwise(order):
        text += f" = {letter}" if place == before else f", {letter}"
    return text


def _sentence(
    name: str, nominal: FloatArray, shares: Mapping[str, Sequence[Any]], letters: Sequence[str]
) -> str:
    """Sentence on the samples of a result. The last entries of ``shares`` are those of this result."""
    better, equal, best, place = (shares[key][-1] for key in ("better", "equal", "best", "place"))
    numbers, unit = as_read(name, nominal)
    words = [f"{number}{unit}" for number in numbers]
    first = int(np.argmax(best))
    machines = "of 100 possible machines"
    alike = [k for k in range(len(letters)) if k == first or equal[first, k] >= CLEAR]
    text = (RESULTS | OF_TEETH)[name]
    values = f"{text} " + ", ".join(f"{a} {b}" for a, b in zip(letters, words, strict=True))
    if len(alike) == len(letters):
        share = float(equal[first, [k for k in alike if k != first]].min())
        return f"{_all(letters)} are equal in {of_hundred(share)} {machines}: {values}."
    clear = float(best[first])
    if len(letters) == 2:
        share = float(better[first, 1 - first])
        tied = float(equal[0, 1])
        clear = share / (1.0 - tied)  # of the machines in which they differ
        values = f"{text} {words[first]} against {words[1 - first]}"
        statement = f"{letters[first]} is better than {letters[1 - first]} in {of_hundred(share)} {machines}"
        statement += f", equal in {of_hundred(tied)}" if tied > 0.0 else ""
    else:
        verb = "is" if len(alike) == 1 else "are"
        statement = f"{_all([letters[k] for k in alike])} {verb} best in {of_hundred(clear)} {machines}"
    if clear < CLEAR:
        return f"No difference that these inputs can show: {values}; {statement}."
    against = "" if place[first] == 1 else ", though not with the values as given"
    return f"{statement}{against}: {values}."


def _all(letters: Sequence[str]) -> str:
    """All letters as a list in words: "A, B and C"."""
    return letters[0] if len(letters) == 1 else f"{', '.join(letters[:-1])} and {letters[-1]}"
