"""Stiffness of a tooth pair by plane finite elements of both whole gears, see ``elastic_teeth``."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from lumped.path_function import PathFunction
from lumped.ranges import RangeViolation
from lumped.stiffness.base import MeshingPair, StiffnessModel
from lumped.stiffness.body import thin_rims
from lumped.stiffness.contact import softening
from lumped.stiffness.elastic_teeth import Plane, Support, alone, elastic_teeth, together
from lumped.stiffness.neighbours import coupled_pairs
from lumped.stiffness.series import fitted_series


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
        """Stiffness of a tooth pair from A to D by finite elements [N/m].

        Raises
        ------
        ParameterError : a solid gear is clamped
        NumericalError : the teeth cannot be meshed
        """
        teeth = elastic_teeth(pair, self.plane, self.support)
        ends = pair.geometry.L_XA, pair.geometry.L_XD
        return fitted_series(lambda xi: 1.0 / alone(pair, teeth, xi), ends)

    def violations(self, pair: MeshingPair) -> tuple[RangeViolation, ...]:
        """Rims so thin that what holds them decides."""
        return thin_rims(pair)

    def neighbours(self, pair: MeshingPair) -> tuple[PathFunction, ...]:
        """Motion of the next pairs by the load of one [m/N]."""
        teeth = elastic_teeth(pair, self.plane, self.support)
        return coupled_pairs(pair, lambda apart, xi: together(pair, teeth, apart, xi))

    def softening(self, pair: MeshingPair) -> float:
        """D of the contact, see ``contact.softening`` [m/N]."""
        moduli = (pair.pinion.youngs_modulus, pair.gear.youngs_modulus)
        ratios = (pair.pinion.poisson_ratio, pair.gear.poisson_ratio)
        return softening(moduli, ratios) / pair.geometry.face_width
