"""Spur gear pairs with sliding friction: schema, kinematics, stiffness, friction laws and the LTV model."""

from lumped.bodies import Bodies, bodies
from lumped.errors import FieldProblem, LawRangeWarning, NumericalError, ParameterError, SpurcheckError
from lumped.gear_geometry import Geometry, geometry
from lumped.parameters import GearPair
from lumped.path_function import PathFunction
from lumped.serialise import json_schema, load_gear_pair, preset_names

__all__ = [
    "Bodies",
    "FieldProblem",
    "GearPair",
    "Geometry",
    "LawRangeWarning",
    "NumericalError",
    "ParameterError",
    "PathFunction",
    "SpurcheckError",
    "bodies",
    "geometry",
    "json_schema",
    "load_gear_pair",
    "preset_names",
]
