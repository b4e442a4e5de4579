"""Rows of what is doubted: values that hardly can be meant, and assumptions of the model as flags."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator

import numpy as np
import xarray as xr

from lumped import GearPair, condensed_bearings
from tests.guards.by_hand import ByHand, Contact
from tests.guards.fits import torque_of_unit_load
from tests.guards.guard import MATE, Acts, Changes, Choice, Guard
from tests.guards.refused import FAST, LONG, RACK_25, RELIEVED, SMALL, of
from tests.unlike_pairs import unlike_pair
from validation.validity import flags
from validation.validity.plausibility import parameter_warnings


def doubt(pair: GearPair, changes: Changes) -> Acts:
    """Sentences about values that hardly can be meant."""
    return [("doubt", text) for text in parameter_warnings(pair.with_(dict(changes)))]


_WHERE = "validation/validity/plausibility.py"
#: A mesh whose mean stiffness is known: 3e8 N/m a pair, as many pairs as the contact ratio says.
_PAIR_STIFFNESS = 3e8
_KNOWN = {"mesh.stiffness": {"model": "rectangular", "pair_stiffness": _PAIR_STIFFNESS}}
_SLOW = _KNOWN | {"operating.pinion_speed": 200.0}


def _size(field: str, why: str, says: str, **limits: float) -> Iterator[Guard]:
    for end, limit in limits.items():
        sets = f"{field.rpartition('.')[0]}"
        relief = sets.endswith("relief")
        yield Guard(_WHERE, "doubt", RELIEVED, why, **{end: limit}, sets=field, judge=doubt, says=says,
                    beside=True, after={sets: {"amount": 3.0,
                    "start_roll_angle": 25.0}} if relief else {})  # fmt: skip


def _epsilon(pair: GearPair) -> float:
    hand = ByHand(pair, "pinion")
    return (hand.tip_length - hand.start_length) / hand.base_pitch


def _gives_way(pair: GearPair) -> float:
    """Deflection of the mesh [m]: the load along the line of action over the mean stiffness."""
    load = pair.operating.pinion_torque / (1e-3 * ByHand(pair, "pinion").r_b)
    return load / (_PAIR_STIFFNESS * _epsilon(pair))


def _torque_that_gives(share: float) -> Callable[[GearPair, str], float]:
    def limit(pair: GearPair, gear: str) -> float:
        return float(share * pair.basic_rack.module / _gives_way(pair) * pair.operating.pinion_torque)

    return limit


def _pressing(pair: GearPair, gear: str) -> float:
    """Torque that presses the flanks at the pitch point with 4.2 GPa."""
    pitch = Contact(pair, np.array([Contact(pair).pitch]))
    return float(pair.operating.pinion_torque * (4.2e9 / pitch.pressure[0]) ** 2)


def _width(modules: float) -> Callable[[GearPair, str], float]:
    return lambda pair, gear: modules * 1e3 * pair.basic_rack.module


def _disc(pair: GearPair, gear: str) -> tuple[float, float]:
    """Mass and inertia of the gear, a disc of the reference diameter with a bore [kg, kg m^2]."""
    own = getattr(pair, gear)
    radius = 1e-3 * ByHand(pair, gear).r
    area = math.pi * (radius**2 - 0.25 * own.bore**2)
    mass = own.density * area * own.face_width
    return float(mass), float(0.5 * mass * (radius**2 + 0.25 * own.bore**2))


def _square(pair: GearPair) -> float:
    """Square of 1000 oscillations a mesh cycle [rad^2/s^2]."""
    return float((1000.0 * pair.operating.pinion_speed * pair.pinion.teeth) ** 2)


def _stiff_off(pair: GearPair, gear: str) -> float:
    return _square(pair) * _disc(pair, gear)[0]


def _stiff_along(pair: GearPair, gear: str) -> float:
    """The bearing acts beside the mesh."""
    return _square(pair) * _disc(pair, gear)[0] - _PAIR_STIFFNESS * _epsilon(pair)


def _light(pair: GearPair, gear: str) -> float:
    """Inertia with which k (r_b1^2/J_1 + r_b2^2/J_2) is that square."""
    hand = ByHand(pair, gear)
    mate = (1e-3 * hand.mate.r_b) ** 2 / _disc(pair, MATE[gear])[1]
    return float((1e-3 * hand.r_b) ** 2 / (_square(pair) / (_PAIR_STIFFNESS * _epsilon(pair)) - mate))


def _springs(line: str) -> Callable[[GearPair, str, float], Changes]:
    """Springs that are equivalent to the shafts, except for one spring with a multiple of this stiffness."""

    def sets(pair: GearPair, gear: str, factor: float) -> Changes:
        static = condensed_bearings(pair).bearings
        every = {
            f"bearings.{name}.{one}_stiffness": float(getattr(getattr(static, name), f"{one}_stiffness"))
            for name in ("pinion", "gear") for one in ("loa", "oloa")
        }  # fmt: skip
        return every | {
            f"bearings.{gear}.{line}_stiffness": factor * every[f"bearings.{gear}.{line}_stiffness"]
        }

    return sets


def _rpm_of(velocity: float) -> Callable[[GearPair, str], float]:
    """Speed [rpm] at which the pitch line moves at a velocity [m/s]."""

    def limit(pair: GearPair, gear: str) -> float:
        return velocity / Contact(pair).pitch_line * float(pair.operating.pinion_speed) * 30.0 / math.pi

    return limit


def _both(share: float) -> Callable[[GearPair, str], float]:
    """A share of the root sum of squares of both roughnesses [um]."""
    return lambda pair, gear: share * 1e6 * math.hypot(pair.pinion.roughness, pair.gear.roughness)


_STEEL = "{gear}.youngs_modulus = "
DOUBTS = (
    *_size("bearings.{gear}.loa_stiffness", "softer than any gear shaft", "{gear}.loa_stiffness = ",
           least=2e6),
    *_size("bearings.{gear}.oloa_stiffness", "softer than any gear shaft", "{gear}.oloa_stiffness = ",
           least=2e6),
    *_size("{gear}.youngs_modulus", "plastics 1 GPa, hard metal 650 GPa", _STEEL, least=0.5, most=800.0),
    *_size("{gear}.roughness", "polished 0.02 um, cast 12.5 um", "{gear}.roughness = ", least=0.01,
           most=12.5),
    *_size("{gear}.tip_relief.amount", "half a micrometre can be made", "{gear}.tip_relief.amount",
           least=0.5),
    *_size("{gear}.root_relief.amount", "half a micrometre can be made", "{gear}.root_relief.amount",
           least=0.5),
    *(Guard(_WHERE, "doubt", base, "gears are 5 to 40 modules wide", **{end: _width(modules)}, judge=doubt,
            sets="{gear}.face_width", says="{gear}.face_width = ", beside=True)
      for base in (RACK_25, FAST) for end, modules in (("least", 0.5), ("most", 100.0))),
    Guard(_WHERE, "doubt", RACK_25, "ISO 76:2006: bearing steel is indented for good at 4.2 GPa",
          most=_pressing,
          sets="operating.pinion_torque", judge=doubt, says="presses the flanks", beside=True),
    *(Guard(_WHERE, "doubt", base, "a tenth of the module is beyond any tooth", most=_torque_that_gives(0.1),
            sets="operating.pinion_torque", after=_KNOWN, judge=doubt, says="more than a tenth of the module",
            beside=True) for base in (RACK_25, FAST)),
    Guard(_WHERE, "doubt", RACK_25, "the backs would touch where the backlash is less than the deflection",
          least=lambda pair, gear: 1e3 * _gives_way(pair), sets="mesh.backlash", after=_KNOWN, judge=doubt,
          says="the backs of the teeth would touch"),
    Guard(_WHERE, "doubt", RACK_25, "no backlash but for the rounding of lengths is meant", near=1e-3,
          most=lambda pair, gear: 1e-9 * 1e3 * pair.basic_rack.module, sets="mesh.backlash", after=_KNOWN,
          judge=doubt, says="the backs of the teeth would touch"),
    Guard(_WHERE, "doubt", FAST, "1.450 may be 1450", least=5.0, sets="operating.pinion_speed", judge=doubt,
          says="does a point part thousands?", beside=True),
    Guard(_WHERE, "doubt", SMALL, "24 may be turns a second", least=120.0, sets="operating.pinion_speed",
          judge=doubt, says="Turns a second meant?", after=_KNOWN),
    Guard(_WHERE, "doubt", RELIEVED, "pitch lines of gears in use move faster than 0.5 m/s",
          least=_rpm_of(0.5),
          sets="operating.pinion_speed", judge=doubt, says="Turns a second meant?", after=_KNOWN),
    *(Guard(_WHERE, "doubt", base, "pitch lines of gears in use move slower than 200 m/s",
            most=_rpm_of(200.0),
            sets="operating.pinion_speed", judge=doubt, says="faster than any gears") for base in (FAST,
            RACK_25)),
    *(Guard(_WHERE, "doubt", base, "variances add: +- 5 % of the root sum of squares", **{end: _both(share)},
            sets="friction.composite_roughness", judge=doubt, says="not the root sum")
      for base in (FAST, RACK_25) for end, share in (("least", 0.95), ("most", 1.05))),
    *(Guard(_WHERE, "doubt", RACK_25, "a cycle of 1000 oscillations takes minutes", **{end: limit},
            sets=field,
            after=_SLOW, judge=doubt, says="The fastest mode swings")
      for end, limit, field in (("most", _stiff_off, "bearings.{gear}.oloa_stiffness"),
                                ("most", _stiff_along, "bearings.{gear}.loa_stiffness"),
                                ("least", _light, "{gear}.inertia"))),
    *(Guard(_WHERE, "doubt", LONG, "twice another stiffness is another machine", **{end: factor}, judge=doubt,
            sets=_springs(line), says="the {gear} has")
      for line in ("loa", "oloa") for end, factor in (("least", 0.5), ("most", 2.0))),
)  # fmt: skip


# ---- flags ------------------------------------------------------------------------------------------------


def film_flag(pair: GearPair, changes: Changes) -> Acts:
    """The flag of the lubrication regime, where it warns."""
    found = flags.film_regime(pair.with_(dict(changes)))
    return [(found.key, found.detail)] * (found.state != "ok")


def contact_ratio_flag(pair: GearPair, changes: Changes) -> Acts:
    """The flag of the contact ratio, where it warns."""
    found = flags.contact_ratio(pair.with_(dict(changes)).geometry)
    return [(found.key, found.detail)] * (found.state != "ok")


def law_flag(pair: GearPair, changes: Changes) -> Acts:
    """The flag of the friction law's ranges, where it warns."""
    found = flags.law_ranges(pair.with_(dict(changes)))
    return [(found.key, found.detail)] * (found.state != "ok")


