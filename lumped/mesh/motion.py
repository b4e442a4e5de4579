"""Motion of the gears by momentary load: stiffness and damper of each pair follow its load.

The classical Runge-Kutta method of order 4 on steps that end wherever a law of a pair jumps or has a kink.

Sources: docs/theory/teeth.md, "Motion"; docs/theory/contact_energy.md, "First law".
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from lumped.compiler import compiled
from lumped.mesh.element import MeshForce, Record, Records, inlined, mesh_force, record, share_load
from lumped.mesh.tables import CyclePairs, MeshTables, fill_steps
from lumped.typing import FloatArray

#: A harmonic of a torque: amplitude cos(angle t/T_m + start).
RIPPLE = record(
    shaft="0 pinion, 1 gear",
    angle="in a mesh cycle [rad]",
    start="phase at t = 0 [rad]",
    amplitude="[N m]",
    cycles="mesh cycles of a turn of the shaft",
)
#: Work in a run [J].
WORK = record(
    sliding="that friction takes",
    tooth_dampers="that the dampers of the pairs take",
    bearings="that bearings take",
    shafts="that shafts and couplings take",
    teeth="that the normal loads do on the vibration of the gears",
)


class Body(NamedTuple):
    """Linear equations of the gears on their supports, z'' = constant (z, z') + torques + forces of the mesh.

    Attributes
    ----------
    constant : (m, 2m)
    torque : (m,) acceleration by the mean torques
    deflection : (m,) delta = deflection . z
    per_normal, per_friction, per_friction_moment, per_separating : (m,) acceleration per unit of FORCE
    per_moment, per_torque : (2, m) per unit moment on, and torque of, pinion and gear
    bearings, shafts : (m, m) forms of the rates that are the powers of the bearings, and of shafts with
        couplings; (0, m) without shafts
    turning : (2, m) rates of the rotation of pinion and gear per rate of z
    off_line : (m,) y_p' - y_g' per rate of z
    speeds : (2,) nominal speeds of pinion and gear [rad/s]
    line : L_XY [m]
    """

    constant: FloatArray
    torque: FloatArray
    deflection: FloatArray
    per_normal: FloatArray
    per_friction: FloatArray
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


class Run(NamedTuple):
    """What a run recorded, and where it ended.

    Attributes
    ----------
    states : (outputs, 2m)
    loads : (pairs, outputs) [N]
    end : (2m,) state
    work : (1,) WORK
    """

    states: FloatArray
    loads: FloatArray
    end: FloatArray
    work: Records


@inlined
def accelerate(state: FloatArray, force: MeshForce, line: Record, body: Body, rate: FloatArray) -> None:
    """Write the rates (2m,) of a state (2m,) under a force of the mesh."""
    m = body.torque.size
    for j in range(m):
        per_normal = (
            body.per_normal[j]
            + body.per_moment[0, j] * line.moment_pinion
            + body.per_moment[1, j] * line.moment_gear
        )
        acceleration = body.torque[j] + force.normal * per_normal
        acceleration += force.friction * body.per_friction[j]
        acceleration += force.friction_moment * body.per_friction_moment[j]
        acceleration += force.separating * body.per_separating[j]
        for i in range(2 * m):
            acceleration += body.constant[j, i] * state[i]
        rate[j] = state[m + j]
        rate[m + j] = acceleration


@inlined
def add_ripples(cycle: int, phase: float, ripples: Records, body: Body, rate: FloatArray) -> None:
    """Add the accelerations by the harmonics of the torques."""
    m = body.torque.size
    for n in range(ripples.size):
        ripple = ripples[n]
        turn = ripple.angle * ((cycle + phase) % ripple.cycles) + ripple.start
        torque = ripple.amplitude * math.cos(turn)
        for j in range(m):
            rate[m + j] += body.per_torque[int(ripple.shaft), j] * torque


@inlined
def dot(row: FloatArray, values: FloatArray, first: int) -> float:
    """Product of a row with as many values from ``first`` on."""
    total = 0.0
    for j in range(row.size):
        total += row[j] * values[first + j]
    return total


@inlined
def form(matrix: FloatArray, values: FloatArray, first: int) -> float:
    """Quadratic form of as many values from ``first`` on as the matrix has rows; 0 for a matrix of none."""
    total = 0.0
    for j in range(matrix.shape[0]):
        total += values[first + j] * dot(matrix[j], values, first)
    return total


@inlined
def add_work(
    time: float, state: FloatArray, closing: float, force: MeshForce, line: Record, body: Body, work: Record
) -> None:
    """Add the work in a time at the powers of a state."""
    m = body.torque.size
    pinion, gear = dot(body.turning[0], state, m), dot(body.turning[1], state, m)
    off_line = dot(body.off_line, state, m)
    # Sliding velocity (Omega_p + theta_p') xi - (Omega_g + theta_g') (L - xi) - (y_p' - y_g').
    speed_pinion, speed_gear = body.speeds[0] + pinion, body.speeds[1] + gear
    sliding = force.friction_moment * (speed_pinion + speed_gear)
    sliding -= force.friction * (speed_gear * body.line + off_line)
    # The moments of eccentric gears work on the vibration too.
    by_moments = line.moment_pinion * pinion + line.moment_gear * gear
    teeth = force.normal * (closing - line.gap_rate - by_moments) + force.separating * off_line
    work.sliding += time * sliding
    work.tooth_dampers += time * force.damper_power
    work.bearings += time * form(body.bearings, state, m)
    work.shafts += time * form(body.shafts, state, m)
    work.teeth += time * teeth


@compiled
def run_cycles(
    start: int,
    cycles: int,
    recorded: int,
    tables: MeshTables,
    body: Body,
    ripples: Records,
    initial: FloatArray,
    mesh: CyclePairs,
    work: Records,
) -> Run:
    """Motion from a state (2m,) at the start of a mesh cycle, over so many; the last ones are recorded.

    The nodes of ``tables`` are start, middle and end of each step; ``mesh`` is worked in, ``work`` (1,)
    is added to.
    """
    m = body.torque.size
    count = tables.position.shape[2]
    steps = tables.edges.size - 1
    outputs = 0
    for step in range(steps):
        outputs += recorded * tables.outputs[step]
    states = np.empty((outputs, 2 * m))
    loads = np.empty((count, outputs))
    state = np.empty(2 * m)
    stage_state = np.empty(2 * m)
    rates = np.empty((4, 2 * m))
    for j in range(2 * m):
        state[j] = initial[j]
        rates[-1, j] = 0.0
    law = tables.law
    edges = tables.edges
    contacts = mesh.contacts
    matrix = mesh.matrix
    normal = np.empty(count)
    # the literal 0 would be compiled for itself
    row = 0
    first = steps - steps
    for cycle in range(start, start + cycles):
        keeps = cycle >= start + cycles - recorded
        fill_steps(cycle, first, steps, tables, mesh)
        for step in range(steps):
            h = (edges[step + 1] - edges[step]) * tables.duration
            for stage in range(4):
                node = (stage + 1) // 2
                part = 0.0 if stage == 0 else h if stage == 3 else 0.5 * h
                for j in range(2 * m):
                    stage_state[j] = state[j] + part * rates[stage - 1, j]
                approach = dot(body.deflection, stage_state, 0)
                closing = dot(body.deflection, stage_state, m)
                pairs = mesh.pairs[step, node]
                line = mesh.lines[step, node]
                share_load(approach, pairs, line, law, tables.coupling[step, node], matrix, contacts)
                force = mesh_force(closing, pairs, line, law, contacts, normal)
                accelerate(stage_state, force, line, body, rates[stage])
                phase = edges[step] + 0.5 * node * (edges[step + 1] - edges[step])
                add_ripples(cycle, phase, ripples, body, rates[stage])
                if keeps:
                    weight = h / (3.0 if 0 < stage < 3 else 6.0)
                    add_work(weight, stage_state, closing, force, line, body, work[0])
                if keeps and stage == 0 and tables.outputs[step] == 1:
                    for j in range(2 * m):
                        states[row, j] = state[j]
                    for i in range(count):
                        loads[i, row] = normal[i]
                    row += 1
            for j in range(2 * m):
                state[j] += h / 6.0 * (rates[0, j] + 2.0 * rates[1, j] + 2.0 * rates[2, j] + rates[3, j])
    return Run(states, loads, state, work)
