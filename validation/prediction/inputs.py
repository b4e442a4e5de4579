"""Uncertain inputs of a pair and their ranges: as the file states them, or documented defaults.

A range is log-uniform where factors state the range, or where both ends are positive and the upper end is
at least twice the lower end; every other range is uniform. The stated value is therefore the median of "*
0.5 .. * 2" and of "+- 2 um". Fields with one cause are one input: both directions of a bearing, the flanks
of both gears, mass and inertia. A tip takes a few values of the range: each value needs its own finite
elements.
"""

from __future__ import annotations

import fnmatch
import functools
import re
import tomllib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import replace
from importlib.resources import files
from typing import Any

from lumped.errors import ParameterError, refuse
from lumped.fields.units import to_si, to_stated
from lumped.friction.registry import LAWS
from lumped.schema.assumed import State
from lumped.schema.bodies import bodies_of
from lumped.schema.fields_read import fields_read
from lumped.schema.pair import GearPair, field_at, field_values, leaf_paths, stated_unit
from lumped.stiffness.registry import MODELS
from validation.prediction.machines import machines_left
from validation.prediction.uncertain_input import Input, Part

_NUMBER = r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)"
_OFFSET = re.compile(rf"\+-\s*{_NUMBER}\s*(.*)")
_FACTORS = re.compile(rf"([*/])\s*{_NUMBER}\s*\.\.\s*([*/])\s*{_NUMBER}\s*")
_WRITTEN = "'0.02 .. 0.10', '+- 2 um', '+- 10 %', '/ 2 .. * 2', or a list of choices"
#: A range is log-uniform where the upper end is at least this many times the lower end.
_WIDE = 2.0
#: A default range in modules, the same distance up and down.
_MODULES = re.compile(rf"\+-\s*{_NUMBER}\s*modules")
#: Field of a gear with a default range in modules: `_tips` reads this range.
_IN_MODULES = ".tip_alteration"
#: Fields that can give the position of a tip.
_TIP = ("tip_alteration", "tip_diameter", "addendum")
#: Number of values of a tip: each value needs its own finite elements, which take 0.05 s.
TIP_LEVELS = 9
#: Number of values of profile shifts that only the centre distance gives.
_SHIFT_LEVELS = 3
#: Seeds of random gears of a tolerance class run from 1 to here.
_SEEDS = 2**31
#: Inputs that draw the teeth of a tolerance class.
SEED_FIELDS = tuple(f"{gear}.deviations.seed" for gear in ("pinion", "gear"))
#: Field -> allowed names of a choice.
_CHOICES: Mapping[str, tuple[str, ...]] = {"friction.law": tuple(LAWS), "mesh.stiffness": tuple(MODELS)}

#: Fields with one cause -> name of the common input.
_TIED = (
    (re.compile(r"((?:shafts\.\w+\.)?bearings\.\w+)\.o?loa_(stiffness|damping_ratio)"), r"\1.\2"),
    (re.compile(r"(?:pinion|gear)\.(roughness)"), r"gears.\1"),
)


@functools.lru_cache(maxsize=16)  # a report asks a dozen times
def uncertain_inputs(pair: GearPair) -> tuple[Input, ...]:
    """Return every uncertain input of a pair.

    The inputs are those of ``[uncertainty]`` and, with documented default ranges, the assumed values. An
    assumed value counts where the pair reads the value, or would read the value with another law or model
    among the choices. Fields that records were fitted with are one input, the machines of ``[posterior]``.
    For random teeth of a tolerance class the seed is an input. An unreadable range is refused, and a range
    with values outside the limits of the field.
    """
    left = machines_left(pair)
    fitted = {part.field: left.written for part in left.parts} if left else {}
    stated = {field: one for field, one in pair.uncertainty if not _covered(field, fitted)}
    stated_inputs = [_input(pair, field, spread, "stated in the file") for field, spread in stated.items()]
    stated |= fitted
    for gear in ("pinion", "gear"):
        deviations = getattr(pair, gear).deviations
        if deviations is not None and deviations.tolerance_class is not None:
            words = f"class {deviations.tolerance_class}"
            reason = "the class says how large errors are, and not which: every seed is another gear of it"
            seed = Part(f"{gear}.deviations.seed", 1, _SEEDS)
            stated_inputs.append(Input(seed.field, (seed,), (), "1", words, reason))
    candidates = [*leaf_paths(pair), "mesh.stiffness", "mesh.stiffness_factor"]
    assumed: list[Input] = []
    for field in dict.fromkeys(candidates):
        default = _default(field)
        if default is None or _covered(field, stated) or field.endswith(_IN_MODULES):
            continue
        if is_assumed(pair, default.get("with", field)):
            if field == "mesh.stiffness" and pair.mesh.stiffness.model == "table":
                continue
            spread = default["spread"]
            if isinstance(spread, list):
                spread = list(dict.fromkeys([_chosen(pair, field), *spread]))
            if (value := _by_default(pair, field, spread, default["reason"])) is not None:
                assumed.append(value)
    read = _read(pair, [*stated_inputs, *assumed])
    assumed = [one for one in assumed if one.choices or one.field in read]
    return (
        *([left] if left else []),
        *stated_inputs,
        *_together(assumed),
        *_blanks(pair, stated),
        *_shifts(pair, stated),
        *_tips(pair, stated),
    )


