"""Dynamic viscosity of a lubricant section of the schema."""

from __future__ import annotations

from typing import TYPE_CHECKING

from lumped.lubrication.viscosity import ZERO_CELSIUS, kinematic_viscosity, oil_density, walther_constants
from lumped.lubrication.viscosity_grade import grade_viscosity

if TYPE_CHECKING:
    from lumped.schema.contact import Lubricant


def dynamic_viscosity(lubricant: Lubricant) -> float:
    """Dynamic viscosity of a lubricant section [Pa s]: the given number, or its law at its temperature."""
    law = lubricant.viscosity_law
    if law is None:
        assert lubricant.viscosity is not None  # the schema asks for exactly one of them
        return lubricant.viscosity
    celsius = law.temperature - ZERO_CELSIUS
    if law.iso_vg is not None:
        nu = float(grade_viscosity(law.iso_vg, celsius, law.viscosity_index))
    else:
        assert law.kinematic_viscosity_40 is not None  # the schema asks for the grade or both viscosities
        assert law.kinematic_viscosity_100 is not None
        constants = walther_constants(
            law.kinematic_viscosity_40 * 1e6, 40.0, law.kinematic_viscosity_100 * 1e6, 100.0
        )
        nu = float(kinematic_viscosity(celsius, constants))
    return nu * 1e-6 * float(oil_density(law.density, celsius))
