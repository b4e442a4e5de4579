"""Compiled statics and motion of a mesh whose teeth differ, cycle by cycle over the tables of ``contact``.

Sources: docs/theory/teeth.md, "Statics", "Motion".
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import NamedTuple

import numpy as np

from lumped.compiler import Compiler
from lumped.quasi_static import kernels as quasi_static
from lumped.quasi_static.kernels import corner_at, shared_loads
from lumped.typing import FloatArray, IntArray

compiled = Compiler([Path(__file__), Path(quasi_static.__file__)])

#: Forms of the contact: fixed windows, linear; the same, push-only; own gaps and corners, push-only; the
#: linear form about the own static state.
FIXED, FIXED_PUSH, PUSH, LINEAR = 0, 1, 2, 3
_STEPS = 100
_SETTLED = 1e-12


class Tables(NamedTuple):
    """Contact of every kind of pair (v) at the nodes of the steps of a mesh cycle; SI.

    Attributes
    ----------
    edges : (steps + 1,) phases of the ends of the steps, 0 and 1 included
    nodes : (nodes,) places in a step, 0 to 1; ends are limits from inside
    outputs : (steps,) whether a step starts at an output
    ahead : (pairs,) whole pitches by which a place is ahead of the pair at A at the cycle's start; falling
    place : (steps, nodes, pairs) xi [m]
    stiffness, damping : (v, steps, nodes, pairs) k [N/m], zero where a pair is not followed, and c [N s/m]
    friction : (steps, nodes, pairs) mu
    gap, gap_slope : (v, steps, nodes, pairs) without corners and errors of single teeth [m], and over xi
    shape, shape_slope : (steps, nodes, pairs, 6) gap per unit of each number of a pair, and over xi
    ends : (v, 5) L_XA, L_XD, L_XY, base radii, as in ``gap_at`` [m]
    coupling : (1 or steps, nodes, pairs, pairs) w_ij [m/N]
    kinds : (z1, z2) kind of the pair of two teeth
    pinion, gear : (z1, 3), (z2, 3) error, profile slope, tip relief of the teeth [m]
    constants : force F, lengthening, softening D, least load N_1, load of the full damper; see ``ContactLaw``
    eccentric : (2, 6) amplitude, phase at t = 0, teeth, L, cot(alpha_w) of pinion and gear, and way of the
        common rotation on the base circles per amplitude
    first : teeth at A at t = 0, from 0
    period : mesh cycles until all repeats
    duration : of a mesh cycle [s]
    speed : at which xi grows [m/s]
    """

    edges: FloatArray
    nodes: FloatArray
    outputs: IntArray
    ahead: IntArray
    place: FloatArray
    stiffness: FloatArray
    damping: FloatArray
    friction: FloatArray
    gap: FloatArray
    gap_slope: FloatArray
    shape: FloatArray
    shape_slope: FloatArray
    ends: FloatArray
    coupling: FloatArray
    kinds: IntArray
    pinion: FloatArray
    gear: FloatArray
    constants: FloatArray
    eccentric: FloatArray
    first: IntArray
    period: int
    duration: float
    speed: float


@compiled
def corner(
    beyond: float, start: float, tangent: float, flank_radius: float, tip_radius: float
) -> tuple[float, float]:
    """The gap of ``corner_at``, its slope over ``beyond``: the flank's normal times the way of the corner."""
    if beyond <= 0.0:
        return 0.0, 0.0
    gap = corner_at(beyond, start, tangent, flank_radius, tip_radius)[0]
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
    """Into ``found``: e, de/dcycles, dL, turn of the line (A, D), de/dtheta of both gears, shift of xi."""
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
        found[7] += eccentric[which, 5] * sine


@compiled
def gaps_of(
    delta: float,
    cycle: int,
    step: int,
    node: int,
    corners: bool,
    moved: FloatArray,
    own: Tables,
    k: FloatArray,
    kind: IntArray,
    found: FloatArray,
) -> None:
    """Gaps of all places at the approach ``delta``: ``found`` (pairs, 5) is gap, over xi, over delta.

    The last two are the first two without corners, which do not depend on ``delta``.
    """
    for i in range(own.ahead.size):
        number = cycle - own.ahead[i]
        p, g = (own.first[0] + number) % own.pinion.shape[0], (own.first[1] + number) % own.gear.shape[0]
        v = own.kinds[p, g]
        kind[i], k[i] = v, own.stiffness[v, step, node, i]
        if k[i] <= 0.0:
            continue
        value, slope = own.gap[v, step, node, i] + moved[0], own.gap_slope[v, step, node, i]
        for s in range(3):
            a, b = own.pinion[p, s], own.gear[g, s]
            value += own.shape[step, node, i, s] * a + own.shape[step, node, i, 3 + s] * b
            slope += own.shape_slope[step, node, i, s] * a + own.shape_slope[step, node, i, 3 + s] * b
        value += slope * moved[7]
        found[i, 0], found[i, 1], found[i, 2], found[i, 3], found[i, 4] = value, slope, 0.0, value, slope
    if corners:
        add_corners(delta, step, node, moved, own, k, kind, found)


