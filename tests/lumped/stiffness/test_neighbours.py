"""Does the load of a tooth move the next ones as the elasticity of the ring says?"""

import math

import numpy as np
import pytest

import lumped
from lumped.stiffness.foundation import coefficients, torsional_stiffness
from lumped.stiffness.neighbours import foot_compliance, foot_loads, neighbour_compliances


@pytest.mark.parametrize(("ratio", "half_angle"), [(2.0, 0.05), (4.0, 0.05), (4.0, 0.1), (6.0, 0.1)])
def test_a_foot_under_its_own_load_is_that_of_the_published_ring(ratio, half_angle):
    # The fit's P* and P* Q* are the motion across and along the centre line under even loads, the twist
    # included; measured 1.3 % and 5 %.
    own = foot_compliance(ratio, 0.3, half_angle, 0.0)
    _, _, across, along = coefficients(ratio, half_angle)
    twist = 1.0 / torsional_stiffness(1.0, 1.0 / ratio, 1.0, 0.3)
    assert own[0, 0] + twist == pytest.approx(across, rel=0.03)
    assert own[1, 1] == pytest.approx(across * along, rel=0.06)


def test_loads_and_motions_are_reciprocal_and_cost_work():
    here = foot_compliance(4.0, 0.3, 0.1, 0.0)
    for apart in (0.22, 0.5, 2.0):
        there = foot_compliance(4.0, 0.3, 0.1, apart)
        assert pytest.approx(foot_compliance(4.0, 0.3, 0.1, -apart), abs=1e-12) == there.T
        both = np.block([[here, there.T], [there, here]])
        assert np.linalg.eigvalsh(both).min() > 0.0


def test_the_foot_carries_what_the_tooth_does():
    # Force and moment about the centre: base radius times the unit load.
    t, ratio = 0.1, 1.02
    for angle in (0.1, 0.4):
        across, along, couple = foot_loads(np.array([angle]), ratio, t)[:, 0]
        assert math.hypot(across, along) == pytest.approx(1.0, rel=1e-14)
        assert across * math.sin(t) / t + couple == pytest.approx(-ratio, rel=1e-14)


def test_a_thin_layer_on_a_rigid_core_is_pressed_and_sheared():
    # A force spread evenly over the whole rim: half of it presses the layer, which cannot grow sideways, with
    # E/(1 - nu^2), half shears it with G.
    ratio, poisson = 1.005, 0.3
    thickness = 1.0 - 1.0 / ratio
    expected = 0.5 * thickness * ((1.0 - poisson**2) + 2.0 * (1.0 + poisson)) / (2.0 * math.pi)
    assert foot_compliance(ratio, poisson, math.pi, 0.0)[1, 1] == pytest.approx(expected, rel=0.01)


def test_exchanged_gears_move_each_other_alike():
    pair = lumped.load_gear_pair("nasa_28_28").with_(
        {"pinion.teeth": 23, "gear.teeth": 41, "centre_distance": None, "pinion.profile_shift": 0.2}
    )
    other = pair.with_(
        {"pinion.teeth": 41, "gear.teeth": 23, "pinion.profile_shift": 0.0, "gear.profile_shift": 0.2}
    )
    g = pair.geometry
    for apart, (one, mirrored) in enumerate(
        zip(neighbour_compliances(pair), neighbour_compliances(other), strict=True), 1
    ):
        xi = np.linspace(*one.interval, 7)[1:-1]
        assert one(xi) == pytest.approx(mirrored(g.L_XY - xi - apart * g.base_pitch), rel=1e-8)


def test_curves_that_hold_the_bodies_already_have_no_neighbours():
    pair = lumped.load_gear_pair("nasa_28_28")
    assert pair.mesh.stiffness.neighbours(pair) == ()
    scaled = pair.with_(mesh__stiffness={"model": "energy", "scale": "iso6336"})
    assert scaled.mesh.stiffness.neighbours(scaled) == ()
