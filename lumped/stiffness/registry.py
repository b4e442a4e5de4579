"""The stiffness models by name."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import get_args

from lumped.stiffness.base import StiffnessModel
from lumped.stiffness.energy import EnergyStiffness
from lumped.stiffness.finite_elements import FiniteElementStiffness
from lumped.stiffness.parabolic import ParabolicStiffness
from lumped.stiffness.rectangular import RectangularStiffness
from lumped.stiffness.table import TableStiffness

#: Every model that ``mesh.stiffness.model`` may name.
AnyStiffness = (
    RectangularStiffness | ParabolicStiffness | EnergyStiffness | FiniteElementStiffness | TableStiffness
)

#: ``mesh.stiffness.model`` -> section of the parameter file, which computes the curve.
MODELS: Mapping[str, type[StiffnessModel]] = MappingProxyType(
    {section.model_fields["model"].default: section for section in get_args(AnyStiffness)}
)