def stiffness_flag(pair: GearPair, changes: Changes) -> Acts:
    """The flag of the stiffness model's ranges, where it warns."""
    found = flags.stiffness_ranges(pair.with_(dict(changes)))
    return [(found.key, found.detail)] * (found.state != "ok")


def _ends(pair: GearPair) -> Contact:
    contact = Contact(pair)
    return Contact(pair, np.linspace(contact.start, contact.end, 201))


def _rough(pair: GearPair, gear: str) -> float:
    """Own Ra [um] with which the film parameter falls to the first threshold: it goes with 1/R, R^2 adds."""
    contact = _ends(pair)
    composite = contact.composite * float(contact.film_parameter.min()) / pair.friction.thresholds[0]
    return 1e6 * math.sqrt(composite**2 - getattr(pair, MATE[gear]).roughness ** 2)


_FLAGS = "validation/validity/flags.py"
FLAGGED = (
    *(Guard(_FLAGS, "film_parameter", base, "boundary lubrication below the first threshold of law V",
            most=_rough, sets="{gear}.roughness", after={"friction.law": law}, judge=film_flag)
      for base, law in ((LONG, "xu_kahraman"), (FAST, "benedict_kelley"), (FAST, "iso_14179"))),
    *(Choice(_FLAGS, "film_parameter", LONG, why, {"{gear}.roughness": 9.0},
             {"{gear}.roughness": 9.0, "friction.law": law}, judge=film_flag)
      for law, why in (("composite", "law V changes its law itself"), ("coulomb", "no regime"))),
    Guard(_FLAGS, "friction_law_range", RACK_25, "ISO/TR 14179-2: 150 N/mm and more",
          sets="operating.pinion_torque",
          least=torque_of_unit_load(150.0), after={"friction.law": "iso_14179"}, judge=law_flag),
    Guard(_FLAGS, "stiffness_range", FAST, "finite elements: root radius over bore radius 2 and more",
          most=of(lambda h: h.r_f), sets="{gear}.bore", judge=stiffness_flag, says="rim of the {gear}"),
    Choice(_FLAGS, "stiffness_range", RACK_25, "a number of the user stands on no fit",
           {"operating.pinion_torque": 30.0},
           {"operating.pinion_torque": 30.0, "mesh.stiffness.pair_stiffness": 3e8}, judge=stiffness_flag),
    Guard(_FLAGS, "contact_ratio", SMALL, "below 1.1 tolerances leave moments without contact",
          least=lambda pair, gear: (h := ByHand(pair, gear)).tip_diameter(
              1.1 * h.base_pitch + h.line - h.mate.tip_length),
          sets="{gear}.tip_diameter", judge=contact_ratio_flag),
)  # fmt: skip


