"""Does a plane finite-element model of the same tooth and body deflect as the energy method says?

A discretisation of one tooth with its true fillets on a ring that shares nothing with ``lumped.elasticity``:
the flank is loaded at a node along the line of action; the deflection is read on the tooth's centre line,
where the singular dent under the load has died out (the energy method treats the contact apart). The ring is
clamped at its bore. Free gears and neighbours are those of ``lumped.elasticity``, which has its own tests.
"""

import math

import numpy as np
import pytest
from scipy import sparse
from scipy.optimize import brentq
from scipy.sparse.linalg import splu

from lumped.elasticity.ring import compliances
from lumped.elasticity.sector import sector, stations
from lumped.gear_geometry.tooth_profile import ToothProfile
from lumped.stiffness.energy import beam_compliance
from lumped.stiffness.foundation import BODY_RATIO, foundation_compliance, torsional_stiffness
from lumped.stiffness.neighbours import foot_compliance, foot_loads

NU = 0.3
ACROSS, FILLET, FLANK, AROUND, DEEP = 8, 10, 16, 24, 12  # elements


def element_matrices(corners):
    """Stiffness (n, 18, 18) of nine-node elements with nodes (n, 9, 2); E = 1."""
    law = np.array([[1, NU, 0], [NU, 1, 0], [0, 0, (1 - NU) / 2]]) / (1 - NU**2)
    points, weights = np.polynomial.legendre.leggauss(3)
    total = np.zeros((len(corners), 18, 18))
    for x, wx in zip(points, weights, strict=True):
        for y, wy in zip(points, weights, strict=True):
            (a, da), (b, db) = (
                (
                    np.array([s * (s - 1) / 2, 1 - s * s, s * (s + 1) / 2]),
                    np.array([s - 0.5, -2 * s, s + 0.5]),
                )
                for s in (x, y)
            )
            local = np.stack([np.outer(da, b).ravel(), np.outer(a, db).ravel()])
            jacobian = np.einsum("dk,ekc->edc", local, corners)
            determinant = np.linalg.det(jacobian)
            assert determinant.min() > 0.0
            gradient = np.linalg.solve(jacobian, np.broadcast_to(local, (len(corners), 2, 9)))
            strain = np.zeros((len(corners), 3, 18))
            strain[:, 0, 0::2] = strain[:, 2, 1::2] = gradient[:, 0]
            strain[:, 1, 1::2] = strain[:, 2, 0::2] = gradient[:, 1]
            density = np.einsum("eai,ab,ebj->eij", strain, law, strain)
            total += wx * wy * determinant[:, None, None] * density
    return total


def with_midpoints(ends):
    full = np.empty(2 * len(ends) - 1)
    full[::2], full[1::2] = ends, (ends[1:] + ends[:-1]) / 2
    return full


def graded(length, first, count):
    """Ends of ``count`` elements over a length, growing geometrically from ``first``."""

    def excess(q):
        return first * sum(q**i for i in range(count)) - length

    ratio = brentq(excess, 0.3, 3.0)
    return np.concatenate([[0.0], np.cumsum(first * ratio ** np.arange(count))])


def grids(profile, tip_length, bore):
    """Node grids of the tooth (along, across) and of the ring (radius, angle), joined on the root circle."""
    root, theta = profile.root_radius, profile.root_half_angle
    u_1, h_1, _ = profile.fillet_points(np.linspace(*profile.fillet_range, 2 * FILLET + 1))
    u_2, h_2, *_ = profile.involute_points(np.linspace(profile.form_length, tip_length, 2 * FLANK + 1))
    u, h = np.concatenate([u_1, u_2[1:]]), np.concatenate([h_1, h_2[1:]])
    eta, s = np.linspace(-1, 1, 2 * ACROSS + 1), np.linspace(0, 1, u.size)[:, None]
    tip, top = math.hypot(u[-1], h[-1]), math.atan2(h[-1], u[-1])
    arc_root = root * (np.cos(eta * theta) - math.cos(theta))
    arc_tip = tip * (np.cos(eta * top) - math.cos(top))
    x, y = u[:, None] + (1 - s) ** 2 * arc_root + s**2 * arc_tip, h[:, None] * eta
    x[0], y[0] = root * np.cos(eta * theta), root * np.sin(eta * theta)
    half = with_midpoints(graded(math.pi - theta, theta / ACROSS, AROUND))
    angle = np.concatenate([eta * theta, theta + half[1:], 2 * math.pi - theta - half[-2::-1]])
    depth = with_midpoints(graded(root - bore, root * theta / ACROSS, DEEP))
    radius = (root - depth)[::-1, None]
    ring_x, ring_y = radius * np.cos(angle), radius * np.sin(angle)
    ring_x[:, -1], ring_y[:, -1] = ring_x[:, 0], ring_y[:, 0]
    return (x, y), (ring_x, ring_y)


