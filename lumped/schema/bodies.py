"""Masses, inertias and the effective mesh mass of a gear pair.

Sources: solid discs, elementary; the effective mass 1/m_e = r_bp^2/J_p + r_bg^2/J_g closes the equations on
r_bp theta_p - r_bg theta_g (docs/theory/equations.md).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from lumped.display.result import DisplayedResult
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.gear import Gear
from lumped.schema.pair import GearPair


@dataclass(frozen=True, repr=False)
class Bodies(DisplayedResult):
    """Rigid-body properties, SI.

    Attributes
    ----------
    mass_pinion, mass_gear : [kg]
    inertia_pinion, inertia_gear : polar moments about the own axis [kg m^2]
    effective_mass : m_e with 1/m_e = r_bp^2/J_p + r_bg^2/J_g [kg]
    """

    mass_pinion: float
    mass_gear: float
    inertia_pinion: float
    inertia_gear: float
    effective_mass: float


def solid_disc(radius: float, width: float, density: float, bore: float = 0.0) -> tuple[float, float]:
    """Mass [kg] and polar moment [kg m^2] of a disc; lengths in m, ``bore`` a diameter."""
    inner = 0.5 * bore
    mass = density * math.pi * (radius**2 - inner**2) * width
    return mass, 0.5 * mass * (radius**2 + inner**2)


def bodies(pair: AnyPair) -> Bodies:
    """Return masses and inertias: the inputs, otherwise of a disc of reference diameter and face width."""
    return bodies_of(load_gear_pair(pair))


def bodies_of(pair: GearPair) -> Bodies:
    """``bodies`` of a pair that is loaded."""
    g = pair.geometry
    m_p, j_p = _resolved(pair.pinion, g.reference_radius_pinion)
    m_g, j_g = _resolved(pair.gear, g.reference_radius_gear)
    effective = 1.0 / (g.base_radius_pinion**2 / j_p + g.base_radius_gear**2 / j_g)
    return Bodies(m_p, m_g, j_p, j_g, effective)


def _resolved(gear: Gear, radius: float) -> tuple[float, float]:
    mass, inertia = solid_disc(radius, gear.face_width, gear.density, gear.bore)
    return mass if gear.mass is None else gear.mass, inertia if gear.inertia is None else gear.inertia
