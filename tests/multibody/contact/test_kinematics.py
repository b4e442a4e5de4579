"""Are the contact kinematics those of two rigid involute gears? Gradients, invariances, drawn flanks."""

import math

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from multibody.contact import kinematics as kin
from multibody.contact.records import MAX_PAIRS, PHI_G, PHI_P

FLANKS = [kin.DRIVE, kin.COAST]


def random_pose(teeth, rng, flank):
    """Centres displaced by up to 0.2 mm, flanks pressed by some micrometres."""
    direction = rng.uniform(-math.pi, math.pi)
    a = teeth.centre_distance + rng.uniform(-2e-5, 2e-4)
    pose = np.array([*rng.uniform(-1, 1, 2), rng.uniform(-20, 20), 0, 0, rng.uniform(-20, 20)])
    pose[3:5] = pose[:2] + a * np.array([math.cos(direction), math.sin(direction)])
    delta = overlap(teeth, pose, flank)
    pose[PHI_G] += flank * (delta - rng.uniform(1e-6, 5e-5)) / teeth.radius_g
    return pose


def line_of_action(teeth, pose, flank):
    base_sum = teeth.radius_p + teeth.radius_g
    along, across = pose[3:5] - pose[:2]
    return kin.line_of_action(along, across - base_sum, 0.0, base_sum, flank)


def line_of(teeth, pose, flank):
    ex, ey, length, _ = line_of_action(teeth, pose, flank)
    return kin.Line(ex, ey, length, flank, teeth.radius_p, teeth.radius_g)


def phase(teeth, pose, flank):
    """Line of action, place of the first pinion flank on it, overlap."""
    line = line_of_action(teeth, pose, flank)
    _, _, grown, psi = line
    radii = (teeth.radius_p, teeth.radius_g)
    chi_p, chi_g = teeth.chi[flank]
    apart = -flank * (radii[0] * chi_p + radii[1] * (chi_g - math.pi))
    side = kin.Side(flank, *radii, teeth.pitch, chi_p, apart)
    turn = kin.Turn(psi=psi, grown=grown, phi_p=pose[PHI_P], phi_g=pose[PHI_G], rolled=0.0)
    return line, *kin.mesh_phase(side, turn)


def overlap(teeth, pose, flank):
    _, _, delta = phase(teeth, pose, flank)
    return delta


def contact(teeth, pose, flank):
    """(line, arms of every pair, overlap) in one pose."""
    line, rho, delta = phase(teeth, pose, flank)
    _, _, grown, _ = line
    arms = np.zeros((MAX_PAIRS, 2))
    count = kin.pairs_in_contact(rho, delta, grown, teeth.pitch, (0.0, teeth.tip_p), (0.0, teeth.tip_g), arms)
    return line, arms[:count] - 0.5 * delta, delta


def wrench(teeth, pose, flank, normal, friction, pair=0):
    arms = contact(teeth, pose, flank)[1]
    result = np.zeros(6)
    kin.add_wrench(result, line_of(teeth, pose, flank), normal, friction, *arms[pair])
    return result


def contact_point(teeth, pose, flank, pair=0):
    line, arms, _ = contact(teeth, pose, flank)
    e = np.array(line[:2])
    n = flank * np.array([-e[1], e[0]])
    return pose[:2] + teeth.radius_p * n + arms[pair, 0] * e, e, n


@pytest.mark.parametrize("flank", FLANKS)
def test_whole_machine_may_turn_and_shift(teeth, rng, flank):
    for _ in range(10):
        pose = random_pose(teeth, rng, flank)
        beta = rng.uniform(-3, 3)
        shift = rng.uniform(-1, 1, 2)
        turn = np.array([[math.cos(beta), -math.sin(beta)], [math.sin(beta), math.cos(beta)]])
        shifted = pose.copy()
        shifted[:2] = turn @ pose[:2] + shift
        shifted[3:5] = turn @ pose[3:5] + shift
        shifted[[2, 5]] += beta
        w = wrench(teeth, pose, flank, 100.0, 5.0)
        w_moved = wrench(teeth, shifted, flank, 100.0, 5.0)
        # Angles of 20 rad carry rounding of 4e-15 rad, some 1e-16 m.
        assert overlap(teeth, shifted, flank) == pytest.approx(overlap(teeth, pose, flank), abs=2e-15)
        np.testing.assert_allclose(turn @ w[:2], w_moved[:2], atol=1e-11)
        np.testing.assert_allclose(w[[2, 5]], w_moved[[2, 5]], atol=1e-11)


