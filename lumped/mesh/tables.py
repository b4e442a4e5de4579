"""The tooth pairs of any mesh cycle, as they are without load, from tables over the steps of one mesh cycle.

Everything of a tooth pair repeats with the mesh cycle but for what its own two teeth bring: three numbers
each, and its kind, which is that of their faults. Eccentric gears turn the line of action, and they and
ripples of the torques swing the common rotation, which the contact follows. Like teeth have one kind, no
numbers, and nothing that turns.

Sources: docs/theory/teeth.md, "Tables", "Eccentricity".
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from lumped.mesh.element import CONTACT, LINE, PAIR, ContactLaw, Record, Records, inlined, place_pair, record
from lumped.typing import FloatArray, IntArray

#: Laws of a kind of tooth pair at a place of the mesh cycle, or their slopes over xi.
LAWS = record(
    stiffness="k [N/m]; 0 where the pair is not followed",
    damping="c of the full damper [N s/m]",
    friction="mu [-]",
    gap="without tip corners and without the numbers of single teeth [m]",
)
#: The numbers of one tooth, or the gap of a pair per unit of each.
TOOTH = record(
    error="constant over the flank, positive where the tooth comes too late [m]",
    slope="profile slope deviation, material at the tip [m]",
    relief="tip relief beyond the design's [m]",
)
#: What turns with a shaft: an eccentric gear, or a harmonic of a torque, whose amplitude only swings.
TURNING = record(
    shaft="0 pinion, 1 gear",
    amplitude="eccentricity [m], or torque [N m]",
    start="phase at t = 0 [rad]",
    cycles="mesh cycles of a turn",
    swing="way of the common rotation on the base circles per amplitude",
)
#: Rows of TURNING: both gears, and the first of the ripples.
PINION, GEAR, RIPPLES = range(3)


class MeshTables(NamedTuple):
    """Tooth pairs of every kind at the nodes of the steps of a mesh cycle; SI.

    Attributes
    ----------
    edges : (steps + 1,) phases of the ends of the steps, 0 and 1 included
    nodes, weights : (nodes,) places in a step, 0 to 1, ends are limits from inside, and those of quadrature
    outputs : (steps,) whether a step starts at an output
    ahead : (pairs,) whole pitches by which a place is ahead of the pair at A at the cycle's start; falling
    position : (steps, nodes, pairs) xi [m]
    laws, slopes : (kinds, steps, nodes, pairs) LAWS and their slopes over xi
    shape, shape_slope : (steps, nodes, pairs, 2) TOOTH: gap per unit of the numbers of the pinion's and the
        gear's tooth, and its slope over xi
    flanks : (kinds,) FLANKS
    coupling : (steps, nodes, pairs, pairs) w_ij by which the load of a pair moves another [m/N]
    kinds : (z1, z2) kind of the pair of two teeth
    pinion, gear : (z1,), (z2,) TOOTH
    turning : (2 + ripples,) TURNING of pinion and gear, then of each ripple
    turned : (steps, nodes, 2 + ripples, 2) cosine and sine of each turn since the cycle's start
    cotangent : of the operating pressure angle
    first : teeth at A at t = 0, from 0
    period : mesh cycles until all repeats
    duration : of a mesh cycle [s]
    lengthening : of the line of action by the loaded bearings [m]
    law : of the contact
    """

    edges: FloatArray
    nodes: FloatArray
    weights: FloatArray
    outputs: IntArray
    ahead: IntArray
    position: FloatArray
    laws: Records
    slopes: Records
    shape: Records
    shape_slope: Records
    flanks: Records
    coupling: FloatArray
    kinds: IntArray
    pinion: Records
    gear: Records
    turning: Records
    turned: FloatArray
    cotangent: float
    first: IntArray
    period: int
    duration: float
    lengthening: float
    law: ContactLaw


class CyclePairs(NamedTuple):
    """The tooth pairs of one mesh cycle, as ``fill_steps`` writes them.

    Attributes
    ----------
    pairs : (steps, nodes, pairs) PAIR
    lines : (steps, nodes) LINE
    kind, pinion, gear : (pairs,) kind of each pair and its teeth
    contacts, matrix : (pairs,) CONTACT and (pairs, pairs) of the loads
    starts : (2 + ripples, 2) amplitude of what turns, times cosine and sine of its angle at the cycle's start
    """

    pairs: Records
    lines: Records
    kind: IntArray
    pinion: IntArray
    gear: IntArray
    contacts: Records
    matrix: FloatArray
    starts: FloatArray


def cycle_pairs(tables: MeshTables) -> CyclePairs:
    """Empty records for the pairs of a mesh cycle; not compiled, for that takes half a second."""
    steps, nodes, count = tables.position.shape
    pairs = np.zeros((steps, nodes, count), PAIR)
    lines = np.zeros((steps, nodes), LINE)
    kind, pinion, gear = np.zeros((3, count), np.int64)
    contacts = np.zeros(count, CONTACT)
    matrix = np.zeros((count, count))
    return CyclePairs(pairs, lines, kind, pinion, gear, contacts, matrix, np.zeros((tables.turning.size, 2)))


@inlined
def begin_cycle(cycle: int, tables: MeshTables, into: CyclePairs) -> None:
    """Write which teeth meet in a mesh cycle, and the angles of what turns at its start."""
    for i in range(into.kind.size):
        number = cycle - tables.ahead[i]
        into.pinion[i] = (tables.first[0] + number) % tables.pinion.size
        into.gear[i] = (tables.first[1] + number) % tables.gear.size
        into.kind[i] = tables.kinds[into.pinion[i], into.gear[i]]
    for which in range(tables.turning.size):
        shaft = tables.turning[which]
        # Whole turns are taken off first: a million cycles lose no digit.
        angle = 2.0 * math.pi / shaft.cycles * (cycle % shaft.cycles) + shaft.start
        into.starts[which, 0] = shaft.amplitude * math.cos(angle)
        into.starts[which, 1] = shaft.amplitude * math.sin(angle)


@inlined
def turn_line(
    step: int, node: int, tables: MeshTables, starts: FloatArray, line: Record
) -> tuple[float, float]:
    """Write the line of action; the gap of all pairs by eccentric gears, and the swing of the contacts [m].

    To first order in the eccentricities, docs/theory/teeth.md, "Eccentricity".
    """
    flanks = tables.flanks[0]
    line.length = flanks.length + tables.lengthening
    line.lengthening = tables.lengthening
    line.turn = 0.0
    line.gap_rate = 0.0
    line.moment_pinion = 0.0
    line.moment_gear = 0.0
    gap = shift = 0.0
    for which in range(tables.turning.size):
        shaft = tables.turning[which]
        start = starts[which]
        turned = tables.turned[step, node, which]
        if shaft.amplitude == 0.0:
            continue
        cosine = start[0] * turned[0] - start[1] * turned[1]
        sine = start[1] * turned[0] + start[0] * turned[1]
        shift += shaft.swing * sine
        if which >= RIPPLES:
            continue
        sense = 1.0 if which == PINION else -1.0
        gap += cosine
        line.gap_rate -= 2.0 * math.pi / (shaft.cycles * tables.duration) * sine
        line.length += cosine - sense * sine * tables.cotangent
        line.turn -= sense * sine / flanks.length
        if which == PINION:
            line.moment_pinion = -sine
        else:
            line.moment_gear = -sine
    return gap, shift


@inlined
def look_up(step: int, node: int, shift: float, tables: MeshTables) -> tuple[int, int, int, float]:
    """Step, node and whole pitches of the tables next to a shifted place, and the way from there [m].

    The step is that of the shifted middle of the own one: all nodes of a step see a law from the same side of
    its jumps, and a shift that vanishes changes nothing.
    """
    edges = tables.edges
    nodes = tables.nodes
    pitch = tables.law.rolling_speed * tables.duration
    length = edges[step + 1] - edges[step]
    middle = edges[step] + 0.5 * length + shift / pitch
    whole = math.floor(middle)
    middle -= whole
    at = step
    while at < edges.size - 2 and middle >= edges[at + 1]:
        at += 1
    while middle < edges[at]:
        at -= 1
    phase = edges[step] + nodes[node] * length + shift / pitch - whole
    near = 0
    way = math.inf
    for other in range(nodes.size):
        left = pitch * (phase - edges[at] - nodes[other] * (edges[at + 1] - edges[at]))
        if abs(left) < abs(way):
            near = other
            way = left
    return at, near, whole, way


@inlined
def of_tooth(shape: Record, tooth: Record) -> float:
    """Gap by the numbers of a tooth [m], or its slope over xi."""
    gap: float = shape.error * tooth.error + shape.slope * tooth.slope + shape.relief * tooth.relief
    return gap


@inlined
def fill_pair(
    pair: Record, i: int, step: int, node: int, column: int, way: float, tables: MeshTables, into: CyclePairs
) -> None:
    """Write the laws of the pair in place ``i`` from a place of the tables, ``way`` before it [m]."""
    laws = tables.laws[into.kind[i], step, node, column]
    slopes = tables.slopes[into.kind[i], step, node, column]
    shape = tables.shape[step, node, column]
    shape_slope = tables.shape_slope[step, node, column]
    pinion, gear = tables.pinion[into.pinion[i]], tables.gear[into.gear[i]]
    pair.stiffness = laws.stiffness + slopes.stiffness * way
    pair.damping = laws.damping + slopes.damping * way
    pair.friction = laws.friction + slopes.friction * way
    pair.gap_slope = slopes.gap + of_tooth(shape_slope[0], pinion) + of_tooth(shape_slope[1], gear)
    pair.gap = laws.gap + of_tooth(shape[0], pinion) + of_tooth(shape[1], gear) + pair.gap_slope * way


@inlined
def fill_steps(cycle: int, low: int, high: int, tables: MeshTables, into: CyclePairs) -> None:
    """Write the pairs of a mesh cycle at the nodes of its steps from ``low`` to before ``high``."""
    nodes = tables.position.shape[1]
    count = tables.position.shape[2]
    begin_cycle(cycle, tables, into)
    for step in range(low, high):
        for node in range(nodes):
            line = into.lines[step, node]
            gap, shift = turn_line(step, node, tables, into.starts, line)
            # The windows of prescribed contact stay at their places.
            swings = shift != 0.0 and not tables.law.windows
            at, near, whole, way = look_up(step, node, shift, tables) if swings else (step, node, 0, shift)
            for i in range(count):
                pair = into.pairs[step, node, i]
                column = i - whole
                if 0 <= column < count:
                    fill_pair(pair, i, at, near, column, way, tables, into)
                else:  # far beyond the flanks
                    fill_pair(pair, i, step, node, i, shift, tables, into)
                pair.gap += gap
                position = tables.position[step, node, i] + (shift if swings else 0.0)
                place_pair(pair, position, tables.flanks[into.kind[i]], line, tables.law)
