"""The linear form of a mesh and its static loads, at places of its mesh cycles or over whole cycles.

Sources: docs/theory/teeth.md, "Statics", "The linear form".
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from lumped.errors import NumericalError
from lumped.mesh.kinks import KinkSearch, linear_cycles
from lumped.mesh.linear import (
    FULL_DAMPER,
    PAIR_LOAD,
    PLACE,
    STATE,
    SWITCHES,
    LinearForm,
    empty_instant,
    linear_places,
    node_place,
)
from lumped.mesh.records import FORCE, Records
from lumped.mesh.tables import MeshTables, cycle_pairs
from lumped.typing import FloatArray

#: Evaluations to find one kink inside a step of the linear form: the kink errs no more than the step itself.
_FEW_ROUNDS = 3
#: Switches of which a step with a kink gets moments: touching and the full damper. The others bend a slope
#: only.
_KINKS_OF_LOADS = FULL_DAMPER + 1


def linear_form_at(
    tables: MeshTables,
    start: int,
    cycle: ArrayLike,
    step: ArrayLike,
    place: ArrayLike,
    *,
    loads: bool = False,
) -> tuple[LinearForm, Records]:
    """Return the linear form at places of the mesh cycles from ``start`` on, and the loads of the pairs.

    Parameters
    ----------
    cycle, step, place : as in PLACE; arrays that broadcast to one shape (...)
    loads : whether the loads are wanted

    Returns
    -------
    FORCE (..., 3) and STATE (...); PAIR_LOAD (..., pairs), or (0, pairs) without loads
    """
    cycles, steps, in_step = np.broadcast_arrays(cycle, step, place)
    shape = cycles.shape
    places = np.zeros(cycles.size, PLACE)
    places["cycle"] = cycles.ravel()
    places["step"] = steps.ravel()
    places["place"] = in_step.ravel()
    pairs = tables.ahead.size
    form = LinearForm(np.zeros((places.size, 3), FORCE), np.zeros(places.size, STATE))
    pair_loads = np.zeros((places.size if loads else 0, pairs), PAIR_LOAD)
    linear_places(start, tables, places, form, pair_loads, cycle_pairs(tables), empty_instant(tables))
    _check_static(form)
    shaped = LinearForm(form.forces.reshape(*shape, 3), form.states.reshape(shape))
    return shaped, pair_loads.reshape(*shape, pairs) if loads else pair_loads


def _check_static(form: LinearForm) -> None:
    """Raise NumericalError where no pair carries the force."""
    if not np.isfinite(form.states["approach"]).all():
        raise NumericalError("At a position no tooth pair carries the load: check stiffness and deviations.")


def fill_linear_form(tables: MeshTables, start: int, form: LinearForm) -> None:
    """Write FORCE (cycles, steps, nodes, 3) and STATE (cycles, steps, nodes) of consecutive mesh cycles."""
    nodes = np.array([node_place(j) for j in range(tables.nodes.size)])
    search = KinkSearch(nodes, _KINKS_OF_LOADS, _FEW_ROUNDS)
    linear_cycles(start, tables, search, form, True, cycle_pairs(tables), empty_instant(tables))
    _check_static(form)


def static_loads(tables: MeshTables, start: int, cycles: int) -> tuple[FloatArray, Records]:
    """Static approach (cycles, steps) [m] and PAIR_LOAD (cycles, steps, pairs) at the starts of the steps."""
    cycle = np.arange(cycles)[:, None]
    steps = np.arange(tables.edges.size - 1)
    form, loads = linear_form_at(tables, start, cycle, steps, node_place(0), loads=True)
    return np.asarray(form.states["approach"], dtype=np.float64), loads


def kinks(tables: MeshTables, start: int, cycles: int, places: FloatArray, rounds: int) -> FloatArray:
    """Phases of all kinks of the mesh cycles from ``start`` on, in cycles after ``start``.

    Parameters
    ----------
    places, rounds : as of ``KinkSearch``
    """
    shape = (cycles, tables.edges.size - 1, 0)
    no_form = LinearForm(np.empty((*shape, 3), FORCE), np.empty(shape, STATE))
    search = KinkSearch(places, SWITCHES, rounds)
    phases: FloatArray = linear_cycles(
        start, tables, search, no_form, False, cycle_pairs(tables), empty_instant(tables)
    )
    return phases
