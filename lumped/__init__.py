"""Spur gear pairs with sliding friction: schema, kinematics, stiffness, friction laws and the LTV model."""

from lumped.errors import (
    FieldProblem,
    LawRangeWarning,
    LikeTeethWarning,
    NumericalError,
    ParameterError,
    SpurcheckError,
)
from lumped.gear_geometry.geometry import Geometry
from lumped.model.averaged import natural_frequencies
from lumped.model.mesh_cycle import MeshCycle, mesh_cycle
from lumped.model.periodic_system import LTVSystem, periodic_system
from lumped.model.run_up import run_up
from lumped.model.static_sharing import static_sharing
from lumped.model.steady_state import steady_state
from lumped.model.sweep import speed_sweep
from lumped.model.transient import simulate
from lumped.path_function import PathFunction
from lumped.path_of_contact.plane_compliance import plane_compliance
from lumped.path_of_contact.stiffness import mesh_stiffness, stiffness_components
from lumped.quasi_static import optimal_relief, static_transmission_error
from lumped.quasi_static.contacts import mesh_elements
from lumped.quasi_static.elements import MeshElements
from lumped.schema.assumed import State
from lumped.schema.bodies import Bodies, bodies
from lumped.schema.files import geometry, json_schema, load_gear_pair, preset_names
from lumped.schema.meeting_teeth import meeting_teeth, revolution, tooth_gaps
from lumped.schema.pair import GearPair
from lumped.schema.tolerances import flank_tolerances
from lumped.shafts.equivalents import condensed_bearings, shaft_modes

__all__ = [
    "Bodies",
    "FieldProblem",
    "GearPair",
    "Geometry",
    "LTVSystem",
    "LawRangeWarning",
    "LikeTeethWarning",
    "MeshCycle",
    "MeshElements",
    "NumericalError",
    "ParameterError",
    "PathFunction",
    "SpurcheckError",
    "State",
    "bodies",
    "condensed_bearings",
    "flank_tolerances",
    "geometry",
    "json_schema",
    "load_gear_pair",
    "meeting_teeth",
    "mesh_cycle",
    "mesh_elements",
    "mesh_stiffness",
    "natural_frequencies",
    "optimal_relief",
    "periodic_system",
    "plane_compliance",
    "preset_names",
    "revolution",
    "run_up",
    "shaft_modes",
    "simulate",
    "speed_sweep",
    "static_sharing",
    "static_transmission_error",
    "steady_state",
    "stiffness_components",
    "tooth_gaps",
]
