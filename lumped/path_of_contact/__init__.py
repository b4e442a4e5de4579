"""What a gear pair has over its path of contact: contact conditions, friction and stiffness."""

from lumped.path_of_contact.friction import (
    contact_path,
    friction_path_function,
    friction_profile,
    law_range_violations,
)
from lumped.path_of_contact.plane_compliance import plane_compliance
from lumped.path_of_contact.stiffness import mesh_stiffness, pair_stiffness, stiffness_components

__all__ = [
    "contact_path",
    "friction_path_function",
    "friction_profile",
    "law_range_violations",
    "mesh_stiffness",
    "pair_stiffness",
    "plane_compliance",
    "stiffness_components",
]
