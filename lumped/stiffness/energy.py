"""Potential-energy stiffness of a tooth pair: Hertz, bending, shear, axial compression, fillet foundation.

The compliances of both teeth, both bodies and the contact add up along the line of action. With Weber and
Banaschek's contact the mean mesh stiffness lies within a tenth of ISO 6336-1's, a fit of measurements; the
linearised contact of the literature makes it a quarter larger. ``scale = "iso6336"`` brings the mean to the
standard's.

The curve is of a pair alone. Pairs that touch together share the two bodies; how far they move each other is
``EnergyStiffness.neighbours``. Prescribed contact of the model leaves it out, as most of the literature does,
so that its stiffness is an upper estimate in double contact; loaded contact takes it.
"""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from lumped.path_function import PathFunction
from lumped.ranges import RangeViolation, range_violations
from lumped.stiffness import iso6336
from lumped.stiffness.base import MeshingPair, StiffnessModel
from lumped.stiffness.body import thin_rims
from lumped.stiffness.contact import softening
from lumped.stiffness.foundation import HALF_ANGLE
from lumped.stiffness.neighbours import neighbour_compliances
from lumped.stiffness.pair_compliance import Contact, pair_compliance
from lumped.stiffness.ramp import RampLength, ramped
from lumped.stiffness.series import fitted_series


def energy_curve(pair: MeshingPair, hertz: Contact = "weber_banaschek") -> PathFunction:
    """Stiffness of a tooth pair alone from A to D by the potential-energy method, as it comes [N/m].

    Parameters
    ----------
    pair : the gear pair
    hertz : contact compliance, as in ``pair_compliance``
    """
    ends = pair.geometry.L_XA, pair.geometry.L_XD
    return fitted_series(lambda xi: pair_compliance(pair, xi, hertz=hertz).stiffness, ends)


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
        """D in 1/k(T) = 1/k(T_0) - D ln(T/T_0), of Weber and Banaschek's contact [m/N].

        The linearised contact does not depend on the load; curves that are scaled or ramped keep the
        operating torque.
        """
        changed = self.scale != "none" or self.ramp_length > 0.0
        if self.hertz != "weber_banaschek" or changed:
            return 0.0
        moduli = (pair.pinion.youngs_modulus, pair.gear.youngs_modulus)
        ratios = (pair.pinion.poisson_ratio, pair.gear.poisson_ratio)
        return softening(moduli, ratios) / pair.geometry.face_width
