"""Quasi-static meshing: profile modification, load sharing, static transmission error, best relief."""

from lumped.quasi_static.load_sharing import LoadSharing, share_load
from lumped.quasi_static.prescribed import LoadedMesh, loaded_mesh
from lumped.quasi_static.relief_optimum import OptimalRelief, optimal_relief, relief_map, with_tip_relief
from lumped.quasi_static.tooth_error import corner_gap, error_function, relief_error
from lumped.quasi_static.transmission_error import MeshPositions, mesh_positions, static_transmission_error

__all__ = [
    "LoadSharing",
    "LoadedMesh",
    "MeshPositions",
    "OptimalRelief",
    "corner_gap",
    "error_function",
    "loaded_mesh",
    "mesh_positions",
    "optimal_relief",
    "relief_error",
    "relief_map",
    "share_load",
    "static_transmission_error",
    "with_tip_relief",
]
