"""Amplitudes over the mesh order: curves over a mesh cycle with phases, values at one speed without.

With amplitude a_m and phase p_m of order m a channel is the sum of a_m cos(2 pi m s + p_m) over the mesh
cycles s. A complex amplitude is U_m = a_m exp(i p_m). Amplitudes are peak values; order 0 is the mean.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from lumped.errors import refuse, shown
from lumped.schema.pair import GearPair
from lumped.typing import ComplexArray, FloatArray, IntArray
from validation.check.curves import Channel, Curves, SpeedColumn, ValuesOverSpeed
from validation.check.quantities import QUANTITIES
from validation.check.reading.channels import no_channel, note_not_used
from validation.check.reading.facts import Facts, scaled
from validation.check.reading.headings import readings
from validation.check.reading.meaning import Meaning, Part, Understood, part_of_order, understood
from validation.check.reading.over_speed import over_speed
from validation.check.reading.table import Column
from validation.check.reading.units import si_factor

#: Highest mesh order from which curves are made.
_HIGHEST = 4096
#: Samples of a mesh cycle: at least this many, and at least this many for each order.
_SAMPLES = 256
_SAMPLES_PER_ORDER = 8
#: Distance of a mesh order from a whole number that rounding makes.
_ROUNDING = 1e-6


class OrderColumn(NamedTuple):
    """A column in SI, a phase in rad: which part of the complex amplitude of which quantity it holds."""

    heading: str
    quantity: str
    tooth_pair: str | None
    part: Part
    values: ComplexArray | FloatArray


class _Spectrum(NamedTuple):
    """Complex or real amplitudes (m,) of a quantity.

    Attributes
    ----------
    heading : heading of the first column
    quantity : name of the quantity
    tooth_pair : label of the tooth pair; None: a quantity of the mesh
    amplitudes : (m,) in SI; real and not negative where the phase is not known
    has_phase : whether the phase is known
    """

    heading: str
    quantity: str
    tooth_pair: str | None
    amplitudes: ComplexArray
    has_phase: bool


def curves_of_orders(
    columns: list[Column], orders: FloatArray, facts: Facts, pair: GearPair
) -> Curves | ValuesOverSpeed:
    """Return curves over a mesh cycle, or amplitudes at the speed of the pair where phases are missing."""
    uses: list[OrderColumn] = []
    not_used = []
    quantities = {known.meaning for c in columns if (known := _known(c)) is not None}
    alone = next(iter(quantities)) if len(quantities) == 1 else None
    for column in columns:
        if use := _used(column, facts, orders.size, alone):
            uses.append(use)
        else:
            not_used.append(column.heading)
    note_not_used(not_used, facts)
    if not uses:
        raise no_channel(not_used)
    return curves_of_parts(uses, orders, facts, pair)


def curves_of_parts(
    parts: list[OrderColumn], orders: FloatArray, facts: Facts, pair: GearPair
) -> Curves | ValuesOverSpeed:
    """Return curves over a mesh cycle, or amplitudes at one speed, of parts in SI at orders (m,)."""
    whole = _whole_orders(orders, facts)
    spectra = _spectra(parts)
    if all(one.has_phase for one in spectra):
        return _synthesised(spectra, whole, orders, facts)
    speed = facts.pinion_speed or float(pair.operating.pinion_speed)
    values = [
        SpeedColumn(
            f"{one.heading}, order {int(np.rint(order))}", one.quantity, "order",
            np.array([np.abs(amplitude)]), float(np.rint(order)),
        )
        for one in spectra
        for order, amplitude in zip(orders[whole], one.amplitudes[whole], strict=True)
        if order > _ROUNDING
    ]  # fmt: skip
    facts.remarks.append("No phases are given: amplitudes of the orders are read, at one speed.")
    return over_speed(np.array([speed]), values, facts)


def _known(column: Column) -> Understood | None:
    """Quantity that the heading of a column names beside the part of a complex amplitude."""
    found = (understood(part_of_order(reading.words).words) for reading in readings(column.heading))
    return next((one for one in found if one is not None), None)


def _used(column: Column, facts: Facts, count: int, alone: Meaning | None) -> OrderColumn | None:
    """Return a column with its part of a complex amplitude; None where its heading names no quantity.

    A heading that names only the part, such as "phase", belongs to ``alone``, the only quantity.
    """
    for reading in readings(column.heading):
        part = part_of_order(reading.words)
        known = understood(part.words)
        meaning = known.meaning if known is not None else alone if not part.words else None
        if meaning is None:
            continue
        stated = reading.unit or (known.heading.unit if known is not None else None)
        unit = column.unit if column.unit is not None else stated
        values = _in_si(column, meaning.quantity, part.part, unit, facts, count)
        return OrderColumn(column.heading, meaning.quantity, meaning.tooth_pair, part.part, values)
    return None


def _in_si(
    column: Column, quantity: str, part: Part, unit: str | None, facts: Facts, count: int
) -> ComplexArray | FloatArray:
    name = shown(column.heading)
    if column.damage is not None:
        raise column.damage
    if column.values.shape != (count,):
        raise refuse(name, f"{column.values.size} values", f"{count} values", "Give one for each order.")
    if not np.isfinite(column.values).all():
        raise refuse(name, "a value that is not finite", "finite values", "Repair the row.")
    si = "rad" if part == "phase" else QUANTITIES[quantity].unit
    if unit is None:
        facts.without_unit.append(column.heading)
        return column.values
    factor = si_factor(unit, si, name)
    if column.values.dtype.kind == "c":
        return np.asarray(
            scaled(column.values.real, factor, name) + 1j * scaled(column.values.imag, factor, name)
        )
    return scaled(column.values, factor, name)


def _whole_orders(orders: FloatArray, facts: Facts) -> IntArray:
    """Indices of the rows with whole mesh orders."""
    if (orders < 0.0).any():
        raise refuse(
            "order", f"{orders.min():g}", ">= 0", "Give one-sided amplitudes, which are peak values."
        )
    whole = np.flatnonzero((np.abs(orders - np.rint(orders)) < _ROUNDING) & (orders <= _HIGHEST))
    if whole.size < orders.size:
        facts.remarks.append(f"{orders.size - whole.size} rows are no whole mesh order and are not used.")
    used = np.rint(orders[whole])
    if np.unique(used).size < used.size:
        raise refuse("order", "an order twice", "different orders", "Remove one of the rows.")
    if not (used > 0.0).any():
        allowed = "mesh orders 1, 2, ..."
        raise refuse("order", "no whole mesh order", allowed, "Divide shaft orders by the number of teeth.")
    return whole


def _spectra(uses: list[OrderColumn]) -> list[_Spectrum]:
    """Complex amplitudes of each quantity from its parts."""
    groups: dict[tuple[str, str | None], dict[str, OrderColumn]] = {}
    for use in uses:
        parts = groups.setdefault((use.quantity, use.tooth_pair), {})
        if use.part in parts:
            headings = f"{shown(parts[use.part].heading)} and {shown(use.heading)}"
            raise refuse("theirs", headings, "one column of each part", "Remove one of the columns.")
        parts[use.part] = use
    return [_spectrum(parts) for parts in groups.values()]


def _spectrum(parts: dict[str, OrderColumn]) -> _Spectrum:
    """Complex amplitudes of one quantity."""
    first = next(iter(parts.values()))
    values = {part: use.values for part, use in parts.items()}
    has_phase = True
    amplitudes: Any
    if set(values) == {"real", "imag"}:
        amplitudes = values["real"] + 1j * values["imag"]
    elif set(values) == {"amplitude", "phase"}:
        amplitudes = values["amplitude"] * np.exp(1j * values["phase"])
    elif set(values) == {"amplitude"}:
        amplitudes = values["amplitude"]
        has_phase = amplitudes.dtype.kind == "c"
    else:
        stated = ", ".join(sorted(values))
        allowed = "amplitude alone, amplitude and phase, or real and imag"
        action = f"Name the columns '{first.quantity} amplitude' and '{first.quantity} phase [deg]'."
        raise refuse(shown(first.heading), stated, allowed, action)
    return _Spectrum(
        first.heading,
        first.quantity,
        first.tooth_pair,
        np.asarray(amplitudes, dtype=np.complex128),
        has_phase,
    )


def _synthesised(spectra: list[_Spectrum], whole: IntArray, orders: FloatArray, facts: Facts) -> Curves:
    """Curves over one mesh cycle from complex amplitudes."""
    used = np.rint(orders[whole])
    count = max(_SAMPLES, _SAMPLES_PER_ORDER * int(used.max()))
    places = np.arange(count) / count
    channels = []
    for one in spectra:
        values = np.zeros(count)
        for order, amplitude in zip(used, one.amplitudes[whole], strict=True):
            wave = np.exp(2j * np.pi * np.mod(order * np.arange(count), count) / count)
            values += (amplitude * wave).real
        name = one.quantity + (f"_{one.tooth_pair}" if one.tooth_pair else "")
        channels.append(Channel(name, one.quantity, values, one.tooth_pair))
    facts.remarks.append(f"The curves are made of {used.size} mesh orders.")
    return Curves(
        facts.name, "mesh_cycles", places, tuple(channels), facts.role, facts.pinion_speed,
        facts.pinion_torque, facts.recurrence, facts.statics, facts.sentences,
    )  # fmt: skip
