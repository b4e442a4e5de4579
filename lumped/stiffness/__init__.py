"""Tooth-pair stiffness over the path of contact: one small module per model, and their registry.

Sources: each model names its own; docs/theory/mesh_physics.md, "Stiffness of a tooth pair".
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from lumped.stiffness import iso6336
from lumped.stiffness.energy import energy
from lumped.stiffness.energy import violations as energy_violations
from lumped.stiffness.parabolic import parabolic
from lumped.stiffness.rectangular import rectangular
from lumped.stiffness.table import table

if TYPE_CHECKING:
    from lumped.gear_geometry.geometry import Geometry
    from lumped.path_function import PathFunction
    from lumped.ranges import RangeViolation
    from lumped.schema.pair import GearPair

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


def stiffness_range_violations(pair: GearPair, geometry: Geometry) -> tuple[RangeViolation, ...]:
    """Validity ranges that a gear pair leaves under its stiffness model.

    They are returned, not warned about: ordinary gears leave the fit of the fillet foundation, and a warning
    at every evaluation of a sweep would hide the others. The report lists them among the validity flags.

    Parameters
    ----------
    pair, geometry : the gear pair and its geometry
    """
    model = pair.mesh.stiffness
    found: tuple[RangeViolation, ...] = ()
    if model.model == "energy":
        found += energy_violations(pair, geometry)
    standard = (
        (model.model == "energy" and model.scale == "iso6336")
        or (model.model == "rectangular" and model.pair_stiffness is None)
        or (model.model == "parabolic" and (model.peak is None or model.end_ratio is None))
    )
    return found + iso6336.violations(pair, geometry) if standard else found


__all__ = [
    "MODELS",
    "energy",
    "pair_stiffness",
    "parabolic",
    "rectangular",
    "stiffness_range_violations",
    "table",
]
