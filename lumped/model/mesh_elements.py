"""The element laws of one tooth pair that every model of the pair shares: k, c, mu and e over the path.

Sources: Abbas Al-Zubaidi 2008, eqs. 3 and 4; damping c_i = 2 zeta sqrt(k_i m_e), as He, Cho and Singh 2008.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lumped.model.bodies import bodies
from lumped.path_function import PathFunction
from lumped.path_of_contact import friction_path_function, pair_stiffness
from lumped.quasi_static.loaded_contact import loaded_contact
from lumped.quasi_static.loaded_mesh import loaded_mesh
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray

#: Fit error of c over its largest value.
_DAMPING_TOLERANCE = 1e-11
#: The same where k starts from zero: rounding of k by 1e-16 of its peak is 1e-8 in its root.
_DAMPING_TOLERANCE_FROM_ZERO = 1e-7


@dataclass(frozen=True, eq=False)
class MeshElements:
    """Element laws of one tooth pair over the interval of xi in which it can touch; zero outside.

    That is [L_XA, L_XD] with prescribed contact, and reaches beyond with loaded contact.

    N = k (delta - e) + c (delta' - e'), F = mu N (docs/theory/equations.md, eqs. 3 and 4).

    Attributes
    ----------
    stiffness : k [N/m]
    damping : c = 2 zeta sqrt(k m_e) [N s/m]
    friction : mu at nominal speed [-], signed by s = sgn(xi - L_XP)
    error : e, unloaded tooth error, positive where the teeth come too late to touch [m]
    gap : the gap that closes at the first touch, where e is not that gap (loaded, Hertz) [m]
    """

    stiffness: PathFunction
    damping: PathFunction
    friction: PathFunction
    error: PathFunction
    gap: PathFunction | None = None

    @property
    def error_slope(self) -> PathFunction:
        """E' over xi, that the damper sees: of the gap itself where e is the tangent's [-]."""
        return (self.error if self.gap is None else self.gap).slope


def mesh_elements(pair: AnyPair) -> MeshElements:
    """Return the element laws of a gear pair.

    Raises
    ------
    ParameterError : a law refuses its parameters
    NumericalError : a law is not finite on the path of contact
    """
    pair = load_gear_pair(pair)
    mass = bodies(pair).effective_mass
    if pair.mesh.contact == "loaded":
        return _loaded_elements(pair, mass)
    if pair.mesh.relief == "static":
        loaded = loaded_mesh(pair)
        stiffness, error = loaded.stiffness, loaded.error
    else:
        stiffness = pair_stiffness(pair)
        error = PathFunction.constant(0.0, *stiffness.interval)
    return MeshElements(
        stiffness=stiffness,
        damping=_damping(stiffness, pair.mesh.damping_ratio, mass),
        friction=friction_path_function(pair),
        error=error,
    )


def _loaded_elements(pair: GearPair, mass: float) -> MeshElements:
    """The laws about the static loaded motion; the damper takes hold as the load does."""
    contact = loaded_contact(pair)
    low, high = contact.stiffness.interval
    scale = 2.0 * pair.mesh.damping_ratio * np.sqrt(mass)

    def damping(xi: FloatArray) -> FloatArray:
        root = np.sqrt(np.maximum(contact.secant(xi), 0.0))
        return np.asarray(scale * root * contact.engagement(xi), dtype=np.float64)

    engaged = contact.engagement
    breaks = np.union1d(engaged.breaks, contact.secant.breaks)
    largest = float(np.abs(damping(np.linspace(low, high, 401))).max())
    return MeshElements(
        stiffness=contact.stiffness,
        damping=PathFunction.constant(0.0, low, high)
        if largest == 0.0
        else PathFunction.fit(
            damping, breaks, engaged.switches, tolerance=_DAMPING_TOLERANCE * largest, by_length=True
        ),
        friction=friction_path_function(pair, interval=(low, high)),
        error=contact.error,
        gap=contact.gap,
    )


def _damping(stiffness: PathFunction, ratio: float, mass: float) -> PathFunction:
    """c_i proportional to sqrt(k_i m_e) (He, Cho and Singh 2008)."""
    low, high = stiffness.interval
    if ratio == 0.0:
        return PathFunction.constant(0.0, low, high)
    scale = 2.0 * ratio * np.sqrt(mass)

    def damping(xi: FloatArray) -> FloatArray:
        return np.asarray(scale * np.sqrt(np.maximum(stiffness(xi), 0.0)), dtype=np.float64)

    values = damping(np.linspace(low, high, 401))
    from_zero = min(values[0], values[-1]) < 1e-3 * values.max()
    relative = _DAMPING_TOLERANCE_FROM_ZERO if from_zero else _DAMPING_TOLERANCE
    return PathFunction.fit(
        damping, stiffness.breaks, stiffness.switches, tolerance=relative * float(values.max())
    )
