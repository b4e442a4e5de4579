"""Where the neighbours of a tooth pair, a whole number of base pitches away, change what it carries."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from lumped.gear_geometry.geometry import Geometry
from lumped.typing import FloatArray

#: Positions closer than this fraction of a base pitch are one.
_SAME = 1e-9


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
