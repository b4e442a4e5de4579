"""Potential-energy stiffness of a tooth pair: Hertz, bending, shear, axial compression, fillet foundation.

The compliances of both teeth, both bodies and the contact add up along the line of action. With Weber and
Banaschek's contact the mean mesh stiffness lies within a tenth of ISO 6336-1's, a fit of measurements; the
linearised contact of the literature makes it a quarter larger. ``scale = "iso6336"`` brings the mean to the
standard's.

A tooth is a cantilever of its true section on the root circle, loaded along the line of action. Its strain
energies give one compliance each (bending and compression: D. C. H. Yang and J. Y. Lin, J. Mech. Transm.
Autom. Des. 109 (1987) 189-196; shear: X. Tian, M. Zuo and K. Fyfe, IMECE 2004):

    1/k_b = int (cos(a) (u_c - u) - sin(a) h_c)^2 / (E I) du,   I = 2/3 h^3 b
    1/k_s = int 1.2 cos^2(a) / (G A) du,                        A = 2 h b
    1/k_a = int sin^2(a) / (E A) du

with the contact point (u_c, h_c), the load angle a, and u from the root circle to the contact point, over the
fillet and the involute; plane stress.

The curve is of a pair alone. Pairs that touch together share the two bodies; how far they move each other is
``EnergyStiffness.neighbours``. Prescribed contact of the model leaves it out, as most of the literature does,
so that its stiffness is an upper estimate in double contact; loaded contact takes it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field

from lumped.errors import NumericalError
from lumped.gear_geometry.geometry import Wheel
from lumped.gear_geometry.tooth_profile import ToothProfile
from lumped.path_function import PathFunction
from lumped.ranges import RangeViolation, range_violations
from lumped.stiffness import iso6336
from lumped.stiffness.base import (
    TOOTH_FORM,
    Material,
    MeshingPair,
    RampLength,
    StiffnessModel,
    fitted_series,
    ramped,
)
from lumped.stiffness.foundation import HALF_ANGLE, foundation_compliance, thin_rims
from lumped.stiffness.neighbours import neighbour_compliances
from lumped.typing import FloatArray


def linear_hertz_compliance(modulus: tuple[float, float], poisson: tuple[float, float]) -> float:
    """Linear contact compliance times face width, 2/pi ((1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2) [m^2/N].

    For equal materials 4 (1 - nu^2)/(pi E), D. C. H. Yang and Z. S. Sun (J. Mech. Transm. Autom. Des. 107
    (1985) 529-535): the usual choice, though teeth in contact are some three times softer.

    >>> f"{linear_hertz_compliance((206e9, 206e9), (0.3, 0.3)):.4e}"
    '5.6245e-12'
    """
    return 2.0 / math.pi * sum((1.0 - nu**2) / e for e, nu in zip(modulus, poisson, strict=True))


def contact_half_width(
    load: float, radius: FloatArray, modulus: tuple[float, float], poisson: tuple[float, float]
) -> FloatArray:
    """Half width of the Hertzian contact at a load per face width [N/m] and reduced radius [m]; in m.

    sqrt(4 w rho ((1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2)/pi)

    >>> f"{contact_half_width(100e3, np.array(0.008), (206e9, 206e9), (0.3, 0.3)):.5e}"
    '9.48642e-05'
    """
    plane = sum((1.0 - nu**2) / e for e, nu in zip(modulus, poisson, strict=True))
    return np.asarray(np.sqrt(4.0 * load * radius * plane / math.pi), dtype=np.float64)


def local_compliance(half_width: FloatArray, depth: FloatArray, modulus: float, poisson: float) -> FloatArray:
    """Shortening of a tooth between loaded flank and centre line, per load, times face width [m^2/N].

    2 (1 - nu^2)/(pi E) (ln(2 h/a) - nu/(2 (1 - nu))), C. Weber and K. Banaschek, Formaenderung und
    Profilruecknahme bei gerad- und schraegverzahnten Raedern, Vieweg 1953: the strain under a Hertzian
    pressure of half width a [m], integrated over the depth h [m] from the flank to the centre line along the
    load (plane strain, h well beyond a).

    >>> f"{local_compliance(np.array(1e-4), np.array(2e-3), 206e9, 0.3):.4e}"
    '9.7714e-12'
    """
    shape = np.log(2.0 * depth / half_width) - poisson / (2.0 * (1.0 - poisson))
    return np.asarray(2.0 * (1.0 - poisson**2) / (math.pi * modulus) * shape, dtype=np.float64)


def softening(modulus: tuple[float, float], poisson: tuple[float, float]) -> float:
    """Fall D of ``local_compliance`` of both teeth with the logarithm of the load, times width [m^2/N].

    The half width grows as the root of the load, so D = sum (1 - nu^2)/(pi E), at every position.
    """
    return sum((1.0 - nu**2) / e for e, nu in zip(modulus, poisson, strict=True)) / math.pi


#: Gauss points on the fillet and on the involute; the error is measured by a rule with half as many more.
NODES = 24
#: Largest accepted quadrature error of a compliance, over its value.
TOLERANCE = 1e-8
#: Shear correction of the rectangular section.
SHEAR_FACTOR = 1.2


@dataclass(frozen=True)
class BeamCompliance:
    """Compliances (n,) of one tooth along the line of action, each times face width [m^2/N].

    ``quadrature_error`` is the largest relative difference from a finer Gauss rule over the three.
    """

    bending: FloatArray
    shear: FloatArray
    axial: FloatArray
    quadrature_error: float


def beam_compliance(
    profile: ToothProfile, length: FloatArray, modulus: float, poisson: float, nodes: int = NODES
) -> BeamCompliance:
    """Compliances of a tooth loaded at lengths (n,) on the base tangent, at or beyond its form length [m].

    ``nodes`` are the Gauss points on the fillet and on the involute to begin with; up to eight times as many
    are taken, until a finer rule agrees to ``TOLERANCE``.
    """
    (bending, area), error = _converged(profile, length, nodes)
    *_, angle = profile.involute_points(length)
    shear_modulus = modulus / (2.0 * (1.0 + poisson))
    return BeamCompliance(
        bending=bending / modulus,
        shear=SHEAR_FACTOR * np.cos(angle) ** 2 * area / shear_modulus,
        axial=np.sin(angle) ** 2 * area / modulus,
        quadrature_error=error,
    )


def _converged(
    profile: ToothProfile, length: FloatArray, nodes: int
) -> tuple[tuple[FloatArray, FloatArray], float]:
    """Both integrals, and their relative difference from a rule with two thirds of the points."""
    error = np.inf
    for count in (nodes, 2 * nodes, 4 * nodes, 8 * nodes):
        coarse = _integrals(profile, length, count)
        fine = _integrals(profile, length, count + count // 2)
        error = max(float(np.max(np.abs(a / b - 1.0))) for a, b in zip(coarse, fine, strict=True))
        if error <= TOLERANCE:
            return fine, error
    raise NumericalError(
        f"The tooth's strain energy did not converge (relative error {error:.1e}): the tooth is nearly "
        "pointed or its root nearly cut through; lower the tip diameter or change the profile shift."
    )


@cache
def _gauss(nodes: int) -> tuple[FloatArray, FloatArray]:
    points, weights = np.polynomial.legendre.leggauss(nodes)
    return points, weights


def _integrals(profile: ToothProfile, length: FloatArray, nodes: int) -> tuple[FloatArray, FloatArray]:
    """Integrals of arm^2/(2/3 h^3) and 1/(2 h) over u, root circle to each contact point; (n,) [-]."""
    points, weights = _gauss(nodes)
    start, end = profile.fillet_range
    u_1, h_1, slope_1 = profile.fillet_points(0.5 * (start + end) + 0.5 * (end - start) * points)
    w_1 = 0.5 * (end - start) * weights * slope_1
    form = profile.form_length
    half = 0.5 * (length - form)[:, None]
    u_2, h_2, slope_2, _ = profile.involute_points(form + half * (1.0 + points))
    w_2 = half * weights * slope_2
    u_c, h_c, _, angle = profile.involute_points(length)

    def bending(u: FloatArray, h: FloatArray, w: FloatArray) -> FloatArray:
        arm = np.cos(angle)[:, None] * (u_c[:, None] - u) - (np.sin(angle) * h_c)[:, None]
        return np.asarray(np.sum(1.5 * arm**2 / h**3 * w, axis=1), dtype=np.float64)

    area = np.sum(w_1 / (2.0 * h_1)) + np.sum(w_2 / (2.0 * h_2), axis=1)
    return bending(u_1, h_1, w_1) + bending(u_2, h_2, w_2), np.asarray(area, dtype=np.float64)


HertzLaw = Literal["linear", "weber_banaschek"]


@dataclass(frozen=True)
class ToothCompliance(BeamCompliance):
    """Compliances (n,) of one tooth along the line of action [m/N]."""

    foundation: FloatArray

    @property
    def total(self) -> FloatArray:
        """Sum of the parts [m/N]."""
        return self.bending + self.shear + self.axial + self.foundation


@dataclass(frozen=True)
class PairCompliance:
    """Compliances of a tooth pair at positions (n,) on the path of contact [m, m/N]."""

    position: FloatArray
    hertz: FloatArray
    pinion: ToothCompliance
    gear: ToothCompliance

    @property
    def stiffness(self) -> FloatArray:
        """Stiffness of the pair [N/m]."""
        return 1.0 / (self.hertz + self.pinion.total + self.gear.total)


def pair_compliance(
    pair: MeshingPair, xi: ArrayLike, *, hertz: HertzLaw = "weber_banaschek"
) -> PairCompliance:
    """Compliances of a tooth pair in contact at positions xi from X, (n,) [m].

    ``hertz`` is the contact: "weber_banaschek" at the load of a single pair under the operating torque, or
    "linear".
    """
    position = np.atleast_1d(np.asarray(xi, dtype=float))
    g = pair.geometry
    return PairCompliance(
        position=position,
        hertz=_contact(pair, position, hertz),
        pinion=_tooth(pair.wheels[0], pair.pinion, position, g.face_width),
        gear=_tooth(pair.wheels[1], pair.gear, g.L_XY - position, g.face_width),
    )


def _elastic(pair: MeshingPair) -> tuple[tuple[float, float], tuple[float, float]]:
    """E [Pa] and nu of both gears."""
    moduli = (pair.pinion.youngs_modulus, pair.gear.youngs_modulus)
    return moduli, (pair.pinion.poisson_ratio, pair.gear.poisson_ratio)


def weber_banaschek_softening(pair: MeshingPair) -> float:
    """D of Weber and Banaschek's contact in 1/k(T) = 1/k(T_0) - D ln(T/T_0) [m/N].

    D is without the factors of a file on the stiffness;
    `lumped.path_of_contact.stiffness.contact_softening` applies these.
    """
    return softening(*_elastic(pair)) / pair.geometry.face_width


def _contact(pair: MeshingPair, xi: FloatArray, hertz: HertzLaw) -> FloatArray:
    g = pair.geometry
    width = g.face_width
    moduli, ratios = _elastic(pair)
    if hertz == "linear":
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
    profile = wheel.tooth
    modulus = material.youngs_modulus
    ratio = material.poisson_ratio
    beam = beam_compliance(profile, length, modulus, ratio)
    *_, angle = profile.involute_points(length)
    radii = profile.base_radius, profile.root_radius
    foundation = foundation_compliance(*radii, profile.root_half_angle, angle, modulus, ratio)
    return ToothCompliance(
        bending=beam.bending / width,
        shear=beam.shear / width,
        axial=beam.axial / width,
        foundation=foundation / width,
        quadrature_error=beam.quadrature_error,
    )


def energy_curve(pair: MeshingPair, hertz: HertzLaw = "weber_banaschek") -> PathFunction:
    """Stiffness of a tooth pair alone from A to D by the potential-energy method, as it comes [N/m]."""
    ends = pair.geometry.L_XA, pair.geometry.L_XD
    return fitted_series(lambda xi: pair_compliance(pair, xi, hertz=hertz).stiffness, ends)


def foundation_violations(pair: MeshingPair) -> tuple[RangeViolation, ...]:
    """Fitted range of the foundation formula that the two gears leave, and their thin rims."""
    result: list[RangeViolation] = []
    for name, wheel in zip(("pinion", "gear"), pair.wheels, strict=True):
        half = {HALF_ANGLE.quantity: wheel.tooth.root_half_angle}
        result += range_violations(f"fillet foundation of the {name}", (HALF_ANGLE,), half)
    return (*result, *thin_rims(pair))


#: What the method reads of the tooth form: the body is one for every gear, bored or solid.
READS = TOOTH_FORM - {"gears.bore"}


class EnergyStiffness(StiffnessModel):
    """Potential-energy stiffness of the true tooth form on its gear body."""

    model: Literal["energy"] = "energy"
    hertz: Literal["weber_banaschek", "linear"] = Field(
        "weber_banaschek",
        description="contact compliance: by Weber and Banaschek at the operating torque, or linearised",
    )
    scale: Literal["none", "iso6336"] = Field(
        "none", description="'iso6336' scales the curve to the mean mesh stiffness of ISO 6336-1 method B"
    )
    ramp_length: RampLength = 0.0

    @property
    def reads(self) -> frozenset[str]:
        """The tooth form without the bore."""
        return READS

    def curve(self, pair: MeshingPair) -> PathFunction:
        """By the potential-energy method [N/m]."""
        k = energy_curve(pair, self.hertz)
        if self.scale == "iso6336":
            k = k.scaled(iso6336.mean_of(pair) / (k.mean() * pair.geometry.contact_ratio))
        return ramped(k, self.ramp_length)

    def violations(self, pair: MeshingPair) -> tuple[RangeViolation, ...]:
        """Return the ranges left of the fillet foundation and, where the curve is scaled, of ISO 6336-1."""
        return foundation_violations(pair) + (iso6336.fit_violations(pair) if self.scale == "iso6336" else ())

    def neighbours(self, pair: MeshingPair) -> tuple[PathFunction, ...]:
        """Return the functions of the gear bodies. A curve that is scaled to the standard has none."""
        return neighbour_compliances(pair) if self.scale == "none" else ()

    def softening(self, pair: MeshingPair) -> float:
        """Return D of Weber and Banaschek's contact; 0 for curves that are scaled or ramped."""
        changed = self.scale != "none" or self.ramp_length > 0.0
        return 0.0 if self.hertz == "linear" or changed else weber_banaschek_softening(pair)
