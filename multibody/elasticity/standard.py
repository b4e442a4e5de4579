"""Stiffness of ISO 6336-1, method B, coded a second time from the standard.

The table of constants is keyed by the terms of q', and the formulas have the standard's units: teeth, module
shifts, N/(mm um). A second coding is evidence against faults of coding alone: both codes have one source.

Source: ISO 6336-1:2019, eqs. (82) to (93), for spur gears of solid discs (C_R = 1) at any load.
"""

from __future__ import annotations

import math

from lumped.schema.pair import GearPair
from multibody.gears.cut_teeth import profile_shifts

#: Powers (1/z_n1, 1/z_n2, x_1, x_2) of a term of q' -> its constant C_1 to C_9, table of eq. (84).
_FLEXIBILITY = {
    (0, 0, 0, 0): 0.04723,
    (1, 0, 0, 0): 0.15551,
    (0, 1, 0, 0): 0.25791,
    (0, 0, 1, 0): -0.00635,
    (1, 0, 1, 0): -0.11654,
    (0, 0, 0, 1): -0.00193,
    (0, 1, 0, 1): -0.24188,
    (0, 0, 2, 0): 0.00529,
    (0, 0, 0, 2): 0.00182,
}
#: C_M of eq. (85); Young's modulus of the standard's steel, eq. (90) [N/mm^2].
_MEASURED_OVER_THEORY = 0.8
_STEEL = 206_000.0
#: Dedendum of the standard's rack in modules, and its pressure angle [deg], eq. (88).
_DEDENDUM = 1.2
_ANGLE = 20.0
#: N/(mm um) in N/m of stiffness a metre of face width.
_UNIT = 1e9


def single_stiffness(pair: GearPair) -> float:
    """Largest stiffness of a tooth pair, c' times the common face width [N/m]."""
    smaller, larger = sorted(
        zip((pair.pinion.teeth, pair.gear.teeth), profile_shifts(pair), strict=True),
        key=lambda gear: (gear[0], -gear[1]),
    )
    numbers = (1.0 / smaller[0], 1.0 / larger[0], smaller[1], larger[1])
    flexibility = sum(
        constant * math.prod(number**power for number, power in zip(numbers, powers, strict=True))
        for powers, constant in _FLEXIBILITY.items()
    )
    rack = pair.basic_rack
    steep = 1.0 - 0.02 * (_ANGLE - math.degrees(rack.pressure_angle))
    rack_factor = (1.0 + 0.5 * (_DEDENDUM - rack.dedendum_coefficient)) * steep
    softness = [1e6 / gear.youngs_modulus for gear in (pair.pinion, pair.gear)]  # mm^2/N
    modulus = 2.0 / sum(softness)
    stiffness = _MEASURED_OVER_THEORY * rack_factor / flexibility * modulus / _STEEL
    return stiffness * _UNIT * min(pair.pinion.face_width, pair.gear.face_width)


def mean_stiffness(pair: GearPair, contact_ratio: float) -> float:
    """Mean stiffness of the mesh, c_gamma times the common face width, eq. (93) [N/m]."""
    return single_stiffness(pair) * (0.25 + 0.75 * contact_ratio)
