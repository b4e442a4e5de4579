"""Springs, dampers and masses of the 6-DOF model that move like the shafts at one frequency.

Seen from its gear, a shaft with all that is on it has one dynamic stiffness D in each direction. At the
chosen frequency a spring and a mass have the same D and the same slope over the square of the frequency: mass
m = -dD/d(omega^2), stiffness k = D + omega^2 m. At zero this is static condensation: the stiffness of the
gear's centre, and the mass whose kinetic energy the statically bent shaft has.

Sources: R. J. Guyan, AIAA J. 3 (1965) 380 (static condensation); docs/theory/shafts.md.
"""

from __future__ import annotations

import math

import numpy as np

from lumped.arguments import real_number
from lumped.errors import refuse
from lumped.model.shafted import ShaftedPair, shafted_pair
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair

#: Frequencies are from zero to this [Hz].
_HIGHEST = 1e7


def condensed_bearings(pair: AnyPair, frequency: float = 0.0) -> GearPair:
    """Return the pair with bearings, masses and inertias that stand for its shafts at one frequency.

    Parameters
    ----------
    pair : a gear pair with shafts
    frequency : at which the gears' centres and rims feel the same resistance as on their shafts [Hz]. At 0
        all inertia that turns with a gear is its own; at a mesh frequency far above the couplings, that of
        motor and load is not

    Returns
    -------
    GearPair without ``shafts``; a gear has one mass, that along the line of action, and off it a stiffness
    that gives the dynamic stiffness there. Dampers are those that take the same power at the frequency.

    Raises
    ------
    ParameterError : no shafts, a frequency out of range, or one between a natural frequency of a shaft and
        the node above it, where no positive spring and inertia resist as the shaft does
    """
    pair = load_gear_pair(pair)
    frequency = real_number("frequency", frequency, 0.0, _HIGHEST)
    shafted = shafted_pair(pair)
    omega = 2.0 * math.pi * frequency
    changes: dict[str, float | None] = {"shafts": None}
    for which, name in enumerate(("pinion", "gear")):
        inertia = _seen_inertia(shafted, which, omega)
        along, mass, damping = _seen(shafted, 2 + which, omega)
        off, own_mass, off_damping = _seen(shafted, 4 + which, omega)
        off += omega**2 * (mass - own_mass)
        values = {"along": along, "off": off, "inertia": inertia}
        wrong = [f"{key} {value:.3g}" for key, value in values.items() if not value > 0.0]
        if wrong:
            allowed = f"a frequency at which the {name}'s shaft resists like a spring and an inertia"
            action = f"There, {', '.join(wrong)}: choose another one, or take supports='shafts'."
            raise refuse("frequency", f"{frequency:g} Hz", allowed, action)
        changes |= {
            f"{name}.mass": mass,
            f"{name}.inertia": inertia,
            f"bearings.{name}.loa_stiffness": along,
            f"bearings.{name}.oloa_stiffness": off,
            f"bearings.{name}.loa_damping_ratio": min(damping / (2.0 * math.sqrt(along * mass)), 2.0),
            f"bearings.{name}.oloa_damping_ratio": min(off_damping / (2.0 * math.sqrt(off * mass)), 2.0),
        }
    return pair.with_(changes)


def _seen(shafted: ShaftedPair, row: int, omega: float) -> tuple[float, float, float]:
    """Stiffness [N/m], mass [kg] and damping [N s/m] that a gear's centre feels, teeth apart."""
    shape = shafted.gears[row]
    own = np.flatnonzero(shape)
    shape, squares = shape[own], shafted.frequencies[own] ** 2
    receptance = float(np.sum(shape**2 / (squares - omega**2)))
    stiffness = 1.0 / receptance
    mass = stiffness**2 * float(np.sum((shape / (squares - omega**2)) ** 2))
    moved = stiffness * shape / (squares - omega**2)
    damping = float(moved @ shafted.damping[np.ix_(own, own)] @ moved)
    return stiffness + omega**2 * mass, mass, damping


def _seen_inertia(shafted: ShaftedPair, which: int, omega: float) -> float:
    """Inertia that the rim of a gear feels [kg m^2], from all modes of its shaft's twist and its turn."""
    shape, squares = shafted.gears[which], shafted.frequencies**2
    elastic = squares > 0.0
    rigid = float(np.sum(shape[~elastic] ** 2))
    if omega == 0.0:
        return 1.0 / rigid
    return 1.0 / (rigid - omega**2 * float(np.sum(shape[elastic] ** 2 / (squares[elastic] - omega**2))))
