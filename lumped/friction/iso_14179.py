"""Mean friction coefficient of ISO/TR 14179-2, one number over the path of contact."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from lumped.friction.base import ContactPath, FrictionLaw, FrictionSettings
from lumped.friction.misfit import constant
from lumped.ranges import ValidityRange, checked
from lumped.typing import FloatArray

_RECALLED = "limit of the formula in ISO/TR 14179-2, source not checked"
RANGES = (
    ValidityRange("unit_load", "N/mm", 150.0, None, _RECALLED),
    ValidityRange("pitch_line_velocity", "m/s", None, 50.0, _RECALLED),
)


def iso_14179_mean_coefficient(
    unit_load: ArrayLike,
    sum_velocity: ArrayLike,
    radius: ArrayLike,
    viscosity: ArrayLike,
    roughness: ArrayLike,
    oil_factor: ArrayLike = 1.0,
) -> FloatArray:
    """Mean friction coefficient over the path of contact.

    mu_mz = 0.048 (w / (v_sum rho))^0.2 eta^-0.05 Ra^0.25 X_L

    Parameters
    ----------
    unit_load : w = F_bt/b, base-tangential load per face width [N/mm]
    sum_velocity : v_sum, sum of the rolling velocities at the pitch point, 2 v_t sin(alpha_w) [m/s]
    radius : rho, reduced radius of curvature at the pitch point [mm]
    viscosity : eta at the oil temperature, dynamic [mPa s]
    roughness : Ra, mean of both gears [um]
    oil_factor : X_L, 1 for mineral oil [-]

    Returns
    -------
    mu_mz [-]

    Raises
    ------
    ParameterError : an argument negative, zero where a power needs it, or not finite

    References
    ----------
    ISO/TR 14179-2:2001, after K. Schlenk's tests on FZG gears.

    Examples
    --------
    >>> round(float(iso_14179_mean_coefficient(200, 6, 8, 20, 0.4)), 4)
    0.0437
    """
    w = checked("unit_load", unit_load, "N/mm", allow_zero=True)
    v = checked("sum_velocity", sum_velocity, "m/s")
    rho = checked("radius", radius, "mm")
    eta = checked("viscosity", viscosity, "mPa s")
    ra = checked("roughness", roughness, "um", allow_zero=True)
    factor = checked("oil_factor", oil_factor, "")
    return np.asarray(0.048 * (w / (v * rho)) ** 0.2 * eta**-0.05 * ra**0.25 * factor, dtype=np.float64)


def coefficient_of(path: ContactPath) -> float:
    """``iso_14179_mean_coefficient`` of a contact, with mineral oil [-]."""
    pitch = np.array(path.L_XP)
    return float(
        iso_14179_mean_coefficient(
            path.unit_load * 1e-3,
            path.entraining_velocity(pitch),
            path.radius(pitch) * 1e3,
            path.viscosity * 1e3,
            path.roughness * 1e6,
        )
    )


def _signed(xi: FloatArray, path: ContactPath, settings: FrictionSettings) -> FloatArray:
    return np.asarray(coefficient_of(path) * np.sign(xi - path.L_XP), dtype=np.float64)


LAW = FrictionLaw(
    name="iso_14179",
    label="ISO/TR 14179-2",
    formula=_signed,
    switches=lambda path, settings: [path.L_XP],
    ranges=RANGES,
    reads=frozenset({"viscosity", "roughness"}),
    fluid_film=True,
    factor=lambda path, settings: coefficient_of(path),
    analytic=constant(lambda path, settings: coefficient_of(path)),
)
