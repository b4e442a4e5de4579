"""Constant stiffness of every tooth pair: the total mesh stiffness is a rectangular wave."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lumped.path_function import PathFunction
from lumped.stiffness import iso6336

if TYPE_CHECKING:
    from lumped.gear_geometry.geometry import Geometry
    from lumped.schema.mesh import RectangularStiffness
    from lumped.schema.pair import GearPair


def rectangular(model: RectangularStiffness, pair: GearPair, geometry: Geometry) -> PathFunction:
    """Stiffness of a tooth pair [N/m], constant from A to D.

    Parameters
    ----------
    model : ``pair_stiffness`` [N/m]; None takes ISO 6336-1 method B c' times face width
    pair, geometry : the gear pair and its geometry
    """
    value = model.pair_stiffness
    if value is None:
        value = iso6336.pair_single_stiffness(pair) * iso6336.SI * geometry.face_width
    return PathFunction.constant(value, geometry.L_XA, geometry.L_XD)
