"""Schema of the mesh: stiffness model, damping, backlash."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Field, ValidationInfo, model_validator

from lumped.schema.section import Section
from lumped.schema.units import Quantity

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


class EnergyStiffness(Section):
    """Potential-energy stiffness of the true tooth form on its gear body."""

    model: Literal["energy"] = "energy"
    hertz: Literal["weber_banaschek", "linear"] = Field(
        "weber_banaschek",
        description="contact compliance: by Weber and Banaschek at the operating torque, or linearised",
    )
    coupling: Literal["none", "ring_twist"] = Field(
        "none",
        description="'ring_twist': pairs in contact together share the twist of bored gear bodies",
    )
    scale: Literal["none", "iso6336"] = Field(
        "none", description="'iso6336' scales the curve to the mean mesh stiffness of ISO 6336-1 method B"
    )
    ramp_length: Annotated[float, Quantity("mm", at_least=0)] = Field(
        0.0, description="length along the path over which a pair takes up its stiffness; 0 is a jump"
    )


class TableStiffness(Section):
    """Tabulated stiffness: of one pair over the path of contact, or of all pairs over a mesh cycle."""

    model: Literal["table"] = "table"
    kind: Literal["pair", "total"] = Field(
        "pair", description="stiffness of one pair from A to D, or sum of all pairs over one mesh cycle"
    )
    axis: Literal["position_mm", "roll_angle_deg", "phase"] = Field(
        description="what 'points' are: distance from X [mm], pinion roll angle [deg], or cycles after A [1]"
    )
    points: tuple[float, ...] = Field(
        min_length=4, max_length=100_000, description="increasing abscissae, in the unit of 'axis'"
    )
    stiffness: tuple[float, ...] = Field(
        min_length=4, max_length=100_000, description="stiffness at the points [N/m]"
    )
    interpolation: Literal["monotone", "cubic"] = Field(
        "monotone",
        description="monotone (no overshoot, continuous slope) or cubic spline (continuous curvature)",
    )
    ramp_length: Annotated[float, Quantity("mm", at_least=0)] = Field(
        0.0, description="length along the path over which a pair takes up its stiffness; 0 is a jump"
    )

    @model_validator(mode="before")
    @classmethod
    def _read_file(cls, data: Any, info: ValidationInfo) -> Any:
        """Replace ``file = "curve.csv"`` by its contents; a relative path is beside the parameter file."""
        if not isinstance(data, dict) or "file" not in data:
            return data
        from lumped.schema.stiffness_table import read_stiffness_table

        folder = (info.context or {}).get("folder", ".")
        return {key: value for key, value in data.items() if key != "file"} | read_stiffness_table(
            data["file"], folder
        )

    @model_validator(mode="after")
    def _checked(self) -> Self:
        from lumped.schema.stiffness_table import check_stiffness_table

        check_stiffness_table(self.points, self.stiffness)
        return self


StiffnessModel = Annotated[
    RectangularStiffness | ParabolicStiffness | EnergyStiffness | TableStiffness,
    Field(discriminator="model"),
]


class Mesh(Section):
    """The elastic mesh of the tooth pairs."""

    stiffness: StiffnessModel = Field(description="stiffness of a tooth pair over the path of contact")
    damping_ratio: Annotated[float, Quantity("1", at_least=0, at_most=1)] = Field(
        description="zeta in c_i = 2 zeta sqrt(k_i m_e)"
    )
    relief: Literal["ignored", "static"] = Field(
        "ignored",
        description="'static': tip and root relief enter as unloaded error, and a pair touches where it "
        "carries load at the mean torque; 'ignored': perfect involutes from A to D",
    )
    backlash: Annotated[float, Quantity("mm", at_least=0)] = Field(
        0.0, description="normal backlash by tooth thinning, beyond that of the centre distance"
    )
