"""Schema of the mesh: stiffness model, damping, backlash."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from lumped.fields.section import Section
from lumped.fields.units import Quantity
from lumped.stiffness.registry import AnyStiffness


class Mesh(Section):
    """The elastic mesh of the tooth pairs."""

    stiffness: AnyStiffness = Field(
        discriminator="model", description="stiffness of a tooth pair over the path of contact"
    )
    damping_ratio: Annotated[float, Quantity("1", at_least=0, at_most=1)] = Field(
        description="zeta in c_i = 2 zeta sqrt(k_i m_e)"
    )
    relief: Literal["ignored", "static"] = Field(
        "static",
        description="'static': tip and root relief, where given, enter as unloaded error, and a pair touches "
        "where it carries load at the mean torque; 'ignored': perfect involutes from A to D",
    )
    contact: Literal["prescribed", "loaded"] = Field(
        "loaded",
        description="'loaded': a pair touches where its gap closes under the mean load, with its tangent "
        "stiffness there, and the brake balances every loss; 'prescribed': it touches from A to D ",
    )
    backlash: Annotated[float, Quantity("mm", at_least=0)] = Field(
        0.0, description="normal backlash by tooth thinning, beyond that of the centre distance"
    )
