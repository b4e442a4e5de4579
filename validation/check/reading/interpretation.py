"""A table becomes curves or values over speed, by the meaning of its headings."""

from __future__ import annotations

from typing import Any

import numpy as np

from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.check.curves import FEWEST_SAMPLES, Channel, Curves, ValuesOverSpeed
from validation.check.reading.abscissa import Place, abscissa_place, mesh_cycles, no_abscissa
from validation.check.reading.channels import channels_of
from validation.check.reading.facts import Facts, stated_facts
from validation.check.reading.over_speed import values_over_speed
from validation.check.reading.spectrum import curves_of_orders
from validation.check.reading.table import Table


def interpreted(table: Table, pair: GearPair) -> Curves | ValuesOverSpeed:
    """Return the curves of a table whose headings say what its columns are."""
    facts = stated_facts(table)
    place = abscissa_place(table, facts, pair)
    if place is None:
        if not table.columns and facts.statics:
            return curves("time", np.zeros(0), (), facts)
        raise no_abscissa(table)
    columns = [column for column in table.columns if column.heading != place.heading]
    if place.kind == "speed":
        return values_over_speed(columns, place.values, facts)
    if place.kind == "order":
        return curves_of_orders(columns, place.values, facts, pair)
    channels = channels_of(columns, place.values.size, facts)
    return curves_over(place, channels, facts, pair)


def curves_over(place: Place, channels: tuple[Channel, ...], facts: Facts, pair: GearPair) -> Curves:
    """Return curves over time, mesh phase or an angle."""
    if place.kind == "time":
        return curves("time", place.values, channels, facts)
    return curves("mesh_cycles", mesh_cycles(place, pair), channels, facts)


def curves(abscissa: Any, places: FloatArray, channels: tuple[Channel, ...], facts: Facts) -> Curves:
    """Return curves with their facts; of samples at equal places the last one counts."""
    channels = tuple(unwrapped(channel, facts) for channel in channels)
    if channels and places.size >= FEWEST_SAMPLES:
        last = np.append(np.diff(places) != 0.0, True)
        if not last.all():
            facts.remarks.append(f"{np.count_nonzero(~last)} samples at a repeated {abscissa} are left out.")
            places = places[last]
            channels = tuple(
                Channel(one.name, one.quantity, one.values[last], one.tooth_pair, one.noise)
                if one.values.shape == last.shape
                else one
                for one in channels
            )
    return Curves(
        facts.name, abscissa, places, channels, facts.role, facts.pinion_speed, facts.pinion_torque,
        facts.recurrence, facts.statics, facts.sentences,
    )  # fmt: skip


def unwrapped(channel: Channel, facts: Facts) -> Channel:
    """Return a channel whose angles do not jump by a turn."""
    if channel.quantity not in ("theta_p", "theta_g") or not np.isfinite(channel.values).all():
        return channel
    values = np.unwrap(channel.values)
    if np.array_equal(values, channel.values):
        return channel
    facts.remarks.append(f"Jumps of {channel.name} by a whole turn are taken out.")
    return Channel(channel.name, channel.quantity, values, channel.tooth_pair, channel.noise)
