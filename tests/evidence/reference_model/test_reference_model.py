"""Does the multibody model's own evidence hold: its damping, its bodies, its modes?"""

import itertools

import numpy as np
import pytest

import lumped
import multibody
from lumped.friction.registry import LAWS
from multibody.contact import friction
from multibody.run.linear_motion import mesh_wrench
from multibody.run.setup import prepare
from tests.evidence.check import failing
from tests.evidence.reference_model.checks import (
    PAIR,
    blanks,
    frozen_modes,
    held,
    linearised,
    modes_of,
    reference_model,
)


def test_every_number_keeps_its_limit():
    checks = list(reference_model())
    assert [check.subject for check in failing(checks)] == []


def test_a_bore_takes_its_disc_out_of_the_outline():
    solid = blanks(PAIR)[0]
    bored = blanks(PAIR.with_(pinion__bore=40.0))[0]
    hole = PAIR.pinion.density * PAIR.pinion.face_width * np.pi * 0.02**2
    assert solid.mass - bored.mass == pytest.approx(hole, rel=1e-12)
    assert solid.inertia - bored.inertia == pytest.approx(0.5 * hole * 0.02**2, rel=1e-12)


def test_frozen_modes_are_the_lumped_ones_but_for_the_turned_line():
    result = frozen_modes(PAIR, phase=0.3)
    frozen, exact, turned = (result[name] for name in ("lumped frozen", "exudyn exact", "lumped turned line"))
    np.testing.assert_allclose(frozen[0, [0, -1]], [2237.677, 8691.553], atol=1e-3)
    assert exact[0, 1] - frozen[0, 1] == pytest.approx(turned[0, 1] - frozen[0, 1], rel=0.01)
    assert turned[0, 1] - frozen[0, 1] == pytest.approx(-1.27, abs=0.01)
    np.testing.assert_allclose(exact[0, [0, 2, 3, 4]], frozen[0, [0, 2, 3, 4]], rtol=1e-6)


def test_modes_on_shafts_are_those_of_the_matrices():
    """exudyn differentiates the assembled forces; here the mesh adds its incidence to the own matrices."""
    shaft = {
        "segments": [{"length": 100, "diameter": 30}, {"length": 60, "diameter": 25, "bore": 8}],
        "gear_position": 145,
        "bearings": [
            {"position": at, "loa_stiffness": 2e8, "oloa_stiffness": 1.6e8, "loa_damping": 300.0}
            for at in (20, 90)
        ],
    }
    motor = {"position": 0, "inertia": 0.004, "coupling_stiffness": 4e4, "coupling_damping": 0.2}
    shafts = {"damping_ratio": 0.02, "max_frequency": 12e3, "pinion": shaft, "gear": shaft, "motor": motor}
    setup = prepare(PAIR.with_(shafts=shafts), "linear", supports="shafts")
    m = setup.machine
    roots = linearised(held(setup, 0.3 * m.period), np.zeros(m.size))
    by_overlap, by_rate, _ = mesh_wrench(m, np.array([0.3 * m.period]), 0.0, m.period)
    stiffness = m.train.stiffness.copy()
    damping = m.train.damping.copy()
    stiffness[:6, :6] -= np.outer(by_overlap[0], m.overlap)
    damping[:6, :6] -= np.outer(by_rate[0], m.overlap)
    n = m.size
    inverse = np.linalg.inv(m.train.mass)
    expected = np.linalg.eigvals(
        np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ stiffness, -inverse @ damping]])
    )
    expected = modes_of(expected[np.argsort(np.abs(expected))[2:]])
    np.testing.assert_allclose(modes_of(roots)[0], expected[0], rtol=1e-6)
    np.testing.assert_allclose(modes_of(roots)[1], expected[1], atol=1e-5)


@pytest.mark.parametrize("quantity", ["dte", "y_p"])
def test_the_motion_converges_as_the_sign_change_of_friction_sharpens(quantity):
    """79.1 N m, 800 rpm: each halving of the velocity moves the motion by less, at about first order."""
    pair = lumped.load_gear_pair("nasa_28_28").with_(
        {"operating.pinion_torque": 79.1, "operating.pinion_speed": 800},
        friction__law="coulomb",
        friction__coefficient=0.05,
    )
    velocities = 8e-3 / 2.0 ** np.arange(5)  # the default is smaller still
    runs = [multibody.simulate(pair, 2, friction_velocity=v)[quantity].to_numpy() for v in velocities]
    steps = np.array([np.abs(a - b).max() for a, b in itertools.pairwise(runs)]) / np.ptp(runs[-1])
    orders = np.log2(steps[:-1] / steps[1:])
    assert np.all(orders > 0.26), steps  # a factor of 1.2 per halving
    # What is left below 0.5 mm/s: a geometric series with the last ratio.
    assert steps[-1] / (2.0 ** orders[-1] - 1) < 0.02


def test_every_law_is_written_twice():
    assert set(LAWS) == set(friction.LAWS)
