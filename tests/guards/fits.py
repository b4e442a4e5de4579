"""Rows of the ranges in which published fits hold, of friction laws and of stiffness models."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from lumped import GearPair
from lumped.friction import xu_kahraman
from lumped.typing import FloatArray
from tests.guards.by_hand import ByHand, Contact, root_of
from tests.guards.guard import MATE, Changes, Guard, friction, law_range, stiffness_range
from tests.guards.refused import FAST, LONG, RACK_25, RELIEVED, SMALL, UNLIKE_TEETH, of

_ISO = "lumped/stiffness/iso6336.py"
_FOUNDATION = "lumped/stiffness/foundation.py"
_II = "lumped/friction/benedict_kelley.py"
_III = "lumped/friction/xu_kahraman.py"
_ISO_LAW = "lumped/friction/iso_14179.py"
_TABLE = "lumped/friction/table.py"

#: (Law or model, quantity) -> (unit, low, high) of every range that a source states.
RANGES: dict[tuple[str, str], tuple[str, float | None, float | None]] = {
    ("benedict_kelley", "roughness"): ("um", 0.0, 0.75),  # 1.13/(1.13 - S) held at 3, AGMA 925-A03
    ("benedict_kelley", "friction_number"): ("1", 1.0, None),  # its logarithm is negative below
    ("benedict_kelley", "mean_coefficient"): ("1", None, 0.1),  # steel under boundary lubrication
    ("xu_kahraman", "slide_to_roll"): ("1", 0.0, 2.0),  # 2 where one flank stands still
    ("xu_kahraman", "viscosity"): ("mPa s", 1.0, None),  # log10(eta) is positive
    ("xu_kahraman", "pressure"): ("GPa", 0.5, 2.5),  # Xu 2005
    ("xu_kahraman", "mean_rolling_velocity"): ("m/s", 1.0, 20.0),  # Xu 2005
    ("xu_kahraman", "mean_coefficient"): ("1", None, 0.1),
    ("iso_14179", "unit_load"): ("N/mm", 150.0, None),  # ISO/TR 14179-2
    ("iso_14179", "pitch_line_velocity"): ("m/s", None, 50.0),  # ISO/TR 14179-2
    ("iso6336", "profile shift sum x1 + x2"): ("1", -0.5, 2.0),  # ISO 6336-1, method B
    ("iso6336", "profile shift difference x1 - x2"): ("1", 0.0, None),  # x1 >= x2, ISO 6336-1
    ("iso6336", "load per face width"): ("N/mm", 100.0, 1600.0),  # ISO 6336-1
    ("foundation", "half tooth angle on the root circle"): ("rad", 0.01, 0.30),  # Sainsot 2004; FE above 0.12
    ("foundation", "root radius over bore radius"): ("1", 2.0, None),  # plane finite elements
}


def _shift(pair: GearPair, gear: str) -> float:
    return float(getattr(pair, gear).profile_shift)


def _sum(pair: GearPair, gear: str, total: float) -> Changes:
    return {f"{gear}.profile_shift": total - _shift(pair, MATE[gear])}


def _torque_of_load(load: float) -> Callable[[GearPair, str], float]:
    """Torque of a tangential load at the reference circle, per common face width [N/mm]."""
    return lambda pair, gear: load * 1e3 * Contact(pair).width * 1e-3 * ByHand(pair, "pinion").r


def torque_of_unit_load(load: float) -> Callable[[GearPair, str], float]:
    """Torque of a load along the line of action, per common face width [N/mm]."""
    return lambda pair, gear: load * 1e3 * Contact(pair).width * 1e-3 * ByHand(pair, "pinion").r_b


def _dedendum(half_angle: float) -> Callable[[GearPair, str], float]:
    """Dedendum of the rack with which the fillet leaves this half tooth on the root circle [rad].

    The fillet begins at the roll angle of the rack's rounded tip, 2/z (pi/4 - (h_f - rho) tan(alpha)
    - rho/cos(alpha)); the half tooth is what is left of pi/z.
    """

    def limit(pair: GearPair, gear: str) -> float:
        hand = ByHand(pair, gear)
        tip = 0.25 * math.pi - 0.5 * (math.pi - half_angle * hand.z)
        return (tip - hand.fillet / math.cos(hand.alpha)) / math.tan(hand.alpha) + hand.fillet

    return limit


_IN = "ISO 6336-1 tooth stiffness: "
_RECTANGULAR = {"mesh.stiffness": {"model": "rectangular"}, "operating.pinion_torque": 100.0}
_MANY = {"pinion.teeth": 60, "gear.teeth": 75}
STIFFNESS = (
    Guard(_ISO, _IN + "profile shift sum x1 + x2", SMALL, "ISO 6336-1: x1 + x2 >= -0.5", least=-0.5,
          sets=_sum,
          after=_MANY, judge=stiffness_range, beside=True),
    Guard(_ISO, _IN + "profile shift sum x1 + x2", SMALL, "ISO 6336-1: x1 + x2 <= 2", most=2.0, sets=_sum,
          after=_MANY, judge=stiffness_range, beside=True),
    # Gear 1 of the standard has fewer teeth: the pinion of one pair, the gear of the other.
    *(Guard(_ISO, _IN + "profile shift difference x1 - x2", base, "ISO 6336-1: x1 >= x2",
            **{end: lambda pair, _, other=MATE[own]: _shift(pair, other)}, sets=f"{own}.profile_shift",
            after=_RECTANGULAR, judge=stiffness_range)
      for base, own, end in ((RACK_25, "pinion", "least"), (RACK_25, "gear", "most"),
                             (FAST, "gear", "least"), (FAST, "pinion", "most"))),
    *(Guard(_ISO, _IN + "load per face width", base, "ISO 6336-1: F_t/b 100 to 1600 N/mm",
            **{end: _torque_of_load(load)}, sets="operating.pinion_torque", after=_RECTANGULAR,
            judge=stiffness_range)
      for base in (RACK_25, FAST) for end, load in (("least", 100.0), ("most", 1600.0))),
    # A bore of the root radius is half the root diameter; each model has its own list of ranges.
    *(Guard(_FOUNDATION, "rim of the {gear}: root radius over bore radius", base,
            "finite elements: 2 and more",
            most=of(lambda h: h.r_f), sets="{gear}.bore", judge=stiffness_range)
      for base in (RACK_25, SMALL, FAST, UNLIKE_TEETH)),
    *(Guard(_FOUNDATION, "fillet foundation of the {gear}: half tooth angle on the root circle", LONG, why,
            **{end: _dedendum(angle)}, sets="basic_rack.dedendum_coefficient", judge=stiffness_range,
            after={"{gear}.teeth": teeth, "{gear}.profile_shift": shift, "shafts": None, "{gear}.bore": 0.0,
                   "basic_rack.addendum_coefficient": 0.9, "basic_rack.fillet_radius_coefficient": 0.3})
      for why, end, angle, teeth, shift in (("Sainsot et al. (2004): 0.01 and more", "least", 0.01, 300, 0.0),
                                            ("finite elements: up to 0.30", "most", 0.30, 10, 0.55))),
)  # fmt: skip


# ---- friction ---------------------------------------------------------------------------------------------


def _scaled(quantity: Callable[[Contact], float], limit: float, power: float, field: str) -> Callable:
    """Return the value of a field at which a quantity reaches its limit.

    The quantity is proportional to a power of the field.
    """

    def value(pair: GearPair, gear: str) -> float:
        si_value = getattr(pair.operating, field)
        stated_value = si_value * 30.0 / math.pi if field == "pinion_speed" else si_value
        return float(stated_value * (limit / quantity(Contact(pair))) ** (1.0 / power))

    return value


def _mean_of_law_ii(pair: GearPair, gear: str) -> float:
    """Own Ra [um] for a mean of 0.1 of law II, 0.0127 * 1.13/(1.13 - S) log10(number) from 0 to its cap."""
    level = 0.0127 * 1.13 * np.log10(Contact(pair).friction_number)
    cap = pair.friction.maximum
    mean = root_of(lambda s: float(np.clip(level / (1.13 - s), 0.0, cap).mean()) - 0.1, 0.0, 1.1)
    return 2.0 * mean - 1e6 * float(getattr(pair, MATE[gear]).roughness)


def _of_law_iii(c: Contact) -> FloatArray:
    """Law III, whose arguments are in GPa, m/s (half the sum), mPa s, um and m."""
    return xu_kahraman(
        1e-9 * c.pressure, 2.0 * c.sliding / c.entraining, 0.5 * c.entraining, 1e3 * c.viscosity,
        1e6 * c.roughness, c.radius,
    )  # fmt: skip


def _too_rough(pair: GearPair, gear: str) -> float:
    """Own Ra [um] with which law III reaches mu = 1 on the path: it goes with exp(0.620305 exp(S))."""
    largest = _of_law_iii(Contact(pair)).max()
    mean = 0.5e6 * (pair.pinion.roughness + pair.gear.roughness)
    roughness = math.log(math.exp(mean) - math.log(largest) / 0.620305)
    return 2.0 * roughness - 1e6 * float(getattr(pair, MATE[gear]).roughness)


def _law(name: str) -> Changes:
    return {"friction.law": name}


_SPEED = "operating.pinion_speed"
_TORQUE = "operating.pinion_torque"
_XU = {"judge": law_range, "after": _law("xu_kahraman"), "beside": True}
_BK = {"judge": law_range, "after": _law("benedict_kelley")}
_AT = {"friction.law": "table", "friction.table": {"points": [0, 9, 18, 50], "coefficient": [0.05] * 4,
                                                   "speed": 1300.0, "unit_load": 310.0}}  # fmt: skip
FRICTION = (
    *(Guard(_II, "roughness", base, "AGMA 925-A03 holds the factor at 3: S <= 0.75 um",
            sets="{gear}.roughness",
            most=lambda pair, gear: 1.5 - 1e6 * getattr(pair, MATE[gear]).roughness, beside=True, **_BK)
      for base in (RACK_25, LONG)),
    Guard(_II, "friction_number", LONG, "log10 of it is negative below 1", beside=True, sets=_TORQUE, **_BK,
          least=_scaled(lambda c: float(c.friction_number.min()), 1.0, 1.0, "pinion_torque")),
    Guard(_II, "mean_coefficient", RACK_25, "means of lubricated gears are below 0.1", most=_mean_of_law_ii,
          sets="{gear}.roughness", **_BK),
    Guard(_III, "viscosity", RACK_25, "log10(eta) is positive", least=1.0, sets="lubricant.viscosity", **_XU),
    Guard(_III, "pressure", FAST, "Xu 2005: 0.5 GPa and more", sets=_TORQUE, **_XU,
          least=_scaled(lambda c: float(c.pressure.min()), 0.5e9, 0.5, "pinion_torque")),
    Guard(_III, "pressure", RACK_25, "Xu 2005: up to 2.5 GPa", sets=_TORQUE, **_XU,
          most=_scaled(lambda c: float(c.pressure.max()), 2.5e9, 0.5, "pinion_torque")),
    Guard(_III, "mean_rolling_velocity", SMALL, "Xu 2005: 1 m/s and more", sets=_SPEED, **_XU,
          least=_scaled(lambda c: 0.5 * float(c.entraining.min()), 1.0, 1.0, "pinion_speed")),
    Guard(_III, "mean_rolling_velocity", FAST, "Xu 2005: up to 20 m/s", sets=_SPEED, **_XU,
          most=_scaled(lambda c: 0.5 * float(c.entraining.max()), 20.0, 1.0, "pinion_speed")),
    Guard(_III, "mean_coefficient", SMALL, "means of lubricated gears are below 0.1", sets=_SPEED, **_XU,
          least=_scaled(lambda c: float(_of_law_iii(c).mean()), 0.1, -0.100601, "pinion_speed")),
    *(Guard("lumped/path_of_contact/friction.py", "friction.law", base, "not above the normal load",
            most=_too_rough, sets="{gear}.roughness", after=_law("xu_kahraman"), judge=friction)
      for base in (SMALL, FAST)),
    *(Guard(_ISO_LAW, "unit_load", base, "ISO/TR 14179-2: 150 N/mm and more",
            least=torque_of_unit_load(150.0),
            sets=_TORQUE, judge=law_range, after=_law("iso_14179")) for base in (RACK_25, FAST)),
    *(Guard(_ISO_LAW, "pitch_line_velocity", base, "ISO/TR 14179-2: up to 50 m/s", sets=_SPEED,
            judge=law_range,
            most=_scaled(lambda c: c.pitch_line, 50.0, 1.0, "pinion_speed"),
            after={"friction.law": "iso_14179", "operating.pinion_torque": 170.0})
      for base in (SMALL, FAST)),
    *(Guard(_TABLE, "pinion_speed", RELIEVED, "mu of a table by speed: +- 5 %", **{end: value}, sets=_SPEED,
            after=_AT, judge=law_range, beside=True) for end, value in (("least", 1235.0), ("most", 1365.0))),
    *(Guard(_TABLE, "unit_load", RELIEVED, "mu of a table by load: +- 5 %",
            **{end: torque_of_unit_load(load)},
            sets=_TORQUE, after=_AT, judge=law_range, beside=True)
      for end, load in (("least", 294.5), ("most", 325.5))),
)  # fmt: skip

FITS = (*STIFFNESS, *FRICTION)
