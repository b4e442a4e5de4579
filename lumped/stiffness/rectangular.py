"""Constant stiffness of every tooth pair: the total mesh stiffness is a rectangular wave."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from lumped.fields.units import Quantity
from lumped.path_function import PathFunction
from lumped.ranges import RangeViolation
from lumped.stiffness import iso6336
from lumped.stiffness.base import MeshingPair, StiffnessModel


class RectangularStiffness(StiffnessModel):
    """Constant stiffness of every tooth pair in contact: the total is a rectangular wave."""

    model: Literal["rectangular"] = "rectangular"
    pair_stiffness: Annotated[float | None, Quantity("N/m", at_least=1e-6, at_most=1e12, optional=True)] = (
        Field(
            None, description="stiffness of one tooth pair; default ISO 6336-1 method B c' times face width"
        )
    )

    @property
    def reads(self) -> frozenset[str]:
        """Material and rack for C' of ISO 6336-1, where no stiffness is given."""
        return iso6336.READS if self.pair_stiffness is None else frozenset()

    def curve(self, pair: MeshingPair) -> PathFunction:
        """Stiffness of a tooth pair [N/m], constant from A to D."""
        value = iso6336.single_of(pair) if self.pair_stiffness is None else self.pair_stiffness
        return PathFunction.constant(value, pair.geometry.L_XA, pair.geometry.L_XD)

    def violations(self, pair: MeshingPair) -> tuple[RangeViolation, ...]:
        """Ranges of ISO 6336-1 where it gives the stiffness."""
        return iso6336.violations(pair) if self.pair_stiffness is None else ()
