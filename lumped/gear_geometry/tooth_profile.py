"""True profile of a rack-generated tooth: involute and fillet trochoid, in the tooth's own axes.

Axes: u along the tooth's centre line, from the gear's centre outwards; h across it, so that the tooth's
section at u is 2 h wide. Both flanks are equal. References: ISO 21771 for the involute and the tooth
thickness; the fillet is the envelope of the rack's tip circle (see
``lumped.gear_geometry.involute.RackTooth.trochoid``).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.optimize import brentq

from lumped.gear_geometry.involute import RackTooth, tooth_half_angle
from lumped.typing import FloatArray


@dataclass(frozen=True)
class ToothProfile(RackTooth):
    """One tooth of a gear, flank and fillet as functions of one parameter each."""

    @property
    def root_radius(self) -> float:
        """Radius of the root circle [m]."""
        return self.module * (0.5 * self.teeth - self.dedendum + self.profile_shift)

    @property
    def base_half_angle(self) -> float:
        """Half the tooth's thickness on the base circle, as an angle at the gear's centre [rad]."""
        return tooth_half_angle(self.teeth, self.profile_shift, self.pressure_angle, 0.0)

    @property
    def root_half_angle(self) -> float:
        """Half the tooth's thickness where the fillet meets the root circle, as an angle [rad]."""
        return math.pi / self.teeth - self.fillet_range[0]

    @cached_property
    def fillet_range(self) -> tuple[float, float]:
        """Generating roll angles at the root circle and at the start of the involute [rad]."""
        bottom, joint = self.fillet_rolls
        form = math.hypot(self.base_radius, self.form_length)

        def excess(roll: float) -> float:
            return float(np.hypot(*self.trochoid(np.array(roll)))) - form

        if excess(joint) <= 1e-9 * self.module:  # the joint is the end of the fillet: no undercut
            return bottom, joint
        return bottom, float(brentq(excess, bottom, joint, xtol=1e-14))

    def involute_points(self, length: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Points of the involute at lengths L along the base tangent.

        Parameters
        ----------
        length : L [m], any shape

        Returns
        -------
        u, h : coordinates [m]
        slope : du/dL = (L/r_b) cos(load_angle) [-]
        load_angle : angle between the flank's normal and the normal to the centre line,
            L/r_b - base_half_angle [rad]; positive when the load pushes towards the root
        """
        load_angle = length / self.base_radius - self.base_half_angle
        u = self.base_radius * np.cos(load_angle) + length * np.sin(load_angle)
        h = length * np.cos(load_angle) - self.base_radius * np.sin(load_angle)
        return u, h, length / self.base_radius * np.cos(load_angle), load_angle

    def fillet_points(self, roll: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Points of the fillet at generating roll angles.

        Parameters
        ----------
        roll : angles phi [rad], any shape; 0 where the rack's tooth is centred in the space

        Returns
        -------
        u, h : coordinates [m]
        slope : du/dphi [m/rad]
        """
        x, y = self.trochoid(roll)
        radius, half_width, down = self.rack_tip
        r = self.reference_radius
        along = half_width - r * roll
        distance = np.hypot(along, down)
        stretch, stretch_rate = 1.0 + radius / distance, radius * along * r / distance**3
        x_rate, y_rate = -r * stretch + along * stretch_rate, -down * stretch_rate
        turn = roll - math.pi / self.teeth
        cosine, sine = np.cos(turn), np.sin(turn)
        u, h = y * cosine - x * sine, -(x * cosine + y * sine)
        return u, h, y_rate * cosine - x_rate * sine - y * sine - x * cosine
