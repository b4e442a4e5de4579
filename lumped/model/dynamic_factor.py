"""Dynamic factor K_v of ISO 6336-1:2006, method B, for a spur gear pair of steel.

Method B needs tolerances of pitch and profile. A gear pair does not state them, so they are taken from a
class of ISO 1328-1:2013.

Sources: ISO 6336-1:2006, clause 6.5 (resonance ratio, table 8, B_p, B_f, B_k, running in of case-hardened
gears, y = 0.075 f); ISO 1328-1:2013, f_pT and f_falphaT.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from lumped.schema.bodies import bodies_of
from lumped.schema.pair import GearPair
from lumped.stiffness.iso6336 import mean_mesh_stiffness, pair_single_stiffness

#: Default class of ISO 1328-1: ground industrial gears.
ASSUMED_TOLERANCE_CLASS = 6
_RUN_IN = 0.075
_SUBCRITICAL = 0.85
_MAIN = 1.15
_SUPERCRITICAL = 1.5


@dataclass(frozen=True)
class IsoDynamicFactor:
    """K_v and the values from which it follows.

    Attributes
    ----------
    factor : K_v [-]
    resonance_ratio : N, speed over the main resonance speed [-]
    zone : "subcritical", "main resonance", "intermediate" or "supercritical"
    tolerance_class : class of ISO 1328-1
    """

    factor: float
    resonance_ratio: float
    zone: str
    tolerance_class: int


def iso_dynamic_factor(pair: GearPair, tolerance_class: int = ASSUMED_TOLERANCE_CLASS) -> IsoDynamicFactor:
    """Return K_v by ISO 6336-1 method B, for a tolerance class of ISO 1328-1, 1 to 11.

    The stiffness is that of the standard: neither the pair's stiffness model nor a factor on its stiffness
    (``lumped.path_of_contact.stiffness.FACTORS``) changes K_v.
    """
    g = pair.geometry
    b = bodies_of(pair)
    width = 1e3 * g.face_width  # mm; the formulas are in N, mm, um
    ratio = pair.gear.teeth / pair.pinion.teeth
    eps = g.contact_ratio
    single = pair_single_stiffness(pair)
    mean = mean_mesh_stiffness(single, eps)
    # Reduced mass per face width on the line of action [kg/mm].
    masses = b.inertia_pinion / g.base_radius_pinion**2, b.inertia_gear / g.base_radius_gear**2
    reduced = masses[0] * masses[1] / (masses[0] + masses[1]) / width
    resonance = 30000.0 / (math.pi * pair.pinion.teeth) * math.sqrt(mean / reduced)  # rpm
    n = pair.operating.pinion_speed * 30.0 / math.pi / resonance
    # Tangential load at the reference circle per face width [N/mm].
    load = pair.operating.pinion_torque / g.reference_radius_pinion / width
    module = 1e3 * pair.basic_rack.module
    step = math.sqrt(2.0) ** (tolerance_class - 5)
    diameter = 2e3 * g.reference_radius_pinion * max(ratio, 1.0)  # of the larger gear
    pitch = (0.001 * diameter + 0.4 * module + 5.0) * step * math.cos(pair.basic_rack.pressure_angle)
    profile = (0.55 * module + 5.0) * step
    b_p = single * pitch * (1.0 - _RUN_IN) / load
    b_f = single * profile * (1.0 - _RUN_IN) / load
    relief = max((1e6 * r.amount for r in (pair.pinion.tip_relief, pair.gear.tip_relief) if r), default=0.0)
    b_k = abs(1.0 - single * relief / load)
    limit = _SUBCRITICAL if load >= 100.0 else 0.5 + 0.35 * math.sqrt(load / 100.0)
    c = _factors(eps)
    main = c.v1 * b_p + c.v2 * b_f + c.v4 * b_k + 1.0
    fast = c.v5 * b_p + c.v6 * b_f + c.v7
    if n <= limit:
        factor = n * (c.v1 * b_p + c.v2 * b_f + c.v3 * b_k) + 1.0
        zone = "subcritical"
    elif n <= _MAIN:
        factor = main
        zone = "main resonance"
    elif n < _SUPERCRITICAL:
        factor = fast + (main - fast) / (_SUPERCRITICAL - _MAIN) * (_SUPERCRITICAL - n)
        zone = "intermediate"
    else:
        factor = fast
        zone = "supercritical"
    return IsoDynamicFactor(factor, n, zone, tolerance_class)


class _Factors(NamedTuple):
    """Factors C_v1 to C_v7 of table 8."""

    v1: float
    v2: float
    v3: float
    v4: float
    v5: float
    v6: float
    v7: float


def _factors(eps: float) -> _Factors:
    """Return the factors of table 8 at a contact ratio."""
    if eps <= 2.0:
        c7 = 0.75 if eps <= 1.5 else 0.125 * math.sin(math.pi * (eps - 2.0)) + 0.875
        return _Factors(0.32, 0.34, 0.23, 0.90, 0.47, 0.47, c7)
    c7 = 1.0 if eps > 2.5 else 0.125 * math.sin(math.pi * (eps - 2.0)) + 0.875
    return _Factors(
        0.32,
        0.57 / (eps - 0.3),
        0.096 / (eps - 1.56),
        (0.57 - 0.05 * eps) / (eps - 1.44),
        0.47,
        0.12 / (eps - 1.74),
        c7,
    )
