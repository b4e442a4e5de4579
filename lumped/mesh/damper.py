"""The damper of a tooth pair: its coefficient, the share of it that acts, and the power that it takes.

    c = 2 zeta sqrt(k m_e),   N = N_el + s(N_el) c p',   P = s c p'^2

zeta is ``mesh.damping_ratio``, k the stiffness of the pair, m_e the effective mass of both gears on the line
of action, p' the rate of the compression. The share s rises smoothly from 0 to 1 with the elastic load, so
that a pair begins and ends its contact without a jump of the force. All damper forces of ``lumped`` take c
and s from here.

Sources: He, Cho and Singh 2008; docs/theory/contact_energy.md, "Energy of one pair".
"""

from __future__ import annotations

from collections.abc import Callable
from typing import overload

import numpy as np

from lumped.compiler import inlined
from lumped.mesh.records import ContactLaw, Record
from lumped.typing import FloatArray

#: The whole damper of a pair acts where the pair carries this share of the mean load.
FULL_DAMPING = 1.0 / 15.0


@overload
def damping_coefficient(ratio: float, stiffness: float, mass: float) -> float: ...
@overload
def damping_coefficient(ratio: float, stiffness: FloatArray, mass: float) -> FloatArray: ...
def damping_coefficient(ratio: float, stiffness: float | FloatArray, mass: float) -> float | FloatArray:
    """Damping coefficient c = 2 zeta sqrt(k m_e) [N s/m] of tooth pairs with stiffness k [N/m].

    Parameters
    ----------
    ratio : zeta [-]
    stiffness : k, a number or an array of any shape [N/m]
    mass : m_e [kg]
    """
    coefficient: float | FloatArray = 2.0 * ratio * np.sqrt(stiffness * mass)
    return coefficient


def damping_law(
    ratio: float, stiffness: Callable[[FloatArray], FloatArray], mass: float
) -> Callable[[FloatArray], FloatArray]:
    """Return c(xi) of ``damping_coefficient`` for a stiffness law k(xi), whose rounding below 0 counts as 0.

    c of k is c of 1 N/m times sqrt(k).
    """
    of_unit_stiffness = damping_coefficient(ratio, 1.0, mass)

    def damping(xi: FloatArray) -> FloatArray:
        root = np.sqrt(np.maximum(stiffness(xi), 0.0))
        return np.asarray(of_unit_stiffness * root, dtype=np.float64)

    return damping


def rescaled_damping(damping: FloatArray, stiffness: FloatArray, former_stiffness: FloatArray) -> FloatArray:
    """Return the damping coefficient after a change of the stiffness, as c grows with sqrt(k) [N s/m]."""
    ratio = stiffness / np.where(former_stiffness > 0.0, former_stiffness, 1.0)
    return np.asarray(damping * np.sqrt(ratio), dtype=np.float64)


@inlined
def damper_share(load: float, law: ContactLaw) -> float:
    """Share s of the damper that acts at an elastic load: s = x^2 (3 - 2 x), x = N_el over the full load.

    With prescribed contact the whole damper acts.
    """
    if law.prescribed:
        return 1.0
    x = min(max(load / law.full_damper, 0.0), 1.0)
    return x * x * (3.0 - 2.0 * x)


@inlined
def acting_damping(pair: Record, contact: Record, law: ContactLaw) -> float:
    """Damping coefficient s c of a pair at its elastic load [N s/m]."""
    damping: float = pair.damping * damper_share(contact.load, law)
    return damping


@inlined
def damper_power(damper_force: float, compression_rate: float) -> float:
    """Power that a damper takes [W]: its force times the rate of the compression."""
    return damper_force * compression_rate
