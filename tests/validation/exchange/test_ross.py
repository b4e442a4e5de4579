"""Does the comparison with a mesh of ROSS find what agrees and what does not?"""

from __future__ import annotations

import tomllib
from types import SimpleNamespace

import numpy as np
import pytest

import spurcheck

STEEL = SimpleNamespace(E=206e9, Poisson=0.3, rho=7850.0)
ANGLE = np.deg2rad(20)
#: The pair of ``mesh`` with the method of ROSS.
CHANGES = {
    "gears.bore": 20, "gears.youngs_modulus": 206, "gears.poisson_ratio": 0.3,
    "mesh.stiffness": {"model": "energy", "hertz": "linear"}, "mesh.contact": "prescribed",
    "mesh.relief": "ignored", "basic_rack.fillet_radius_coefficient": float(0.25 / (1 - np.sin(ANGLE))),
}  # fmt: skip


def gear(teeth: int) -> SimpleNamespace:
    """A gear as GearElementTVMS has it: m = rho pi (r^2 - r_i^2) b, I = m (r^2 + r_i^2)/2."""
    radius, inner = 0.001 * teeth, 0.01
    mass = 7850.0 * np.pi * (radius**2 - inner**2) * 0.02
    tooth = {"n_teeth": teeth, "module": 0.002, "width": 0.02, "bore_diameter": 2 * inner, "pr_angle": ANGLE}
    rack = {"addendum_coeff": 1.0, "tip_clearance_coeff": 0.25, "base_radius": radius * np.cos(ANGLE)}
    return SimpleNamespace(**tooth, **rack, material=STEEL, m=mass, Ip=mass * (radius**2 + inner**2) / 2)


def mesh(factor: float = 1.0, **changes: object) -> SimpleNamespace:
    """A mesh of 30/60 teeth whose stiffness is ours times a factor; contact ratio by its formula."""
    pair = spurcheck.new_pair("30/60", module=2, face_width=20, speed=1500, torque=50, changes=CHANGES)
    stiffness = spurcheck.mesh_stiffness(pair)["mesh_stiffness"].to_numpy() * factor
    path = sum(np.sqrt((r + 2) ** 2 - (r * np.cos(ANGLE)) ** 2) for r in (30, 60)) - 90 * np.sin(ANGLE)
    attributes = {
        "driving_gear": gear(30),
        "driven_gear": gear(60),
        "helix_angle": 0.0,
        "contact_ratio": path / (2 * np.pi * np.cos(ANGLE)),
        "stiffness_range": np.append(stiffness, stiffness[0]),
    }
    return SimpleNamespace(**attributes | changes)


def test_a_mesh_of_our_stiffness_agrees_in_all():
    found = spurcheck.compare_ross(mesh(), 1500, 50)
    assert found["agrees"].all(), found.to_dataframe()
    assert spurcheck.load_gear_pair(tomllib.loads(found.attrs["parameters"])).gear.teeth == 60


def test_what_differs_is_named():
    found = spurcheck.compare_ross(mesh(factor=0.8, contact_ratio=1.6), 1500, 50)
    wrong = found["quantity"].to_numpy()[~found["agrees"].to_numpy()]
    kinds = ["contact ratio", *["mesh stiffness"] * 3, "transmission error"]
    assert [str(name).split(",")[0] for name in wrong] == kinds
    assert found["difference"].sel(quantity="mesh stiffness, mean") == pytest.approx(-0.2, abs=1e-3)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [(mesh(helix_angle=0.2), "spur gears"), (SimpleNamespace(), "allowed ross.Mesh of two GearElementTVMS")],
)
def test_other_meshes_are_refused(wrong, message):
    with pytest.raises(spurcheck.ParameterError, match=message):
        spurcheck.compare_ross(wrong, 1500, 50)
