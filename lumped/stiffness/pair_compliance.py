"""Compliances of a tooth pair along the line of action: teeth, bodies and the contact between them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from lumped.arguments import one_of
from lumped.gear_geometry.geometry import Wheel
from lumped.stiffness.base import Material, MeshingPair
from lumped.stiffness.contact import contact_half_width, linear_hertz_compliance, local_compliance
from lumped.stiffness.foundation import foundation_compliance
from lumped.stiffness.tooth_beam import beam_compliance
from lumped.typing import FloatArray

Contact = Literal["linear", "weber_banaschek"]


@dataclass(frozen=True)
class ToothCompliance:
    """Compliances of one tooth along the line of action, one per position [m/N].

    Attributes
    ----------
    bending, shear, axial, foundation : (n,) the parts
    quadrature_error : relative error estimate of the Gauss integration [-]
    """

    bending: FloatArray
    shear: FloatArray
    axial: FloatArray
    foundation: FloatArray
    quadrature_error: float

    @property
    def total(self) -> FloatArray:
        """Sum of the parts [m/N]."""
        return self.bending + self.shear + self.axial + self.foundation


@dataclass(frozen=True)
class PairCompliance:
    """Compliances of a tooth pair over positions on the path of contact.

    Attributes
    ----------
    position : (n,) xi from X [m]
    hertz : (n,) compliance of the contact [m/N]
    pinion, gear : the two teeth
    """

    position: FloatArray
    hertz: FloatArray
    pinion: ToothCompliance
    gear: ToothCompliance

    @property
    def stiffness(self) -> FloatArray:
        """Stiffness of the pair [N/m]."""
        return 1.0 / (self.hertz + self.pinion.total + self.gear.total)


def pair_compliance(
    pair: MeshingPair, xi: ArrayLike, *, hertz: Contact = "weber_banaschek"
) -> PairCompliance:
    """Compliances of a tooth pair in contact at positions xi.

    Parameters
    ----------
    pair : the gear pair
    xi : (n,) positions from X in [L_XA, L_XD] [m]
    hertz : "weber_banaschek" at the load of a single pair under the operating torque, or "linear"

    Raises
    ------
    NumericalError : the Gauss integration did not converge
    """
    position = np.atleast_1d(np.asarray(xi, dtype=float))
    g = pair.geometry
    return PairCompliance(
        position=position,
        hertz=_contact(pair, position, hertz),
        pinion=_tooth(pair.wheels[0], pair.pinion, position, g.face_width),
        gear=_tooth(pair.wheels[1], pair.gear, g.L_XY - position, g.face_width),
    )


def _contact(pair: MeshingPair, xi: FloatArray, hertz: Contact) -> FloatArray:
    g = pair.geometry
    width = g.face_width
    moduli = (pair.pinion.youngs_modulus, pair.gear.youngs_modulus)
    ratios = (pair.pinion.poisson_ratio, pair.gear.poisson_ratio)
    if one_of("hertz", hertz, get_args(Contact)) == "linear":
        return np.full(xi.shape, linear_hertz_compliance(moduli, ratios) / width)
    load = pair.operating.pinion_torque / g.base_radius_pinion / width
    radius = xi * (g.L_XY - xi) / g.L_XY
    half_width = contact_half_width(load, radius, moduli, ratios)
    total = np.zeros(xi.shape)
    lengths = (xi, g.L_XY - xi)
    for wheel, length, modulus, ratio in zip(pair.wheels, lengths, moduli, ratios, strict=True):
        _, h, _, angle = wheel.tooth.involute_points(length)
        total = total + local_compliance(half_width, h / np.cos(angle), modulus, ratio) / width
    return total


def _tooth(wheel: Wheel, material: Material, length: FloatArray, width: float) -> ToothCompliance:
    profile, modulus, ratio = wheel.tooth, material.youngs_modulus, material.poisson_ratio
    beam = beam_compliance(profile, length, modulus, ratio)
    *_, angle = profile.involute_points(length)
    foundation = foundation_compliance(
        profile.base_radius,
        profile.root_radius,
        profile.root_half_angle,
        angle,
        modulus,
        ratio,
    )
    return ToothCompliance(
        bending=beam.bending / width,
        shear=beam.shear / width,
        axial=beam.axial / width,
        foundation=foundation / width,
        quadrature_error=beam.quadrature_error,
    )
