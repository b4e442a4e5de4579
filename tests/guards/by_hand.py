"""Lengths and contact of a gear pair from the numbers of its file alone, of which limits are made.

Sources: ISO 21771; equations (11) to (21) of docs/theory. Nothing here calls the program's geometry.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from lumped import GearPair
from lumped.typing import FloatArray
from tests.guards.guard import MATE


def inv(angle: float) -> float:
    return math.tan(angle) - angle


def root_of(function: Callable[[float], float], low: float, high: float) -> float:
    """Zero of a function that rises or falls from low to high, by halving."""
    rises = function(high) > 0.0
    for _ in range(200):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if (function(middle) > 0.0) == rises else (middle, high)
    return 0.5 * (low + high)


class ByHand:
    """One gear of a pair beside its mate [mm, rad]."""

    def __init__(self, pair: GearPair, gear: str) -> None:
        rack = pair.basic_rack
        own = getattr(pair, gear)
        self.pair = pair
        self.gear = gear
        self.m = 1e3 * rack.module
        self.alpha = float(rack.pressure_angle)
        self.dedendum = rack.dedendum_coefficient
        self.fillet = rack.fillet_radius_coefficient
        self.z, self.x = own.teeth, own.profile_shift or 0.0  # none of these pairs takes it from a
        self.r = 0.5 * self.m * self.z
        self.r_b = self.r * math.cos(self.alpha)
        self.r_f = self.r - self.m * (self.dedendum - self.x)
        self.base_pitch = math.pi * self.m * math.cos(self.alpha)
        #: Half the tooth's thickness on the base circle, as an angle.
        self.psi_b = (0.5 * math.pi + 2.0 * self.x * math.tan(self.alpha)) / self.z + inv(self.alpha)

    @property
    def mate(self) -> ByHand:
        return ByHand(self.pair, MATE[self.gear])

    @property
    def r_a(self) -> float:
        """Of the file, else a - r_f of the mate - clearance of the rack, up to the full addendum."""
        own = getattr(self.pair, self.gear)
        rack = self.pair.basic_rack
        if own.tip_diameter is not None:
            return 0.5e3 * float(own.tip_diameter)
        if own.addendum is not None:
            return self.r + 1e3 * float(own.addendum)
        full = self.r + self.m * (rack.addendum_coefficient + self.x)
        if own.tip_alteration is not None:
            return full + 1e3 * float(own.tip_alteration)
        clearance = self.m * (self.dedendum - rack.addendum_coefficient)
        centre = self.base_radii / math.cos(self.operating_angle)
        return min(full, centre - self.mate.r_f - clearance)

    @property
    def base_radii(self) -> float:
        return self.r_b + self.mate.r_b

    @property
    def operating_angle(self) -> float:
        if self.pair.centre_distance is not None:
            return math.acos(self.base_radii / (1e3 * self.pair.centre_distance))
        shift = self.x + self.mate.x
        teeth = self.z + self.mate.z
        involute = inv(self.alpha) + 2.0 * shift * math.tan(self.alpha) / teeth
        return root_of(lambda angle: inv(angle) - involute, 0.0, 1.4)

    @property
    def line(self) -> float:
        """Between the points where the line of action touches both base circles."""
        return self.base_radii * math.tan(self.operating_angle)

    @property
    def tip_length(self) -> float:
        """From the own tangent point to where the own tip leaves contact."""
        return math.sqrt(self.r_a**2 - self.r_b**2)

    @property
    def start_length(self) -> float:
        """From the own tangent point to where the mate's tip begins contact."""
        return self.line - self.mate.tip_length

    @property
    def form_length(self) -> float:
        """From the own tangent point to the lowest involute that the straight flank of the rack cuts."""
        sine = math.sin(self.alpha)
        depth = self.dedendum - self.fillet * (1.0 - sine) - self.x
        return self.r * sine - depth * self.m / sine

    @property
    def pointed_radius(self) -> float:
        """Where both flanks of a tooth meet."""
        return self.r_b / math.cos(root_of(lambda angle: inv(angle) - self.psi_b, 0.0, 1.4))

    def tip_diameter(self, length: float) -> float:
        """Tip diameter of a gear whose tip leaves contact at a length from its tangent point."""
        return 2.0 * math.hypot(self.r_b, length)

    def roll(self, length: float) -> float:
        """Roll angle of a place on the own flank [deg]."""
        return math.degrees(length / self.r_b)


class Contact:
    """The nominal contact of a pair over the path of contact by equations (11) to (21), in SI.

    ``xi``: distances from X [m]; default the 201 positions inside A to D at which ranges are judged.
    """

    def __init__(self, pair: GearPair, xi: FloatArray | None = None) -> None:
        hand = ByHand(pair, "pinion")
        steel = (pair.pinion, pair.gear)
        self.start = 1e-3 * hand.start_length
        self.end = 1e-3 * hand.tip_length
        line = 1e-3 * hand.line
        self.pitch = 1e-3 * hand.r_b * math.tan(hand.operating_angle)
        self.xi = np.linspace(self.start, self.end, 203)[1:-1] if xi is None else xi
        self.width = min(pair.pinion.face_width, pair.gear.face_width)
        omega = float(pair.operating.pinion_speed)
        self.flanks = omega * self.xi, omega * hand.z / hand.mate.z * (line - self.xi)
        self.sliding = np.abs(self.flanks[0] - self.flanks[1])
        self.entraining = self.flanks[0] + self.flanks[1]
        self.pitch_line = omega * 1e-3 * hand.r_b / math.cos(hand.operating_angle)
        self.unit_load = pair.operating.pinion_torque / (1e-3 * hand.r_b) / self.width
        self.radius = self.xi * (line - self.xi) / line
        self.modulus = 2.0 / sum((1.0 - one.poisson_ratio**2) / one.youngs_modulus for one in steel)
        self.pressure = np.sqrt(self.unit_load * self.modulus / (2.0 * math.pi * self.radius))
        self.half_width = np.sqrt(8.0 * self.unit_load * self.radius / (math.pi * self.modulus))
        self.viscosity = float(pair.lubricant.dynamic_viscosity)
        self.roughness = 0.5 * (pair.pinion.roughness + pair.gear.roughness)
        # Of mPa s and mm^2/N to SI.
        k = pair.lubricant.pressure_viscosity_k
        s = pair.lubricant.pressure_viscosity_s
        self.pressure_viscosity = 1e-6 * k * (1e3 * self.viscosity) ** s
        material = self.pressure_viscosity * self.modulus
        speed = self.viscosity * self.entraining / (2.0 * self.modulus * self.radius)
        load = self.unit_load / (self.modulus * self.radius)
        self.film = 3.06 * material**0.56 * speed**0.69 * load**-0.10 * self.radius
        both = math.hypot(pair.pinion.roughness, pair.gear.roughness)
        self.composite = pair.friction.composite_roughness or both
        cut_off = pair.friction.film_length / (2.0 * self.half_width)
        self.film_parameter = self.film / self.composite * np.sqrt(cut_off)

    @property
    def friction_number(self) -> FloatArray:
        """29700 w/(eta v_s v_e^2) of law II, with w in N/mm and eta in mPa s: the factor is 29.7e-3 in SI."""
        return 29700.0 * 1e-6 * self.unit_load / (self.viscosity * self.sliding * self.entraining**2)
