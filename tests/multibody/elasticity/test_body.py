"""Is the ring of Ritz's method the elastic ring, and does it stand on its own?"""

import math
from pathlib import Path

import numpy as np
import pytest

from lumped.stiffness.neighbours import foot_compliance
from multibody.elasticity import body, pair, standard, table, tooth
from multibody.elasticity.body import Body, foot_forces, foot_motions, published_deflection, ring_twist


@pytest.mark.parametrize("poisson", [0.22, 0.3])
@pytest.mark.parametrize(("half_angle", "teeth"), [(0.03, 60), (0.06, 28), (0.13, 13)])
def test_a_foot_moves_as_the_closed_solutions_of_a_ring_say(poisson, half_angle, teeth):
    for pitches in (1, 2):
        apart = 2.0 * math.pi * pitches / teeth
        ring = foot_motions(Body("untwisted", 4.0, poisson), half_angle, apart)
        closed = foot_compliance(4.0, poisson, half_angle, apart)
        assert ring == pytest.approx(closed, abs=1e-3 * np.abs(closed).max())


@pytest.mark.parametrize("ratio", [1.5, 4.0, 12.0])
def test_an_even_shear_stress_twists_the_ring_as_lame_says(ratio):
    clamped, untwisted = (
        foot_motions(Body(support, ratio, 0.3), 0.06, 0.0) for support in ("clamped", "untwisted")
    )
    load = foot_forces(np.array([0.35]), 1.05, 0.06)[:, 0]
    assert load @ (clamped - untwisted) @ load == pytest.approx(ring_twist(ratio, 0.3, 1.05), rel=1e-6)


def test_a_free_ring_does_not_feel_a_small_bore_and_moves_less_than_a_clamped_one():
    load = foot_forces(np.array([0.35]), 1.05, 0.06)[:, 0]
    free = [load @ foot_motions(Body("free", ratio, 0.3), 0.06, 0.0) @ load for ratio in (20.0, 40.0)]
    assert free[0] == pytest.approx(free[1], rel=1e-3)
    assert free[1] < load @ foot_motions(Body("untwisted", 4.0, 0.3), 0.06, 0.0) @ load


def test_the_published_polynomials_are_near_the_ring():
    """They are a fit of this ring under these loads."""
    angle = np.array([0.2, 0.35, 0.5])
    forces = foot_forces(angle, 1.05, 0.06)
    motions = foot_motions(Body("clamped", 4.0, 0.3), 0.06, 0.0)
    ring = np.einsum("ik,ij,jk->k", forces, motions, forces)
    assert published_deflection(0.06, 4.0, 1.05 / np.cos(angle) - 1.0, angle) == pytest.approx(ring, rel=0.1)


def test_the_second_values_import_nothing_of_the_first():
    for module in (body, pair, standard, table, tooth):
        text = Path(module.__file__).read_text(encoding="utf-8")
        for name in ("lumped.stiffness", "lumped.elasticity", "lumped.gear_geometry", "path_of_contact"):
            assert f"from {name}" not in text
            assert f"import {name}" not in text