def test_mirror_image_works_on_the_other_flank(teeth, rng):
    """Reflecting the whole machine in the x axis turns drive flanks into coast flanks."""
    from dataclasses import replace

    mirrored = replace(teeth, chi={kin.COAST: tuple(-c for c in teeth.chi[kin.DRIVE])})
    sign = np.array([1, -1, -1, 1, -1, -1.0])
    for _ in range(10):
        pose = random_pose(teeth, rng, kin.DRIVE)
        w = wrench(teeth, pose, kin.DRIVE, 100.0, 5.0)
        np.testing.assert_allclose(wrench(mirrored, sign * pose, kin.COAST, 100.0, 5.0), sign * w, atol=1e-11)


def involute_flank(centre, body_angle, radius, chi, flank, rho):
    """Points of a drawn flank: a string of length rho, tangent to the base circle where it was unwound."""
    # String direction psi' = phi + chi + flank rho/r; the tangent point is at flank*90 deg from it.
    direction = body_angle + chi + flank * rho / radius
    e = np.array([np.cos(direction), np.sin(direction)])
    n = flank * np.array([-e[1], e[0]])
    return centre[:, None] + radius * n + rho * e


@pytest.mark.parametrize("flank", FLANKS)
def test_drawn_flanks_touch_where_the_formulas_say(teeth, rng, flank):
    """With zero overlap, the two drawn involutes have exactly one common point, the contact point."""
    for _ in range(3):
        pose = random_pose(teeth, rng, flank)
        pose[PHI_G] += flank * overlap(teeth, pose, flank) / teeth.radius_g
        point, _, _ = contact_point(teeth, pose, flank)
        _, arms, delta = contact(teeth, pose, flank)
        assert abs(delta) < 1e-15

        def drawn(rho, teeth=teeth, pose=pose, arms=arms):
            # The pinion flank in contact is the one whose string is arms[0, 0] long on the line of action.
            _, _, _, psi = line_of_action(teeth, pose, flank)
            chi = psi - pose[PHI_P] - flank * arms[0, 0] / teeth.radius_p
            return involute_flank(pose[:2], pose[PHI_P], teeth.radius_p, chi, flank, np.atleast_1d(rho))

        def gap(rho, pose=pose):
            # Distance of a pinion flank point from the gear flank, measured as string length on the gear
            # side: a point at distance d from the gear's centre unwinds sqrt(d^2 - r^2) from the base circle.
            q = drawn(rho)[:, 0] - pose[3:5]
            length = math.sqrt(q @ q - teeth.radius_g**2)
            direction = math.atan2(q[1], q[0]) + flank * (-math.pi / 2 + math.atan2(length, teeth.radius_g))
            unwound = flank * teeth.radius_g * (direction - pose[PHI_G] - teeth.chi[flank][1])
            return kin.wrap(length - unwound, teeth.pitch)

        low = max(1e-4, arms[0, 0] - 2e-3)
        high = arms[0, 0] + 2e-3
        best = minimize_scalar(gap, bounds=(low, high), method="bounded", options={"xatol": 1e-9})
        assert best.fun == pytest.approx(0.0, abs=1e-13)
        # The gap is quadratic about the contact, so its minimiser is known to the root of the rounding.
        np.testing.assert_allclose(drawn(best.x)[:, 0], point, atol=5e-7)


def test_overlapping_base_circles_give_nan():
    _, _, grown, _ = kin.line_of_action(0.08, -0.0835, 0.0, 0.0835, kin.DRIVE)
    assert math.isnan(grown)
