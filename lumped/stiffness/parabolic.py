"""Stiffness of a tooth pair as a parabola over the path of contact, with an optional smooth engagement.

The parabola, symmetric about the middle of the path of contact, is the classical approximation of measured
and computed tooth-pair stiffness: Cai and Hayashi (J. Mech. Des. 116 (1994) 558-564) take 0.55 of the peak at
the ends. The default here makes the mean total stiffness that of ISO 6336-1, eq. (93), for any contact ratio.
"""

from __future__ import annotations

from typing import Annotated, Literal

import numpy as np
from numpy.polynomial import Polynomial
from pydantic import Field

from lumped.fields.units import Quantity
from lumped.path_function import PathFunction
from lumped.ranges import RangeViolation
from lumped.stiffness import iso6336
from lumped.stiffness.base import RAMP, MeshingPair, RampLength, StiffnessModel, check_ramp_length


def iso_end_ratio(contact_ratio: float) -> float:
    """Stiffness at the ends over the peak for which the mean total stiffness is ISO 6336-1, eq. (93) [-].

    A parabola from r to 1 and back has the mean (2 + r)/3 over the path, so the mean total is eps (2 + r)/3
    times the peak; equating it to 0.75 eps + 0.25 gives r = 0.25 + 0.75/eps.

    >>> iso_end_ratio(1.5)
    0.75
    """
    return 0.25 + 0.75 / contact_ratio


def parabola(
    low: float, high: float, peak: float, end_ratio: float, ramp_length: float = 0.0
) -> PathFunction:
    """Parabola from low to high [m] with a peak in the middle, times ramps of a length [m] at both ends.

    ``end_ratio`` is the value at the ends over the peak. The inner ends of the ramps, where the curvature
    jumps, are switches.
    """
    check_ramp_length(ramp_length, low, high)
    half = 0.5 * (high - low)
    arch = Polynomial([end_ratio, 2.0 * (1.0 - end_ratio) / half, -(1.0 - end_ratio) / half**2]) * peak
    if ramp_length == 0.0:
        return PathFunction(
            np.array([low, high]), np.asarray(arch.coef[::-1, None], dtype=np.float64), np.empty(0)
        )
    inner = (low + ramp_length, high - ramp_length)
    rise = RAMP(Polynomial([0.0, 1.0 / ramp_length]))
    fall = RAMP(Polynomial([1.0, -1.0 / ramp_length]))
    pieces = [arch * rise]
    if inner[0] < inner[1]:
        pieces.append(arch(Polynomial([ramp_length, 1.0])))
    pieces.append(arch(Polynomial([high - low - ramp_length, 1.0])) * fall)
    coefficients = np.zeros((max(piece.coef.size for piece in pieces), len(pieces)))
    for column, piece in enumerate(pieces):
        coefficients[-piece.coef.size :, column] = piece.coef[::-1]
    switches = np.unique(inner)
    return PathFunction(np.array([low, *switches, high]), coefficients, switches)


class ParabolicStiffness(StiffnessModel):
    """Stiffness of a tooth pair as a parabola over the path of contact, with optional smooth engagement."""

    model: Literal["parabolic"] = "parabolic"
    peak: Annotated[float | None, Quantity("N/m", at_least=1e-6, at_most=1e12, optional=True)] = Field(
        None,
        description="largest stiffness of one tooth pair; default ISO 6336-1 method B c' times face width",
    )
    end_ratio: Annotated[float | None, Quantity("1", above=0, at_most=1, optional=True)] = Field(
        None,
        description="stiffness at the ends of the path of contact over the peak; default gives the mean mesh "
        "stiffness of ISO 6336-1",
    )
    ramp_length: RampLength = 0.0

    @property
    def reads(self) -> frozenset[str]:
        """Material and rack for C' of ISO 6336-1, where no peak is given."""
        return iso6336.READS if self.peak is None else frozenset()

    def curve(self, pair: MeshingPair) -> PathFunction:
        """Stiffness of a tooth pair [N/m]: a parabola from A to D with its peak in the middle."""
        g = pair.geometry
        peak = iso6336.single_of(pair) if self.peak is None else self.peak
        ratio = iso_end_ratio(g.contact_ratio) if self.end_ratio is None else self.end_ratio
        return parabola(g.L_XA, g.L_XD, peak, ratio, self.ramp_length)

    def violations(self, pair: MeshingPair) -> tuple[RangeViolation, ...]:
        """Ranges of ISO 6336-1 where it gives the peak or the ends."""
        return iso6336.violations(pair) if self.peak is None or self.end_ratio is None else ()
