"""Compiled statics of a mesh whose teeth differ, cycle by cycle over the tables of ``contact``.

Sources: docs/theory/teeth.md, "Statics".
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from lumped.compiler import compiled
from lumped.quasi_static.kernels import corner_at
from lumped.typing import FloatArray, IntArray

#: Of functions that allocate nothing: counting references would take most of their time.
inlined = compiled(_nrt=False, forceinline=True)

#: Forms of the contact: fixed windows, linear; the same, unilateral; own gaps and corners, unilateral; the
#: linear form about the own static state.
FIXED, FIXED_PUSH, PUSH, LINEAR = 0, 1, 2, 3
#: Rows of the contact of all places at an approach: gap [m], its slopes over xi and over the approach, sine
#: of the tilt, compression [m], load [N], tangent stiffness [N/m]; then what ``shared`` works with.
GAP, BY_XI, BY_DELTA, TILT, PRESSED, LOAD, TANGENT, STEP, MATRIX = range(9)
_STEPS = 100
_SETTLED = 1e-12
#: Change of the loads in a Newton's step, over their sum, after which no further one is needed.
_CLOSE = 1e-8


class Tables(NamedTuple):
    """Contact of every kind of pair (v) at the nodes of the steps of a mesh cycle; SI.

    Attributes
    ----------
    edges : (steps + 1,) phases of the ends of the steps, 0 and 1 included
    nodes, weights : (nodes,) places in a step, 0 to 1, ends are limits from inside, and those of quadrature
    outputs : (steps,) whether a step starts at an output
    ahead : (pairs,) whole pitches by which a place is ahead of the pair at A at the cycle's start; falling
    place : (steps, nodes, pairs) xi [m]
    stiffness, damping : (v, steps, nodes, pairs) k [N/m], zero where a pair is not followed, and c [N s/m]
    friction : (steps, nodes, pairs) mu
    gap : (v, steps, nodes, pairs) without corners and errors of single teeth [m]
    slopes : (v, steps, nodes, pairs, 4) of stiffness, damping, gap and friction over xi
    shape, shape_slope : (steps, nodes, pairs, 6) gap per unit of each number of a pair, and over xi
    ends : (v, 7) L_XA, L_XD, L_XY, base radii, as in ``gap_at`` [m], and what the gap of either tip's corner
        has at least, over the square of its way beyond the end [1/m]
    coupling : (1 or steps, nodes, pairs, pairs) w_ij [m/N]
    kinds : (z1, z2) kind of the pair of two teeth
    pinion, gear : (z1, 3), (z2, 3) error, profile slope, tip relief of the teeth [m]
    constants : force F, lengthening, softening D, least load N_1, load of the full damper; see ``ContactLaw``
    eccentric : (2, 6) amplitude, phase at t = 0, teeth, L, cot(alpha_w) of pinion and gear, and way of the
        common rotation on the base circles per amplitude. A row more for each ripple of a torque, which has
        this way alone: instead of the teeth the cycles of its period, instead of L its shaft
    turned : (steps, nodes, rows of eccentric, 2) cosine and sine of each turn since the cycle's start
    first : teeth at A at t = 0, from 0
    period : mesh cycles until all repeats
    duration : of a mesh cycle [s]
    speed : at which xi grows [m/s]
    """

    edges: FloatArray
    nodes: FloatArray
    weights: FloatArray
    outputs: IntArray
    ahead: IntArray
    place: FloatArray
    stiffness: FloatArray
    damping: FloatArray
    friction: FloatArray
    gap: FloatArray
    slopes: FloatArray
    shape: FloatArray
    shape_slope: FloatArray
    ends: FloatArray
    coupling: FloatArray
    kinds: IntArray
    pinion: FloatArray
    gear: FloatArray
    constants: FloatArray
    eccentric: FloatArray
    turned: FloatArray
    first: IntArray
    period: int
    duration: float
    speed: float


class Room(NamedTuple):
    """Arrays that a kernel works in.

    Attributes
    ----------
    place, coupling : as of ``Tables``, with a step more, in which a place between nodes is put
    kind : (pairs,) of the pair in each place
    errors : (pairs, 6) of its teeth, as in ``Tables.pinion`` and ``gear``
    k : (steps + 1, nodes, pairs) stiffness [N/m]
    flat : (steps + 1, nodes, pairs, 4) gap without corners, its slope over xi, c and mu
    moved : (steps + 1, nodes, 8) of ``eccentric_steps``
    here : of ``loads_at``
    share : (nodes,) of each node in the value at the place
    static : (1,) static approach at the last place, from which the next one is sought [m]
    """

    place: FloatArray
    coupling: FloatArray
    kind: IntArray
    errors: FloatArray
    k: FloatArray
    flat: FloatArray
    moved: FloatArray
    here: FloatArray
    share: FloatArray
    static: FloatArray


@compiled
def room_of(own: Tables) -> Room:
    """Arrays for a pair."""
    steps, nodes, pairs = own.place.shape
    place, coupling = np.zeros((steps + 1, nodes, pairs)), np.zeros((steps + 1, nodes, pairs, pairs))
    # One by one: of slices numba would compile the message about other shapes, a second.
    for s in range(steps):
        same = min(s, own.coupling.shape[0] - 1)
        for node in range(nodes):
            for i in range(pairs):
                place[s, node, i] = own.place[s, node, i]
                for other in range(pairs):
                    coupling[s, node, i, other] = own.coupling[same, node, i, other]
    contact = np.zeros((steps + 1, nodes, pairs)), np.zeros((steps + 1, nodes, pairs, 4))
    moved, here = np.zeros((steps + 1, nodes, 8)), np.zeros((MATRIX + pairs, pairs))
    kind, errors = np.zeros(pairs, np.int64), np.zeros((pairs, 6))
    return Room(place, coupling, kind, errors, *contact, moved, here, np.ones(nodes), np.zeros(1))


@compiled
def corner(
    beyond: float, start: float, tangent: float, flank_radius: float, tip_radius: float
) -> tuple[float, float, float]:
    """Gap of ``corner_at``, its slope over ``beyond``, the normal times the way of the corner; tilt."""
    if beyond <= 0.0:
        return 0.0, 0.0, 0.0
    gap, tilt = corner_at(beyond, start, tangent, flank_radius, tip_radius)
    length, turn = tangent - start, beyond / tip_radius
    sine, cosine = math.sin(turn), math.cos(turn)
    t_rate = (length * sine - tip_radius * cosine) / tip_radius
    n_rate = (tip_radius * sine + length * cosine) / tip_radius
    return gap, math.sqrt(1.0 - tilt * tilt) * t_rate + tilt * n_rate + 1.0, tilt


@inlined
def eccentric_steps(
    cycle: int, low: int, high: int, turned: FloatArray, eccentric: FloatArray, moved: FloatArray
) -> None:
    """Into ``moved``: e, de/dcycles, dL, turn of the line (A, D), de/dtheta of both gears, shift of xi.

    Rows (steps, nodes, 8) of a mesh cycle, from step ``low`` to before ``high``; ``turned`` as in ``Tables``.
    """
    moved[low:high] = 0.0
    for which in range(eccentric.shape[0]):
        size, cotangent, way = eccentric[which, 0], eccentric[which, 4], eccentric[which, 5]
        if size == 0.0:
            continue
        turns, sense = 2.0 * math.pi / eccentric[which, 2], 1.0 - 2.0 * which
        # Whole turns are taken off first: a million cycles lose no digit.
        angle = turns * (cycle % eccentric[which, 2]) + eccentric[which, 1]
        start_cosine, start_sine = size * math.cos(angle), size * math.sin(angle)
        for s in range(low, high):
            for node in range(moved.shape[1]):
                turn, found = turned[s, node, which], moved[s, node]
                cosine = start_cosine * turn[0] - start_sine * turn[1]
                sine = start_sine * turn[0] + start_cosine * turn[1]
                found[7] += way * sine
                if which > 1:
                    continue
                found[0] += cosine
                found[1] -= turns * sine
                found[2] += cosine - sense * sine * cotangent
                line = -sense * sine / eccentric[which, 3]  # angle by which the line of action turns
                found[3] += line  # times the base radius of the gear, and of the pinion
                found[4] += line
                found[5 + which] = -sine


@inlined
def contact_of_steps(cycle: int, low: int, high: int, fixed: bool, own: Tables, room: Room) -> None:
    """Contact of steps of a mesh cycle, from ``low`` to before ``high``, but for what the approach changes.

    It is at shifted places but in ``fixed`` windows. Written are ``kind`` to ``moved`` of ``room``.
    """
    kind, errors, k, flat, moved = room.kind, room.errors, room.k, room.flat, room.moved
    steps, nodes, pairs = own.place.shape
    eccentric_steps(cycle, low, high, own.turned, own.eccentric, moved)
    for i in range(pairs):
        number = cycle - own.ahead[i]
        p, g = (own.first[0] + number) % own.pinion.shape[0], (own.first[1] + number) % own.gear.shape[0]
        kind[i] = own.kinds[p, g]
        for n in range(3):
            errors[i, n], errors[i, 3 + n] = own.pinion[p, n], own.gear[g, n]
    edges, pitch = own.edges, own.speed * own.duration
    step = low
    for s in range(low, high):
        for node in range(nodes):
            off = moved[s, node]
            at, near, whole, way = s, node, 0, off[7]
            if off[7] != 0.0 and not fixed:  # the shifted place: its step, next node, and the way from that
                tau = edges[s] + own.nodes[node] * (edges[s + 1] - edges[s]) + off[7] / pitch
                whole = math.floor(tau)
                tau -= whole
                while step < steps - 1 and tau >= edges[step + 1]:
                    step += 1
                while tau < edges[step]:
                    step -= 1
                at, way = step, math.inf
                for other in range(nodes):
                    left = pitch * (tau - edges[at] - own.nodes[other] * (edges[at + 1] - edges[at]))
                    if abs(left) < abs(way):
                        near, way = other, left
            for i in range(pairs):
                row, column, j, left = at, near, i - whole, way
                if j < 0 or j >= pairs:  # far beyond the flanks
                    row, column, j, left = s, node, i, off[7]
                v, found = kind[i], flat[s, node, i]
                slopes, error = own.slopes[v, row, column, j], errors[i]
                shape, shape_slope = own.shape[row, column, j], own.shape_slope[row, column, j]
                k[s, node, i] = own.stiffness[v, row, column, j] + slopes[0] * left
                value, slope = own.gap[v, row, column, j] + off[0], slopes[2]
                for n in range(6):
                    value += shape[n] * error[n]
                    slope += shape_slope[n] * error[n]
                found[0], found[1] = value + slope * left, slope
                found[2] = own.damping[v, row, column, j] + slopes[1] * left
                found[3] = own.friction[row, column, j] + slopes[3] * left


@inlined
def shared(k: FloatArray, coupling: FloatArray, constants: FloatArray, here: FloatArray) -> None:
    """``quasi_static.shared_loads`` by Newton's steps for all loads at once, from those that ``here`` has.

    N_i (1/k_i - s/2 ln((N_i^2 + N_1^2)/F^2)) + sum_j w_ij N_j = p_i of the pairs that press.
    """
    force, softening, least, size = constants[0], constants[2], constants[3], k.size
    for _ in range(_STEPS):
        for i in range(size):
            left, load = here[PRESSED, i], here[LOAD, i]
            if left > 0.0:
                for j in range(size):
                    left -= coupling[i, j] * here[LOAD, j]
            for j in range(size):
                here[MATRIX + i, j] = 0.0
            here[MATRIX + i, i] = 1.0
            here[STEP, i] = here[TANGENT, i] = 0.0
            if left > 0.0 or load > 0.0:
                square = load * load + least * least
                secant = 1.0 / k[i] - 0.5 * softening * math.log(square / (force * force))
                for j in range(size):
                    here[MATRIX + i, j] = coupling[i, j]
                here[MATRIX + i, i] = secant - softening * load * load / square
                here[STEP, i], here[TANGENT, i] = left - load * secant, 1.0
        for i in range(size):  # the matrix is positive definite: no pivots
            for row in range(i + 1, size):
                factor = here[MATRIX + row, i] / here[MATRIX + i, i]
                if factor != 0.0:
                    for column in range(i + 1, size):
                        here[MATRIX + row, column] -= factor * here[MATRIX + i, column]
                    here[STEP, row] -= factor * here[STEP, i]
                    here[TANGENT, row] -= factor * here[TANGENT, i]
        change = total = 0.0
        for i in range(size - 1, -1, -1):
            for column in range(i + 1, size):
                here[STEP, i] -= here[MATRIX + i, column] * here[STEP, column]
                here[TANGENT, i] -= here[MATRIX + i, column] * here[TANGENT, column]
            here[STEP, i] /= here[MATRIX + i, i]
            here[TANGENT, i] /= here[MATRIX + i, i]
            load = max(here[LOAD, i] + here[STEP, i], 0.0)
            change += abs(load - here[LOAD, i])
            total += load
            here[LOAD, i] = load
        if change <= _CLOSE * total:  # the next step is its square
            break
    for i in range(size):
        if here[LOAD, i] == 0.0:
            here[TANGENT, i] = 0.0


@inlined
def loads_at(delta: float, single: bool, at: int, node: int, own: Tables, room: Room) -> None:
    """Gaps and elastic loads of all pairs at the approach ``delta``, into ``here``, at a node of a step.

    ``single``: linear pairs that do not move each other.
    """
    k, flat, moved, place = room.k[at, node], room.flat[at, node], room.moved[at, node], room.place[at, node]
    kind, ends, constants, here = room.kind, own.ends, own.constants, room.here
    longer = constants[1]
    half, length = 0.5 * (delta + longer), longer + moved[2]
    for i in range(k.size):
        if k[i] <= 0.0:
            here[LOAD, i] = here[TANGENT, i] = here[PRESSED, i] = 0.0
            continue
        gap, slope, rise, tilt = flat[i, 0], flat[i, 1], 0.0, 0.0
        of, xi = ends[kind[i]], place[i] + moved[7]
        early, late = of[0] - xi + half + of[4] * moved[3], xi - of[1] + half + of[3] * moved[4]
        line = of[2] + length
        pressed = delta - gap - of[5] * max(early, 0.0) ** 2 - of[6] * max(late, 0.0) ** 2
        if pressed > 0.0:  # else the tip's corner is farther away than that
            if early > 0.0:
                more, steep, tilt = corner(early, of[0] + length, line, of[3], of[4])
                gap, slope, rise = gap + more, slope - steep, 0.5 * steep
            if late > 0.0:
                more, steep, turned = corner(late, line - of[1], line, of[4], of[3])
                gap, slope, rise, tilt = gap + more, slope + steep, rise + 0.5 * steep, tilt + turned
            pressed = delta - gap
        here[GAP, i], here[BY_XI, i], here[BY_DELTA, i], here[TILT, i] = gap, slope, rise, tilt
        here[PRESSED, i] = pressed
        if single:
            here[LOAD, i] = k[i] * pressed if pressed > 0.0 else 0.0
            here[TANGENT, i] = k[i] if pressed > 0.0 else 0.0
    if not single:
        shared(k, room.coupling[at, node], constants, here)


@inlined
def settled(delta: float, single: bool, at: int, node: int, own: Tables, room: Room) -> float:
    """Static approach near ``delta`` at which the loads make the force [m], or NaN; see ``loads_at``."""
    k, here, constants = room.k[at, node], room.here, own.constants
    low, high, force = -math.inf, math.inf, constants[0]
    away = 1e-300
    for i in range(k.size):
        away = max(away, k[i])
    away = force / away
    for _ in range(_STEPS):
        loads_at(delta, single, at, node, own, room)
        total, slope = -force, 0.0
        for i in range(k.size):
            if k[i] > 0.0:
                total += here[LOAD, i]
                slope += here[TANGENT, i] * (1.0 - here[BY_DELTA, i])
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
