"""Parameter files of the pairs of the seventh set, as mappings for ``lumped.load_gear_pair``.

Contact is prescribed, because the users' teeth touch from A to D; one pair has relief as an unloaded error.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

Table = dict[str, Any]

STEEL = {"youngs_modulus": 206.0, "poisson_ratio": 0.3, "density": 7850.0}
#: Bearings that do not give way, of users who model rotations alone [N/m].
RIGID = 1e12


def wheel(teeth: int, shift: float, width: float, roughness: float, **others: Any) -> Table:
    """One gear, by default of steel; width in mm, roughness Ra in um."""
    sizes = {"teeth": teeth, "profile_shift": shift, "face_width": width, "roughness": roughness}
    return {**sizes, **STEEL, **others}


def bearing(loa: float, oloa: float, loa_damping: float, oloa_damping: float) -> Table:
    """Bearings of one gear: stiffness in N/m and damping ratio, along and off the line of action."""
    return {
        "loa_stiffness": loa,
        "oloa_stiffness": oloa,
        "loa_damping_ratio": loa_damping,
        "oloa_damping_ratio": oloa_damping,
    }


def pair(
    name: str,
    rack: Mapping[str, float],
    wheels: tuple[Table, Table],
    bearings: tuple[Table, Table],
    mesh: Mapping[str, Any],
    friction: Mapping[str, Any],
    operating: tuple[float, float],
    viscosity: float = 20.0,
) -> Table:
    """One file; the operating point is the speed of the pinion in rpm and its torque in N m."""
    return {
        "format": 2,
        "name": name,
        "description": f"{name}, as its user has it",
        "basic_rack": {"fillet_radius_coefficient": 0.25, **rack},
        "pinion": wheels[0],
        "gear": wheels[1],
        "bearings": {"pinion": bearings[0], "gear": bearings[1]},
        "mesh": {"backlash": 0.1, "contact": "prescribed", "relief": "ignored", **mesh},
        "lubricant": {
            "viscosity": viscosity,
            "pressure_viscosity_k": 0.010471,
            "pressure_viscosity_s": 0.1348,
        },
        "friction": dict(friction),
        "operating": {"pinion_speed": operating[0], "pinion_torque": operating[1]},
    }


REDUCER = pair(
    "reducer",
    {"module": 3.0, "pressure_angle": 20.0},
    (
        wheel(19, 0.35, 32.0, 0.45, mass=0.72, inertia=3.4e-4),
        wheel(61, -0.10, 30.0, 0.6, bore=45.0, mass=5.6, inertia=2.55e-2),
    ),
    (bearing(2.9e8, 2.1e8, 0.05, 0.04), bearing(3.8e8, 3.2e8, 0.06, 0.05)),
    {"damping_ratio": 0.06, "stiffness": {"model": "rectangular"}},
    {"law": "xu_kahraman"},
    (1480.0, 165.0),
    viscosity=42.0,
)

STUDENT = pair(
    "student",
    {"module": 2.5, "pressure_angle": 20.0},
    (wheel(27, 0.0, 20.0, 0.4, bore=20.0), wheel(35, 0.0, 20.0, 0.4, bore=20.0)),
    (bearing(1.5e8, 1.5e8, 0.05, 0.05), bearing(1.5e8, 1.5e8, 0.05, 0.05)),
    {"damping_ratio": 0.07, "stiffness": {"model": "parabolic"}},
    {"law": "coulomb", "coefficient": 0.06},
    (2400.0, 75.0),
)

PUMP = pair(
    "pump",
    {"module": 4.5, "pressure_angle": 20.0},
    (
        wheel(14, 0.45, 28.0, 0.5, mass=0.83, inertia=4.3e-4),
        wheel(14, 0.45, 28.0, 0.5, mass=0.71, inertia=3.6e-4),
    ),
    (bearing(1.2e8, 0.8e8, 0.08, 0.06), bearing(0.9e8, 1.1e8, 0.07, 0.09)),
    {"damping_ratio": 0.08, "stiffness": {"model": "rectangular"}},
    {"law": "coulomb", "coefficient": 0.08},
    (1450.0, 96.0),
)

STEP_UP = pair(
    "step_up",
    {"module": 5.0, "pressure_angle": 20.0},
    (wheel(47, 0.12, 60.0, 0.5, bore=90.0), wheel(20, 0.30, 62.0, 0.4, bore=35.0)),
    (bearing(7.0e8, 5.2e8, 0.04, 0.05), bearing(4.4e8, 6.1e8, 0.06, 0.03)),
    {"damping_ratio": 0.05, "stiffness": {"model": "energy"}},
    {"law": "smoothed_coulomb", "coefficient": 0.07, "sharpness": 22.0},
    (620.0, 2100.0),
)

RACING = pair(
    "racing",
    {"module": 3.5, "pressure_angle": 28.0, "fillet_radius_coefficient": 0.2},
    (
        wheel(22, 0.08, 16.0, 0.2, mass=0.44, inertia=3.1e-4),
        wheel(27, -0.08, 16.0, 0.2, mass=0.95, inertia=6.9e-4),
    ),
    (bearing(2.1e8, 1.7e8, 0.05, 0.06), bearing(1.8e8, 2.6e8, 0.04, 0.05)),
    {"damping_ratio": 0.06, "stiffness": {"model": "rectangular", "pair_stiffness": 2.3e8}},
    {"law": "benedict_kelley", "maximum": 0.1},
    (7400.0, 260.0),
    viscosity=7.0,
)

LONG_TEETH = pair(
    "long_teeth",
    {
        "module": 2.75,
        "pressure_angle": 20.0,
        "addendum_coefficient": 1.38,
        "dedendum_coefficient": 1.63,
        "fillet_radius_coefficient": 0.18,
    },
    (wheel(37, 0.10, 26.0, 0.3, bore=30.0), wheel(53, -0.02, 24.0, 0.4, bore=38.0)),
    (bearing(3.2e8, 0.9e8, 0.04, 0.07), bearing(2.6e8, 1.1e8, 0.05, 0.06)),
    {"damping_ratio": 0.05, "stiffness": {"model": "parabolic"}},
    {"law": "xu_kahraman"},
    (2850.0, 230.0),
    viscosity=15.0,
)

MACHINE_TOOL = pair(
    "machine_tool",
    {
        "module": 2.54,
        "pressure_angle": 14.5,
        "addendum_coefficient": 0.8,
        "dedendum_coefficient": 1.0,
        "fillet_radius_coefficient": 0.2,
    },
    (
        wheel(36, 0.0, 36.0, 0.8, mass=1.75, inertia=1.9e-3),
        wheel(72, 0.0, 25.0, 0.8, mass=4.6, inertia=2.0e-2),
    ),
    (bearing(2.4e8, 1.8e8, 0.06, 0.05), bearing(1.9e8, 2.7e8, 0.05, 0.06)),
    {"damping_ratio": 0.1, "stiffness": {"model": "rectangular"}},
    {"law": "coulomb", "coefficient": 0.09},
    (950.0, 110.0),
)

PLASTIC = pair(
    "plastic",
    {"module": 1.5, "pressure_angle": 20.0},
    (
        wheel(18, 0.22, 14.0, 0.6, bore=6.0),
        wheel(41, 0.0, 12.0, 1.0, bore=10.0, youngs_modulus=2.9, poisson_ratio=0.38, density=1410.0),
    ),
    (bearing(4.0e7, 3.0e7, 0.05, 0.05), bearing(2.2e7, 3.4e7, 0.08, 0.06)),
    {"damping_ratio": 0.09, "stiffness": {"model": "rectangular"}},
    {"law": "coulomb", "coefficient": 0.18},
    (1900.0, 2.2),
)

RELIEVED = pair(
    "relieved",
    {"module": 3.0, "pressure_angle": 20.0},
    (
        wheel(
            31,
            0.06,
            28.0,
            0.35,
            bore=30.0,
            tip_relief={"shape": "linear", "amount": 14.0, "start_roll_angle": 25.5},
        ),
        wheel(
            44,
            0.15,
            30.0,
            0.5,
            bore=40.0,
            tip_relief={"shape": "linear", "amount": 11.0, "start_roll_angle": 25.0},
        ),
    ),
    (bearing(2.7e8, 1.9e8, 0.05, 0.06), bearing(3.5e8, 2.3e8, 0.04, 0.05)),
    {"damping_ratio": 0.07, "relief": "static", "stiffness": {"model": "parabolic"}},
    {"law": "iso_14179"},
    (3000.0, 310.0),
    viscosity=11.0,
)

PARTING = pair(
    "parting",
    {"module": 2.0, "pressure_angle": 20.0},
    (wheel(32, 0.0, 18.0, 0.3, bore=18.0), wheel(49, 0.10, 16.0, 0.3, bore=22.0)),
    (bearing(9.0e8, 7.0e8, 0.03, 0.04), bearing(8.0e8, 9.5e8, 0.03, 0.04)),
    {"damping_ratio": 0.016, "stiffness": {"model": "rectangular"}},
    {"law": "none"},
    (6600.0, 48.0),
)

RIG = pair(
    "rig",
    {"module": 3.25, "pressure_angle": 20.0},
    (
        wheel(44, 0.0, 22.0, 0.4, mass=2.6, inertia=7.6e-3),
        wheel(44, 0.0, 22.0, 0.4, mass=2.6, inertia=7.6e-3),
    ),
    (bearing(RIGID, RIGID, 0.05, 0.05), bearing(RIGID, RIGID, 0.05, 0.05)),
    {"damping_ratio": 0.018, "stiffness": {"model": "rectangular", "pair_stiffness": 3.1e8}},
    {"law": "coulomb", "coefficient": 0.05},
    (1300.0, 200.0),
)

SOFT_MOUNTS = pair(
    "soft_mounts",
    {"module": 2.25, "pressure_angle": 20.0},
    (
        wheel(29, 0.18, 18.0, 0.3, mass=0.49, inertia=2.6e-4),
        wheel(38, -0.06, 17.0, 0.4, mass=0.78, inertia=7.1e-4),
    ),
    (bearing(2.4e7, 1.5e7, 0.06, 0.05), bearing(1.7e7, 3.1e7, 0.05, 0.07)),
    {"damping_ratio": 0.08, "stiffness": {"model": "parabolic"}},
    {"law": "benedict_kelley", "maximum": 0.12},
    (5200.0, 62.0),
    viscosity=12.0,
)

SHIFTED = pair(
    "shifted",
    {"module": 3.5, "pressure_angle": 22.5},
    (wheel(21, 0.52, 30.0, 0.4, bore=24.0), wheel(34, 0.44, 28.0, 0.6, bore=40.0)),
    (bearing(2.2e8, 1.4e8, 0.05, 0.07), bearing(1.6e8, 2.5e8, 0.06, 0.04)),
    {"damping_ratio": 0.06, "stiffness": {"model": "energy"}},
    {"law": "smoothed_coulomb", "coefficient": 0.06, "sharpness": 35.0},
    (1750.0, 340.0),
)

PAIRS = (
    *(REDUCER, STUDENT, PUMP, STEP_UP, RACING, LONG_TEETH, MACHINE_TOOL, PLASTIC),
    *(RELIEVED, PARTING, RIG, SOFT_MOUNTS, SHIFTED),
)
