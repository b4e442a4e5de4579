"""Pairs of the ninth set: 13 unlike parameter files of one author; three as from a drawing office.

The office pairs have shifts and tip relief; the others have prescribed contact and perfect involutes.
"""

from __future__ import annotations

from typing import Any

from benchmarks.foreign_models.pairs import RIGID, bearings

Table = dict[str, Any]

ISO: Table = {"model": "rectangular"}
PARABOLA: Table = {"model": "parabolic"}


def _gear(teeth: int, shift: float, width: float, roughness: float, bore: float = 0.0, **more: Any) -> Table:
    """One gear of steel; lengths in mm, roughness in um."""
    table = {"teeth": teeth, "profile_shift": shift, "face_width": width, "roughness": roughness}
    table |= {"youngs_modulus": 206.0, "poisson_ratio": 0.3, "density": 7850.0}
    return table | ({"bore": bore} if bore else {}) | more


def _relief(shape: str, amount: float, start: float) -> Table:
    """Tip relief; amount in um, roll angle of the start in degrees."""
    return {"tip_relief": {"shape": shape, "amount": amount, "start_roll_angle": start}}


def _pair(
    name: str,
    rack: tuple[float, float, float],
    gears: tuple[Table, Table],
    supports: Table,
    mesh: tuple[Table, float],
    friction: Table,
    operating: tuple[float, float],
    viscosity: float = 25.0,
) -> Table:
    """Parameter file; rack: module in mm, angle in degrees, addendum; mesh: stiffness, damping ratio."""
    module, angle, addendum = rack
    relief = "static" if "tip_relief" in gears[0] else "ignored"
    return {
        "format": 2,
        "name": name,
        "description": f"{name} of the ninth set",
        "basic_rack": {
            "module": module,
            "pressure_angle": angle,
            "addendum_coefficient": addendum,
            "dedendum_coefficient": addendum + 0.25,
        },
        "pinion": gears[0],
        "gear": gears[1],
        "bearings": supports,
        "mesh": {
            "contact": "prescribed",
            "relief": relief,
            "backlash": 0.12,
            "stiffness": mesh[0],
            "damping_ratio": mesh[1],
        },
        "lubricant": {"viscosity": viscosity},
        "friction": friction,
        "operating": {"pinion_speed": operating[0], "pinion_torque": operating[1]},
    }


