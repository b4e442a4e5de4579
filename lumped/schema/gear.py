"""Schema of the gears: basic rack, blank, material, roughness and flank modifications."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Annotated, Self

from pydantic import Field, model_validator

from lumped.errors import FieldProblem, ParameterError, refuse
from lumped.faults.base import Flank
from lumped.faults.registry import AnyFault
from lumped.fields.section import Section
from lumped.fields.units import Quantity
from lumped.gear_geometry.profile_shift import LARGEST_SHIFT, LEAST_SHIFT
from lumped.schema.relief import ProfileRelief
from lumped.schema.teeth import Deviations, Mounting

_MODULUS = "Steel has 206 GPa; write the unit where it is another one: '206000 MPa'."
_SIZE = "Give the size as drawn; check the unit."
#: Fillet radius over module of the standard basic rack (ISO 53, type A).
STANDARD_FILLET = 0.38


class BasicRack(Section):
    """Basic rack of both gears (ISO 53)."""

    module: Annotated[float, Quantity("mm", above=0, at_most=100, action=_SIZE)] = Field(
        description="normal module; for a diametral pitch of 8: '25.4/8 mm'"
    )
    pressure_angle: Annotated[float, Quantity("deg", at_least=10, at_most=35)] = Field(
        20.0, description="pressure angle of the basic rack"
    )
    addendum_coefficient: Annotated[float, Quantity("1", above=0, at_most=2)] = Field(
        1.0, description="addendum over module"
    )
    dedendum_coefficient: Annotated[float, Quantity("1", above=0, at_most=2.5)] = Field(
        1.25, description="dedendum over module"
    )
    fillet_radius_coefficient: Annotated[float, Quantity("1", at_least=0, at_most=0.6)] = Field(
        STANDARD_FILLET,
        description="root fillet radius of the rack over module; default 0.38, or 0.95 of the full tip "
        "radius where the rack's tip has no room for 0.38",
    )

    @property
    def full_radius_coefficient(self) -> float:
        """Full tip radius over module: the rack's tooth has no flat tip. Negative: the tooth is pointed.

        Half the width of the rack's tooth at the tip, over module, is pi/4 - h tan a. A tip radius rho
        between flank and tip needs rho (1 - sin a)/cos a of this half width.
        """
        sine = math.sin(self.pressure_angle)
        cosine = math.cos(self.pressure_angle)
        half_width = 0.25 * math.pi - self.dedendum_coefficient * sine / cosine
        return half_width * cosine / (1.0 - sine)

    @property
    def assumed_fillet(self) -> float:
        """Default fillet radius over module: the value of ISO 53, if this radius fits the rack's tip.

        Otherwise the default is 0.95 of the full tip radius, rounded down to two digits.
        """
        full = self.full_radius_coefficient
        if full >= STANDARD_FILLET:
            return STANDARD_FILLET
        return max(math.floor(95.0 * full) / 100.0, 0.0)

    @model_validator(mode="after")
    def _tip_has_room(self) -> Self:
        if "fillet_radius_coefficient" not in self.model_fields_set:
            self.__dict__["fillet_radius_coefficient"] = self.assumed_fillet
        largest = self.full_radius_coefficient
        if largest < 0.0:
            cosine = math.cos(self.pressure_angle)
            sine = math.sin(self.pressure_angle)
            raise refuse(
                "dedendum_coefficient",
                f"{self.dedendum_coefficient:g}",
                f"<= {0.25 * math.pi * cosine / sine:.4f} at this pressure angle",
                "The rack's teeth are pointed above their tips: lower the dedendum or the pressure angle.",
            )
        if self.fillet_radius_coefficient > largest:
            raise refuse(
                "fillet_radius_coefficient",
                f"{self.fillet_radius_coefficient:g}",
                f"<= {largest:.4f} (full tip radius) for this pressure angle and dedendum",
                "Lower the fillet radius or the dedendum of the rack, or delete the fillet radius: one that "
                "fits is then assumed.",
            )
        return self


class Gear(Section):
    """One gear. Mass and inertia default to a solid steel disc of the reference diameter."""

    teeth: Annotated[int, Field(ge=5, le=1000, strict=True)] = Field(description="number of teeth")
    face_width: Annotated[float, Quantity("mm", at_least=0.01, at_most=2000, action=_SIZE)] = Field(
        description="face width"
    )
    profile_shift: Annotated[
        float | None, Quantity("1", at_least=LEAST_SHIFT, at_most=LARGEST_SHIFT, optional=True)
    ] = Field(
        None,
        description="profile shift coefficient x; default what the centre distance asks for, without one 0",
    )
    addendum: Annotated[float | None, Quantity("mm", above=0, optional=True)] = Field(
        None, description="addendum, reference to tip circle, instead of tip_diameter"
    )
    tip_diameter: Annotated[float | None, Quantity("mm", above=0, optional=True)] = Field(
        None,
        description="tip diameter; default module * (teeth + 2 x + 2 addendum_coefficient) "
        "+ 2 tip_alteration",
    )
    tip_alteration: Annotated[float | None, Quantity("mm", at_least=-100, at_most=100, optional=True)] = (
        Field(
            None,
            description="tip alteration k m, negative shortens the tooth, instead of tip_diameter; default "
            "keeps the clearance of the basic rack; 0 does not shorten",
        )
    )
    bore: Annotated[float, Quantity("mm", at_least=0)] = Field(0.0, description="bore diameter; 0 is solid")
    mass: Annotated[float | None, Quantity("kg", at_least=1e-9, at_most=1e7, optional=True)] = Field(
        None, description="mass; default disc of the reference diameter and face width"
    )
    inertia: Annotated[float | None, Quantity("kg*m**2", at_least=1e-15, at_most=1e9, optional=True)] = Field(
        None, description="polar moment of inertia; default as for mass"
    )
    density: Annotated[float, Quantity("kg/m**3", at_least=10, at_most=30000)] = Field(
        7850.0, description="density, for the disc"
    )
    youngs_modulus: Annotated[float, Quantity("GPa", at_least=1e-6, at_most=2000, action=_MODULUS)] = Field(
        206.0, description="Young's modulus"
    )
    poisson_ratio: Annotated[float, Quantity("1", at_least=0, below=0.5)] = Field(
        0.3, description="Poisson ratio"
    )
    roughness: Annotated[float, Quantity("um", at_least=0, at_most=50)] = Field(
        description="arithmetic mean roughness Ra of the flanks"
    )
    tip_relief: ProfileRelief | None = Field(None, description="material removed towards the tip")
    root_relief: ProfileRelief | None = Field(None, description="material removed towards the root")
    deviations: Deviations | None = Field(None, description="deviations of single teeth; default: all alike")
    mounting: Mounting | None = Field(None, description="how the gear sits on its shaft; default: centred")
    faults: tuple[Annotated[AnyFault, Field(discriminator="kind")], ...] = Field(
        (), max_length=1000, description="damaged teeth"
    )

    @property
    def eccentricity(self) -> float:
        """Of the mounting [m]."""
        return self.mounting.eccentricity if self.mounting else 0.0

    @property
    def has_own_teeth(self) -> bool:
        """Whether its teeth or its turns differ."""
        return self.deviations is not None or self.eccentricity > 0.0 or bool(self.faults)

    def with_relief_on(self, flank: Flank) -> Self:
        """The gear with the roll angles at which the reliefs start on a flank; unchanged if all are stated.

        Raises
        ------
        ParameterError : a relief that does not start on the active flank
        """
        located = {
            f"{end}_relief": relief.on(flank, f"{end}_relief")
            for end, relief in (("tip", self.tip_relief), ("root", self.root_relief))
            if relief is not None and not relief.by_angle
        }
        return self.model_copy(update=located) if located else self

    @model_validator(mode="after")
    def _fits_its_teeth(self) -> Self:
        problems: list[FieldProblem] = []
        if self.deviations is not None:
            for one in self.deviations.problems(self.teeth, self.tip_relief is not None):
                problems.append(replace(one, field=f"deviations.{one.field}"))
            if self.eccentricity > 0.0 and self.deviations.first_order == "eccentricity":
                action = (
                    "The first harmonic of the deviations is an eccentricity already: remove one, or set "
                    "deviations.first_order = 'steps' for pitch errors about the gear's own centre."
                )
                value = f"{self.eccentricity * 1e6:g} um beside deviations"
                problems.append(FieldProblem("mounting.eccentricity", value, "one source", action))
        for number, fault in enumerate(self.faults):
            if fault.tooth > self.teeth:
                allowed = f"1 to {self.teeth}"
                action = "Name a tooth of this gear."
                problems.append(FieldProblem(f"faults.{number}.tooth", f"{fault.tooth}", allowed, action))
        if problems:
            raise ParameterError(problems)
        return self

    @model_validator(mode="after")
    def _one_tip(self) -> Self:
        names = ("addendum", "tip_diameter", "tip_alteration")
        stated = [name for name in names if getattr(self, name) is not None]
        if len(stated) > 1:
            value = f"{getattr(self, stated[-1]) * 1e3:g} mm beside {' and '.join(stated[:-1])}"
            raise refuse(stated[-1], value, f"one of {', '.join(names)}", "Keep one of them.")
        return self
