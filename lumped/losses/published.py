"""Mean friction and sliding loss of a mesh as others publish them.

Sources: ISO/TR 14179-2:2001; Anderson and Loewenthal, NASA TP-1622, 1980.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from lumped.friction.iso_14179 import coefficient_of
from lumped.losses.loss_factor import loss_factor, quadrature, sliding_velocity, springs
from lumped.path_function import PathFunction
from lumped.path_of_contact import contact_path
from lumped.ranges import checked
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import FloatArray

_HALVINGS = 40


def iso_14179_of(pair: AnyPair) -> float:
    """Mean coefficient of ISO/TR 14179-2 of a pair at its operating point, with mineral oil [-]."""
    pair = load_gear_pair(pair)
    return coefficient_of(contact_path(pair))


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
