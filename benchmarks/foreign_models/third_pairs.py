"""Pairs of the third set: drawings of their own, none from a preset."""

from __future__ import annotations

from typing import Any, NamedTuple

STEEL = {"youngs_modulus": 206.0, "poisson_ratio": 0.3, "density": 7850.0}
GREY_IRON = {"youngs_modulus": 112.0, "poisson_ratio": 0.26, "density": 7200.0}
BRONZE = {"youngs_modulus": 115.0, "poisson_ratio": 0.34, "density": 8800.0}


class Support(NamedTuple):
    """Bearing of a gear along and off the line of action: stiffness [N/m], damping ratios."""

    loa_stiffness: float
    oloa_stiffness: float
    loa_damping_ratio: float
    oloa_damping_ratio: float


def wheel(
    teeth: int, width: float, shift: float = 0.0, bore: float = 0.0, roughness: float = 0.4, **others: Any
) -> dict[str, Any]:
    """Gear of a parameter file: lengths in mm, roughness Ra in um; steel unless others say more."""
    numbers = {"teeth": teeth, "profile_shift": shift, "face_width": width, "roughness": roughness}
    return numbers | ({"bore": bore} if bore else {}) | STEEL | others


def drawn(
    name: str,
    rack: dict[str, float],
    pinion: dict[str, Any],
    gear: dict[str, Any],
    supports: tuple[Support, Support],
    mesh: dict[str, Any],
    friction: dict[str, Any],
    viscosity: float,
    **others: Any,
) -> dict[str, Any]:
    """Parameter file as a mapping, with prescribed contact; viscosity in mPa s."""
    return {
        "format": 2,
        "name": name,
        "description": f"{pinion['teeth']}/{gear['teeth']} as a user modelled it",
        "basic_rack": {"dedendum_coefficient": 1.25, "fillet_radius_coefficient": 0.25} | rack,
        "pinion": pinion,
        "gear": gear,
        "bearings": {"pinion": supports[0]._asdict(), "gear": supports[1]._asdict()},
        "mesh": {"backlash": 0.1, "contact": "prescribed", "relief": "ignored"} | mesh,
        "lubricant": {
            "viscosity": viscosity,
            "pressure_viscosity_k": 0.010471,
            "pressure_viscosity_s": 0.1348,
        },
        "friction": friction,
        "operating": {"pinion_speed": 1500.0, "pinion_torque": 100.0},
        **others,
    }


