"""A chip: a broken corner of a tooth."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, Literal

from pydantic import Field

from lumped.errors import FieldProblem
from lumped.faults.base import Flank, ToothFault
from lumped.fields.units import Quantity


class Chip(ToothFault):
    """The flank ends at a roll angle. The corner there is the tip corner of this tooth."""

    kind: Literal["chip"] = Field("chip", description="a broken corner")
    roll_angle: Annotated[float, Quantity("deg", at_least=0, at_most=180)] = Field(
        description="roll angle at which the flank ends"
    )

    def problems(self, flank: Flank) -> Iterator[FieldProblem]:
        """Yield a chip that removes all of the flank in contact, or begins beyond the tip."""
        radius = flank.wheel.tooth.base_radius
        low, high = (math.degrees(place / radius) for place in (flank.start, flank.tip))
        if not low < math.degrees(self.roll_angle) <= high:
            value = f"{math.degrees(self.roll_angle):g} deg"
            yield FieldProblem("roll_angle", value, f"{low:.4f} to {high:.4f} deg", "End it on the flank.")

    def end(self, flank: Flank) -> float:
        """Return the place of the edge of the chip [m]."""
        return min(flank.tip, flank.length(self.roll_angle))
