"""Compiled statics and motion of a mesh whose teeth differ, cycle by cycle over the tables of ``contact``.

Sources: docs/theory/teeth.md, "Statics", "Motion".
"""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from lumped.compiler import Compiler
from lumped.quasi_static import kernels as quasi_static
from lumped.quasi_static.kernels import corner_gap_at, shared_loads
from lumped.typing import FloatArray, IntArray

compiled = Compiler([Path(__file__), Path(quasi_static.__file__)])

#: Forms of the contact: fixed windows, linear; the same, push-only; own gaps and corners, push-only; the
#: linear form about the own static state.
FIXED, FIXED_PUSH, PUSH, LINEAR = 0, 1, 2, 3
_STEPS = 100
_SETTLED = 1e-12


@compiled
def corner(
    beyond: float, start: float, tangent: float, flank_radius: float, tip_radius: float
) -> tuple[float, float]:
    """``corner_gap_at``, and its slope over ``beyond``: the flank's normal times the way of the corner."""
    if beyond <= 0.0:
        return 0.0, 0.0
    gap = corner_gap_at(beyond, start, tangent, flank_radius, tip_radius)
    length = tangent - start
    turn = beyond / tip_radius
    sine, cosine = math.sin(turn), math.cos(turn)
    t = tangent - (tip_radius * sine + length * cosine)
    n = 2.0 * tip_radius * math.sin(0.5 * turn) ** 2 + length * sine
    far = math.sqrt(max(t * t + n * (n + 2.0 * flank_radius), 0.0))
    angle = math.atan2(t, n + flank_radius) - math.atan2(far, flank_radius)
    t_rate = (length * sine - tip_radius * cosine) / tip_radius
    n_rate = (tip_radius * sine + length * cosine) / tip_radius
    return gap, math.cos(angle) * t_rate - math.sin(angle) * n_rate + 1.0


@compiled
def eccentric_at(cycles: float, eccentric: FloatArray, found: FloatArray) -> None:
    """Into ``found``: e, de/dcycles, dL, shift of A and of D, then de/dtheta of pinion and gear."""
    found[:] = 0.0
    for which in range(2):
        size = eccentric[which, 0]
        if size == 0.0:
            continue
        turns = 2.0 * math.pi / eccentric[which, 2]
        # Whole turns are taken off first: a million cycles lose no digit.
        angle = turns * (cycles % eccentric[which, 2]) + eccentric[which, 1]
        cosine, sine = size * math.cos(angle), size * math.sin(angle)
        sense = 1.0 - 2.0 * which
        found[0] += cosine
        found[1] -= turns * sine
        found[2] += cosine - sense * sine * eccentric[which, 4]
        line = -sense * sine / eccentric[which, 3]  # angle by which the line of action turns
        found[3] += line  # times the base radius of the gear, and of the pinion
        found[4] += line
        found[5 + which] = -sine


@compiled
def gaps_of(
    delta: float,
    cycle: int,
    step: int,
    node: int,
    corners: bool,
    moved: FloatArray,
    longer: float,
    ahead: IntArray,
    place: FloatArray,
    stiffness: FloatArray,
    gap: FloatArray,
    gap_slope: FloatArray,
    shape: FloatArray,
    shape_slope: FloatArray,
    ends: FloatArray,
    kinds: IntArray,
    pinion: FloatArray,
    gear: FloatArray,
    first: IntArray,
    k: FloatArray,
    kind: IntArray,
    found: FloatArray,
) -> None:
    """Gaps of all places at the approach ``delta``: ``found`` (pairs, 3) is gap, over xi, over delta."""
    for i in range(ahead.size):
        number = cycle - ahead[i]
        p, g = (first[0] + number) % pinion.shape[0], (first[1] + number) % gear.shape[0]
        v = kinds[p, g]
        kind[i], k[i] = v, stiffness[v, step, node, i]
        if k[i] <= 0.0:
            continue
        value, slope, own = gap[v, step, node, i], gap_slope[v, step, node, i], 0.0
        for s in range(3):
            value += shape[step, node, i, s] * pinion[p, s] + shape[step, node, i, 3 + s] * gear[g, s]
            slope += shape_slope[step, node, i, s] * pinion[p, s]
            slope += shape_slope[step, node, i, 3 + s] * gear[g, s]
        if corners:
            half, length = 0.5 * (delta + longer), longer + moved[2]
            xi = place[step, node, i]
            early = ends[v, 0] - xi + half + ends[v, 4] * moved[3]
            late = xi - ends[v, 1] + half + ends[v, 3] * moved[4]
            if early > 0.0:
                more, rise = corner(early, ends[v, 0] + length, ends[v, 2] + length, ends[v, 3], ends[v, 4])
                value, slope, own = value + more, slope - rise, own + 0.5 * rise
            if late > 0.0:
                line = ends[v, 2] + length
                more, rise = corner(late, line - ends[v, 1], line, ends[v, 4], ends[v, 3])
                value, slope, own = value + more, slope + rise, own + 0.5 * rise
        found[i, 0], found[i, 1], found[i, 2] = value + moved[0], slope, own


