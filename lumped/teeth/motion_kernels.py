"""Compiled motion of a mesh whose teeth differ: steps of Runge and Kutta, and Gauss steps of the linear form.

Sources: docs/theory/teeth.md, "Motion", "The linear form".
"""

from __future__ import annotations

import math

import numpy as np

from lumped.compiler import compiled
from lumped.model.kernels import copy, solve_in_place
from lumped.teeth import kernels as kn
from lumped.teeth.kernels import Tables, contact_of_steps, loads_at, room_of
from lumped.typing import FloatArray, IntArray

#: Directions of the forces of the mesh: N, its moments on both gears, F, F xi, tip corners; both torques.
FORCES = 8
#: Stages of the Gauss steps.
STAGES = 4


@compiled
def motion_cycles(
    corners: bool,
    start: int,
    cycles: int,
    recorded: int,
    own: Tables,
    state: FloatArray,
    constant: FloatArray,
    deflection: FloatArray,
    per_load: FloatArray,
    per_moment: FloatArray,
    per_apart: FloatArray,
    torque: FloatArray,
    ripple: FloatArray,
    per_torque: FloatArray,
    bearing: FloatArray,
    sliding: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Motion with unilateral contact over mesh cycles by the classical Runge-Kutta method of order 4.

    ``corners``: own gaps and tip corners, else the windows of the tables; ``constant`` (m, 2m) acceleration
    of z per z and z' with the teeth apart, ``per_load`` (3, m) per N, F and F xi, ``per_moment`` (2, m) per
    moment on pinion and gear, ``per_apart`` (m,) per force of tip corners, ``torque`` (m,) that of both
    torques, ``ripple`` (n, 5) shaft, angle a cycle, phase, amplitude, cycles of its turn, ``per_torque``
    (2, m) per torque; ``bearing`` (m, m) gives the power of the supports, ``sliding`` (3, m) the sliding
    velocity per z', as constant and per xi: rows pinion, gear, y. Returned are states (outputs, 2m) and loads
    (pairs, outputs) of the last ``recorded`` cycles, the state at the end, and over these cycles the
    integrals of sliding, tooth dampers, supports, and work of the teeth on both gears [J].
    """
    m, pairs, steps = deflection.size, own.ahead.size, own.edges.size - 1
    count = recorded * own.outputs.sum()
    states, record = np.empty((count, 2 * m)), np.zeros((pairs, count))
    work, power = np.zeros(4), np.zeros(4)
    x, at, rate = state.copy(), np.empty(2 * m), np.zeros((4, 2 * m))
    constants, speed, edges, outputs = own.constants, own.speed, own.edges, own.outputs
    room, normal, single = room_of(own), np.zeros(pairs), constants[2] == 0.0 and not own.coupling.any()
    k, flat, moves, place, here = room.k, room.flat, room.moved, room.place, room.here
    row = 0
    for c in range(cycles):
        cycle = start + c
        keeps = c >= cycles - recorded
        contact_of_steps(cycle, 0, steps, not corners, own, room)
        for s in range(steps):
            h = (edges[s + 1] - edges[s]) * own.duration
            for stage in range(4):
                node = (stage + 1) // 2
                part = h if stage == 3 else 0.5 * h
                for j in range(2 * m):
                    at[j] = x[j] if stage == 0 else x[j] + part * rate[stage - 1, j]
                delta, closing = 0.0, 0.0
                for j in range(m):
                    delta += deflection[j] * at[j]
                    closing += deflection[j] * at[m + j]
                tau = edges[s] + 0.5 * node * (edges[s + 1] - edges[s])
                k_at, gap_at, moved, xi = k[s, node], flat[s, node], moves[s, node], place[s, node]
                e_rate = moved[1] / own.duration
                if corners:
                    loads_at(delta, single, s, node, own, room)
                sums, friction_sum, friction_arm, apart = 0.0, 0.0, 0.0, 0.0
                power[:] = 0.0
                v_p, v_g, v_y = sliding[0, m], sliding[1, m], 0.0
                for j in range(m):
                    v_p += sliding[0, j] * at[m + j]
                    v_g += sliding[1, j] * at[m + j]
                    v_y += sliding[2, j] * at[m + j]
                for i in range(pairs):
                    normal[i] = 0.0
                    if k_at[i] <= 0.0:
                        continue
                    c_i, rise, slope, tilt = gap_at[i, 2], 0.0, gap_at[i, 1], 0.0
                    arm = xi[i] + (moved[7] if corners else 0.0)
                    elastic = k_at[i] * (delta - gap_at[i, 0])
                    if corners:
                        rise, slope, tilt = here[kn.BY_DELTA, i], here[kn.BY_XI, i], here[kn.TILT, i]
                        elastic = here[kn.LOAD, i]
                        if elastic <= 0.0:
                            continue
                        part = min(elastic / constants[4], 1.0)
                        c_i *= part * part * (3.0 - 2.0 * part)
                    pressing = closing * (1.0 - rise) - slope * speed - e_rate
                    load = elastic + c_i * pressing
                    if load <= 0.0:
                        continue
                    normal[i] = load
                    f = gap_at[i, 3] * load
                    sums += load
                    apart += load * tilt
                    friction_sum += f
                    friction_arm += f * arm
                    power[0] += f * (v_p * arm - v_g * (sliding[2, m] - arm) - v_y)
                    power[1] += c_i * pressing**2
                # The moments of e work on the vibration too.
                v_p, v_g = v_p - sliding[0, m], v_g - sliding[1, m]
                power[3] = sums * (closing - e_rate - moved[5] * v_p - moved[6] * v_g) + apart * v_y
                for j in range(m):
                    acceleration = torque[j]
                    acceleration += sums * (
                        per_load[0, j] + per_moment[0, j] * moved[5] + per_moment[1, j] * moved[6]
                    )
                    acceleration += friction_sum * per_load[1, j] + friction_arm * per_load[2, j]
                    acceleration += apart * per_apart[j]
                    for n in range(2 * m):
                        acceleration += constant[j, n] * at[n]
                    rate[stage, j], rate[stage, m + j] = at[m + j], acceleration
                for n in range(ripple.shape[0]):
                    turn = ripple[n, 1] * ((cycle + tau) % ripple[n, 4]) + ripple[n, 2]
                    size = ripple[n, 3] * math.cos(turn)
                    for j in range(m):
                        rate[stage, m + j] += per_torque[int(ripple[n, 0]), j] * size
                if not keeps:
                    continue
                for j in range(m):
                    along = 0.0
                    for n in range(m):
                        along += bearing[j, n] * at[m + n]
                    power[2] += at[m + j] * along
                weight = h / (3.0 if 0 < stage < 3 else 6.0)
                for n in range(4):
                    work[n] += weight * power[n]
                if stage == 0 and outputs[s] == 1:
                    for j in range(2 * m):
                        states[row, j] = x[j]
                    for i in range(pairs):
                        record[i, row] = normal[i]
                    row += 1
            for j in range(2 * m):
                x[j] += h / 6.0 * (rate[0, j] + 2.0 * rate[1, j] + 2.0 * rate[2, j] + rate[3, j])
    return states, record, x, work


@compiled(nogil=True)
def linear_cycles(
    first: int,
    columns: FloatArray,
    keeps: bool,
    sums: FloatArray,
    which: IntArray,
    free: FloatArray,
    by_force: FloatArray,
    by_p: FloatArray,
    reach: FloatArray,
    deflection: FloatArray,
    ripple: FloatArray,
    own: Tables,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Gauss steps of the linear form through mesh cycles from ``first`` on, each from its own start.

    ``columns`` (cycles, count, 2m + forcings) are states at the starts before the weights of the forcings,
    ``sums`` those of ``static_mesh``, ``which`` (steps,) the length of each step, a row of the next four:
    ``free`` (k, 2m + forcings, STAGES + 2m) p and end of ``lumped.model.propagation.without_mesh`` side by
    side, ``by_force`` (k, s, FORCES, STAGES + 2m) its by_feedback along the directions of ``FORCES``, its
    by_p, and ``reach`` (k, s) the time to each stage [s]; ``ripple`` as in ``motion_cycles``. Returned are
    the states at the ends (cycles, count, 2m) and, where it ``keeps``, of the first column the state at the
    start of every step (cycles, steps, 2m), and delta, then its rate, at the stages (cycles, steps, 2s).
    """
    cycles, count, wide = columns.shape
    steps, m = sums.shape[1], deflection.size
    n, rows = 2 * m, STAGES + 2 * m
    ends, kept = np.empty((cycles, count, n)), cycles if keeps else 0
    states, inside = np.empty((kept, steps, n)), np.empty((kept, steps, 2 * STAGES))
    now, to, found = np.empty((count, wide)), np.empty((2 * STAGES, rows)), np.empty(rows)
    start, p, strength = np.empty(2 * STAGES), np.empty(STAGES), np.zeros((3, FORCES))
    fixed, matrix, inverse = np.empty(rows), np.empty((STAGES, STAGES)), np.empty((STAGES, STAGES))
    for c in range(cycles):
        copy(now, columns[c])
        for s in range(steps):
            of = which[s]
            fixed[:] = 0.0
            for stage in range(STAGES):
                at = sums[c, s, stage]
                for part in range(3):
                    strength[part, 0], strength[part, 5] = at[3 * part], at[14 + part]
                    strength[part, 1], strength[part, 2] = at[3 * part] * at[9], at[3 * part] * at[10]
                    strength[part, 3], strength[part, 4] = at[3 * part + 1], at[3 * part + 2]
                strength[2, 6] = strength[2, 7] = 0.0
                tau = own.edges[s] + own.nodes[stage] * (own.edges[s + 1] - own.edges[s])
                for i in range(ripple.shape[0]):
                    turn = ripple[i, 1] * ((first + c + tau) % ripple[i, 4]) + ripple[i, 2]
                    strength[2, 6 + int(ripple[i, 0])] += ripple[i, 3] * math.cos(turn)
                for row in range(rows):
                    to[stage, row] = to[STAGES + stage, row] = 0.0
                for force in range(FORCES):
                    by_delta, by_rate, constant = strength[0, force], strength[1, force], strength[2, force]
                    if by_delta != 0.0 or by_rate != 0.0 or constant != 0.0:
                        for row in range(rows):
                            factor = by_force[of, stage, force, row]
                            to[stage, row] += by_delta * factor
                            to[STAGES + stage, row] += by_rate * factor
                            fixed[row] += constant * factor
            for row in range(STAGES):
                for column in range(STAGES):
                    matrix[row, column] = inverse[row, column] = 1.0 if row == column else 0.0
                    for i in range(2 * STAGES):
                        matrix[row, column] -= to[i, row] * by_p[of, i, column]
            solve_in_place(matrix, inverse)
            for column in range(count):
                x = now[column]
                place = rate = 0.0
                for j in range(m):
                    place += deflection[j] * x[j]
                    rate += deflection[j] * x[m + j]
                for row in range(rows):
                    found[row] = fixed[row] * x[n]
                for inner in range(0, wide, 4):  # four together, for a processor loads and stores fewer rows
                    f0, f1, f2, f3 = x[inner], x[inner + 1], x[inner + 2], x[inner + 3]
                    a = free[of, inner : inner + 4]
                    for row in range(rows):
                        found[row] += f0 * a[0, row] + f1 * a[1, row] + f2 * a[2, row] + f3 * a[3, row]
                for stage in range(STAGES):
                    start[stage], start[STAGES + stage] = place + reach[of, stage] * rate, rate
                for row in range(STAGES):
                    for i in range(2 * STAGES):
                        found[row] += to[i, row] * start[i]
                for row in range(STAGES):
                    p[row] = 0.0
                    for i in range(STAGES):
                        p[row] += inverse[row, i] * found[i]
                for row in range(2 * STAGES):
                    for i in range(STAGES):
                        start[row] += by_p[of, row, i] * p[i]
                if keeps and column == 0:
                    states[c, s], inside[c, s] = x[:n], start
                for half in range(0, 2 * STAGES, 4):
                    f0, f1, f2, f3 = start[half], start[half + 1], start[half + 2], start[half + 3]
                    a = to[half : half + 4]
                    for row in range(STAGES, rows):
                        found[row] += f0 * a[0, row] + f1 * a[1, row] + f2 * a[2, row] + f3 * a[3, row]
                for row in range(n):
                    x[row] = found[STAGES + row]
        ends[c] = now[:, :n]
    return ends, states, inside
