"""Where a rack with rounded tips cuts the involute away, as the multibody model draws it.

Written apart from ``lumped.gear_geometry``. Source: docs/theory/mesh_physics.md, "Undercut and interference".
"""

from __future__ import annotations

import math

import numpy as np
from scipy.optimize import brentq

from lumped.schema.gear import BasicRack

#: Rolls at which the crossing is looked for, and the depth of a cut that counts, in modules.
_ROLLS = 201
_LEAST = 1e-4


def undercut_edge(rack: BasicRack, teeth: int, shift: float) -> float:
    """Length on the base tangent at which an undercut ends the involute [m]; 0: no undercut.

    The trochoid of the rack's tip cuts the involute. Lengths are in modules, and points are complex numbers:
    the gear's centre is 0, and the middle of a tooth space is on the real axis. Rolling by phi moves the
    rack's pitch line by r phi along the pitch circle, and moves the centre of the rack's rounded tip too. The
    tip cuts at the point where the line from the pitch point through this centre leaves the rounding.
    """
    angle = rack.pressure_angle
    radius = 0.5 * teeth
    base = radius * math.cos(angle)
    rounding = rack.fillet_radius_coefficient
    straight = rack.dedendum_coefficient - rounding * (1.0 - math.sin(angle)) - shift  # reach of the flank
    if radius * math.sin(angle) ** 2 >= straight - _LEAST * math.sin(angle):
        return 0.0
    deep = rack.dedendum_coefficient - rounding - shift  # of the centre of the rounding below the pitch line
    if abs(deep) < 1e-6:
        deep = 1e-6
    across = (
        0.25 * math.pi - (rack.dedendum_coefficient - rounding) * math.tan(angle) - rounding / math.cos(angle)
    )
    space = (
        0.5 * math.pi / teeth - 2.0 * shift * math.tan(angle) / teeth
    )  # half the space on the pitch circle

    def cut(roll: float) -> complex:
        pitch_point = radius * np.exp(1j * roll)
        to_centre = (-deep + 1j * (across - radius * roll)) * np.exp(1j * roll)
        return complex(pitch_point + to_centre * (1.0 + math.copysign(rounding, deep) / abs(to_centre)))

    def beside(roll: float) -> float:
        """Angle by which the cut point is inside the tooth, beyond the involute; negative in the space."""
        point = cut(roll)
        turn = math.sqrt(max((abs(point) / base) ** 2 - 1.0, 0.0))
        flank = space - (math.tan(angle) - angle) + (turn - math.atan(turn))
        return float(np.angle(point)) - flank

    bottom = across / radius
    last = bottom - deep / (radius * math.tan(angle))  # where the straight flank takes over
    first = bottom
    if abs(cut(bottom)) < base:
        first = float(brentq(lambda roll: abs(cut(roll)) - base, bottom, last, xtol=1e-15))
    rolls = np.linspace(first, last, _ROLLS)
    inside = np.array([beside(roll) > 0.0 for roll in rolls])
    if not inside.any():
        return 0.0
    end = int(np.flatnonzero(inside)[-1])
    roll = rolls[end]
    if end + 1 < _ROLLS:
        roll = float(brentq(beside, rolls[end], rolls[end + 1], xtol=1e-15))
    return rack.module * math.sqrt(max(abs(cut(roll)) ** 2 - base**2, 0.0))