@dataclasses.dataclass(frozen=True)
class Level:
    """A row of a flag of a motion: the last number that is good, and the last that is a warning only.

    Attributes
    ----------
    key : of the flag
    good, warned : limits; equal where there is no warning
    flag : the flag of a motion made so that its number is this one
    source : where the limits come from
    near : distance of the values tried from the limits, relative
    """

    key: str
    good: float
    warned: float
    flag: Callable[[float], flags.Flag]
    source: str
    near: float = 1e-9
    where: str = _FLAGS

    @property
    def names(self) -> str:
        """Key of the flag, as other rows call it."""
        return self.key

    @property
    def title(self) -> str:
        """Name of the row in the list of tests."""
        return f"{self.key}-levels"

    def complaints(self) -> list[str]:
        """Sides of both limits on which the state is another one."""
        low = 1.0 - self.near
        high = 1.0 + self.near
        tried = {self.good * low: "ok", self.warned * high: "violated"}
        if self.warned != self.good:
            tried |= {self.good * high: "warning", self.warned * low: "warning"}
        found = {value: self.flag(value) for value in tried}
        return [
            f"{v!r}: {found[v].state}, not {state}" for v, state in tried.items() if found[v].state != state
        ] + [f"{v!r}: {one.action!r}" for v, one in found.items() if bool(one.action) == (one.state == "ok")]


