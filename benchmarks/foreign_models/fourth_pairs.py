"""Pairs of the fourth set: drawings of their own, none from a preset, a test or another set."""

from __future__ import annotations

from typing import Any

from benchmarks.foreign_models.third_pairs import Support, drawn, wheel

PHOSPHOR_BRONZE = {"youngs_modulus": 110.0, "poisson_ratio": 0.33, "density": 8900.0}
DUCTILE_IRON = {"youngs_modulus": 169.0, "poisson_ratio": 0.28, "density": 7100.0}

PAIRS: dict[str, dict[str, Any]] = {
    pair["name"]: pair
    for pair in (
        drawn(
            "pitch_6",
            {"module": 25.4 / 6.0, "pressure_angle": 20.0},
            wheel(22, 38.1, bore=30.0, roughness=0.4),
            wheel(35, 31.75, bore=45.0, roughness=0.6),
            (Support(3.1e8, 1.8e8, 0.04, 0.05), Support(4.3e8, 2.4e8, 0.05, 0.03)),
            {"damping_ratio": 0.06, "stiffness": {"model": "rectangular"}},
            {"law": "coulomb", "coefficient": 0.06},
            40.0,
        ),
        drawn(
            "rack_25_26_45",
            {"module": 3.0, "pressure_angle": 25.0},
            wheel(26, 27.0, shift=0.1, bore=25.0, roughness=0.3),
            wheel(45, 25.0, shift=0.04, bore=40.0, roughness=0.4),
            (Support(1.7e8, 2.6e8, 0.03, 0.05), Support(3.4e8, 1.5e8, 0.06, 0.04)),
            {"damping_ratio": 0.05, "stiffness": {"model": "parabolic"}},
            {"law": "xu_kahraman"},
            28.0,
        ),
        drawn(
            "rack_14_42_66",
            {"module": 2.5, "pressure_angle": 14.5, "dedendum_coefficient": 1.157},
            wheel(42, 24.0, bore=32.0, roughness=0.6),
            wheel(66, 22.0, bore=55.0, roughness=0.8),
            (Support(2.4e8, 1.1e8, 0.05, 0.04), Support(1.6e8, 3.2e8, 0.04, 0.06)),
            {"damping_ratio": 0.05, "stiffness": {"model": "rectangular"}},
            {"law": "iso_14179"},
            65.0,
        ),
        drawn(
            "up_58_23",
            {"module": 2.0, "pressure_angle": 20.0},
            wheel(58, 16.0, shift=-0.06, bore=36.0, roughness=0.3),
            wheel(23, 20.0, shift=0.31, bore=14.0, roughness=0.5),
            (Support(1.9e8, 1.2e8, 0.05, 0.03), Support(0.9e8, 1.4e8, 0.04, 0.06)),
            {"damping_ratio": 0.06, "stiffness": {"model": "energy"}},
            {"law": "benedict_kelley", "maximum": 0.22},
            35.0,
        ),
        drawn(
            "up_37_21",
            {"module": 4.0, "pressure_angle": 22.5},
            wheel(37, 30.0, shift=0.21, bore=50.0, roughness=0.5),
            wheel(21, 33.0, shift=0.34, bore=28.0, roughness=0.7),
            (Support(4.6e8, 2.7e8, 0.04, 0.06), Support(2.2e8, 3.5e8, 0.05, 0.04)),
            {"damping_ratio": 0.07, "stiffness": {"model": "parabolic", "end_ratio": 0.6}},
            {"law": "coulomb", "coefficient": 0.08},
            55.0,
        ),
        drawn(
            "high_ratio_41_59",
            {"module": 2.25, "addendum_coefficient": 1.32, "dedendum_coefficient": 1.62},
            wheel(41, 21.0, shift=0.08, bore=26.0, roughness=0.2),
            wheel(59, 19.0, shift=-0.04, bore=38.0, roughness=0.3),
            (Support(1.4e8, 0.9e8, 0.05, 0.04), Support(2.3e8, 1.6e8, 0.03, 0.06)),
            {"damping_ratio": 0.05, "stiffness": {"model": "energy"}},
            {"law": "smoothed_coulomb", "coefficient": 0.07, "sharpness": 16.0},
            16.0,
        ),
        drawn(
            "low_ratio_16_33",
            {"module": 5.0, "addendum_coefficient": 0.85},
            wheel(16, 45.0, shift=0.48, bore=25.0, roughness=0.6),
            wheel(33, 48.0, shift=0.42, bore=50.0, roughness=0.8),
            (Support(3.9e8, 5.5e8, 0.06, 0.05), Support(5.8e8, 3.0e8, 0.04, 0.05)),
            {"damping_ratio": 0.08, "stiffness": {"model": "rectangular"}},
            {"law": "coulomb", "coefficient": 0.07},
            75.0,
        ),
        drawn(
            "like_31_32",
            {"module": 3.5, "pressure_angle": 20.0},
            wheel(31, 28.0, shift=0.1, bore=34.0, roughness=0.4),
            wheel(32, 26.0, shift=0.08, bore=30.0, roughness=0.4),
            (Support(2.0e8, 3.1e8, 0.05, 0.04), Support(2.9e8, 1.3e8, 0.06, 0.03)),
            {"damping_ratio": 0.06, "stiffness": {"model": "energy", "hertz": "linear"}},
            {"law": "coulomb", "coefficient": 0.05},
            30.0,
        ),
        drawn(
            "fine_72_95",
            {"module": 1.5, "pressure_angle": 20.0},
            wheel(72, 13.0, shift=0.14, bore=40.0, roughness=0.25),
            wheel(95, 12.0, shift=-0.11, bore=60.0, roughness=0.35),
            (Support(0.8e8, 1.5e8, 0.04, 0.05), Support(1.2e8, 0.7e8, 0.05, 0.06)),
            {"damping_ratio": 0.05, "stiffness": {"model": "rectangular", "pair_stiffness": 1.9e8}},
            {"law": "xu_kahraman"},
            12.0,
        ),
        drawn(
            "long_short_14_49",
            {"module": 6.0, "pressure_angle": 20.0},
            wheel(14, 60.0, shift=0.46, bore=26.0, roughness=0.7),
            wheel(49, 56.0, shift=-0.31, bore=120.0, roughness=0.9, **DUCTILE_IRON),
            (Support(6.1e8, 3.6e8, 0.05, 0.04), Support(8.2e8, 5.2e8, 0.03, 0.06)),
            {"damping_ratio": 0.07, "stiffness": {"model": "parabolic"}},
            {"law": "iso_14179"},
            110.0,
        ),
        drawn(
            "light_27_29",
            {"module": 3.0, "pressure_angle": 20.0},
            wheel(27, 20.0, bore=22.0, roughness=0.3),
            wheel(29, 20.0, bore=26.0, roughness=0.3),
            (Support(3.3e8, 2.1e8, 0.03, 0.04), Support(2.5e8, 3.7e8, 0.03, 0.03)),
            {"damping_ratio": 0.02, "stiffness": {"model": "rectangular"}},
            {"law": "none"},
            20.0,
        ),
        drawn(
            "bronze_19_67",
            {"module": 2.0, "pressure_angle": 20.0},
            wheel(19, 20.0, shift=0.2, bore=12.0, roughness=0.3),
            wheel(67, 16.0, shift=0.05, bore=40.0, roughness=0.5, **PHOSPHOR_BRONZE),
            (Support(1.3e8, 0.7e8, 0.04, 0.05), Support(2.1e8, 1.0e8, 0.06, 0.04)),
            {"damping_ratio": 0.06, "stiffness": {"model": "parabolic", "end_ratio": 0.75}},
            {"law": "smoothed_coulomb", "coefficient": 0.09, "sharpness": 30.0},
            80.0,
        ),
        drawn(
            "plus_shifts_18_25",
            {"module": 3.25, "pressure_angle": 20.0},
            wheel(18, 30.0, shift=0.52, bore=20.0, roughness=0.4),
            wheel(25, 28.0, shift=0.61, bore=30.0, roughness=0.5),
            (Support(2.8e8, 1.7e8, 0.06, 0.04), Support(2.0e8, 2.9e8, 0.04, 0.05)),
            {"damping_ratio": 0.06, "stiffness": {"model": "rectangular"}},
            {"law": "benedict_kelley", "maximum": 0.2},
            45.0,
        ),
        drawn(
            "rack_17_30_50",
            {"module": 3.0, "pressure_angle": 17.5},
            wheel(30, 26.0, shift=0.15, bore=28.0, roughness=0.5),
            wheel(50, 23.0, shift=0.22, bore=48.0, roughness=0.6),
            (Support(2.7e8, 1.4e8, 0.04, 0.06), Support(1.8e8, 2.3e8, 0.05, 0.04)),
            {"damping_ratio": 0.05, "stiffness": {"model": "energy", "scale": "iso6336"}},
            {"law": "coulomb", "coefficient": 0.065},
            50.0,
        ),
    )
}


def at(name: str, speed: float, torque: float) -> dict[str, Any]:
    """Return a pair of ``PAIRS`` at an operating point [rpm, N m]."""
    return {**PAIRS[name], "operating": {"pinion_speed": speed, "pinion_torque": torque}}
