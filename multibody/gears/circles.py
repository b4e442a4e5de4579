"""Circles, path of contact, tooth thickness and reliefs of a pair, from the fields of the schema.

Nothing here reads ``pair.geometry``: agreement with ``lumped.gear_geometry`` is evidence for both.

Sources: ISO 21771; docs/theory/multibody.md, "What is own and what is shared".
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

from scipy.optimize import brentq

from lumped.schema.pair import GearPair
from lumped.schema.relief import ProfileRelief
from multibody.gears.cut_teeth import profile_shifts, root_radius
from multibody.gears.undercut import undercut_edge

#: Largest operating pressure angle in the search for the centre distance [rad].
_STEEPEST = 1.4


@dataclass(frozen=True)
class Circles:
    """Circles and path of contact of a pair: base radii, base pitch, tip radii, centre distance [m].

    An undercut ends a flank at the length ``edge_pinion`` or ``edge_gear`` on its base tangent; 0 without
    one.
    """

    base_pinion: float
    base_gear: float
    pitch: float
    tip_pinion: float
    tip_gear: float
    centre_distance: float
    edge_pinion: float
    edge_gear: float

    @property
    def reach_pinion(self) -> float:
        """Length on the pinion's base tangent from X to its tip circle."""
        return math.sqrt(self.tip_pinion**2 - self.base_pinion**2)

    @property
    def reach_gear(self) -> float:
        """Length on the gear's base tangent from Y to its tip circle."""
        return math.sqrt(self.tip_gear**2 - self.base_gear**2)

    @property
    def start(self) -> float:
        """L_XA: where the gear's tip or the pinion's edge begins contact."""
        return max(self.tangent - self.reach_gear, self.edge_pinion)

    @property
    def end(self) -> float:
        """L_XD: where the pinion's tip or the gear's edge ends contact."""
        return min(self.reach_pinion, self.tangent - self.edge_gear)

    @property
    def tangent(self) -> float:
        """Length L_XY of the line of action between the base circles."""
        return math.sqrt(self.centre_distance**2 - (self.base_pinion + self.base_gear) ** 2)


def circles(pair: GearPair) -> Circles:
    """Circles of a pair."""
    rack = pair.basic_rack
    cosine = math.cos(rack.pressure_angle)
    r_p, r_g = (0.5 * rack.module * gear.teeth * cosine for gear in (pair.pinion, pair.gear))
    centre = _close_mesh(pair, r_p + r_g) if pair.centre_distance is None else pair.centre_distance
    shifts = profile_shifts(pair)
    return Circles(
        base_pinion=r_p,
        base_gear=r_g,
        pitch=math.pi * rack.module * cosine,
        tip_pinion=_tip_radius(pair, 0, centre),
        tip_gear=_tip_radius(pair, 1, centre),
        centre_distance=centre,
        edge_pinion=undercut_edge(pair.basic_rack, pair.pinion.teeth, shifts[0]),
        edge_gear=undercut_edge(pair.basic_rack, pair.gear.teeth, shifts[1]),
    )


class Relieved(NamedTuple):
    """A relief of one flank.

    gear : 0 pinion, 1 gear
    start, end : roll angles at which the relief starts and ends [rad]
    amount : missing material at ``end`` [m]
    power : the relief grows with this power of the roll angle
    """

    gear: int
    start: float
    end: float
    amount: float
    power: float


def reliefs(pair: GearPair, drawn: Circles) -> list[Relieved]:
    """Reliefs that act.

    A tip relief ends at the tip, a root relief where contact starts or ends on its flank. Without
    ``mesh.relief = "static"`` only the relief of single teeth beyond the design acts, with the amount 0 here.
    """
    acts = pair.mesh.relief == "static"
    acting = []
    for number, gear, base, tip, root in (
        (0, pair.pinion, drawn.base_pinion, drawn.reach_pinion, drawn.start),
        (1, pair.gear, drawn.base_gear, drawn.reach_gear, drawn.tangent - drawn.end),
    ):
        for relief, end, sense in ((gear.tip_relief, tip, -1.0), (gear.root_relief, root, 1.0)):
            of_single_teeth = gear.deviations is not None and gear.deviations.tip_relief is not None
            if relief is None or not (of_single_teeth or (acts and relief.amount != 0.0)):
                continue
            power = 1.0 if relief.shape == "linear" else 2.0
            amount = relief.amount if acts else 0.0
            start = _relief_start(relief, base, end, sense)
            acting.append(Relieved(number, start, end / base, amount, power))
    return acting


def _relief_start(relief: ProfileRelief, base: float, end: float, sense: float) -> float:
    """Roll angle at which a relief starts [rad], from the length, the diameter or the angle of the file.

    base : base radius [m]
    end : length on the base tangent at which the relief ends [m]
    sense : -1 for a tip relief, +1 for a root relief

    The profile angle at radius r is arccos(r_b/r), and its tangent the roll angle.
    """
    if relief.length is not None:
        return (end + sense * relief.length) / base
    if relief.start_diameter is not None:
        return math.tan(math.acos(2.0 * base / relief.start_diameter))
    return relief.start_roll_angle


def base_tooth_angle(pair: GearPair, number: int, base: float) -> float:
    """Angle between both flanks of a tooth on the base circle, less half of the backlash [rad].

    number : 0 pinion, 1 gear
    base : base radius [m]
    """
    rack = pair.basic_rack
    gear = (pair.pinion, pair.gear)[number]
    shift = profile_shifts(pair)[number]
    alpha = rack.pressure_angle
    at_reference = (0.5 * math.pi + 2.0 * shift * math.tan(alpha)) / (0.5 * gear.teeth)
    return at_reference + 2.0 * (math.tan(alpha) - alpha) - 0.5 * pair.mesh.backlash / base


def _tip_radius(pair: GearPair, number: int, centre_distance: float) -> float:
    """Tip radius of the pinion (0) or the gear (1) [m]: the radius of the file, else the radius by the rack.

    By the rack the tip keeps the clearance of the rack to the root of the mating gear, and does not reach
    beyond the addendum of the rack.
    """
    gear = (pair.pinion, pair.gear)[number]
    rack = pair.basic_rack
    if gear.tip_diameter is not None:
        return gear.tip_diameter / 2.0
    if gear.addendum is not None:
        return rack.module * gear.teeth / 2.0 + gear.addendum
    full = rack.module * (0.5 * gear.teeth + rack.addendum_coefficient + profile_shifts(pair)[number])
    if gear.tip_alteration is not None:
        return full + gear.tip_alteration
    clearance = rack.module * (rack.dedendum_coefficient - rack.addendum_coefficient)
    return min(full, centre_distance - root_radius(pair, 1 - number) - clearance)


def _close_mesh(pair: GearPair, base: float) -> float:
    """Centre distance without backlash, with the teeth as the rack cuts the teeth [m]."""
    alpha = pair.basic_rack.pressure_angle
    teeth = pair.pinion.teeth + pair.gear.teeth
    shift = sum(profile_shifts(pair))

    def gap(angle: float) -> float:
        grown = (math.tan(angle) - angle) - (math.tan(alpha) - alpha)
        return grown - 2.0 * shift / teeth * math.tan(alpha)

    if shift == 0.0:
        return base / math.cos(alpha)
    return base / math.cos(float(brentq(gap, 0.0, _STEEPEST, xtol=1e-15, rtol=1e-14)))
