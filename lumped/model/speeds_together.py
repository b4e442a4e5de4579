"""Systems of one pair at several speeds, whose mesh forces are computed in one pass.

The speed scales time alone: the tooth pairs pass the same positions, and of the laws only the friction
coefficient depends on the speed. So the laws are evaluated once, on the clock of the first system, and each
system adds its own friction and its own rate of the tooth error.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import fields, replace
from typing import NamedTuple

import numpy as np

from lumped.mesh.records import Records
from lumped.model.mesh_cycle import MeshCycle, PairState, friction_coefficients
from lumped.model.periodic_system import LTVSystem
from lumped.path_function import PathFunction
from lumped.typing import FloatArray, IntArray


def goes_with(first: LTVSystem, other: LTVSystem) -> bool:
    """Whether a system differs from the first one in speed and in the size of the friction alone.

    Positions at which a law is not smooth are then the same. Shafts have gyroscopic moments, which depend on
    the speed.
    """
    cycles = first.cycle, other.cycle
    if other.constant is not first.constant or any(type(cycle) is not MeshCycle for cycle in cycles):
        return False
    elements, others = (cycle.elements for cycle in cycles)
    laws = (one.name for one in fields(elements) if one.name != "friction")
    if any(getattr(others, law) is not getattr(elements, law) for law in laws):
        return False
    return _same_breaks(elements.friction, others.friction)


def _same_breaks(law: PathFunction, other: PathFunction) -> bool:
    """Whether two laws are smooth on the same pieces."""
    if law.breaks is other.breaks:  # one fit with another factor
        return True
    return all(
        np.array_equal(getattr(law, name), getattr(other, name)) for name in ("breaks", "switches", "bends")
    )


class MeshTimes(NamedTuple):
    """Times in the mesh cycles of systems that go together.

    Attributes
    ----------
    time : (k,) each on the clock of its system [s]
    segment : (k,) smooth segment in which each time lies
    owner : (k,) index of the system of each time, increasing
    """

    time: FloatArray
    segment: IntArray
    owner: IntArray


def forces_together(systems: Sequence[LTVSystem], at: MeshTimes) -> tuple[Records, PairState]:
    """FORCE (k, 3) of the linear form, and its pairs, of systems for which ``goes_with`` the first holds."""
    first = systems[0]
    if len(systems) == 1:
        return first.mesh_forces(at.time, at.segment)
    clock = np.array([first.period / system.period for system in systems])[at.owner]
    time = clock * at.time  # of the first system
    pairs = first.cycle.sample(time, at.segment)
    _, place, contact = first.cycle.places(time, at.segment)
    friction = np.empty_like(pairs.friction)
    ends = np.searchsorted(at.owner, np.arange(len(systems) + 1)).tolist()
    for system, (low, high) in zip(systems, itertools.pairwise(ends), strict=True):
        elements = system.cycle.elements
        friction[:, low:high] = friction_coefficients(elements, place[:, low:high], contact[:, low:high])
    pairs = replace(pairs, friction=friction, error_rate=pairs.error_rate * clock)
    return pairs.forces, pairs
