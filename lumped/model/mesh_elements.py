"""The element laws of one tooth pair that every model of the pair shares: k, c, mu and e over the path.

Sources: Abbas Al-Zubaidi 2008, eqs. 3 and 4; damping c_i = 2 zeta sqrt(k_i m_e), as He, Cho and Singh 2008.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lumped.model.bodies import bodies
from lumped.path_function import PathFunction
from lumped.path_of_contact import friction_path_function, pair_stiffness
from lumped.quasi_static.loaded_mesh import loaded_mesh
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray

#: Fit error of c over its largest value.
_DAMPING_TOLERANCE = 1e-11
#: The same where k starts from zero: rounding of k by 1e-16 of its peak is 1e-8 in its root.
_DAMPING_TOLERANCE_FROM_ZERO = 1e-7


@dataclass(frozen=True, eq=False)
class MeshElements:
    """Element laws of one tooth pair over xi in [L_XA, L_XD]; zero outside.

    N = k (delta - e) + c (delta' - e'), F = mu N (docs/theory/equations.md, eqs. 3 and 4).

    Attributes
    ----------
    stiffness : k [N/m]
    damping : c = 2 zeta sqrt(k m_e) [N s/m]
    friction : mu at nominal speed [-], signed by s = sgn(xi - L_XP)
    error : e, unloaded tooth error, positive where the teeth come too late to touch [m]
    """

    stiffness: PathFunction
    damping: PathFunction
    friction: PathFunction
    error: PathFunction


def mesh_elements(pair: GearPair) -> MeshElements:
    """Return the element laws of a gear pair.

    Raises
    ------
    ParameterError : a law refuses its parameters
    NumericalError : a law is not finite on the path of contact
    """
    if pair.mesh.relief == "static":
        loaded = loaded_mesh(pair)
        stiffness, error = loaded.stiffness, loaded.error
    else:
        stiffness = pair_stiffness(pair)
        error = PathFunction.constant(0.0, *stiffness.interval)
    return MeshElements(
        stiffness=stiffness,
        damping=_damping(stiffness, pair.mesh.damping_ratio, bodies(pair).effective_mass),
        friction=friction_path_function(pair),
        error=error,
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
