"""Schema of the elastic mesh: stiffness, damping, backlash; and of the lubricant."""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from lumped.errors import refuse
from lumped.fields.section import Section
from lumped.fields.units import Quantity, to_file
from lumped.lubrication.viscosity import (
    ZERO_CELSIUS,
    grade_viscosity,
    kinematic_viscosity,
    midpoint,
    oil_density,
    walther_constants,
)
from lumped.schema.oil_grade import grade_of
from lumped.stiffness.registry import AnyStiffness


def _contact(value: object) -> object:
    if value != "paper":
        return value
    warnings.warn(
        "mesh.contact = 'paper' is read as 'prescribed', its name now.", FutureWarning, stacklevel=2
    )
    return "prescribed"


#: What to do with a contact that follows the load and a stiffness that has it already.
_WHOLE = (
    "Write mesh.contact = 'prescribed', or leave it out: the curve is then used as given. If it is the curve "
    "of one tooth pair, write kind = 'pair' in mesh.stiffness: then contact = 'loaded' stays."
)
Tooth = Annotated[int, Field(ge=1, le=1000, strict=True)]


def without_assumed_defaults(data: Any, defaults: Mapping[str, str]) -> Any:
    """Plain data of a pair, without values of the section ``mesh`` that are assumed defaults.

    Parameters
    ----------
    data : of a pair as a file has it; anything else is returned as it is
    defaults : field of the mesh -> its default; ``Mesh.by_stiffness`` of the pair they come from
    """
    if not isinstance(data, Mapping):
        return data
    mesh = data.get("mesh")
    assumed = data.get("assumed")
    if not isinstance(mesh, Mapping) or not isinstance(assumed, Mapping):
        return data
    gone = [
        name
        for name, value in defaults.items()
        if mesh.get(name) == value and assumed.get(f"mesh.{name}") == value
    ]
    if not gone:
        return data
    paths = [f"mesh.{name}" for name in gone]
    return {
        **data,
        "mesh": {name: value for name, value in mesh.items() if name not in gone},
        "assumed": {path: value for path, value in assumed.items() if path not in paths},
    }


class Mesh(Section):
    """The elastic mesh of the tooth pairs."""

    stiffness: AnyStiffness = Field(
        discriminator="model", description="stiffness of a tooth pair over the path of contact"
    )
    stiffness_factor: Annotated[float, Quantity("1", at_least=0.1, at_most=10)] = Field(
        1.0,
        description="factor on the stiffness of a tooth pair that the model gives; not on the stiffness of "
        "ISO 6336-1 in K_v",
    )
    damping_ratio: Annotated[float, Quantity("1", at_least=0, at_most=1)] = Field(
        description="zeta in c_i = 2 zeta sqrt(k_i m_e)"
    )
    relief: Literal["ignored", "static"] = Field(
        "static",
        description="'static': tip and root relief, where given, enter as unloaded error, and a pair touches "
        "where it carries load at the mean torque; 'ignored': perfect involutes from A to D. With a "
        "stiffness of the whole mesh, which has the profile in it, the default is 'ignored'",
    )
    contact: Annotated[Literal["prescribed", "loaded"], BeforeValidator(_contact)] = Field(
        "loaded",
        description="'loaded': a pair touches where its gap closes under the mean load, with its tangent "
        "stiffness there, and the brake balances every loss; 'prescribed': it touches from A to D. With a "
        "stiffness of the whole mesh, which is used as given, the default is 'prescribed'",
    )
    backlash: Annotated[float, Quantity("mm", at_least=0)] = Field(
        0.0, description="normal backlash by tooth thinning, beyond that of the centre distance"
    )
    first_teeth: tuple[Tooth, Tooth] | None = Field(
        None, description="teeth of pinion and gear that are at the start of contact A at t = 0; default 1, 1"
    )

    @model_validator(mode="after")
    def _follows_the_stiffness(self) -> Self:
        """Set the defaults of contact and relief from the stiffness. No other place sets these defaults."""
        for name, value in self.by_stiffness.items():
            if name not in self.model_fields_set:
                self.__dict__[name] = value  # nobody has the section yet
        if self.stiffness.whole_mesh and self.contact == "loaded":
            raise refuse(
                "contact", "loaded", "'prescribed' where mesh.stiffness is that of the whole mesh", _WHOLE
            )
        return self

    @property
    def by_stiffness(self) -> dict[str, str]:
        """Defaults of ``contact`` and ``relief``. The stiffness decides both.

        A stiffness of the whole mesh is load over transmission error. This stiffness includes early contact,
        gaps that share the load, and relief.
        """
        if self.stiffness.whole_mesh:
            return {"contact": "prescribed", "relief": "ignored"}
        return {"contact": "loaded", "relief": "static"}


def _grade(value: object) -> object:
    """The grade in a text. A number is returned unchanged, and checked later."""
    return grade_of(value) if isinstance(value, str) else value


