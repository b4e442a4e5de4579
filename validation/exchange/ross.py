"""Rotors of ROSS, the rotor dynamics package of Petrobras and UFRJ, at their running speed.

Sources: R. Timbó et al., ROSS - Rotordynamic Open Source Software, J. Open Source Software 5(48) (2020) 2120.
"""

from __future__ import annotations

import math
from typing import Any, Protocol

import numpy as np

from floquet import GearRotor
from lumped.arguments import one_of, real_number
from lumped.errors import refuse
from lumped.typing import FloatArray

#: Coordinates of a node: x, y, z, rotations alpha, beta, theta about them; the shaft along z.
_PER_NODE = 6


class RossRotor(Protocol):
    """What is asked of a ``ross.Rotor``."""

    nodes: list[int]
    number_dof: int

    def M(self) -> FloatArray:
        """Mass."""

    def C(self, frequency: float) -> FloatArray:
        """Damping at a frequency [rad/s]."""

    def K(self, frequency: float) -> FloatArray:
        """Stiffness at a frequency [rad/s]."""

    def G(self) -> FloatArray:
        """Gyroscopic matrix for 1 rad/s."""


def ross_rotor(rotor: RossRotor, node: int, speed_rpm: float) -> GearRotor:
    """Return M, C and K of a ROSS rotor at its running speed, with the station of a node.

    C is that of ROSS and the speed times its gyroscopic matrix; bearings have their values at that speed.

    Parameters
    ----------
    rotor : a ``ross.Rotor`` with six coordinates a node, as ROSS 2 makes it
    node : where the gear sits
    speed_rpm : negative where the rotor turns from y to x, as the gear of an external pair does [rpm]

    Raises
    ------
    ParameterError : another object, a node that it does not have, or elements without torsion
    """
    methods = all(callable(getattr(rotor, name, None)) for name in "MCKG")
    if not methods or getattr(rotor, "number_dof", None) != _PER_NODE:
        wanted = "a ross.Rotor with six coordinates a node"
        raise refuse("rotor", type(rotor).__name__, wanted, "Use ROSS 2 or later, or elements with torsion.")
    number: Any = one_of("node", str(node), map(str, rotor.nodes), "Choose a node of the rotor.")
    speed = math.pi / 30.0 * real_number("speed_rpm", speed_rpm, unit="rpm")
    first = _PER_NODE * list(map(str, rotor.nodes)).index(number)
    M, K = (np.asarray(B, dtype=float) for B in (rotor.M(), rotor.K(abs(speed))))
    C = np.asarray(rotor.C(abs(speed)), dtype=float) + speed * np.asarray(rotor.G(), dtype=float)
    return GearRotor(M, C, K, (first, first + 1, first + 5))
