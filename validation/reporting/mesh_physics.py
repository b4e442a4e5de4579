"""Computation of the mesh physics chapter: stiffness, load sharing, static transmission error, tip relief."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
import xarray as xr

from lumped import GearPair, NumericalError, ParameterError
from lumped.labelling import labelled_dataset
from lumped.path_of_contact.stiffness import iso_comparison, mesh_stiffness, stiffness_components
from lumped.quasi_static import (
    OptimalRelief,
    optimal_relief,
    relief_map,
    static_transmission_error,
    with_tip_relief,
)

#: Torques of the static transmission error curves, over the operating torque.
CURVES = (0.1, 0.5, 1.0, 1.5, 2.0)
_HARRIS_POINTS = 121
_MAP_POINTS = 41

T = TypeVar("T")


@dataclass(frozen=True, eq=False)
class MeshPhysics:
    """Mesh physics of one gear pair; None where a method does not apply, with the reason in ``refused``.

    Attributes
    ----------
    components, iso, energy_mesh : potential-energy stiffness of the pair, whatever its own model:
        ``stiffness_components``, ``iso_comparison`` and ``mesh_stiffness``
    curves : ``static_transmission_error`` at ``CURVES`` times the operating torque, with the pair's model
    harris : peak to peak static transmission error over ``torque`` [N m] and ``flank``
    optimum, relief : best linear tip relief at the operating torque, and the map around it; None when quick
    refused : reasons of what is missing
    """

    components: xr.Dataset | None
    iso: xr.Dataset | None
    energy_mesh: xr.Dataset | None
    curves: xr.Dataset | None
    harris: xr.Dataset | None
    optimum: OptimalRelief | None
    relief: xr.Dataset | None
    refused: tuple[str, ...]


def mesh_physics(pair: GearPair, *, quick: bool = False) -> MeshPhysics:
    """Compute the mesh physics of a gear pair.

    Parameters
    ----------
    pair : a validated gear pair
    quick : without the best relief
    """
    refused: list[str] = []

    def attempt(what: str, compute: Callable[[], T]) -> T | None:
        try:
            return compute()
        except (ParameterError, NumericalError) as error:
            refused.append(f"{what}: {error}")
            return None

    energy = pair.with_(mesh__stiffness={"model": "energy"})
    optimum = None if quick else attempt("Tip relief", lambda: optimal_relief(pair))
    return MeshPhysics(
        components=attempt("Potential-energy stiffness", lambda: stiffness_components(pair)),
        iso=attempt("Comparison with ISO 6336-1", lambda: iso_comparison(pair)),
        energy_mesh=attempt("Potential-energy mesh stiffness", lambda: mesh_stiffness(energy)),
        curves=attempt("Static transmission error", lambda: _curves(pair)),
        harris=attempt("Harris map", lambda: _harris(pair, energy, optimum)),
        optimum=optimum,
        relief=None if optimum is None else attempt("Relief map", lambda: _map(pair, optimum)),
        refused=tuple(refused),
    )


def _curves(pair: GearPair) -> xr.Dataset:
    return static_transmission_error(pair, np.array(CURVES) * pair.operating.pinion_torque)


def _harris(pair: GearPair, energy: GearPair, optimum: OptimalRelief | None) -> xr.Dataset:
    """Peak to peak over torque: own flanks, involutes, best relief, own flanks with energy stiffness."""
    torque = np.linspace(0.02, 2.0, _HARRIS_POINTS) * pair.operating.pinion_torque
    flanks = {"flanks as given": pair}
    if any((gear.tip_relief, gear.root_relief) != (None, None) for gear in (pair.pinion, pair.gear)):
        bare: dict[str, None] = {
            f"{gear}__{which}_relief": None for gear in ("pinion", "gear") for which in ("tip", "root")
        }
        flanks["perfect involutes"] = pair.with_(**bare)
    if optimum is not None:
        flanks["best linear tip relief"] = with_tip_relief(pair, optimum)
    if pair.mesh.stiffness.model != "energy":
        flanks["as given, energy stiffness"] = energy
    rows = [static_transmission_error(one, torque)["peak_to_peak"].to_numpy() for one in flanks.values()]
    return labelled_dataset(
        {"peak_to_peak": (("flank", "torque"), rows, "m", "peak to peak static transmission error")},
        {"flank": (list(flanks), "1", "flanks"), "torque": (torque, "N*m", "pinion torque")},
        {"operating_torque": pair.operating.pinion_torque},
    )


def _map(pair: GearPair, optimum: OptimalRelief) -> xr.Dataset:
    share = np.linspace(0.0, 2.0, _MAP_POINTS)
    return relief_map(pair, share * optimum.amount, np.linspace(0.3, 1.7, _MAP_POINTS) * optimum.length)
