"""The linear form of the mesh: its force on small motions about the static state of every pair.

    N = N_el + k_t (delta - delta_static) + s c p'

k_t is the tangent of the elastic load. A pair that would pull does pull in this form; in
``lumped.mesh.unilateral_force`` it has no load. ``lumped.mesh.kinks`` finds where the form has kinks over
whole mesh cycles.

Sources: docs/theory/teeth.md, "The linear form"; docs/theory/contact_energy.md, "Loaded contact of the linear
model".
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from lumped.compiler import called, compiled, inlined
from lumped.mesh.damper import acting_damping
from lumped.mesh.element import in_contact, rolling_rate, static_approach, write_elastic_loads
from lumped.mesh.records import (
    AT_REST,
    BY_APPROACH,
    BY_RATE,
    CONTACT,
    FORCE,
    LINE,
    PAIR,
    ContactLaw,
    Record,
    Records,
    add_force,
    clear_force,
    record,
)
from lumped.mesh.tables import CyclePairs, MeshTables, fill_steps
from lumped.mesh.tip_corners import end_of_flanks, place_pair, start_of_flanks, tip_minus_edge
from lumped.typing import FloatArray

#: What the linear form has beside FORCE: the static state, and the power of the dampers as a polynomial of
#: the rate of the approach.
STATE = record(
    approach="static approach [m]; NaN where no pair carries the force",
    moment_pinion="lever arm that the pinion's eccentricity gives the mesh force [m]",
    moment_gear="lever arm that the gear's eccentricity gives the mesh force [m]",
    damper_by_square="power of the dampers over the square of the rate [N s/m]",
    damper_by_rate="power of the dampers over the rate [N]",
    damper_at_rest="power of the dampers without a rate [W]",
)
#: Load of one pair in the linear form.
PAIR_LOAD = record(
    static="elastic load in the static state [N]",
    by_approach="load per approach [N/m]",
    by_rate="load per rate of the approach [N s/m]",
    at_rest="load without approach and rate [N]",
)
#: Where the linear form is wanted, see ``linear_of_step``.
PLACE = record(
    cycle="mesh cycles after the first one, a whole number",
    step="step of the mesh cycle, a whole number",
    place="place in the step: 0 to 1, or ``node_place(j)``",
)
#: Switches of a pair: quantities that change their sign at a kink. COMPRESSION is the part of the compression
#: that the pair's load causes, FULL_DAMPER the load less the load of the full damper; both make a kink of the
#: load. TIP_AT_START and TIP_AT_END are ``tip_minus_edge`` at the ends of the flanks, EDGE_AT_START and
#: EDGE_AT_END the distances beyond the edges; these four make a kink of the slope only.
COMPRESSION, FULL_DAMPER, TIP_AT_START, TIP_AT_END, EDGE_AT_START, EDGE_AT_END = range(6)
SWITCHES = 6
#: Relative error of the static approach.
_CONVERGED = 1e-12


class LinearForm(NamedTuple):
    """The linear form at n instants: (n, 3) FORCE by approach, by rate and at rest, and (n,) STATE."""

    forces: Records
    states: Records


@compiled
def add_forces(
    position: FloatArray,
    mu: FloatArray,
    tilt: FloatArray,
    by_approach: FloatArray,
    by_rate: FloatArray,
    at_rest: FloatArray,
    pair: Records,
    forces: Records,
) -> None:
    """Add the forces of pairs (pairs, k) to FORCE (k, 3). ``pair``, (1,) PAIR, is memory."""
    for time in range(position.shape[1]):
        for i in range(position.shape[0]):
            pair[0].position = position[i, time]
            pair[0].mu = mu[i, time]
            add_force(forces[time, BY_APPROACH], by_approach[i, time], pair[0], tilt[i, time])
            add_force(forces[time, BY_RATE], by_rate[i, time], pair[0], tilt[i, time])
            add_force(forces[time, AT_REST], at_rest[i, time], pair[0], tilt[i, time])


def forces_of_laws(
    position: FloatArray,
    mu: FloatArray,
    tilt: FloatArray | None,
    by_approach: FloatArray,
    by_rate: FloatArray,
    at_rest: FloatArray,
) -> Records:
    """Return FORCE (k, 3) of pairs (pairs, k) whose loads in the linear form are known.

    Parameters
    ----------
    position, mu : xi [m] and friction coefficient of each pair
    tilt : of the normal at a tip corner; None is 0
    by_approach, by_rate, at_rest : loads as in PAIR_LOAD
    """
    forces = np.zeros((position.shape[1], 3), FORCE)
    tilts = np.zeros(position.shape) if tilt is None else tilt
    add_forces(
        np.ascontiguousarray(position),
        np.ascontiguousarray(mu),
        np.ascontiguousarray(tilts),
        np.ascontiguousarray(by_approach),
        np.ascontiguousarray(by_rate),
        np.ascontiguousarray(at_rest),
        np.zeros(1, PAIR),
        forces,
    )
    return forces


class Instant(NamedTuple):
    """The mesh at one instant with its linear form, and the memory to compute them.

    Attributes
    ----------
    pairs, line, coupling : (pairs,) PAIR, (1,) LINE and (pairs, pairs) interpolated between the nodes
    node_shares : (nodes,) share of each node in the interpolation
    contacts, matrix : (pairs,) CONTACT, and (pairs, pairs) memory, of ``write_elastic_loads``
    static : (1,) static approach; on entry the guess from which it is sought [m]
    forces, state : (3,) FORCE and (1,) STATE of the linear form
    loads : (pairs,) PAIR_LOAD
    switches : (SWITCHES, pairs) quantities that change their sign at a kink
    """

    pairs: Records
    line: Records
    coupling: FloatArray
    node_shares: FloatArray
    contacts: Records
    matrix: FloatArray
    static: FloatArray
    forces: Records
    state: Records
    loads: Records
    switches: FloatArray


def empty_instant(tables: MeshTables) -> Instant:
    """Return the memory of an instant. Not compiled, because compiling takes half a second."""
    nodes = tables.position.shape[1]
    count = tables.position.shape[2]
    return Instant(
        pairs=np.zeros(count, PAIR),
        line=np.zeros(1, LINE),
        coupling=np.zeros((count, count)),
        node_shares=np.ones(nodes),
        contacts=np.zeros(count, CONTACT),
        matrix=np.empty((count, count)),
        static=np.zeros(1),
        forces=np.zeros(3, FORCE),
        state=np.zeros(1, STATE),
        loads=np.zeros(count, PAIR_LOAD),
        switches=np.zeros((SWITCHES, count)),
    )


@inlined
def lagrange(x: float, nodes: FloatArray, shares: FloatArray) -> None:
    """Write the Lagrange polynomials of the nodes at ``x``: the share of each node in the interpolation."""
    for j in range(nodes.size):
        shares[j] = 1.0
        denominator = 1.0
        for other in range(nodes.size):
            if other != j:
                shares[j] *= x - nodes[other]
                denominator *= nodes[j] - nodes[other]
        shares[j] /= denominator


@inlined
def interpolate_line(step: int, mesh: CyclePairs, instant: Instant) -> None:
    """Write the line of action between the nodes of a step, by the shares of the nodes."""
    line = instant.line[0]
    line.length = 0.0
    line.lengthening = 0.0
    line.turn = 0.0
    line.gap_rate = 0.0
    line.moment_pinion = 0.0
    line.moment_gear = 0.0
    for j in range(instant.node_shares.size):
        share = instant.node_shares[j]
        node_line = mesh.lines[step, j]
        line.length += share * node_line.length
        line.lengthening += share * node_line.lengthening
        line.turn += share * node_line.turn
        line.gap_rate += share * node_line.gap_rate
        line.moment_pinion += share * node_line.moment_pinion
        line.moment_gear += share * node_line.moment_gear


@inlined
def interpolate_pair(i: int, step: int, tables: MeshTables, mesh: CyclePairs, instant: Instant) -> None:
    """Write one pair between the nodes of a step, by the shares of the nodes."""
    count = instant.pairs.size
    pair = instant.pairs[i]
    position = 0.0
    pair.stiffness = 0.0
    pair.damping = 0.0
    pair.mu = 0.0
    pair.gap = 0.0
    pair.gap_slope = 0.0
    for n in range(count):
        instant.coupling[i, n] = 0.0
    for j in range(instant.node_shares.size):
        share = instant.node_shares[j]
        node_pair = mesh.pairs[step, j, i]
        position += share * node_pair.position
        pair.stiffness += share * node_pair.stiffness
        pair.damping += share * node_pair.damping
        pair.mu += share * node_pair.mu
        pair.gap += share * node_pair.gap
        pair.gap_slope += share * node_pair.gap_slope
        coupling = tables.coupling[step, j]
        for n in range(count):
            instant.coupling[i, n] += share * coupling[i, n]
    place_pair(pair, position, tables.flanks[mesh.kind[i]], instant.line[0], tables.law)


@called
def interpolate_mesh(step: int, x: float, tables: MeshTables, mesh: CyclePairs, instant: Instant) -> None:
    """Write pairs, coupling and line of action at a place of a step, by polynomials through the nodes."""
    lagrange(x, tables.nodes, instant.node_shares)
    interpolate_line(step, mesh, instant)
    for i in range(instant.pairs.size):
        interpolate_pair(i, step, tables, mesh, instant)


@inlined
def clear_form(forces: Records, state: Record) -> None:
    """Set the linear form to zero."""
    for part in range(3):
        clear_force(forces[part])
    state.approach = 0.0
    state.moment_pinion = 0.0
    state.moment_gear = 0.0
    state.damper_by_square = 0.0
    state.damper_by_rate = 0.0
    state.damper_at_rest = 0.0


@inlined
def copy_form(to_forces: Records, to_state: Record, forces: Records, state: Record) -> None:
    """Copy a linear form."""
    for part in range(3):
        to_forces[part].normal = forces[part].normal
        to_forces[part].friction_force = forces[part].friction_force
        to_forces[part].friction_moment = forces[part].friction_moment
        to_forces[part].separating = forces[part].separating
    to_state.approach = state.approach
    to_state.moment_pinion = state.moment_pinion
    to_state.moment_gear = state.moment_gear
    to_state.damper_by_square = state.damper_by_square
    to_state.damper_by_rate = state.damper_by_rate
    to_state.damper_at_rest = state.damper_at_rest


@inlined
def add_form(factor: float, to_forces: Records, to_state: Record, forces: Records, state: Record) -> None:
    """Add a factor times a linear form to another one."""
    for part in range(3):
        to_forces[part].normal += factor * forces[part].normal
        to_forces[part].friction_force += factor * forces[part].friction_force
        to_forces[part].friction_moment += factor * forces[part].friction_moment
        to_forces[part].separating += factor * forces[part].separating
    to_state.approach += factor * state.approach
    to_state.moment_pinion += factor * state.moment_pinion
    to_state.moment_gear += factor * state.moment_gear
    to_state.damper_by_square += factor * state.damper_by_square
    to_state.damper_by_rate += factor * state.damper_by_rate
    to_state.damper_at_rest += factor * state.damper_at_rest


@inlined
def add_damper_power(damping: float, compression_share: float, rolling: float, state: Record) -> None:
    """Add the power c (f delta' - r)^2 of a damper to the coefficients of delta'^2, delta' and 1.

    f is the share of the approach that compresses the pair, r the rate at which rolling opens the gap [m/s].
    """
    state.damper_by_square += damping * compression_share**2
    state.damper_by_rate -= 2.0 * damping * compression_share * rolling
    state.damper_at_rest += damping * rolling**2


@inlined
def linear_load(
    static: float, damping: float, compression_share: float, rolling: float, contact: Record, load: Record
) -> None:
    """Write N = N_el + k_t (delta - static) + c (f delta' - r); for f, r see ``add_damper_power``."""
    load.static = contact.load
    load.by_approach = contact.tangent
    load.by_rate = damping * compression_share
    load.at_rest = contact.load - contact.tangent * static - damping * rolling


@inlined
def clear_load(load: Record) -> None:
    """Set the load of a pair to zero."""
    load.static = 0.0
    load.by_approach = 0.0
    load.by_rate = 0.0
    load.at_rest = 0.0


@inlined
def linearise(
    static: float,
    pairs: Records,
    line: Record,
    law: ContactLaw,
    contacts: Records,
    forces: Records,
    state: Record,
    loads: Records,
) -> None:
    """Write the linear form and the load of each pair about a static approach.

    Parameters
    ----------
    static : static approach [m]; with prescribed contact, which is linear everywhere, 0
    contacts : of ``write_elastic_loads`` at the static approach
    forces, state, loads : written: (3,) FORCE, STATE, (pairs,) PAIR_LOAD
    """
    clear_form(forces, state)
    state.approach = static
    state.moment_pinion = line.moment_pinion
    state.moment_gear = line.moment_gear
    for i in range(pairs.size):
        pair = pairs[i]
        contact = contacts[i]
        load = loads[i]
        clear_load(load)
        if not in_contact(pair, contact, law):
            continue
        damping = acting_damping(pair, contact, law)
        compression_share = 1.0 - contact.gap_by_approach
        rolling = rolling_rate(contact, line, law)
        linear_load(static, damping, compression_share, rolling, contact, load)
        add_force(forces[BY_APPROACH], load.by_approach, pair, contact.tilt)
        add_force(forces[BY_RATE], load.by_rate, pair, contact.tilt)
        add_force(forces[AT_REST], load.at_rest, pair, contact.tilt)
        add_damper_power(damping, compression_share, rolling, state)


@inlined
def write_switches(
    static: float,
    pairs: Records,
    line: Record,
    law: ContactLaw,
    coupling: FloatArray,
    instant: Instant,
) -> None:
    """Write the quantities of each pair that change their sign at a kink; 0 where a pair has none."""
    switches = instant.switches
    for i in range(pairs.size):
        pair = pairs[i]
        contact = instant.contacts[i]
        for switch in range(SWITCHES):
            switches[switch, i] = 0.0
        if pair.stiffness <= 0.0 or law.prescribed:
            continue
        switches[COMPRESSION, i] = contact.compression
        for n in range(pairs.size):
            switches[COMPRESSION, i] -= coupling[i, n] * instant.contacts[n].load
        switches[FULL_DAMPER, i] = contact.load - law.full_damper
        start = start_of_flanks(pair, static, line, law)
        end = end_of_flanks(pair, static, line, law)
        switches[TIP_AT_START, i] = tip_minus_edge(start)
        switches[TIP_AT_END, i] = tip_minus_edge(end)
        switches[EDGE_AT_START, i] = start.beyond_edge if start.edge > 0.0 else 0.0
        switches[EDGE_AT_END, i] = end.beyond_edge if end.edge > 0.0 else 0.0


@called
def linear_of_mesh(
    pairs: Records, line: Record, coupling: FloatArray, law: ContactLaw, instant: Instant
) -> None:
    """Write the linear form, the loads and the switches of given pairs into ``instant``."""
    if law.prescribed:  # linear already, about any state
        static = 0.0
        write_elastic_loads(static, pairs, line, law, coupling, instant.matrix, instant.contacts)
    else:
        guess = 0.0 if math.isnan(instant.static[0]) else instant.static[0]
        static = static_approach(
            guess, _CONVERGED, law.force, pairs, line, law, coupling, instant.matrix, instant.contacts
        )
    instant.static[0] = static
    linearise(static, pairs, line, law, instant.contacts, instant.forces, instant.state[0], instant.loads)
    write_switches(static, pairs, line, law, coupling, instant)


def node_place(node: int) -> float:
    """Return -1 - j, the place that stands for the node j in ``linear_of_step``. For callers in Python."""
    return -1.0 - node


@inlined
def is_node(place: float) -> bool:
    """Whether a place is a node itself."""
    return place <= -0.5


@inlined
def node_of(place: float) -> int:
    """Return the node j of ``node_place``."""
    return int(-1.0 - place)


@inlined
def linear_of_step(step: int, place: float, tables: MeshTables, mesh: CyclePairs, instant: Instant) -> None:
    """Write the linear form at a place of a step into ``instant``.

    Parameters
    ----------
    step : whose pairs ``mesh`` has
    place : 0 to 1, where pairs are interpolated between the nodes, or ``node_place(j)``, the node j itself
    """
    if is_node(place):
        node = node_of(place)
        pairs = mesh.pairs[step, node]
        line = mesh.lines[step, node : node + 1]
        coupling = tables.coupling[step, node]
    else:
        interpolate_mesh(step, place, tables, mesh, instant)
        pairs = instant.pairs
        line = instant.line
        coupling = instant.coupling
    linear_of_mesh(pairs, line[0], coupling, tables.law, instant)


@compiled(nogil=True)
def linear_places(
    start: int,
    tables: MeshTables,
    places: Records,
    form: LinearForm,
    loads: Records,
    mesh: CyclePairs,
    instant: Instant,
) -> None:
    """Write the linear form at n places of the mesh cycles from ``start`` on.

    Parameters
    ----------
    places : (n,) PLACE
    form : written, (n, 3) FORCE and (n,) STATE
    loads : written, PAIR_LOAD (n, pairs); (0, pairs) where no loads are wanted
    mesh, instant : memory
    """
    cycle_of_step = np.empty(tables.position.shape[0], np.int64)  # whose pairs ``mesh`` has in each step
    for step in range(cycle_of_step.size):
        cycle_of_step[step] = -1
    for n in range(places.shape[0]):
        cycle = int(places[n].cycle)
        step = int(places[n].step)
        if cycle_of_step[step] != cycle:
            cycle_of_step[step] = cycle
            fill_steps(start + cycle, step, step + 1, tables, mesh)
        linear_of_step(step, places[n].place, tables, mesh, instant)
        copy_form(form.forces[n], form.states[n], instant.forces, instant.state[0])
        for i in range(instant.loads.size if n < loads.shape[0] else 0):
            loads[n, i] = instant.loads[i]
