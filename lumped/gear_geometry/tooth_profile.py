"""True profile of a rack-generated tooth: involute and fillet trochoid, in the tooth's own axes.

Axes: u along the tooth's centre line, from the gear's centre outwards; h across the centre line: the tooth's
section at u is 2 h wide. Both flanks are equal. References: ISO 21771 for the involute and the tooth
thickness; the fillet is the envelope of the rack's tip circle (see ``ToothProfile.trochoid``).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lumped.root_in_bracket import root_in_bracket
from lumped.typing import FloatArray


def involute(angle: float) -> float:
    """Return inv(angle) = tan(angle) - angle [rad].

    >>> round(involute(math.radians(20.0)), 6)
    0.014904
    """
    return math.tan(angle) - angle


def inverse_involute(value: float) -> float:
    """Return the angle [rad] in [0, 1.5] whose involute is ``value`` >= 0.

    >>> round(math.degrees(inverse_involute(0.014904)), 3)
    20.0
    """
    return float(root_in_bracket(lambda angle: involute(angle) - value, 0.0, 1.5, xtol=1e-15, rtol=1e-15))


def tooth_half_angle(teeth: int, profile_shift: float, pressure_angle: float, radius_angle: float) -> float:
    """Half the tooth's thickness at a radius, as an angle at the gear centre [rad].

    ``radius_angle`` is the profile angle arccos(r_b / r) at the radius r, ``pressure_angle`` the pressure
    angle of the basic rack [rad].
    """
    reference = (0.5 * math.pi + 2.0 * profile_shift * math.tan(pressure_angle)) / teeth
    return reference + involute(pressure_angle) - involute(radius_angle)


#: Least distance of the centre of the rack's tip circle from the pitch line [modules].
_OFF = 1e-6


@dataclass(frozen=True)
class ToothProfile:
    """A tooth cut by a basic rack. Flank and fillet are functions of one parameter each.

    Lengths in m, angles in rad. ``dedendum`` is the dedendum and ``fillet`` the tip radius of the rack, both
    over module.
    """

    teeth: int
    module: float
    pressure_angle: float
    profile_shift: float
    dedendum: float
    fillet: float

    @property
    def reference_radius(self) -> float:
        """Radius of the circle on which the rack's pitch line rolls [m]."""
        return 0.5 * self.module * self.teeth

    @property
    def base_radius(self) -> float:
        """Radius of the base circle [m]."""
        return self.reference_radius * math.cos(self.pressure_angle)

    @property
    def rack_tip(self) -> tuple[float, float, float]:
        """Tip radius; half distance of the tip circles' centres; depth of both below the pitch line [m]."""
        radius = self.fillet * self.module
        centre_depth = self.dedendum - self.fillet
        half_width = self.module * (0.25 * math.pi - centre_depth * math.tan(self.pressure_angle))
        half_width -= radius / math.cos(self.pressure_angle)
        down = self.module * (self.dedendum - self.profile_shift) - radius
        # On the pitch line the whole tip would be cut at one roll angle.
        return radius, half_width, down if abs(down) > _OFF * self.module else _OFF * self.module

    @property
    def fillet_rolls(self) -> tuple[float, float]:
        """Generating roll angles of the fillet at the root circle and at the rack's straight flank [rad]."""
        _, half_width, down = self.rack_tip
        bottom = half_width / self.reference_radius
        return bottom, bottom - down / (self.reference_radius * math.tan(self.pressure_angle))

    def trochoid(self, roll: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Fillet cut by the rack's rounded tip at roll angles, in axes that turn with the roll.

        The rack's pitch line rolls on the reference circle. The normal of the tip circle's envelope passes
        through the pitch point. The cut point therefore lies on the line from the pitch point through the
        centre of the tip circle: beyond the centre, or before the centre where a large profile shift lifts
        the centre above the pitch line.

        Returns x and y, across and along the line from the gear's centre to the pitch point [m]. The angle of
        the cut point from the centre line of the space is arctan2(x, y) + roll.
        """
        radius, half_width, down = self.rack_tip
        along = half_width - self.reference_radius * roll
        stretch = 1.0 + math.copysign(radius, down) / np.hypot(along, down)
        return along * stretch, self.reference_radius - down * stretch

    @cached_property
    def form_length(self) -> float:
        """Length along the base tangent at which the involute begins [m].

        Where the rack undercuts the flank, the involute begins at the crossing with the fillet's trochoid.
        The crossing is computed numerically.
        """
        return self.undercut_length if self._undercut else max(self._joint_length, 0.0)

    @property
    def _joint_length(self) -> float:
        """Length at which the rack's straight flank ends [m]; negative beyond the tangent point."""
        sine = math.sin(self.pressure_angle)
        flank_depth = self.dedendum - self.fillet * (1.0 - sine)
        return self.reference_radius * sine - (flank_depth - self.profile_shift) * self.module / sine

    @property
    def _undercut(self) -> bool:
        # A shorter undercut moves the form radius by less than 1e-9 modules.
        return self._joint_length < -1e-4 * self.module

    @cached_property
    def undercut_length(self) -> float:
        """Length along the base tangent at which an undercut ends the involute in an edge [m].

        The length is 0 where the fillet joins the flank smoothly.
        """
        return self._crossing_length() if self._undercut else 0.0

    def _crossing_length(self) -> float:
        """Length at which the fillet's trochoid crosses the involute of an undercut tooth [m].

        The trochoid climbs from the root circle to the joint with the rack's straight flank, beyond the
        tangent point. The trochoid is inside the tooth at the base circle and outside at the joint: trochoid
        and involute cross once.
        """
        r_base = self.base_radius
        bottom, joint = self.fillet_rolls

        def radius(roll: float) -> float:
            return float(np.hypot(*self.trochoid(np.array(roll))))

        def depth(roll: float) -> float:
            """Angle by which the trochoid is inside the tooth."""
            x, y = self.trochoid(np.array(roll))
            profile = math.acos(min(1.0, r_base / radius(roll)))
            half = tooth_half_angle(self.teeth, self.profile_shift, self.pressure_angle, profile)
            return float(np.arctan2(x, y)) + roll - (math.pi / self.teeth - half)

        base = root_in_bracket(lambda roll: radius(roll) - r_base, bottom, joint, xtol=1e-15)
        if depth(base) <= 0.0:
            return 0.0
        # By rounding the depth may vanish at a joint close to the base circle. The crossing is then the
        # joint.
        crossing = joint if depth(joint) >= 0.0 else root_in_bracket(depth, base, joint, xtol=1e-15)
        return math.sqrt(max(radius(crossing) ** 2 - r_base**2, 0.0))

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
        return bottom, float(root_in_bracket(excess, bottom, joint, xtol=1e-14))

    def involute_points(self, length: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        """Points u, h of the involute at lengths L along the base tangent [m], any shape; du/dL [-]; angle a.

        a = L/r_b - base_half_angle is the angle between the flank's normal and the normal to the centre line,
        positive where the load pushes towards the root. du/dL = (L/r_b) cos(a).
        """
        load_angle = length / self.base_radius - self.base_half_angle
        u = self.base_radius * np.cos(load_angle) + length * np.sin(load_angle)
        h = length * np.cos(load_angle) - self.base_radius * np.sin(load_angle)
        return u, h, length / self.base_radius * np.cos(load_angle), load_angle

    def fillet_points(self, roll: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Points u, h [m] of the fillet and slope du/dphi [m/rad] at generating roll angles phi, any shape.

        ``roll`` is 0 where the rack's tooth is centred in the space.
        """
        x, y = self.trochoid(roll)
        radius, half_width, down = self.rack_tip
        r = self.reference_radius
        along = half_width - r * roll
        distance = np.hypot(along, down)
        radius = math.copysign(radius, down)
        stretch = 1.0 + radius / distance
        stretch_rate = radius * along * r / distance**3
        x_rate = -r * stretch + along * stretch_rate
        y_rate = -down * stretch_rate
        turn = roll - math.pi / self.teeth
        cosine = np.cos(turn)
        sine = np.sin(turn)
        u = y * cosine - x * sine
        h = -(x * cosine + y * sine)
        return u, h, y_rate * cosine - x_rate * sine - y * sine - x * cosine