class ViscosityLaw(Section):
    """Dynamic viscosity from temperature (Walther, ASTM D341): of an ISO VG grade, or of two viscosities."""

    iso_vg: Annotated[
        Annotated[int, Field(strict=True)] | None,
        BeforeValidator(_grade, json_schema_input_type=int | str | None),
    ] = Field(
        None,
        description="ISO 3448 viscosity grade, 100 or 'ISO VG 100'; or give the two kinematic viscosities",
    )
    viscosity_index: Annotated[float, Quantity("1", at_least=0, at_most=400)] = Field(
        95.0, description="viscosity index of the grade, ASTM D2270"
    )
    kinematic_viscosity_40: Annotated[
        float | None, Quantity("mm**2/s", at_least=2, at_most=2e4, optional=True)
    ] = Field(None, description="kinematic viscosity at 40 degC, instead of iso_vg")
    kinematic_viscosity_100: Annotated[
        float | None, Quantity("mm**2/s", at_least=1, at_most=2e3, optional=True)
    ] = Field(None, description="kinematic viscosity at 100 degC, instead of iso_vg")
    density: Annotated[float, Quantity("kg/m**3", at_least=500, at_most=1500)] = Field(
        870.0, description="density at 15 degC"
    )
    temperature: Annotated[float, Quantity("degC", at_least=-40, at_most=200)] = Field(
        description="oil temperature in the contact inlet"
    )

    @model_validator(mode="after")
    def _grade_or_two_points(self) -> Self:
        points = (self.kinematic_viscosity_40, self.kinematic_viscosity_100)
        value = [v is not None for v in points]
        if not (all(value) if self.iso_vg is None else not any(value)):
            allowed = "iso_vg, or kinematic_viscosity_40 and kinematic_viscosity_100"
            action = "Give one of the two descriptions"
            if self.iso_vg is None and not any(value):
                temperature = to_file(self.temperature, "degC")
                action += f" with the temperature: {{'iso_vg': 220, 'temperature': {temperature:g}}}"
            raise refuse("iso_vg", self.iso_vg, allowed, action + ".")
        if self.iso_vg is not None:
            midpoint(self.iso_vg)
        with np.errstate(over="ignore"):
            viscosity = self.dynamic_viscosity  # refuses an oil that thickens with heat, or is too thin
        if not math.isfinite(viscosity):
            allowed = "a temperature at which Walther's law gives a viscosity"
            raise refuse("temperature", f"{self.temperature - ZERO_CELSIUS:g} degC", allowed, "Raise it.")
        return self

    @property
    def dynamic_viscosity(self) -> float:
        """Dynamic viscosity at the oil temperature [Pa s]."""
        celsius = self.temperature - ZERO_CELSIUS
        if self.iso_vg is not None:
            nu = float(grade_viscosity(self.iso_vg, celsius, self.viscosity_index))
        else:
            at_40 = self.kinematic_viscosity_40
            at_100 = self.kinematic_viscosity_100
            assert at_40 is not None  # the section has the grade or both viscosities
            assert at_100 is not None
            constants = walther_constants(at_40 * 1e6, 40.0, at_100 * 1e6, 100.0)
            nu = float(kinematic_viscosity(celsius, constants))
        return nu * 1e-6 * float(oil_density(self.density, celsius))


class Lubricant(Section):
    """Lubricant: dynamic viscosity (a number or a law) and pressure-viscosity constants alpha = k eta^s."""

    viscosity: Annotated[float | None, Quantity("mPa*s", at_least=1e-9, at_most=1e5, optional=True)] = Field(
        None, description="dynamic viscosity at the contact inlet"
    )
    viscosity_law: ViscosityLaw | None = Field(
        None, description="viscosity from temperature, instead of viscosity"
    )
    pressure_viscosity_k: Annotated[float, Quantity("1", above=0)] = Field(
        0.010471, description="k in alpha = k eta^s, alpha in mm^2/N, eta in mPa s"
    )
    pressure_viscosity_s: Annotated[float, Quantity("1", at_least=0, at_most=1)] = Field(
        0.1348, description="s in alpha = k eta^s"
    )

    @model_validator(mode="after")
    def _one_viscosity(self) -> Self:
        if (self.viscosity is None) == (self.viscosity_law is None):
            value = "both" if self.viscosity is not None else "neither"
            raise refuse("viscosity", value, "viscosity or viscosity_law", "Give exactly one of them.")
        return self

    @property
    def dynamic_viscosity(self) -> float:
        """Dynamic viscosity at the contact inlet [Pa s]: the input, or the law at the oil temperature."""
        if self.viscosity_law is not None:
            return self.viscosity_law.dynamic_viscosity
        assert self.viscosity is not None  # the section has exactly one of them
        return self.viscosity
