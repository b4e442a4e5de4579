"""What friction laws see of a gear pair: the nominal contact, and from which fields each value comes.

This is the only place at which a value of another section (gears, lubricant, operating point) comes to the
friction laws: as a field of ``lumped.friction.base.ContactPath``.

Sources: Abbas Al-Zubaidi 2008, eqs. 5 and 11 to 15 (docs/theory/friction.md).
"""

from __future__ import annotations

import math

from lumped.friction.base import ContactPath
from lumped.gear_geometry.geometry import Geometry
from lumped.lubrication import film
from lumped.schema.contact import Friction, Lubricant
from lumped.schema.gear import Gear

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
    )
