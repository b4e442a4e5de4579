"""Potential-energy stiffness of a tooth pair: Hertz, bending, shear, axial compression, fillet foundation.

The compliances of both teeth, both bodies and the contact add up along the line of action. With Weber and
Banaschek's contact the mean mesh stiffness lies within a tenth of ISO 6336-1's, a fit of measurements; the
linearised contact of the literature makes it a quarter larger. ``scale = "iso6336"`` brings the mean to the
standard's.

The curve is of a pair alone. Pairs that touch together share the two bodies; how far they move each other is
``EnergyStiffness.neighbours``. The paper's form of the model leaves it out, as most of the literature does,
so that its stiffness is an upper estimate in double contact; the loaded form takes it.
"""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.polynomial import Chebyshev
from pydantic import Field

from lumped.path_function import PathFunction
from lumped.ranges import RangeViolation, range_violations
from lumped.stiffness import iso6336
from lumped.stiffness.base import MeshingPair, StiffnessModel
from lumped.stiffness.body import thin_rims
from lumped.stiffness.foundation import HALF_ANGLE
from lumped.stiffness.neighbours import neighbour_compliances
from lumped.stiffness.pair_compliance import Contact, pair_compliance
from lumped.stiffness.ramp import RampLength, ramped
from lumped.typing import FloatArray

#: Fit error of k over its largest value.
_FIT_TOLERANCE = 1e-10
#: Terms of the Chebyshev series of k over the path of contact that are tried.
_SERIES = (64, 128)


def energy_curve(pair: MeshingPair, hertz: Contact = "weber_banaschek") -> PathFunction:
    """Stiffness of a tooth pair alone from A to D by the potential-energy method, as it comes [N/m].

    Parameters
    ----------
    pair : the gear pair
    hertz : contact compliance, as in ``pair_compliance``
    """
    low, high = pair.geometry.L_XA, pair.geometry.L_XD

    def stiffness(xi: FloatArray) -> FloatArray:
        return pair_compliance(pair, xi, hertz=hertz).stiffness

    # Stiffness is analytic over the path, so its Chebyshev series from a few dozen evaluations stands for it.
    for terms in _SERIES:
        series = Chebyshev.interpolate(stiffness, terms - 1, (low, high))
        tolerance = _FIT_TOLERANCE * float(np.abs(series.linspace(terms)[1]).max())
        if np.abs(series.coef[-terms // 8 :]).max() <= 0.1 * tolerance:
            return PathFunction.fit(series, (low, high), tolerance=tolerance)
    return PathFunction.fit(stiffness, (low, high), tolerance=tolerance)


def foundation_violations(pair: MeshingPair) -> tuple[RangeViolation, ...]:
    """Fitted range of the foundation formula that the two gears leave, and their thin rims."""
    found: list[RangeViolation] = []
    for name, wheel in zip(("pinion", "gear"), pair.wheels, strict=True):
        half = {HALF_ANGLE.quantity: wheel.tooth.root_half_angle}
        found += range_violations(f"fillet foundation of the {name}", (HALF_ANGLE,), half)
    return (*found, *thin_rims(pair))


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

    def curve(self, pair: MeshingPair) -> PathFunction:
        """Stiffness of a tooth pair from A to D by the potential-energy method [N/m]."""
        k = energy_curve(pair, self.hertz)
        if self.scale == "iso6336":
            k = k.scaled(iso6336.mean_of(pair) / (k.mean() * pair.geometry.contact_ratio))
        return ramped(k, self.ramp_length)

    def violations(self, pair: MeshingPair) -> tuple[RangeViolation, ...]:
        """Ranges of the fillet foundation's fit, and of ISO 6336-1 where the curve is scaled to it."""
        return foundation_violations(pair) + (iso6336.fit_violations(pair) if self.scale == "iso6336" else ())

    def neighbours(self, pair: MeshingPair) -> tuple[PathFunction, ...]:
        """Motion of the next pairs by the load of one; a curve that is scaled to the standard has it."""
        return neighbour_compliances(pair) if self.scale == "none" else ()

    def softening(self, pair: MeshingPair) -> float:
        """D in 1/k(T) = 1/k(T_0) - D ln(T/T_0) [m/N].

        Weber and Banaschek's contact depends on the load by -2 (1 - nu^2)/(pi E b) ln(a) per tooth, and its
        half width a grows as the root of the load, so D = sum (1 - nu^2)/(pi E b) over both teeth, at every
        position. The linearised contact does not depend on the load; curves that are scaled or ramped
        keep the operating torque.
        """
        changed = self.scale != "none" or self.ramp_length > 0.0
        if self.hertz != "weber_banaschek" or changed:
            return 0.0
        plane = sum((1.0 - g.poisson_ratio**2) / g.youngs_modulus for g in (pair.pinion, pair.gear))
        return plane / (math.pi * pair.geometry.face_width)
