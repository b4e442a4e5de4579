"""How deep the rack cuts both gears: profile shifts and root circles, by formulas of this package's own.

Source: ISO 21771 for the sum of the profile shifts; the rest is elementary.
"""

from __future__ import annotations

import math

from lumped.schema.pair import GearPair


def profile_shifts(pair: GearPair) -> tuple[float, float]:
    """Profile shift coefficients of both gears: of the file, else from the centre distance.

    Without backlash the thicknesses of both teeth on the working circles add up to the pitch on these
    circles. So x_p + x_g follows from the involute of the working pressure angle. The tangent of this angle
    is the ratio of the legs of a triangle: the centre distance is the hypotenuse, and the sum of the base
    radii is one leg. Two unknown shifts share the sum in proportion to the numbers of teeth, so that the gear
    with fewer teeth has the thicker teeth.
    """
    of_pinion = pair.pinion.profile_shift
    of_gear = pair.gear.profile_shift
    if of_pinion is not None and of_gear is not None:
        return of_pinion, of_gear
    if pair.centre_distance is None:
        return of_pinion or 0.0, of_gear or 0.0
    rack = pair.basic_rack
    teeth = (pair.pinion.teeth, pair.gear.teeth)
    base = 0.5 * rack.module * sum(teeth) * math.cos(rack.pressure_angle)
    leg = math.sqrt(pair.centre_distance**2 - base**2) / base
    slope = math.tan(rack.pressure_angle)
    total = (leg - math.atan(leg) - slope + rack.pressure_angle) * 0.5 * sum(teeth) / slope
    if of_pinion is not None:
        return of_pinion, total - of_pinion
    if of_gear is not None:
        return total - of_gear, of_gear
    of_pinion = total * (teeth[1] if total > 0.0 else teeth[0]) / sum(teeth)
    return of_pinion, total - of_pinion


def root_radius(pair: GearPair, number: int) -> float:
    """Root radius of the pinion (0) or the gear (1) [m], cut by the tip line of the rack."""
    rack = pair.basic_rack
    gear = (pair.pinion, pair.gear)[number]
    return rack.module * (0.5 * gear.teeth + profile_shifts(pair)[number] - rack.dedendum_coefficient)
