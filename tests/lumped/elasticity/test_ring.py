"""Are elements exact under uniform stress, is a ring as stiff as Lame says, are joined pitches the gear?"""

import math

import numpy as np
import pytest
from scipy import sparse
from scipy.sparse.linalg import splu

from lumped.elasticity.elements import assembled, plane_law
from lumped.elasticity.load import flank_load
from lumped.elasticity.ring import compliances

from .conftest import NU, TEETH, meshed

LENGTHS = np.array([1.6, 3.2])
PITCH = 2.0 * math.pi / TEETH


@pytest.fixture(scope="module")
def free(coarse):
    return compliances(coarse, NU, TEETH, LENGTHS, TEETH - 1, "free")


def whole_gear(mesh):
    """Nodes, elements and for every tooth the numbers of a pitch's nodes; all pitches side by side."""
    known, nodes, places = {}, [], []
    for tooth in range(TEETH):
        c, s = math.cos(tooth * PITCH), math.sin(tooth * PITCH)
        numbers = []
        for point in mesh.nodes @ np.array([[c, s], [-s, c]]):
            key = tuple(np.round(point * 1e6 + 0.25).astype(int))
            if key not in known:
                known[key] = len(nodes)
                nodes.append(point)
            numbers.append(known[key])
        places.append(np.array(numbers))
    elements = np.concatenate([numbers[mesh.elements] for numbers in places])
    return np.array(nodes), elements, places


@pytest.mark.parametrize("support", ["free", "clamped"])
def test_joined_pitches_are_the_whole_gear(coarse, free, support):
    nodes, elements, places = whole_gear(coarse)
    assert len(nodes) == TEETH * (len(coarse.nodes) - len(coarse.ahead))
    matrix, heavy = assembled(nodes, elements, NU)
    freedoms = [np.stack([2 * numbers, 2 * numbers + 1], -1).ravel() for numbers in places]
    load, read, taken = flank_load(coarse, NU, LENGTHS[1])
    force = np.zeros(2 * len(nodes))
    force[freedoms[0]] = load
    rigid = np.zeros((force.size, 3))
    rigid[::2, 0] = rigid[1::2, 1] = 1.0
    rigid[::2, 2], rigid[1::2, 2] = -nodes[:, 1], nodes[:, 0]
    mass = rigid.T @ heavy
    fixed = np.unique(
        [2 * places[0][coarse.bore[0]], 2 * places[0][coarse.bore[0]] + 1, 2 * places[4][0] + 1]
    )
    if support == "clamped":
        fixed = np.unique(
            np.concatenate([freedoms[t].reshape(-1, 2)[coarse.bore].ravel() for t in range(TEETH)])
        )
    else:
        force -= heavy @ np.linalg.solve(mass, rigid.T @ force)
    kept = np.setdiff1d(np.arange(force.size), fixed)
    moved = np.zeros(force.size)
    moved[kept] = splu(sparse.csc_array(matrix)[kept][:, kept]).solve(force[kept])
    if support == "free":  # the part that was taken off has a mean motion too
        moved -= rigid @ np.linalg.solve(mass, heavy.T @ moved + taken)
    found = free if support == "free" else compliances(coarse, NU, TEETH, LENGTHS, 2, support)
    for tooth in range(3):
        c, s = math.cos(tooth * PITCH), math.sin(tooth * PITCH)
        there = moved[freedoms[tooth]].reshape(-1, 2) @ np.array([[c, -s], [s, c]])
        assert found[tooth, 1, 1] == pytest.approx(read @ there.ravel(), rel=1e-9)


def test_load_and_point_may_change_places(free):
    # Load at i on a tooth and point at j on the next one, or the other way round. Only the load's singularity
    # is taken off, so the two differ by an error of the mesh, beside a motion of the loaded tooth of 2 to 4.
    assert free[1] == pytest.approx(free[-1].T, abs=4e-4)


def test_uniform_strain_meets_no_resistance_inside_and_the_area_is_the_mass(coarse):
    matrix, heavy = assembled(coarse.nodes, coarse.elements, NU)
    strain = np.array([[0.3, 0.7], [-0.2, 0.5]])
    moved = (coarse.nodes @ strain.T).ravel()
    force = (matrix @ moved).reshape(-1, 2)
    border = np.unique(np.concatenate([coarse.surface.ravel(), coarse.behind, coarse.ahead, coarse.bore]))
    inside = np.setdiff1d(np.arange(len(coarse.nodes)), border)
    assert abs(force[inside]).max() < 1e-12
    # The work of uniform stress is the energy density times the area.
    area = heavy[::2, 0].sum()
    voigt = np.array([0.3, 0.5, 0.5])
    assert moved @ force.ravel() == pytest.approx(voigt @ plane_law(NU) @ voigt * area, rel=1e-12)
    ends = coarse.nodes[coarse.surface[:, [0, 2]]]
    polygon = 0.5 * (ends[:, 0, 0] * ends[:, 1, 1] - ends[:, 1, 0] * ends[:, 0, 1]).sum()
    bore = 0.5 * math.hypot(*coarse.nodes[coarse.bore[0]]) ** 2 * 2.0 * math.pi / TEETH
    assert area == pytest.approx(polygon - bore, rel=3e-3)  # edges are curved


def test_the_ring_twists_as_lame_says(small):
    # The same load on every tooth is a pure torque. Between two bores only the twist of the ring differs:
    # z r_b^2 (1/r_1^2 - 1/r_2^2)/(4 pi G), up to what the teeth feel of the bore, (1/h)^z.
    bores = small.root_radius / np.array([3.0, 6.0])
    lengths = np.array([2.0])
    wide, narrow = (
        compliances(meshed(small, 0.5, bore, 0.3), NU, TEETH, lengths, TEETH - 1, "clamped").sum()
        for bore in bores
    )
    shear = 0.5 / (1.0 + NU)
    lame = TEETH * small.base_radius**2 * (bores[1] ** -2 - bores[0] ** -2) / (4.0 * math.pi * shear)
    assert narrow - wide == pytest.approx(lame, rel=5e-4)
