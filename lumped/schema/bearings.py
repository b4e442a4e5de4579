"""Schema of the springs that stand for shafts, bearings and housing in the 6-DOF model."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from lumped.fields.section import Section
from lumped.fields.units import Quantity

#: From a hair to a bearing that is rigid beside any tooth.
_STIFFNESS = Quantity("N/m", at_least=1e-6, at_most=1e30)


class Bearing(Section):
    """Radial support of one gear, along (LOA) and off (OLOA) the line of action."""

    loa_stiffness: Annotated[float, _STIFFNESS] = Field(description="stiffness along the LOA")
    oloa_stiffness: Annotated[float, _STIFFNESS] = Field(description="stiffness off the LOA")
    loa_damping_ratio: Annotated[float, Quantity("1", at_least=0, at_most=2)] = Field(
        description="damping ratio of the gear mass on the LOA stiffness"
    )
    oloa_damping_ratio: Annotated[float, Quantity("1", at_least=0, at_most=2)] = Field(
        description="damping ratio of the gear mass on the OLOA stiffness"
    )


class Bearings(Section):
    """Bearings of both shafts."""

    pinion: Bearing
    gear: Bearing
