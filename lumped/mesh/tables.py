"""The tooth pairs of any mesh cycle, as they are without load, from tables over the steps of one mesh cycle.

Everything of a tooth pair repeats with the mesh cycle, except what the two teeth of the pair bring: three
numbers of each tooth, and the kind of the pair, which the faults of both teeth decide. The numbers of a tooth
are gaps: a tooth of a tolerance class has an error of ``lumped.schema.tooth_errors``; ``TOOTH`` has this
error as ``gap``, and ``fill_pair`` adds ``tooth_gap`` of both teeth to the gap of the pair. Like teeth have
one kind and numbers that are zero.

Eccentric gears turn the line of action. Eccentric gears and ripples of the torques also swing the common
rotation of both gears, and the contacts follow this swing.

Sources: docs/theory/teeth.md, "Tables", "Eccentricity".
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from lumped.compiler import inlined
from lumped.mesh.records import CONTACT, LINE, PAIR, ContactLaw, Record, Records, record
from lumped.mesh.tip_corners import place_pair
from lumped.typing import FloatArray, IntArray

#: Laws of a kind of tooth pair at a place of the mesh cycle, or the slopes of these laws over xi.
LAWS = record(
    stiffness="k [N/m]; 0 where the pair is too far from its path to be computed",
    damping="c of the full damper [N s/m]",
    mu="friction coefficient mu [-]",
    gap="gap without tip corners and without the numbers of single teeth [m]",
)
#: The numbers of one tooth; or, in ``MeshTables.shape``, the gap of a pair per unit of each number.
TOOTH = record(
    gap="gap all over the flank; positive where the tooth comes too late to touch [m]",
    slope="profile slope deviation, material at the tip [m]",
    relief="tip relief in addition to the relief of the design [m]",
)
#: Something that repeats with a turn of a shaft: the eccentricity of a gear, or a harmonic of a torque.
TURNING = record(
    shaft="0 pinion, 1 gear",
    amplitude="eccentricity [m], or torque [N m]",
    start="phase at t = 0 [rad]",
    cycles="mesh cycles of a turn",
    swing="way of the common rotation on the base circles per amplitude",
)
#: A step of the tables that is shorter than this share of another step has nothing to say of its places.
_SHORT_STEP = 0.25
#: Rows of TURNING: the eccentricity of both gears, then the ripples of the torques from RIPPLES on.
PINION, GEAR, RIPPLES = range(3)


class MeshTables(NamedTuple):
    """Tooth pairs of every kind at the nodes of the steps of a mesh cycle; SI.

    Attributes
    ----------
    edges : (steps + 1,) phases of the ends of the steps, from 0 to 1
    nodes, weights : (nodes,) places in a step, 0 to 1, and weights of the quadrature with them. At the ends
        of a step the tables have limits from inside the step
    outputs : (steps,) 1 where an output is at the start of the step, else 0
    ahead : (pairs,) whole pitches by which a pair is ahead of the pair that is at A at the start of the
        cycle; decreasing
    position : (steps, nodes, pairs) xi [m]
    laws, slopes : (kinds, steps, nodes, pairs) LAWS, and their slopes over xi
    shape, shape_slope : (steps, nodes, pairs, 2) TOOTH: gap per unit of the numbers of the pinion's and the
        gear's tooth, and the slope of this gap over xi
    flanks : (kinds,) FLANKS
    coupling : (steps, nodes, pairs, pairs) w_ij by which the load of pair j moves pair i [m/N]
    kinds : (z1, z2) kind of the pair of two teeth
    pinion, gear : (z1,), (z2,) TOOTH of each tooth
    turning : (2 + ripples,) TURNING
    turned : (steps, nodes, 2 + ripples, 2) cosine and sine of the angle of each TURNING since the start of
        the cycle; 0 where it has no amplitude
    cotangent : of the operating pressure angle
    first : (2,) teeth of pinion and gear that are at A at t = 0, counted from 0
    period : mesh cycles after which all repeats
    duration : of a mesh cycle [s]
    lengthening : length that the deflection of the bearings adds to the line of action [m]
    law : law of the contact
    alike : whether all mesh cycles are alike: like teeth that nothing swings
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
    alike: bool