class PlaneGear:
    """Plane-stress gear with E = 1, unit thickness and one of its teeth, clamped at its bore."""

    def __init__(self, profile, tip_length, bore):
        self.profile = profile
        self.lengths = np.linspace(profile.form_length, tip_length, 2 * FLANK + 1)
        grid = grids(profile, tip_length, bore)
        known, nodes, elements, tables = {}, [], [], []
        for x, y in grid:
            table = np.empty(x.shape, dtype=int)
            for index in np.ndindex(x.shape):
                key = (round(x[index] * 1e6), round(y[index] * 1e6))
                near = (key, *((key[0] + i, key[1] + j) for i in (-1, 0, 1) for j in (-1, 0, 1)))
                table[index] = next((known[k] for k in near if k in known), len(nodes))
                if table[index] == len(nodes):
                    known[key] = len(nodes)
                    nodes.append((x[index], y[index]))
            tables.append(table)
            elements += [
                table[i : i + 3, j : j + 3].ravel()
                for i in range(0, x.shape[0] - 2, 2)
                for j in range(0, x.shape[1] - 2, 2)
            ]
        self.nodes, elements = np.array(nodes), np.array(elements)
        self.tooth, self.ring = tables
        stiffness = element_matrices(self.nodes[elements])
        of = np.stack([2 * elements, 2 * elements + 1], axis=-1).reshape(len(elements), 18)
        places = np.repeat(of, 18, axis=1).ravel(), np.tile(of, 18).ravel()
        self.stiffness = sparse.csc_matrix((stiffness.ravel(), places))

    def direction(self, length):
        """Of the line of action, from the flank into the tooth, where it meets the flank at a length."""
        angle = self.profile.involute_points(np.array([length]))[3][0]
        return np.array([-math.sin(angle), -math.cos(angle)])

    def moved(self, row):
        """Displacements (2 n) under a unit load at a row of the flank."""
        load = np.zeros(2 * len(self.nodes))
        loaded = self.tooth[2 * FILLET + row, -1]
        load[2 * loaded : 2 * loaded + 2] = self.direction(self.lengths[row])
        free = np.setdiff1d(np.arange(load.size), [2 * self.ring[0], 2 * self.ring[0] + 1])
        moved = np.zeros(load.size)
        moved[free] = splu(self.stiffness[free][:, free]).solve(load[free])
        return moved

    def own(self, moved, row):
        """Deflection along the line of action, on its centre line."""
        length, centre = self.lengths[row], self.tooth[:, ACROSS]
        along = np.stack([moved[2 * centre], moved[2 * centre + 1]], axis=1) @ self.direction(length)
        angle = self.profile.involute_points(np.array([length]))[3][0]
        return np.interp(self.profile.base_radius / math.cos(angle), self.nodes[centre, 0], along)


def standard_gear(teeth):
    profile = ToothProfile(teeth, 1.0, math.radians(20.0), 0.0, 1.25, 0.38)
    return profile, math.sqrt((teeth / 2 + 1) ** 2 - profile.base_radius**2)


def twist(profile, ratio):
    """Deflection by the twist of the ring between its clamp and the root circle."""
    return profile.base_radius**2 / torsional_stiffness(
        profile.root_radius, profile.root_radius / ratio, 1.0, NU
    )


@pytest.mark.parametrize(("teeth", "ratio"), [(28, 6.0), (75, 4.0)])
def test_tooth_and_body_deflect_as_in_finite_elements(teeth, ratio):
    profile, tip_length = standard_gear(teeth)
    gear, rows = PlaneGear(profile, tip_length, profile.root_radius / ratio), np.array([4, 10, 16, 22, 28])
    reference = np.array([gear.own(gear.moved(row), row) for row in rows])
    reference -= twist(profile, ratio)  # no part of the tooth
    length = gear.lengths[rows]
    beam = beam_compliance(profile, length, 1.0, NU)
    body = foundation_compliance(
        profile.base_radius,
        profile.root_radius,
        profile.root_half_angle,
        profile.involute_points(length)[3],
        1.0,
        NU,
    )
    total = beam.bending + beam.shear + beam.axial + body
    # A beam on a body is not the plane problem: up to 12 % too soft.
    ratio_to_fe = total / reference
    assert np.all((ratio_to_fe > 0.97) & (ratio_to_fe < 1.12))
    # The rise towards the tip is mostly the tooth itself.
    assert total[-1] - total[0] == pytest.approx(reference[-1] - reference[0], rel=0.08)


def test_a_free_tooth_does_not_feel_the_bore_of_a_thick_rim():
    # Counted from the mean motion of the gear. A thin rim bends between its teeth, and the limit of
    # ``BODY_RATIO`` stands where that begins to show.
    profile, tip_length = standard_gear(28)
    tip, lengths = math.hypot(profile.base_radius, tip_length), np.array([2.8, 4.8, 6.6])
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
