"""Values of motions over the speed: peak to peak, rms, mean and mesh orders."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from lumped.errors import refuse, shown
from lumped.typing import FloatArray
from validation.check.curves import SpeedColumn, ValuesOverSpeed
from validation.check.quantities import QUANTITIES
from validation.check.reading.channels import no_channel, note_not_used
from validation.check.reading.facts import Facts, finite, si_values
from validation.check.reading.headings import readings
from validation.check.reading.meaning import Value, understood, value_over_speed
from validation.check.reading.table import Column

#: Values that cannot be negative.
_SIZES = ("peak_to_peak", "rms", "order")


class _Use(NamedTuple):
    """A column with its value over speed and its quantity; an empty text: the heading names no quantity."""

    column: Column
    value: Value
    quantity: str


def values_over_speed(columns: list[Column], speeds: FloatArray, facts: Facts) -> ValuesOverSpeed:
    """Return the values of columns such as "dte peak-to-peak [um]" over pinion speeds (s,) [rad/s]."""
    uses = []
    not_used = []
    for column in columns:
        if use := _used(column):
            uses.append(use)
        else:
            not_used.append(column.heading)
    note_not_used(not_used, facts)
    quantities = {use.quantity for use in uses if use.quantity}
    values = []
    for use in uses:
        quantity = use.quantity
        heading = shown(use.column.heading)
        if not quantity:
            if len(quantities) != 1:
                action = f"Write the quantity before it, such as 'dte {heading}'."
                raise refuse(heading, "a value without quantity", "a quantity and a value", action)
            (quantity,) = quantities
            facts.remarks.append(f"{heading} is read as a value of {quantity}.")
        numbers = si_values(use.column, QUANTITIES[quantity].unit, facts, heading)
        values.append(SpeedColumn(heading, quantity, use.value.statistic, numbers, use.value.order))
    if not values:
        raise no_channel(not_used, "peak to peak, rms, mean or order 1 behind it, such as 'dte rms [um]'")
    return over_speed(speeds, values, facts)


def over_speed(speeds: FloatArray, values: list[SpeedColumn], facts: Facts) -> ValuesOverSpeed:
    """Return checked values in the order of the speeds.

    Raises
    ------
    ParameterError : two equal speeds, speeds that are not positive, values that are not finite or sizes that
        are negative, two columns of one value
    """
    order = np.argsort(speeds)
    rising = speeds[order]
    if rising.size and rising[0] <= 0.0:
        raise refuse("speed", f"{rising[0]:g} rad/s", "> 0", "Remove the row.")
    if (np.diff(rising) == 0.0).any():
        twice = float(rising[np.flatnonzero(np.diff(rising) == 0.0)[0]])
        action = "Keep one row for each speed: run-up or run-down."
        raise refuse("speed", f"{twice:g} rad/s twice", "different speeds", action)
    seen: dict[tuple[str, str, float], str] = {}
    columns = []
    for one in values:
        if one.values.shape != speeds.shape:
            action = "Give one value for each speed."
            raise refuse(one.name, f"{one.values.size} values", f"{speeds.size} values", action)
        finite(one.values, one.name)
        if one.statistic in _SIZES and (one.values < 0.0).any():
            raise refuse(one.name, f"{one.values.min():g}", ">= 0", "Give the size, without sign.")
        key = (one.quantity, one.statistic, one.order)
        if key in seen:
            action = "Remove or rename one of the columns."
            raise refuse("theirs", f"{seen[key]} and {one.name}", "one column of a value", action)
        seen[key] = one.name
        columns.append(replace(one, values=one.values[order]))
    return ValuesOverSpeed(
        facts.name, rising, tuple(columns), facts.role, facts.pinion_torque, facts.sentences
    )


def _used(column: Column) -> _Use | None:
    """Return a column with its value and quantity; None where the heading names no value."""
    for reading in readings(column.heading):
        value = value_over_speed(reading.words)
        if value is None:
            continue
        known = understood(value.words) if value.words else None
        if known is None and value.words:
            continue
        unit = column.unit if column.unit is not None else reading.unit
        if unit is None and known is not None:
            unit = known.heading.unit
        return _Use(replace(column, unit=unit), value, known.meaning.quantity if known else "")
    return None
