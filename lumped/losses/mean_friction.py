"""Mean friction coefficient of a mesh after ISO/TR 14179-2."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from lumped.losses.loss_factor import loss_factor
from lumped.path_of_contact import contact_path
from lumped.ranges import checked
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import FloatArray

if TYPE_CHECKING:
    pass


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


def iso_14179_of(pair: AnyPair) -> float:
    """``iso_14179_mean_coefficient`` of a pair at its operating point, with mineral oil [-]."""
    pair = load_gear_pair(pair)
    g, path = pair.geometry, contact_path(pair)
    return float(
        iso_14179_mean_coefficient(
            path.unit_load * 1e-3,
            2.0 * g.pitch_line_velocity * math.sin(g.operating_pressure_angle),
            path.radius(np.array(g.L_XP)) * 1e3,
            path.viscosity * 1e3,
            path.roughness * 1e6,
        )
    )


def iso_14179_mesh_loss(pair: AnyPair) -> float:
    """Load-dependent loss of the mesh with mineral oil after ISO/TR 14179-2, P_VZP = P mu_mz H_v [W].

    With the exact loss factor of equal load sharing, which is Ohlendorf's wherever his closed form holds.
    """
    pair = load_gear_pair(pair)
    power = pair.operating.pinion_torque * pair.operating.pinion_speed
    return power * iso_14179_of(pair) * loss_factor(pair, "uniform")
