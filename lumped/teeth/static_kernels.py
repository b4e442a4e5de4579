"""Compiled mesh of teeth that differ about its static state: at any places, and over cycles with kinks.

Sources: docs/theory/teeth.md, "Statics", "The linear form".
"""

from __future__ import annotations

import math

import numpy as np

from lumped.compiler import compiled
from lumped.teeth import kernels as kn
from lumped.teeth.kernels import Room, Tables, contact_of_steps, room_of, settled
from lumped.typing import FloatArray

inlined = compiled(_nrt=False, forceinline=True)


@inlined
def put_between(s: int, x: float, own: Tables, room: Room) -> None:
    """Contact at the place ``x`` of a step, 0 to 1, by the polynomial through that of its nodes."""
    at, nodes, pairs = own.place.shape
    share, k, flat, moved = room.share, room.k, room.flat, room.moved
    place, coupling = room.place, room.coupling
    place[at, 0], coupling[at, 0] = 0.0, 0.0
    k[at, 0], flat[at, 0], moved[at, 0] = 0.0, 0.0, 0.0
    for j in range(nodes):
        share[j] = below = 1.0
        for other in range(nodes):
            if other != j:
                share[j] *= x - own.nodes[other]
                below *= own.nodes[j] - own.nodes[other]
        share[j] /= below
        for n in range(8):
            moved[at, 0, n] += share[j] * moved[s, j, n]
        for i in range(pairs):
            k[at, 0, i] += share[j] * k[s, j, i]
            place[at, 0, i] += share[j] * place[s, j, i]
            for n in range(4):
                flat[at, 0, i, n] += share[j] * flat[s, j, i, n]
            for n in range(pairs):
                coupling[at, 0, i, n] += share[j] * coupling[s, j, i, n]


@inlined
def at_place(
    s: int, x: float, fixed: bool, single: bool, own: Tables, room: Room, row: FloatArray, numbers: FloatArray
) -> None:
    """Sums and numbers of ``static_places`` at a place of a step whose contact ``room`` has."""
    at, node, kinds = s, int(-1.0 - x), numbers.shape[0]
    if x > -0.5:
        at, node = own.place.shape[0], 0
        put_between(s, x, own, room)
    k_at, gap, off = room.k[at, node], room.flat[at, node], room.moved[at, node]
    xi, w, here, constants, pairs = (
        room.place[at, node],
        room.coupling[at, node],
        room.here,
        own.constants,
        k_at.size,
    )
    if not fixed:
        guess = 0.0 if math.isnan(room.static[0]) else room.static[0]
        room.static[0] = settled(guess, single, at, node, own, room)
    static = room.static[0]
    row[:], numbers[:] = 0.0, 0.0
    row[9], row[10], row[17] = off[5], off[6], static
    for i in range(pairs):
        if kinds > 0 and k_at[i] > 0.0 and not fixed:
            numbers[0, i], numbers[1, i] = here[kn.PRESSED, i], here[kn.LOAD, i] - constants[4]
            for n in range(pairs):
                numbers[0, i] -= w[i, n] * here[kn.LOAD, n]
            if kinds > 2:
                of, beyond = own.ends[room.kind[i]], 0.5 * (static + constants[1])
                numbers[2, i] = of[0] - xi[i] - off[7] + beyond + of[4] * off[3]
                numbers[3, i] = xi[i] + off[7] - of[1] + beyond + of[3] * off[4]
        if k_at[i] <= 0.0 or not (fixed or here[kn.LOAD, i] > 0.0):
            continue
        c_i, rise, load = gap[i, 2], k_at[i], -k_at[i] * gap[i, 0]
        closing, slope, tilt = 1.0, gap[i, 1], 0.0
        if not fixed:
            part = min(here[kn.LOAD, i] / constants[4], 1.0)
            c_i *= part * part * (3.0 - 2.0 * part)
            rise, load = here[kn.TANGENT, i], here[kn.LOAD, i] - here[kn.TANGENT, i] * static
            closing, slope, tilt = 1.0 - here[kn.BY_DELTA, i], here[kn.BY_XI, i], here[kn.TILT, i]
        rolling = slope * own.speed + off[1] / own.duration
        load -= c_i * rolling
        mu, arm = gap[i, 3], xi[i] + (0.0 if fixed else off[7])
        for n, value in ((0, rise), (1, c_i * closing), (2, load)):
            row[3 * n] += value
            row[3 * n + 1] += mu * value
            row[3 * n + 2] += mu * value * arm
            row[14 + n] += tilt * value
            if kinds > 4:
                numbers[5 + n, i] = value
        if kinds > 4:
            numbers[4, i] = here[kn.LOAD, i]
        row[11] += c_i * closing**2
        row[12] -= 2.0 * c_i * closing * rolling
        row[13] += c_i * rolling**2


