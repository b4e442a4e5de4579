"""The linear form of a mesh and its static loads, at places of its mesh cycles or over whole cycles.

Sources: docs/theory/teeth.md, "Statics", "The linear form".
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from lumped.errors import NumericalError
from lumped.mesh.element import FORCE, Records
from lumped.mesh.linear import (
    PAIR_LOAD,
    SIGNS,
    STATE,
    LinearForm,
    empty_instant,
    linear_cycles,
    linear_places,
)
from lumped.mesh.tables import MeshTables, cycle_pairs
from lumped.typing import FloatArray

#: Steps to a kink inside a step of the linear form, whose error is that of the step there.
_FEW_ROUNDS = 3


def linear_form_at(
    tables: MeshTables, start: int, *where: ArrayLike, loads: bool = False
) -> tuple[LinearForm, Records]:
    """Linear form at cycles after ``start``, steps and places that go together (...), see ``linear_places``.

    Returned are FORCE (..., 3) and STATE (...), and PAIR_LOAD (..., pairs) where ``loads`` are asked for.
    """
    asked = np.stack(np.broadcast_arrays(*where), axis=-1).astype(float)
    shape = asked.shape[:-1]
    asked = asked.reshape(-1, 3)
    form = LinearForm(np.zeros((len(asked), 3), FORCE), np.zeros(len(asked), STATE))
    of_pairs = np.zeros((len(asked) if loads else 0, tables.ahead.size), PAIR_LOAD)
    linear_places(start, tables, asked, form, of_pairs, cycle_pairs(tables), empty_instant(tables))
    _all_carried(form)
    whole = LinearForm(form.forces.reshape(*shape, 3), form.states.reshape(shape))
    return whole, of_pairs.reshape(*shape, tables.ahead.size) if loads else of_pairs


def _all_carried(form: LinearForm) -> None:
    if not np.isfinite(form.states["approach"]).all():
        raise NumericalError("At a position no tooth pair carries the load: check stiffness and deviations.")


def fill_linear_form(tables: MeshTables, start: int, form: LinearForm) -> None:
    """Fill FORCE (cycles, steps, nodes, 3) and STATE (cycles, steps, nodes) of consecutive cycles."""
    nodes = np.arange(tables.nodes.size, dtype=np.float64)
    mesh = cycle_pairs(tables)
    at = empty_instant(tables)
    linear_cycles(start, tables, -1.0 - nodes, 2, _FEW_ROUNDS, form, True, mesh, at)
    _all_carried(form)


def static_loads(tables: MeshTables, start: int, cycles: int) -> tuple[FloatArray, Records]:
    """Static approach (cycles, steps) [m] and PAIR_LOAD (cycles, steps, pairs) at the starts of the steps."""
    where = np.arange(cycles)[:, None], np.arange(tables.edges.size - 1), -1.0
    form, loads = linear_form_at(tables, start, *where, loads=True)
    return np.asarray(form.states["approach"], dtype=np.float64), loads


def kinks(tables: MeshTables, start: int, cycles: int, looks: FloatArray, rounds: int) -> FloatArray:
    """Phases of all kinks of mesh cycles from ``start`` on, in cycles after it; see ``linear_cycles``."""
    shape = (cycles, tables.edges.size - 1, 0)
    nothing = LinearForm(np.empty((*shape, 3), FORCE), np.empty(shape, STATE))
    mesh = cycle_pairs(tables)
    at = empty_instant(tables)
    found: FloatArray = linear_cycles(start, tables, looks, SIGNS, rounds, nothing, False, mesh, at)
    return found
