"""Gears whose teeth differ: base circles off their axes, and the error of the tooth that is in contact.

The number of a tooth comes from the actual angle of its gear, whole turns included. Sources:
docs/theory/teeth.md.
"""

from __future__ import annotations

import math

import numpy as np

from lumped.errors import refuse
from lumped.schema.pair import GearPair
from lumped.teeth.pairs import first_teeth, own_teeth
from lumped.typing import FloatArray
from multibody.contact.kinematics import compiled

#: Places in the block of a pair: of pinion and gear eccentricity [m], its angle at t = 0 [rad], number of
#: teeth, tooth at A at t = 0; then the errors of the pinion's teeth and of the gear's [m].
ECCENTRICITY, ANGLE, TEETH, FIRST, COLUMNS = 0, 1, 2, 3, 4
ERRORS = 2 * COLUMNS


def block(pair: GearPair) -> FloatArray:
    """The block of a pair; empty for like teeth."""
    if pair.healthy is pair:
        return np.zeros(0)
    unread = [f"{name}.faults" for name in ("pinion", "gear") if getattr(pair, name).faults]
    unread += ["operating.torque_ripple"] if pair.operating.torque_ripple else []
    teeth = own_teeth(pair)
    for name, one in zip(("pinion", "gear"), teeth, strict=True):
        unread += [f"{name}.deviations.profile_slope"] if one.slope.any() else []
        unread += [f"{name}.deviations.tip_relief"] if one.relief.any() else []
    if unread:
        allowed = "index deviations and eccentricity, all that the multibody model has of teeth that differ"
        raise refuse(unread[0], "given", allowed, "Leave it out, or use lumped.steady_state.")
    rows = [
        (one.eccentricity, one.phase + 2.0 * math.pi * first / one.error.size, one.error.size, first)
        for one, first in zip(teeth, first_teeth(pair), strict=True)
    ]
    return np.concatenate([np.ravel(rows), *(one.error for one in teeth)])


def with_block(pair: GearPair, parameters: FloatArray, start: int) -> FloatArray:
    """Parameters with the block of the pair behind them, and at ``start`` where it begins, or 0."""
    own = block(pair)
    found = np.append(parameters, own)
    found[start] = parameters.size if own.size else 0.0
    return found


@compiled
def off_axis(own: FloatArray, t: float, state: FloatArray, omega_p: float, omega_g: float) -> FloatArray:
    """Rows of (x, y, phi) of both: state of the base circles' centres, rates, their way from the axes."""
    found = np.empty((3, 6))
    for j in range(6):
        found[0, j], found[1, j] = state[0, j], state[1, j]
    for which in range(2):
        row, sense = COLUMNS * which, 1.0 - 2.0 * which  # the pinion turns clockwise
        x, y = 3 * which, 3 * which + 1
        turned = (omega_g if which else omega_p) * t - sense * state[0, x + 2]
        rate = (omega_g if which else omega_p) - sense * state[1, x + 2]
        size, angle = own[row + ECCENTRICITY], turned + own[row + ANGLE]
        along, off = -sense * size * math.cos(angle), size * math.sin(angle)
        found[2, x], found[2, y] = along, off
        found[0, x] += along
        found[0, y] += off
        found[1, x] += sense * off * rate
        found[1, y] -= sense * along * rate
    return found


@compiled
def move_moments(ways: FloatArray, wrench: FloatArray) -> None:
    """Make the moments about the base circles' centres those about the axes."""
    for x in (0, 3):
        wrench[x + 2] += ways[x] * wrench[x + 1] - ways[x + 1] * wrench[x]


@compiled
def error_of(
    own: FloatArray, turned_p: float, turned_g: float, rho_p: float, rho_g: float, pitch: float
) -> float:
    """Error of the pair with flanks at these distances from X and Y [m].

    ``turned_p`` and ``turned_g`` are arcs of the base circles: of pair 0 the first is its distance from X,
    and the second its distance from Y, which falls.
    """
    number_p = math.floor((turned_p - rho_p) / pitch + 0.5)
    number_g = math.floor((rho_g - turned_g) / pitch + 0.5)
    z_p, z_g = int(own[TEETH]), int(own[COLUMNS + TEETH])
    pinion = (int(own[FIRST]) + number_p) % z_p
    gear = (int(own[COLUMNS + FIRST]) + number_g) % z_g
    return float(own[ERRORS + pinion] + own[ERRORS + z_p + gear])
