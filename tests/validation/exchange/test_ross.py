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
    radius = 0.001 * teeth
    inner = 0.01
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


def wrong(found) -> list[str]:
    return found["quantity"].where(~found["agrees"], drop=True).values.tolist()


def test_what_differs_is_named():
    found = spurcheck.compare_ross(mesh(factor=0.8, contact_ratio=1.6), 1500, 50)
    stiffness = [f"mesh stiffness, {which}" for which in ("mean", "largest", "smallest")]
    assert wrong(found) == ["contact ratio", *stiffness, "transmission error, peak to peak"]
    assert found["difference"].sel(quantity="mesh stiffness, mean") == pytest.approx(-0.2, abs=1e-3)
    backwards = mesh(stiffness_range=mesh().stiffness_range[::-1])
    # Friction does not run backwards with the stiffness, so the transmission error differs, too.
    named = wrong(spurcheck.compare_ross(backwards, 1500, 50))
    assert named == [f"mesh stiffness, {STEP}", "transmission error, peak to peak"]


STEP = "variation in step, over the mean"
SPRING = 2e8


@pytest.mark.parametrize(("change", "differs"), [
    (lambda M, K: (M, K), []),
    (lambda M, K: (M, K[::-1]), [f"sum of squared frequencies, {STEP}"]),
    (lambda M, K: (M[:4, :4], K[:, :4, :4]), ["number of natural frequencies"]),
    (lambda M, K: (M * np.array([1.2, 1, 1, 1, 1, 1]), K), ["natural frequency 5"]),
])  # fmt: skip
def test_matrices_are_compared_in_any_coordinates(change, differs):
    """M and K of the six displacements by hand: K(t) = k(t) v v^T and the bearings."""
    pair = spurcheck.new_pair("30/60", 2, 20, 1500, 50, CHANGES, bearings__stiffness=SPRING)
    g = pair.geometry
    bodies = spurcheck.bodies(pair)
    cycle = spurcheck.lumped.mesh_cycle(pair)
    k = cycle.sample(np.arange(200) * (cycle.period / 200)).stiffness.sum(axis=0)
    v = np.array([g.base_radius_pinion, -g.base_radius_gear, 1.0, -1.0, 0.0, 0.0])
    masses = [bodies.mass_pinion, bodies.mass_gear]
    M = np.diag([bodies.inertia_pinion, bodies.inertia_gear, *masses, *masses])
    K = k[:, None, None] * np.outer(v, v) + np.diag([0.0, 0.0, *[SPRING] * 4])
    M, K = change(M, K)
    T = np.random.default_rng(1).normal(size=M.shape)
    found = wrong(spurcheck.compare_matrices(pair, T.T @ M @ T, T.T @ K @ T))
    assert found[:1] == differs


@pytest.mark.parametrize(
    ("wrong", "message"),
    [(mesh(helix_angle=0.2), "spur gears"), (SimpleNamespace(), "allowed ross.Mesh of two GearElementTVMS")],
)
def test_other_meshes_are_refused(wrong, message):
    with pytest.raises(spurcheck.ParameterError, match=message):
        spurcheck.compare_ross(wrong, 1500, 50)
    with pytest.raises(spurcheck.ParameterError, match="regular"):
        spurcheck.compare_matrices("nasa_28_28", np.ones((2, 2)), np.eye(2))
