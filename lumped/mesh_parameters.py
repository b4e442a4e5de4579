"""Schema of the mesh: stiffness model, damping, backlash."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from lumped.section import Section
from lumped.units import Quantity

_PairStiffness = Quantity("N/m", above=0, at_most=1e12, optional=True)


class RectangularStiffness(Section):
    """Constant stiffness of every tooth pair in contact: the total is a rectangular wave."""

    model: Literal["rectangular"] = "rectangular"
    pair_stiffness: Annotated[float | None, _PairStiffness] = Field(
        None, description="stiffness of one tooth pair; default ISO 6336-1 method B c' times face width"
    )


class ParabolicStiffness(Section):
    """Stiffness of a tooth pair as a parabola over the path of contact, with optional smooth engagement."""

    model: Literal["parabolic"] = "parabolic"
    peak: Annotated[float | None, _PairStiffness] = Field(
        None,
        description="largest stiffness of one tooth pair; default ISO 6336-1 method B c' times face width",
    )
    end_ratio: Annotated[float | None, Quantity("1", above=0, at_most=1, optional=True)] = Field(
        None,
        description="stiffness at the ends of the path of contact over the peak; default gives the mean mesh "
        "stiffness of ISO 6336-1",
    )
    ramp_length: Annotated[float, Quantity("mm", at_least=0)] = Field(
        0.0, description="length along the path over which a pair takes up its stiffness; 0 is a jump"
    )


StiffnessModel = Annotated[RectangularStiffness | ParabolicStiffness, Field(discriminator="model")]


class Mesh(Section):
    """The elastic mesh of the tooth pairs."""

    stiffness: StiffnessModel = Field(description="stiffness of a tooth pair over the path of contact")
    damping_ratio: Annotated[float, Quantity("1", at_least=0, at_most=1)] = Field(
        description="zeta in c_i = 2 zeta sqrt(k_i m_e)"
    )
    backlash: Annotated[float, Quantity("mm", at_least=0)] = Field(
        0.0, description="normal backlash by tooth thinning, beyond that of the centre distance"
    )
