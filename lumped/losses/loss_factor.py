"""Tooth loss factor H_v: the sliding loss over mu times the transmitted power; how pairs share the load.

Sources: Ohlendorf 1958; docs/theory/mesh_physics.md, "Load sharing and static transmission error", "Losses".
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from lumped.arguments import one_of
from lumped.gear_geometry.geometry import Geometry
from lumped.path_function import PathFunction
from lumped.quasi_static.contacts import CONTACTS
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import BoolArray, FloatArray

#: Exact to degree 15: a fitted mu of degree 8 times a sliding velocity of degree 1, and a load share.
_NODES = 8
_SAME = 1e-13  # of a base pitch: edges closer than this are one
#: "elements": stiffness and tooth error as the dynamic model has them; "uniform": equal shares.
Sharing = Literal["elements", "uniform"]


@dataclass(frozen=True, eq=False)
class CyclePositions:
    """Positions xi_i of all tooth pairs at instants of one mesh cycle, pair 0 ahead.

    Attributes
    ----------
    weight : (k,) quadrature weights, sum 1
    position : (pairs, k) [m]
    contact : (pairs, k) whether L_XA <= xi_i < L_XD
    """

    weight: FloatArray
    position: FloatArray
    contact: BoolArray

    def mean(self, values: FloatArray) -> float:
        """Mean over the cycle of values (k,)."""
        return float(self.weight @ values)


def quadrature(g: Geometry, functions: Iterable[PathFunction]) -> CyclePositions:
    """Gauss-Legendre nodes on every stretch of the cycle between two breaks of the functions, P, A and D."""
    marks = np.concatenate([np.array([g.L_XA, g.L_XP, g.L_XD]), *(f.breaks for f in functions)])
    folded = np.sort(np.mod(marks - g.L_XA, g.base_pitch))
    edges = np.concatenate([[0.0], folded, [g.base_pitch]])
    edges = edges[np.append(True, np.diff(edges) > _SAME * g.base_pitch)]
    edges[-1] = g.base_pitch
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    half = 0.5 * np.diff(edges)
    phase = (edges[:-1] + half)[:, None] + half[:, None] * nodes
    weight = np.asarray(half[:, None] * weights / g.base_pitch, dtype=np.float64)
    position = g.L_XA + np.arange(g.pairs - 1, -1, -1)[:, None] * g.base_pitch + phase.ravel()
    return CyclePositions(weight.ravel(), position, position < g.L_XD)


@dataclass(frozen=True, eq=False)
class Springs:
    """Tooth pairs as springs k(xi) with unloaded errors e(xi) [m], or none, under a mesh force [N]."""

    stiffness: PathFunction
    error: PathFunction | None
    force: float

    @property
    def functions(self) -> list[PathFunction]:
        """Path functions from which the shares follow."""
        return [self.stiffness] if self.error is None else [self.stiffness, self.error]

    def share(self, positions: CyclePositions) -> FloatArray:
        """Fraction of the mesh load on each pair; (pairs, k), sums to 1 over the pairs.

        All pairs deflect by the same delta = (F + SUM k_i e_i)/SUM k_i and carry k_i (delta - e_i).
        """
        k = np.where(positions.contact, self.stiffness(positions.position), 0.0)
        if self.error is None:
            return np.asarray(k / k.sum(axis=0), dtype=np.float64)
        e = np.where(positions.contact, self.error(positions.position), 0.0)
        delta = (self.force + (k * e).sum(axis=0)) / k.sum(axis=0)
        return np.asarray(k * (delta - e) / self.force, dtype=np.float64)


def springs(pair: GearPair, sharing: Sharing) -> Springs:
    """Return the springs that share the load of a gear pair, see ``Sharing``."""
    g = pair.geometry
    force = pair.operating.pinion_torque / g.base_radius_pinion
    one_of("sharing", sharing, get_args(Sharing))
    if sharing == "uniform":
        return Springs(PathFunction.constant(1.0, g.L_XA, g.L_XD), None, force)
    # Positions are those from A to D, so contact is the prescribed one.
    laws = CONTACTS["prescribed"].elements(pair)
    return Springs(laws.stiffness, laws.error, force)


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


def ohlendorf_of(pair: AnyPair) -> float:
    """Ohlendorf's loss factor of a gear pair [-], see ``ohlendorf``."""
    pair = load_gear_pair(pair)
    g = pair.geometry
    addenda = (g.L_XD - g.L_XP) / g.base_pitch, (g.L_XP - g.L_XA) / g.base_pitch
    return ohlendorf(pair.pinion.teeth, pair.gear.teeth, *addenda)


def loss_factor(pair: AnyPair, sharing: Sharing = "uniform") -> float:
    """Loss factor by exact integration, for any contact ratio and load sharing.

    H_v = 1/(p v_t) INTEGRAL over the cycle of SUM share_i |v_s,i|, v_t = Omega_p r_bp

    Parameters
    ----------
    pair : the gear pair
    sharing : how pairs share the load, see ``Sharing``

    Returns
    -------
    H_v [-]; the mean sliding loss of a constant mu is mu H_v times the power, to first order in mu
    """
    pair = load_gear_pair(pair)
    g = pair.geometry
    teeth = springs(pair, sharing)
    positions = quadrature(g, teeth.functions)
    return mean_loss_factor(g, positions, teeth.share(positions))


def mean_loss_factor(g: Geometry, positions: CyclePositions, share: FloatArray) -> float:
    """H_v of load shares (pairs, k) at positions of a mesh cycle."""
    slide = sliding_velocity(g, positions.position)
    return positions.mean((share * np.abs(slide)).sum(axis=0)) / (g.omega_pinion * g.base_radius_pinion)


def sliding_velocity(g: Geometry, position: FloatArray) -> FloatArray:
    """Nominal v_p - v_g = Omega_p xi - Omega_g (L_XY - xi) [m/s], signed."""
    return np.asarray((g.omega_pinion + g.omega_gear) * (position - g.L_XP), dtype=np.float64)
