"""Potential-energy stiffness of a tooth pair: Hertz, bending, shear, axial compression, fillet foundation.

The compliances of both teeth, both bodies and the contact add up along the line of action. With Weber and
Banaschek's contact the mean mesh stiffness lies within a tenth of ISO 6336-1's, a fit of measurements; the
linearised contact of the literature makes it a quarter larger. ``scale = "iso6336"`` brings the mean to the
standard's.

By default each pair stands alone, as in most of the literature: the sum of the pairs in contact leaves out
that they share the two bodies (structural coupling) and is an upper estimate in double contact.
``coupling = "ring_twist"`` takes in the part of it that has a closed form.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike

from lumped.path_function import PathFunction
from lumped.ranges import RangeViolation, range_violations
from lumped.stiffness import iso6336
from lumped.stiffness.coupling import coupled, twist_compliance
from lumped.stiffness.foundation import BODY_RATIO, HALF_ANGLE
from lumped.stiffness.pair_compliance import Contact, pair_compliance, tooth_profile
from lumped.stiffness.ramp import ramped
from lumped.typing import FloatArray

if TYPE_CHECKING:
    from lumped.gear_geometry.geometry import Geometry
    from lumped.schema.mesh import EnergyStiffness
    from lumped.schema.pair import GearPair

#: Fit error of k over its largest value.
_FIT_TOLERANCE = 1e-10
#: Terms of the Chebyshev series of k over the path of contact that are tried.
_SERIES = (64, 128)


def energy(model: EnergyStiffness, pair: GearPair, geometry: Geometry) -> PathFunction:
    """Stiffness of a tooth pair from A to D by the potential-energy method [N/m].

    Parameters
    ----------
    model : ``hertz``, ``coupling``, ``scale`` ("none" or "iso6336": mean mesh stiffness of eq. (93)) and
        ``ramp_length`` [m]
    pair, geometry : the gear pair and its geometry
    """
    k = energy_curve(pair, geometry, model.hertz)
    if model.coupling == "ring_twist":
        k = coupled(k, twist_compliance(pair, geometry), geometry)
    if model.scale == "iso6336":
        single = iso6336.pair_single_stiffness(pair)
        target = (
            iso6336.mean_mesh_stiffness(single, geometry.contact_ratio) * iso6336.SI * geometry.face_width
        )
        k = k.scaled(target / (k.mean() * geometry.contact_ratio))
    return ramped(k, model.ramp_length)


def energy_curve(pair: GearPair, geometry: Geometry, hertz: Contact = "weber_banaschek") -> PathFunction:
    """Stiffness of a tooth pair alone from A to D by the potential-energy method, as it comes [N/m].

    Parameters
    ----------
    pair, geometry : the gear pair and its geometry
    hertz : contact compliance, as in ``pair_compliance``
    """
    low, high = geometry.L_XA, geometry.L_XD

    def stiffness(xi: FloatArray) -> FloatArray:
        return pair_compliance(pair, geometry, xi, hertz=hertz).stiffness

    # Stiffness is analytic over the path, so its Chebyshev series from a few dozen evaluations stands for it.
    for terms in _SERIES:
        nodes = chebyshev.chebpts1(terms)
        sample = stiffness(low + 0.5 * (high - low) * (1.0 + nodes))
        scale = float(np.abs(sample).max())
        series = chebyshev.chebvander(nodes, terms - 1).T @ sample * (2.0 / terms)
        series[0] *= 0.5
        if np.abs(series[-terms // 8 :]).max() <= 0.1 * _FIT_TOLERANCE * scale:
            return _fit_series(series, low, high, _FIT_TOLERANCE * scale)
    return PathFunction.fit(stiffness, (low, high), tolerance=_FIT_TOLERANCE * scale)


def _fit_series(series: FloatArray, low: float, high: float, tolerance: float) -> PathFunction:
    def value(xi: FloatArray) -> FloatArray:
        return np.asarray(chebyshev.chebval(2.0 * (xi - low) / (high - low) - 1.0, series), dtype=np.float64)

    return PathFunction.fit(value, (low, high), tolerance=tolerance)


def contact_softening(pair: GearPair, geometry: Geometry) -> float:
    """How the compliance of a pair falls with load: D in 1/k(T) = 1/k(T_0) - D ln(T/T_0) [m/N].

    Weber and Banaschek's contact depends on the load by -2 (1 - nu^2)/(pi E b) ln(a) per tooth, and its half
    width a grows as the root of the load, so D = sum (1 - nu^2)/(pi E b) over both teeth, at every position.

    Parameters
    ----------
    pair, geometry : the gear pair and its geometry

    Returns
    -------
    D, or 0 for stiffness that does not depend on the load: other models, the linearised contact, and curves
    that are scaled, coupled or ramped (they keep the operating torque)
    """
    model = pair.mesh.stiffness
    if model.model != "energy" or model.hertz != "weber_banaschek":
        return 0.0
    if model.scale != "none" or model.coupling != "none" or model.ramp_length > 0.0:
        return 0.0
    plane = sum((1.0 - g.poisson_ratio**2) / g.youngs_modulus for g in (pair.pinion, pair.gear))
    return plane / (math.pi * geometry.face_width)


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
