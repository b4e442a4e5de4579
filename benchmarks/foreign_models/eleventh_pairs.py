"""Pairs of the eleventh set: 13 parameter files of one author, unlike each other.

Three are as from a drawing office, with shifts and tip relief. The others have perfect involutes.
"""

from __future__ import annotations

from typing import Any

from benchmarks.foreign_models.pairs import RIGID, bearings

Table = dict[str, Any]

ISO: Table = {"model": "rectangular"}
IRON: Table = {"youngs_modulus": 118.0, "density": 7200.0}


def _rack(module: float, angle: float = 20.0, addendum: float = 1.0) -> Table:
    return {
        "module": module,
        "pressure_angle": angle,
        "addendum_coefficient": addendum,
        "dedendum_coefficient": addendum + 0.25,
    }


def _wheel(teeth: int, width: float, bore: float, shift: float = 0.0, **more: Any) -> Table:
    """One gear of steel unless ``more`` says otherwise; width and bore in mm."""
    wheel = {"teeth": teeth, "face_width": width, "bore": bore, "profile_shift": shift, "roughness": 0.5}
    return wheel | {"youngs_modulus": 206.0, "poisson_ratio": 0.3, "density": 7850.0} | more


def _relieved(shape: str, amount: float, start: float) -> Table:
    """Tip relief; amount in um, roll angle of the start in degrees."""
    return {"tip_relief": {"shape": shape, "amount": amount, "start_roll_angle": start}}


def _mesh(stiffness: Table, damping_ratio: float, backlash: float = 0.08) -> Table:
    return {
        "contact": "prescribed",
        "relief": "ignored",
        "backlash": backlash,
        "stiffness": stiffness,
        "damping_ratio": damping_ratio,
    }


def _at(speed: float, torque: float) -> Table:
    """Operating point: rpm, N m."""
    return {"pinion_speed": speed, "pinion_torque": torque}


def _coulomb(coefficient: float) -> Table:
    return {"law": "coulomb", "coefficient": coefficient}


