"""Pairs of the fifth set, each written out by its own numbers; contact is prescribed."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from typing import Any

from benchmarks.foreign_models.pairs import RIGID, bearings

Pair = dict[str, Any]


def _gear(teeth: int, shift: float, width: float, roughness: float, **more: Any) -> Pair:
    return {
        "teeth": teeth,
        "profile_shift": shift,
        "face_width": width,
        "roughness": roughness,
        "youngs_modulus": 206.0,
        "poisson_ratio": 0.3,
        "density": 7850.0,
    } | more


def _pair(
    name: str, description: str, rack: Pair, pinion: Pair, gear: Pair, supports: Pair, **sections: Any
) -> Pair:
    mesh = {"contact": "prescribed", "relief": "ignored"} | sections.pop("mesh")
    return {
        "format": 2,
        "name": name,
        "description": description,
        "basic_rack": rack,
        "pinion": pinion,
        "gear": gear,
        "bearings": supports,
        "mesh": mesh,
    } | sections


def _relief(amount: float, start: float) -> Pair:
    return {"shape": "linear", "amount": amount, "start_roll_angle": start}


_FAN = _pair(
    "fan",
    "23/67 of a fan drive, pinion wider than the gear",
    {"module": 3.0},
    _gear(23, 0.28, 34.0, 0.5, bore=25.0),
    _gear(67, -0.12, 26.0, 0.6, bore=60.0),
    bearings((2.2e8, 3.1e8), (1.6e8, 2.4e8), 0.05),
    mesh={"damping_ratio": 0.06, "stiffness": {"model": "rectangular"}},
    lubricant={"viscosity": 20.0},
    friction={"law": "coulomb", "coefficient": 0.06},
    operating={"pinion_speed": 4300.0, "pinion_torque": 180.0},
)
_OVERDRIVE = _pair(
    "overdrive",
    "71/26 that speeds up, shift on the driven gear alone",
    {"module": 2.0},
    _gear(71, 0.0, 30.0, 0.4, bore=50.0),
    _gear(26, 0.35, 31.0, 0.4),
    bearings((1.4e8, 0.9e8), (1.1e8, 1.2e8), 0.04),
    mesh={"damping_ratio": 0.07, "stiffness": {"model": "parabolic"}},
    lubricant={"viscosity": 25.0},
    friction={"law": "smoothed_coulomb", "coefficient": 0.05, "sharpness": 20.0},
    operating={"pinion_speed": 2050.0, "pinion_torque": 260.0},
)
_SERVO = _pair(
    "servo",
    "24/35 with a rack of 25 degrees",
    {"module": 3.5, "pressure_angle": 25.0},
    _gear(24, 0.1, 25.0, 0.3, bore=20.0),
    _gear(35, -0.1, 25.0, 0.3, bore=30.0),
    bearings((2.6e8, 2.0e8), (2.9e8, 1.7e8), 0.05),
    mesh={"damping_ratio": 0.05, "stiffness": {"model": "parabolic", "end_ratio": 0.58}},
    lubricant={"viscosity": 12.0},
    friction={"law": "xu_kahraman"},
    operating={"pinion_speed": 5200.0, "pinion_torque": 150.0},
)
_LONG_TEETH = _pair(
    "long_teeth",
    "38/53 with long addenda, contact ratio above 2",
    {
        "module": 2.5,
        "addendum_coefficient": 1.32,
        "dedendum_coefficient": 1.6,
        "fillet_radius_coefficient": 0.2,
    },
    _gear(38, 0.06, 28.0, 0.4, bore=30.0),
    _gear(53, -0.04, 28.0, 0.4, bore=40.0),
    bearings((1.9e8, 1.3e8), (2.3e8, 1.5e8), 0.05),
    mesh={"damping_ratio": 0.06, "stiffness": {"model": "energy"}},
    lubricant={"viscosity": 15.0},
    friction={"law": "coulomb", "coefficient": 0.05},
    operating={"pinion_speed": 3300.0, "pinion_torque": 220.0},
)
_PUMP = _pair(
    "pump",
    "14/31 with large shifts and shortened tips",
    {"module": 4.0},
    _gear(14, 0.55, 30.0, 0.35),
    _gear(31, 0.5, 30.0, 0.35, bore=35.0),
    bearings((3.0e8, 2.2e8), (2.5e8, 2.8e8), 0.06),
    mesh={"damping_ratio": 0.08, "stiffness": {"model": "rectangular", "pair_stiffness": 4.1e8}},
    lubricant={"viscosity": 35.0},
    friction={"law": "benedict_kelley", "maximum": 0.11},
    operating={"pinion_speed": 2600.0, "pinion_torque": 240.0},
)
_RELIEVED = _pair(
    "relieved",
    "30/45 with linear tip relief on both gears",
    {"module": 3.0},
    _gear(30, 0.0, 20.0, 0.4, bore=30.0, tip_relief=_relief(9.0, 25.5)),
    _gear(45, 0.0, 20.0, 0.4, bore=45.0, tip_relief=_relief(13.0, 23.5)),
    bearings((2.0e8, 1.5e8), (1.7e8, 1.9e8), 0.05),
    mesh={
        "relief": "static",
        "damping_ratio": 0.06,
        "stiffness": {"model": "parabolic"},
    },
    lubricant={"viscosity": 18.0},
    friction={"law": "coulomb", "coefficient": 0.07},
    operating={"pinion_speed": 3900.0, "pinion_torque": 260.0},
)
_LIGHT = _pair(
    "light",
    "40/41 lightly loaded in its resonance",
    {"module": 2.0},
    _gear(40, 0.0, 15.0, 0.3, bore=20.0),
    _gear(41, 0.0, 15.0, 0.3, bore=20.0),
    bearings((1.5e9, 1.5e9), (1.2e9, 1.2e9), 0.05),
    mesh={"damping_ratio": 0.04, "backlash": 0.3, "stiffness": {"model": "rectangular"}},
    lubricant={"viscosity": 10.0},
    friction={"law": "none"},
    operating={"pinion_speed": 8000.0, "pinion_torque": 15.0},
)
_MILL = _pair(
    "mill",
    "19/83, slow under a large load",
    {"module": 6.0},
    _gear(19, 0.35, 80.0, 0.8, bore=40.0),
    _gear(83, 0.05, 76.0, 0.9, bore=120.0),
    bearings((9.0e8, 6.5e8), (7.5e8, 8.5e8), 0.05),
    mesh={"damping_ratio": 0.06, "stiffness": {"model": "parabolic", "end_ratio": 0.6}},
    lubricant={"viscosity": 60.0},
    friction={"law": "iso_14179"},
    operating={"pinion_speed": 1150.0, "pinion_torque": 2600.0},
)
_TEST_RIG = _pair(
    "test_rig",
    "32/48 on nearly rigid bearings",
    {"module": 2.5},
    _gear(32, 0.0, 18.0, 0.4, bore=25.0),
    _gear(48, 0.0, 18.0, 0.4, bore=35.0),
    bearings((RIGID, RIGID), (RIGID, RIGID), 0.05),
    mesh={"damping_ratio": 0.07, "stiffness": {"model": "rectangular"}},
    lubricant={"viscosity": 14.0},
    friction={"law": "coulomb", "coefficient": 0.05},
    operating={"pinion_speed": 3600.0, "pinion_torque": 110.0},
)
_BRONZE = _pair(
    "bronze",
    "22/54, steel pinion and bronze wheel",
    {"module": 2.75},
    _gear(22, 0.2, 22.0, 0.4),
    _gear(54, -0.2, 22.0, 0.6, bore=38.0, youngs_modulus=110.0, poisson_ratio=0.34, density=8700.0),
    bearings((1.3e8, 1.6e8), (1.2e8, 1.0e8), 0.04),
    mesh={"damping_ratio": 0.05, "stiffness": {"model": "rectangular"}},
    lubricant={"viscosity": 40.0},
    friction={"law": "coulomb", "coefficient": 0.08},
    operating={"pinion_speed": 3500.0, "pinion_torque": 75.0},
)
_EFFICIENCY_RIG = _pair(
    "efficiency_rig",
    "17/25 with ground flanks",
    {"module": 4.5},
    _gear(17, 0.2, 15.0, 0.11),
    _gear(25, 0.12, 15.0, 0.12, bore=30.0),
    bearings((1.8e8, 1.1e8), (1.5e8, 1.4e8), 0.05),
    mesh={"damping_ratio": 0.06, "stiffness": {"model": "parabolic"}},
    lubricant={"viscosity": 22.0},
    friction={"law": "benedict_kelley", "maximum": 0.15},
    operating={"pinion_speed": 3600.0, "pinion_torque": 135.0},
)
_INVERSE = _pair(
    "inverse",
    "33/29 that speeds up a little, masses and inertias given",
    {"module": 3.175, "fillet_radius_coefficient": 0.3},
    _gear(33, 0.05, 20.0, 0.25, mass=1.31, inertia=1.72e-3),
    _gear(29, 0.12, 19.0, 0.3, mass=0.92, inertia=0.95e-3),
    bearings((1.6e8, 1.1e8), (1.4e8, 1.3e8), 0.05),
    mesh={"damping_ratio": 0.05, "stiffness": {"model": "energy"}},
    lubricant={"viscosity": 30.0},
    friction={"law": "xu_kahraman"},
    operating={"pinion_speed": 3300.0, "pinion_torque": 140.0},
)
_SPINDLE = _pair(
    "spindle",
    "45/64, fast",
    {"module": 1.5},
    _gear(45, 0.1, 16.0, 0.3, bore=25.0),
    _gear(64, 0.02, 15.0, 0.3, bore=32.0),
    bearings((1.7e8, 1.5e8), (2.1e8, 1.2e8), 0.05),
    mesh={"damping_ratio": 0.06, "stiffness": {"model": "energy", "scale": "iso6336"}},
    lubricant={"viscosity": 8.0},
    friction={"law": "smoothed_coulomb", "coefficient": 0.04, "sharpness": 40.0},
    operating={"pinion_speed": 5500.0, "pinion_torque": 45.0},
)

PAIRS: dict[str, Pair] = {
    pair["name"]: pair
    for pair in (
        *(_FAN, _OVERDRIVE, _SERVO, _LONG_TEETH, _PUMP, _RELIEVED, _LIGHT),
        *(_MILL, _TEST_RIG, _BRONZE, _EFFICIENCY_RIG, _INVERSE, _SPINDLE),
    )
}

#: Pairs that the user models without bearings, and those at whose operating point teeth lose contact.
TORSIONAL = ("test_rig",)
LOSES_CONTACT = ("light",)


def at(name: str, changes: Mapping[str, Any]) -> Pair:
    """Return a pair with other values; a change is named by its path, with two underscores for a point."""
    pair = copy.deepcopy(PAIRS[name])
    for path, value in changes.items():
        *sections, last = path.split("__")
        inside = pair
        for section in sections:
            inside = inside[section]
        inside[last] = value
    return pair
