"""Profile shifts, centre distance and tip alteration of a pair: each from the others.

Sources: ISO 21771 and DIN 3960: the sum of the profile shift coefficients that meshes without backlash at a
centre distance, inv(alpha_w) = inv(alpha) + 2 (x_1 + x_2) tan(alpha) / (z_1 + z_2); the tip alteration
k m = a - a_d - m (x_1 + x_2) that keeps the clearance of the basic rack.
"""

from __future__ import annotations

import math

from lumped.errors import refuse
from lumped.gear_geometry.tooth_profile import inverse_involute, involute

#: Profile shift coefficients, and lengths over module, that are rounding of a centre distance [-].
_ROUNDING = 1e-11
#: Range of a profile shift coefficient, that of the schema [-].
LEAST_SHIFT = -1.5
LARGEST_SHIFT = 2.0


def operating_pressure_angle(
    teeth: int, module: float, pressure_angle: float, centre_distance: float
) -> float:
    """Return alpha_w [rad] at a centre distance [m]: cos(alpha_w) = (r_b1 + r_b2) / a.

    ``teeth`` is the sum of both gears; a centre distance up to the sum of the base radii is refused.
    """
    base = 0.5 * module * teeth * math.cos(pressure_angle)
    if centre_distance <= base:
        allowed = f"> {base * 1e3:.4f} mm, the sum of the base radii"
        reference = f"without profile shifts it is {5e2 * module * teeth:.6g} mm"
        action = f"Check centre_distance, module and the numbers of teeth: {reference}."
        raise refuse("centre_distance", f"{centre_distance * 1e3:.6g} mm", allowed, action)
    return math.acos(base / centre_distance)


def shift_sum(teeth: int, module: float, pressure_angle: float, centre_distance: float) -> float:
    """Return the sum of the profile shift coefficients that has no backlash at a centre distance [m].

    x_1 + x_2 = (z_1 + z_2) (inv alpha_w - inv alpha) / (2 tan alpha); ``teeth`` is z_1 + z_2.

    >>> import math
    >>> round(shift_sum(97, 2.5e-3, math.radians(20.0), 0.122), 4)
    0.3069
    """
    working = operating_pressure_angle(teeth, module, pressure_angle, centre_distance)
    value = 0.5 * teeth * (involute(working) - involute(pressure_angle)) / math.tan(pressure_angle)
    return 0.0 if abs(value) < _ROUNDING else value


def distance_without_backlash(teeth: int, module: float, pressure_angle: float, shift: float) -> float:
    """Return the centre distance [m] at which gears with a sum of profile shifts have no backlash.

    This function is the inverse of `shift_sum`. A negative sum with base circles that overlap is refused.
    """
    value = involute(pressure_angle) + 2.0 * shift / teeth * math.tan(pressure_angle)
    if value < 0.0:
        allowed = f"sum > {-0.5 * teeth * involute(pressure_angle) / math.tan(pressure_angle):.4g}"
        action = "Raise the profile shifts or give centre_distance."
        raise refuse("pinion.profile_shift", f"sum {shift:g}", allowed, action)
    working = pressure_angle if shift == 0.0 else inverse_involute(value)
    return 0.5 * module * teeth * math.cos(pressure_angle) / math.cos(working)


def shared(shift: float, teeth: tuple[int, int]) -> tuple[float, float]:
    """Share the sum of the profile shift coefficients between two gears, where no input decides the shares.

    The gear with fewer teeth gets the larger part of a positive sum, and the smaller part of a negative sum.
    The parts are in proportion to the numbers of teeth. This convention of the program lies between two usual
    conventions: half to each gear, and all to the smaller gear (a negative sum: all to the larger gear).
    """
    of_first = (teeth[1] if shift > 0.0 else teeth[0]) / sum(teeth)
    return shift * of_first, shift * (1.0 - of_first)


def resolved_shifts(
    shifts: tuple[float | None, float | None],
    teeth: tuple[int, int],
    module: float,
    pressure_angle: float,
    distance: float | None,
) -> tuple[float, float]:
    """Return both profile shift coefficients: from the file, otherwise from the centre distance.

    Parameters
    ----------
    shifts : profile shift coefficients of pinion and gear in the file; None: the file has none
    distance : centre distance [m]; None: a shift that is not in the file is 0

    Raises
    ------
    ParameterError : a centre distance for which no gear has the necessary profile shifts
    """
    first, second = shifts
    if first is not None and second is not None:
        return first, second
    if distance is None:
        return first or 0.0, second or 0.0
    total = shift_sum(sum(teeth), module, pressure_angle, distance)
    if first is not None:
        resolved = first, total - first
    elif second is not None:
        resolved = total - second, second
    else:
        resolved = shared(total, teeth)
    if not all(LEAST_SHIFT <= one <= LARGEST_SHIFT for one in resolved):
        pair_of_shifts = f"the profile shifts {resolved[0]:.4g} and {resolved[1]:.4g} without backlash"
        value = f"{1e3 * distance:.6g} mm, which asks for {pair_of_shifts}"
        reference = 5e2 * module * sum(teeth)
        allowed = f"{LEAST_SHIFT:g} to {LARGEST_SHIFT:g} for each; {reference:.6g} mm asks for none"
        action = "Check centre_distance, module and the numbers of teeth."
        raise refuse("centre_distance", value, allowed, action)
    return resolved


def tip_alteration(distance: float, module: float, teeth: int, shift: float) -> float:
    """Return the tip alteration k m [m] of both gears that keeps the clearance of the basic rack.

    k m = a - a_d - m (x_1 + x_2) with the reference centre distance a_d (DIN 3960); ``teeth`` and ``shift``
    are the sums of both gears. Tips are shortened where the centre distance a is smaller than
    a_d + m (x_1 + x_2). Tips are not lengthened: k m is never positive.
    """
    value = distance - 0.5 * module * teeth - module * shift
    return 0.0 if value > -_ROUNDING * module else value