def _together(inputs: Iterable[Input]) -> Iterator[Input]:
    """The inputs, after fields with one cause are joined to one input. A single field keeps the name."""
    groups: dict[str, list[Input]] = {}
    for one in inputs:
        names = (pattern.sub(name, one.field) for pattern, name in _TIED if pattern.fullmatch(one.field))
        groups.setdefault(next(names, one.field), []).append(one)
    for name, tied in groups.items():
        parts = tuple(part for one in tied for part in one.parts)
        yield tied[0] if len(tied) == 1 else replace(tied[0], field=name, parts=parts)


def _blanks(pair: GearPair, stated: Mapping[str, Any]) -> Iterator[Input]:
    """Mass and inertia of each gear as one input, where a solid disc stands for an unknown blank.

    A known bore gives the shape of the blank: then there is no such input.
    """
    bodies = bodies_of(pair)
    for gear in ("pinion", "gear"):
        field = f"{gear}.inertia"
        default = _default(field)
        of_disc = {"inertia": getattr(bodies, f"inertia_{gear}"), "mass": getattr(bodies, f"mass_{gear}")}
        parts = [
            _part(
                f"{gear}.{key}",
                _ends(field, default["spread"], value, str(stated_unit(f"{gear}.{key}"))),
                default["spread"],
            )
            for key, value in of_disc.items()
            if default is not None
            and getattr(getattr(pair, gear), key) is None
            and not _covered(f"{gear}.{key}", stated)
        ]
        if default is None or not parts or not is_assumed(pair, f"{gear}.bore"):
            continue
        unit = str(stated_unit(parts[0].field))
        yield Input(parts[0].field, tuple(parts), (), unit, default["spread"], default["reason"])


def _shifts(pair: GearPair, stated: Mapping[str, Any]) -> Iterator[Input]:
    """Share of the pinion in the sum of the profile shifts, where only the centre distance gives the sum.

    The range goes from half the sum for each gear to the whole sum for one gear: the gear with fewer teeth
    for a positive sum, the gear with more teeth for a negative sum. The shift of the gear is the rest.
    """
    fields = [f"{gear}.profile_shift" for gear in ("pinion", "gear")]
    free = pair.pinion.profile_shift is None and pair.gear.profile_shift is None
    total = sum(pair.profile_shifts)
    if pair.centre_distance is None or not free or any(_covered(one, stated) for one in fields):
        return
    gets_all = (pair.pinion.teeth <= pair.gear.teeth) == (total > 0.0)
    low, high = sorted((0.5 * total, total if gets_all else 0.0))
    pinion_shift = pair.profile_shifts[0]
    low, high = (end if _allowed(pair, fields[0], end) else pinion_shift for end in (low, high))
    if low < high:
        words = "half of the sum to each gear, or all to one"
        reason = "convention: no drawing says how the shifts that its centre distance asks for are shared"
        yield Input(fields[0], (Part(fields[0], low, high, levels=_SHIFT_LEVELS),), (), "1", words, reason)


