"""Columns of a table with the meaning of their headings, and the channels that they are."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple

from lumped.arguments import nearest
from lumped.errors import ParameterError, refuse, shown
from validation.check.curves import Channel
from validation.check.quantities import QUANTITIES
from validation.check.reading.facts import Facts, finite, si_values
from validation.check.reading.meaning import Meaning, names_to_type, understood
from validation.check.reading.table import Column, listed


class _Use(NamedTuple):
    """A column with the meaning of its heading."""

    column: Column
    meaning: Meaning


def channels_of(columns: list[Column], samples: int, facts: Facts) -> tuple[Channel, ...]:
    """Channels of all columns with a known quantity, in SI."""
    uses, not_used = _used(columns)
    channels = []
    for use in uses:
        quantity = QUANTITIES[use.meaning.quantity]
        name = _channel_name(use.meaning)
        values = si_values(use.column, quantity.unit, facts, shown(use.column.heading))
        if values.shape != (samples,):
            action = "Give one value for each sample of the abscissa."
            raise refuse(shown(use.column.heading), f"{values.size} values", f"{samples} values", action)
        values = finite(values, shown(use.column.heading))
        channels.append(Channel(name, quantity.name, values, use.meaning.tooth_pair))
    _note_assumptions(uses, facts)
    note_not_used(not_used, facts)
    if not channels and not facts.statics:
        raise no_channel(not_used)
    return tuple(channels)


def _channel_name(meaning: Meaning) -> str:
    return meaning.quantity if meaning.tooth_pair is None else f"{meaning.quantity}_{meaning.tooth_pair}"


def _used(columns: Iterable[Column]) -> tuple[list[_Use], list[str]]:
    """Columns with a meaning, and headings of the others; two columns of one quantity are refused."""
    uses: list[_Use] = []
    not_used = []
    for column in columns:
        if column.tooth_pair is not None and column.heading in QUANTITIES:
            use = _Use(column, Meaning(column.heading, column.tooth_pair))
        elif (found := understood(column.heading)) is not None:
            unit = column.unit if column.unit is not None else found.heading.unit
            use = _Use(Column(column.heading, column.values, unit, damage=column.damage), found.meaning)
        else:
            not_used.append(column.heading)
            continue
        for other in uses:
            if _channel_name(other.meaning) == _channel_name(use.meaning):
                headings = f"{shown(other.column.heading)} and {shown(column.heading)}"
                allowed = f"one column of {_channel_name(use.meaning)}"
                raise refuse("theirs", headings, allowed, "Remove or rename one of the columns.")
        uses.append(use)
    return uses, not_used


def _note_assumptions(uses: list[_Use], facts: Facts) -> None:
    notes: dict[str, list[str]] = {}
    for use in uses:
        if use.meaning.assumption:
            notes.setdefault(use.meaning.assumption, []).append(use.column.heading)
    for assumption, headings in notes.items():
        verb = ": " if not assumption.startswith("is ") else " "
        facts.remarks.append(f"{listed(headings)}{verb}{assumption}.")


def note_not_used(not_used: list[str], facts: Facts) -> None:
    """Note columns that are not used, with names that are near to theirs."""
    not_used = [name for name in not_used if name.strip()]
    if not_used:
        count = f"{len(not_used)} columns were" if len(not_used) > 1 else "1 column was"
        near = [text for name in not_used[:3] if (text := nearest(name.lower(), names_to_type()))]
        facts.remarks.append(" ".join([f"{count} not used: {listed(not_used)}.", *dict.fromkeys(near)]))


def no_channel(not_used: list[str], further: str = "") -> ParameterError:
    """Return the refusal of a source of which no column is used; ``further``: what a name must also have."""
    near = next((text for name in not_used if (text := nearest(name.lower(), names_to_type()))), "")
    return refuse(
        "theirs",
        listed([shown(name) for name in not_used]) or "no column beside the abscissa",
        f"a column named by one of {', '.join(names_to_type())}{', with ' + further if further else ''}",
        near or "Rename the column, with its unit in brackets: 'dte [um]'.",
    )
