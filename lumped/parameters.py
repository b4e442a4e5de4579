"""The schema of a gear pair: one frozen, validated, hashable model shared by every part of spurcheck.

Values are SI inside. In files and keyword arguments a bare number means the field's stated unit and a string
may carry any unit of that dimension (``lumped.units``).
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, PlainSerializer, model_validator
from pydantic_core import PydanticCustomError

from lumped.contact_parameters import Friction, FrictionLaw, Lubricant, ViscosityLaw
from lumped.gear_parameters import BasicRack, Gear, ProfileRelief
from lumped.mesh_parameters import Mesh
from lumped.section import Section, Text
from lumped.units import Quantity


class Bearing(Section):
    """Radial support of one gear, along (LOA) and off (OLOA) the line of action."""

    loa_stiffness: Annotated[float, Quantity("N/m", above=0)] = Field(description="stiffness along the LOA")
    oloa_stiffness: Annotated[float, Quantity("N/m", above=0)] = Field(description="stiffness off the LOA")
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


_BRAKE = Quantity("N*m", above=0, action="Correct the value, or write 'balanced'.")


def _brake(value: object) -> object:
    if value == "balanced":
        return value
    try:
        return _BRAKE.parse(value)
    except PydanticCustomError as error:
        context = error.context or {}
        allowed = f"{context['allowed']} or 'balanced'"
        raise PydanticCustomError(
            "quantity", "{value}: allowed {allowed}", context | {"allowed": allowed}
        ) from None


class OperatingPoint(Section):
    """Where the pair runs. The pinion drives, in its positive sense."""

    pinion_speed: Annotated[
        float,
        Quantity(
            "rpm",
            above=0,
            at_most=200000,
            action="Give the running speed; the pinion drives in its positive sense.",
        ),
    ] = Field(description="nominal speed of the pinion")
    pinion_torque: Annotated[float, Quantity("N*m", above=0)] = Field(description="torque driving the pinion")
    brake_torque: Annotated[
        Literal["balanced"] | float, BeforeValidator(_brake, json_schema_input_type=float | str)
    ] = Field(
        "balanced",
        description="torque braking the gear [N*m], or 'balanced': no drift of the mean speed",
        json_schema_extra={"unit": "N*m", "si_unit": "N*m"},
    )


#: Fields that a file may give in another form -> the field that is kept.
STORED_AS = {"basic_rack.diametral_pitch": "basic_rack.module"}


def _sources_in(value: object) -> object:
    if not isinstance(value, dict):
        return value
    return tuple(sorted((STORED_AS.get(path, path), text) for path, text in value.items()))


Sources = Annotated[
    tuple[tuple[str, str], ...],
    BeforeValidator(_sources_in, json_schema_input_type=dict[str, str]),
    PlainSerializer(dict, return_type=dict[str, str]),
]


class GearPair(Section):
    """A spur gear pair with everything that spurcheck needs to know about it."""

    name: Text = Field(min_length=1, max_length=80, description="short name")
    description: Text = Field("", max_length=2000, description="what this pair is")
    basic_rack: BasicRack
    pinion: Gear = Field(description="the driving gear")
    gear: Gear = Field(description="the driven gear")
    centre_distance: Annotated[float | None, Quantity("mm", above=0, optional=True)] = Field(
        None, description="centre distance; default free of backlash for the profile shifts"
    )
    bearings: Bearings
    mesh: Mesh
    lubricant: Lubricant
    friction: Friction
    operating: OperatingPoint
    sources: Sources = Field((), description="field path -> where its value comes from, or 'assumed'")

    @model_validator(mode="after")
    def _must_exist(self) -> GearPair:
        from lumped.gear_geometry import check_geometry
        from lumped.schema_errors import check_sources

        check_geometry(self)
        check_sources(self)
        return self

    def to_mapping(self) -> dict[str, Any]:
        """Return the pair as nested plain data for TOML or JSON; reading it back gives an equal pair."""
        from lumped.serialise import to_mapping

        return to_mapping(self)

    def to_toml(self) -> str:
        """Return the pair as TOML text; reading it back gives an equal pair."""
        import tomli_w

        return tomli_w.dumps(self.to_mapping())

    def with_(self, changes: dict[str, Any] | None = None, /, **fields: Any) -> GearPair:
        """Return a validated variation of this pair.

        Parameters
        ----------
        changes : dotted field paths -> values, e.g. ``{"operating.pinion_speed": "2000 rpm"}``
        **fields : the same with ``__`` for the dot: ``operating__pinion_speed=2000``. A bare number means
            the field's stated unit; a dict replaces a whole section; ``None`` restores the default.

        Raises
        ------
        ParameterError : an unknown path or a value that a file could not have either
        """
        from lumped.serialise import varied

        return varied(self, {**(changes or {}), **{key.replace("__", "."): v for key, v in fields.items()}})


def stated_unit(path: str) -> str | None:
    """Return the stated unit of a field by dotted path, or None where the field has none."""
    from lumped.schema_errors import field_at

    info = field_at(path)
    for marker in info.metadata:
        if isinstance(marker, Quantity):
            return marker.unit
    # A quantity that may also be a word has its unit in the JSON Schema alone.
    extra = info.json_schema_extra
    return str(extra["unit"]) if isinstance(extra, dict) and "unit" in extra else None


__all__ = [
    "BasicRack",
    "Bearing",
    "Bearings",
    "Friction",
    "FrictionLaw",
    "Gear",
    "GearPair",
    "Lubricant",
    "Mesh",
    "OperatingPoint",
    "ProfileRelief",
    "Section",
    "ViscosityLaw",
    "stated_unit",
]
