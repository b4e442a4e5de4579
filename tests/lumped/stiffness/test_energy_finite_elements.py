"""Do tooth, body and neighbours deflect as plane finite elements of the same gear say?"""

import math

import numpy as np
import pytest

import lumped
from lumped import load_gear_pair
from lumped.elasticity.ring import compliances
from lumped.elasticity.sector import sector, stations
from lumped.gear_geometry.tooth_profile import ToothProfile
from lumped.stiffness.energy import beam_compliance
from lumped.stiffness.finite_elements import elastic_teeth
from lumped.stiffness.foundation import BODY_RATIO, coefficients, foundation_compliance, torsional_stiffness
from lumped.stiffness.neighbours import foot_compliance, foot_loads, neighbour_compliances

NU = 0.3


def twist(profile, ratio):
    """Deflection by the twist of the ring between its clamp and the root circle."""
    return profile.base_radius**2 / torsional_stiffness(
        profile.root_radius, profile.root_radius / ratio, 1.0, NU
    )


@pytest.mark.parametrize(("teeth", "ratio"), [(28, 6.0), (75, 4.0)])
def test_tooth_and_body_deflect_as_in_finite_elements(teeth, ratio):
    # Both without the contact, from the flank down to the centre line, and without the twist of the body.
    changes = {"pinion.teeth": teeth, "gear.teeth": teeth, "centre_distance": None, "basic_rack.module": 1.0}
    pair = load_gear_pair("nasa_28_28").with_({**changes, "pinion.tip_relief": None, "gear.tip_relief": None})
    tooth, _ = elastic_teeth(pair, "stress", "untwisted", ratio)
    profile, e = tooth.wheel.tooth, tooth.material.youngs_modulus
    tip = math.sqrt(tooth.wheel.tip_radius**2 - profile.base_radius**2)
    length = np.linspace(profile.form_length, tip, 9)[1:-1]
    _, h, _, angle = profile.involute_points(length)
    depth = h / np.cos(angle) / profile.module
    at = tooth.flank.deflection(length / profile.module)
    reference = (at - 2.0 / math.pi * np.log(depth) - tooth.twist) / e
    beam = beam_compliance(profile, length, e, NU)
    radii = profile.base_radius, profile.root_radius
    body = foundation_compliance(*radii, profile.root_half_angle, angle, e, NU)
    total = beam.bending + beam.shear + beam.axial + body
    # A beam on a body is not the plane problem: up to 12 % too soft.
    found = total / reference
    assert np.all((found > 0.97) & (found < 1.12))
    # The rise towards the tip is mostly the tooth itself.
    assert total[-1] - total[0] == pytest.approx(reference[-1] - reference[0], rel=0.08)


def test_a_free_tooth_does_not_feel_the_bore_of_a_thick_rim():
    # Counted from the mean motion of the gear. A thin rim bends between its teeth, and the limit of
    # ``BODY_RATIO`` stands where that begins to show.
    profile = ToothProfile(28, 1.0, math.radians(20.0), 0.0, 1.25, 0.38)
    tip, lengths = 15.0, np.array([2.8, 4.8, 6.6])
    own = {}
    for h in (1.4, 1.6, BODY_RATIO.low, 3.0, 6.0, 20.0):
        bore = profile.root_radius / h
        mesh = sector(profile, tip, bore, stations(profile, tip, bore, 0.3))
        found = np.diag(compliances(mesh, NU, 28, lengths, 1, "free")[0])
        own[h] = found + 2.0 / math.pi * math.log(1.0 / 0.02)  # and a contact
    thick = own.pop(20.0)
    off = {h: np.abs(one / thick - 1.0).max() for h, one in own.items()}
    assert max(off[h] for h in (3.0, 6.0)) < 0.015
    assert off[BODY_RATIO.low] < 0.04
    assert off[1.6] > 0.05


@pytest.mark.parametrize(("teeth", "shift", "ratio"), [(16, 0.18, 4.0), (28, 0.0, 2.0), (75, 0.0, 4.0)])
def test_a_load_moves_the_next_teeth_as_in_finite_elements(teeth, shift, ratio):
    profile = ToothProfile(teeth, 1.0, math.radians(20.0), shift, 1.25, 0.38)
    tip, bore = teeth / 2 + 1 + shift, profile.root_radius / ratio
    tip_length = math.sqrt(tip**2 - profile.base_radius**2)
    base_pitch = math.pi * math.cos(math.radians(20.0))
    behind = np.linspace(max(profile.form_length, 0.3), tip_length - base_pitch - 0.1, 3)
    lengths = np.concatenate([behind, behind + base_pitch])
    mesh = sector(profile, tip, bore, stations(profile, tip, bore, 0.3))
    moved = np.diag(compliances(mesh, NU, teeth, lengths, 1, "clamped")[1, 3:, :3]) - twist(profile, ratio)
    own, other = (
        foot_loads(
            at / profile.base_radius - profile.base_half_angle,
            profile.base_radius / profile.root_radius,
            profile.root_half_angle,
        )
        for at in (behind, behind + base_pitch)
    )
    feet = foot_compliance(ratio, NU, profile.root_half_angle, 2.0 * math.pi / teeth)
    assert np.einsum("ik,ij,jk->k", other, feet, own) == pytest.approx(moved, rel=0.045)


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