def _tips(pair: GearPair, stated: Mapping[str, Any]) -> Iterator[Input]:
    """Tip alteration of each gear, where it is assumed. The default range is in modules."""
    for gear in ("pinion", "gear"):
        field = f"{gear}{_IN_MODULES}"
        default = _default(field)
        if default is None or not is_assumed(pair, field):
            continue
        if any(_covered(f"{gear}.{key}", stated) for key in _TIP):
            continue
        match = _MODULES.fullmatch(default["spread"])
        assert match is not None, "the default of a tip is in modules"
        unit = str(stated_unit(field))
        alteration = getattr(pair, gear).tip_alteration
        value = float(to_stated(pair.tip_alteration if alteration is None else alteration, unit))
        half_width = float(match[1]) * float(to_stated(pair.basic_rack.module, unit))
        low, high = (
            end if _allowed(pair, field, end) else value for end in (value - half_width, value + half_width)
        )
        if low < high:
            part = Part(field, low, high, levels=TIP_LEVELS)
            yield Input(field, (part,), (), unit, default["spread"], default["reason"])


def forms_beside(pair: GearPair) -> dict[str, dict[str, Any]]:
    """Return other forms of the model, outside the range of the inputs: name -> changes of the pair.

    Other forms are the other contact and, for an uncertain stiffness model, the models outside the choices.
    A given stiffness of the whole mesh includes the contact: then there is no other contact.
    """
    other = "prescribed" if pair.mesh.contact == "loaded" else "loaded"
    forms: dict[str, dict[str, Any]] = {}
    if not pair.mesh.stiffness.whole_mesh and "mesh.contact" not in dict(pair.posterior):
        forms[f"mesh.contact = {other}"] = {"mesh.contact": other}
    models = next((one.choices for one in uncertain_inputs(pair) if one.field == "mesh.stiffness"), None)
    for name in MODELS if models else ():
        if name != "table" and name not in (models or ()):
            forms[f"mesh.stiffness = {name}"] = {"mesh.stiffness": {"model": name}}
    return forms


def is_assumed(pair: GearPair, field: str) -> bool:
    """Return whether a value is assumed. For the tooth stiffness: whether the model is assumed."""
    return pair.state("mesh.stiffness.model" if field == "mesh.stiffness" else field) is State.ASSUMED


def _read(pair: GearPair, inputs: Iterable[Input], *, contact_lost: bool = False) -> frozenset[str]:
    """Fields that a pair reads, with the present laws and models and with every choice of the inputs."""
    read = fields_read(pair, contact_lost=contact_lost)
    for one in inputs:
        for place in range(len(one.choices)):
            with suppress(ParameterError):  # a law or model that the pair cannot have
                chosen = pair.with_(one.changes((place + 0.5) / len(one.choices)))
                read |= fields_read(chosen, contact_lost=contact_lost)
    return read & field_values(pair).keys()


def given_and_assumed(pair: GearPair, *, contact_lost: bool = False) -> tuple[int, int]:
    """Return the number of known and the number of assumed values on which the results depend.

    A value that the chosen laws and models do not read counts where another choice reads the value. The
    backlash counts where contact is lost.
    """
    read = read_values(pair, contact_lost=contact_lost)
    assumed = sum(path in pair.assumed for path in read)
    return len(read) - assumed, assumed


def read_values(pair: GearPair, *, contact_lost: bool = False) -> frozenset[str]:
    """Return the fields that `given_and_assumed` counts."""
    return _read(pair, uncertain_inputs(pair), contact_lost=contact_lost)


@functools.cache
def _defaults() -> tuple[dict[str, Any], ...]:
    text = files("validation.prediction").joinpath("defaults.toml").read_text(encoding="utf-8")
    return tuple(tomllib.loads(text)["spread"])


def _default(field: str) -> dict[str, Any] | None:
    return next((entry for entry in _defaults() if fnmatch.fnmatchcase(field, entry["field"])), None)


def source_of(pair: GearPair, field: str) -> str | None:
    """Return the source of a value in the words of the file; None: the file states no source.

    The source may be stated for the field, for its section, or for a field inside it.
    """
    sources = dict(pair.sources)
    parts = field.split(".")
    paths = [".".join(parts[: len(parts) - n]) for n in range(len(parts))]
    inside = [text for path, text in sources.items() if path.startswith(f"{field}.")]
    return next((sources[path] for path in paths if path in sources), inside[0] if inside else None)


def kind_of(field: str) -> str:
    """Return the kind of an input. The report gives one advice for all inputs of a kind."""
    first, *rest = field.split(".")
    if first == "shafts" and "bearings" in rest:
        return "shafts.bearings"
    if first in ("bearings", "friction", "lubricant", "operating"):
        return first
    if first in ("pinion", "gear"):
        return "relief" if rest[0] in ("tip_relief", "root_relief") else rest[0]
    return field


