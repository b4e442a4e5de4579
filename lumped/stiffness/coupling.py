"""Structural coupling of the tooth pairs in contact through the twist of both gear bodies.

All pairs load the same two rings. With c_i the compliance of a pair without the twist, the twist w of both
rings stands in every place of the compliance matrix: delta = c_i N_i + w sum_j N_j. Without unloaded errors

    N_i = k_i delta,   k_i = (1/c_i)/(1 + w sum_j 1/c_j),

which is one spring 1/w in series with all pairs: in double contact each pair is softer than alone. What a
tooth's load does to the fillet of its neighbour otherwise (local coupling) is left out.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from lumped.gear_geometry.geometry import Geometry
from lumped.path_function import PathFunction
from lumped.stiffness.base import MeshingPair
from lumped.stiffness.foundation import ring_twist
from lumped.typing import FloatArray

_FIT_TOLERANCE = 1e-10
#: Positions closer than this fraction of a base pitch are one.
_SAME = 1e-9


def twist_compliance(pair: MeshingPair) -> float:
    """Compliance of both rings in twist along the line of action [m/N]; a gear without a bore has none."""
    total = 0.0
    for wheel, body in zip(pair.wheels, (pair.pinion, pair.gear), strict=True):
        radii = (wheel.tooth.base_radius, wheel.tooth.root_radius, 0.5 * wheel.bore)
        if wheel.bore > 0.0:
            total += ring_twist(*radii, body.youngs_modulus, body.poisson_ratio)
    return total / pair.geometry.face_width


def coupled(k: PathFunction, twist: float, geometry: Geometry) -> PathFunction:
    """Stiffness of a pair in the presence of its neighbours [N/m].

    Parameters
    ----------
    k : stiffness of a pair alone, its twist included, from A to D [N/m]
    twist : w, compliance of both rings in twist, smaller than 1/k [m/N]
    geometry : of the pair

    Returns
    -------
    PathFunction : with jumps where a neighbour enters or leaves contact
    """
    if twist == 0.0:
        return k
    low, high = k.interval
    pitch = geometry.base_pitch
    shifts = np.arange(1 - geometry.pairs, geometry.pairs) * pitch

    def local(xi: FloatArray) -> FloatArray:
        inside = (xi > low) & (xi < high)
        alone = np.where(inside, k(np.clip(xi, low, np.nextafter(high, low))), 1.0)
        return np.where(inside, alone / (1.0 - twist * alone), 0.0)

    def stiffness(xi: FloatArray) -> FloatArray:
        together = sum(local(xi + shift) for shift in shifts)
        return np.asarray(local(xi) / (1.0 + twist * together), dtype=np.float64)

    breaks, switches = neighbour_breaks([low, high], k.breaks[1:-1], geometry)
    scale = float(k(np.linspace(low, high, 65)[1:-1]).max())
    return PathFunction.fit(stiffness, breaks, switches, tolerance=_FIT_TOLERANCE * scale)


def neighbour_breaks(
    switches: ArrayLike, knots: ArrayLike, geometry: Geometry
) -> tuple[FloatArray, FloatArray]:
    """Breaks and switches of a function of a pair and its neighbours over the path of contact.

    Parameters
    ----------
    switches : (m,) positions at which one pair alone jumps or has a kink, A and D among them [m]
    knots : (n,) positions at which one pair alone passes from one polynomial piece to the next [m]
    geometry : of the pair

    Returns
    -------
    breaks : from A to D, increasing, none within rounding of another [m]
    switches : those inside that are jumps or kinks [m]
    """
    g, same = geometry, _SAME * geometry.base_pitch
    shifts = np.arange(1 - g.pairs, g.pairs) * g.base_pitch

    def within(positions: ArrayLike) -> FloatArray:
        moved = np.unique(np.add.outer(np.asarray(positions), shifts))
        moved = moved[(moved > g.L_XA + same) & (moved < g.L_XD - same)]
        return moved[np.diff(moved, prepend=-np.inf) > same]

    jumps, joints = within(switches), within(knots)
    apart = np.abs(np.subtract.outer(joints, jumps)).min(axis=1, initial=np.inf) > same
    return np.unique(np.concatenate([[g.L_XA, g.L_XD], jumps, joints[apart]])), jumps