PAIRS: dict[str, dict[str, Any]] = {
    pair["name"]: pair
    for pair in (
        drawn(
            "pitch_8",
            {"module": 3.175, "pressure_angle": 20.0},
            wheel(24, 25.4, bore=22.0, roughness=0.3),
            wheel(40, 22.0, bore=35.0, roughness=0.5),
            (Support(2.1e8, 1.3e8, 0.04, 0.05), Support(3.0e8, 1.7e8, 0.03, 0.06)),
            {"damping_ratio": 0.05, "stiffness": {"model": "rectangular"}},
            {"law": "coulomb", "coefficient": 0.055},
            25.0,
        ),
        drawn(
            "old_rack",
            {"module": 4.0, "pressure_angle": 14.5, "dedendum_coefficient": 1.157},
            wheel(34, 36.0, bore=40.0, roughness=0.5),
            wheel(57, 40.0, bore=60.0, roughness=0.7),
            (Support(3.6e8, 2.2e8, 0.05, 0.04), Support(2.4e8, 4.1e8, 0.06, 0.05)),
            {"damping_ratio": 0.06, "stiffness": {"model": "parabolic"}},
            {"law": "xu_kahraman"},
            18.0,
        ),
        drawn(
            "speed_up_51_19",
            {"module": 2.5, "pressure_angle": 20.0},
            wheel(51, 18.0, shift=0.12, bore=30.0, roughness=0.4),
            wheel(19, 21.0, shift=0.38, bore=16.0, roughness=0.6),
            (Support(2.2e8, 1.4e8, 0.04, 0.03), Support(1.1e8, 1.6e8, 0.05, 0.04)),
            {"damping_ratio": 0.05, "stiffness": {"model": "parabolic"}},
            {"law": "benedict_kelley", "maximum": 0.25},
            30.0,
        ),
        drawn(
            "iron_gear",
            {"module": 5.0, "pressure_angle": 20.0},
            wheel(21, 50.0, shift=0.28, bore=35.0, roughness=0.6),
            wheel(64, 46.0, shift=-0.14, bore=180.0, roughness=0.9, **GREY_IRON),
            (Support(5.2e8, 3.3e8, 0.04, 0.05), Support(7.4e8, 4.6e8, 0.05, 0.03)),
            {"damping_ratio": 0.06, "stiffness": {"model": "rectangular"}},
            {"law": "iso_14179"},
            90.0,
        ),
        drawn(
            "long_teeth",
            {"module": 2.0, "addendum_coefficient": 1.3, "dedendum_coefficient": 1.6},
            wheel(37, 20.0, shift=0.05, bore=24.0, roughness=0.2),
            wheel(53, 18.0, shift=-0.1, bore=30.0, roughness=0.3),
            (Support(1.5e8, 0.8e8, 0.06, 0.04), Support(2.0e8, 1.2e8, 0.05, 0.07)),
            {"damping_ratio": 0.05, "stiffness": {"model": "energy"}},
            {"law": "smoothed_coulomb", "coefficient": 0.06, "sharpness": 20.0},
            12.0,
        ),
        drawn(
            "short_path",
            {"module": 6.0, "addendum_coefficient": 0.9},
            wheel(15, 55.0, shift=0.55, bore=28.0, roughness=0.5),
            wheel(41, 60.0, shift=0.52, bore=70.0, roughness=0.8),
            (Support(4.8e8, 3.1e8, 0.05, 0.06), Support(6.6e8, 5.1e8, 0.04, 0.05)),
            {"damping_ratio": 0.07, "stiffness": {"model": "parabolic"}},
            {"law": "coulomb", "coefficient": 0.07},
            45.0,
        ),
        drawn(
            "speed_up_44_27",
            {"module": 3.0, "pressure_angle": 25.0},
            wheel(44, 26.0, shift=-0.1, bore=45.0, roughness=0.25),
            wheel(27, 24.0, shift=0.22, bore=25.0, roughness=0.35),
            (Support(2.9e8, 1.9e8, 0.05, 0.04), Support(1.8e8, 2.6e8, 0.03, 0.05)),
            {"damping_ratio": 0.05, "stiffness": {"model": "energy"}},
            {"law": "xu_kahraman"},
            22.0,
        ),
        drawn(
            "rack_22",
            {"module": 4.5, "pressure_angle": 22.5},
            wheel(18, 34.0, shift=0.2, bore=26.0, roughness=0.4),
            wheel(29, 30.0, shift=0.11, bore=38.0, roughness=0.6),
            (Support(2.7e8, 4.4e8, 0.06, 0.05), Support(4.9e8, 3.0e8, 0.04, 0.06)),
            {"damping_ratio": 0.08, "stiffness": {"model": "rectangular", "pair_stiffness": 3.7e8}},
            {"law": "benedict_kelley", "maximum": 0.2},
            50.0,
        ),
        drawn(
            "light_damping",
            {"module": 2.5, "pressure_angle": 20.0},
            wheel(33, 16.0, bore=20.0, roughness=0.3, tip_diameter=87.5),
            wheel(39, 16.0, bore=25.0, roughness=0.3, tip_diameter=102.5),
            (Support(2.6e8, 1.5e8, 0.03, 0.03), Support(1.9e8, 2.8e8, 0.03, 0.04)),
            {"damping_ratio": 0.018, "stiffness": {"model": "rectangular"}},
            {"law": "none"},
            15.0,
            centre_distance=90.22,
        ),
        drawn(
            "negative_shifts",
            {"module": 1.75, "pressure_angle": 20.0},
            wheel(40, 15.0, shift=-0.3, bore=18.0, roughness=0.3),
            wheel(63, 14.0, shift=-0.22, bore=30.0, roughness=0.4),
            (Support(0.9e8, 0.5e8, 0.05, 0.06), Support(1.3e8, 0.7e8, 0.04, 0.03)),
            {"damping_ratio": 0.05, "stiffness": {"model": "parabolic", "end_ratio": 0.68}},
            {"law": "xu_kahraman"},
            14.0,
        ),
        drawn(
            "fine_teeth",
            {"module": 1.25, "pressure_angle": 20.0},
            wheel(61, 12.0, shift=0.1, bore=30.0, roughness=0.2),
            wheel(83, 11.0, shift=0.06, bore=40.0, roughness=0.3),
            (Support(0.7e8, 1.2e8, 0.04, 0.05), Support(1.1e8, 0.6e8, 0.06, 0.04)),
            {"damping_ratio": 0.05, "stiffness": {"model": "energy"}},
            {"law": "coulomb", "coefficient": 0.05},
            10.0,
        ),
        drawn(
            "bronze_wheel",
            {"module": 3.5, "pressure_angle": 25.0, "addendum_coefficient": 0.95},
            wheel(23, 28.0, shift=0.15, bore=24.0, roughness=0.3),
            wheel(70, 24.0, shift=-0.05, bore=50.0, roughness=0.6, **BRONZE),
            (Support(2.3e8, 2.9e8, 0.04, 0.05), Support(3.8e8, 2.0e8, 0.06, 0.04)),
            {"damping_ratio": 0.06, "stiffness": {"model": "parabolic"}},
            {"law": "smoothed_coulomb", "coefficient": 0.08, "sharpness": 12.0},
            60.0,
        ),
    )
}


def at(name: str, speed: float, torque: float) -> dict[str, Any]:
    """Return a pair of ``PAIRS`` at an operating point [rpm, N m]."""
    return {**PAIRS[name], "operating": {"pinion_speed": speed, "pinion_torque": torque}}
