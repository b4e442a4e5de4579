"""Compliance of one tooth and of the contact of two teeth, by formulas of this package.

The tooth is a beam of its drawn section on the root circle: bending with the shear and the shortening of
Timoshenko's beam. The contact is the shortening of a half plane below a Hertzian pressure, from the stresses
on the axis of the pressure. Everything is times face width.

Sources: S. P. Timoshenko, Strength of Materials, for the beam; K. L. Johnson, Contact Mechanics (1985), eqs.
(4.43) to (4.46), for the pressure and the stresses below it.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from lumped.typing import FloatArray
from multibody.elasticity.outline import Outline, Section, fillet, involute, load_angle

#: Shear factor of a rectangular section.
_SHEAR = 1.2
#: Panels of Simpson's rule on the fillet and on the involute.
_PANELS = 120


class Elasticity(NamedTuple):
    """Material of one gear: Young's modulus [Pa] and Poisson's ratio."""

    modulus: float
    poisson: float


def beam_compliance(tooth: Outline, material: Elasticity, length: FloatArray) -> FloatArray:
    """Deflection of a tooth under a unit load, along the load, at lengths (n,) on the base tangent [m^2/N].

    Moment over E I, shear force over G A/1.2 and axial force over E A are integrated from the root circle to
    the load.
    """
    angle = load_angle(tooth, length)[:, None]
    tip = involute(tooth, length[:, None])
    shear_modulus = 0.5 * material.modulus / (1.0 + material.poisson)
    normals = np.linspace(0.5 * math.pi, tooth.fillet_end, 2 * _PANELS + 1)
    steps = tooth.form_length + (length[:, None] - tooth.form_length) * np.linspace(0.0, 1.0, 2 * _PANELS + 1)
    total = np.zeros(length.shape)
    for points, place in ((fillet(tooth, normals), normals[None, :]), (involute(tooth, steps), steps)):
        moment = np.cos(angle) * (tip.height - points.height) - np.sin(angle) * tip.half_thickness
        area = 2.0 * points.half_thickness
        inertia = area**3 / 12.0
        rate = moment**2 / (material.modulus * inertia)
        rate = rate + _SHEAR * np.cos(angle) ** 2 / (shear_modulus * area)
        rate = rate + np.sin(angle) ** 2 / (material.modulus * area)
        total += _simpson(rate * points.rise, place)
    return total


def _simpson(values: FloatArray, places: FloatArray) -> FloatArray:
    """Integrals of rows by Simpson's rule; the places of a row are evenly spaced."""
    width = (places[:, -1] - places[:, 0]) / (places.shape[1] - 1)
    inner = 4.0 * values[:, 1:-1:2].sum(axis=1) + 2.0 * values[:, 2:-1:2].sum(axis=1)
    return np.asarray(width / 3.0 * (values[:, 0] + inner + values[:, -1]), dtype=np.float64)


def contact_depth(tooth: Outline, length: FloatArray) -> FloatArray:
    """Distance along the load from the flank to the middle of the tooth, at lengths on the tangent [m]."""
    point: Section = involute(tooth, length)
    return np.asarray(point.half_thickness / np.cos(load_angle(tooth, length)), dtype=np.float64)


def half_width(
    load: float, place: FloatArray, tangent: float, materials: tuple[Elasticity, Elasticity]
) -> FloatArray:
    """Half width of the contact [m] under a load per face width [N/m], at places on the line of action [m].

    ``tangent`` is the length of the line of action between both base circles.
    """
    radius = 1.0 / (1.0 / place + 1.0 / (tangent - place))
    plane_modulus = 1.0 / sum((1.0 - one.poisson**2) / one.modulus for one in materials)
    return np.asarray(2.0 * np.sqrt(load * radius / (math.pi * plane_modulus)), dtype=np.float64)


def shortening(half: FloatArray, depth: FloatArray, material: Elasticity) -> FloatArray:
    """Shortening of a half plane down to a depth, over the load, below a pressure of this half width [m^2/N].

    On the axis of the pressure the stresses are -p b/sqrt(b^2 + z^2) along z and
    -p ((b^2 + 2 z^2)/(b sqrt(b^2 + z^2)) - 2 z/b) across, with p = 2 F/(pi b). Their integrals over the depth
    give the strain of plane strain. Weber and Banaschek's formula is the limit of a deep half plane.
    """
    along = np.arcsinh(depth / half)
    across = depth * (np.hypot(half, depth) - depth) / half**2
    poisson = material.poisson
    plane = along - poisson / (1.0 - poisson) * across
    return np.asarray(2.0 * (1.0 - poisson**2) / (math.pi * material.modulus) * plane, dtype=np.float64)


def linear_contact(materials: tuple[Elasticity, Elasticity]) -> float:
    """Linearised contact of both teeth, 2 (1 - nu^2)/(pi E) of each, times face width [m^2/N].

    Source: D. C. H. Yang and Z. S. Sun, J. Mech. Transm. Autom. Des. 107 (1985) 529-535.
    """
    return 2.0 / math.pi * sum((1.0 - one.poisson**2) / one.modulus for one in materials)
