"""Schema of the gears: basic rack, blank, material, roughness and flank modifications."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from lumped.errors import FieldProblem, ParameterError
from lumped.section import Section
from lumped.units import Quantity, to_stated

_SIZE = "Give the size as drawn; check the unit."


class ProfileRelief(Section):
    """Deviation of a flank from the involute by design, growing from a roll angle to the flank's end."""

    shape: Literal["linear", "parabolic"] = Field("linear", description="growth over roll angle")
    amount: Annotated[float, Quantity("um", at_least=0, at_most=1000)] = Field(
        description="material removed at the end of the flank, normal to it"
    )
    start_roll_angle: Annotated[float, Quantity("deg", above=0, at_most=180)] = Field(
        description="roll angle at which the relief starts"
    )


class BasicRack(Section):
    """Basic rack of both gears (ISO 53). ``diametral_pitch`` may be given instead of ``module``."""

    module: Annotated[float, Quantity("mm", above=0, at_most=100, action=_SIZE)] = Field(
        description="normal module; or give diametral_pitch [1/inch] instead"
    )
    pressure_angle: Annotated[float, Quantity("deg", at_least=10, at_most=35)] = Field(
        0.3490658503988659, description="pressure angle of the basic rack"
    )
    addendum_coefficient: Annotated[float, Quantity("1", above=0, at_most=2)] = Field(
        1.0, description="addendum over module"
    )
    dedendum_coefficient: Annotated[float, Quantity("1", above=0, at_most=2.5)] = Field(
        1.25, description="dedendum over module"
    )
    fillet_radius_coefficient: Annotated[float, Quantity("1", at_least=0, at_most=0.6)] = Field(
        0.38, description="root fillet radius of the rack over module"
    )

    @model_validator(mode="before")
    @classmethod
    def _diametral_pitch(cls, data: Any) -> Any:
        if not isinstance(data, dict) or "diametral_pitch" not in data:
            return data
        rest = dict(data)
        given = rest.pop("diametral_pitch")
        if "module" in rest:
            problem = FieldProblem(
                "basic_rack.diametral_pitch",
                str(given),
                "either module or diametral_pitch",
                "Remove one of the two.",
            )
            raise ParameterError([problem])
        pitch = Quantity("1/inch", above=0.25, at_most=200).parse(given)
        return {**rest, "module": None if pitch is None else 25.4 / to_stated(pitch, "1/inch")}


class Gear(Section):
    """One gear. Mass and inertia default to a solid steel disc of the reference diameter."""

    teeth: Annotated[int, Field(ge=5, le=1000, strict=True)] = Field(description="number of teeth")
    face_width: Annotated[float, Quantity("mm", above=0, at_most=2000, action=_SIZE)] = Field(
        description="face width"
    )
    profile_shift: Annotated[float, Quantity("1", at_least=-1.5, at_most=2)] = Field(
        0.0, description="profile shift coefficient x"
    )
    addendum: Annotated[float | None, Quantity("mm", above=0, optional=True)] = Field(
        None, description="addendum, reference to tip circle; default module * (addendum_coefficient + x)"
    )
    tip_diameter: Annotated[float | None, Quantity("mm", above=0, optional=True)] = Field(
        None, description="tip diameter, instead of addendum"
    )
    bore: Annotated[float, Quantity("mm", at_least=0)] = Field(0.0, description="bore diameter; 0 is solid")
    mass: Annotated[float | None, Quantity("kg", above=0, optional=True)] = Field(
        None, description="mass; default disc of the reference diameter and face width"
    )
    inertia: Annotated[float | None, Quantity("kg*m**2", above=0, optional=True)] = Field(
        None, description="polar moment of inertia; default as for mass"
    )
    density: Annotated[float, Quantity("kg/m**3", above=0)] = Field(
        7850.0, description="density, for the disc"
    )
    youngs_modulus: Annotated[float, Quantity("GPa", above=0)] = Field(206e9, description="Young's modulus")
    poisson_ratio: Annotated[float, Quantity("1", at_least=0, below=0.5)] = Field(
        0.3, description="Poisson ratio"
    )
    roughness: Annotated[float, Quantity("um", at_least=0, at_most=50)] = Field(
        description="arithmetic mean roughness Ra of the flanks"
    )
    tip_relief: ProfileRelief | None = Field(None, description="material removed towards the tip")
    root_relief: ProfileRelief | None = Field(None, description="material removed towards the root")

    @model_validator(mode="after")
    def _one_tip(self) -> Self:
        if self.addendum is not None and self.tip_diameter is not None:
            problem = FieldProblem(
                "tip_diameter",
                f"{self.tip_diameter * 1e3:g} mm",
                "either addendum or tip_diameter",
                "Remove one.",
            )
            raise ParameterError([problem])
        return self
