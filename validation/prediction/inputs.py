"""Inputs of a pair that are not known exactly, and what each may be: as stated, or by documented defaults.

A range is log-uniform where both ends are positive and one is at least twice the other, else uniform.
"""

from __future__ import annotations

import fnmatch
import functools
import re
import tomllib
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from importlib.resources import files
from typing import Any

from lumped.errors import ParameterError, refuse
from lumped.fields.units import to_si, to_stated
from lumped.friction.registry import LAWS
from lumped.schema.assumed import State
from lumped.schema.fields_read import fields_read
from lumped.schema.pair import GearPair, field_at, leaf_paths, stated_unit
from lumped.stiffness.registry import MODELS

_NUMBER = r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)"
_OFFSET = re.compile(rf"\+-\s*{_NUMBER}\s*(.*)")
_FACTORS = re.compile(rf"([*/])\s*{_NUMBER}\s*\.\.\s*([*/])\s*{_NUMBER}\s*")
_WRITTEN = "'0.02 .. 0.10', '+- 2 um', '+- 10 %', '/ 2 .. * 2', or a list of choices"
#: A range whose upper end is at least this many times the lower one is log-uniform.
_WIDE = 2.0
#: Seeds of random gears of a tolerance class run from 1 to here.
_SEEDS = 2**31
#: Field -> the names that a choice may have.
_CHOICES: Mapping[str, tuple[str, ...]] = {"friction.law": tuple(LAWS), "mesh.stiffness": tuple(MODELS)}


@dataclass(frozen=True)
class Input:
    """One value that is not known exactly: ends of its range in file units, NaN where it has ``choices``.

    ``written`` is the spread as the file or the default states it, ``reason`` why so far.
    """

    field: str
    low: float
    high: float
    choices: tuple[str, ...]
    unit: str
    written: str
    reason: str

    def at(self, share: float) -> float | str:
        """The value that a share of the distribution lies below, in file units."""
        if self.field.endswith(".seed"):
            return int(self.low + (self.high - self.low) * share)
        if self.choices:
            return self.choices[min(int(share * len(self.choices)), len(self.choices) - 1)]
        if self.low > 0.0 and self.high >= _WIDE * self.low:
            return float(self.low * (self.high / self.low) ** share)
        return self.low + (self.high - self.low) * share

    def change(self, value: float | str) -> tuple[str, Any]:
        """Field and value as ``GearPair.with_`` takes them."""
        return self.field, {"model": value} if self.field == "mesh.stiffness" else value


def uncertain_inputs(pair: GearPair) -> tuple[Input, ...]:
    """Return every input of a pair that may be another value than the file has.

    Those of ``[uncertainty]``, and by documented defaults every assumed value that the pair reads, or would
    read with another law or model that its inputs may be. A spread that cannot be read, or with values that
    the field cannot have, is refused. Of random teeth of a tolerance class the seed is an input.
    """
    stated = dict(pair.uncertainty)
    found = [_input(pair, field, spread, "stated in the file") for field, spread in stated.items()]
    for gear in ("pinion", "gear"):
        deviations = getattr(pair, gear).deviations
        if deviations is not None and deviations.tolerance_class is not None:
            words = f"class {deviations.tolerance_class}"
            reason = "the class says how large errors are, and not which: every seed is another gear of it"
            found.append(Input(f"{gear}.deviations.seed", 1, _SEEDS, (), "1", words, reason))
    candidates = [*leaf_paths(pair), "mesh.stiffness", "mesh.stiffness_factor"]
    assumed: list[Input] = []
    for field in dict.fromkeys(candidates):
        default = _default(field)
        if default is None or _covered(field, stated):
            continue
        if is_assumed(pair, default.get("with", field)):
            if field == "mesh.stiffness" and pair.mesh.stiffness.model == "table":
                continue
            spread = default["spread"]
            if isinstance(spread, list):
                spread = list(dict.fromkeys([_chosen(pair, field), *spread]))
            if (value := _by_default(pair, field, spread, default["reason"])) is not None:
                assumed.append(value)
    read = _read(pair, [*found, *assumed])
    return (*found, *(one for one in assumed if one.choices or one.field in read))


