"""Schema of the shafts that bear the gears: segments, bearings and coupled inertias."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Self

from pydantic import Field, model_validator

from lumped.errors import FieldProblem, ParameterError, refuse
from lumped.fields.section import Section
from lumped.fields.units import Quantity

_SIZE = "Give the size as drawn; check the unit."
_PLACE = Quantity("mm", at_least=0, at_most=1e5, action="Measure it from the shaft's end at z = 0.")
#: From a hair to a bearing that is rigid beside any shaft; what is stiffer would cost the others digits.
_STIFFNESS = Quantity("N/m", at_least=1e-6, at_most=1e13)
_DAMPING = Quantity("N*s/m", at_least=0, at_most=1e15)
#: Thinnest wall of a shaft as a share of its diameter: below, sections do not keep their form.
_WALL = 0.01
#: Length over mean diameter is at most this, and at least its inverse.
_SLENDER = 1000.0


class ShaftSegment(Section):
    """A piece of a shaft of constant section."""

    length: Annotated[float, Quantity("mm", at_least=0.01, at_most=20000, action=_SIZE)] = Field(
        description="length"
    )
    diameter: Annotated[float, Quantity("mm", at_least=0.1, at_most=5000, action=_SIZE)] = Field(
        description="outer diameter"
    )
    bore: Annotated[float, Quantity("mm", at_least=0)] = Field(0.0, description="bore diameter; 0 is solid")

    @model_validator(mode="after")
    def _has_a_wall(self) -> Self:
        largest = (1.0 - 2.0 * _WALL) * self.diameter
        if self.bore > largest:
            value = f"{self.bore * 1e3:g} mm"
            allowed = f"<= {largest * 1e3:.6g} mm"
            action = "Lower the bore, or raise the diameter."
            raise refuse("bore", value, f"{allowed}, a wall of {_WALL:.0%} of the diameter", action)
        return self


class ShaftBearing(Section):
    """A bearing with its housing: springs and dampers from a station of the shaft to the ground."""

    position: Annotated[float, _PLACE] = Field(description="from the shaft's end at z = 0")
    loa_stiffness: Annotated[float, _STIFFNESS] = Field(description="radial stiffness along the LOA")
    oloa_stiffness: Annotated[float, _STIFFNESS] = Field(description="radial stiffness off the LOA")
    loa_damping: Annotated[float, _DAMPING] = Field(0.0, description="radial damping along the LOA")
    oloa_damping: Annotated[float, _DAMPING] = Field(0.0, description="radial damping off the LOA")
    tilt_stiffness: Annotated[float, Quantity("N*m/rad", at_least=0, at_most=1e12)] = Field(
        0.0, description="stiffness against tilting, in both planes; needed where a shaft has one bearing"
    )


class Shaft(Section):
    """The shaft of one gear: an elastic beam of segments in bearings.

    The gear is a rigid disc on the beam.
    """

    segments: tuple[ShaftSegment, ...] = Field(
        min_length=1, max_length=60, description="pieces of constant section, from z = 0 on"
    )
    gear_position: Annotated[float, _PLACE] = Field(
        description="middle of the face, from the shaft's end at z = 0"
    )
    bearings: tuple[ShaftBearing, ...] = Field(
        min_length=1, max_length=12, description="at least two, or one with tilt_stiffness"
    )
    youngs_modulus: Annotated[float, Quantity("GPa", at_least=1e-3, at_most=2000)] = Field(
        206.0, description="Young's modulus"
    )
    poisson_ratio: Annotated[float, Quantity("1", at_least=0, below=0.5)] = Field(
        0.3, description="Poisson ratio"
    )
    density: Annotated[float, Quantity("kg/m**3", at_least=10, at_most=30000)] = Field(
        7850.0, description="density"
    )

    @property
    def length(self) -> float:
        """Length of all segments [m]."""
        return sum(segment.length for segment in self.segments)

    @model_validator(mode="after")
    def _is_supported(self) -> Self:
        problems = list(off_shaft(self.gear_position, "gear_position", self.length))
        for number, bearing in enumerate(self.bearings):
            problems += off_shaft(bearing.position, f"bearings.{number}.position", self.length)
        problems += [*self._no_beam(), *self._may_tilt()]
        if problems:
            raise ParameterError(problems)
        return self

    def _no_beam(self) -> Iterator[FieldProblem]:
        """Segments that together are no shaft."""
        mean = sum(s.length * s.diameter for s in self.segments) / self.length
        if not 1.0 / _SLENDER <= self.length / mean <= _SLENDER:
            value = f"{self.length * 1e3:.6g} mm long, mean diameter {mean * 1e3:.6g} mm"
            allowed = f"length over diameter from {1.0 / _SLENDER:g} to {_SLENDER:g}"
            yield FieldProblem("segments", value, allowed, _SIZE)

    def _may_tilt(self) -> Iterator[FieldProblem]:
        """A shaft that turns about a bearing freely, instead of being held."""
        places = [bearing.position for bearing in self.bearings]
        apart = max(places) - min(places)
        if apart < 1e-3 * self.length and not any(bearing.tilt_stiffness for bearing in self.bearings):
            where = f"{len(places)} at {places[0] * 1e3:g} mm"
            allowed = "two bearings at least a thousandth of the shaft apart, or one with tilt_stiffness > 0"
            yield FieldProblem(
                "bearings", where, allowed, "Add a bearing, or say what keeps the shaft from tilting."
            )


class CoupledInertia(Section):
    """A motor or a load: an inertia that turns with a shaft through a coupling elastic in torsion."""

    position: Annotated[float, _PLACE] = Field(description="of the coupling, from the shaft's end at z = 0")
    inertia: Annotated[float, Quantity("kg*m**2", at_least=1e-12, at_most=1e9)] = Field(
        description="polar moment of inertia, about the shaft's axis"
    )
    coupling_stiffness: Annotated[float, Quantity("N*m/rad", at_least=1e-6, at_most=1e12)] = Field(
        description="torsional stiffness of the coupling"
    )
    coupling_damping: Annotated[float, Quantity("N*m*s/rad", at_least=0, at_most=1e12)] = Field(
        0.0, description="torsional damping of the coupling"
    )


class Shafts(Section):
    """Shafts of both gears, in the directions of the contact: x along and y off the LOA."""

    damping_ratio: Annotated[float, Quantity("1", at_least=0, at_most=1)] = Field(
        description="of every elastic mode of a shaft with its gear and coupled inertia in its bearings, "
        "teeth apart; beside the dampers of bearings and couplings"
    )
    max_frequency: Annotated[float | None, Quantity("Hz", at_least=1, at_most=1e7, optional=True)] = Field(
        None,
        description="modes of the shafts with their gears held are kept up to this; default three times the "
        "frequency of both gears turning on teeth of 20 N/(mm um)",
    )
    pinion: Shaft = Field(description="the pinion's shaft")
    gear: Shaft = Field(description="the gear's shaft")
    motor: CoupledInertia | None = Field(
        None, description="takes the driving torque to the pinion's shaft; default: it acts on the pinion"
    )
    load: CoupledInertia | None = Field(
        None, description="takes the braking torque from the gear's shaft; default: it acts on the gear"
    )

    @model_validator(mode="after")
    def _coupled_on_the_shaft(self) -> Self:
        problems: list[FieldProblem] = []
        for name, inertia, shaft in (("motor", self.motor, self.pinion), ("load", self.load, self.gear)):
            if inertia is not None:
                problems += off_shaft(inertia.position, f"{name}.position", shaft.length)
        if problems:
            raise ParameterError(problems)
        return self


def off_shaft(position: float, field: str, length: float) -> Iterator[FieldProblem]:
    """The problem of a position [m] behind the end of a shaft of this length [m]."""
    if position > length * (1.0 + 1e-9):
        allowed = f"from 0 to {length * 1e3:.6g} mm, the length of all segments"
        yield FieldProblem(
            field, f"{position * 1e3:.6g} mm", allowed, "Correct the position, or add a segment."
        )
