"""Gear pairs as bare numbers for the kinematics tests, made without lumped."""

import math
from dataclasses import dataclass

import numpy as np
import pytest


@dataclass(frozen=True)
class Teeth:
    """Two involute gears: base radii, pitch, tip tangent lengths, flank angles, centre distance (SI)."""

    radius_p: float
    radius_g: float
    pitch: float
    tip_p: float
    tip_g: float
    chi: dict[float, tuple[float, float]]
    centre_distance: float
    backlash: float


def make_teeth(zp, zg, module, alpha_deg, centre_distance, tip_p, tip_g, shifts=(0.0, 0.0), thinning=1e-4):
    """Flank 0 of both gears starts at body angle 0 (chi = 0 on the drive side)."""
    alpha = math.radians(alpha_deg)
    rp = 0.5 * module * zp * math.cos(alpha)
    rg = 0.5 * module * zg * math.cos(alpha)
    inv = math.tan(alpha) - alpha
    thick = [
        module * math.cos(alpha) * (math.pi / 2 + 2 * x * math.tan(alpha)) + 2 * r * inv - thinning / 2
        for x, r in zip(shifts, (rp, rg), strict=True)
    ]
    back = (math.pi + thick[0] / rp, math.pi + thick[1] / rg)
    return Teeth(
        radius_p=rp, radius_g=rg, pitch=math.pi * module * math.cos(alpha), tip_p=math.sqrt(tip_p**2 - rp**2),
        tip_g=math.sqrt(tip_g**2 - rg**2), chi={1.0: (0.0, 0.0), -1.0: back}, centre_distance=centre_distance,
        backlash=thinning,
    )  # fmt: skip


PAIRS = {
    "28/28": make_teeth(28, 28, 3.175e-3, 20, 88.9e-3, 47.625e-3, 47.625e-3),
    "16/24 shifted": make_teeth(
        16, 24, 4.5e-3, 20, 91.5e-3, 41.318e-3, 59.272e-3, shifts=(0.1817, 0.1715), thinning=0.0
    ),
    "25/31 apart": make_teeth(25, 31, 3.175e-3, 25, 89.4e-3, 42.9e-3, 52.4e-3),
    "high contact ratio": make_teeth(60, 60, 2e-3, 14.5, 120e-3, 63.2e-3, 63.2e-3),
}


@pytest.fixture(params=PAIRS, ids=list(PAIRS))
def teeth(request) -> Teeth:
    return PAIRS[request.param]


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(20240607)
