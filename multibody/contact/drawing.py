"""What the drawing of a gear pair says as plain numbers: circles, tooth thickness, reliefs, bodies, bearings.

Everything is derived here again from the fields of the schema: nothing reads ``pair.geometry`` or
``lumped.bodies``, so that agreement of the two models is evidence for both. Sources: ISO 21771 for the
circles; solid discs, elementary.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from lumped.schema.gear import Gear
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray

#: Largest operating pressure angle that is looked for [rad].
_STEEPEST = 1.4


@dataclass(frozen=True)
class Circles:
    """Circles and path of contact of a pair: base radii, base pitch, tip radii, centre distance [m]."""

    base_pinion: float
    base_gear: float
    pitch: float
    tip_pinion: float
    tip_gear: float
    centre_distance: float

    @property
    def reach_pinion(self) -> float:
        """Length on the pinion's base tangent from X to its tip circle: L_XD."""
        return math.sqrt(self.tip_pinion**2 - self.base_pinion**2)

    @property
    def reach_gear(self) -> float:
        """Length on the gear's base tangent from Y to its tip circle: L_XY - L_XA."""
        return math.sqrt(self.tip_gear**2 - self.base_gear**2)

    @property
    def tangent(self) -> float:
        """Length L_XY of the line of action between the base circles."""
        return math.sqrt(self.centre_distance**2 - (self.base_pinion + self.base_gear) ** 2)


def circles(pair: GearPair) -> Circles:
    """Circles of a pair."""
    rack = pair.basic_rack
    cosine = math.cos(rack.pressure_angle)
    r_p, r_g = (0.5 * rack.module * gear.teeth * cosine for gear in (pair.pinion, pair.gear))
    centre = pair.centre_distance
    return Circles(
        base_pinion=r_p,
        base_gear=r_g,
        pitch=math.pi * rack.module * cosine,
        tip_pinion=_tip_radius(pair, pair.pinion),
        tip_gear=_tip_radius(pair, pair.gear),
        centre_distance=_close_mesh(pair, r_p + r_g) if centre is None else centre,
    )


def masses(pair: GearPair) -> tuple[FloatArray, FloatArray]:
    """Masses [kg] and polar inertias [kg m^2] of pinion and gear, each (2,).

    Given values are taken; a body without is a disc of the reference diameter with the gear's own face width
    and bore, as the schema says.
    """
    bodies = [_disc(pair, gear) for gear in (pair.pinion, pair.gear)]
    return np.array([mass for mass, _ in bodies]), np.array([inertia for _, inertia in bodies])


def bearing_constants(pair: GearPair, mass: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Stiffness [N/m] and damping [N s/m] of the bearings, each (2, 2): rows pinion, gear; columns x, y.

    x is along the line of action and y off it; d = 2 zeta sqrt(k m) is the damping of one mass on one spring.
    """
    stiffness, damping = np.empty((2, 2)), np.empty((2, 2))
    for row, bearing in enumerate((pair.bearings.pinion, pair.bearings.gear)):
        stiffness[row] = bearing.loa_stiffness, bearing.oloa_stiffness
        ratio = np.array([bearing.loa_damping_ratio, bearing.oloa_damping_ratio])
        damping[row] = 2.0 * ratio * np.sqrt(stiffness[row] * mass[row])
    return stiffness, damping


def reliefs(pair: GearPair, drawn: Circles) -> list[tuple[float, float, float, float, float]]:
    """Reliefs that act: gear (0 pinion, 1 gear), roll angles of start and end [rad], amount [m], power.

    A tip relief ends at the tip, a root relief where the mate's tip touches last. Without
    ``mesh.relief = "static"`` none acts.
    """
    rows = []
    for which, gear, base, tip, mate in (
        (0.0, pair.pinion, drawn.base_pinion, drawn.reach_pinion, drawn.reach_gear),
        (1.0, pair.gear, drawn.base_gear, drawn.reach_gear, drawn.reach_pinion),
    ):
        for relief, end in ((gear.tip_relief, tip), (gear.root_relief, drawn.tangent - mate)):
            if pair.mesh.relief == "static" and relief is not None and relief.amount != 0.0:
                power = 1.0 if relief.shape == "linear" else 2.0
                rows.append((which, relief.start_roll_angle, end / base, relief.amount, power))
    return rows


def base_tooth_angle(pair: GearPair, gear: Gear, base: float) -> float:
    """Angle between both flanks of a tooth on the base circle, thinned by its share of the backlash [rad]."""
    rack = pair.basic_rack
    alpha = rack.pressure_angle
    at_reference = (0.5 * math.pi + 2.0 * gear.profile_shift * math.tan(alpha)) / (0.5 * gear.teeth)
    return at_reference + 2.0 * (math.tan(alpha) - alpha) - 0.5 * pair.mesh.backlash / base


def _tip_radius(pair: GearPair, gear: Gear) -> float:
    if gear.tip_diameter is not None:
        return gear.tip_diameter / 2.0
    module, addendum = pair.basic_rack.module, gear.addendum
    if addendum is None:
        addendum = (pair.basic_rack.addendum_coefficient + gear.profile_shift) * module
    return module * gear.teeth / 2.0 + addendum


def _close_mesh(pair: GearPair, base: float) -> float:
    """Centre distance at which the teeth, as the rack cuts them, mesh without backlash [m]."""
    alpha, teeth = pair.basic_rack.pressure_angle, pair.pinion.teeth + pair.gear.teeth
    shift = pair.pinion.profile_shift + pair.gear.profile_shift

    def gap(angle: float) -> float:
        grown = (math.tan(angle) - angle) - (math.tan(alpha) - alpha)
        return grown - 2.0 * shift / teeth * math.tan(alpha)

    if shift == 0.0:
        return base / math.cos(alpha)
    return base / math.cos(float(brentq(gap, 0.0, _STEEPEST, xtol=1e-15, rtol=1e-14)))


def _disc(pair: GearPair, gear: Gear) -> tuple[float, float]:
    outer, inner = pair.basic_rack.module * gear.teeth, gear.bore  # diameters
    mass = 0.25 * math.pi * (outer**2 - inner**2) * gear.face_width * gear.density
    inertia = math.pi / 32.0 * (outer**4 - inner**4) * gear.face_width * gear.density
    return (mass if gear.mass is None else gear.mass), (inertia if gear.inertia is None else gear.inertia)
