"""Tooth stiffness by ISO 6336-1, method B: single stiffness c' and mean mesh stiffness c_gamma.

The formulas are a fit of measured and computed deflections of steel gears and keep the standard's units,
N/(mm um): newton per millimetre of face width and micrometre of deflection along the line of action.

Reference: ISO 6336-1:2019, Calculation of load capacity of spur and helical gears, part 1, tooth stiffness
parameters, eqs (82) to (93).
"""

from __future__ import annotations

import math

from lumped.ranges import RangeViolation, ValidityRange, range_violations
from lumped.stiffness.base import MeshingPair
from lumped.stiffness.foundation import thin_rims

#: C1 to C9 of q', eq. (84), in the order of the terms.
COEFFICIENTS = (0.04723, 0.15551, 0.25791, -0.00635, -0.11654, -0.00193, -0.24188, 0.00529, 0.00182)
#: Factor C_M between theory and measurement, eq. (85).
CORRECTION = 0.8
#: Young's modulus of the steel that the fit stands for [GPa].
STEEL_MODULUS = 206.0
#: Below this load per face width c' falls with the load, eq. (92) [N/mm].
LOW_LOAD = 100.0
#: One N/(mm um) in SI: N/m of stiffness per m of face width.
SI = 1e9

_SOURCE = "ISO 6336-1, method B"
RANGES = (
    ValidityRange("profile shift sum x1 + x2", "1", -0.5, 2.0, _SOURCE),
    ValidityRange("profile shift difference x1 - x2", "1", 0.0, None, _SOURCE),
    ValidityRange("load per face width", "N/mm", LOW_LOAD, 1600.0, _SOURCE),
)


def theoretical_single_stiffness(z_1: float, z_2: float, x_1: float, x_2: float) -> float:
    """Theoretical single stiffness c'_th = 1/q' of a pair of solid-disc gears [N/(mm um)], eqs (83), (84).

    z_1, z_2 are the teeth of the smaller and the larger gear, x_1, x_2 their profile shift coefficients;
    valid in ``RANGES``.

    >>> round(theoretical_single_stiffness(28, 28, 0.0, 0.0), 4)
    16.1303
    """
    c1, c2, c3, c4, c5, c6, c7, c8, c9 = COEFFICIENTS
    flexibility = (
        c1
        + c2 / z_1
        + c3 / z_2
        + c4 * x_1
        + c5 * x_1 / z_1
        + c6 * x_2
        + c7 * x_2 / z_2
        + c8 * x_1**2
        + c9 * x_2**2
    )
    return 1.0 / flexibility


def basic_rack_factor(dedendum: float, pressure_angle: float) -> float:
    """Basic rack factor C_B [-], eq. (88), of the dedendum over module and the pressure angle [deg].

    >>> round(basic_rack_factor(1.25, 20.0), 4)
    0.975
    """
    return (1.0 + 0.5 * (1.2 - dedendum)) * (1.0 - 0.02 * (20.0 - pressure_angle))


def material_factor(modulus_1: float, modulus_2: float) -> float:
    """Ratio E/E_St of c' to that of steel gears [-], eqs (90), (91), with E = 2 E1 E2/(E1 + E2) [GPa].

    >>> round(material_factor(206.0, 103.0), 4)
    0.6667
    """
    return 2.0 * modulus_1 * modulus_2 / (modulus_1 + modulus_2) / STEEL_MODULUS


def single_stiffness(
    theoretical: float, *, basic_rack: float = 1.0, material: float = 1.0, helix: float = 0.0
) -> float:
    """Single stiffness c' of solid discs, the largest of one tooth pair [N/(mm um)], eq. (82) with C_R = 1.

    ``helix`` is the helix angle [deg].

    >>> round(single_stiffness(16.1303, basic_rack=0.975), 4)
    12.5816
    """
    return theoretical * CORRECTION * basic_rack * material * math.cos(math.radians(helix))


def mean_mesh_stiffness(single: float, contact_ratio: float) -> float:
    """Mean total mesh stiffness c_gamma_alpha = c' (0.75 eps_alpha + 0.25) [N/(mm um)], eq. (93).

    >>> round(mean_mesh_stiffness(14.0, 1.6), 4)
    20.3
    """
    return single * (0.75 * contact_ratio + 0.25)


def pair_single_stiffness(pair: MeshingPair) -> float:
    """Single stiffness c' of a gear pair of solid discs [N/(mm um)].

    Without the low-load reduction, as the linear model has one stiffness per position at every torque.
    """
    small, large = _ordered(pair)
    rack = pair.wheels[0].tooth
    return single_stiffness(
        theoretical_single_stiffness(small[0], large[0], small[1], large[1]),
        basic_rack=basic_rack_factor(rack.dedendum, math.degrees(rack.pressure_angle)),
        material=material_factor(pair.pinion.youngs_modulus * 1e-9, pair.gear.youngs_modulus * 1e-9),
    )


#: Fields that C' depends on beside the numbers of teeth, the profile shifts and the pressure angle.
READS = frozenset({"basic_rack.dedendum_coefficient", "gears.youngs_modulus"})


def single_of(pair: MeshingPair) -> float:
    """C' of a gear pair times its face width: the largest stiffness of a tooth pair [N/m]."""
    return pair_single_stiffness(pair) * SI * pair.geometry.face_width


def mean_of(pair: MeshingPair) -> float:
    """c_gamma of a gear pair times its face width: the mean stiffness of all tooth pairs [N/m]."""
    mean = mean_mesh_stiffness(pair_single_stiffness(pair), pair.geometry.contact_ratio)
    return mean * SI * pair.geometry.face_width


def violations(pair: MeshingPair) -> tuple[RangeViolation, ...]:
    """Return the ranges of the standard that a pair leaves, and the rims that are too thin."""
    return (*fit_violations(pair), *thin_rims(pair))


def fit_violations(pair: MeshingPair) -> tuple[RangeViolation, ...]:
    """Validity ranges of the standard's fit that a pair at its operating point leaves."""
    small, large = _ordered(pair)
    force = pair.operating.pinion_torque / pair.geometry.reference_radius_pinion
    values = {
        "profile shift sum x1 + x2": small[1] + large[1],
        "profile shift difference x1 - x2": small[1] - large[1],
        "load per face width": force / pair.geometry.face_width * 1e-3,
    }
    return range_violations("ISO 6336-1 tooth stiffness", RANGES, values)


def _ordered(pair: MeshingPair) -> tuple[tuple[int, float], tuple[int, float]]:
    """(teeth, profile shift) of the standard's gears 1 and 2: fewer teeth first, then the larger shift."""
    gears = ((w.tooth.teeth, w.tooth.profile_shift) for w in pair.wheels)
    small, large = sorted(gears, key=lambda gear: (gear[0], -gear[1]))
    return small, large
