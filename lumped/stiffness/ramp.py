"""Smooth engagement: a pair's stiffness rises from zero at both ends of the path of contact."""

from __future__ import annotations

from typing import Annotated

import numpy as np
from numpy.polynomial import Polynomial
from pydantic import Field

from lumped.errors import refuse
from lumped.fields.units import Quantity
from lumped.path_function import PathFunction
from lumped.typing import FloatArray

#: The field ``ramp_length`` of the stiffness models.
RampLength = Annotated[
    float,
    Quantity("mm", at_least=0),
    Field(description="length along the path over which a pair takes up its stiffness; 0 is a jump"),
]
#: Ramp in s from 0 to 1. The square of the cubic smoothstep, so that sqrt(k), and with it the damping
#: 2 zeta sqrt(k m_e), is analytic on the ramp too; it starts like s^4 and ends with zero slope.
RAMP = Polynomial([0.0, 0.0, 3.0, -2.0]) ** 2
#: Shortest ramp over half of the path of contact: rounding of positions is then below the fit's tolerance.
_SHORTEST = 2e-4
#: Fit error of a ramped function over its largest value.
_FIT_TOLERANCE = 1e-11


def check_ramp_length(ramp_length: float, low: float, high: float) -> None:
    """Refuse a ramp longer than half of the path of contact, or too short to be resolved.

    Raises
    ------
    ParameterError : the ramps overlap, or are no jump though shorter than positions can resolve
    """
    half = 0.5 * (high - low)
    if ramp_length > half or 0.0 < ramp_length < _SHORTEST * half:
        raise refuse(
            "mesh.stiffness.ramp_length",
            f"{ramp_length * 1e3:g} mm",
            f"0, or {_SHORTEST * half * 1e3:.4f} to {half * 1e3:.4f} mm, half of the path of contact",
            "Shorten the ramp." if ramp_length > half else "Write 0 for a jump.",
        )


def ramped(function: PathFunction, ramp_length: float) -> PathFunction:
    """Multiply a path function by the ramp at both ends.

    Parameters
    ----------
    function : values over the path of contact
    ramp_length : length of each ramp [m]; 0 returns the function itself

    Returns
    -------
    PathFunction : with additional switches at the inner ends of the ramps, where the curvature jumps

    Raises
    ------
    ParameterError : the ramps overlap, or cannot be resolved
    """
    if ramp_length == 0.0:
        return function
    low, high = function.interval
    check_ramp_length(ramp_length, low, high)

    def product(xi: FloatArray) -> FloatArray:
        s = np.minimum(np.minimum(xi - low, high - xi) / ramp_length, 1.0)
        return np.asarray(function(xi) * RAMP(np.maximum(s, 0.0)), dtype=np.float64)

    inner = np.array([low + ramp_length, high - ramp_length])
    scale = float(np.abs(function(np.linspace(low, high, 257))).max())
    return PathFunction.fit(
        product,
        np.unique(np.concatenate([function.breaks, inner])),
        np.union1d(function.switches, inner),
        tolerance=_FIT_TOLERANCE * scale,
    )
