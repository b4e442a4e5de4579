"""Kinks of the linear form over whole mesh cycles, and steps of an integration that have a kink inside.

A pair that touches or leaves, whose damper becomes full, or whose tip leaves the line of action makes a kink
of the force. ``linear_cycles`` finds these kinks. A step with a kink inside gets the moments of the force
over the step instead of the values at the nodes, because a polynomial through the values would not see the
kink.

Sources: docs/theory/teeth.md, "The linear form".
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from lumped.compiler import called, compiled, inlined
from lumped.mesh.linear import (
    SWITCHES,
    Instant,
    LinearForm,
    add_form,
    clear_form,
    copy_form,
    is_node,
    linear_of_step,
    node_of,
)
from lumped.mesh.tables import CyclePairs, MeshTables, fill_steps
from lumped.typing import FloatArray, IntArray

#: A kink closer to an end of a step than this share of the step counts as at the end, not inside.
_AT_END = 1e-7


class KinkSearch(NamedTuple):
    """How kinks are searched.

    Attributes
    ----------
    places : (k,) places in each step at which the switches are evaluated, as of ``linear_of_step``; between
        two of them a switch has at most one root
    switches : number of switches that are searched, from the first of ``linear.SWITCHES`` on
    rounds : evaluations to find one root
    """

    places: FloatArray
    switches: int
    rounds: int


class Kinks(NamedTuple):
    """Kinks of one mesh cycle, with increasing phases.

    Attributes
    ----------
    phase, step : (most,) phase in the mesh cycle and step of each kink
    number : (1,) number of kinks
    """

    phase: FloatArray
    step: IntArray
    number: IntArray


class SignChange(NamedTuple):
    """A change of sign of a switch of one pair between two phases.

    Attributes
    ----------
    switch, pair : which switch of which pair
    step : step of the lower phase; the higher phase is in this step or in the next one
    low, high : phases in the mesh cycle
    at_low, at_high : values of the switch there
    """

    switch: int
    pair: int
    step: int
    low: float
    high: float
    at_low: float
    at_high: float


@inlined
def insert_kink(phase: float, step: int, kinks: Kinks) -> None:
    """Insert a kink so that the phases stay in increasing order."""
    index = kinks.number[0]
    while index > 0 and kinks.phase[index - 1] > phase:
        kinks.phase[index] = kinks.phase[index - 1]
        kinks.step[index] = kinks.step[index - 1]
        index -= 1
    kinks.phase[index] = phase
    kinks.step[index] = step
    kinks.number[0] += 1


@inlined
def share_of_step(phase: float, step: int, tables: MeshTables) -> float:
    """Place 0 to 1 of a phase in a step."""
    edges = tables.edges
    share: float = (phase - edges[step]) / (edges[step + 1] - edges[step])
    return share


@called
def find_kink(
    change: SignChange, rounds: int, tables: MeshTables, mesh: CyclePairs, instant: Instant, kinks: Kinks
) -> None:
    """Find the phase at which a switch is zero, by the Illinois form of the secant rule, and insert this
    kink.

    If an end of a step lies between both phases, it is evaluated first: like teeth have their kinks there.
    """
    edges = tables.edges
    low = change.low
    high = change.high
    at_low = change.at_low
    at_high = change.at_high
    last = -1  # end that the last round replaced: 0 low, 1 high
    root = 0.0
    step = change.step
    for rounds_left in range(rounds, -1, -1):
        root = (low * at_high - high * at_low) / (at_high - at_low)
        if rounds_left == rounds and low < edges[change.step + 1] < high:
            root = edges[change.step + 1]
        in_next = change.step < edges.size - 2 and root >= edges[change.step + 1]
        step = change.step + 1 if in_next else change.step
        if rounds_left == 0:
            break
        linear_of_step(step, share_of_step(root, step, tables), tables, mesh, instant)
        value = instant.switches[change.switch, change.pair]
        # An end that stays for two rounds counts half, else it would stay for ever.
        if (value < 0.0) == (at_low < 0.0):
            at_high *= 0.5 if last == 0 else 1.0
            low = root
            at_low = value
            last = 0
        else:
            at_low *= 0.5 if last == 1 else 1.0
            high = root
            at_high = value
            last = 1
    insert_kink(root, step, kinks)


@inlined
def find_kinks(
    search: KinkSearch,
    phases: FloatArray,
    values: FloatArray,
    tables: MeshTables,
    mesh: CyclePairs,
    instant: Instant,
    kinks: Kinks,
) -> None:
    """Find all kinks of a mesh cycle from switches (phases, SWITCHES, pairs) at increasing phases."""
    kinks.number[0] = 0
    for look in range(1, phases.size):
        step = (look - 1) // search.places.size
        for switch in range(search.switches):
            for i in range(values.shape[2]):
                before = values[look - 1, switch, i]
                after = values[look, switch, i]
                if before * after < 0.0:
                    change = SignChange(switch, i, step, phases[look - 1], phases[look], before, after)
                    find_kink(change, search.rounds, tables, mesh, instant, kinks)


@called
def write_moments(
    step: int,
    first_kink: int,
    kinks: Kinks,
    tables: MeshTables,
    mesh: CyclePairs,
    instant: Instant,
    step_form: LinearForm,
) -> int:
    """Write the moments of the force over a step with kinks, and return the next kink behind this step.

    The step is cut at its kinks. Quadrature with the nodes of each part gives
    f_j = sum_q w_q l_j(x_q) f(x_q) / b_j: values at the nodes that have the moments of f with the Lagrange
    polynomials l_j of the nodes.

    Parameters
    ----------
    first_kink : the first kink of this step
    step_form : written, (nodes, 3) FORCE and (nodes,) STATE
    """
    nodes = tables.nodes.size
    kink = first_kink
    low = 0.0
    for j in range(nodes):
        clear_form(step_form.forces[j], step_form.states[j])
    while low < 1.0:
        high = 1.0
        if kink < kinks.number[0] and kinks.step[kink] == step:
            high = max(low, share_of_step(kinks.phase[kink], step, tables))
            kink += 1
        for node in range(nodes if high > low else 0):
            linear_of_step(step, low + (high - low) * tables.nodes[node], tables, mesh, instant)
            weight = (high - low) * tables.weights[node]
            for j in range(nodes):
                factor = weight * instant.node_shares[j] / tables.weights[j]
                add_form(factor, step_form.forces[j], step_form.states[j], instant.forces, instant.state[0])
        low = high
    return kink


@inlined
def write_all_moments(
    cycle: int,
    first_kink: int,
    kinks: Kinks,
    tables: MeshTables,
    mesh: CyclePairs,
    instant: Instant,
    form: LinearForm,
) -> None:
    """Write the moments of every step of a mesh cycle that has a kink inside."""
    kink = first_kink
    while kink < kinks.number[0]:
        step = kinks.step[kink]
        place = share_of_step(kinks.phase[kink], step, tables)
        if place < _AT_END or place > 1.0 - _AT_END:
            kink += 1
            continue
        step_form = LinearForm(form.forces[cycle, step], form.states[cycle, step])
        kink = write_moments(step, kink, kinks, tables, mesh, instant, step_form)


@inlined
def phases_of_places(tables: MeshTables, places: FloatArray, phases: FloatArray) -> None:
    """Write the phases (steps * k,) of k places in every step."""
    edges = tables.edges
    for look in range(phases.size):
        step = look // places.size
        place = places[look % places.size]
        share = tables.nodes[node_of(place)] if is_node(place) else place
        phases[look] = edges[step] + (edges[step + 1] - edges[step]) * share


@compiled
def twice_as_long(values: FloatArray) -> FloatArray:
    """Return a copy with as much memory again behind the values."""
    longer = np.empty(2 * values.size)
    for i in range(values.size):
        longer[i] = values[i]
    return longer


@compiled(nogil=True)
def linear_cycles(
    start: int,
    tables: MeshTables,
    search: KinkSearch,
    form: LinearForm,
    write_form: bool,
    mesh: CyclePairs,
    instant: Instant,
) -> FloatArray:
    """Return the phases of all kinks of the mesh cycles from ``start`` on, in cycles after ``start``.

    Parameters
    ----------
    form : (cycles, steps, nodes, 3) FORCE and (cycles, steps, nodes) STATE
    write_form : whether ``form`` is written: values at the nodes and, in a step with a kink inside, moments.
        ``search.places`` must be the nodes then
    mesh, instant : memory
    """
    steps = tables.position.shape[0]
    count = tables.position.shape[2]
    places = search.places
    phases = np.empty(steps * places.size)
    switches = np.empty((phases.size, SWITCHES, count))
    most = phases.size * search.switches * count
    kinks = Kinks(np.empty(most), np.empty(most, np.int64), np.empty(1, np.int64))
    all_kinks = np.empty(16)
    number = 0
    zero = steps - steps  # numba would compile the callees once more for the literal 0
    phases_of_places(tables, places, phases)
    for cycle in range(form.states.shape[0]):
        fill_steps(start + cycle, zero, steps, tables, mesh)
        for look in range(phases.size):
            step = look // places.size
            j = look % places.size
            linear_of_step(step, places[j], tables, mesh, instant)
            if write_form:
                copy_form(
                    form.forces[cycle, step, j], form.states[cycle, step, j], instant.forces, instant.state[0]
                )
            for switch in range(SWITCHES):
                for i in range(count):
                    switches[look, switch, i] = instant.switches[switch, i]
        find_kinks(search, phases, switches, tables, mesh, instant, kinks)
        for kink in range(kinks.number[0]):
            if number == all_kinks.size:
                all_kinks = twice_as_long(all_kinks)
            all_kinks[number] = cycle + kinks.phase[kink]
            number += 1
        if write_form:
            write_all_moments(cycle, zero, kinks, tables, mesh, instant, form)
    return all_kinks[:number]