@compiled
def carried(
    delta: float,
    k: FloatArray,
    coupling: FloatArray,
    gaps: FloatArray,
    constants: FloatArray,
    loads: FloatArray,
    tangents: FloatArray,
    alone: FloatArray,
) -> None:
    """Elastic loads [N] and tangents dN/ddelta [N/m] of all places at the approach ``delta``."""
    if constants[2] == 0.0 and not coupling.any():
        for i in range(k.size):
            pressed = delta - gaps[i, 0]
            touches = k[i] > 0.0 and pressed > 0.0
            loads[i] = k[i] * pressed if touches else 0.0
            tangents[i] = k[i] if touches else 0.0
        return
    pressed = np.empty(k.size)
    for i in range(k.size):
        if not k[i] > 0.0:
            loads[i] = alone[i] = 0.0
        pressed[i] = delta - gaps[i, 0]
    shared_loads(pressed, k, coupling, constants[2], constants[0], constants[3], loads, tangents, alone)


@compiled
def settled(
    delta: float,
    cycle: int,
    step: int,
    node: int,
    moved: FloatArray,
    coupling: FloatArray,
    constants: FloatArray,
    ahead: IntArray,
    place: FloatArray,
    stiffness: FloatArray,
    gap: FloatArray,
    gap_slope: FloatArray,
    shape: FloatArray,
    shape_slope: FloatArray,
    ends: FloatArray,
    kinds: IntArray,
    pinion: FloatArray,
    gear: FloatArray,
    first: IntArray,
    k: FloatArray,
    kind: IntArray,
    gaps: FloatArray,
    loads: FloatArray,
    tangents: FloatArray,
    alone: FloatArray,
) -> float:
    """Static approach near ``delta`` at which the loads make the force [m], or NaN; see ``gaps_of``."""
    low, high = -math.inf, math.inf
    for _ in range(_STEPS):
        gaps_of(
            delta, cycle, step, node, True, moved, constants[1], ahead, place, stiffness, gap, gap_slope,
            shape, shape_slope, ends, kinds, pinion, gear, first, k, kind, gaps,
        )  # fmt: skip
        carried(delta, k, coupling, gaps, constants, loads, tangents, alone)
        total, slope = loads.sum() - constants[0], 0.0
        for i in range(k.size):
            slope += tangents[i] * (1.0 - gaps[i, 2])
        if total < 0.0:
            low = delta
        else:
            high = delta
        # Newton's step; where it leaves the bracket, or nothing touches, bisect or go further.
        away = constants[0] / max(k.max(), 1e-300)
        following = delta - total / slope if slope > 0.0 else delta + away
        if not low < following < high:
            if low > -math.inf and high < math.inf:
                following = 0.5 * (low + high)
            else:
                following = delta + (2.0 * away if total < 0.0 else -2.0 * away)
        change = abs(following - delta)
        if change <= _SETTLED * (abs(delta) + away):
            return delta
        delta = following
    return math.nan


@compiled
def static_cycles(
    start: int,
    cycles: int,
    edges: FloatArray,
    eccentric: FloatArray,
    constants: FloatArray,
    coupling: FloatArray,
    ahead: IntArray,
    place: FloatArray,
    stiffness: FloatArray,
    gap: FloatArray,
    gap_slope: FloatArray,
    shape: FloatArray,
    shape_slope: FloatArray,
    ends: FloatArray,
    kinds: IntArray,
    pinion: FloatArray,
    gear: FloatArray,
    first: IntArray,
) -> tuple[FloatArray, FloatArray]:
    """Static approach (cycles, steps) [m] and loads (pairs, cycles, steps) [N] at the start of every step.

    NaN where no approach carries the force.
    """
    steps, pairs = edges.size - 1, ahead.size
    found, all_loads = np.empty((cycles, steps)), np.zeros((pairs, cycles, steps))
    loads, tangents, alone = np.zeros(pairs), np.zeros(pairs), np.zeros(pairs)
    k, gaps, kind, moved = np.zeros(pairs), np.zeros((pairs, 3)), np.zeros(pairs, np.int64), np.zeros(7)
    delta = 0.0
    for c in range(cycles):
        for s in range(steps):
            eccentric_at(start + c + edges[s], eccentric, moved)
            w = coupling[s if coupling.shape[0] > 1 else 0, 0]
            delta = settled(
                0.0 if math.isnan(delta) else delta, start + c, s, 0, moved, w, constants, ahead, place,
                stiffness, gap, gap_slope, shape, shape_slope, ends, kinds, pinion, gear, first, k, kind,
                gaps, loads, tangents, alone,
            )  # fmt: skip
            found[c, s] = delta
            for i in range(pairs):
                all_loads[i, c, s] = loads[i]
    return found, all_loads


