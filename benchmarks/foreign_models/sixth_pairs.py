"""Pairs of the sixth set: parameter files as mappings, written for it and unlike each other.

Contact is prescribed. Relief is ignored, but for ``relieved``.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

Pair = dict[str, Any]

#: Stiffness of a support that does not yield [N/m], for models that only turn.
RIGID = 1e12


def gear(teeth: int, shift: float, width: float, bore: float, roughness: float, **others: Any) -> Pair:
    """One gear: face width and bore [mm], roughness Ra [um]; ``others`` by the names of the file."""
    return {
        "teeth": teeth,
        "profile_shift": shift,
        "face_width": width,
        "bore": bore,
        "youngs_modulus": 206.0,
        "poisson_ratio": 0.3,
        "density": 7850.0,
        "roughness": roughness,
    } | others


def rack(module: float, angle: float = 20.0, addendum: float = 1.0, dedendum: float = 1.25) -> Pair:
    """Basic rack: module [mm], pressure angle [deg]."""
    return {
        "module": module,
        "pressure_angle": angle,
        "addendum_coefficient": addendum,
        "dedendum_coefficient": dedendum,
        "fillet_radius_coefficient": 0.2,
    }


def support(loa: float, oloa: float, loa_ratio: float, oloa_ratio: float) -> Pair:
    """Support of a gear: stiffness [N/m] and damping ratio along and off the line of action."""
    return {
        "loa_stiffness": loa,
        "oloa_stiffness": oloa,
        "loa_damping_ratio": loa_ratio,
        "oloa_damping_ratio": oloa_ratio,
    }


def pair_of(
    name: str,
    description: str,
    basic_rack: Pair,
    gears: tuple[Pair, Pair],
    supports: tuple[Pair, Pair],
    mesh: Pair,
    friction: Pair,
    viscosity: float,
    operating: tuple[float, float],
    **others: Any,
) -> Pair:
    """Parameter file: viscosity [mPa s], operating point as speed [rpm] and torque [N m] of the pinion."""
    return {
        "format": 2,
        "name": name,
        "description": description,
        "basic_rack": basic_rack,
        "pinion": gears[0],
        "gear": gears[1],
        "bearings": {"pinion": supports[0], "gear": supports[1]},
        "mesh": {"contact": "prescribed", "relief": "ignored"} | mesh,
        "lubricant": {"viscosity": viscosity},
        "friction": friction,
        "operating": {"pinion_speed": operating[0], "pinion_torque": operating[1]},
    } | others


def _relief(amount: float, start: float) -> Pair:
    return {"shape": "linear", "amount": amount, "start_roll_angle": start}


_MADE = (
    pair_of(
        "mixer",
        "19/77 of a mixer, unlike widths, stiffness of ISO 6336-1",
        rack(2.5),
        (gear(19, 0.35, 30.0, 16.0, 0.4), gear(77, -0.10, 22.0, 60.0, 0.6)),
        (support(1.8e8, 1.2e8, 0.05, 0.04), support(2.6e8, 2.0e8, 0.03, 0.06)),
        {"damping_ratio": 0.05, "stiffness": {"model": "rectangular"}},
        {"law": "coulomb", "coefficient": 0.06},
        20.0,
        (1470.0, 95.0),
    ),
    pair_of(
        "lathe",
        "33/33 of a lathe with large bores",
        rack(3.0),
        (gear(33, 0.0, 18.0, 62.0, 0.4), gear(33, 0.0, 18.0, 66.0, 0.4)),
        (support(3.1e8, 2.2e8, 0.04, 0.05), support(2.4e8, 2.8e8, 0.05, 0.03)),
        {"damping_ratio": 0.07, "stiffness": {"model": "parabolic"}},
        {"law": "smoothed_coulomb", "coefficient": 0.08, "sharpness": 20.0},
        30.0,
        (2900.0, 150.0),
    ),
    pair_of(
        "excavator",
        "14/43 from a 25-degree rack, slow and heavily loaded",
        rack(6.0, angle=25.0, dedendum=1.2),
        (gear(14, 0.45, 60.0, 30.0, 0.7), gear(43, 0.05, 56.0, 90.0, 0.7)),
        (support(7.0e8, 5.0e8, 0.06, 0.05), support(9.0e8, 6.5e8, 0.04, 0.07)),
        {"damping_ratio": 0.06, "stiffness": {"model": "energy"}},
        {"law": "benedict_kelley", "maximum": 0.15},
        90.0,
        (620.0, 2300.0),
    ),
    pair_of(
        "press",
        "37/59 with long teeth, contact ratio above 2",
        rack(2.0, addendum=1.38, dedendum=1.62),
        (gear(37, 0.10, 24.0, 25.0, 0.3), gear(59, -0.10, 24.0, 40.0, 0.3)),
        (support(1.3e8, 1.0e8, 0.05, 0.05), support(1.9e8, 1.4e8, 0.06, 0.04)),
        {"damping_ratio": 0.05, "stiffness": {"model": "parabolic"}},
        {"law": "coulomb", "coefficient": 0.05},
        25.0,
        (1900.0, 130.0),
    ),
    pair_of(
        "turbine",
        "61 teeth drive 24, fast",
        rack(1.75),
        (gear(61, -0.10, 16.0, 40.0, 0.3), gear(24, 0.25, 18.0, 14.0, 0.3)),
        (support(2.2e8, 1.6e8, 0.03, 0.04), support(1.2e8, 1.7e8, 0.05, 0.05)),
        {"damping_ratio": 0.08, "stiffness": {"model": "rectangular"}},
        {"law": "iso_14179"},
        9.0,
        (4200.0, 110.0),
    ),
    pair_of(
        "rig",
        "16/24 of the FZG kind",
        rack(4.5),
        (gear(16, 0.1817, 14.0, 20.0, 0.35), gear(24, 0.1715, 14.0, 30.0, 0.35)),
        (support(1.5e8, 1.5e8, 0.05, 0.05), support(1.5e8, 1.5e8, 0.05, 0.05)),
        {"damping_ratio": 0.06, "stiffness": {"model": "rectangular"}},
        {"law": "xu_kahraman"},
        12.0,
        (2600.0, 239.0),
    ),
    pair_of(
        "student",
        "24/36 of a textbook, two torsional degrees of freedom",
        rack(4.0),
        (gear(24, 0.0, 30.0, 0.0, 0.4), gear(36, 0.0, 30.0, 0.0, 0.4)),
        (support(RIGID, RIGID, 0.05, 0.05), support(RIGID, RIGID, 0.05, 0.05)),
        {"damping_ratio": 0.1, "stiffness": {"model": "rectangular", "pair_stiffness": 3.5e8}},
        {"law": "coulomb", "coefficient": 0.05},
        20.0,
        (1200.0, 300.0),
    ),
    pair_of(
        "howl",
        "45/45 without friction, near resonance, contact is lost",
        rack(2.5),
        (gear(45, 0.0, 20.0, 30.0, 0.4), gear(45, 0.0, 20.0, 30.0, 0.4)),
        (support(8.0e8, 8.0e8, 0.03, 0.03), support(8.0e8, 8.0e8, 0.03, 0.03)),
        {"damping_ratio": 0.05, "stiffness": {"model": "rectangular"}},
        {"law": "none"},
        10.0,
        (3600.0, 120.0),
    ),
    pair_of(
        "relieved",
        "29/34 with tip relief on both gears",
        rack(3.0),
        (
            gear(29, 0.08, 26.0, 28.0, 0.4, tip_relief=_relief(18.0, 26.5)),
            gear(34, 0.02, 26.0, 32.0, 0.4, tip_relief=_relief(16.0, 25.5)),
        ),
        (support(2.4e8, 1.8e8, 0.05, 0.04), support(3.0e8, 2.1e8, 0.04, 0.06)),
        {"damping_ratio": 0.06, "stiffness": {"model": "rectangular"}, "relief": "static"},
        {"law": "coulomb", "coefficient": 0.04},
        15.0,
        (2400.0, 260.0),
    ),
    pair_of(
        "windmill",
        "22/91, large positive shifts, very slow, thick oil",
        rack(5.0),
        (gear(22, 0.45, 82.0, 50.0, 0.6), gear(91, 0.30, 78.0, 150.0, 0.8)),
        (support(6.0e8, 4.0e8, 0.03, 0.05), support(1.1e9, 8.0e8, 0.05, 0.04)),
        {"damping_ratio": 0.05, "stiffness": {"model": "energy"}},
        {"law": "xu_kahraman"},
        55.0,
        (190.0, 1800.0),
    ),
    pair_of(
        "stub",
        "13/34 with short teeth, contact ratio near 1.1",
        rack(3.5, angle=22.5, addendum=0.8, dedendum=1.1),
        (gear(13, 0.30, 32.0, 14.0, 0.5), gear(34, 0.20, 30.0, 40.0, 0.5)),
        (support(2.0e8, 2.6e8, 0.04, 0.03), support(3.3e8, 1.9e8, 0.06, 0.05)),
        {"damping_ratio": 0.09, "stiffness": {"model": "parabolic"}},
        {"law": "coulomb", "coefficient": 0.09},
        40.0,
        (1750.0, 160.0),
    ),
    pair_of(
        "old_mill",
        "32/48 from a 14.5-degree rack",
        rack(3.175, angle=14.5, dedendum=1.157),
        (gear(32, 0.0, 25.0, 25.0, 0.8), gear(48, 0.0, 25.0, 35.0, 0.8)),
        (support(1.4e8, 0.9e8, 0.05, 0.06), support(1.6e8, 1.1e8, 0.05, 0.04)),
        {"damping_ratio": 0.07, "stiffness": {"model": "parabolic"}},
        {"law": "benedict_kelley", "maximum": 0.12},
        45.0,
        (800.0, 140.0),
    ),
    pair_of(
        "bronze",
        "21/44, a steel pinion and a bronze gear",
        rack(2.0),
        (
            gear(21, 0.15, 20.0, 12.0, 0.4),
            gear(44, 0.10, 18.0, 30.0, 0.8, youngs_modulus=108.0, poisson_ratio=0.34, density=8800.0),
        ),
        (support(0.9e8, 0.7e8, 0.06, 0.05), support(1.1e8, 1.2e8, 0.05, 0.07)),
        {"damping_ratio": 0.06, "stiffness": {"model": "rectangular"}},
        {"law": "iso_14179"},
        60.0,
        (2200.0, 38.0),
    ),
    pair_of(
        "joint",
        "27/35 from a 22.5-degree rack, small module, soft bearings",
        rack(1.25, angle=22.5),
        (gear(27, 0.12, 10.0, 8.0, 0.3), gear(35, -0.05, 9.0, 10.0, 0.3)),
        (support(2.5e7, 1.8e7, 0.04, 0.05), support(3.2e7, 2.6e7, 0.05, 0.04)),
        {"damping_ratio": 0.05, "stiffness": {"model": "parabolic"}},
        {"law": "smoothed_coulomb", "coefficient": 0.07, "sharpness": 60.0},
        18.0,
        (5200.0, 9.0),
    ),
)

#: Parameter files by name.
SIXTH_PAIRS: Mapping[str, Pair] = {pair["name"]: pair for pair in _MADE}
