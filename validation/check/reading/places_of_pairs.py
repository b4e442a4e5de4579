"""Loads of tooth pairs by their place in the mesh become loads of labelled tooth pairs.

A result of this program has a column for each place: in place 0 is the pair that is ahead, and after each
mesh cycle every pair moves on to the place before. With P places the pair in a place is the same again after
P mesh cycles, if the label of the pair that leaves is given to the pair that enters.
"""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np

from lumped.errors import refuse
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray, IntArray
from validation.check.quantities import PAIR_LABELS
from validation.check.reading.headings import readings
from validation.check.reading.meaning import abscissa
from validation.check.reading.table import Column, Table
from validation.check.reading.units import si_factor

_PLACE = re.compile(r"(normal_load|friction_force|position)_pair(\d+)")
#: Labels beyond the number of places, where the loads say which pair is in which place.
_MORE_LABELS = 2
#: Fewest mesh cycles in which the handover is searched, and the share of the cycles that must show it.
_FEWEST_CYCLES = 1.5
_CYCLES_SEEN = 0.7
#: Jump of all loads at a handover over the largest load, at least.
_JUMPS = 0.2
#: Length of the mean of the unit vectors at the phases of the handovers, at least: all in one phase.
_SAME_PHASE = 0.98
#: What remains of the jumps at a handover if every pair moves on by one place, at most.
_HANDED = 0.25
#: Part of a mesh cycle by which rounding moves the end of a cycle.
_ROUNDING = 1e-6


def heading_of_place(name: str, place: int) -> str:
    """Return the heading of a column of one place."""
    return f"{name}_pair{place}"


def with_labels(table: Table, pair: GearPair) -> Table:
    """Return a table whose loads are those of labelled tooth pairs.

    Positions of the contacts in the same table say which pair is in which place. Without positions the loads
    say so, if each pair hands its load to the next place once in a mesh cycle (``handover``). Else place 0 is
    tooth pair A, place 1 is B and so on.
    """
    names: dict[str, dict[int, Column]] = {}
    others = []
    for column in table.columns:
        match = _PLACE.fullmatch(next((reading.words for reading in readings(column.heading)), ""))
        unit = next((r.unit for r in readings(column.heading)), None) if column.unit is None else column.unit
        if match:
            names.setdefault(match[1], {})[int(match[2])] = replace(column, unit=unit)
        else:
            others.append(column)
    positions = names.pop("position", {})
    if not names:
        return table
    count = max(len(columns) for columns in names.values())
    if count > len(PAIR_LABELS) or any(sorted(c) != list(range(len(c))) for c in names.values()):
        allowed = f"places 0, 1, ... of at most {len(PAIR_LABELS)} tooth pairs"
        raise refuse("pair", f"{count} places", allowed, "Leave out the loads of the tooth pairs.")
    ahead = _ahead(positions, others, count, pair)
    if ahead is None and (entered := _handed_over(names, others, pair)) is not None:
        # More labels than places: with loaded contact a pair of ours touches earlier and later than theirs.
        labels = min(count + _MORE_LABELS, len(PAIR_LABELS))
        columns = [
            Column(name, values, places[0].unit, tooth_pair=PAIR_LABELS[label])
            for name, places in names.items()
            for label, values in enumerate(_by_label(places, entered, labels))
        ]
        return replace(table, columns=(*others, *columns), recurrence=labels)
    columns = [
        Column(name, values, places[0].unit, tooth_pair=PAIR_LABELS[label])
        for name, places in names.items()
        for label, values in enumerate(_by_label(places, ahead))
    ]
    recurrence = table.recurrence if ahead is None else count
    return replace(table, columns=(*others, *columns), recurrence=recurrence)


def _handed_over(
    names: dict[str, dict[int, Column]], others: list[Column], pair: GearPair
) -> IntArray | None:
    """Mesh cycle (place, sample) in which the pair of each place has entered, by the loads alone.

    None: the loads are not handed from place to place.
    """
    time = _times(others)
    places = names.get("normal_load", next(iter(names.values())))
    if time is None or any(column.values.shape != time.shape for column in places.values()):
        return None
    loads = np.stack([places[place].values for place in range(len(places))]).astype(np.float64)
    cycles = time / pair.geometry.mesh_period
    return entered_by_handover(loads, cycles)


