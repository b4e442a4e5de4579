"""Mean friction and sliding loss of a mesh as others publish them.

Sources: ISO/TR 14179-2:2001; Anderson and Loewenthal, NASA TP-1622, 1980.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from lumped.losses.loss_factor import loss_factor, quadrature, sliding_velocity, springs
from lumped.path_function import PathFunction
from lumped.path_of_contact import contact_path
from lumped.ranges import checked
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import FloatArray

_HALVINGS = 40


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


def anderson_loewenthal_coefficient(
    unit_load: ArrayLike, viscosity: ArrayLike, sliding_velocity: ArrayLike, sum_velocity: ArrayLike
) -> FloatArray:
    """Friction coefficient of the loss model, Benedict and Kelley's for smooth surfaces.

    f = 0.0127 log10(29.66 w / (mu v_s v_T^2)), not below 0

    Parameters
    ----------
    unit_load : w, load of one tooth pair per face width [N/mm]
    viscosity : mu, dynamic viscosity of the oil [Pa s]
    sliding_velocity : v_s [m/s], > 0
    sum_velocity : v_T, sum of the rolling velocities [m/s]

    Returns
    -------
    f [-]

    References
    ----------
    N. E. Anderson and S. H. Loewenthal, "Spur-gear-system efficiency at part and full load",
    NASA TP-1622, 1980.

    Examples
    --------
    >>> round(float(anderson_loewenthal_coefficient(100, 0.01, 2, 10)), 5)
    0.04027
    """
    w = checked("unit_load", unit_load, "N/mm")
    eta = checked("viscosity", viscosity, "Pa s")
    v_s = checked("sliding_velocity", sliding_velocity, "m/s")
    v_t = checked("sum_velocity", sum_velocity, "m/s")
    f = 0.0127 * np.log10(29.66 * w / (eta * v_s * v_t**2))
    return np.asarray(np.maximum(f, 0.0), dtype=np.float64)


def anderson_loewenthal_sliding_loss(pair: AnyPair) -> float:
    """Mean sliding loss of the mesh [W].

    The instantaneous loss f w v_s of every pair in contact, each pair with an equal share of the load, is
    averaged over the mesh cycle. Unlike law II along the path, which takes the full static load everywhere,
    the coefficient belongs to the load that the pair carries. Rolling and windage losses of the same report
    are not part of it.
    """
    pair = load_gear_pair(pair)
    g, path = pair.geometry, contact_path(pair)
    at = quadrature(g, [_graded(g.L_XA, g.L_XP, g.L_XD)])
    touching, xi = at.contact, at.position[at.contact]
    share = springs(pair, "uniform").share(at)
    loads, slide = share[touching] * path.unit_load, np.abs(sliding_velocity(g, xi))  # N/m, m/s
    f = anderson_loewenthal_coefficient(loads * 1e-3, path.viscosity, slide, path.entraining_velocity(xi))
    power = np.zeros_like(share)
    power[touching] = f * loads * slide
    return at.mean(power.sum(axis=0)) * g.face_width


def _graded(low: float, pitch: float, high: float) -> PathFunction:
    """A constant whose breaks close in on P by halves: the loss has a v_s log(v_s) there."""
    scale = 0.5 ** np.arange(_HALVINGS)
    breaks = np.unique(
        np.concatenate([pitch - (pitch - low) * scale, [pitch], pitch + (high - pitch) * scale])
    )
    return PathFunction(breaks, np.ones((1, breaks.size - 1)), np.empty(0))
