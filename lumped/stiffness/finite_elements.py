"""Stiffness of a tooth pair by plane finite elements of both whole gears.

The deflection of a tooth under a line load, less the half plane around the load, comes from the finite
elements (``lumped.elasticity``); what a Hertzian pressure adds down to the tooth's centre line is Weber and
Banaschek's contact, in plane strain. In plane strain their sum is the plane solution itself. No formula is
shared with the energy method, so that each can judge the other.

The angles and displacements of the model are the mean ones of the gear bodies. So a gear is free here: its
load is balanced by its own inertia, and the deflection counts from its mean motion. What lies between mean
motion and shaft, the twist and the translation of the body, is shared by all pairs and no part of k.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from pydantic import Field

from lumped.errors import refuse
from lumped.gear_geometry.geometry import Wheel
from lumped.path_function import PathFunction
from lumped.ranges import RangeViolation
from lumped.stiffness.base import Material, MeshingPair, StiffnessModel, fitted_series
from lumped.stiffness.energy import weber_banaschek_softening
from lumped.stiffness.foundation import thin_rims
from lumped.stiffness.neighbours import REACH, coupled_pairs
from lumped.typing import FloatArray

if TYPE_CHECKING:
    from lumped.elasticity.gear import FlankCompliance, PlaneGear

Plane = Literal["stress", "strain"]
Support = Literal["free", "clamped", "untwisted"]


@dataclass(frozen=True, eq=False)
class ElasticTooth:
    """One gear of a pair as a plane elastic body, with the lengths and moduli that give compliances in m/N.

    Lengths of ``body`` are in modules. ``twist`` is the twist of the body, times modulus and face width [-];
    it is subtracted from the motion of all teeth.
    """

    wheel: Wheel
    material: Material
    plane: Plane
    body: PlaneGear
    twist: float

    @property
    def flank(self) -> FlankCompliance:
        """Compliances of the flanks, by plane finite elements."""
        from lumped.elasticity.gear import flank_compliance

        return flank_compliance(self.body)

    @property
    def modulus(self) -> float:
        """E in plane stress, E/(1 - nu^2) in plane strain [Pa]."""
        e = self.material.youngs_modulus
        nu = self.material.poisson_ratio
        return e if self.plane == "stress" else e / (1.0 - nu**2)

    def compliance(self, length: FloatArray, half_width: FloatArray) -> FloatArray:
        """Deflection under the own load, contact included, at a flank length and half width [m]; [m^2/N]."""
        module = self.wheel.tooth.module
        _, h, _, angle = self.wheel.tooth.involute_points(length)
        depth = h / np.cos(angle) / module
        tooth = self.flank.deflection(length / module) - 2.0 / math.pi * np.log(depth) - self.twist
        # The contact is narrow beside the face width: down to the depth the strain is plane in any case.
        e = self.material.youngs_modulus
        nu = self.material.poisson_ratio
        contact = (2.0 * np.log(2.0 * depth * module / half_width) - nu / (1.0 - nu)) / math.pi
        return tooth / self.modulus + contact * (1.0 - nu**2) / e

    def neighbour_motion(self, apart: int, loaded: FloatArray, length: FloatArray) -> FloatArray:
        """Motion of the tooth ``apart`` >= 1 pitches ahead of a loaded one, times face width [m^2/N]."""
        module = self.wheel.tooth.module
        motion = self.flank.neighbour_motion(apart, loaded / module, length / module)
        return (motion - self.twist) / self.modulus


def elastic_teeth(
    pair: MeshingPair, plane: Plane = "stress", support: Support = "free", bore: float | None = None
) -> tuple[ElasticTooth, ElasticTooth]:
    """Pinion and gear as plane elastic bodies.

    ``plane`` is the state of stress, "stress" for narrow gears, "strain" for wide ones; ``support`` is
    "free", "clamped" at the bore (refused without one), or "untwisted", clamped and less the twist of the
    ring; ``bore`` is root over bore radius of both gears, in the place of their own.
    """
    from lumped.elasticity.gear import PlaneGear

    apart = math.floor(pair.geometry.contact_ratio + 2.0 * REACH)
    result = []
    for name, wheel, material in zip(("pinion", "gear"), pair.wheels, (pair.pinion, pair.gear), strict=True):
        tooth = replace(wheel.tooth, module=1.0)
        module = wheel.tooth.module
        radius = 0.5 * wheel.bore / module if bore is None else tooth.root_radius / bore
        if support != "free" and radius == 0.0:
            action = "Give the bore, or choose support = 'free'."
            raise refuse("mesh.stiffness.support", support, f"'free', as the {name} has no bore", action)
        nu = material.poisson_ratio
        if plane == "strain":
            nu = nu / (1.0 - nu)
        reach = min(apart, tooth.teeth - 1)
        body = PlaneGear(
            tooth, wheel.tip_radius / module, radius, nu, "free" if support == "free" else "clamped", reach
        )
        twist = 0.0
        if support == "untwisted":
            # Lame's ring, G = 1/(2 (1 + nu)).
            inverse = (radius**-2 - tooth.root_radius**-2) / (2.0 * math.pi)
            twist = tooth.base_radius**2 * (1.0 + nu) * inverse
        result.append(ElasticTooth(wheel, material, plane, body, twist))
    return result[0], result[1]


def hertz_half_width(pair: MeshingPair, xi: FloatArray) -> FloatArray:
    """Half width of the contact at positions xi of any shape [m], Johnson (1985), eq. (4.43).

    Under the operating torque on a single pair; written here once more than in ``energy``, so that the two
    ways to a stiffness share no formula.
    """
    g = pair.geometry
    curvature = 1.0 / xi + 1.0 / (g.L_XY - xi)
    effective = 1.0 / sum((1.0 - m.poisson_ratio**2) / m.youngs_modulus for m in (pair.pinion, pair.gear))
    force = pair.operating.pinion_torque / (g.base_radius_pinion * g.face_width)
    return np.asarray(np.sqrt(4.0 * force / (math.pi * effective * curvature)), dtype=np.float64)


def self_compliance(
    pair: MeshingPair, teeth: tuple[ElasticTooth, ElasticTooth], xi: FloatArray
) -> FloatArray:
    """Compliance of a tooth pair under the load of this pair, at positions xi of any shape [m/N].

    The contact is as wide as under the operating torque on a single pair.
    """
    g = pair.geometry
    half = hertz_half_width(pair, xi)
    total = teeth[0].compliance(xi, half) + teeth[1].compliance(g.L_XY - xi, half)
    return np.asarray(total / g.face_width, dtype=np.float64)


def cross_compliance(
    pair: MeshingPair, teeth: tuple[ElasticTooth, ElasticTooth], apart: int, xi: FloatArray
) -> FloatArray:
    """Motion of the pair ``apart`` base pitches ahead of a loaded one, which is at xi, any shape [m/N]."""
    g = pair.geometry
    ahead = xi + apart * g.base_pitch
    total = teeth[0].neighbour_motion(apart, xi, ahead) + teeth[1].neighbour_motion(
        apart, g.L_XY - ahead, g.L_XY - xi
    )
    return np.asarray(total / g.face_width, dtype=np.float64)


def pair_error(pair: MeshingPair, teeth: tuple[ElasticTooth, ElasticTooth], xi: FloatArray) -> FloatArray:
    """Share of ``self_compliance`` by which a coarser mesh differs, at positions xi of any shape [-]."""
    from lumped.elasticity.gear import COARSE, flank_compliance

    g = pair.geometry
    difference = np.zeros(np.shape(xi))
    for tooth, length in zip(teeth, (xi, g.L_XY - xi), strict=True):
        place = length / tooth.wheel.tooth.module
        coarse = flank_compliance(tooth.body, COARSE)
        difference += abs(tooth.flank.deflection(place) - coarse.deflection(place)) / tooth.modulus
    return np.asarray(difference / g.face_width / self_compliance(pair, teeth, xi), dtype=np.float64)


class FiniteElementStiffness(StiffnessModel):
    """Plane finite elements of both gears, true tooth form and whole body."""

    model: Literal["finite_elements"] = "finite_elements"
    plane: Plane = Field(
        "stress", description="state of the bodies: plane 'stress' for narrow gears, 'strain' for wide ones"
    )
    support: Support = Field(
        "free",
        description="'free': deflections count from the mean motion of the gear; 'clamped': from the bore; "
        "'untwisted': from the bore, less the twist of the body",
    )

    def curve(self, pair: MeshingPair) -> PathFunction:
        """Return k(xi) by plane finite elements [N/m]."""
        teeth = elastic_teeth(pair, self.plane, self.support)
        ends = pair.geometry.L_XA, pair.geometry.L_XD
        return fitted_series(lambda xi: 1.0 / self_compliance(pair, teeth, xi), ends)

    def violations(self, pair: MeshingPair) -> tuple[RangeViolation, ...]:
        """Return the rims that are too thin: their deflection depends on the support of the bore."""
        return thin_rims(pair)

    def neighbours(self, pair: MeshingPair) -> tuple[PathFunction, ...]:
        """Return w_m(xi) by plane finite elements [m/N]."""
        teeth = elastic_teeth(pair, self.plane, self.support)
        return coupled_pairs(pair, lambda apart, xi: cross_compliance(pair, teeth, apart, xi))

    def softening(self, pair: MeshingPair) -> float:
        """Return D of the contact [m/N]."""
        return weber_banaschek_softening(pair)
