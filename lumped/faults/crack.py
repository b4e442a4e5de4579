"""A crack at the root of a tooth."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from lumped.faults.base import ToothFault
from lumped.fields.units import Quantity


class Crack(ToothFault):
    """Crack through the face width, from the fillet of the loaded flank at its 30 degree tangent."""

    kind: Literal["crack"] = Field("crack", description="a crack at the root")
    depth: Annotated[float, Quantity("mm", above=0, at_most=100)] = Field(description="length of the crack")
    angle: Annotated[float, Quantity("deg", above=0, at_most=90)] = Field(
        70.0, description="between the crack and the tooth's centre line"
    )