class CyclePairs(NamedTuple):
    """The tooth pairs of one mesh cycle, as ``fill_steps`` writes them.

    Attributes
    ----------
    pairs : (steps, nodes, pairs) PAIR
    lines : (steps, nodes) LINE
    kind, pinion_tooth, gear_tooth : (pairs,) kind of each pair, and its teeth, counted from 0
    contacts, matrix : (pairs,) CONTACT and (pairs, pairs), memory of ``write_elastic_loads``
    starts : (2 + ripples, 2) amplitude of each TURNING, times cosine and sine of its angle at the start of
        the cycle
    filled : (1,) 1 where the pairs of a cycle have been written
    """

    pairs: Records
    lines: Records
    kind: IntArray
    pinion_tooth: IntArray
    gear_tooth: IntArray
    contacts: Records
    matrix: FloatArray
    starts: FloatArray
    filled: IntArray


class TableNode(NamedTuple):
    """The node of the tables next to a place that swings.

    Attributes
    ----------
    step, node : indices of the tables
    pitches : whole pitches between both places: the table's column is the pair's less this number
    distance : from the node to the place, over xi [m]
    """

    step: int
    node: int
    pitches: int
    distance: float


def cycle_pairs(tables: MeshTables) -> CyclePairs:
    """Return the memory for one mesh cycle. Not compiled, because compiling takes half a second."""
    steps, nodes, count = tables.position.shape
    return CyclePairs(
        pairs=np.zeros((steps, nodes, count), PAIR),
        lines=np.zeros((steps, nodes), LINE),
        kind=np.zeros(count, np.int64),
        pinion_tooth=np.zeros(count, np.int64),
        gear_tooth=np.zeros(count, np.int64),
        contacts=np.zeros(count, CONTACT),
        matrix=np.zeros((count, count)),
        starts=np.zeros((tables.turning.size, 2)),
        filled=np.zeros(1, np.int64),
    )


@inlined
def begin_cycle(cycle: int, tables: MeshTables, mesh: CyclePairs) -> None:
    """Write the teeth that meet in a mesh cycle, and the angles of all TURNING at the start of the cycle."""
    for i in range(mesh.kind.size):
        number = cycle - tables.ahead[i]
        mesh.pinion_tooth[i] = (tables.first[0] + number) % tables.pinion.size
        mesh.gear_tooth[i] = (tables.first[1] + number) % tables.gear.size
        mesh.kind[i] = tables.kinds[mesh.pinion_tooth[i], mesh.gear_tooth[i]]
    for row in range(tables.turning.size):
        turning = tables.turning[row]
        # Whole turns are taken off first: a million cycles lose no digit.
        angle = 2.0 * math.pi / turning.cycles * (cycle % turning.cycles) + turning.start
        mesh.starts[row, 0] = turning.amplitude * math.cos(angle)
        mesh.starts[row, 1] = turning.amplitude * math.sin(angle)


@inlined
def add_eccentricity(gear: int, cosine: float, sine: float, tables: MeshTables, line: Record) -> None:
    """Add what the eccentricity of PINION or GEAR does to the line of action.

    ``cosine`` and ``sine`` are the eccentricity [m] times cosine and sine of the angle of the gear.
    """
    sense = 1.0 if gear == PINION else -1.0
    length = tables.flanks[0].length
    line.gap_rate -= 2.0 * math.pi / (tables.turning[gear].cycles * tables.duration) * sine
    line.length += cosine - sense * sine * tables.cotangent
    line.turn -= sense * sine / length
    if gear == PINION:
        line.moment_pinion = -sine
    else:
        line.moment_gear = -sine


@inlined
def turn_line(
    step: int, node: int, tables: MeshTables, starts: FloatArray, line: Record
) -> tuple[float, float]:
    """Write the line of action; return the gap by eccentric gears and the swing of the contacts [m].

    To first order in the eccentricities, docs/theory/teeth.md, "Eccentricity".
    """
    line.length = tables.flanks[0].length + tables.lengthening
    line.lengthening = tables.lengthening
    line.turn = 0.0
    line.gap_rate = 0.0
    line.moment_pinion = 0.0
    line.moment_gear = 0.0
    gap = 0.0
    swing = 0.0
    for row in range(tables.turning.size):
        turning = tables.turning[row]
        start = starts[row]
        turned = tables.turned[step, node, row]
        if turning.amplitude == 0.0:
            continue
        cosine = start[0] * turned[0] - start[1] * turned[1]
        sine = start[1] * turned[0] + start[0] * turned[1]
        swing += turning.swing * sine
        if row < RIPPLES:
            gap += cosine
            add_eccentricity(row, cosine, sine, tables, line)
    return gap, swing


