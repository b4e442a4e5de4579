"""Potential-energy stiffness of a tooth pair: Hertz, bending, shear, axial compression, fillet foundation.

The compliances of both teeth and of the contact add up along the line of action. Each pair of teeth stands
alone: when two pairs touch, the sum of their stiffnesses leaves out that the load of one pair also deflects
the body below the other (structural coupling), so the total in double contact is an upper estimate. Compare
with ISO 6336-1, whose c_gamma is a fit of measurements, or let ``scale = "iso6336"`` bring the mean to it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike

from lumped.errors import NumericalError
from lumped.path_function import FloatArray, PathFunction
from lumped.stiffness import iso6336
from lumped.stiffness.foundation import BODY_RATIO, HALF_ANGLE, foundation_compliance
from lumped.stiffness.ramp import ramped
from lumped.stiffness.tooth_beam import NODES, BeamCompliance, beam_compliance
from lumped.stiffness.tooth_profile import ToothProfile
from lumped.validity import RangeViolation, range_violations

if TYPE_CHECKING:
    from lumped.gear_geometry import Geometry
    from lumped.mesh_parameters import EnergyStiffness
    from lumped.parameters import GearPair

#: Fit error of k over its largest value.
_FIT_TOLERANCE = 1e-10
#: Terms of the Chebyshev series of k over the path of contact.
_SERIES = 64


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
    hertz : compliance of the contact, the same at every position [m/N]
    pinion, gear : the two teeth
    """

    position: FloatArray
    hertz: float
    pinion: ToothCompliance
    gear: ToothCompliance

    @property
    def stiffness(self) -> FloatArray:
        """Stiffness of the pair [N/m]."""
        return 1.0 / (self.hertz + self.pinion.total + self.gear.total)


def tooth_profile(pair: GearPair, which: str) -> ToothProfile:
    """Profile of a tooth of the ``"pinion"`` or the ``"gear"``."""
    gear, rack = (pair.pinion if which == "pinion" else pair.gear), pair.basic_rack
    return _profile(
        gear.teeth,
        rack.module,
        rack.pressure_angle,
        gear.profile_shift,
        rack.dedendum_coefficient,
        rack.fillet_radius_coefficient,
    )


#: One object per tooth form, as it keeps the ends of its fillet once they are found.
_profile = lru_cache(maxsize=256)(ToothProfile)


def hertz_compliance(modulus: tuple[float, float], poisson: tuple[float, float], face_width: float) -> float:
    """Linear contact compliance 2/(pi b) ((1 - nu_1^2)/E_1 + (1 - nu_2^2)/E_2) [m/N].

    For equal materials 4 (1 - nu^2)/(pi E b), D. C. H. Yang and Z. S. Sun (J. Mech. Transm. Autom. Des. 107
    (1985) 529-535): the approach of two cylinders, linearised; it depends neither on load nor on curvature.

    Parameters
    ----------
    modulus, poisson : E [Pa] and nu [-] of both gears
    face_width : [m]
    """
    plane = sum((1.0 - nu**2) / e for e, nu in zip(modulus, poisson, strict=True))
    return 2.0 * plane / (math.pi * face_width)


def pair_compliance(pair: GearPair, geometry: Geometry, xi: ArrayLike, nodes: int = NODES) -> PairCompliance:
    """Compliances of a tooth pair in contact at positions xi.

    Parameters
    ----------
    pair, geometry : the gear pair and its geometry
    xi : (n,) positions from X in [L_XA, L_XD] [m]
    nodes : Gauss points on the fillet and on the involute of each tooth

    Raises
    ------
    ParameterError : the rack cannot cut these teeth
    NumericalError : the Gauss integration did not converge
    """
    position = np.atleast_1d(np.asarray(xi, dtype=float))
    width = geometry.face_width
    return PairCompliance(
        position=position,
        hertz=hertz_compliance(
            (pair.pinion.youngs_modulus, pair.gear.youngs_modulus),
            (pair.pinion.poisson_ratio, pair.gear.poisson_ratio),
            width,
        ),
        pinion=_tooth(pair, "pinion", position, width, nodes),
        gear=_tooth(pair, "gear", geometry.L_XY - position, width, nodes),
    )


