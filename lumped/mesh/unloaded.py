"""Tooth pairs without load at any phase of the mesh: stiffness, gap by reliefs, and coupling of neighbours.

Sources: docs/theory/mesh_physics.md, "Load sharing and static transmission error";
docs/theory/contact_energy.md, "Neighbours".
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from lumped.compiler import compiled, inlined
from lumped.mesh.records import Record, Records, record
from lumped.mesh.statics import Phases
from lumped.path_values import piece_at, value_on
from lumped.typing import BoolArray, FloatArray, IntArray

#: A relief of one flank, over xi.
RELIEF = record(
    amount="material removed at the end [m]",
    start="roll angle at which the relief starts [rad]",
    end="roll angle at which the relief has its amount [rad]",
    parabolic="1 for a parabola over the roll angle, 0 for a line",
    radius="base radius of the gear [m]",
    origin="xi of the tangent point of the gear [m]",
    sense="1 where the roll angle grows with xi, -1 where it falls",
)


class NeighbourLaws(NamedTuple):
    """w_m(xi), m = 1, 2, ...: how far the load of a pair moves the pair m pitches ahead [m/N].

    Attributes
    ----------
    first : (m + 1,) index of the first break of each function; last the number of all breaks
    breaks : breaks of all functions, one function behind the other [m]
    coefficients : (order, breaks) as of ``PathFunction``; the column of the last break of a function has no
        meaning
    """

    first: IntArray
    breaks: FloatArray
    coefficients: FloatArray


class PairLaws(NamedTuple):
    """Laws of a tooth pair without load, over xi.

    Attributes
    ----------
    start, end : A and D. Beyond them stiffness and reliefs have their values at A and D [m]
    low, high : between them pairs are computed; elsewhere a pair has no stiffness and moves no pair [m]
    breaks, coefficients : k(xi) as of ``PathFunction`` [N/m]
    least_stiffness : lower bound of k [N/m]
    reliefs : RELIEF (n,) of both flanks
    neighbours : coupling of pairs
    lengthening : as of ``Phases`` [m]
    """

    start: float
    end: float
    low: float
    high: float
    breaks: FloatArray
    coefficients: FloatArray
    least_stiffness: float
    reliefs: Records
    neighbours: NeighbourLaws
    lengthening: float


@inlined
def relief_at(relief: Record, xi: float) -> float:
    """Material removed at a position: C s (linear) or C s^2 (parabolic) [m].

    s = (roll angle - start)/(end - start) where positive.
    """
    roll = relief.sense * (xi - relief.origin) / relief.radius
    s = max((roll - relief.start) / (relief.end - relief.start), 0.0)
    removed: float = relief.amount * (s * s if relief.parabolic > 0.0 else s)
    return removed


@compiled
def reliefs_at(reliefs: Records, xi: FloatArray) -> FloatArray:
    """Sum of some reliefs, RELIEF (m,), at positions (n,) [m]."""
    total = np.zeros(xi.size)
    for i in range(xi.size):
        for j in range(reliefs.size):
            total[i] += relief_at(reliefs[j], xi[i])
    return total


@compiled
def relief_slopes(
    reliefs: Records, start: float, end: float, position: FloatArray, offsets: FloatArray, weights: FloatArray
) -> FloatArray:
    """Slope over xi of the sum of some reliefs (m,) at positions (steps, nodes, pairs), by differences [-].

    Parameters
    ----------
    start, end : A and D, beyond which reliefs have their values at A and D [m]
    offsets, weights : (3, nodes) distances from a node to the places of a difference [m], and the weights of
        the values there [1/m]
    """
    slopes = np.zeros(position.shape)
    for step in range(position.shape[0]):
        for node in range(position.shape[1]):
            for pair in range(position.shape[2]):
                place = position[step, node, pair]
                if not start < place < end:
                    continue  # no relief changes there
                for k in range(offsets.shape[0]):
                    on_flanks = min(max(place + offsets[k, node], start), end)
                    total = 0.0
                    for j in range(reliefs.size):
                        total += relief_at(reliefs[j], on_flanks)
                    slopes[step, node, pair] += weights[k, node] * total
    return slopes


@inlined
def write_coupling(
    neighbours: NeighbourLaws, position: FloatArray, near: BoolArray, coupling: FloatArray
) -> None:
    """Write w_ij (pairs, pairs) of pairs that are whole pitches apart, the pair behind first.

    ``near`` (pairs,) says which pairs are computed. The functions are those of the pair behind.
    """
    for m in range(neighbours.first.size - 1):
        breaks = neighbours.breaks[neighbours.first[m] : neighbours.first[m + 1]]
        coefficients = neighbours.coefficients[:, neighbours.first[m] : neighbours.first[m + 1]]
        apart = m + 1
        piece = 0
        for i in range(position.size - apart):
            xi = position[i]
            if near[i] and near[i + apart] and breaks[0] <= xi <= breaks[breaks.size - 1]:
                piece = piece_at(breaks, xi, piece)
                compliance = value_on(breaks, coefficients, piece, xi)
                coupling[i, i + apart] = compliance
                coupling[i + apart, i] = compliance


@compiled
def couplings(neighbours: NeighbourLaws, position: FloatArray, near: BoolArray) -> FloatArray:
    """Coupling (n, pairs, pairs) of pairs at positions (n, pairs), see ``write_coupling`` [m/N]."""
    n, pairs = position.shape
    coupling = np.zeros((n, pairs, pairs))
    for phase in range(n):
        write_coupling(neighbours, position[phase], near[phase], coupling[phase])
    return coupling


@compiled(nogil=True)
def unloaded_phases(xi: FloatArray, shifts: FloatArray, laws: PairLaws) -> Phases:
    """Return the pairs at xi (n,) + shifts (pairs,) without load; shifts are whole pitches that increase."""
    pairs = shifts.size
    position = np.empty((xi.size, pairs))
    stiffness = np.zeros((xi.size, pairs))
    gap = np.zeros((xi.size, pairs))
    coupled = laws.neighbours.first.size > 1
    coupling = np.zeros((xi.size if coupled else 1, pairs, pairs))
    near = np.empty(pairs, dtype=np.bool_)
    first = laws.breaks[0]
    last = np.nextafter(laws.breaks[laws.breaks.size - 1], first)
    piece = 0
    for phase in range(xi.size):
        for i in range(pairs):
            place = xi[phase] + shifts[i]
            position[phase, i] = place
            near[i] = laws.low < place < laws.high
            if near[i]:
                on_path = min(max(place, first), last)
                piece = piece_at(laws.breaks, on_path, piece)
                value = value_on(laws.breaks, laws.coefficients, piece, on_path)
                stiffness[phase, i] = max(value, laws.least_stiffness)
            on_flanks = min(max(place, laws.start), laws.end)
            for j in range(laws.reliefs.size):
                gap[phase, i] += relief_at(laws.reliefs[j], on_flanks)
        if coupled:
            write_coupling(laws.neighbours, position[phase], near, coupling[phase])
    return Phases(position, stiffness, gap, coupling, laws.lengthening)
