"""Stress and displacement of a whole gear under loads on its flanks, for pictures.

All pitches in one matrix; near a load the half plane's solution is added to the smooth part again.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from lumped.elasticity.elements import assembled, gradients, line_shapes, plane_law
from lumped.elasticity.gear import PlaneGear, bore_radius, meshed
from lumped.elasticity.load import FAR, NEAR, flamant, flank_load, outer_radius
from lumped.elasticity.sector import Sector
from lumped.typing import FloatArray, IntArray

#: Elements at the surface [modules].
_SIZE = 0.3


@dataclass(frozen=True, eq=False)
class GearField:
    """A loaded gear. Lengths in modules; E (plane strain: E/(1 - nu^2)) and face width are 1.

    Attributes
    ----------
    nodes : (n, 2) coordinates, tooth 0 along x
    triangles, surface : (t, 3) and (s, 3) node numbers, of edges of the surface
    pitches : (teeth, k) numbers of the nodes of every pitch
    moved : (n, 2) displacement, of a free gear from its mean motion
    stress : (n, 3) xx, yy, xy, mean over the elements of a node
    """

    nodes: FloatArray
    triangles: IntArray
    surface: IntArray
    pitches: IntArray
    moved: FloatArray
    stress: FloatArray

    @property
    def von_mises(self) -> FloatArray:
        """Von Mises stress in plane stress, (n,)."""
        x, y, xy = self.stress.T
        return np.asarray(np.sqrt(x * x - x * y + y * y + 3.0 * xy * xy), dtype=np.float64)


def gear_field(gear: PlaneGear, loads: Mapping[int, tuple[float, float]]) -> GearField:
    """Field of a gear under normal loads.

    Parameters
    ----------
    gear : the gear; ``reach`` is not used
    loads : tooth -> length along the base tangent [modules] and load; teeth count towards the loaded flank

    Raises
    ------
    NumericalError : the teeth cannot be meshed
    """
    teeth = gear.profile.teeth
    mesh = meshed(gear.profile, gear.tip, bore_radius(gear), _SIZE)
    nodes, pitches = _ring(mesh, teeth)
    elements = pitches[:, mesh.elements].reshape(-1, 9)
    matrix, heavy = assembled(nodes, elements, gear.poisson)
    applied, taken = np.zeros(2 * len(nodes)), np.zeros(3)
    singular, stress = np.zeros(nodes.shape), np.zeros((*elements.shape, 3))
    for tooth, (length, load) in loads.items():
        turn = _turn(2.0 * math.pi * tooth / teeth)
        smooth, _, mean = flank_load(mesh, gear.poisson, length)
        applied[_freedoms(pitches[tooth])] += load * (smooth.reshape(-1, 2) @ turn).ravel()
        _, _, point, normal = mesh.edge_at(length)
        taken += load * np.append(mean[:2] @ turn, mean[2])
        off, along = nodes - point @ turn, normal @ turn
        u, s, chi, fall = flamant(off, along, gear.poisson, NEAR, outer_radius(mesh, point, FAR))
        own = np.isin(np.arange(len(nodes)), pitches[tooth])
        singular[own] += load * (chi[:, None] * u)[own]
        cut = np.stack(
            [fall[:, 0] * u[:, 0], fall[:, 1] * u[:, 1], fall[:, 0] * u[:, 1] + fall[:, 1] * u[:, 0]]
        )
        both = chi[:, None] * np.stack([s[:, 0, 0], s[:, 1, 1], s[:, 0, 1]], -1) + cut.T @ plane_law(
            gear.poisson
        )
        block = slice(tooth * len(mesh.elements), (tooth + 1) * len(mesh.elements))
        stress[block] += load * both[elements[block]]
    smooth_part = _solved(matrix, heavy, applied, taken, nodes, pitches, mesh, gear.support)
    stress += _stresses(nodes, elements, smooth_part, gear.poisson)
    mean_stress, count = np.zeros((len(nodes), 3)), np.zeros(len(nodes))
    np.add.at(mean_stress, elements, stress)
    np.add.at(count, elements, 1.0)
    corners = np.array(
        [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [3, 4, 7], [3, 7, 6], [4, 5, 8], [4, 8, 7]]
    )
    return GearField(
        nodes=nodes,
        triangles=elements[:, corners].reshape(-1, 3),
        surface=pitches[:, mesh.surface].reshape(-1, 3),
        pitches=pitches,
        moved=smooth_part + singular,
        stress=mean_stress / count[:, None],
    )


def _ring(mesh: Sector, teeth: int) -> tuple[FloatArray, IntArray]:
    """Nodes of the whole gear, and their numbers for every pitch (teeth, k)."""
    inner = np.setdiff1d(np.arange(len(mesh.nodes)), mesh.behind)
    pitches = np.empty((teeth, len(mesh.nodes)), dtype=np.int64)
    pitches[:, inner] = np.arange(teeth * inner.size).reshape(teeth, -1)
    pitches[:, mesh.behind] = np.roll(pitches[:, mesh.ahead], 1, axis=0)
    turns = [_turn(2.0 * math.pi * tooth / teeth) for tooth in range(teeth)]
    return np.concatenate([mesh.nodes[inner] @ turn for turn in turns]), pitches


def _turn(angle: float) -> FloatArray:
    """Turns rows of coordinates by an angle."""
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, s], [-s, c]])


def _freedoms(numbers: IntArray) -> IntArray:
    return np.asarray(np.stack([2 * numbers, 2 * numbers + 1], -1).ravel())


def _solved(
    matrix: sparse.csc_array,
    heavy: FloatArray,
    applied: FloatArray,
    taken: FloatArray,
    nodes: FloatArray,
    pitches: IntArray,
    mesh: Sector,
    support: str,
) -> FloatArray:
    """Displacements (n, 2) of the smooth part."""
    rigid = np.zeros((applied.size, 3))
    rigid[::2, 0] = rigid[1::2, 1] = 1.0
    rigid[::2, 2], rigid[1::2, 2] = -nodes[:, 1], nodes[:, 0]
    mass = rigid.T @ heavy
    held = np.unique(pitches[:, mesh.bore])
    free = support == "free"
    if free:
        applied = applied - heavy @ np.linalg.solve(mass, rigid.T @ applied)
        far = held[held.size // 2]
        fixed = np.array(
            [2 * held[0], 2 * held[0] + 1, 2 * far + int(abs(nodes[far, 0]) > abs(nodes[far, 1]))]
        )
    else:
        fixed = _freedoms(held)
    kept = np.setdiff1d(np.arange(applied.size), fixed)
    moved = np.zeros(applied.size)
    factor = splu(matrix[kept][:, kept], permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    moved[kept] = factor.solve(applied[kept])
    if free:
        moved -= rigid @ np.linalg.solve(mass, heavy.T @ moved + taken)
    return moved.reshape(-1, 2)


def _stresses(nodes: FloatArray, elements: IntArray, moved: FloatArray, poisson: float) -> FloatArray:
    """Stresses (e, 9, 3) at the nodes of the elements."""
    at, slope = line_shapes(np.array([-1.0, 0.0, 1.0]))

    def product(a: FloatArray, b: FloatArray) -> FloatArray:
        return np.asarray(np.einsum("pi,qj->pqij", a, b).reshape(9, 9))

    gradient, _ = gradients(nodes[elements], np.stack([product(slope, at), product(at, slope)]))
    g = np.einsum("edpk,ekc->epcd", gradient, moved[elements])
    strain = np.stack([g[..., 0, 0], g[..., 1, 1], g[..., 0, 1] + g[..., 1, 0]], -1)
    return np.asarray(strain @ plane_law(poisson))