@inlined
def step_at(edges: FloatArray, phase: float, near: int) -> int:
    """Return the step of a phase, searched from the step ``near`` on; the first or last step beyond them."""
    step = near
    while step < edges.size - 2 and phase >= edges[step + 1]:
        step += 1
    while step > 0 and phase < edges[step]:
        step -= 1
    return step


@inlined
def nearest_node(step: int, node: int, swing: float, tables: MeshTables) -> TableNode:
    """Return the node of the tables next to a node that swings by a way over xi [m].

    The step is the one to which the middle of the own step swings: all nodes of a step see a law from the
    same side of its jumps, and a swing that vanishes changes nothing. If that step is much shorter than the
    own step, its slopes say nothing of the places of the other nodes (law II has steps of a millionth of the
    mesh cycle beside the pitch point, with slopes of 1/x): then each node goes to the step at its own phase.
    """
    edges = tables.edges
    nodes = tables.nodes
    pitch = tables.law.rolling_speed * tables.duration
    length = edges[step + 1] - edges[step]
    middle = edges[step] + 0.5 * length + swing / pitch
    pitches = math.floor(middle)
    table_step = step_at(edges, middle - pitches, step)
    phase = edges[step] + nodes[node] * length + swing / pitch - pitches
    if edges[table_step + 1] - edges[table_step] < _SHORT_STEP * length:
        table_step = step_at(edges, phase, table_step)
    nearest = 0
    least = math.inf
    for other in range(nodes.size):
        distance = pitch * (
            phase - edges[table_step] - nodes[other] * (edges[table_step + 1] - edges[table_step])
        )
        if abs(distance) < abs(least):
            nearest = other
            least = distance
    return TableNode(table_step, nearest, pitches, least)


@inlined
def tooth_gap(shape: Record, tooth: Record) -> float:
    """Gap of a pair by the three numbers of one of its teeth [m], or the slope of this gap over xi.

    ``shape`` is the gap, or the slope, per unit of each number.
    """
    gap: float = shape.gap * tooth.gap + shape.slope * tooth.slope + shape.relief * tooth.relief
    return gap


@inlined
def fill_pair(
    pair: Record, i: int, place: TableNode, column: int, tables: MeshTables, mesh: CyclePairs
) -> None:
    """Write the laws of the pair ``i`` from a column of the tables, to first order in the distance."""
    laws = tables.laws[mesh.kind[i], place.step, place.node, column]
    slopes = tables.slopes[mesh.kind[i], place.step, place.node, column]
    shape = tables.shape[place.step, place.node, column]
    shape_slope = tables.shape_slope[place.step, place.node, column]
    pinion = tables.pinion[mesh.pinion_tooth[i]]
    gear = tables.gear[mesh.gear_tooth[i]]
    pair.stiffness = laws.stiffness + slopes.stiffness * place.distance
    pair.damping = laws.damping + slopes.damping * place.distance
    pair.mu = laws.mu + slopes.mu * place.distance
    pair.gap_slope = slopes.gap + tooth_gap(shape_slope[0], pinion) + tooth_gap(shape_slope[1], gear)
    gap = laws.gap + tooth_gap(shape[0], pinion) + tooth_gap(shape[1], gear)
    pair.gap = gap + pair.gap_slope * place.distance


@inlined
def fill_steps(cycle: int, low: int, high: int, tables: MeshTables, mesh: CyclePairs) -> None:
    """Write the pairs of a mesh cycle at all nodes of the steps from ``low`` to before ``high``."""
    nodes = tables.position.shape[1]
    count = tables.position.shape[2]
    begin_cycle(cycle, tables, mesh)
    for step in range(low, high):
        for node in range(nodes):
            line = mesh.lines[step, node]
            gap, swing = turn_line(step, node, tables, mesh.starts, line)
            # The windows of prescribed contact do not swing.
            swings = swing != 0.0 and not tables.law.prescribed
            place = TableNode(step, node, 0, swing)
            if swings:
                place = nearest_node(step, node, swing, tables)
            for i in range(count):
                pair = mesh.pairs[step, node, i]
                column = i - place.pitches
                if 0 <= column < count:
                    fill_pair(pair, i, place, column, tables, mesh)
                else:  # far beyond the flanks
                    fill_pair(pair, i, TableNode(step, node, 0, swing), i, tables, mesh)
                pair.gap += gap
                position = tables.position[step, node, i] + (swing if swings else 0.0)
                place_pair(pair, position, tables.flanks[mesh.kind[i]], line, tables.law)
