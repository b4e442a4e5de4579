"""Schema of tip and root relief, and where each starts on its flank."""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal, Self

from pydantic import ConfigDict, Field, model_validator

from lumped.errors import ParameterError, refuse
from lumped.faults.base import Flank
from lumped.fields.section import Section
from lumped.fields.units import Quantity, SIValue
from lumped.gear_geometry.roll_angle import diameter_of, roll_angle_of

#: Fields of which one states where a relief starts.
STARTS = ("start_roll_angle", "start_diameter", "length")
_TO = "start_roll_angle, start_diameter or length"
_ON_IT = "Start the relief on the active flank."
#: Default of the roll angle; a pair sets it from the other two.
_NOT_STATED: Any = None


class ProfileRelief(Section):
    """Deviation of a flank from the involute by design, growing from its start to the flank's end.

    Tip relief ends at the tip circle. Root relief ends at the start of the active flank, where the mate's tip
    touches last. Exactly one of ``start_roll_angle``, ``start_diameter`` and ``length`` gives the start. In a
    pair ``start_roll_angle`` always has a value. A written file keeps the field of the user.
    """

    model_config = ConfigDict(json_schema_extra={"oneOf": [{"required": [name]} for name in STARTS]})

    shape: Literal["linear", "parabolic"] = Field("linear", description="growth over roll angle")
    amount: Annotated[float, Quantity("um", at_least=0, at_most=1000)] = Field(
        description="material removed at the end of the flank, normal to it"
    )
    start_roll_angle: Annotated[float, Quantity("deg", above=0, at_most=180, optional=True)] = Field(
        _NOT_STATED, description="roll angle at which the relief starts; or give start_diameter or length"
    )
    start_diameter: Annotated[float | None, Quantity("mm", above=0, optional=True)] = Field(
        None, description="diameter at which the relief starts, instead of start_roll_angle"
    )
    length: Annotated[float | None, Quantity("mm", above=0, optional=True)] = Field(
        None,
        description="roll length of the relief from its start to the flank's end, instead of "
        "start_roll_angle: on the length axis of a profile chart (ISO 1328-1), and along the path of "
        "contact; not along the flank nor radially",
    )

    @model_validator(mode="after")
    def _one_start(self) -> Self:
        stated = [name for name in STARTS if getattr(self, name) is not None]
        if len(stated) != 1:
            value = " and ".join(stated) or "missing"
            raise refuse("start_roll_angle", value, f"exactly one of {_TO}", "Give one of them.")
        return self

    @property
    def by_angle(self) -> bool:
        """Whether the file states the start as a roll angle."""
        return self.start_diameter is None and self.length is None

    def on(self, flank: Flank, kind: str) -> Self:
        """The relief with the roll angle phi of the start on a flank.

        From a diameter d: phi = sqrt(d^2 - d_b^2)/d_b. From a length: phi = (L_end -+ length)/r_b, minus for
        a length from the tip, plus for a length from the start of the active flank.

        Parameters
        ----------
        flank : of the gear in its mesh
        kind : "tip_relief" or "root_relief"

        Raises
        ------
        ParameterError : a start that is not on the active flank
        """
        radius = flank.wheel.tooth.base_radius
        if self.start_diameter is not None:
            if self.start_diameter <= 2.0 * radius:
                raise self.off(flank, kind)
            roll = roll_angle_of(self.start_diameter, radius)
        elif self.length is not None:
            end = flank.tip - self.length if kind == "tip_relief" else flank.start + self.length
            roll = end / radius
        else:
            roll = self.start_roll_angle
        if not flank.start < roll * radius < flank.tip:
            raise self.off(flank, kind)
        return self.model_copy(update={"start_roll_angle": SIValue(roll, "rad")})

    def off(self, flank: Flank, kind: str) -> ParameterError:
        """The refusal of a relief that does not start on the active flank; names the field of the start."""
        radius = flank.wheel.tooth.base_radius
        ends = (flank.start, flank.tip)
        if self.length is not None:
            allowed = f"> 0 and < {1e3 * (flank.tip - flank.start):.4f} mm, the active flank"
            return refuse(f"{kind}.length", f"{1e3 * self.length:.6g} mm", allowed, _ON_IT)
        if self.start_diameter is not None:
            low, high = (1e3 * diameter_of(end / radius, radius) for end in ends)
            value = f"{1e3 * self.start_diameter:.6g} mm"
            allowed = f"{low:.4f} to {high:.4f} mm"
            return refuse(f"{kind}.start_diameter", value, allowed, _ON_IT)
        low, high = (math.degrees(end / radius) for end in ends)
        value = f"{math.degrees(self.start_roll_angle):.4g} deg"
        allowed = f"{low:.4f} to {high:.4f} deg"
        return refuse(f"{kind}.start_roll_angle", value, allowed, _ON_IT)

    @property
    def derived_fields(self) -> tuple[str, ...]:
        """The roll angle, where the file states the start in another way."""
        return () if self.by_angle else ("start_roll_angle",)
