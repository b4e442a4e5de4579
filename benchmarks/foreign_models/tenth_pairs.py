"""Pairs of the tenth set: 13 unlike parameter files of one author; three as from a drawing office.

The office pairs have shifts and tip relief; the others have prescribed contact and perfect involutes.
"""

from __future__ import annotations

from typing import Any

from benchmarks.foreign_models.pairs import RIGID, bearings

Table = dict[str, Any]

ISO: Table = {"model": "rectangular"}


def _side(teeth: int, shift: float, width: float, roughness: float, **more: Any) -> Table:
    """One gear of steel unless ``more`` says otherwise; width and bore in mm, roughness in um."""
    steel = {"youngs_modulus": 206.0, "poisson_ratio": 0.3, "density": 7850.0}
    size = {"teeth": teeth, "profile_shift": shift, "face_width": width, "roughness": roughness}
    return size | steel | more


def _tip(shape: str, amount: float, start: float) -> Table:
    """Tip relief; amount in um, roll angle of the start in degrees."""
    return {"shape": shape, "amount": amount, "start_roll_angle": start}


def _rack(module: float, angle: float = 20.0, addendum: float = 1.0) -> Table:
    return {
        "module": module,
        "pressure_angle": angle,
        "addendum_coefficient": addendum,
        "dedendum_coefficient": addendum + 0.25,
    }


def _pair(
    rack: Table,
    pinion: Table,
    gear: Table,
    supports: Table,
    mesh: tuple[Table, float],
    friction: Table,
    operating: tuple[float, float],
    viscosity: float = 20.0,
) -> Table:
    """Parameter file without its name; mesh: stiffness, damping ratio; operating: rpm, N m."""
    return {
        "format": 2,
        "basic_rack": rack,
        "pinion": pinion,
        "gear": gear,
        "bearings": supports,
        "mesh": {
            "contact": "prescribed",
            "relief": "static" if "tip_relief" in pinion else "ignored",
            "backlash": 0.1,
            "stiffness": mesh[0],
            "damping_ratio": mesh[1],
        },
        "lubricant": {"viscosity": viscosity},
        "friction": friction,
        "operating": {"pinion_speed": operating[0], "pinion_torque": operating[1]},
    }


