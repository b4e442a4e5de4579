"""Quasi-static meshing: profile modification, load sharing, static transmission error, best relief."""

from lumped.quasi_static.load_sharing import LoadSharing, share_load
from lumped.quasi_static.relief_optimum import OptimalRelief, optimal_relief, with_tip_relief
from lumped.quasi_static.transmission_error import mesh_positions, static_transmission_error

__all__ = [
    "LoadSharing",
    "OptimalRelief",
    "mesh_positions",
    "optimal_relief",
    "share_load",
    "static_transmission_error",
    "with_tip_relief",
]
