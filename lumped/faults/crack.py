"""A crack at the root of a tooth.

Sources: H. Tada, P. C. Paris and G. R. Irwin, The Stress Analysis of Cracks Handbook, 3rd ed. 2000: rotation
of a strip with an edge crack under bending; docs/theory/teeth.md, "Faults".
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, Literal

import numpy as np
from numpy.polynomial import polynomial
from pydantic import Field

from lumped.errors import FieldProblem
from lumped.faults.base import Flank, ToothFault
from lumped.fields.units import Quantity
from lumped.gear_geometry.tooth_profile import ToothProfile
from lumped.root_in_bracket import root_in_bracket
from lumped.typing import FloatArray

#: Deepest crack over the section's thickness: beyond, neither strip nor cantilever.
_DEEPEST = 0.5
#: Of S(x) = (x/(1 - x))^2 (5.93 - 19.69 x + ...), lowest power first.
_STRIP = (5.93, -19.69, 37.14, -35.84, 13.12)


class Crack(ToothFault):
    """Crack through the face width, from the fillet of the loaded flank at its 30 degree tangent."""

    kind: Literal["crack"] = Field("crack", description="a crack at the root")
    depth: Annotated[float, Quantity("mm", above=0, at_most=100)] = Field(description="length of the crack")
    angle: Annotated[float, Quantity("deg", above=0, at_most=90)] = Field(
        70.0, description="between the crack and the tooth's centre line"
    )

    def problems(self, flank: Flank) -> Iterator[FieldProblem]:
        """Yield a crack that is deeper than half the root."""
        thickness = 2.0 * root_section(flank.wheel.tooth)[1]
        largest = _DEEPEST * thickness / math.sin(self.angle)
        if self.depth > largest:
            allowed = f"<= {largest * 1e3:.4g} mm, half the root of {thickness * 1e3:.4g} mm at this angle"
            yield FieldProblem("depth", f"{self.depth * 1e3:g} mm", allowed, "Lower the depth.")

    def compliance(self, flank: Flank, length: FloatArray) -> FloatArray:
        """Return the compliance (n,) of an edge crack in a strip as thick as the root [m/N]."""
        u, half = root_section(flank.wheel.tooth)
        at_u, at_h, _, angle = flank.wheel.tooth.involute_points(np.asarray(length, dtype=float))
        arm = np.cos(angle) * (at_u - u) - np.sin(angle) * at_h
        x = self.depth * math.sin(self.angle) / (2.0 * half)
        strip = (x / (1.0 - x)) ** 2 * float(polynomial.polyval(x, _STRIP))
        scale = 24.0 / (flank.youngs_modulus * flank.face_width * (2.0 * half) ** 2) * strip
        return np.asarray(arm**2 * scale, dtype=np.float64)


def root_section(tooth: ToothProfile) -> tuple[float, float]:
    """Place u on the centre line and half thickness h where the fillet is at 30 degrees to this line [m]."""
    bottom, top = tooth.fillet_range

    def slope(roll: float) -> float:
        u, h, _ = tooth.fillet_points(roll + 1e-6 * (top - bottom) * np.array([-1.0, 1.0]))
        return float((h[0] - h[1]) / (u[1] - u[0])) - math.tan(math.radians(30.0))

    low = bottom + 1e-5 * (top - bottom)
    high = top - 1e-5 * (top - bottom)
    # A fillet whose slope stays below or above 30 degrees has its critical section at that end.
    ends = slope(low), slope(high)
    roll = root_in_bracket(slope, low, high) if ends[0] * ends[1] < 0.0 else (high if ends[0] > 0.0 else low)
    u, h, _ = tooth.fillet_points(np.array([roll]))
    return float(u[0]), float(h[0])
