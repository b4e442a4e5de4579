"""A spall: a pit in the flank."""

from __future__ import annotations

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from lumped.errors import refuse
from lumped.faults.base import ToothFault
from lumped.fields.units import Quantity

_ROLL = Quantity("deg", at_least=0, at_most=180)


class Spall(ToothFault):
    """Pit between two roll angles of the flank, over a part of the face width or all of it."""

    kind: Literal["spall"] = Field("spall", description="a pit in the flank")
    start_roll_angle: Annotated[float, _ROLL] = Field(description="roll angle at which it starts")
    end_roll_angle: Annotated[float, _ROLL] = Field(description="roll angle at which it ends")
    width: Annotated[float | None, Quantity("mm", above=0, optional=True)] = Field(
        None, description="along the face width; default the whole face width"
    )
    pit_depth: Annotated[float, Quantity("um", at_least=0, at_most=1000)] = Field(
        100.0, description="depth, which a pit over the whole face width lets the mate fall"
    )

    @model_validator(mode="after")
    def _increasing(self) -> Self:
        if self.end_roll_angle <= self.start_roll_angle:
            value = f"{self.end_roll_angle.to('deg'):g} deg"  # type: ignore[attr-defined]
            raise refuse("end_roll_angle", value, "> start_roll_angle", "Exchange the two.")
        return self
