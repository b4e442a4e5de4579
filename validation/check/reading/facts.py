"""Facts beside the curves of a source, columns in SI, and the remarks on how both were read."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from lumped.arguments import one_of, real_number, whole_number
from lumped.errors import refuse, shown
from lumped.fields.units import to_si
from lumped.typing import FloatArray
from validation.check.curves import STATICS, Role
from validation.check.reading.headings import readings
from validation.check.reading.table import Column, Table, listed, numbers_of
from validation.check.reading.units import si_factor

#: Values whose squares can be summed.
LARGEST = 1e100


@dataclass
class Facts:
    """Facts beside the curves of a source.

    Attributes
    ----------
    name : short name of the source
    role : "model" or "measurement"
    pinion_speed : [rad/s]; None: not stated
    pinion_torque : [N m]; None: not stated
    recurrence : mesh cycles after which the same labelled tooth pair is in contact again; None: not stated
    statics : name in ``STATICS`` -> value in SI
    remarks : sentences on how the source was read
    without_unit : headings of the columns without unit
    """

    name: str
    role: Role = "model"
    pinion_speed: float | None = None
    pinion_torque: float | None = None
    recurrence: int | None = None
    statics: dict[str, FloatArray] = field(default_factory=dict)
    remarks: list[str] = field(default_factory=list)
    without_unit: list[str] = field(default_factory=list)

    @property
    def sentences(self) -> tuple[str, ...]:
        """All remarks, with one on the columns without unit."""
        if not self.without_unit:
            return tuple(self.remarks)
        return (*self.remarks, f"Columns without a unit are read in SI: {listed(self.without_unit)}.")


def si_values(column: Column, si: str, facts: Facts, field: str) -> FloatArray:
    """Return the real values of a column in SI; a column without unit is noted in ``facts``."""
    unit = column.unit
    values = real_values(column, field)
    if unit is None:
        if si not in ("1", ""):
            facts.without_unit.append(column.heading)
        return values
    return scaled(values, si_factor(unit, si, field), field)


def real_values(column: Column, field: str) -> FloatArray:
    """Return the values of a column, or refuse a damaged column and complex numbers."""
    if column.damage is not None:
        raise column.damage
    if column.values.dtype.kind == "c":
        if np.abs(column.values.imag).max(initial=0.0) > 0.0:
            action = "Give the real part, or amplitudes over 'order'."
            raise refuse(field, "complex numbers", "real numbers", action)
        return np.asarray(column.values.real)
    return np.asarray(column.values)


def scaled(values: FloatArray, factor: float, field: str) -> FloatArray:
    """Return values in SI, or refuse values whose squares cannot be summed."""
    with np.errstate(over="ignore", invalid="ignore"):
        result = np.asarray(values * factor)
    finite = result[np.isfinite(result)]
    if finite.size != np.isfinite(values).sum() or (np.abs(finite) >= LARGEST).any():
        largest = f"up to {np.abs(values).max():g} times {factor:g}"
        raise refuse(field, largest, f"< {LARGEST:g} in SI", "Check the numbers and their unit.")
    return result


def finite(values: FloatArray, name: str) -> FloatArray:
    """Return values that are all finite, or refuse the first other one."""
    bad = np.flatnonzero(~np.isfinite(values))
    if bad.size:
        raise refuse(name, f"{values[bad[0]]} in sample {bad[0] + 1}", "finite values", "Repair the sample.")
    return values


def stated_facts(table: Table) -> Facts:
    """Return the facts that a table states beside its columns."""
    facts = Facts(table.name, recurrence=table.recurrence, remarks=list(table.remarks))
    not_used = []
    for heading, value in table.stated.items():
        if not _use_fact(heading, value, facts):
            not_used.append(heading)
    if not_used:
        facts.remarks.append(f"Not used: {listed(not_used)}.")
    return facts


def _use_fact(heading: str, value: Any, facts: Facts) -> bool:
    """Put a stated value among the facts; False where its name is unknown."""
    reading = next((r for r in readings(heading) if _fact_name(r.words) is not None), None)
    if reading is None:
        return False
    name = str(_fact_name(reading.words))
    if name == "role":
        facts.role = (
            "measurement" if one_of("role", str(value), ("model", "measurement")) != "model" else "model"
        )
    elif name == "name":
        facts.name = shown(str(value))
    elif name == "recurrence":
        facts.recurrence = whole_number("recurrence", _single(value), 1, 1_000_000)
    elif name in ("pinion_speed", "pinion_torque"):
        _use_operating_point(name, value, reading.unit, facts)
    else:
        _use_static(name, value, reading.unit, facts)
    return True


def _fact_name(words: str) -> str | None:
    names = (*STATICS, "pinion_speed", "pinion_torque", "recurrence", "role", "name")
    plain = words.strip().replace(" ", "_")
    return plain if plain in names else next((name for name in names if name.lower() == plain.lower()), None)


def _single(value: Any) -> Any:
    """The number of an array with one number."""
    array = numbers_of(value)
    if array is None or array.size != 1:
        return value
    number = array.ravel()[0]
    return int(number) if float(np.real(number)).is_integer() else float(np.real(number))


def _use_operating_point(name: str, value: Any, unit: str | None, facts: Facts) -> None:
    stated, example = ("rpm", "4000 rpm") if name == "pinion_speed" else ("N*m", "56.5 N*m")
    number = _single(value)
    if isinstance(number, str):
        try:
            result = to_si(number, stated)
        except ValueError as error:
            raise refuse(name, number, f"a text such as '{example}'", f"{error}.") from None
    elif unit is None and name == "pinion_speed":
        action = "Write its unit: 'pinion_speed [rpm]' or 'pinion_speed [rad/s]'."
        raise refuse(name, number, "a speed with a unit", action)
    else:
        si = "rad/s" if name == "pinion_speed" else "N*m"
        result = float(real_number(name, number)) * (si_factor(unit, si, name) if unit else 1.0)
    result = real_number(name, result, 0.0, above=True)
    if name == "pinion_speed":
        facts.pinion_speed = result
    else:
        facts.pinion_torque = result


def _use_static(name: str, value: Any, unit: str | None, facts: Facts) -> None:
    array = numbers_of(value)
    if array is None or array.dtype.kind != "f" or not array.size or not np.isfinite(array).all():
        raise refuse(name, shown(value), "finite numbers", "Correct the value, or leave it out.")
    factor = si_factor(unit, STATICS[name], name) if unit else 1.0
    matrix = name in ("M", "K")
    array = (
        np.atleast_2d(array)
        if matrix
        else array.ravel()
        if name == "natural_frequencies"
        else np.squeeze(array)
    )
    if (matrix and (array.ndim != 2 or array.shape[0] != array.shape[1])) or (
        not matrix and name != "natural_frequencies" and array.ndim
    ):
        allowed = "a square matrix" if matrix else "one number"
        raise refuse(name, f"shape {array.shape}", allowed, "Correct the value, or leave it out.")
    facts.statics[name] = np.asarray(array * factor)
