"""Motion of the gears by momentary load: stiffness and damper of each pair follow its load, teeth only push.

The classical Runge-Kutta method of order 4, on steps that end wherever a law of a pair jumps or has a kink.

Sources: docs/theory/teeth.md, "Motion"; docs/theory/contact_energy.md, "First law".
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from lumped.compiler import compiled, inlined
from lumped.mesh.element import write_elastic_loads
from lumped.mesh.records import Record, Records, record
from lumped.mesh.tables import CyclePairs, MeshTables, fill_steps
from lumped.mesh.unilateral_force import MeshForce, unilateral_force
from lumped.typing import FloatArray, IntArray

#: A harmonic of a torque: amplitude cos(angle t/T_m + start).
RIPPLE = record(
    shaft="0 pinion, 1 gear",
    angle="angle in one mesh cycle [rad]",
    start="phase at t = 0 [rad]",
    amplitude="[N m]",
    cycles="mesh cycles of a turn of the shaft",
)
#: Work of a run [J]. ``lumped.losses`` lists all places where a loss is computed.
WORK = record(
    sliding="taken by friction between the teeth",
    tooth_dampers="taken by the dampers of the pairs",
    bearings="taken by the bearings",
    shafts="taken by shafts and couplings",
    teeth="done by the normal loads on the vibration of the gears",
)


class Body(NamedTuple):
    """Linear equations of the gears on their supports, z'' = constant (z, z') + torques + forces of the mesh.

    Attributes
    ----------
    constant : (m, terms) coefficients of each acceleration, without those that are 0 in all rows
    states : (m, terms) the place in z, z' to which each coefficient belongs
    deflection : (m,) u, with delta = u . z
    per_normal, per_friction_force, per_friction_moment, per_separating : (m,) acceleration per unit of each
        field of FORCE
    per_moment, per_torque : (2, m) acceleration per unit moment on, and torque of, pinion and gear
    bearings, shafts : (m, m) matrices whose quadratic form of the rates z' is the power of the bearings, and
        of shafts with couplings; (0, m) without shafts
    turning : (2, m) rates of the rotation of pinion and gear per rate of z
    off_line : (m,) y_p' - y_g', across the line of action, per rate of z
    speeds : (2,) nominal speeds of pinion and gear [rad/s]
    line : L_XY [m]
    """

    constant: FloatArray
    states: IntArray
    deflection: FloatArray
    per_normal: FloatArray
    per_friction_force: FloatArray
    per_friction_moment: FloatArray
    per_separating: FloatArray
    per_moment: FloatArray
    per_torque: FloatArray
    bearings: FloatArray
    shafts: FloatArray
    turning: FloatArray
    off_line: FloatArray
    speeds: FloatArray
    line: float


class CycleSpan(NamedTuple):
    """Mesh cycles of a run: the first one, their number, and how many of the last ones are recorded."""

    start: int
    cycles: int
    recorded: int


class Run(NamedTuple):
    """One of ``Runs``: states (outputs, 2m), loads (pairs, outputs), end (2m,) and work, (1,) WORK."""

    states: FloatArray
    loads: FloatArray
    end: FloatArray
    work: Records


class Runs(NamedTuple):
    """What runs recorded, and where they ended.

    Attributes
    ----------
    states : (runs, outputs, 2m) states at the outputs of the recorded cycles
    loads : (runs, pairs, outputs) normal load of each pair [N]
    end : (runs, 2m) state at the end
    work : (runs,) WORK in the recorded cycles
    """

    states: FloatArray
    loads: FloatArray
    end: FloatArray
    work: Records


@inlined
def accelerate(
    state: FloatArray, torque: FloatArray, force: MeshForce, line: Record, body: Body, rate: FloatArray
) -> None:
    """Write the rates z', z'' (2m,) of a state z, z' (2m,) under a force of the mesh.

    ``torque`` (m,) is the acceleration by the mean torques.
    """
    m = torque.size
    for j in range(m):
        per_normal = (
            body.per_normal[j]
            + body.per_moment[0, j] * line.moment_pinion
            + body.per_moment[1, j] * line.moment_gear
        )
        acceleration = torque[j] + force.normal * per_normal
        acceleration += force.friction_force * body.per_friction_force[j]
        acceleration += force.friction_moment * body.per_friction_moment[j]
        acceleration += force.separating * body.per_separating[j]
        for term in range(body.states.shape[1]):
            acceleration += body.constant[j, term] * state[body.states[j, term]]
        rate[j] = state[m + j]
        rate[m + j] = acceleration


@inlined
def add_ripples(cycle: int, phase: float, ripples: Records, body: Body, rate: FloatArray) -> None:
    """Add the accelerations by the harmonics of the torques at a phase of a mesh cycle."""
    m = body.deflection.size
    for n in range(ripples.size):
        ripple = ripples[n]
        turn = ripple.angle * ((cycle + phase) % ripple.cycles) + ripple.start
        torque = ripple.amplitude * math.cos(turn)
        for j in range(m):
            rate[m + j] += body.per_torque[int(ripple.shaft), j] * torque


@inlined
def dot(row: FloatArray, values: FloatArray, first: int) -> float:
    """Scalar product of a row with as many values, from the value ``first`` on."""
    total = 0.0
    for j in range(row.size):
        total += row[j] * values[first + j]
    return total


@inlined
def quadratic_form(matrix: FloatArray, values: FloatArray, first: int) -> float:
    """Quadratic form of a matrix (m, m) with m values, from the value ``first`` on; 0 for a matrix (0, m)."""
    total = 0.0
    for j in range(matrix.shape[0]):
        total += values[first + j] * dot(matrix[j], values, first)
    return total


@inlined
def sliding_power(
    force: MeshForce, speed_pinion: float, speed_gear: float, off_line: float, line: float
) -> float:
    """Power that friction takes from the gears, F v_s summed over all pairs [W].

    v_s = omega_p xi - omega_g (L - xi) - (y_p' - y_g')

    Parameters
    ----------
    force : force of all pairs, with F = sum of mu N and the moment sum of mu N xi
    speed_pinion, speed_gear : omega_p, omega_g, speeds with their vibration [rad/s]
    off_line : y_p' - y_g' [m/s]
    line : L [m]
    """
    power: float = force.friction_moment * (speed_pinion + speed_gear)
    power -= force.friction_force * (speed_gear * line + off_line)
    return power


@inlined
def add_work(
    time: float,
    state: FloatArray,
    approach_rate: float,
    force: MeshForce,
    line: Record,
    body: Body,
    work: Record,
) -> None:
    """Add the work of all powers at a state during a time [s]."""
    m = body.deflection.size
    pinion = dot(body.turning[0], state, m)
    gear = dot(body.turning[1], state, m)
    off_line = dot(body.off_line, state, m)
    speed_pinion = body.speeds[0] + pinion
    speed_gear = body.speeds[1] + gear
    sliding = sliding_power(force, speed_pinion, speed_gear, off_line, body.line)
    # The moments of eccentric gears work on the vibration too.
    by_moments = line.moment_pinion * pinion + line.moment_gear * gear
    teeth = force.normal * (approach_rate - line.gap_rate - by_moments) + force.separating * off_line
    work.sliding += time * sliding
    work.tooth_dampers += time * force.damper_power
    work.bearings += time * quadratic_form(body.bearings, state, m)
    work.shafts += time * quadratic_form(body.shafts, state, m)
    work.teeth += time * teeth


@inlined
def write_stage_state(
    stage: int, h: float, state: FloatArray, rates: FloatArray, stage_state: FloatArray
) -> None:
    """Write the state at which a stage of the Runge-Kutta method evaluates the rates.

    At stage 0 this is the state itself: the row ``rates[-1]`` then counts with the factor 0.
    """
    factor = 0.0 if stage == 0 else h if stage == 3 else 0.5 * h
    for j in range(state.size):
        stage_state[j] = state[j] + factor * rates[stage - 1, j]


@inlined
def advance(h: float, rates: FloatArray, state: FloatArray) -> None:
    """Advance a state by a step of the length h, from the rates of the four stages."""
    for j in range(state.size):
        state[j] += h / 6.0 * (rates[0, j] + 2.0 * rates[1, j] + 2.0 * rates[2, j] + rates[3, j])


@inlined
def write_output(
    row: int, state: FloatArray, normal: FloatArray, states: FloatArray, loads: FloatArray
) -> None:
    """Write state and normal loads of one output."""
    for j in range(state.size):
        states[row, j] = state[j]
    for i in range(normal.size):
        loads[i, row] = normal[i]


@compiled(nogil=True)
def run_cycles(
    span: CycleSpan,
    tables: MeshTables,
    body: Body,
    ripples: Records,
    initial: FloatArray,
    torques: FloatArray,
    mesh: CyclePairs,
    contacts: Records,
    work: Records,
) -> Runs:
    """Follow the motions over mesh cycles from states at the start of the first one.

    All runs take a stage of a step before any run takes the next one: the pairs there are read once.

    Parameters
    ----------
    tables : its nodes are start, middle and end of each step
    initial, torques : (runs, 2m) states, and (runs, m) accelerations by the mean torques
    mesh : memory. Where all cycles are alike, a further call with this memory finds the pairs written
    contacts : (runs, pairs) CONTACT, from whose loads the Newton steps start
    work : (runs,) WORK, to which the work in the recorded cycles is added
    """
    runs, m = torques.shape
    count = tables.position.shape[2]
    steps = tables.edges.size - 1
    outputs = 0
    for step in range(steps):
        outputs += span.recorded * tables.outputs[step]
    states = np.empty((runs, outputs, 2 * m))
    loads = np.empty((runs, count, outputs))
    state = np.empty((runs, 2 * m))
    stage_state = np.empty(2 * m)
    rates = np.empty((runs, 4, 2 * m))
    for run in range(runs):
        for j in range(2 * m):
            state[run, j] = initial[run, j]
            rates[run, -1, j] = 0.0
    edges = tables.edges
    normal = np.empty(count)
    row = 0
    zero = steps - steps  # numba would compile ``fill_steps`` once more for the literal 0
    for cycle in range(span.start, span.start + span.cycles):
        records = cycle >= span.start + span.cycles - span.recorded
        if not (tables.alike and mesh.filled[0] == 1):
            fill_steps(cycle, zero, steps, tables, mesh)
            mesh.filled[0] = 1
        for step in range(steps):
            length = edges[step + 1] - edges[step]
            h = length * tables.duration
            is_output = records and tables.outputs[step] == 1
            for stage in range(4):
                node = (stage + 1) // 2
                pairs = mesh.pairs[step, node]
                line = mesh.lines[step, node]
                coupling = tables.coupling[step, node]
                for run in range(runs):
                    write_stage_state(stage, h, state[run], rates[run], stage_state)
                    approach = dot(body.deflection, stage_state, 0)
                    approach_rate = dot(body.deflection, stage_state, m)
                    contact = contacts[run]
                    write_elastic_loads(approach, pairs, line, tables.law, coupling, mesh.matrix, contact)
                    force = unilateral_force(approach_rate, pairs, line, tables.law, contact, normal)
                    rate = rates[run, stage]
                    accelerate(stage_state, torques[run], force, line, body, rate)
                    add_ripples(cycle, edges[step] + 0.5 * node * length, ripples, body, rate)
                    if records:
                        weight = h / (3.0 if 0 < stage < 3 else 6.0)
                        add_work(weight, stage_state, approach_rate, force, line, body, work[run])
                    if is_output and stage == 0:
                        write_output(row, state[run], normal, states[run], loads[run])
            row += 1 if is_output else 0
            for run in range(runs):
                advance(h, rates[run], state[run])
    return Runs(states, loads, state, work)
