"""A chip: a broken corner of a tooth."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from lumped.faults.base import ToothFault
from lumped.fields.units import Quantity


class Chip(ToothFault):
    """No flank beyond a roll angle; the corner that is left is the tip of this tooth."""

    kind: Literal["chip"] = Field("chip", description="a broken corner")
    roll_angle: Annotated[float, Quantity("deg", at_least=0, at_most=180)] = Field(
        description="roll angle at which the flank ends"
    )
