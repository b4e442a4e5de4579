"""Pairs of the eighth set: 13 unlike parameter files of one author; three as from a drawing office.

The office pairs have shifts and tip relief; the others have prescribed contact and perfect involutes.
"""

from __future__ import annotations

from typing import Any

from benchmarks.foreign_models.pairs import RIGID, bearings

Table = dict[str, Any]


def wheel(teeth: int, shift: float, width: float, roughness: float = 0.4, **more: Any) -> Table:
    """One gear of steel; face width in mm, roughness in um."""
    steel = {"youngs_modulus": 206.0, "poisson_ratio": 0.3, "density": 7850.0}
    return (
        {"teeth": teeth, "profile_shift": shift, "face_width": width, "roughness": roughness} | steel | more
    )


def relief(shape: str, amount: float, start: float) -> Table:
    """Tip relief; amount in um, roll angle of the start in degrees."""
    return {"tip_relief": {"shape": shape, "amount": amount, "start_roll_angle": start}}


def pair_of(
    name: str,
    rack: tuple[float, float, float],
    pinion: Table,
    gear: Table,
    supports: Table,
    mesh: Table,
    friction: Table,
    operating: tuple[float, float],
    viscosity: float = 30.0,
) -> Table:
    """Parameter file; rack: module in mm, angle in degrees, addendum; operating: rpm and N m."""
    module, angle, addendum = rack
    plain: Table = {"contact": "prescribed", "relief": "ignored", "backlash": 0.15}
    return {
        "format": 2,
        "name": name,
        "description": f"{name} of the eighth set",
        "basic_rack": {
            "module": module,
            "pressure_angle": angle,
            "addendum_coefficient": addendum,
            "dedendum_coefficient": addendum + 0.25,
        },
        "pinion": pinion,
        "gear": gear,
        "bearings": supports,
        "mesh": plain | mesh,
        "lubricant": {"viscosity": viscosity},
        "friction": friction,
        "operating": {"pinion_speed": operating[0], "pinion_torque": operating[1]},
    }


ISO: Table = {"model": "rectangular"}
PARABOLA: Table = {"model": "parabolic"}

