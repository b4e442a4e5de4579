"""Schema of what holds each gear in the 6-DOF model: two springs, or rolling bearings by type and size."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Discriminator, Field, PrivateAttr, Tag, model_validator

from lumped.bearings.rolling import across_ratio, stiffness_along
from lumped.errors import refuse, shown
from lumped.fields.section import Section
from lumped.fields.units import Quantity

#: From a hair to a spring that is rigid beside any tooth.
_SPRING = Quantity("N/m", at_least=1e-6, at_most=1e30)
_RATIO = Quantity("1", at_least=0, at_most=2)
#: What a section of springs has, and one of rolling bearings; dampers are of both.
STIFFNESSES = ("loa_stiffness", "oloa_stiffness")
ROLLING = ("type", "number", "size", "contact_angle", "bearings", "stiffness_factor")
_EITHER = "either loa_stiffness and oloa_stiffness, or type, number and size of rolling bearings"


class Bearing(Section):
    """Radial support of one gear, along (LOA) and off (OLOA) the line of action."""

    tag: ClassVar[str] = "springs"

    loa_stiffness: Annotated[float, _SPRING] = Field(description="stiffness along the LOA")
    oloa_stiffness: Annotated[float, _SPRING] = Field(description="stiffness off the LOA")
    loa_damping_ratio: Annotated[float, _RATIO] = Field(
        description="damping ratio of the gear mass on the LOA stiffness"
    )
    oloa_damping_ratio: Annotated[float, _RATIO] = Field(
        description="damping ratio of the gear mass on the OLOA stiffness"
    )

    @model_validator(mode="before")
    @classmethod
    def _says_how_stiff(cls, data: Any) -> Any:
        if isinstance(data, Mapping) and not any(key.startswith(("loa_s", "oloa_s")) for key in data):
            action = "Add loa_stiffness and oloa_stiffness, or type = 'ball' with number and size."
            raise refuse("loa_stiffness", "missing", _EITHER, action)
        return data


class RollingBearing(Section):
    """Rolling bearings of one gear. The stiffness is estimated at the mesh force of the pair.

    The mesh force lies along the line of action. The bearings are therefore loaded in this direction alone.
    ``lumped.bearings.rolling`` has the formulas.
    """

    tag: ClassVar[str] = "rolling"

    type: Literal["ball", "roller"] = Field(description="rolling elements: balls or rollers")
    number: Annotated[int, Field(ge=4, le=200, strict=True)] = Field(
        description="number of rolling elements of one bearing"
    )
    size: Annotated[float, Quantity("mm", at_least=0.01, at_most=1000)] = Field(
        description="diameter of a ball, or length of a roller"
    )
    contact_angle: Annotated[float, Quantity("deg", at_least=0, at_most=60)] = Field(
        0.0, description="contact angle; 0 is a radial bearing"
    )
    bearings: Annotated[int, Field(ge=1, le=12, strict=True)] = Field(
        2, description="number of bearings of the shaft, which share the mesh force evenly"
    )
    stiffness_factor: Annotated[float, Quantity("1", at_least=1e-3, at_most=1e3)] = Field(
        1.0, description="factor on both stiffnesses, as of the housing in series or of a preload"
    )
    loa_damping_ratio: Annotated[float, _RATIO] = Field(
        0.05, description="damping ratio of the gear mass on the LOA stiffness"
    )
    oloa_damping_ratio: Annotated[float, _RATIO] = Field(
        0.05, description="damping ratio of the gear mass on the OLOA stiffness"
    )
    _load: float = PrivateAttr(math.nan)

    @model_validator(mode="before")
    @classmethod
    def _one_way(cls, data: Any) -> Any:
        for key in STIFFNESSES:
            if isinstance(data, Mapping) and key in data:
                action = f"Remove {key}, or type, number and size."
                value = data[key] if isinstance(data[key], str) else shown(f"{data[key]!r} N/m")
                raise refuse(key, shown(value), _EITHER, action)
        return data

    def under(self, load: float) -> Self:
        """The bearings under a mesh force [N]. The force decides the stiffnesses."""
        loaded = self.model_copy()
        loaded._load = load
        return loaded

    @property
    def loa_stiffness(self) -> float:
        """Stiffness along the LOA of all bearings together, under the mesh force [N/m]; NaN: no pair."""
        load = self._load / self.bearings
        each = stiffness_along(self.type, self.number, self.size, load, self.contact_angle)
        return float(self.bearings * self.stiffness_factor * each)

    @property
    def oloa_stiffness(self) -> float:
        """Stiffness off the LOA of all bearings together, under the mesh force [N/m]; NaN without a pair."""
        return across_ratio(self.type, self.number) * self.loa_stiffness

    @property
    def springs(self) -> dict[str, float]:
        """The section of two springs with the same action as the bearings, in file units."""
        names = [f"{line}_{key}" for key in ("stiffness", "damping_ratio") for line in ("loa", "oloa")]
        return {name: float(getattr(self, name)) for name in names}


def _form(data: Any) -> str:
    """Tag of the section for the data."""
    if isinstance(data, Mapping):
        return RollingBearing.tag if any(key in data for key in ROLLING) else Bearing.tag
    return getattr(data, "tag", Bearing.tag)


#: What holds one gear.
AnyBearing = Annotated[
    Annotated[Bearing, Tag(Bearing.tag)] | Annotated[RollingBearing, Tag(RollingBearing.tag)],
    Discriminator(_form),
]


class Bearings(Section):
    """Bearings of both shafts."""

    pinion: AnyBearing
    gear: AnyBearing

    def under(self, load: float) -> Self:
        """The bearings under a mesh force [N]. Springs do not depend on the force: the same object."""
        by_gear = {"pinion": self.pinion, "gear": self.gear}
        rolling = {name: b.under(load) for name, b in by_gear.items() if isinstance(b, RollingBearing)}
        return self.model_copy(update=rolling) if rolling else self