_BARE: dict[str, Table] = {
    # Of a drawing office: shifts, relief, energy method or ISO.
    "spindle": {
        "basic_rack": _rack(2.5),
        "pinion": _wheel(24, 26.0, 25.0, 0.4, **_relieved("linear", 11.0, 30.0)),
        "gear": _wheel(38, 24.0, 45.0, 0.2, **_relieved("linear", 9.0, 25.5)),
        "bearings": bearings((4e8, 3e8), (3.5e8, 2.6e8), 0.05),
        "mesh": _mesh({"model": "energy"}, 0.07) | {"relief": "static"},
        "friction": _coulomb(0.05),
        "operating": _at(3600.0, 150.0),
    },
    "tractor": {
        "basic_rack": _rack(5.0),
        "pinion": _wheel(18, 55.0, 35.0, 0.45, **_relieved("parabolic", 22.0, 33.0)),
        "gear": _wheel(49, 50.0, 80.0, 0.15, **_relieved("parabolic", 19.0, 25.0)),
        "bearings": bearings((9e8, 4e8), (1.1e9, 5e8), 0.05),
        "mesh": _mesh(ISO, 0.08) | {"relief": "static"},
        "friction": _coulomb(0.07),
        "operating": _at(1500.0, 900.0),
    },
    "reducer": {
        "basic_rack": _rack(3.0),
        "pinion": _wheel(22, 36.0, 24.0, 0.3, **_relieved("linear", 9.0, 31.0)),
        "gear": _wheel(83, 34.0, 80.0, 0.3, **_relieved("linear", 8.0, 23.6)),
        "bearings": bearings((5e8, 3.2e8), (7e8, 4.4e8), 0.06),
        "mesh": _mesh(ISO, 0.06, 0.12) | {"relief": "static"},
        "friction": {"law": "iso_14179"},
        "operating": _at(1480.0, 190.0),
    },
    # Of students, users of multibody programs, test engineers.
    "student": {
        "basic_rack": _rack(4.0),
        "pinion": _wheel(30, 30.0, 30.0),
        "gear": _wheel(30, 30.0, 30.0),
        "bearings": bearings((1e8, 1e8), (1e8, 1e8), 0.05),
        "mesh": _mesh(ISO, 0.05),
        "friction": _coulomb(0.1),
        "operating": _at(1000.0, 200.0),
    },
    "matlab": {
        "basic_rack": _rack(3.0),
        "pinion": _wheel(23, 20.0, 20.0),
        "gear": _wheel(47, 20.0, 40.0),
        "bearings": bearings((RIGID, RIGID), (RIGID, RIGID), 0.05),
        "mesh": _mesh({"model": "parabolic", "end_ratio": 0.55}, 0.06),
        "friction": {"law": "none"},
        "operating": _at(7000.0, 80.0),
    },
    "fan": {
        "basic_rack": _rack(2.0, 25.0),
        "pinion": _wheel(37, 16.0, 25.0),
        "gear": _wheel(53, 16.0, 35.0),
        "bearings": bearings((1.6e8, 1.2e8), (2e8, 1.4e8), 0.04),
        "mesh": _mesh(ISO, 0.1),
        "friction": {"law": "xu_kahraman"},
        "operating": _at(7600.0, 60.0),
    },
    "robot": {
        "basic_rack": _rack(1.0, 17.5, 0.9),
        "pinion": _wheel(20, 10.0, 6.0),
        "gear": _wheel(80, 9.0, 20.0),
        "bearings": bearings((5e7, 3.5e7), (6e7, 4.5e7), 0.06),
        "mesh": _mesh(ISO, 0.06, 0.04),
        "friction": _coulomb(0.14),
        "operating": _at(2600.0, 3.0),
    },
    "hoist": {
        "basic_rack": _rack(8.0),
        "pinion": _wheel(21, 120.0, 70.0, 0.3),
        "gear": _wheel(67, 110.0, 140.0, -0.3),
        "bearings": bearings((1.2e9, 8e8), (1.4e9, 1e9), 0.05),
        "mesh": _mesh({"model": "parabolic", "end_ratio": 0.4}, 0.07, 0.2),
        "friction": _coulomb(0.1),
        "operating": _at(420.0, 4200.0),
    },
    "wind": {
        "basic_rack": _rack(6.0, 22.5),
        "pinion": _wheel(85, 60.0, 120.0),
        "gear": _wheel(27, 60.0, 60.0),
        "bearings": bearings((1.5e9, 1.1e9), (1e9, 9e8), 0.04),
        "mesh": _mesh({"model": "parabolic"}, 0.05),
        "friction": {"law": "benedict_kelley", "maximum": 0.1},
        "operating": _at(520.0, 7000.0),
    },
    "tall": {
        "basic_rack": _rack(2.5, 20.0, 1.4),
        "pinion": _wheel(41, 25.0, 40.0),
        "gear": _wheel(59, 25.0, 60.0),
        "bearings": bearings((2.2e8, 1.7e8), (2.6e8, 2e8), 0.05),
        "mesh": _mesh(ISO, 0.05),
        "friction": {"law": "smoothed_coulomb", "coefficient": 0.06, "sharpness": 20.0},
        "operating": _at(1900.0, 210.0),
    },
    "racing": {
        "basic_rack": _rack(2.25, 22.0),
        "pinion": _wheel(27, 15.0, 18.0),
        "gear": _wheel(43, 15.0, 30.0),
        "bearings": bearings((8e8, 6e8), (9e8, 7e8), 0.04),
        "mesh": _mesh(ISO, 0.08),
        "friction": _coulomb(0.04),
        "operating": _at(9000.0, 70.0),
    },
    "cast": {
        "basic_rack": _rack(6.0, 20.0, 0.9),
        "pinion": _wheel(26, 60.0, 40.0, **IRON),
        "gear": _wheel(39, 60.0, 60.0, **IRON),
        "bearings": bearings((1.8e8, 1.3e8), (2.1e8, 1.5e8), 0.06),
        "mesh": _mesh(ISO, 0.06),
        "friction": _coulomb(0.09),
        "operating": _at(800.0, 600.0),
    },
    "test": {
        "basic_rack": _rack(3.5, 20.0),
        "pinion": _wheel(35, 18.0, 40.0),
        "gear": _wheel(36, 18.0, 40.0),
        "bearings": bearings((3.2e8, 2.5e8), (3e8, 2.3e8), 0.05),
        "mesh": _mesh(ISO, 0.06),
        "friction": _coulomb(0.05),
        "operating": _at(2700.0, 180.0),
    },
}

PAIRS: dict[str, Table] = {
    name: {"format": 2, "name": name, "description": f"{name} of the eleventh set"}
    | pair
    | {"lubricant": {"viscosity": 18.0}}
    for name, pair in _BARE.items()
}

#: Pairs whose loads are cut at zero by their author: late contact by relief, and teeth that part.
UNILATERAL = ("spindle", "tractor", "reducer", "racing")

#: Pairs that are modelled without bearings, which are nearly rigid in the file.
TORSIONAL = ("matlab",)
