"""A spall: a pit in the flank."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from lumped.errors import FieldProblem, refuse
from lumped.faults.base import Flank, ToothFault
from lumped.fields.units import Quantity
from lumped.typing import BoolArray, FloatArray

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

    def problems(self, flank: Flank) -> Iterator[FieldProblem]:
        """Yield a pit that is wider than the flank."""
        if self.width is not None and self.width > flank.face_width:
            allowed = f"<= {flank.face_width * 1e3:g} mm, the face width in contact"
            yield FieldProblem("width", f"{self.width * 1e3:g} mm", allowed, "Lower the width.")

    def compliance(self, flank: Flank, length: FloatArray) -> FloatArray:
        """Return the compliance of the Hertzian contact, which the pit makes narrower.

        The tooth is not weaker.
        """
        if self._whole(flank):
            return np.zeros(np.shape(length))
        assert self.width is not None  # it is not the whole width
        more = flank.hertz * self.width / (flank.face_width - self.width)
        return np.asarray(more * self._inside(flank, length), dtype=np.float64)

    def gap(self, flank: Flank, length: FloatArray) -> FloatArray:
        """Return the depth of a pit over the whole face width; 0 beside a narrower pit [m]."""
        depth = self.pit_depth if self._whole(flank) else 0.0
        return np.asarray(depth * self._inside(flank, length), dtype=np.float64)

    def kinks(self, flank: Flank) -> tuple[float, ...]:
        """Return the places of both ends of the pit [m]."""
        return flank.length(self.start_roll_angle), flank.length(self.end_roll_angle)

    def _whole(self, flank: Flank) -> bool:
        return self.width is None or self.width >= flank.face_width

    def _inside(self, flank: Flank, length: FloatArray) -> BoolArray:
        low, high = self.kinks(flank)
        return np.asarray((length >= low) & (length < high))
