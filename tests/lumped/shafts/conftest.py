"""Pairs on shafts shared by the tests."""

import math

import pytest

from lumped import bodies

GEARS = ("pinion", "gear")


@pytest.fixture(scope="session")
def on_short_shafts():
    """Function: the pair on short shafts that do what its springs do."""
    return _on_short_shafts


@pytest.fixture(scope="session")
def shafted(unequal, shaft_tables):
    """A pair on elastic shafts."""
    return unequal.with_(shafts=shaft_tables)


def _on_short_shafts(pair):
    """Short, light and stiff shafts, each in one bearing under its gear with its springs and dampers."""
    b = bodies(pair)
    changes = {"shafts": {"damping_ratio": 0}}
    shaft_mass = 10 * math.pi * 0.01**2 * 0.02  # of the shaft, which is taken off the gear
    for name in GEARS:
        mass = getattr(b, f"mass_{name}")
        inertia = getattr(b, f"inertia_{name}")
        changes |= {
            f"{name}.mass": mass - shaft_mass,
            f"{name}.inertia": inertia - 0.5 * shaft_mass * 0.01**2,
        }
        springs = getattr(pair.bearings, name)
        bearing = {"position": 10, "tilt_stiffness": 1e9}
        for d in ("loa", "oloa"):
            stiffness = getattr(springs, f"{d}_stiffness")
            ratio = getattr(springs, f"{d}_damping_ratio")
            bearing |= {f"{d}_stiffness": stiffness, f"{d}_damping": 2 * ratio * math.sqrt(stiffness * mass)}
        changes["shafts"][name] = {
            "segments": [{"length": 20, "diameter": 20}], "gear_position": 10, "bearings": [bearing],
            "youngs_modulus": 2000, "density": 10,
        }  # fmt: skip
    return pair.with_(changes)