def _covered(field: str, stated: Mapping[str, Any]) -> bool:
    return any(field == one or field.startswith(f"{one}.") or one.startswith(f"{field}.") for one in stated)


def _chosen(pair: GearPair, field: str) -> str:
    return pair.mesh.stiffness.model if field == "mesh.stiffness" else pair.friction.law


def _by_default(pair: GearPair, field: str, spread: object, reason: str) -> Input | None:
    """An assumed input with the default range. An end that the field cannot take becomes the value.

    None: the range is empty, for example a share of zero.
    """
    if isinstance(spread, str):
        unit = str(stated_unit(field))
        value = to_stated(to_si(leaf_paths(pair)[field], unit), unit)
        low, high = (
            end if _allowed(pair, field, end) else value for end in _ends(field, spread, value, unit)
        )
        return (
            None
            if low == high
            else Input(field, (_part(field, (low, high), spread),), (), unit, spread, reason)
        )
    return _input(pair, field, spread, reason)


def _part(field: str, ends: tuple[float, float], spread: str) -> Part:
    """A field with its range, as the text states the range."""
    low, high = ends
    factors = _FACTORS.fullmatch(spread.strip()) is not None
    levels = TIP_LEVELS if field.split(".")[-1] in _TIP else 0
    return Part(field, low, high, low > 0.0 and (factors or high >= _WIDE * low), levels)


def _allowed(pair: GearPair, field: str, value: float) -> bool:
    try:
        pair.with_({field: value})
    except ParameterError:
        return False
    return True


def _input(pair: GearPair, field: str, spread: object, reason: str) -> Input:
    where = f"uncertainty.{field}"
    if isinstance(spread, (list, tuple)):
        choices = _CHOICES.get(field)
        wrong = choices is None or len(spread) < 2 or any(one not in choices for one in spread)
        if wrong:
            allowed = f"at least two of {', '.join(choices)}" if choices else f"a range: {_WRITTEN}"
            raise refuse(where, ", ".join(map(str, spread)), allowed, "Correct the list.")
        text = " or ".join(map(str, spread))
        return Input(field, (Part(field),), tuple(map(str, spread)), "1", text, reason)
    field_at(field)
    unit = stated_unit(field)
    value = leaf_paths(pair).get(field)
    if unit is None or isinstance(value, bool) or value is None or not isinstance(spread, str):
        raise refuse(where, spread, f"a field that has a number, and {_WRITTEN}", "Correct the entry.")
    low, high = _ends(where, spread, float(to_stated(to_si(value, unit), unit)), unit)
    if not low < high:
        raise refuse(where, spread, "a lower end below the upper end", "Correct the range.")
    for end in (low, high):
        try:
            pair.with_({field: end})
        except ParameterError as error:
            raise refuse(
                where,
                spread,
                f"values that {field} may have: {error.problems[0].allowed}",
                "Narrow the range.",
            ) from None
    return Input(field, (_part(field, (low, high), spread),), (), unit, spread, reason)


def _ends(where: str, spread: str, value: float, unit: str) -> tuple[float, float]:
    """Both ends of a written range, in the unit of the field."""
    text = spread.strip()
    if match := _FACTORS.fullmatch(text):
        factors = [
            float(x) if sign == "*" else 1.0 / float(x) for sign, x in (match.group(1, 2), match.group(3, 4))
        ]
        ends = value * factors[0], value * factors[1]
    elif match := _OFFSET.fullmatch(text):
        size = float(match[1])
        unit_of_size = match.group(2).strip()
        if unit_of_size == "%":
            half_width = abs(value) * size / 100.0
        elif unit == "degC":
            half_width = size  # a difference of temperatures, in K
        else:
            half_width = _stated(where, f"{size} {unit_of_size}" if unit_of_size else size, unit)
        ends = value - half_width, value + half_width
    elif text.count("..") == 1:
        low, high = (part.strip() for part in text.split(".."))
        ends = _stated(where, low, unit), _stated(where, high, unit)
    else:
        raise refuse(where, spread, _WRITTEN, "Correct the text.")
    return ends


def _stated(where: str, text: str | float, unit: str) -> float:
    try:
        number: str | float = float(text)
    except ValueError:
        number = text
    try:
        return to_stated(to_si(number, unit), unit)
    except ValueError as error:
        raise refuse(where, text, _WRITTEN, f"{error}.") from None
