"""Statics of the mesh: the approach under the mean force, and the loads of pairs at an approach.

Sources: docs/theory/contact_energy.md, "Loaded contact of the linear model"; docs/theory/mesh_physics.md,
"Load sharing and static transmission error".
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from lumped.compiler import compiled
from lumped.mesh.element import (
    CONTACT,
    FLANKS,
    LINE,
    PAIR,
    QUICK,
    ContactLaw,
    Record,
    Records,
    corner_gap,
    inlined,
    open_gap,
    place_pair,
    share_load,
    static_approach,
)
from lumped.typing import FloatArray

#: Relative error of an approach from which laws are fitted: that of rounding.
_EXACT = 2e-15


class Phases(NamedTuple):
    """Tooth pairs at n phases of the mesh, without load.

    Attributes
    ----------
    position : (n, pairs) xi [m]
    stiffness : (n, pairs) k at the mean load [N/m]; 0 where a pair is not followed
    gap : (n, pairs) without tip corners [m]
    coupling : (n, pairs, pairs) w_ij by which the load of a pair moves another [m/N]
    lengthening : of the line of action by the loaded bearings [m]
    """

    position: FloatArray
    stiffness: FloatArray
    gap: FloatArray
    coupling: FloatArray
    lengthening: float


@inlined
def put_pairs(
    phases: Phases, phase: int, flanks: Record, law: ContactLaw, pairs: Records, line: Record
) -> None:
    """Write the pairs and the line of action of a phase."""
    line.length = flanks.length + phases.lengthening
    line.lengthening = phases.lengthening
    for i in range(pairs.size):
        place_pair(pairs[i], phases.position[phase, i], flanks, line, law)
        pairs[i].stiffness = phases.stiffness[phase, i]
        pairs[i].gap = phases.gap[phase, i]


@compiled
def static_approaches(phases: Phases, flanks: Records, law: ContactLaw) -> FloatArray:
    """Static approach (n,) [m] at the phases; NaN where no pair can carry the mean force."""
    n, count = phases.position.shape
    pairs, contacts, lines = np.zeros(count, PAIR), np.zeros(count, CONTACT), np.zeros(1, LINE)
    matrix, found, guess = np.empty((count, count)), np.empty(n), 0.0
    for phase in range(n):
        put_pairs(phases, phase, flanks[0], law, pairs, lines[0])
        coupling = phases.coupling[phase]
        found[phase] = static_approach(guess, _EXACT, pairs, lines[0], law, coupling, matrix, contacts)
        guess = 0.0 if math.isnan(found[phase]) else found[phase]
    return found


@compiled
def middle_contacts(
    approach: FloatArray, phases: Phases, flanks: Records, law: ContactLaw, found: Records
) -> None:
    """Write the contact of the middle pair at an approach of each phase (n,) [m] into ``found`` (n,).

    Its compression is that by its own load, without what the loads of its neighbours move it.
    """
    n, count = phases.position.shape
    pairs, contacts, lines = np.zeros(count, PAIR), np.zeros(count, CONTACT), np.zeros(1, LINE)
    matrix, middle = np.empty((count, count)), count // 2
    for phase in range(n):
        line, coupling = lines[0], phases.coupling[phase]
        put_pairs(phases, phase, flanks[0], law, pairs, line)
        share_load(approach[phase], pairs, line, law, coupling, matrix, contacts)
        one = found[phase]
        open_gap(pairs[middle], approach[phase], line, law, one)
        one.load = contacts[middle].load
        one.tangent = contacts[middle].tangent
        for j in range(count):
            one.compression -= coupling[middle, j] * contacts[j].load


@compiled
def shared_loads(
    stiffness: FloatArray, gap: FloatArray, force: FloatArray, coupling: FloatArray, coupled: bool
) -> tuple[FloatArray, FloatArray]:
    """Approach (n,) [m] and loads (n, pairs) [N] of linear pairs with gaps (n, pairs) under forces (n,)."""
    n, count = stiffness.shape
    pairs, contacts, lines = np.zeros(count, PAIR), np.zeros(count, CONTACT), np.zeros(1, LINE)
    matrix, approach, loads = np.empty((count, count)), np.empty(n), np.zeros((n, count))
    flanks = np.zeros(1, FLANKS)
    flanks[0].start, flanks[0].end = -math.inf, math.inf
    for case in range(n):
        law = ContactLaw(force[case], 0.0, 0.0, QUICK, 0.0, coupled, -math.inf, False, 0.0, 0.0, 0.0)
        least = math.inf
        for i in range(count):
            place_pair(pairs[i], 0.0, flanks[0], lines[0], law)
            pairs[i].stiffness, pairs[i].gap = stiffness[case, i], gap[case, i]
            if stiffness[case, i] > 0.0:
                least = min(least, gap[case, i])
        if force[case] <= 0.0 or least == math.inf:
            approach[case] = least if force[case] <= 0.0 and least < math.inf else math.nan
            continue
        moves = coupling[case if coupled else 0]
        approach[case] = static_approach(least, _EXACT, pairs, lines[0], law, moves, matrix, contacts)
        for i in range(count):
            loads[case, i] = contacts[i].load
    return approach, loads


@compiled
def corner_gaps(
    beyond: FloatArray, tip: float, length: float, flank_radius: float, tip_radius: float
) -> FloatArray:
    """Gaps of a tip corner (n,), see ``corner_gap``; 0 where it is not ``beyond`` (n,) its first contact."""
    found = np.zeros(beyond.size)
    for i in range(beyond.size):
        if beyond[i] > 0.0:
            found[i] = corner_gap(beyond[i], tip, length, flank_radius, tip_radius).gap
    return found