@compiled
def motion_cycles(
    form: int,
    start: int,
    cycles: int,
    recorded: int,
    state: FloatArray,
    constant: FloatArray,
    deflection: FloatArray,
    per_load: FloatArray,
    per_moment: FloatArray,
    torque: FloatArray,
    ripple: FloatArray,
    per_torque: FloatArray,
    bearing: FloatArray,
    sliding: FloatArray,
    period: float,
    edges: FloatArray,
    outputs: IntArray,
    damping: FloatArray,
    friction: FloatArray,
    speed: float,
    eccentric: FloatArray,
    constants: FloatArray,
    coupling: FloatArray,
    ahead: IntArray,
    place: FloatArray,
    stiffness: FloatArray,
    gap: FloatArray,
    gap_slope: FloatArray,
    shape: FloatArray,
    shape_slope: FloatArray,
    ends: FloatArray,
    kinds: IntArray,
    pinion: FloatArray,
    gear: FloatArray,
    first: IntArray,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Motion over mesh cycles by the classical Runge-Kutta method of order 4.

    ``form`` is one of the four above; ``constant`` (m, 2m) acceleration of z per z and z' with the teeth
    apart, ``per_load`` (3, m) per N, F and F xi, ``per_moment`` (2, m) per moment on pinion and gear,
    ``torque`` (m,) that of both torques, ``ripple`` (n, 5) shaft, angle a cycle, phase, amplitude, cycles
    of its turn, ``per_torque`` (2, m) per torque;
    ``bearing`` (m, m) gives the power of the supports, ``sliding`` (3, m) the sliding velocity per z', as
    constant and per xi: rows pinion, gear, y. Returned are the states (outputs, 2m) and loads (pairs,
    outputs) of the last ``recorded`` cycles, the state at the end, and over these cycles the integrals of
    sliding, tooth dampers, supports, work of the teeth on both gears, of e's moments [J], and of N [N s].
    """
    m, pairs, steps = deflection.size, ahead.size, edges.size - 1
    count = recorded * outputs.sum()
    states, record = np.empty((count, 2 * m)), np.zeros((pairs, count))
    work = np.zeros(6)
    x, at, rate = state.copy(), np.empty(2 * m), np.zeros((4, 2 * m))
    power = np.zeros(6)
    loads, tangents, alone = np.zeros(pairs), np.zeros(pairs), np.zeros(pairs)
    k, gaps, kind, moved = np.zeros(pairs), np.zeros((pairs, 3)), np.zeros(pairs, np.int64), np.zeros(7)
    static, normal = 0.0, np.zeros(pairs)
    row = 0
    for c in range(cycles):
        cycle = start + c
        keeps = c >= cycles - recorded
        for s in range(steps):
            h = (edges[s + 1] - edges[s]) * period
            w = coupling[s if coupling.shape[0] > 1 else 0]
            for stage in range(4):
                node = (stage + 1) // 2
                if stage == 0:
                    at[:] = x
                else:
                    part = h if stage == 3 else 0.5 * h
                    for j in range(2 * m):
                        at[j] = x[j] + part * rate[stage - 1, j]
                delta, closing = 0.0, 0.0
                for j in range(m):
                    delta += deflection[j] * at[j]
                    closing += deflection[j] * at[m + j]
                tau = edges[s] + 0.5 * node * (edges[s + 1] - edges[s])
                eccentric_at(cycle + tau, eccentric, moved)
                e_rate = moved[1] / period
                if form == LINEAR:
                    if stage != 2:  # the middle of a step once
                        static = settled(
                            static, cycle, s, node, moved, w[node], constants, ahead, place, stiffness, gap,
                            gap_slope, shape, shape_slope, ends, kinds, pinion, gear, first, k, kind, gaps,
                            loads, tangents, alone,
                        )  # fmt: skip
                else:
                    gaps_of(
                        delta, cycle, s, node, form == PUSH, moved, constants[1], ahead, place, stiffness,
                        gap, gap_slope, shape, shape_slope, ends, kinds, pinion, gear, first, k, kind, gaps,
                    )  # fmt: skip
                    if form == PUSH:
                        carried(delta, k, w[node], gaps, constants, loads, tangents, alone)
                sums = 0.0
                friction_sum, friction_arm = 0.0, 0.0
                power[:] = 0.0
                v_p, v_g, v_y = sliding[0, m], sliding[1, m], 0.0
                for j in range(m):
                    v_p += sliding[0, j] * at[m + j]
                    v_g += sliding[1, j] * at[m + j]
                    v_y += sliding[2, j] * at[m + j]
                for i in range(pairs):
                    normal[i] = 0.0
                    if k[i] <= 0.0:
                        continue
                    c_i = damping[kind[i], s, node, i]
                    pressing = closing * (1.0 - gaps[i, 2]) - gaps[i, 1] * speed - e_rate
                    if form <= FIXED_PUSH:
                        load = k[i] * (delta - gaps[i, 0]) + c_i * pressing
                        damped = c_i * pressing
                    else:
                        if loads[i] <= 0.0:
                            continue
                        part = min(loads[i] / constants[4], 1.0)
                        c_i *= part * part * (3.0 - 2.0 * part)
                        damped = c_i * pressing
                        load = loads[i] + damped
                        if form == LINEAR:
                            load += tangents[i] * (delta - static)
                    if form != FIXED and form != LINEAR and load < 0.0:
                        load = 0.0
                        damped = 0.0
                    normal[i] = load
                    xi = place[s, node, i]
                    f = friction[s, node, i] * load
                    sums += load
                    friction_sum += f
                    friction_arm += f * xi
                    power[0] += f * (v_p * xi - v_g * (sliding[2, m] - xi) - v_y)
                    power[1] += damped * pressing
                # The moments of e work on the vibration too.
                v_p, v_g = v_p - sliding[0, m], v_g - sliding[1, m]
                power[3] = sums * (closing - e_rate - moved[5] * v_p - moved[6] * v_g)
                power[4] = sums * e_rate
                power[5] = sums
                for j in range(m):
                    acceleration = torque[j]
                    acceleration += sums * (
                        per_load[0, j] + per_moment[0, j] * moved[5] + per_moment[1, j] * moved[6]
                    )
                    acceleration += friction_sum * per_load[1, j] + friction_arm * per_load[2, j]
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
                for n in range(6):
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


@compiled
def tangents_of_cycle(
    cycle: int,
    static: float,
    loaded: bool,
    edges: FloatArray,
    damping: FloatArray,
    friction: FloatArray,
    eccentric: FloatArray,
    constants: FloatArray,
    coupling: FloatArray,
    ahead: IntArray,
    place: FloatArray,
    stiffness: FloatArray,
    gap: FloatArray,
    gap_slope: FloatArray,
    shape: FloatArray,
    shape_slope: FloatArray,
    ends: FloatArray,
    kinds: IntArray,
    pinion: FloatArray,
    gear: FloatArray,
    first: IntArray,
) -> tuple[FloatArray, float]:
    """Mesh of one cycle about its static state, at the nodes of the steps (steps, 3, 8), and the approach.

    Columns: d of the sums N, F and F xi over delta and over its rate, then de/dtheta of both gears.
    ``static`` is an approach near that of the first node.
    """
    steps, pairs = edges.size - 1, ahead.size
    found = np.zeros((steps, 3, 8))
    loads, tangents, alone = np.zeros(pairs), np.zeros(pairs), np.zeros(pairs)
    k, gaps, kind, moved = np.zeros(pairs), np.zeros((pairs, 3)), np.zeros(pairs, np.int64), np.zeros(7)
    for s in range(steps):
        w = coupling[s if coupling.shape[0] > 1 else 0]
        for node in range(3):
            tau = edges[s] + 0.5 * node * (edges[s + 1] - edges[s])
            eccentric_at(cycle + tau, eccentric, moved)
            if loaded:
                static = settled(
                    static, cycle, s, node, moved, w[node], constants, ahead, place, stiffness, gap,
                    gap_slope, shape, shape_slope, ends, kinds, pinion, gear, first, k, kind, gaps, loads,
                    tangents, alone,
                )  # fmt: skip
            else:
                gaps_of(
                    0.0, cycle, s, node, False, moved, 0.0, ahead, place, stiffness, gap, gap_slope, shape,
                    shape_slope, ends, kinds, pinion, gear, first, k, kind, gaps,
                )  # fmt: skip
            for i in range(pairs):
                if k[i] <= 0.0 or (loaded and loads[i] <= 0.0):
                    continue
                rise, damper = k[i], damping[kind[i], s, node, i]
                if loaded:
                    part = min(loads[i] / constants[4], 1.0)
                    rise = tangents[i]
                    damper *= part * part * (3.0 - 2.0 * part) * (1.0 - gaps[i, 2])
                mu = friction[s, node, i]
                for column, value in ((0, rise), (3, damper)):
                    found[s, node, column] += value
                    found[s, node, column + 1] += mu * value
                    found[s, node, column + 2] += mu * value * place[s, node, i]
            found[s, node, 6], found[s, node, 7] = moved[5], moved[6]
    return found, static