PAIRS: dict[str, Table] = {
    pair["name"]: pair
    for pair in (
        pair_of(
            "mower",
            (1.75, 20.0, 1.0),
            wheel(21, 0.3, 16.0, bore=12.0),
            wheel(64, 0.2, 14.0, bore=20.0),
            bearings((6e7, 9e7), (5e7, 8e7), 0.04),
            {"stiffness": ISO, "damping_ratio": 0.06},
            {"law": "coulomb", "coefficient": 0.07},
            (2900.0, 16.0),
        ),
        pair_of(
            "pump",
            (3.0, 20.0, 1.0),
            wheel(30, 0.0, 30.0, bore=28.0),
            wheel(30, 0.0, 30.0, bore=28.0),
            bearings((3.5e8, 2.6e8), (3e8, 3.3e8), 0.06),
            {"stiffness": PARABOLA | {"end_ratio": 0.55}, "damping_ratio": 0.09},
            {"law": "smoothed_coulomb", "coefficient": 0.09, "sharpness": 20.0},
            (1480.0, 190.0),
        ),
        pair_of(
            "gearbox",
            (4.0, 20.0, 1.0),
            wheel(17, 0.42, 26.0, 0.5),
            wheel(29, 0.31, 24.0, 0.6, bore=40.0),
            bearings((2.2e8, 4e8), (1.7e8, 2.5e8), 0.05),
            {"stiffness": ISO, "damping_ratio": 0.07},
            {"law": "xu_kahraman"},
            (1900.0, 210.0),
            viscosity=45.0,
        ),
        pair_of(
            "tractor",
            (5.0, 20.0, 1.0),
            wheel(19, 0.35, 48.0, 0.3),
            wheel(53, 0.25, 45.0, 0.4, bore=70.0),
            bearings((5e8, 7e8), (4e8, 6e8), 0.03),
            {"stiffness": PARABOLA, "damping_ratio": 0.1},
            {"law": "benedict_kelley", "maximum": 0.15},
            (1100.0, 900.0),
            viscosity=60.0,
        ),
        pair_of(
            "aero",
            (2.5, 25.0, 1.0),
            wheel(33, 0.0, 18.0, 0.2),
            wheel(41, 0.0, 18.0, 0.2, bore=35.0),
            bearings((1.6e8, 1.1e8), (1.9e8, 1.4e8), 0.02),
            {"stiffness": {"model": "energy"}, "damping_ratio": 0.05},
            {"law": "iso_14179"},
            (5200.0, 160.0),
            viscosity=8.0,
        ),
        pair_of(
            "long_teeth",
            (2.0, 20.0, 1.3),
            wheel(42, 0.05, 20.0, 0.3),
            wheel(55, -0.05, 20.0, 0.3, bore=30.0),
            bearings((1.2e8, 1e8), (1.4e8, 0.9e8), 0.05),
            {"stiffness": PARABOLA | {"end_ratio": 0.7}, "damping_ratio": 0.06},
            {"law": "coulomb", "coefficient": 0.05},
            (2500.0, 110.0),
        ),
        pair_of(
            "lathe",
            (2.75, 20.0, 1.0),
            wheel(37, 0.0, 22.0),
            wheel(37, 0.0, 22.0, bore=45.0),
            bearings((RIGID, RIGID), (RIGID, RIGID), 0.05),
            {"stiffness": ISO, "damping_ratio": 0.08},
            {"law": "coulomb", "coefficient": 0.06},
            (1750.0, 120.0),
        ),
        pair_of(
            "robot",
            (1.25, 20.0, 1.0),
            wheel(16, 0.45, 10.0, 0.3),
            wheel(71, -0.1, 9.0, 0.3, bore=30.0),
            bearings((2.5e7, 2e7), (3.5e7, 2.8e7), 0.05),
            {"stiffness": PARABOLA, "damping_ratio": 0.04},
            {"law": "coulomb", "coefficient": 0.1},
            (9000.0, 6.0),
        ),
        pair_of(
            "office_linear",
            (3.0, 20.0, 1.0),
            wheel(23, 0.27, 25.0, **relief("linear", 18.0, 27.5)),
            wheel(47, 0.11, 24.0, bore=40.0, **relief("linear", 15.0, 24.5)),
            bearings((2.4e8, 1.8e8), (3e8, 2.1e8), 0.05),
            {"stiffness": ISO, "damping_ratio": 0.08, "relief": "static"},
            {"law": "coulomb", "coefficient": 0.05},
            (2400.0, 170.0),
        ),
        pair_of(
            "office_parabolic",
            (2.25, 20.0, 1.0),
            wheel(18, 0.32, 20.0, 0.3, **relief("parabolic", 24.0, 33.0)),
            wheel(37, 0.18, 18.0, 0.3, bore=25.0, **relief("parabolic", 20.0, 27.0)),
            bearings((1.1e8, 1.6e8), (1.3e8, 0.8e8), 0.04),
            {"stiffness": PARABOLA, "damping_ratio": 0.06, "relief": "static"},
            {"law": "xu_kahraman"},
            (3300.0, 60.0),
            viscosity=20.0,
        ),
        pair_of(
            "office_25_degrees",
            (4.5, 25.0, 1.0),
            wheel(27, 0.1, 38.0, 0.5, bore=40.0, **relief("linear", 25.0, 33.0)),
            wheel(34, 0.05, 36.0, 0.5, bore=50.0, **relief("linear", 25.0, 32.5)),
            bearings((6e8, 4.5e8), (5e8, 7e8), 0.06),
            {"stiffness": ISO, "damping_ratio": 0.1, "relief": "static"},
            {"law": "smoothed_coulomb", "coefficient": 0.06, "sharpness": 30.0},
            (1600.0, 700.0),
        ),
        pair_of(
            "winder",
            (2.0, 20.0, 1.0),
            wheel(40, 0.0, 15.0, bore=52.0),
            wheel(43, 0.0, 15.0, bore=40.0),
            bearings((1e8, 8e7), (9e7, 1.2e8), 0.05),
            {"stiffness": ISO, "damping_ratio": 0.03},
            {"law": "coulomb", "coefficient": 0.04},
            (8000.0, 55.0),
        ),
        pair_of(
            "press",
            (6.0, 20.0, 0.85),
            wheel(26, 0.1, 60.0, 0.7, bore=60.0),
            wheel(39, 0.0, 60.0, 0.7, bore=80.0),
            bearings((9e8, 7e8), (8e8, 1e9), 0.05),
            {"stiffness": ISO, "damping_ratio": 0.07},
            {"law": "coulomb", "coefficient": 0.08},
            (720.0, 1800.0),
        ),
    )
}

#: Pairs of the drawing office, with relief.
OFFICE = ("office_linear", "office_parabolic", "office_25_degrees")
