"""Where the samples of a table lie: time, mesh phase, angle of a gear, mesh order or speed."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from lumped.errors import ParameterError, refuse, shown
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from validation.check.reading.facts import Facts, finite, real_values, scaled
from validation.check.reading.meaning import AbscissaKind, abscissa_of, understood
from validation.check.reading.table import Column, Table, listed
from validation.check.reading.units import converts, si_factor

#: Least part of a pitch over which angles are an abscissa.
_LEAST_TURN = 0.5
#: Abscissa -> SI unit.
SI_OF_ABSCISSA: dict[AbscissaKind, str] = {
    "time": "s", "pinion_angle": "rad", "gear_angle": "rad", "speed": "rad/s", "gear_speed": "rad/s",
    "order": "1",
}  # fmt: skip
_ABSCISSAE = "time [s], mesh phase, pinion angle [rad], gear angle [rad], order, speed [rpm]"


class Place(NamedTuple):
    """Abscissa of a table: its kind, its values in SI or mesh cycles, and the heading of its column."""

    kind: AbscissaKind
    values: FloatArray
    heading: str


def mesh_cycles(place: Place, pair: GearPair) -> FloatArray:
    """Return the mesh cycles of places that are mesh phases or angles."""
    if place.kind == "mesh_phase":
        return place.values
    teeth = pair.pinion.teeth if place.kind == "pinion_angle" else pair.gear.teeth
    return np.asarray(np.unwrap(place.values) * teeth / (2.0 * np.pi))


def abscissa_place(table: Table, facts: Facts, pair: GearPair) -> Place | None:
    """Abscissa of a table: time before mesh phase, order, angles and speed."""
    candidates: dict[AbscissaKind, list[tuple[Column, str | None]]] = {}
    for column in table.columns:
        if found := abscissa_of(column.heading):
            kind, heading = found
            candidates.setdefault(kind, []).append((column, column.unit or heading.unit))
    candidates = {kind: _with_fitting_unit(kind, named) for kind, named in candidates.items()}
    for kind in ("time", "order", "mesh_phase"):
        if candidates.get(kind):
            return _placed(kind, candidates[kind], facts)
    for kind, quantity in (("pinion_angle", "theta_p"), ("gear_angle", "theta_g")):
        named = candidates.get(kind) or _columns_of(table, quantity)
        if named:
            place = _placed(kind, named[:1], facts)
            if _turns(place, pair):
                return place
    for kind in ("speed", "gear_speed"):
        if candidates.get(kind):
            place = _placed(kind, candidates[kind], facts)
            ratio = pair.gear.teeth / pair.pinion.teeth
            return place if kind == "speed" else Place("speed", place.values * ratio, place.heading)
    return None


def _with_fitting_unit(
    kind: AbscissaKind, named: list[tuple[Column, str | None]]
) -> list[tuple[Column, str | None]]:
    """Columns whose unit is one of the abscissa; all columns where no unit is, so that they are refused.

    In the columns t [s] and T [N m] the second one is no time.
    """
    units = ("1", "rad") if kind == "mesh_phase" else (SI_OF_ABSCISSA[kind],)
    fitting = [
        (column, unit) for column, unit in named if unit is None or any(converts(unit, si) for si in units)
    ]
    return fitting or named


def _columns_of(table: Table, quantity: str) -> list[tuple[Column, str | None]]:
    """Columns of a quantity with their units."""
    found = ((column, understood(column.heading)) for column in table.columns)
    return [
        (column, column.unit or u.heading.unit) for column, u in found if u and u.meaning.quantity == quantity
    ]


def _turns(place: Place, pair: GearPair) -> bool:
    """Whether angles increase over at least half a pitch: they place the samples, they are no deviation."""
    cycles = mesh_cycles(place, pair)
    increasing = cycles.size > 1 and bool((np.diff(cycles) > 0.0).all())
    return increasing and float(cycles[-1] - cycles[0]) > _LEAST_TURN


def _placed(kind: AbscissaKind, named: list[tuple[Column, str | None]], facts: Facts) -> Place:
    """Values of the column of an abscissa in SI; of several columns only equal ones are allowed."""
    column, unit = named[0]
    for other, _ in named[1:]:
        if not np.array_equal(other.values, column.values):
            headings = f"{shown(column.heading)} and {shown(other.heading)}"
            action = "Give all channels one abscissa: keep one of these columns."
            raise refuse(f"{kind}", headings, "one column", action)
    name = shown(column.heading)
    values = finite(real_values(column, name), name)
    if kind == "mesh_phase":
        return Place(kind, mesh_phases(values, unit, name), column.heading)
    if unit is None and kind in ("speed", "gear_speed"):
        if column.heading.strip().lower() != "rpm":
            action = f"Write '{name} [rpm]' or '{name} [rad/s]'."
            raise refuse(name, "a speed without unit", "a speed with a unit", action)
        unit = "rpm"
    if unit is None and kind != "order":
        facts.without_unit.append(column.heading)
    factor = 1.0 if unit is None else si_factor(unit, SI_OF_ABSCISSA[kind], name)
    return Place(kind, scaled(values, factor, name), column.heading)


def mesh_phases(values: FloatArray, unit: str | None, name: str) -> FloatArray:
    """Return the mesh cycles of mesh phases in mesh cycles, per cent, degrees or radians of a mesh cycle."""
    if unit is not None and unit.strip().lower() in ("deg", "°", "grad", "rad", "degree", "degrees"):
        return np.asarray(values * si_factor(unit, "rad", name) / (2.0 * np.pi))
    if (
        unit is None
        and values.size
        and float(np.ptp(values)) > 1.0 + 1e-9
        and abs(np.ptp(values) / 360.0 - 1.0) < 0.02
    ):
        action = f"Write '{name} [deg]' for degrees, or '{name} [-]' for mesh cycles."
        raise refuse(name, f"values up to {values.max():g} without unit", "a phase with a unit", action)
    return values if unit is None else values * si_factor(unit, "1", name)


def no_abscissa(table: Table) -> ParameterError:
    """Return the refusal of a table without abscissa."""
    headings = listed([shown(column.heading) for column in table.columns]) or "no columns of numbers"
    return refuse("theirs", headings, f"a column with one of {_ABSCISSAE}", "Add it, or rename the column.")
