"""Prescribed contact: a tooth pair touches from A to D, except where relief keeps it apart under the static
load.

The linear model keeps every pair in contact over a fixed interval. With relief the interval depends on the
load: a pair takes part where delta(T) - e_i > 0. There the stiffness is k_i and the unloaded error e_i;
elsewhere the pair has no load. Contact before A and behind D is left out.

Sources: docs/theory/mesh_physics.md, "Load sharing and static transmission error".
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from lumped.errors import NumericalError
from lumped.mesh.damper import damping_law
from lumped.path_function import PathFunction
from lumped.path_of_contact import friction_path_function, pair_stiffness
from lumped.quasi_static.elements import Contact, MeshElements, at_rest, positive_intervals, restricted
from lumped.quasi_static.load_sharing import share_load
from lumped.quasi_static.tooth_error import error_function
from lumped.schema.bodies import bodies_of
from lumped.schema.pair import GearPair
from lumped.typing import BoolArray, FloatArray

#: Fit error of c over its largest value.
_DAMPING_TOLERANCE = 1e-11
#: The same where k starts from zero: a rounding error of 1e-16 of the peak of k is 1e-8 in sqrt(k).
_DAMPING_TOLERANCE_FROM_ZERO = 1e-7


class Prescribed(Contact):
    """Prescribed contact.

    No pair moves another; k(xi) delta has no potential, so the brake balances sliding only.
    """

    name = "prescribed"
    conservative = False
    pressed = "a tooth pair"
    root_damping = True

    def elements(self, pair: GearPair) -> MeshElements:
        """Return the stiffness of the model and the error of the reliefs, from A to D."""
        if pair.mesh.relief == "static":
            stiffness, error = _loaded_mesh(at_rest(pair))
        else:
            stiffness = pair_stiffness(pair)
            error = PathFunction.constant(0.0, *stiffness.interval)
        return MeshElements(
            stiffness=stiffness,
            damping=_damping(stiffness, pair.mesh.damping_ratio, bodies_of(pair).effective_mass),
            friction=friction_path_function(pair),
            error=error,
        )

    def neighbours(self, pair: GearPair) -> tuple[()]:
        """Return no functions: no pair moves another."""
        return ()

    def unilateral_elements(self, pair: GearPair) -> MeshElements:
        """Return the stiffness from A to D, also where a pair is apart in statics, and the reliefs' error."""
        if pair.mesh.relief == "ignored":
            return self.elements(pair)
        return replace(self.elements(pair.with_(mesh__relief="ignored")), error=error_function(pair))

    def pressing(self, load: FloatArray, contact: BoolArray) -> tuple[FloatArray, BoolArray]:
        """Return the load of every pair in contact."""
        return load, contact


@lru_cache(maxsize=32)
def _loaded_mesh(pair: GearPair) -> tuple[PathFunction, PathFunction]:
    """k(xi; T) [N/m] at the operating torque, zero where the loaded pair is apart, and e(xi) [m]."""
    g = pair.geometry
    torque = pair.operating.pinion_torque
    k = pair_stiffness(pair)
    error = error_function(pair)
    if not error.coefficients.any():
        return k, error
    force = torque / g.base_radius_pinion
    shifts = np.arange(1 - g.pairs, g.pairs) * g.base_pitch

    def clearance(xi: FloatArray) -> FloatArray:
        """Approach less error of the pair at xi (n,), whose neighbours are whole pitches away [m]."""
        place = xi[:, None] + shifts
        outside = (place < g.L_XA) | (place > g.L_XD)
        e = np.where(outside, np.inf, error(place))
        delta = share_load(np.where(outside, 0.0, k(place)), e, force).transmission_error
        return np.asarray(delta - e[:, g.pairs - 1], dtype=np.float64)

    kinks = np.concatenate([[g.L_XA, g.L_XD], k.switches, error.switches])
    kinks = np.add.outer(kinks, np.arange(-g.pairs, g.pairs + 1) * g.base_pitch)
    contact = positive_intervals(clearance, g.L_XA, g.L_XD, kinks, g.base_pitch)
    if contact.size == 0:
        raise NumericalError(
            f"At {torque:g} N m no tooth pair carries load: raise the torque or lower the relief."
        )
    return restricted(k, contact), error


def _damping(stiffness: PathFunction, ratio: float, mass: float) -> PathFunction:
    """Fit the damping coefficient c(xi) of ``lumped.mesh.damper.damping_law``."""
    low, high = stiffness.interval
    if ratio == 0.0:
        return PathFunction.constant(0.0, low, high)
    damping = damping_law(ratio, stiffness, mass)
    values = damping(np.linspace(low, high, 401))
    from_zero = min(values[0], values[-1]) < 1e-3 * values.max()
    relative = _DAMPING_TOLERANCE_FROM_ZERO if from_zero else _DAMPING_TOLERANCE
    return PathFunction.fit(
        damping, stiffness.breaks, stiffness.switches, tolerance=relative * float(values.max())
    )
