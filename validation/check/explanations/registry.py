"""The registry of explanations by name: readings of the curves, alterations of the equations, inputs.

A further explanation is an entry of ``OF_READING``, ``LEFT_OUT``, ``OF_PAIR``, ``OF_BODIES``,
``OF_GEOMETRY``, ``OF_DESIGN``, ``OF_ONE_GEAR``, ``OF_SURFACE``, ``OF_RELIEF``, ``OF_PATH`` or
``OF_MODEL``, or a constant of a module of its own, a row of the table in docs/how_to/check_your_model.md and
a case in tests/validation/check/test_explanations.py.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from validation.check.explanations.alterations import OF_MODEL
from validation.check.explanations.body_inputs import OF_BODIES
from validation.check.explanations.cause import Cause
from validation.check.explanations.design_inputs import OF_DESIGN
from validation.check.explanations.geometry_inputs import OF_GEOMETRY
from validation.check.explanations.inputs import OF_PAIR
from validation.check.explanations.left_out import LEFT_OUT
from validation.check.explanations.long_steps import LONG_STEPS
from validation.check.explanations.misreadings import OF_READING
from validation.check.explanations.one_gear_inputs import OF_ONE_GEAR
from validation.check.explanations.path_alterations import OF_PATH
from validation.check.explanations.relief_inputs import OF_RELIEF
from validation.check.explanations.surface_inputs import OF_SURFACE

#: Name -> cause, the cheapest first: a reading costs no motion.
EXPLANATIONS: Mapping[str, Cause] = MappingProxyType(
    {
        cause.name: cause
        for cause in (
            *OF_READING,
            *LEFT_OUT,
            *OF_PAIR,
            *OF_BODIES,
            *OF_GEOMETRY,
            *OF_DESIGN,
            *OF_ONE_GEAR,
            *OF_SURFACE,
            *OF_RELIEF,
            *OF_PATH,
            *OF_MODEL,
            LONG_STEPS,
        )
    }
)