@compiled
def add_corners(
    delta: float,
    step: int,
    node: int,
    moved: FloatArray,
    own: Tables,
    k: FloatArray,
    kind: IntArray,
    found: FloatArray,
) -> None:
    """Add what tip corners make of ``gaps_of`` at the approach ``delta``."""
    longer = own.constants[1]
    half, length = 0.5 * (delta + longer), longer + moved[2]
    for i in range(k.size):
        if k[i] <= 0.0:
            continue
        found[i, 0], found[i, 1], found[i, 2] = found[i, 3], found[i, 4], 0.0
        ends, xi = own.ends[kind[i]], own.place[step, node, i] + moved[7]
        early = ends[0] - xi + half + ends[4] * moved[3]
        late = xi - ends[1] + half + ends[3] * moved[4]
        line = ends[2] + length
        if early > 0.0:
            more, rise = corner(early, ends[0] + length, line, ends[3], ends[4])
            found[i, 0] += more
            found[i, 1] -= rise
            found[i, 2] += 0.5 * rise
        if late > 0.0:
            more, rise = corner(late, line - ends[1], line, ends[4], ends[3])
            found[i, 0] += more
            found[i, 1] += rise
            found[i, 2] += 0.5 * rise


@compiled
def tilt_of(delta: float, xi: float, ends: FloatArray, moved: FloatArray, longer: float) -> float:
    """Tilt of the pair at xi at the approach ``delta``, as of ``corner_at``; 0 where no corner is beyond."""
    half, length = 0.5 * (delta + longer), longer + moved[2]
    xi += moved[7]
    early = ends[0] - xi + half + ends[4] * moved[3]
    late = xi - ends[1] + half + ends[3] * moved[4]
    line, tilt = ends[2] + length, 0.0
    if early > 0.0:
        tilt += corner_at(early, ends[0] + length, line, ends[3], ends[4])[1]
    if late > 0.0:
        tilt += corner_at(late, line - ends[1], line, ends[4], ends[3])[1]
    return tilt


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
    own: Tables,
    k: FloatArray,
    kind: IntArray,
    gaps: FloatArray,
    loads: FloatArray,
    tangents: FloatArray,
    alone: FloatArray,
) -> float:
    """Static approach near ``delta`` at which the loads make the force [m], or NaN; see ``gaps_of``."""
    low, high = -math.inf, math.inf
    coupling, force = own.coupling[step if own.coupling.shape[0] > 1 else 0, node], own.constants[0]
    gaps_of(delta, cycle, step, node, False, moved, own, k, kind, gaps)
    away = force / max(k.max(), 1e-300)
    for _ in range(_STEPS):
        add_corners(delta, step, node, moved, own, k, kind, gaps)
        carried(delta, k, coupling, gaps, own.constants, loads, tangents, alone)
        total, slope = -force, 0.0
        for i in range(k.size):
            total += loads[i]
            slope += tangents[i] * (1.0 - gaps[i, 2])
        if abs(total) <= _SETTLED * force:
            return delta
        if total < 0.0:
            low = delta
        else:
            high = delta
        # Newton's step; where it leaves the bracket, or nothing touches, bisect or go further.
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
    start: int, cycles: int, fixed: bool, own: Tables
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Mesh of consecutive cycles about its static state; NaN where no approach carries the force.

    Returns
    -------
    approach : (cycles, steps, nodes) static approach [m]
    each : (4, pairs, cycles, steps) of every place at the first node of each step: static load [N], then the
        load of small motions, rise delta + damper delta' + constant
    sums : (cycles, steps, nodes, 17) of N, mu N and mu N xi by delta, by delta', and without motion; then
        de/dtheta of both gears; then what dampers take, by delta'^2, delta' and without motion; then the
        force of tip corners that pushes the gears apart, by delta, by delta' and without motion
    ``fixed`` ties the teeth in the windows of the tables, N = k (delta - e) + c (delta' - e').
    """
    steps, nodes, pairs = own.edges.size - 1, own.nodes.size, own.ahead.size
    approach, each = np.zeros((cycles, steps, nodes)), np.zeros((4, pairs, cycles, steps))
    sums = np.zeros((cycles, steps, nodes, 17))
    loads, tangents, alone = np.zeros(pairs), np.zeros(pairs), np.zeros(pairs)
    k, gaps, kind, moved = np.zeros(pairs), np.zeros((pairs, 5)), np.zeros(pairs, np.int64), np.zeros(8)
    static = 0.0
    for c in range(cycles):
        for s in range(steps):
            for node in range(nodes):
                tau = own.edges[s] + own.nodes[node] * (own.edges[s + 1] - own.edges[s])
                eccentric_at(start + c + tau, own.eccentric, moved)
                if fixed:
                    gaps_of(0.0, start + c, s, node, False, moved, own, k, kind, gaps)
                else:
                    guess = 0.0 if math.isnan(static) else static
                    static = settled(
                        guess, start + c, s, node, moved, own, k, kind, gaps, loads, tangents, alone
                    )
                    approach[c, s, node] = static
                row = sums[c, s, node]
                row[9], row[10] = moved[5], moved[6]
                for i in range(pairs):
                    if k[i] <= 0.0 or not (fixed or loads[i] > 0.0):
                        continue
                    rise, part, load = k[i], 1.0, -k[i] * gaps[i, 0]
                    if not fixed:
                        part = min(loads[i] / own.constants[4], 1.0)
                        part *= part * (3.0 - 2.0 * part)
                        rise, load = tangents[i], loads[i] - tangents[i] * static
                    c_i = own.damping[kind[i], s, node, i] * part
                    closing, rolling = 1.0 - gaps[i, 2], gaps[i, 1] * own.speed + moved[1] / own.duration
                    load -= c_i * rolling
                    mu, xi, tilt = own.friction[s, node, i], own.place[s, node, i], 0.0
                    if not fixed:
                        tilt = tilt_of(static, xi, own.ends[kind[i]], moved, own.constants[1])
                    for n, value in ((0, rise), (1, c_i * closing), (2, load)):
                        row[3 * n] += value
                        row[3 * n + 1] += mu * value
                        row[3 * n + 2] += mu * value * xi
                        row[14 + n] += tilt * value
                    row[11] += c_i * closing**2
                    row[12] -= 2.0 * c_i * closing * rolling
                    row[13] += c_i * rolling**2
                    if node == 0:
                        each[0, i, c, s] = loads[i]
                        each[1, i, c, s], each[2, i, c, s], each[3, i, c, s] = rise, c_i * closing, load
    return approach, each, sums


@compiled
def motion_cycles(
    corners: bool,
    start: int,
    cycles: int,
    recorded: int,
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
    own: Tables,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Motion of teeth that push only over mesh cycles by the classical Runge-Kutta method of order 4.

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
    work = np.zeros(4)
    x, at, rate = state.copy(), np.empty(2 * m), np.zeros((4, 2 * m))
    power = np.zeros(4)
    loads, tangents, alone = np.zeros(pairs), np.zeros(pairs), np.zeros(pairs)
    k, gaps, kind, moved = np.zeros(pairs), np.zeros((pairs, 5)), np.zeros(pairs, np.int64), np.zeros(8)
    normal = np.zeros(pairs)
    row = 0
    for c in range(cycles):
        cycle = start + c
        keeps = c >= cycles - recorded
        for s in range(steps):
            h = (own.edges[s + 1] - own.edges[s]) * own.duration
            w = own.coupling[s if own.coupling.shape[0] > 1 else 0]
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
                tau = own.edges[s] + own.nodes[node] * (own.edges[s + 1] - own.edges[s])
                eccentric_at(cycle + tau, own.eccentric, moved)
                e_rate = moved[1] / own.duration
                gaps_of(delta, cycle, s, node, corners, moved, own, k, kind, gaps)
                if corners:
                    carried(delta, k, w[node], gaps, own.constants, loads, tangents, alone)
                sums, friction_sum, friction_arm, apart = 0.0, 0.0, 0.0, 0.0
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
                    c_i = own.damping[kind[i], s, node, i]
                    pressing = closing * (1.0 - gaps[i, 2]) - gaps[i, 1] * own.speed - e_rate
                    if corners:
                        if loads[i] <= 0.0:
                            continue
                        part = min(loads[i] / own.constants[4], 1.0)
                        c_i *= part * part * (3.0 - 2.0 * part)
                        load = loads[i] + c_i * pressing
                    else:
                        load = k[i] * (delta - gaps[i, 0]) + c_i * pressing
                    if load <= 0.0:
                        continue
                    normal[i] = load
                    xi = own.place[s, node, i]
                    f = own.friction[s, node, i] * load
                    sums += load
                    if corners:
                        apart += load * tilt_of(delta, xi, own.ends[kind[i]], moved, own.constants[1])
                    friction_sum += f
                    friction_arm += f * xi
                    power[0] += f * (v_p * xi - v_g * (sliding[2, m] - xi) - v_y)
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
                if stage == 0 and own.outputs[s] == 1:
                    for j in range(2 * m):
                        states[row, j] = x[j]
                    for i in range(pairs):
                        record[i, row] = normal[i]
                    row += 1
            for j in range(2 * m):
                x[j] += h / 6.0 * (rate[0, j] + 2.0 * rate[1, j] + 2.0 * rate[2, j] + rate[3, j])
    return states, record, x, work
