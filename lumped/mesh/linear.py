"""The linear form of the mesh: its force on small motions about the static state of every pair.

A pair that touches or leaves, whose damper becomes full, or whose tip leaves the line of action inside a
step of an integration makes a kink there. ``linear_cycles`` finds these kinks, and gives steps that have one
the moments of the force instead of its values at the nodes.

Sources: docs/theory/teeth.md, "The linear form"; docs/theory/contact_energy.md, "Loaded contact of the linear
model".
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from lumped.compiler import compiled
from lumped.mesh.element import (
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
    acts,
    add_force,
    called,
    clear_force,
    damper_share,
    deciding_tips,
    inlined,
    place_pair,
    record,
    rolling_rate,
    share_load,
    static_approach,
    ways_back,
)
from lumped.mesh.tables import CyclePairs, MeshTables, fill_steps
from lumped.typing import FloatArray, IntArray

#: The mesh about its static state, beside its FORCE.
STATE = record(
    approach="of the static state [m]; NaN where no pair carries the force",
    moment_pinion="of the mesh force on the pinion by its eccentricity, over the force [m]",
    moment_gear="the same of the gear [m]",
    damper_by_square="power of the dampers over the square of the rate of the approach [N s/m]",
    damper_by_rate="over that rate [N]",
    damper_at_rest="without it [W]",
)
#: Load of one pair: static, and of small motions.
PAIR_LOAD = record(
    static="elastic [N]",
    by_approach="[N/m]",
    by_rate="[N s/m]",
    at_rest="without motion [N]",
)
#: Numbers of a pair that change their sign at a kink: compression by its own load, load less that of the full
#: damper, ways of the contact beyond the start and the end of the flanks. The last two are kinks of a slope.
COMPRESSION, FULL_DAMPER, BEFORE_START, BEHIND_END, BEFORE_EDGE, BEHIND_EDGE = range(6)
SIGNS = 6
#: A kink so near to an end of a step, over the step, does not lie inside it.
_AT_END = 1e-7
#: Relative error of the static approach.
_SETTLED = 1e-12


class LinearForm(NamedTuple):
    """The linear form at n instants: (n, 3) FORCE by approach, by rate and at rest, and (n,) STATE."""

    forces: Records
    states: Records


@compiled
def add_forces(
    position: FloatArray,
    friction: FloatArray,
    tilt: FloatArray,
    by_approach: FloatArray,
    by_rate: FloatArray,
    at_rest: FloatArray,
    pair: Records,
    forces: Records,
) -> None:
    """Add the forces of pairs (pairs, k) to FORCE (k, 3); a record ``pair`` (1,) is worked in."""
    for time in range(position.shape[1]):
        for i in range(position.shape[0]):
            pair[0].position = position[i, time]
            pair[0].friction = friction[i, time]
            add_force(forces[time, BY_APPROACH], by_approach[i, time], pair[0], tilt[i, time])
            add_force(forces[time, BY_RATE], by_rate[i, time], pair[0], tilt[i, time])
            add_force(forces[time, AT_REST], at_rest[i, time], pair[0], tilt[i, time])


def forces_of_laws(
    position: FloatArray,
    friction: FloatArray,
    tilt: FloatArray | None,
    by_approach: FloatArray,
    by_rate: FloatArray,
    at_rest: FloatArray,
) -> Records:
    """FORCE (k, 3) of pairs (pairs, k) whose loads in the linear form are known: those of ``PAIR_LOAD``."""
    found = np.zeros((position.shape[1], 3), FORCE)
    tilts = np.zeros(position.shape) if tilt is None else tilt
    place, mu, angle = (np.ascontiguousarray(one) for one in (position, friction, tilts))
    rise, damper, rest = (np.ascontiguousarray(one) for one in (by_approach, by_rate, at_rest))
    add_forces(place, mu, angle, rise, damper, rest, np.zeros(1, PAIR), found)
    return found


class Instant(NamedTuple):
    """A mesh at one instant, and what is sought about it.

    Attributes
    ----------
    pairs, line, coupling : (pairs,) PAIR, (1,) LINE, (pairs, pairs) between nodes
    share : (nodes,) of each node in what is between them
    contacts, matrix : of ``share_load``
    loads : (pairs,) PAIR_LOAD
    signs : (6, pairs) of ``SIGNS``
    static : (1,) the last static approach, from which the next one is sought [m]
    """

    pairs: Records
    line: Records
    coupling: FloatArray
    share: FloatArray
    contacts: Records
    matrix: FloatArray
    loads: Records
    signs: FloatArray
    static: FloatArray


def empty_instant(tables: MeshTables) -> Instant:
    """Records for a mesh; not compiled, for that takes half a second."""
    nodes = tables.position.shape[1]
    count = tables.position.shape[2]
    return Instant(
        np.zeros(count, PAIR),
        np.zeros(1, LINE),
        np.zeros((count, count)),
        np.ones(nodes),
        np.zeros(count, CONTACT),
        np.empty((count, count)),
        np.zeros(count, PAIR_LOAD),
        np.zeros((SIGNS, count)),
        np.zeros(1),
    )


@inlined
def lagrange(x: float, nodes: FloatArray, share: FloatArray) -> None:
    """Write the share of the value at each node in that at ``x`` of the polynomial through them."""
    for j in range(nodes.size):
        share[j] = below = 1.0
        for other in range(nodes.size):
            if other != j:
                share[j] *= x - nodes[other]
                below *= nodes[j] - nodes[other]
        share[j] /= below


@called
def put_between(step: int, x: float, tables: MeshTables, mesh: CyclePairs, at: Instant) -> None:
    """Write the pairs at a place of a step, 0 to 1, by the polynomials through those at its nodes."""
    lagrange(x, tables.nodes, at.share)
    line = at.line[0]
    nodes = tables.nodes.size
    count = at.pairs.size
    line.length = line.lengthening = line.turn = line.gap_rate = 0.0
    line.moment_pinion = line.moment_gear = 0.0
    for j in range(nodes):
        share = at.share[j]
        there = mesh.lines[step, j]
        line.length += share * there.length
        line.lengthening += share * there.lengthening
        line.turn += share * there.turn
        line.gap_rate += share * there.gap_rate
        line.moment_pinion += share * there.moment_pinion
        line.moment_gear += share * there.moment_gear
    for i in range(count):
        pair = at.pairs[i]
        position = 0.0
        pair.stiffness = pair.damping = pair.friction = pair.gap = pair.gap_slope = 0.0
        for n in range(count):
            at.coupling[i, n] = 0.0
        for j in range(nodes):
            share = at.share[j]
            of_node = mesh.pairs[step, j, i]
            position += share * of_node.position
            pair.stiffness += share * of_node.stiffness
            pair.damping += share * of_node.damping
            pair.friction += share * of_node.friction
            pair.gap += share * of_node.gap
            pair.gap_slope += share * of_node.gap_slope
            coupling = tables.coupling[step, j]
            for n in range(count):
                at.coupling[i, n] += share * coupling[i, n]
        place_pair(pair, position, tables.flanks[mesh.kind[i]], line, tables.law)


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
    """Write force, state and load of each pair about the static approach; ``contacts`` are those there.

    N_n = N_el + k_t (delta - static) + c p'_n of the pairs that press; with prescribed contact about 0.
    """
    for part in range(3):
        clear_force(forces[part])
    state.approach = static
    state.moment_pinion = line.moment_pinion
    state.moment_gear = line.moment_gear
    state.damper_by_square = state.damper_by_rate = state.damper_at_rest = 0.0
    for i in range(pairs.size):
        pair = pairs[i]
        contact = contacts[i]
        load = loads[i]
        load.static = load.by_approach = load.by_rate = load.at_rest = 0.0
        if not acts(pair, contact, law):
            continue
        damping = pair.damping * damper_share(contact.load, law)
        closing = 1.0 - contact.gap_by_approach
        rolling = rolling_rate(contact, line, law)
        load.static = contact.load
        load.by_approach = contact.tangent
        load.by_rate = damping * closing
        load.at_rest = contact.load - contact.tangent * static - damping * rolling
        add_force(forces[BY_APPROACH], load.by_approach, pair, contact.tilt)
        add_force(forces[BY_RATE], load.by_rate, pair, contact.tilt)
        add_force(forces[AT_REST], load.at_rest, pair, contact.tilt)
        state.damper_by_square += damping * closing**2
        state.damper_by_rate -= 2.0 * damping * closing * rolling
        state.damper_at_rest += damping * rolling**2


@inlined
def write_signs(
    static: float, pairs: Records, line: Record, law: ContactLaw, coupling: FloatArray, at: Instant
) -> None:
    """Write the numbers of each pair that change their sign at a kink."""
    for i in range(pairs.size):
        pair = pairs[i]
        contact = at.contacts[i]
        for sign in range(SIGNS):
            at.signs[sign, i] = 0.0
        if pair.stiffness <= 0.0 or law.windows:
            continue
        at.signs[COMPRESSION, i] = contact.compression
        for n in range(pairs.size):
            at.signs[COMPRESSION, i] -= coupling[i, n] * at.contacts[n].load
        at.signs[FULL_DAMPER, i] = contact.load - law.full_damper
        at.signs[BEFORE_START, i], at.signs[BEHIND_END, i] = deciding_tips(pair, static, line, law)
        first, last = ways_back(pair, static, line)
        at.signs[BEFORE_EDGE, i] = first if pair.edge_pinion > 0.0 else 0.0
        at.signs[BEHIND_EDGE, i] = last if pair.edge_gear > 0.0 else 0.0


@called
def linear_at(
    pairs: Records,
    line: Record,
    coupling: FloatArray,
    law: ContactLaw,
    at: Instant,
    forces: Records,
    state: Record,
) -> None:
    """Write the linear form of the mesh of one instant into ``forces`` (3,), ``state``, and ``at``."""
    if law.windows:  # linear already
        static = 0.0
        share_load(static, pairs, line, law, coupling, at.matrix, at.contacts)
    else:
        guess = 0.0 if math.isnan(at.static[0]) else at.static[0]
        static = static_approach(
            guess, _SETTLED, law.force, pairs, line, law, coupling, at.matrix, at.contacts
        )
    at.static[0] = static
    linearise(static, pairs, line, law, at.contacts, forces, state, at.loads)
    write_signs(static, pairs, line, law, coupling, at)


@inlined
def linear_of_step(
    step: int, x: float, tables: MeshTables, mesh: CyclePairs, at: Instant, forces: Records, state: Record
) -> None:
    """``linear_at`` a place of a step whose pairs ``mesh`` has: 0 to 1, or -1 - j for the node j."""
    if x > -0.5:
        put_between(step, x, tables, mesh, at)
        pairs = at.pairs
        line = at.line
        coupling = at.coupling
    else:
        node = int(-1.0 - x)
        pairs = mesh.pairs[step, node]
        line = mesh.lines[step, node : node + 1]
        coupling = tables.coupling[step, node]
    linear_at(pairs, line[0], coupling, tables.law, at, forces, state)


@compiled(nogil=True)
def linear_places(
    start: int,
    tables: MeshTables,
    asked: FloatArray,
    form: LinearForm,
    loads: Records,
    mesh: CyclePairs,
    at: Instant,
) -> None:
    """Write the linear form at n places into ``form``, and into ``loads`` (n or 0, pairs) those of each pair.

    ``asked`` (n, 3) is cycles after ``start``, step, and place in it, as of ``linear_of_step``. ``mesh`` and
    ``at`` are worked in.
    """
    known = np.empty(tables.position.shape[0], np.int64)  # cycle whose pairs a step has
    for step in range(known.size):
        known[step] = -1
    for n in range(asked.shape[0]):
        cycle = int(asked[n, 0])
        step = int(asked[n, 1])
        if known[step] != cycle:
            known[step] = cycle
            fill_steps(start + cycle, step, step + 1, tables, mesh)
        linear_of_step(step, asked[n, 2], tables, mesh, at, form.forces[n], form.states[n])
        for i in range(at.loads.size if n < loads.shape[0] else 0):
            loads[n, i] = at.loads[i]


@inlined
def add_part(part: float, forces: Records, state: Record, of_forces: Records, of_state: Record) -> None:
    """Add a part of a linear form to another one."""
    for n in range(3):
        force = forces[n]
        of_force = of_forces[n]
        force.normal += part * of_force.normal
        force.friction += part * of_force.friction
        force.friction_moment += part * of_force.friction_moment
        force.separating += part * of_force.separating
    state.approach += part * of_state.approach
    state.moment_pinion += part * of_state.moment_pinion
    state.moment_gear += part * of_state.moment_gear
    state.damper_by_square += part * of_state.damper_by_square
    state.damper_by_rate += part * of_state.damper_by_rate
    state.damper_at_rest += part * of_state.damper_at_rest


@inlined
def clear(forces: Records, state: Record) -> None:
    """No force, no state."""
    for n in range(3):
        clear_force(forces[n])
    state.approach = state.moment_pinion = state.moment_gear = 0.0
    state.damper_by_square = state.damper_by_rate = state.damper_at_rest = 0.0


class Kinks(NamedTuple):
    """Kinks of one mesh cycle in the order of their phases: (most,) phase and step, (1,) their number."""

    phase: FloatArray
    step: IntArray
    known: IntArray


@inlined
def keep_kink(phase: float, step: int, kinks: Kinks) -> None:
    """Put a kink among those of the cycle, in the order of phases."""
    place = kinks.known[0]
    while place > 0 and kinks.phase[place - 1] > phase:
        kinks.phase[place], kinks.step[place] = kinks.phase[place - 1], kinks.step[place - 1]
        place -= 1
    kinks.phase[place] = phase
    kinks.step[place] = step
    kinks.known[0] += 1


@called
def find_kink(
    sign: int,
    i: int,
    ends: tuple[float, float],
    values: tuple[float, float],
    step: int,
    rounds: int,
    tables: MeshTables,
    mesh: CyclePairs,
    at: Instant,
    forces: Records,
    state: Record,
    kinks: Kinks,
) -> None:
    """Find the phase where a number of a pair is zero between two phases, by the rule of Illinois.

    An end of a step between them is looked at first: kinks of like teeth are there.
    """
    (low, high), (at_low, at_high), edges, last = ends, values, tables.edges, -1
    root = 0.0
    here = step
    for left in range(rounds, -1, -1):
        root = (low * at_high - high * at_low) / (at_high - at_low)
        if left == rounds and low < edges[step + 1] < high:
            root = edges[step + 1]
        here = step + 1 if step < edges.size - 2 and root >= edges[step + 1] else step
        if left == 0:
            break
        x = (root - edges[here]) / (edges[here + 1] - edges[here])
        linear_of_step(here, x, tables, mesh, at, forces, state)
        value = at.signs[sign, i]
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
    keep_kink(root, here, kinks)


@called
def fill_moments(
    step: int,
    first: int,
    kinks: Kinks,
    tables: MeshTables,
    mesh: CyclePairs,
    at: Instant,
    forces: Records,
    state: Record,
    to_forces: Records,
    to_states: Records,
) -> int:
    """Write the moments of a step with kinks, the first of them ``first``; the next kink behind the step.

    With the rule of the nodes on both sides of each kink, f_j = sum_q w_q l_j(x_q) f(x_q)/b_j has the moments
    of f on the polynomials l_j of the nodes.
    """
    nodes = tables.nodes.size
    edges = tables.edges
    low = 0.0
    for j in range(nodes):
        clear(to_forces[j], to_states[j])
    while low < 1.0:
        high = 1.0
        if first < kinks.known[0] and kinks.step[first] == step:
            high = max(low, (kinks.phase[first] - edges[step]) / (edges[step + 1] - edges[step]))
            first += 1
        for node in range(nodes if high > low else 0):
            linear_of_step(step, low + (high - low) * tables.nodes[node], tables, mesh, at, forces, state)
            weight = (high - low) * tables.weights[node]
            for j in range(nodes):
                part = weight * at.share[j] / tables.weights[j]
                add_part(part, to_forces[j], to_states[j], forces, state)
        low = high
    return first


@compiled
def twice_as_long(values: FloatArray) -> FloatArray:
    """The same values and as much place behind them."""
    longer = np.empty(2 * values.size)
    for i in range(values.size):
        longer[i] = values[i]
    return longer


@compiled(nogil=True)
def linear_cycles(
    start: int,
    tables: MeshTables,
    looks: FloatArray,
    signs: int,
    rounds: int,
    form: LinearForm,
    fills: bool,
    mesh: CyclePairs,
    at: Instant,
) -> FloatArray:
    """Linear form of mesh cycles from ``start`` on, and the phases of their kinks, by cycles from ``start``.

    ``form`` has (cycles, steps, nodes, 3) FORCE and (cycles, steps, nodes) STATE. Where it ``fills`` them,
    they are those at the nodes, which ``looks`` then are, and in a step with kinks the moments. ``looks``
    (k,) are places in a step, as of ``linear_of_step``, between which each of the first ``signs`` numbers of
    a pair has at most one root; it is found by so many ``rounds``. ``mesh`` and ``at`` are worked in.
    """
    (steps, _, count), edges, looked = tables.position.shape, tables.edges, looks.size
    one = LinearForm(np.empty(3, FORCE), np.empty(1, STATE))
    phase = np.empty(steps * looked)
    values = np.empty((steps * looked, SIGNS, count))
    most = phase.size * signs * count
    kinks = Kinks(np.empty(most), np.empty(most, np.int64), np.empty(1, np.int64))
    found = np.empty(16)
    known = 0
    first = steps - steps  # the literal 0 would be compiled for itself
    for look in range(phase.size):
        step = look // looked
        x = looks[look % looked]
        place = x if x > -0.5 else tables.nodes[int(-1.0 - x)]
        phase[look] = edges[step] + (edges[step + 1] - edges[step]) * place
    for cycle in range(form.states.shape[0]):
        fill_steps(start + cycle, first, steps, tables, mesh)
        for look in range(phase.size):
            step = look // looked
            j = look % looked
            forces = form.forces[cycle, step, j] if fills else one.forces
            state = form.states[cycle, step, j] if fills else one.states[0]
            linear_of_step(step, looks[j], tables, mesh, at, forces, state)
            for sign in range(SIGNS):
                for i in range(count):
                    values[look, sign, i] = at.signs[sign, i]
        kinks.known[0] = 0
        for look in range(1, phase.size):
            ends = phase[look - 1], phase[look]
            for sign in range(signs):
                for i in range(count):
                    here = values[look - 1, sign, i], values[look, sign, i]
                    if here[0] * here[1] < 0.0:
                        step = (look - 1) // looked
                        find_kink(
                            sign,
                            i,
                            ends,
                            here,
                            step,
                            rounds,
                            tables,
                            mesh,
                            at,
                            one.forces,
                            one.states[0],
                            kinks,
                        )
        for kink in range(kinks.known[0]):
            if known == found.size:
                found = twice_as_long(found)
            found[known] = cycle + kinks.phase[kink]
            known += 1
        kink = first
        while fills and kink < kinks.known[0]:
            step = kinks.step[kink]
            x = (kinks.phase[kink] - edges[step]) / (edges[step + 1] - edges[step])
            if x < _AT_END or x > 1.0 - _AT_END:
                kink += 1
                continue
            kink = fill_moments(
                step, kink, kinks, tables, mesh, at, one.forces, one.states[0],
                form.forces[cycle, step], form.states[cycle, step],
            )  # fmt: skip
    return found[:known]