PAIRS: dict[str, Table] = {
    pair["name"]: pair
    for pair in (
        _pair(
            "hoist",
            (3.0, 20.0, 1.0),
            (_gear(19, 0.3, 32.0, 0.6), _gear(57, 0.15, 30.0, 0.6, 35.0)),
            bearings((2e8, 1.4e8), (2.6e8, 2e8), 0.05),
            (ISO, 0.07),
            {"law": "coulomb", "coefficient": 0.08},
            (1450.0, 140.0),
        ),
        _pair(
            "mixer",
            (3.175, 20.0, 1.0),
            (_gear(24, 0.0, 32.0, 0.8, 25.0), _gear(40, 0.0, 32.0, 0.8, 35.0)),
            bearings((1.5e8, 2.4e8), (1.1e8, 1.8e8), 0.06),
            (ISO, 0.08),
            {"law": "coulomb", "coefficient": 0.05},
            (2950.0, 120.0),
        ),
        _pair(
            "compressor",
            (4.0, 20.0, 1.0),
            (_gear(27, 0.1, 42.0, 0.3, 40.0), _gear(62, -0.1, 40.0, 0.3, 70.0)),
            bearings((4.5e8, 3e8), (3.5e8, 5e8), 0.04),
            (PARABOLA, 0.06),
            {"law": "xu_kahraman"},
            (2200.0, 500.0),
            viscosity=12.0,
        ),
        _pair(
            "turbine",
            (2.0, 25.0, 1.0),
            (_gear(35, 0.0, 20.0, 0.3, 24.0), _gear(52, 0.0, 20.0, 0.3, 40.0)),
            bearings((1.3e8, 1e8), (1.6e8, 1.2e8), 0.03),
            ({"model": "energy"}, 0.04),
            {"law": "iso_14179"},
            (6400.0, 90.0),
            viscosity=9.0,
        ),
        _pair(
            "servo",
            (1.0, 20.0, 1.0),
            (_gear(18, 0.25, 12.0, 0.4, 6.0), _gear(90, 0.0, 8.0, 0.4, 25.0)),
            bearings((3e7, 2e7), (4e7, 3.2e7), 0.05),
            (PARABOLA | {"end_ratio": 0.6}, 0.05),
            {"law": "coulomb", "coefficient": 0.1},
            (4500.0, 4.0),
        ),
        _pair(
            "fan",
            (2.5, 20.0, 1.3),
            (_gear(38, 0.05, 24.0, 0.3, 30.0), _gear(51, 0.0, 24.0, 0.3, 40.0)),
            bearings((2e8, 1.3e8), (1.5e8, 2.2e8), 0.05),
            (PARABOLA | {"end_ratio": 0.65}, 0.05),
            {"law": "coulomb", "coefficient": 0.06},
            (1950.0, 160.0),
        ),
        _pair(
            "test_rig",
            (3.0, 20.0, 1.0),
            (_gear(40, 0.0, 20.0, 0.4, 40.0), _gear(40, 0.0, 20.0, 0.4, 40.0)),
            bearings((RIGID, RIGID), (RIGID, RIGID), 0.05),
            (ISO, 0.06),
            {"law": "coulomb", "coefficient": 0.05},
            (1900.0, 240.0),
        ),
        _pair(
            "crusher",
            (8.0, 20.0, 1.0),
            (_gear(25, 0.2, 90.0, 0.5, 80.0), _gear(33, 0.1, 85.0, 0.5, 100.0)),
            bearings((1.2e9, 9e8), (1e9, 1.4e9), 0.06),
            (ISO, 0.09),
            {"law": "benedict_kelley", "maximum": 0.14},
            (560.0, 4200.0),
            viscosity=70.0,
        ),
        _pair(
            "office_reducer",
            (2.5, 20.0, 1.0),
            (
                _gear(21, 0.31, 24.0, 0.5, **_relief("linear", 16.0, 29.5)),
                _gear(58, 0.22, 22.0, 0.5, 30.0, **_relief("linear", 14.0, 24.0)),
            ),
            bearings((1.8e8, 1.3e8), (2.2e8, 1.6e8), 0.05),
            (ISO, 0.07),
            {"law": "coulomb", "coefficient": 0.06},
            (1480.0, 110.0),
        ),
        _pair(
            "office_axle",
            (2.0, 20.0, 1.0),
            (
                _gear(26, 0.18, 28.0, 0.4, 18.0, **_relief("parabolic", 22.0, 26.5)),
                _gear(71, 0.12, 26.0, 0.4, 60.0, **_relief("parabolic", 18.0, 23.0)),
            ),
            bearings((1.4e8, 2e8), (1.7e8, 1.2e8), 0.04),
            (PARABOLA, 0.06),
            {"law": "smoothed_coulomb", "coefficient": 0.08, "sharpness": 35.0},
            (2600.0, 130.0),
        ),
        _pair(
            "office_marine",
            (6.0, 25.0, 1.0),
            (
                _gear(23, 0.15, 70.0, 0.6, 50.0, **_relief("linear", 35.0, 36.0)),
                _gear(31, 0.1, 66.0, 0.6, 60.0, **_relief("linear", 30.0, 33.5)),
            ),
            bearings((8e8, 5e8), (7e8, 9.5e8), 0.05),
            (PARABOLA | {"end_ratio": 0.7}, 0.08),
            {"law": "coulomb", "coefficient": 0.07},
            (1150.0, 1900.0),
        ),
        _pair(
            "rattler",
            (2.25, 20.0, 1.0),
            (_gear(44, 0.0, 14.0, 0.3, 50.0), _gear(47, 0.0, 14.0, 0.3, 50.0)),
            bearings((1.1e8, 9e7), (9e7, 1.3e8), 0.04),
            (ISO, 0.025),
            {"law": "coulomb", "coefficient": 0.04},
            (3850.0, 45.0),
        ),
        _pair(
            "indexer",
            (1.5, 22.5, 0.95),
            (_gear(29, 0.0, 14.0, 0.4, 15.0), _gear(29, 0.0, 14.0, 0.4, 15.0)),
            bearings((9e7, 6e7), (7e7, 8e7), 0.05),
            (PARABOLA, 0.06),
            {"law": "smoothed_coulomb", "coefficient": 0.09, "sharpness": 25.0},
            (3600.0, 24.0),
        ),
    )
}

#: Pairs of the drawing office, with relief.
OFFICE = ("office_reducer", "office_axle", "office_marine")

#: Pairs whose loads are cut at zero by their author: late contact by relief, and teeth that part.
UNILATERAL = (*OFFICE, "rattler")

#: Pairs that are modelled without bearings, which are nearly rigid in the file.
TORSIONAL = ("test_rig",)