def entered_by_handover(loads: FloatArray, cycles: FloatArray) -> IntArray | None:
    """Return the mesh cycle (place, sample) in which the pair of each place has entered.

    Where a mesh cycle begins, every pair moves on by one place. The load of a place then jumps to the load
    that the place beside it had. None: there is no such phase of the mesh cycle.

    Parameters
    ----------
    loads : (place, sample)
    cycles : (sample,) mesh cycles, increasing
    """
    if len(loads) < 2 or np.ptp(cycles) < _FEWEST_CYCLES:
        return None
    before, after = loads[:, :-1], loads[:, 1:]
    jump = np.abs(after - before).sum(axis=0)
    large = jump > _JUMPS * np.abs(loads).max()
    no_pair = np.zeros((1, before.shape[1]))
    for step in (1, -1):  # place 0 holds the pair that leaves, or the pair that enters
        moved = np.vstack([before[1:], no_pair]) if step == 1 else np.vstack([no_pair, before[:-1]])
        newest = -1 if step == 1 else 0
        # The pair that enters may have any load.
        rest = np.delete(np.abs(after - moved), newest, axis=0).sum(axis=0)
        handed = np.flatnonzero(large & (rest < _HANDED * jump))
        turns = np.exp(2j * np.pi * 0.5 * (cycles[handed] + cycles[handed + 1]))
        enough = handed.size >= _CYCLES_SEEN * np.floor(np.ptp(cycles))
        if enough and abs(turns.mean()) > _SAME_PHASE:
            start = float(np.angle(turns.mean())) / (2.0 * np.pi)
            break
    else:
        return None
    cycle = np.floor(cycles - start).astype(np.int64)
    place = np.arange(len(loads))[:, None]
    oldest = len(loads) - 1
    entered = cycle - (oldest - place if step == 1 else place)
    return np.asarray(entered - entered.min())


def _by_label(
    places: dict[int, Column], ahead: IntArray | None, labels: int | None = None
) -> list[FloatArray]:
    """Values of each labelled pair, from the values of each place. ``labels``: number of labels."""
    stacked = np.stack([places[place].values for place in range(len(places))])
    if ahead is None or ahead.shape != stacked.shape:
        return list(stacked)
    count = labels or len(stacked)
    result = np.zeros((count, stacked.shape[1]), dtype=stacked.dtype)
    for place in range(len(stacked)):
        # The pair that is n pitches ahead of A in mesh cycle c has entered in cycle c - n.
        label = np.mod(ahead[place], count)
        result[label, np.arange(stacked.shape[1])] = stacked[place]
    return list(result)


def _ahead(positions: dict[int, Column], others: list[Column], count: int, pair: GearPair) -> IntArray | None:
    """Mesh cycle (place, sample) in which the pair of each place has entered; None: it is not known."""
    time = _times(others)
    if len(positions) != count or time is None:
        return None
    g = pair.geometry
    cycles = time / g.mesh_period
    cycle = np.floor(cycles + _ROUNDING)
    entered = []
    for place in range(count):
        column = positions[place]
        if column.values.shape != time.shape or not np.isfinite(column.values).all():
            return None
        position = column.values * (si_factor(column.unit, "m", "position") if column.unit else 1.0)
        pitches = (position - g.L_XA) / g.base_pitch - (cycles - cycle)
        entered.append(cycle - np.rint(np.median(pitches)))
    return np.asarray(entered, dtype=np.int64)


def _times(columns: list[Column]) -> FloatArray | None:
    for column in columns:
        for reading in readings(column.heading):
            if abscissa(reading.words) == "time" and column.values.dtype.kind == "f":
                unit = column.unit or reading.unit
                return np.asarray(column.values * (si_factor(unit, "s", "time") if unit else 1.0))
    return None
