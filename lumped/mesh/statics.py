"""Statics of the mesh: the approach under the mean force, and the loads of pairs at an approach.

Sources: docs/theory/contact_energy.md, "Loaded contact of the linear model"; docs/theory/mesh_physics.md,
"Load sharing and static transmission error".
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from lumped.compiler import compiled, inlined
from lumped.mesh.damper import damper_share
from lumped.mesh.element import static_approach, write_elastic_loads, write_gap
from lumped.mesh.records import CONTACT, LINE, PAIR, ContactLaw, Record, Records
from lumped.mesh.tip_corners import FlankEnd, flank_end_gap, place_pair, tip_minus_edge
from lumped.typing import FloatArray

#: Relative error of an approach from which laws are fitted: that of rounding.
_EXACT = 2e-15


class Phases(NamedTuple):
    """Tooth pairs at n phases of the mesh, without load.

    Attributes
    ----------
    position : (n, pairs) xi [m]
    stiffness : (n, pairs) k at the mean load [N/m]; 0 where a pair is too far from its path to be computed
    gap : (n, pairs) gap without tip corners [m]
    coupling : w_ij by which the load of pair j moves pair i [m/N]; (n, pairs, pairs), or (1, pairs, pairs)
        where no pair moves another
    lengthening : length that the deflection of the bearings adds to the line of action [m]
    """

    position: FloatArray
    stiffness: FloatArray
    gap: FloatArray
    coupling: FloatArray
    lengthening: float


class Workspace(NamedTuple):
    """Memory of the kernels: (pairs,) PAIR, (pairs,) CONTACT, (1,) LINE and a matrix (pairs, pairs)."""

    pairs: Records
    contacts: Records
    line: Records
    matrix: FloatArray


def workspace(phases: Phases) -> Workspace:
    """Return the memory for some phases. Not compiled, because compiling takes half a second."""
    count = phases.position.shape[1]
    matrix = np.zeros((count, count))
    return Workspace(np.zeros(count, PAIR), np.zeros(count, CONTACT), np.zeros(1, LINE), matrix)


@inlined
def write_pairs(
    phases: Phases, phase: int, flanks: Record, law: ContactLaw, pairs: Records, line: Record
) -> None:
    """Write the pairs and the line of action of one phase."""
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


@compiled(nogil=True)
def static_approaches(
    phases: Phases,
    force: FloatArray,
    flanks: Records,
    law: ContactLaw,
    loads: FloatArray,
    space: Workspace,
) -> FloatArray:
    """Static approach (n,) [m] at n phases under forces (n,) [N]; NaN where no pair can carry the force.

    Without a force the approach is the least gap. ``loads``, (n, pairs) or (0, pairs), is written: the load
    of each pair.
    """
    n, count = phases.position.shape
    pairs, contacts, lines, matrix = space
    approaches = np.empty(n)
    guess = 0.0
    for phase in range(n):
        write_pairs(phases, phase, flanks[0], law, pairs, lines[0])
        coupling = phases.coupling[phase if law.coupled else 0]
        if force[phase] > 0.0:
            approaches[phase] = static_approach(
                guess, _EXACT, force[phase], pairs, lines[0], law, coupling, matrix, contacts
            )
        else:
            approaches[phase] = least_gap(pairs)
        guess = 0.0 if math.isnan(approaches[phase]) else approaches[phase]
        for i in range(count if phase < loads.shape[0] else 0):
            loads[phase, i] = contacts[i].load if force[phase] > 0.0 else 0.0
    return approaches


@compiled(nogil=True)
def middle_contacts(
    approach: FloatArray,
    phases: Phases,
    flanks: Records,
    law: ContactLaw,
    middle_contact: Records,
    space: Workspace,
) -> None:
    """Write the contact of the middle pair into ``middle_contact`` (n,), at an approach of each phase (n,)
    [m].

    The compression is the part that the load of this pair causes: what the loads of the neighbours move the
    pair is subtracted.
    """
    n, count = phases.position.shape
    pairs, contacts, lines, matrix = space
    middle = count // 2
    for phase in range(n):
        line = lines[0]
        coupling = phases.coupling[phase if law.coupled else 0]
        write_pairs(phases, phase, flanks[0], law, pairs, line)
        write_elastic_loads(approach[phase], pairs, line, law, coupling, matrix, contacts)
        contact = middle_contact[phase]
        write_gap(pairs[middle], approach[phase], line, law, contact)
        contact.load = contacts[middle].load
        contact.tangent = contacts[middle].tangent
        contact.damper_share = damper_share(contact.load, law)
        for j in range(count):
            contact.compression -= coupling[middle, j] * contacts[j].load


@compiled
def flank_end_gaps(
    beyond_tip: FloatArray,
    tip: float,
    beyond_edge: FloatArray,
    edge: float,
    line: float,
    flank_radius: float,
    tip_radius: float,
) -> FloatArray:
    """Gaps (n,) [m] at one end of the flanks, of contacts (n,) beyond this end; see ``FlankEnd``."""
    gaps = np.empty(beyond_tip.size)
    for i in range(beyond_tip.size):
        end = FlankEnd(beyond_tip[i], tip, beyond_edge[i], edge, line, flank_radius, tip_radius)
        gaps[i] = flank_end_gap(end).gap
    return gaps


@compiled
def tips_minus_edges(
    beyond_tip: FloatArray,
    tip: float,
    beyond_edge: FloatArray,
    edge: float,
    line: float,
    flank_radius: float,
    tip_radius: float,
) -> FloatArray:
    """Differences (n,) [m] between the roots of the gaps of tip and edge; see ``tip_minus_edge``."""
    differences = np.empty(beyond_tip.size)
    for i in range(beyond_tip.size):
        end = FlankEnd(beyond_tip[i], tip, beyond_edge[i], edge, line, flank_radius, tip_radius)
        differences[i] = tip_minus_edge(end)
    return differences
