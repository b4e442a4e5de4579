"""Schema of friction, and what the friction laws see of a gear pair.

A law reads two things: the fields of the section ``friction``, and the nominal contact,
``lumped.friction.base.ContactPath``. A value of another section (gears, lubricant, operating point) comes to
the laws as a field of the nominal contact, in `nominal_contact` and nowhere else. `FRICTION_FIELDS` says from
which fields of a file each of these values comes. A factor on mu of every law is an entry of `FACTORS`; the
nominal contact has the product of all.

Sources: Abbas Al-Zubaidi 2008, eqs. 5 and 11 to 15 (docs/theory/friction.md).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Self

from pydantic import BeforeValidator, Field, model_validator

from lumped.errors import refuse
from lumped.fields.section import OneOf, Section
from lumped.fields.units import Quantity
from lumped.friction.base import ContactPath, FrictionLaw
from lumped.friction.registry import LAWS, NAMES, NO_TABLE, file_name
from lumped.friction.table import TABLE, FrictionTable
from lumped.gear_geometry.geometry import Geometry
from lumped.lubrication import film
from lumped.schema.contact import Lubricant
from lumped.schema.gear import Gear


def _increasing(value: object) -> object:
    """Three increasing positive numbers; pydantic alone would take booleans and text for numbers."""
    numbers = list(value) if isinstance(value, (list, tuple)) else []
    real = all(isinstance(n, (int, float)) and not isinstance(n, bool) for n in numbers)
    if len(numbers) == 3 and real:
        low, middle, high = numbers
        if 0 < low < middle < high < math.inf:
            return tuple(float(n) for n in numbers)
    raise refuse("", value, "three increasing positive numbers", "Correct the list.")


class Friction(Section):
    """Sliding friction between the teeth: the law and the parameters of all laws (they are compared)."""

    law: Annotated[str, OneOf(NAMES, file_name)] = Field(
        description=", ".join(f"{law.numeral or law.label} {law.name}" for law in LAWS.values())
        + ", table: of the user"
    )
    coefficient: Annotated[float | None, Quantity("1", at_least=0, at_most=1, optional=True)] = Field(
        None, description="mean coefficient of laws I and IV; default the mean of law II over the path"
    )
    sharpness: Annotated[float, Quantity("1/mm", above=0)] = Field(
        50.0, description="Phi of law IV, the steepness of the sign change at the pitch point"
    )
    maximum: Annotated[float, Quantity("1", above=0, at_most=1)] = Field(
        0.2, description="upper bound of law II, which is infinite at the pitch point"
    )
    thresholds: Annotated[tuple[float, float, float], BeforeValidator(_increasing)] = Field(
        (1.0, 4.0, 10.0), description="film parameters at which law V changes: IV | II | III | III"
    )
    composite_roughness: Annotated[float | None, Quantity("um", above=0, optional=True)] = Field(
        None,
        description="composite roughness R_comp of the film parameter; default root sum square of both Ra",
    )
    film_length: Annotated[float, Quantity("mm", above=0)] = Field(
        0.8, description="cut-off length L_x of the roughness filter in the film parameter"
    )
    table: FrictionTable | None = Field(None, description="mu of the user over the path of contact")

    @model_validator(mode="after")
    def _has_its_table(self) -> Self:
        if self.law == TABLE and self.table is None:
            raise refuse("table", None, "a table of mu over the path of contact", NO_TABLE)
        return self

    @property
    def own_law(self) -> FrictionLaw | None:
        """The law of the user's table, where one is given."""
        return None if self.table is None else self.table.law


#: What a friction law may read (``FrictionLaw.reads``), by the names of ``ContactPath`` and
#: ``FrictionSettings`` -> the fields of a parameter file that decide the value; "gears" are both gears. What
#: every pair reads has no entry: positions, speeds and load.
FRICTION_FIELDS: dict[str, tuple[str, ...]] = {
    "coefficient": ("friction.coefficient",),
    "sharpness": ("friction.sharpness",),
    "maximum": ("friction.maximum",),
    "thresholds": ("friction.thresholds",),
    "effective_modulus": ("gears.youngs_modulus", "gears.poisson_ratio"),
    "viscosity": ("lubricant.viscosity", "lubricant.viscosity_law"),
    "pressure_viscosity_k": ("lubricant.pressure_viscosity_k",),
    "pressure_viscosity_s": ("lubricant.pressure_viscosity_s",),
    "roughness": ("gears.roughness",),
    "composite_roughness": ("friction.composite_roughness", "gears.roughness"),
    "film_length": ("friction.film_length",),
}


@dataclass(frozen=True)
class FrictionFactor:
    """A factor on mu of every law, of the table of a user too.

    The factor acts on mu after the law and its bounds. It is the same at every position, speed and load, so
    that switches of mu, parts of a law and the change of mu with speed stay those of the law.

    Attributes
    ----------
    value : (gears, lubricant, friction) -> factor [-], positive
    reads : fields of a parameter file that decide the value; "gears" are both gears
    """

    value: Callable[[tuple[Gear, Gear], Lubricant, Friction], float]
    reads: tuple[str, ...]


#: Every factor on mu. No field of a file is one yet. CONTRIBUTING.md, "A factor on mu of every law", has the
#: steps, tests/lumped/friction/test_factors.py the tests.
FACTORS: tuple[FrictionFactor, ...] = ()


def fields_of_factors() -> set[str]:
    """Fields of a parameter file on which mu of every law depends."""
    return {field for factor in FACTORS for field in factor.reads}


def nominal_contact(
    g: Geometry, gears: tuple[Gear, Gear], lubricant: Lubricant, friction: Friction, torque: float
) -> ContactPath:
    """The nominal contact from the sections of a file, see ``lumped.path_of_contact.contact_path``.

    Parameters
    ----------
    g : geometry of the pair
    gears : pinion and gear
    lubricant, friction : sections of the file
    torque : of the pinion [N m]
    """
    pinion, gear = gears
    composite = friction.composite_roughness
    if composite is None:
        # The surfaces are independent: variances add.
        composite = math.hypot(pinion.roughness, gear.roughness)
    return ContactPath(
        L_XA=g.L_XA,
        L_XP=g.L_XP,
        L_XD=g.L_XD,
        L_XY=g.L_XY,
        omega_pinion=g.omega_pinion,
        omega_gear=g.omega_gear,
        pitch_line_velocity=g.pitch_line_velocity,
        unit_load=torque / (g.face_width * g.base_radius_pinion),
        effective_modulus=film.effective_modulus(
            pinion.youngs_modulus, pinion.poisson_ratio, gear.youngs_modulus, gear.poisson_ratio
        ),
        viscosity=lubricant.dynamic_viscosity,
        pressure_viscosity_k=lubricant.pressure_viscosity_k,
        pressure_viscosity_s=lubricant.pressure_viscosity_s,
        roughness=0.5 * (pinion.roughness + gear.roughness),
        composite_roughness=composite,
        film_length=friction.film_length,
        edge_pinion=g.undercut_pinion,
        edge_gear=g.undercut_gear,
        friction_factor=math.prod((one.value(gears, lubricant, friction) for one in FACTORS), start=1.0),
    )
