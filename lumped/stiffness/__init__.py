"""Tooth-pair stiffness over the path of contact: one small module per model, and their registry.

Sources: each model names its own; docs/theory/mesh_physics.md, "Stiffness of a tooth pair".
"""

from lumped.stiffness.base import StiffnessModel
from lumped.stiffness.registry import MODELS, AnyStiffness

__all__ = ["MODELS", "AnyStiffness", "StiffnessModel"]