def energy(model: EnergyStiffness, pair: GearPair, geometry: Geometry) -> PathFunction:
    """Stiffness of a tooth pair from A to D by the potential-energy method [N/m].

    Parameters
    ----------
    model : ``ramp_length`` [m] and ``scale``, "none" or "iso6336" (mean mesh stiffness of eq. (93))
    pair, geometry : the gear pair and its geometry
    """
    k = energy_curve(pair, geometry)
    if model.scale == "iso6336":
        single = iso6336.pair_single_stiffness(pair)
        target = (
            iso6336.mean_mesh_stiffness(single, geometry.contact_ratio) * iso6336.SI * geometry.face_width
        )
        k = k.scaled(target / (k.mean() * geometry.contact_ratio))
    return ramped(k, model.ramp_length)


def energy_curve(pair: GearPair, geometry: Geometry) -> PathFunction:
    """Unscaled stiffness of a tooth pair from A to D by the potential-energy method, without ramps [N/m].

    Parameters
    ----------
    pair, geometry : the gear pair and its geometry
    """
    low, high = geometry.L_XA, geometry.L_XD
    # Stiffness is analytic over the path, so one evaluation at Chebyshev points stands for it everywhere.
    nodes = chebyshev.chebpts1(_SERIES)
    sample = pair_compliance(pair, geometry, low + 0.5 * (high - low) * (1.0 + nodes)).stiffness
    series = chebyshev.chebvander(nodes, _SERIES - 1).T @ sample * (2.0 / _SERIES)
    series[0] *= 0.5
    scale = float(np.abs(sample).max())
    tail = float(np.abs(series[-_SERIES // 8 :]).max())
    if tail > 0.1 * _FIT_TOLERANCE * scale:
        raise NumericalError(
            f"The stiffness does not converge over the path of contact (last terms {tail / scale:.1e} of the "
            "peak): check the tooth form (a nearly pointed tip)."
        )
    return PathFunction.fit(
        lambda xi: np.asarray(
            chebyshev.chebval(2.0 * (xi - low) / (high - low) - 1.0, series), dtype=np.float64
        ),
        (low, high),
        tolerance=_FIT_TOLERANCE * scale,
    )


def violations(pair: GearPair, geometry: Geometry) -> tuple[RangeViolation, ...]:
    """Fitted ranges of the foundation formula that the two gears leave.

    Parameters
    ----------
    pair, geometry : the gear pair and its geometry
    """
    found: list[RangeViolation] = []
    for name, gear in (("pinion", pair.pinion), ("gear", pair.gear)):
        profile = tooth_profile(pair, name)
        values: dict[str, ArrayLike] = {HALF_ANGLE.quantity: profile.root_half_angle}
        if gear.bore > 0.0:
            values[BODY_RATIO.quantity] = profile.root_radius / (0.5 * gear.bore)
        found += range_violations(f"fillet foundation of the {name}", (BODY_RATIO, HALF_ANGLE), values)
    return tuple(found)


def _tooth(pair: GearPair, which: str, length: FloatArray, width: float, nodes: int) -> ToothCompliance:
    gear = pair.pinion if which == "pinion" else pair.gear
    profile = tooth_profile(pair, which)
    beam: BeamCompliance = beam_compliance(profile, length, gear.youngs_modulus, gear.poisson_ratio, nodes)
    *_, angle = profile.involute_points(length)
    foundation = foundation_compliance(
        profile.base_radius,
        profile.root_radius,
        0.5 * gear.bore,
        profile.root_half_angle,
        angle,
        gear.youngs_modulus,
        gear.poisson_ratio,
    )
    return ToothCompliance(
        bending=beam.bending / width,
        shear=beam.shear / width,
        axial=beam.axial / width,
        foundation=foundation / width,
        quadrature_error=beam.quadrature_error,
    )
