"""Harmonics of the torques over the mesh cycles: which shaft, how fast, and where each starts.

Sources: docs/theory/teeth.md, "Numbering and sign".
"""

from __future__ import annotations

import math
from typing import NamedTuple

from lumped.schema.meeting_teeth import first_teeth
from lumped.schema.pair import GearPair


class Ripple(NamedTuple):
    """One harmonic of a torque, amplitude cos(angle n + start) after n mesh cycles.

    Attributes
    ----------
    shaft : 0 pinion, 1 gear
    angle : by which the harmonic advances in a mesh cycle [rad]
    start : phase at t = 0 [rad]
    amplitude : of the torque [N m]
    cycles : mesh cycles of a turn of the shaft
    """

    shaft: int
    angle: float
    start: float
    amplitude: float
    cycles: int


def ripples(pair: GearPair) -> list[Ripple]:
    """The harmonics of ``operating.torque_ripple``, in the order of the file."""
    result = []
    for harmonic in pair.operating.torque_ripple:
        shaft = ("pinion", "gear").index(harmonic.shaft)
        teeth = (pair.pinion.teeth, pair.gear.teeth)[shaft]
        angle = 2.0 * math.pi * harmonic.order / teeth
        start = harmonic.phase + angle * first_teeth(pair)[shaft]
        result.append(Ripple(shaft, angle, start, harmonic.amplitude, teeth))
    return result
