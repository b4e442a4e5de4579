"""What faults of a tooth share: their section of the parameter file, and what they do to the contact.

Sources: docs/theory/teeth.md, "Faults".
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from pydantic import Field

from lumped.errors import FieldProblem
from lumped.fields.section import Section
from lumped.gear_geometry.geometry import Wheel
from lumped.typing import FloatArray


@dataclass(frozen=True)
class Flank:
    """The loaded flank of a tooth in its mesh, SI; places on it are lengths along the own base tangent [m].

    Attributes
    ----------
    wheel : the gear as it is cut
    tip, start : lengths of its tip, and of where the mate's tip touches it first or an undercut ends it [m]
    face_width : common to both gears [m]
    youngs_modulus : of the gear [Pa]
    hertz : linear compliance of the Hertzian contact over the whole face width [m/N]
    """

    wheel: Wheel
    tip: float
    start: float
    face_width: float
    youngs_modulus: float
    hertz: float

    def length(self, roll: float) -> float:
        """Length [m] of a roll angle [rad]."""
        return roll * self.wheel.tooth.base_radius


class ToothFault(Section):
    """Base of the faults: the entry of ``faults`` with what it changes; by default nothing."""

    kind: str
    tooth: int = Field(ge=1, le=1000, strict=True, description="number of the tooth, in order of engagement")

    def problems(self, flank: Flank) -> Iterator[FieldProblem]:
        """Values that do not fit this tooth, each with its field below the fault's own."""
        yield from ()

    def compliance(self, flank: Flank, length: FloatArray) -> FloatArray:
        """Compliance that it adds at places (n,) of the flank, (n,) [m/N]."""
        return np.zeros(np.shape(length))

    def gap(self, flank: Flank, length: FloatArray) -> FloatArray:
        """Material missing at places (n,) of the flank, (n,) [m]."""
        return np.zeros(np.shape(length))

    def kinks(self, flank: Flank) -> tuple[float, ...]:
        """Places where ``compliance`` or ``gap`` jumps or has a kink [m]."""
        return ()

    def end(self, flank: Flank) -> float:
        """Place where the flank ends [m]: a corner that is left is the tip of this tooth."""
        return flank.tip
