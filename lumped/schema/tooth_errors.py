"""The error that each tooth brings to its pairs: deviations become lengths along the line of action.

Here errors get their sign: an error is positive where material is missing, so that the pair comes late. How
a tolerance class becomes a gap of the contact, one name after the other:

=====================  ===========================================  =========================================
quantity (symbol)      name                                         made in
=====================  ===========================================  =========================================
tolerance class        ``pinion.deviations.tolerance_class``        parameter file, ``schema/teeth.py``
index deviation (F)    ``index``, positive further along the count  ``drawn_index``, ``schema/tolerances.py``
tooth error (e)        ``ToothErrors.error``, positive where late,  ``tooth_errors``, this file
                       without the first harmonic
first harmonic         ``ToothErrors.eccentricity``: the gear       ``tooth_errors``, this file
                       turns about another axis
the error, a record    ``TOOTH.gap``                                ``_of_teeth``, ``model/tooth_laws.py``
gap of a pair          ``PAIR.gap``: laws and errors of both teeth  ``fill_pair``, ``mesh/tables.py``
                       what eccentric gears add to it               ``fill_steps``, ``mesh/tables.py``
compression            approach less gap; above 0 the pair touches  ``mesh/element.py``
=====================  ===========================================  =========================================

Sources: docs/theory/teeth.md, "Numbering and sign", "Eccentricity".
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from lumped.schema.pair import GearPair
from lumped.schema.teeth import Deviations
from lumped.schema.tolerances import drawn_index
from lumped.typing import FloatArray

PINION, GEAR = range(2)
#: Sign with which an index deviation becomes an error. A flank further along the count has material missing
#: on the driving flank of the pinion, and material in excess on the driven flank of the gear.
_LATE = {PINION: 1.0, GEAR: -1.0}


@dataclass(frozen=True, eq=False)
class ToothErrors:
    """Errors of the z teeth of one gear, in order of engagement from tooth 1 on, SI.

    Attributes
    ----------
    index : (z,) index deviations F of the file or of the draw, positive where the flank is further along the
        count [m]
    error : (z,) error e, constant over the flank, positive where the tooth comes late [m]
    slope : (z,) profile slope deviations, positive for material at the tip [m]
    relief : (z,) tip relief beyond that of the design [m]
    eccentricity : amplitude of the error of the turning gear [m]
    phase : of the error eccentricity cos(rotation + phase), rotation counted from tooth 1 at A [rad]
    """

    index: FloatArray
    error: FloatArray
    slope: FloatArray
    relief: FloatArray
    eccentricity: float
    phase: float


def tooth_errors(pair: GearPair) -> tuple[ToothErrors, ToothErrors]:
    """The errors of the teeth of pinion and gear."""
    return _of_gear(pair, PINION), _of_gear(pair, GEAR)


def _of_gear(pair: GearPair, gear_index: int) -> ToothErrors:
    """The errors of the teeth of the pinion (0) or the gear (1)."""
    gear = (pair.pinion, pair.gear)[gear_index]
    teeth = gear.teeth
    deviations = gear.deviations
    slope = _in_order_of_engagement(deviations, "profile_slope", teeth, mirrored_sign=1.0)
    relief = _in_order_of_engagement(deviations, "tip_relief", teeth, mirrored_sign=1.0)
    mounting_phase = gear.mounting.phase if gear.mounting else 0.0
    if deviations is None:
        none = np.zeros(teeth)
        return ToothErrors(none, none, slope, relief, float(gear.eccentricity), float(mounting_phase))
    index = _in_order_of_engagement(deviations, "index", teeth, mirrored_sign=-1.0)
    if deviations.tolerance_class is not None:
        module = pair.basic_rack.module
        index = drawn_index(teeth, module, deviations.tolerance_class, deviations.seed)
    error = _LATE[gear_index] * math.cos(pair.basic_rack.pressure_angle) * index
    if deviations.first_order == "steps":
        return ToothErrors(index, error, slope, relief, float(gear.eccentricity), float(mounting_phase))
    error, first_harmonic = without_first_harmonic(error)
    # The index deviation of a tooth belongs to contact at the pitch point, the phase to contact at A.
    g = pair.geometry
    radius = (g.base_radius_pinion, g.base_radius_gear)[gear_index]
    phase = float(np.angle(first_harmonic)) - (g.L_XP - g.L_XA) / radius
    return ToothErrors(index, error, slope, relief, float(abs(first_harmonic)), phase)


def without_first_harmonic(error: FloatArray) -> tuple[FloatArray, complex]:
    """Errors (z,) less the first harmonic, and the first harmonic.

    The first harmonic turns continuously, like an eccentric gear. As a list of steps the harmonic would be a
    staircase, with sidebands several times too large.
    """
    teeth = error.size
    turn = 2.0 * np.pi * np.arange(teeth) / teeth
    harmonic = 2.0 / teeth * np.sum(error * np.exp(-1j * turn))
    return error - (harmonic * np.exp(1j * turn)).real, harmonic


def _in_order_of_engagement(
    deviations: Deviations | None, name: str, teeth: int, mirrored_sign: float
) -> FloatArray:
    """A list of the file, one value a tooth [m]; zeros without a list.

    A list that is numbered against the order of engagement is reversed, but for tooth 1, and takes the sign.
    """
    values = getattr(deviations, name) if deviations is not None else None
    if values is None:
        return np.zeros(teeth)
    ordered = np.array(values, dtype=float)
    if deviations is not None and deviations.counted == "against":
        ordered = mirrored_sign * ordered[-np.arange(teeth)]
    return ordered