#: Of motions that are made up: the pair tells the scale.
_PAIR = unlike_pair(RACK_25)


def _motion(**variables: list[list[float]]) -> xr.Dataset:
    return xr.Dataset({name: (("pair", "time"), np.array(rows)) for name, rows in variables.items()})


def _reversed_at(share: float) -> flags.Flag:
    """Sliding of a loaded pair turns at a share of a base pitch before P, half way between two samples of it.

    A pair without load, which slides backwards further out, does not count.
    """
    g = _PAIR.geometry
    scale = np.array([[-1.5, -0.5, 0.5], [-9.0, -8.0, 0.5]])
    motion = _motion(position=(g.L_XP + g.base_pitch * share * scale).tolist(), contact=[[1.0] * 3] * 2,
                     sliding_velocity=[[-1.0, 1.0, 1.0]] * 2, normal_load=[[9.0] * 3, [0.0] * 3])  # fmt: skip
    return flags.sliding_reversal(g, motion)


def _pulled(share: float) -> flags.Flag:
    """The lowest load is minus a share of the static load T/r_b, over all pairs together."""
    hand = ByHand(_PAIR, "pinion")
    static = _PAIR.operating.pinion_torque / (1e-3 * hand.r_b)
    loads = [[static, -0.5 * share * static], [static, -0.5 * share * static]]
    motion = _motion(
        normal_load=loads, contact=[[1.0, 1.0]] * 2, position=[[1e-3 * hand.start_length] * 2] * 2
    )
    return flags.contact_loss(_PAIR, _PAIR.geometry, motion)


def _drifting(share: float) -> flags.Flag:
    """The pinion gains a share of its nominal speed from the first mesh cycle to the last."""
    period = 2.0 * math.pi / (_PAIR.pinion.teeth * float(_PAIR.operating.pinion_speed))
    rate = share * float(_PAIR.operating.pinion_speed) * np.array([0.0, 0.0, 0.3, 1.0, 1.0])
    time = period * np.array([0.0, 0.5, 2.0, 3.5, 4.0])
    return flags.speed_drift(_PAIR.geometry, xr.Dataset({"time": ("t", time), "theta_p_dot": ("t", rate)}))


def _given(**attributes: float) -> xr.Dataset:
    return xr.Dataset(attrs=attributes)


LEVELS = (
    Level("sliding_reversal", 0.02, 0.05, _reversed_at, "chosen: of a base pitch"),
    Level("contact_loss", 1e-4, 1e-4, _pulled, "of the static load: teeth that touch without load"),
    Level("speed_drift", 1e-3, 1e-2, _drifting, "chosen: of the nominal speed"),
    Level("solution_error", 1e-6, 1e-4,
          lambda error: flags.solution_error(_given(error_estimate=error, closure=0.0)),
          "chosen: of the transmission error, far below differences that are discussed"),
    Level("torque_balance", 1e-9, 0.05,
          lambda excess: flags.torque_balance(_PAIR, _given(
              pinion_torque=_PAIR.operating.pinion_torque * (1.0 - excess), brake_torque=1.0)),
          "of the driving torque; 1e-9 of it has seven digits in the difference of two torques", near=1e-6),
)  # fmt: skip

DOUBTED = (*DOUBTS, *FLAGGED, *LEVELS)
