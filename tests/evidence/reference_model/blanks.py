"""Mass and polar inertia of a gear by integrating its outline, against the disc that the models take.

The outline has the multibody model's own flanks and tip circles; the fillet between flank and root is the
trochoid of the rack. Sources: Green's theorem on a polygon and Richardson's
extrapolation; docs/theory/multibody.md, "What is own and what is shared".
"""

import math
from dataclasses import dataclass

import numpy as np

from lumped.schema.gear import Gear
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray
from multibody.contact.drawing import base_tooth_angle, circles, masses

#: Points on each of the four parts of half a tooth.
_POINTS = 400


@dataclass(frozen=True)
class Blank:
    """One gear body: mass [kg] and inertia [kg m^2] of its outline and as the simulations take them.

    ``error`` is that of both outline values by the polygon, relative.
    """

    mass: float
    inertia: float
    error: float
    taken_mass: float
    taken_inertia: float


def blanks(pair: GearPair) -> tuple[Blank, Blank]:
    """Bodies of pinion and gear by their outlines, beside what the simulations take."""
    mass, inertia = masses(pair)
    drawn = circles(pair)
    sides = ((pair.pinion, drawn.base_pinion, drawn.tip_pinion), (pair.gear, drawn.base_gear, drawn.tip_gear))
    result = []
    for i, (gear, base, tip) in enumerate(sides):
        coarse, fine = (_integrals(half_tooth(pair, gear, base, tip, n)) for n in (_POINTS, 2 * _POINTS))
        # The polygon errs by the square of its steps: a third of the change is left in the finer one.
        left = (fine - coarse) / 3.0
        area, polar = 2.0 * gear.teeth * (fine + left)
        hole = math.pi * (0.5 * gear.bore) ** 2
        area, polar = area - hole, polar - 0.5 * hole * (0.5 * gear.bore) ** 2
        weight = gear.density * gear.face_width
        error = float(np.abs(left / fine).max())
        result.append(
            Blank(float(weight * area), float(weight * polar), error, float(mass[i]), float(inertia[i]))
        )
    return result[0], result[1]


def half_tooth(pair: GearPair, gear: Gear, base: float, tip: float, points: int) -> FloatArray:
    """Outline of half a tooth and half a space from the gear's centre, closed, (k, 2) [m]."""
    profile = pair.wheels[0 if gear is pair.pinion else 1].tooth
    half = 0.5 * base_tooth_angle(pair, gear, base)
    thinned = profile.base_half_angle - half
    length = np.linspace(math.sqrt(tip**2 - base**2), profile.form_length, points)
    flank_angle, flank_radius = half - length / base + np.arctan(length / base), np.hypot(base, length)
    bottom, joint = profile.fillet_range
    u, h, _ = profile.fillet_points(np.linspace(joint, bottom, points))
    fillet_angle, fillet_radius = np.arctan2(h, u) - thinned, np.hypot(u, h)
    top = np.linspace(0.0, float(flank_angle[0]), points)
    root = np.linspace(float(fillet_angle[-1]), math.pi / gear.teeth, points)
    angle = np.concatenate([top, flank_angle, fillet_angle, root])
    radius = np.concatenate(
        [np.full(points, tip), flank_radius, fillet_radius, np.full(points, fillet_radius[-1])]
    )
    rim = np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=1)
    return np.vstack([np.zeros((1, 2)), rim, np.zeros((1, 2))])


def _integrals(polygon: FloatArray) -> FloatArray:
    """Area and polar second moment of a closed polygon about the origin, (2,) [m^2], [m^4]."""
    a, b = polygon[:-1], polygon[1:]
    cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    spread = np.sum(a * a + a * b + b * b, axis=1)
    return np.array([0.5 * cross.sum(), cross @ spread / 12.0])
