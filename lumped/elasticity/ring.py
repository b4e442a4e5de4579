"""A whole gear out of equal pitches: each is condensed to its two cuts, and the ring is closed.

All pitches are the same finite-element model turned about the axis, so one is factored, and 2^k of them in a
row are condensed by joining k times (J. S. Przemieniecki, Theory of Matrix Structural Analysis (1968),
chapter 9). Freedoms on a cut are radial and tangential, the same for the pitches on both sides.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from lumped.elasticity.elements import assembled
from lumped.elasticity.load import flank_load
from lumped.elasticity.sector import Sector
from lumped.typing import FloatArray

#: Column of the rotation among the rigid motions: along x, along y, rotation.
_ROTATION = 2
#: Support of the gear. "free": the inertia of the gear balances the load, and motions count from the mean
#: motion; "clamped": the bore is fixed.
Support = Literal["free", "clamped"]


@dataclass(frozen=True)
class Chain:
    """Pitches in a row, condensed to the cuts at their ends.

    Attributes
    ----------
    stiffness : (2 r, 2 r) of the cut behind, then of the cut ahead
    loads : (2 r, c) forces on the cuts by unit values of c loads
    work : (c, c) work of the loads on the motions that the loads cause while both cuts are fixed
    """

    stiffness: FloatArray
    loads: FloatArray
    work: FloatArray


def compliances(
    mesh: Sector,
    poisson: float,
    teeth: int,
    lengths: FloatArray,
    reach: int,
    support: Support,
    radii: tuple[float, float] | None = None,
) -> FloatArray:
    """Motion of points on the flanks by unit loads on tooth 0, both along the line of action.

    Young's modulus and thickness are 1, lengths are in modules.

    Parameters
    ----------
    lengths : (n,) of loads and points along the base tangent
    reach : number of the teeth ahead of tooth 0 whose motion is computed
    radii : as of ``flank_load``

    Returns
    -------
    (reach + 1, n, n) for the teeth 0, 1, ...: motion of each point by each load. On tooth 0 the motion is the
    smooth part u_c; only its diagonal, the motion of the loaded point, has a meaning.
    """
    options = () if radii is None else (radii,)
    applied, read, singular_integrals = (
        np.stack(each, axis=-1)
        for each in zip(*(flank_load(mesh, poisson, length, *options) for length in lengths), strict=True)
    )
    matrix, inertia_loads = assembled(mesh.nodes, mesh.elements, poisson)
    pitch = 2.0 * math.pi / teeth
    count = lengths.size
    one_pitch = _condensed(
        mesh, matrix, np.concatenate([applied, read, inertia_loads], axis=1), pitch, support
    )
    body = slice(2 * count, 2 * count + 3)
    body_only = Chain(one_pitch.stiffness, one_pitch.loads[:, body], one_pitch.work[body, body])
    other_teeth = teeth - 1 - reach
    # Columns: loads of tooth 0, points of the teeth 0 to reach, three accelerations of the whole gear.
    cut = one_pitch.stiffness.shape[0] // 2
    cuts = reach + 2 if other_teeth else reach + 1
    columns = count * (reach + 2) + 3
    total = np.zeros((cuts, cut, cuts, cut))
    work = np.zeros((columns, columns))
    loads = np.zeros((cuts, cut, columns))

    def add(chain: Chain, chosen: np.ndarray, behind: int, ahead: int, turn: float) -> None:
        rotation = np.eye(chosen.size)
        rotation[-3:, -3:] = _turn(turn)
        ends = [behind, ahead % cuts]
        stiffness = chain.stiffness.reshape(2, cut, 2, cut)
        forces = (chain.loads @ rotation).reshape(2, cut, -1)
        for i, row in enumerate(ends):
            loads[row][:, chosen] += forces[i]
            for j, column in enumerate(ends):
                total[row, :, column] += stiffness[i, :, j]
        work[np.ix_(chosen, chosen)] += rotation.T @ chain.work @ rotation

    last = np.arange(columns - 3, columns)
    for tooth in range(reach + 1):
        points = np.arange(count * (tooth + 1), count * (tooth + 2))
        used = np.arange(count, 2 * count + 3) if tooth else np.arange(2 * count + 3)
        chosen = np.concatenate([points, last] if tooth else [np.arange(count), points, last])
        part = Chain(one_pitch.stiffness, one_pitch.loads[:, used], one_pitch.work[np.ix_(used, used)])
        add(part, chosen, tooth, tooth + 1, tooth * pitch)
    if other_teeth:
        add(_row(body_only, other_teeth, pitch), last, reach + 1, 0, (reach + 1) * pitch)

    stiffness = total.reshape(cuts * cut, -1)
    forces = loads.reshape(cuts * cut, -1)
    not_pinned = np.ones(len(stiffness), dtype=bool)
    balance = np.eye(columns)
    resultants = np.zeros((3, columns))
    if support == "free":
        rigid = np.zeros((len(applied), 3))
        rigid[::2, 0] = rigid[1::2, 1] = 1.0
        rigid[::2, _ROTATION] = -mesh.nodes[:, 1]
        rigid[1::2, _ROTATION] = mesh.nodes[:, 0]
        inertia = rigid.T @ inertia_loads
        mass = teeth * np.array([inertia[0, 0], inertia[0, 0], inertia[_ROTATION, _ROTATION]])
        resultants[:, :count] = rigid.T @ applied
        for tooth in range(reach + 1):
            points_of_tooth = slice(count * (tooth + 1), count * (tooth + 2))
            resultants[:, points_of_tooth] = _turn(tooth * pitch).T @ rigid.T @ read
        resultants /= mass[:, None]
        balance[-3:] -= resultants
        not_pinned[[0, 1, cut - 1]] = False  # three pins, whose forces are zero because the loads balance
    motion = np.linalg.solve(stiffness[np.ix_(not_pinned, not_pinned)], forces[not_pinned])
    result = balance.T @ (work + forces[not_pinned].T @ motion) @ balance
    points = result[count:-3, :count] - resultants[:, count:-3].T @ singular_integrals
    return np.asarray(points.reshape(reach + 1, count, count))


def _turn(angle: float) -> FloatArray:
    """Accelerations (along x, along y, about 0) in axes turned by an angle; (3, 3)."""
    c = math.cos(angle)
    s = math.sin(angle)
    return np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])


def _condensed(
    mesh: Sector, matrix: sparse.csc_array, loads: FloatArray, pitch: float, support: Support
) -> Chain:
    """Condense one pitch to its cuts; a "clamped" bore is fixed."""
    bore_nodes = set(mesh.bore.tolist()) if support == "clamped" else set()
    cuts = [np.array([node for node in cut if node not in bore_nodes]) for cut in (mesh.behind, mesh.ahead)]
    outer = np.concatenate([np.stack([2 * cut, 2 * cut + 1], -1).ravel() for cut in cuts])
    inner = np.ones(len(loads), dtype=bool)
    inner[outer] = False
    for node in bore_nodes:
        inner[2 * node : 2 * node + 2] = False
    polar = np.zeros((outer.size, outer.size))
    half = outer.size // 2
    for first, angle in ((0, -0.5 * pitch), (half, 0.5 * pitch)):
        c = math.cos(angle)
        s = math.sin(angle)
        for k in range(first, first + half, 2):
            polar[k : k + 2, k : k + 2] = [[c, -s], [s, c]]
    inside = np.flatnonzero(inner)
    border = matrix[inside][:, outer] @ polar
    factor = splu(matrix[inside][:, inside], permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
    by_border, by_loads = np.split(
        factor.solve(np.concatenate([border, loads[inside]], axis=1)), [outer.size], 1
    )
    return Chain(
        polar.T @ matrix[outer][:, outer] @ polar - border.T @ by_border,
        polar.T @ loads[outer] - border.T @ by_loads,
        loads[inside].T @ by_loads,
    )


def _connected(a: Chain, b: Chain, turn: float) -> Chain:
    """Join two chains whose loads are accelerations; the second is turned against the first by an angle."""
    half = len(a.stiffness) // 2
    t = _turn(turn)
    b = Chain(b.stiffness, b.loads @ t, t.T @ b.work @ t)
    middle = a.stiffness[half:, half:] + b.stiffness[:half, :half]
    by_cuts = np.concatenate([a.stiffness[half:, :half], b.stiffness[:half, half:]], axis=1)
    force = a.loads[half:] + b.loads[:half]
    by_ends, by_force = np.split(
        np.linalg.solve(middle, np.concatenate([by_cuts, force], axis=1)), [2 * half], 1
    )
    ends = np.zeros_like(a.stiffness)
    ends[:half, :half] = a.stiffness[:half, :half]
    ends[half:, half:] = b.stiffness[half:, half:]
    return Chain(
        ends - by_cuts.T @ by_ends,
        np.concatenate([a.loads[:half], b.loads[half:]]) - by_cuts.T @ by_force,
        a.work + b.work + force.T @ by_force,
    )


def _row(one: Chain, count: int, pitch: float) -> Chain:
    """Join ``count`` equal pitches in a row."""
    result = None
    joined = 0
    power = one
    power_count = 1
    while True:
        if count & power_count:
            result = power if result is None else _connected(result, power, joined * pitch)
            joined += power_count
        if joined == count:
            assert result is not None
            return result
        power = _connected(power, power, power_count * pitch)
        power_count = 2 * power_count
