"""What a statically loaded mesh hands to the linear dynamic model: k_i(xi; T) and e_i(xi).

The linear model keeps every pair in contact over a fixed interval. With relief that interval depends on the
load: a pair takes part where delta(T) - e_i > 0. There its stiffness is k_i and its unloaded error e_i;
elsewhere it carries nothing. Contact before A and behind D is left out: the linear model's path of contact is
A to D.

Sources: docs/theory/mesh_physics.md, "Load sharing and static transmission error".
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lumped.errors import NumericalError
from lumped.gear_geometry.geometry import Geometry
from lumped.path_function import PathFunction
from lumped.path_of_contact import pair_stiffness
from lumped.quasi_static.intervals import positive_intervals, restricted
from lumped.quasi_static.load_sharing import share_load
from lumped.quasi_static.tooth_error import error_function
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import FloatArray


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


def loaded_mesh(pair: AnyPair) -> LoadedMesh:
    """Stiffness and unloaded error of a tooth pair for the linear model at the operating torque.

    Raises
    ------
    ParameterError : a relief starts outside the active flank
    NumericalError : at this torque no pair touches at some position
    """
    pair = load_gear_pair(pair)
    g, torque = pair.geometry, pair.operating.pinion_torque
    k, error = pair_stiffness(pair), error_function(pair)
    if not error.coefficients.any():
        return LoadedMesh(k, error, np.array([[g.L_XA, g.L_XD]]))
    force = torque / g.base_radius_pinion

    def clearance(xi: FloatArray) -> FloatArray:
        return _clearance(xi, k, error, force, g)

    kinks = np.concatenate([[g.L_XA, g.L_XD], k.switches, error.switches])
    kinks = np.add.outer(kinks, np.arange(-g.pairs, g.pairs + 1) * g.base_pitch)
    contact = positive_intervals(clearance, g.L_XA, g.L_XD, kinks, g.base_pitch)
    if contact.size == 0:
        raise NumericalError(
            f"At {torque:g} N m no tooth pair carries load: raise the torque or lower the relief."
        )
    return LoadedMesh(restricted(k, contact), error, contact)


def _clearance(xi: FloatArray, k: PathFunction, error: PathFunction, force: float, g: Geometry) -> FloatArray:
    """Approach minus error of the pair at xi, with its neighbours a pitch apart; (n,) [m]."""
    shifts = np.arange(1 - g.pairs, g.pairs) * g.base_pitch
    place = xi[:, None] + shifts
    outside = (place < g.L_XA) | (place > g.L_XD)
    e = np.where(outside, np.inf, error(place))
    delta = share_load(np.where(outside, 0.0, k(place)), e, force).transmission_error
    return np.asarray(delta - e[:, g.pairs - 1], dtype=np.float64)
