"""Tooth loss factor H_v: the sliding loss over mu times the transmitted power.

Sources: Ohlendorf 1958; docs/theory/mesh_physics.md, "Losses".
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from lumped.gear_geometry.geometry import Geometry
from lumped.losses.cycle import CyclePositions, quadrature
from lumped.losses.sharing import Sharing, springs
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import FloatArray

if TYPE_CHECKING:
    pass


def ohlendorf(
    teeth_pinion: float, teeth_gear: float, contact_ratio_1: float, contact_ratio_2: float
) -> float:
    """Ohlendorf's loss factor of a spur pair in closed form.

    H_v = pi (u + 1)/(z_1 u) (1 - eps_alpha + eps_1^2 + eps_2^2), eps_alpha = eps_1 + eps_2

    Parameters
    ----------
    teeth_pinion, teeth_gear : z_1, z_2; u = z_2/z_1
    contact_ratio_1, contact_ratio_2 : addendum contact ratios of pinion and gear, path from P to D and from A
        to P over the base pitch

    Returns
    -------
    H_v [-]

    Notes
    -----
    Exact for constant mu, load shared equally between two pairs, contact ratio 1 to 2 and a pitch point in
    single contact (eps_1, eps_2 <= 1). With s = (xi - L_XP)/p the sliding velocity is
    v_t 2 pi (u + 1)/(z_1 u) |s|; half the load over the whole path gives (eps_1^2 + eps_2^2)/4, the other
    half in single contact, eps_1 - 1 < s < 1 - eps_2, gives ((1 - eps_1)^2 + (1 - eps_2)^2)/4. Outside of
    these conditions use ``loss_factor``.

    References
    ----------
    H. Ohlendorf, "Verlustleistung und Erwaermung von Stirnraedern", dissertation, TH Muenchen, 1958; the
    tooth loss factor of ISO/TR 14179-2.

    Examples
    --------
    >>> round(ohlendorf(28, 28, 0.819, 0.819), 4)
    0.1579
    """
    u = teeth_gear / teeth_pinion
    overlap = 1.0 - contact_ratio_1 - contact_ratio_2 + contact_ratio_1**2 + contact_ratio_2**2
    return math.pi * (u + 1.0) / (teeth_pinion * u) * overlap


def addendum_contact_ratios(g: Geometry) -> tuple[float, float]:
    """eps_1 = (L_XD - L_XP)/p of the pinion's addendum and eps_2 = (L_XP - L_XA)/p of the gear's [-]."""
    return (g.L_XD - g.L_XP) / g.base_pitch, (g.L_XP - g.L_XA) / g.base_pitch


def ohlendorf_of(pair: AnyPair) -> float:
    """Ohlendorf's loss factor of a gear pair [-], see ``ohlendorf``."""
    pair = load_gear_pair(pair)
    return ohlendorf(pair.pinion.teeth, pair.gear.teeth, *addendum_contact_ratios(pair.geometry))


def loss_factor(pair: AnyPair, sharing: Sharing = "uniform") -> float:
    """Loss factor by exact integration, for any contact ratio and load sharing.

    H_v = 1/(p v_t) INTEGRAL over the cycle of SUM share_i |v_s,i|, v_t = Omega_p r_bp

    Parameters
    ----------
    pair : the gear pair
    sharing : see ``lumped.losses.sharing``

    Returns
    -------
    H_v [-]; the mean sliding loss of a constant mu is mu H_v times the power, to first order in mu
    """
    pair = load_gear_pair(pair)
    g = pair.geometry
    teeth = springs(pair, sharing)
    at = quadrature(g, teeth.functions)
    return mean_loss_factor(g, at, teeth.share(at))


def mean_loss_factor(g: Geometry, at: CyclePositions, share: FloatArray) -> float:
    """H_v of given load shares (pairs, k) at the nodes of a cycle."""
    slide = sliding_velocity(g, at.position)
    return at.mean((share * np.abs(slide)).sum(axis=0)) / (g.omega_pinion * g.base_radius_pinion)


def sliding_velocity(g: Geometry, position: FloatArray) -> FloatArray:
    """Nominal v_p - v_g = Omega_p xi - Omega_g (L_XY - xi) [m/s], signed."""
    return np.asarray((g.omega_pinion + g.omega_gear) * (position - g.L_XP), dtype=np.float64)
