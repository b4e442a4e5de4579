"""What a statically loaded mesh hands to the linear dynamic model: k_i(xi; T) and e_i(xi).

The linear model keeps every pair in contact over a fixed interval. With relief that interval depends on the
load: a pair takes part where delta(T) - e_i > 0. There its stiffness is k_i and its unloaded error e_i;
elsewhere it carries nothing. Contact before A and behind D is left out: the linear model's path of contact is
A to D.

Sources: docs/theory/mesh_physics.md, "Load sharing and static transmission error".
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import brentq

from lumped.errors import NumericalError
from lumped.gear_geometry.geometry import Geometry
from lumped.path_function import PathFunction
from lumped.path_of_contact import pair_stiffness
from lumped.quasi_static.load_sharing import share_load
from lumped.quasi_static.tooth_error import error_function
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray

#: Samples over the path of contact between which contact begins or ends at most once.
_SAMPLES = 2000


@dataclass(frozen=True, eq=False)
class LoadedMesh:
    """One tooth pair in the statically loaded mesh, over xi in [L_XA, L_XD].

    Attributes
    ----------
    stiffness : k(xi; T), zero where the loaded pair is apart [N/m]
    error : e(xi), unloaded [m]
    contact : (n, 2) intervals of xi in which the pair carries load [m]
    """

    stiffness: PathFunction
    error: PathFunction
    contact: FloatArray


def loaded_mesh(pair: GearPair) -> LoadedMesh:
    """Stiffness and unloaded error of a tooth pair for the linear model at the operating torque.

    Raises
    ------
    ParameterError : a relief starts outside the active flank
    NumericalError : at this torque no pair touches at some position
    """
    g, torque = pair.geometry, pair.operating.pinion_torque
    k, error = pair_stiffness(pair), error_function(pair)
    if not error.coefficients.any():
        return LoadedMesh(k, error, np.array([[g.L_XA, g.L_XD]]))
    force = torque / g.base_radius_pinion

    def clearance(xi: FloatArray) -> FloatArray:
        return _clearance(xi, k, error, force, g)

    contact = _positive_intervals(clearance, g, np.concatenate([k.switches, error.switches]))
    if contact.size == 0:
        raise NumericalError(
            f"At {torque:g} N m no tooth pair carries load: raise the torque or lower the relief."
        )
    return LoadedMesh(_restricted(k, contact), error, contact)


def _clearance(xi: FloatArray, k: PathFunction, error: PathFunction, force: float, g: Geometry) -> FloatArray:
    """Approach minus error of the pair at xi, with its neighbours a pitch apart; (n,) [m]."""
    shifts = np.arange(1 - g.pairs, g.pairs) * g.base_pitch
    place = xi[:, None] + shifts
    outside = (place < g.L_XA) | (place > g.L_XD)
    e = np.where(outside, np.inf, error(place))
    delta = share_load(np.where(outside, 0.0, k(place)), e, force).transmission_error
    return np.asarray(delta - e[:, g.pairs - 1], dtype=np.float64)


def _positive_intervals(
    function: Callable[[FloatArray], FloatArray], g: Geometry, kinks: FloatArray
) -> FloatArray:
    """Intervals of [L_XA, L_XD] in which a piecewise smooth function is positive; (n, 2)."""
    inside = 1e-12 * g.base_pitch
    jumps = np.add.outer(np.array([g.L_XA, g.L_XD, *kinks]), np.arange(-g.pairs, g.pairs + 1) * g.base_pitch)
    marks = np.unique(jumps[(jumps > g.L_XA + inside) & (jumps < g.L_XD - inside)])
    ends: list[float] = []
    for low, high in itertools.pairwise([g.L_XA, *marks, g.L_XD]):
        if high - low <= 4 * inside:
            continue
        count = max(3, int(_SAMPLES * (high - low) / (g.L_XD - g.L_XA)))
        xi = np.linspace(low + inside, high - inside, count)
        positive = function(xi) > 0.0
        roots = [
            float(brentq(lambda x: float(function(np.array([x]))[0]), xi[j], xi[j + 1], xtol=1e-16))
            for j in np.flatnonzero(np.diff(positive))
        ]
        ends += [*([low] if positive[0] else []), *roots, *([high] if positive[-1] else [])]
    meet = 2 * np.flatnonzero(np.diff(ends)[1::2] <= 4 * inside)  # intervals that meet at a mark are one
    return np.delete(ends, [*(meet + 1), *(meet + 2)]).reshape(-1, 2)


def _restricted(k: PathFunction, contact: FloatArray) -> PathFunction:
    """The function on the intervals, zero between them; jumps are switches."""
    low, high = k.interval
    k, ends = k.split(contact), contact.ravel()
    middle = 0.5 * (k.breaks[:-1] + k.breaks[1:])
    loaded = ((middle[:, None] > contact[:, 0]) & (middle[:, None] < contact[:, 1])).any(axis=1)
    jumps = ends[(ends > low) & (ends < high)]
    return PathFunction(k.breaks, np.where(loaded, k.coefficients, 0.0), np.union1d(k.switches, jumps))
