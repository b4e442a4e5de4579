"""The base of the faults of a tooth: their section of the parameter file, and their effect on the contact.

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
    """The loaded flank of a tooth in its mesh, SI. A place on the flank is a length along the base tangent
    [m].

    Attributes
    ----------
    wheel : the gear as it is cut
    tip, start : place of the tip, and place where the mate's tip touches first or an undercut ends the flank
        [m]
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
    """Base of the faults: an entry of ``faults``, with what it changes. By default it changes nothing."""

    kind: str
    tooth: int = Field(ge=1, le=1000, strict=True, description="number of the tooth, in order of engagement")

    def problems(self, flank: Flank) -> Iterator[FieldProblem]:
        """Yield the values that do not fit this tooth, each with the name of its field."""
        yield from ()

    def compliance(self, flank: Flank, length: FloatArray) -> FloatArray:
        """Return the compliance (n,) that the fault adds at places (n,) of the flank [m/N]."""
        return np.zeros(np.shape(length))

    def gap(self, flank: Flank, length: FloatArray) -> FloatArray:
        """Return the missing material (n,) at places (n,) of the flank [m]."""
        return np.zeros(np.shape(length))

    def kinks(self, flank: Flank) -> tuple[float, ...]:
        """Return the places where ``compliance`` or ``gap`` jumps or has a kink [m]."""
        return ()

    def end(self, flank: Flank) -> float:
        """Return the place where the flank ends: the tip corner of this tooth [m]."""
        return flank.tip