_BARE: dict[str, Table] = {
    "press": _pair(
        _rack(2.0),
        _side(17, 0.0, 20.0, 0.5, bore=10.0),
        _side(52, 0.0, 20.0, 0.5, bore=24.0),
        bearings((1.2e8, 8e7), (1.5e8, 1e8), 0.05),
        (ISO, 0.06),
        {"law": "coulomb", "coefficient": 0.06},
        (2850.0, 32.0),
    ),
    "winch": _pair(
        _rack(5.0),
        _side(19, 0.3, 50.0, 0.8, bore=35.0),
        _side(61, -0.3, 48.0, 0.8, bore=60.0),
        bearings((5e8, 3.5e8), (6e8, 4e8), 0.06),
        ({"model": "parabolic", "end_ratio": 0.5}, 0.08),
        {"law": "coulomb", "coefficient": 0.12},
        (720.0, 650.0),
    ),
    "mill": _pair(
        _rack(6.0),
        _side(23, 0.35, 90.0, 0.6, bore=45.0, tip_relief=_tip("linear", 25.0, 30.0)),
        _side(71, 0.22, 76.0, 0.6, bore=110.0, tip_relief=_tip("linear", 20.0, 24.0)),
        bearings((1e9, 7e8), (1.3e9, 9e8), 0.05),
        ({"model": "energy"}, 0.07),
        {"law": "coulomb", "coefficient": 0.05},
        (1180.0, 1900.0),
    ),
    "aero": _pair(
        _rack(2.54, 25.0),
        _side(31, 0.0, 18.0, 0.35, bore=25.0),
        _side(44, 0.0, 18.0, 0.35, bore=35.0),
        bearings((2e8, 1.5e8), (1.6e8, 2.2e8), 0.04),
        (ISO, 0.05),
        {"law": "xu_kahraman"},
        (6200.0, 95.0),
        viscosity=6.0,
    ),
    "old": _pair(
        _rack(2.54, 14.5),
        _side(40, 0.0, 22.0, 0.7, bore=30.0),
        _side(63, 0.0, 22.0, 0.7, bore=40.0),
        bearings((9e7, 1.2e8), (1.4e8, 7e7), 0.03),
        (ISO, 0.03),
        {"law": "coulomb", "coefficient": 0.07},
        (1300.0, 75.0),
    ),
    "tall": _pair(
        _rack(3.0, 20.0, 1.35),
        _side(36, 0.0, 28.0, 0.3, bore=35.0),
        _side(53, 0.0, 28.0, 0.3, bore=50.0),
        bearings((3e8, 2e8), (2.4e8, 2.8e8), 0.05),
        (ISO, 0.06),
        {"law": "smoothed_coulomb", "coefficient": 0.07, "sharpness": 30.0},
        (2100.0, 260.0),
    ),
    "scooter": _pair(
        _rack(1.5),
        _side(19, 0.0, 12.0, 0.5, bore=10.0),
        _side(37, 0.0, 12.0, 0.5, bore=15.0),
        bearings((1.6e8, 6e7), (1.8e8, 8e7), 0.05),
        (ISO, 0.04),
        {"law": "coulomb", "coefficient": 0.08},
        (12500.0, 9.0),
    ),
    "pump": _pair(
        _rack(4.0),
        _side(21, 0.3, 34.0, 0.4, bore=30.0, tip_relief=_tip("parabolic", 28.0, 31.0)),
        _side(21, 0.3, 34.0, 0.4, bore=30.0, tip_relief=_tip("parabolic", 28.0, 31.0)),
        bearings((2.5e8, 1.8e8), (2e8, 2.6e8), 0.05),
        (ISO, 0.08),
        {"law": "benedict_kelley", "maximum": 0.12},
        (1470.0, 240.0),
        viscosity=35.0,
    ),
    "increaser": _pair(
        _rack(3.5),
        _side(67, 0.0, 36.0, 0.3, bore=70.0),
        _side(29, 0.0, 36.0, 0.3, bore=40.0),
        bearings((6e8, 4e8), (4e8, 5e8), 0.05),
        ({"model": "parabolic"}, 0.06),
        {"law": "xu_kahraman"},
        (1250.0, 820.0),
        viscosity=14.0,
    ),
    "tester": _pair(
        _rack(3.5),
        _side(44, 0.0, 18.0, 0.4, bore=50.0),
        _side(44, 0.0, 18.0, 0.4, bore=50.0),
        bearings((RIGID, RIGID), (RIGID, RIGID), 0.05),
        (ISO, 0.06),
        {"law": "coulomb", "coefficient": 0.04},
        (1500.0, 260.0),
    ),
    "lathe": _pair(
        _rack(4.0),
        _side(20, 0.25, 40.0, 0.5, bore=46.0, tip_relief=_tip("linear", 18.0, 31.0)),
        _side(35, 0.15, 38.0, 0.5, bore=95.0, tip_relief=_tip("linear", 16.0, 27.0)),
        bearings((7e8, 5e8), (6e8, 4.5e8), 0.04),
        (ISO, 0.08),
        {"law": "coulomb", "coefficient": 0.05},
        (3000.0, 330.0),
    ),
    "axle": _pair(
        _rack(1.9, 17.5, 1.1),
        _side(29, 0.0, 26.0, 0.25, bore=16.0),
        _side(73, 0.0, 24.0, 0.25, bore=50.0),
        bearings((1.8e8, 1.3e8), (2.2e8, 1.6e8), 0.06),
        ({"model": "parabolic", "end_ratio": 0.65}, 0.05),
        {"law": "xu_kahraman"},
        (11000.0, 70.0),
        viscosity=7.0,
    ),
    "feeder": _pair(
        _rack(4.5),
        _side(30, 0.0, 30.0, 0.9, bore=40.0, youngs_modulus=126.0, density=7300.0),
        _side(30, 0.0, 30.0, 0.9, bore=40.0, youngs_modulus=126.0, density=7300.0),
        bearings((6e7, 4e7), (5e7, 7e7), 0.07),
        (ISO, 0.1),
        {"law": "coulomb", "coefficient": 0.08},
        (960.0, 300.0),
    ),
}

PAIRS: dict[str, Table] = {
    name: pair | {"name": name, "description": f"{name} of the tenth set"} for name, pair in _BARE.items()
}

#: Pairs whose loads are cut at zero by their author: late contact by relief, and teeth that part.
UNILATERAL = ("mill", "pump", "lathe", "scooter")

#: Pairs that are modelled without bearings, which are nearly rigid in the file.
TORSIONAL = ("tester",)
