"""Does a plane finite-element model of the same tooth and body deflect as the energy method says?

An independent discretisation of the same gear: one tooth with its true fillet on a ring clamped at the bore,
nine-node plane-stress elements. The flank is loaded along the line of action; the deflection is read on the
tooth's centre line, where the singular dent under the load has died out: the energy method
treats the contact apart.
"""

import math

import numpy as np
import pytest
from scipy import sparse
from scipy.optimize import brentq
from scipy.sparse.linalg import splu

from lumped.gear_geometry.tooth_profile import ToothProfile
from lumped.stiffness.foundation import foundation_compliance, ring_twist
from lumped.stiffness.tooth_beam import beam_compliance

NU = 0.3
ACROSS, FILLET, FLANK, AROUND, DEEP = 8, 10, 16, 24, 12  # elements


def element_stiffness(corners):
    """Stiffness matrices (n, 18, 18) of nine-node elements with nodes (n, 9, 2); E = 1, unit thickness."""
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
    first = theta / ACROSS
    beyond = theta + with_midpoints(graded(math.pi - theta, first, AROUND))
    angle = np.concatenate([-beyond[::-1], (eta * theta)[1:-1], beyond])
    depth = with_midpoints(graded(root - bore, root * first, DEEP))
    radius = (root - depth)[::-1, None]
    ring_x, ring_y = radius * np.cos(angle), radius * np.sin(angle)
    ring_x[:, -1], ring_y[:, 0], ring_y[:, -1] = ring_x[:, 0], 0.0, 0.0
    return (x, y), (ring_x, ring_y)


def deflections(profile, tip_length, bore, rows):
    """Lengths on the base tangent and compliance E b delta/F on the centre line for loads at flank nodes."""
    numbers, nodes, elements, tables = {}, [], [], []
    for x, y in grids(profile, tip_length, bore):
        table = np.empty(x.shape, dtype=int)
        for index in np.ndindex(x.shape):
            key = (round(x[index] * 1e8), round(y[index] * 1e8))
            if key not in numbers:
                numbers[key] = len(nodes)
                nodes.append((x[index], y[index]))
            table[index] = numbers[key]
        tables.append(table)
        elements += [
            table[i : i + 3, j : j + 3].ravel()
            for i in range(0, x.shape[0] - 2, 2)
            for j in range(0, x.shape[1] - 2, 2)
        ]
    nodes, elements = np.array(nodes), np.array(elements)
    freedoms = np.stack([2 * elements, 2 * elements + 1], axis=-1).reshape(len(elements), 18)
    stiffness = sparse.csc_matrix(
        (
            element_stiffness(nodes[elements]).ravel(),
            (np.repeat(freedoms, 18, axis=1).ravel(), np.tile(freedoms, (1, 18)).ravel()),
        )
    )
    tooth, ring = tables
    clamped = np.concatenate([2 * ring[0], 2 * ring[0] + 1])
    free = np.setdiff1d(np.arange(2 * len(nodes)), clamped)
    solver = splu(stiffness[free][:, free])
    lengths = np.linspace(profile.form_length, tip_length, 2 * FLANK + 1)[rows]
    angles = profile.involute_points(lengths)[3]
    centre = tooth[:, ACROSS]
    found = []
    for row, angle in zip(rows, angles, strict=True):
        direction = np.array([-math.sin(angle), -math.cos(angle)])  # from the +h flank into the tooth
        load, moved = np.zeros(2 * len(nodes)), np.zeros(2 * len(nodes))
        loaded = tooth[2 * FILLET + row, -1]
        load[2 * loaded : 2 * loaded + 2] = direction
        moved[free] = solver.solve(load[free])
        along = moved[2 * centre] * direction[0] + moved[2 * centre + 1] * direction[1]
        found.append(np.interp(profile.base_radius / math.cos(angle), nodes[centre, 0], along))
    return lengths, np.array(found)


@pytest.mark.parametrize(("teeth", "ratio"), [(28, 2.0), (28, 4.0), (28, 6.0), (50, 3.0), (75, 3.0)])
def test_tooth_and_body_deflect_as_in_finite_elements(teeth, ratio):
    profile = ToothProfile(teeth, 1.0, math.radians(20.0), 0.0, 1.25, 0.38)
    tip_length = math.sqrt((teeth / 2 + 1) ** 2 - profile.base_radius**2)
    bore = profile.root_radius / ratio
    length, reference = deflections(profile, tip_length, bore, np.array([4, 10, 16, 22, 28]))
    beam = beam_compliance(profile, length, 1.0, NU)
    body = foundation_compliance(
        profile.base_radius,
        profile.root_radius,
        bore,
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


def test_the_body_part_of_finite_elements_holds_the_ring_twist():
    # Between two bores the tooth's own deflection cancels; what is left is the ring's twist and a local part
    # that grows slowly, as the logarithm of the thickness.
    profile = ToothProfile(28, 1.0, math.radians(20.0), 0.0, 1.25, 0.38)
    tip_length = math.sqrt(15**2 - profile.base_radius**2)
    rows = np.array([16])
    thin, thick = (deflections(profile, tip_length, profile.root_radius / h, rows)[1][0] for h in (4.0, 6.0))
    twist = [
        ring_twist(profile.base_radius, profile.root_radius, profile.root_radius / h, 1.0, NU)
        for h in (4.0, 6.0)
    ]
    assert thick - thin == pytest.approx(twist[1] - twist[0], rel=0.04)
