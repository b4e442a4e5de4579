"""How simultaneous tooth pairs share the load."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from lumped.errors import refuse
from lumped.losses.cycle import CyclePositions
from lumped.path_function import FloatArray, PathFunction
from lumped.stiffness import pair_stiffness

if TYPE_CHECKING:
    from lumped.gear_geometry import Geometry
    from lumped.parameters import GearPair

#: "uniform", "stiffness" (as the pair's stiffness model) or a path function of relative stiffness.
Sharing = Literal["uniform", "stiffness"] | PathFunction


def sharing_function(pair: GearPair, g: Geometry, sharing: Sharing) -> PathFunction:
    """Return the relative stiffness of a tooth pair over the path for a kind of load sharing.

    Raises
    ------
    ParameterError : not one of the kinds
    """
    if isinstance(sharing, PathFunction):
        return sharing
    if sharing == "uniform":
        return PathFunction.constant(1.0, g.L_XA, g.L_XD)
    if sharing == "stiffness":
        return pair_stiffness(pair, g)
    raise refuse("sharing", sharing, "'uniform', 'stiffness' or a PathFunction", "Choose one of them.")


def load_share(relative: PathFunction, at: CyclePositions) -> FloatArray:
    """Fraction of the mesh load on each pair, k_i / SUM k; (pairs, k), sums to 1 over the pairs.

    All pairs deflect by the same transmission error, so a pair's load is proportional to its stiffness.
    """
    weights = np.where(at.contact, relative(at.position), 0.0)
    return np.asarray(weights / weights.sum(axis=0), dtype=np.float64)