def is_assumed(pair: GearPair, field: str) -> bool:
    """Whether a value is assumed; of the stiffness of the teeth, whether its model is."""
    return pair.state("mesh.stiffness.model" if field == "mesh.stiffness" else field) is State.ASSUMED


def _read(pair: GearPair, inputs: Iterable[Input], *, contact_lost: bool = False) -> frozenset[str]:
    """Fields that a pair reads with its laws and models, and with those that its inputs may be instead."""
    read = fields_read(pair, contact_lost=contact_lost)
    for one in inputs:
        for name in one.choices:
            with suppress(ParameterError):  # a law or model that the pair cannot have
                read |= fields_read(pair.with_(dict([one.change(name)])), contact_lost=contact_lost)
    return read & leaf_paths(pair).keys()


def given_and_assumed(pair: GearPair, *, contact_lost: bool = False) -> tuple[int, int]:
    """Number of values of a pair that are known, and that are assumed, of those that its results depend on.

    What the chosen laws and models do not read counts where a choice that is an uncertain input reads it, and
    the backlash where contact is lost.
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
    """Where a value of a pair comes from, in the words of the file; None where it does not say.

    It is the source of the field, of the section that it is in, or of a field inside it.
    """
    sources, parts = dict(pair.sources), field.split(".")
    paths = [".".join(parts[: len(parts) - n]) for n in range(len(parts))]
    inside = [text for path, text in sources.items() if path.startswith(f"{field}.")]
    return next((sources[path] for path in paths if path in sources), inside[0] if inside else None)


def kind_of(field: str) -> str:
    """Kind of an input: inputs of one kind are found out in the same way, by the advice of the report."""
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
    """An assumed input with its default spread; an end that the field cannot have is the value itself.

    None where nothing is left of the spread: a share of zero.
    """
    if isinstance(spread, str):
        unit = str(stated_unit(field))
        value = to_stated(to_si(leaf_paths(pair)[field], unit), unit)
        low, high = (
            end if _allowed(pair, field, end) else value for end in _ends(field, spread, value, unit)
        )
        return None if low == high else Input(field, low, high, (), unit, spread, reason)
    return _input(pair, field, spread, reason)


def _allowed(pair: GearPair, field: str, value: float) -> bool:
    try:
        pair.with_({field: value})
    except ParameterError:
        return False
    return True


def _input(pair: GearPair, field: str, spread: object, reason: str) -> Input:
    where = f"uncertainty.{field}"
    if isinstance(spread, (list, tuple)):
        known = _CHOICES.get(field)
        wrong = known is None or len(spread) < 2 or any(one not in known for one in spread)
        if wrong:
            allowed = f"at least two of {', '.join(known)}" if known else f"a range: {_WRITTEN}"
            raise refuse(where, ", ".join(map(str, spread)), allowed, "Correct the list.")
        text = " or ".join(map(str, spread))
        return Input(field, float("nan"), float("nan"), tuple(map(str, spread)), "1", text, reason)
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
    return Input(field, low, high, (), unit, spread, reason)


def _ends(where: str, spread: str, value: float, unit: str) -> tuple[float, float]:
    """Both ends of a written range in the field's unit."""
    text = spread.strip()
    if match := _FACTORS.fullmatch(text):
        factors = [
            float(x) if sign == "*" else 1.0 / float(x) for sign, x in (match.group(1, 2), match.group(3, 4))
        ]
        ends = value * factors[0], value * factors[1]
    elif match := _OFFSET.fullmatch(text):
        size, of = float(match[1]), match[2].strip()
        if of == "%":
            off = abs(value) * size / 100.0
        elif unit == "degC":
            off = size  # a difference of temperatures, in K
        else:
            off = _stated(where, f"{size} {of}" if of else size, unit)
        ends = value - off, value + off
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
