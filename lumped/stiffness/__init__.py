"""Tooth-pair stiffness over the path of contact: one small module per model, and their registry."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from lumped.stiffness.energy import energy
from lumped.stiffness.parabolic import parabolic
from lumped.stiffness.rectangular import rectangular
from lumped.stiffness.table import table

if TYPE_CHECKING:
    from lumped.gear_geometry import Geometry
    from lumped.parameters import GearPair
    from lumped.path_function import PathFunction

#: ``mesh.stiffness.model`` -> function (model parameters, pair, geometry) -> k_i(xi) [N/m].
MODELS: dict[str, Callable[[Any, GearPair, Geometry], PathFunction]] = {
    "rectangular": rectangular,
    "parabolic": parabolic,
    "energy": energy,
    "table": table,
}


def pair_stiffness(pair: GearPair, geometry: Geometry) -> PathFunction:
    """Stiffness k_i(xi) of one tooth pair of a gear pair from A to D, by its stiffness model [N/m].

    Parameters
    ----------
    pair : a validated gear pair; ``pair.mesh.stiffness`` names the model and its parameters
    geometry : the pair's geometry

    Raises
    ------
    ParameterError : the model's parameters do not fit this pair
    """
    model = pair.mesh.stiffness
    return MODELS[model.model](model, pair, geometry)


__all__ = ["MODELS", "energy", "pair_stiffness", "parabolic", "rectangular", "table"]
