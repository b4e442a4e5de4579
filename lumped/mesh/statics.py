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
    LINE,
    PAIR,
    ContactLaw,
    Record,
    Records,
    damper_share,
    flank_end,
    inlined,
    open_gap,
    place_pair,
    share_load,
    static_approach,
    tip_decides,
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
    coupling : (n, pairs, pairs), or (1, pairs, pairs) where pairs stand alone, w_ij by which the load of a
        pair moves another [m/N]
    lengthening : of the line of action by the loaded bearings [m]
    """

    position: FloatArray
    stiffness: FloatArray
    gap: FloatArray
    coupling: FloatArray
    lengthening: float


class Workspace(NamedTuple):
    """Records to work in: (pairs,) PAIR, (pairs,) CONTACT, (1,) LINE, and a matrix (pairs, pairs)."""

    pairs: Records
    contacts: Records
    line: Records
    matrix: FloatArray


def workspace(phases: Phases) -> Workspace:
    """For as many pairs; not compiled, for that takes half a second."""
    count = phases.position.shape[1]
    matrix = np.zeros((count, count))
    return Workspace(np.zeros(count, PAIR), np.zeros(count, CONTACT), np.zeros(1, LINE), matrix)


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


@inlined
def least_gap(pairs: Records) -> float:
    """Least gap of the pairs that can carry a load [m], or NaN."""
    least = math.nan
    for i in range(pairs.size):
        if pairs[i].stiffness > 0.0 and not pairs[i].gap >= least:
            least = pairs[i].gap
    return least


@compiled
def static_approaches(
    phases: Phases,
    force: FloatArray,
    flanks: Records,
    law: ContactLaw,
    loads: FloatArray,
    space: Workspace,
) -> FloatArray:
    """Static approach (n,) [m] at the phases under forces (n,) [N]; NaN where no pair can carry one.

    ``loads`` (n or 0, pairs) receive those of the pairs. Without a force the approach is the least gap.
    """
    n, count = phases.position.shape
    pairs, contacts, lines, matrix = space
    found = np.empty(n)
    guess = 0.0
    for phase in range(n):
        put_pairs(phases, phase, flanks[0], law, pairs, lines[0])
        coupling = phases.coupling[phase if law.coupled else 0]
        if force[phase] > 0.0:
            found[phase] = static_approach(
                guess, _EXACT, force[phase], pairs, lines[0], law, coupling, matrix, contacts
            )
        else:
            found[phase] = least_gap(pairs)
        guess = 0.0 if math.isnan(found[phase]) else found[phase]
        for i in range(count if phase < loads.shape[0] else 0):
            loads[phase, i] = contacts[i].load if force[phase] > 0.0 else 0.0
    return found


@compiled
def middle_contacts(
    approach: FloatArray,
    phases: Phases,
    flanks: Records,
    law: ContactLaw,
    found: Records,
    space: Workspace,
) -> None:
    """Write the contact of the middle pair at an approach of each phase (n,) [m] into ``found`` (n,).

    Its compression is that by its own load, without what the loads of its neighbours move it.
    """
    n, count = phases.position.shape
    pairs, contacts, lines, matrix = space
    middle = count // 2
    for phase in range(n):
        line = lines[0]
        coupling = phases.coupling[phase if law.coupled else 0]
        put_pairs(phases, phase, flanks[0], law, pairs, line)
        share_load(approach[phase], pairs, line, law, coupling, matrix, contacts)
        one = found[phase]
        open_gap(pairs[middle], approach[phase], line, law, one)
        one.load = contacts[middle].load
        one.tangent = contacts[middle].tangent
        one.damper_share = damper_share(one.load, law)
        for j in range(count):
            one.compression -= coupling[middle, j] * contacts[j].load


@compiled
def end_gaps(
    beyond: FloatArray,
    tip: float,
    back: FloatArray,
    edge: float,
    length: float,
    flank_radius: float,
    tip_radius: float,
) -> FloatArray:
    """Gaps (n,) where flanks end in a tip corner and an edge, see ``flank_end``; ways (n,) [m]."""
    found = np.empty(beyond.size)
    for i in range(beyond.size):
        found[i] = flank_end(beyond[i], tip, back[i], edge, length, flank_radius, tip_radius).gap
    return found


@compiled
def deciding_ways(
    beyond: FloatArray,
    tip: float,
    back: FloatArray,
    edge: float,
    length: float,
    flank_radius: float,
    tip_radius: float,
) -> FloatArray:
    """Where the tip corner decides the gap of ``end_gaps``, (n,) positive [m], see ``tip_decides``."""
    found = np.empty(beyond.size)
    for i in range(beyond.size):
        found[i] = tip_decides(beyond[i], tip, back[i], edge, length, flank_radius, tip_radius)
    return found