@compiled(nogil=True)
def static_places(
    start: int, fixed: bool, own: Tables, asked: FloatArray, sums: FloatArray, numbers: FloatArray
) -> None:
    """Mesh about its static state, into ``sums`` (n, 18) and ``numbers`` (n, kinds, pairs).

    ``asked`` (n, 3) is cycles after ``start``, step, and place in it: 0 to 1, or -1 - j for the node j.
    ``fixed`` ties the teeth in the windows of the tables, N = k (delta - e) + c (delta' - e').

    Sums are of N, mu N and mu N xi by delta, by delta', and without motion; de/dtheta of both gears; what
    dampers take, by delta'^2, delta' and without motion; the force of tip corners that pushes the gears
    apart, by delta, by delta' and without motion; the static approach [m], NaN where none carries the force.
    Numbers of each pair are, none, the first 2, 4 or all 8, what changes its sign at a kink: compression that
    presses [m], load less that of the full damper [N], ways of the contact point beyond start and end of the
    line [m]; then static load [N] and the load of small motions, rise delta + damper delta' + constant.
    """
    room = room_of(own)
    single = own.constants[2] == 0.0 and not own.coupling.any()
    now, known = -1, np.full(own.place.shape[0], -1)  # known is the cycle whose contact a step has
    for a in range(asked.shape[0]):
        s = int(asked[a, 1])
        if asked[a, 0] != now or known[s] != now:
            now = known[s] = int(asked[a, 0])
            contact_of_steps(start + now, s, s + 1, fixed, own, room)
        at_place(s, asked[a, 2], fixed, single, own, room, sums[a], numbers[a])


@compiled(nogil=True)
def static_cycles(
    start: int, fixed: bool, own: Tables, looks: FloatArray, kinds: int, rounds: int, sums: FloatArray
) -> FloatArray:
    """Fill ``sums`` of consecutive cycles, and return the phases of their kinks, by cycles from ``start``.

    ``sums`` are (cycles, steps, nodes, 18), those of ``static_places`` at the nodes, which ``looks`` then
    are; but in a step with kinks they have the moments of what they are there, by the rule on both sides of
    each. With (cycles, steps, 0, 18) the kinks alone are sought. ``looks`` (k,) are places in a step, between
    which each of the ``kinds`` of numbers has at most one root; it is found by ``rounds`` of Illinois' rule.
    """
    (steps, nodes, pairs), edges, count = own.place.shape, own.edges, looks.size
    cycles, fills = sums.shape[0], sums.shape[2] > 0
    room, row, numbers = room_of(own), np.zeros(18), np.zeros((kinds, pairs))
    single = own.constants[2] == 0.0 and not own.coupling.any()
    tau, values = np.empty(steps * count), np.empty((steps * count, kinds, pairs))
    roots, step_of = np.empty(tau.size * kinds * pairs), np.empty(tau.size * kinds * pairs, np.int64)
    phases, known = np.empty(16), 0
    for look in range(tau.size):
        s, x = look // count, looks[look % count]
        tau[look] = edges[s] + (edges[s + 1] - edges[s]) * (x if x > -0.5 else own.nodes[int(-1.0 - x)])
    for c in range(cycles):
        contact_of_steps(start + c, 0, steps, fixed, own, room)
        for look in range(tau.size):
            s, j = look // count, look % count
            at_place(s, looks[j], fixed, single, own, room, sums[c, s, j] if fills else row, values[look])
        found = 0
        for look in range(1, tau.size):
            for n in range(kinds * pairs):
                kind, i = n // pairs, n % pairs
                at_low, at_high, last = values[look - 1, kind, i], values[look, kind, i], -1
                if not at_low * at_high < 0.0:
                    continue
                low, high, s, root = tau[look - 1], tau[look], (look - 1) // count, 0.0
                for left in range(rounds, -1, -1):
                    root = (low * at_high - high * at_low) / (at_high - at_low)
                    s = (look - 1) // count
                    if s < steps - 1 and root >= edges[s + 1]:
                        s += 1
                    if left == 0:
                        break
                    x = (root - edges[s]) / (edges[s + 1] - edges[s])
                    at_place(s, x, fixed, single, own, room, row, numbers)
                    value = numbers[kind, i]
                    if (value < 0.0) == (at_low < 0.0):
                        at_high *= 0.5 if last == 0 else 1.0
                        low, at_low, last = root, value, 0
                    else:
                        at_low *= 0.5 if last == 1 else 1.0
                        high, at_high, last = root, value, 1
                if known == phases.size:
                    phases = np.append(phases, np.empty(known))
                phases[known] = c + root
                known += 1
                j = found  # sorted as they come
                while j > 0 and roots[j - 1] > root:
                    roots[j], step_of[j] = roots[j - 1], step_of[j - 1]
                    j -= 1
                roots[j], step_of[j] = root, s
                found += 1
        at = 0
        while fills and at < found:
            s, low = step_of[at], 0.0
            sums[c, s] = 0.0
            while low < 1.0:
                high = 1.0
                if at < found and step_of[at] == s:
                    high = max(low, (roots[at] - edges[s]) / (edges[s + 1] - edges[s]))
                    at += 1
                for node in range(nodes if high > low else 0):
                    x = low + (high - low) * own.nodes[node]
                    at_place(s, x, fixed, single, own, room, row, numbers[:0])
                    for j in range(nodes):
                        part = (high - low) * own.weights[node] * room.share[j] / own.weights[j]
                        for n in range(18):
                            sums[c, s, j, n] += part * row[n]
                low = high
    return phases[:known].copy()
