"""How deep the rack cuts both gears: profile shifts and root circles, by formulas of this package's own.

Source: ISO 21771 for the sum of the profile shifts; the rest is elementary.
"""

from __future__ import annotations

import math

from lumped.schema.pair import GearPair


def profile_shifts(pair: GearPair) -> tuple[float, float]:
    """Profile shift coefficients of both gears: of the file, else what the centre distance asks for.

    Without backlash the thicknesses of both teeth on the working circles add up to the pitch there. That
    gives x_p + x_g from the involute of the working pressure angle; its tangent is the ratio of the legs of
    the triangle with the centre distance as hypotenuse and the sum of the base radii as one leg. Two unknown
    shifts share the sum in proportion to the numbers of teeth, so that the gear with fewer teeth is the
    thicker one.
    """
    given = pair.pinion.profile_shift, pair.gear.profile_shift
    if given[0] is not None and given[1] is not None:
        return given[0], given[1]
    if pair.centre_distance is None:
        return given[0] or 0.0, given[1] or 0.0
    rack = pair.basic_rack
    teeth = (pair.pinion.teeth, pair.gear.teeth)
    base = 0.5 * rack.module * sum(teeth) * math.cos(rack.pressure_angle)
    leg = math.sqrt(pair.centre_distance**2 - base**2) / base
    slope = math.tan(rack.pressure_angle)
    total = (leg - math.atan(leg) - slope + rack.pressure_angle) * 0.5 * sum(teeth) / slope
    if given[0] is not None:
        return given[0], total - given[0]
    if given[1] is not None:
        return total - given[1], given[1]
    of_pinion = total * (teeth[1] if total > 0.0 else teeth[0]) / sum(teeth)
    return of_pinion, total - of_pinion


def root_radius(pair: GearPair, which: int) -> float:
    """Root radius of the pinion (0) or the gear (1) [m], cut by the tip line of the rack."""
    rack = pair.basic_rack
    gear = (pair.pinion, pair.gear)[which]
    return rack.module * (0.5 * gear.teeth + profile_shifts(pair)[which] - rack.dedendum_coefficient)
