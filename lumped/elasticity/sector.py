"""Mesh of one pitch of a gear: the tooth with its fillets, and the rim below it from space to space.

Two grids of mapped nine-node quadrilaterals that share the foot of the tooth. The foot is an arc between the
points at which the fillets make 45 degrees with the centre line: on the root circle they are tangent to it,
and elements there would have no angle. Lengths are in modules, axes as in ``gear_geometry.tooth_profile``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lumped.elasticity.elements import Quadrature, line_shapes, quadrature
from lumped.gear_geometry.tooth_profile import ToothProfile
from lumped.root_in_bracket import root_in_bracket
from lumped.typing import FloatArray, IntArray

#: Where elements at the surface are 0.3 modules long: growth of the rows below it, their largest share of r.
_COARSE = 0.3
_GROWTH = 0.45
_LARGEST = 0.3
#: Gauss points along an edge and a side of an element where a load is spread.
SPREAD_POINTS = 4
#: Shorter arcs between the fillets' ends are none [modules].
_NO_LAND = 1e-3


@dataclass(frozen=True)
class Sector:
    """One pitch of a gear as a mesh; coordinates in modules.

    Attributes
    ----------
    nodes, elements : (n, 2) coordinates, (e, 9) node numbers
    behind, ahead : (r,) nodes of the radial cuts at half a pitch, from bore to root circle
    bore : nodes of the bore
    flank : (k, 3) edges of the loaded flank, from the fillet to the tip
    surface : (s, 3) edges of the surface, the body to the left of their direction
    lengths : (2 k + 1,) of the flank's nodes along the base tangent
    """

    profile: ToothProfile
    nodes: FloatArray
    elements: IntArray
    behind: IntArray
    ahead: IntArray
    bore: IntArray
    flank: IntArray
    lengths: FloatArray
    surface: IntArray

    @cached_property
    def quadrature(self) -> Quadrature:
        """Gauss rule for loads that are spread over elements."""
        return quadrature(self.nodes, self.elements, SPREAD_POINTS)

    def edge_at(self, length: float) -> tuple[IntArray, FloatArray, FloatArray, FloatArray]:
        """Where a load at a length along the base tangent meets the flank.

        Nodes of the edge (3,), their shape functions (3,), the point (2,), the normal into the tooth (2,).
        """
        k = int(np.clip(np.searchsorted(self.lengths[::2], length) - 1, 0, len(self.flank) - 1))
        start, middle, end = self.lengths[2 * k : 2 * k + 3]
        edge = self.flank[k]
        shapes, _ = line_shapes(np.array((length - middle) / (0.5 * (end - start))))
        *_, angle = self.profile.involute_points(np.array(length))
        return edge, shapes, shapes @ self.nodes[edge], -np.array([np.sin(angle), np.cos(angle)])


@dataclass(frozen=True)
class Stations:
    """Where the nodes stand, ends and middles of the elements by turns.

    Attributes
    ----------
    above : rolling angles along the fillet from the foot to the involute [rad]
    lengths : along the base tangent from there to the tip [modules]
    across : from -1 to 1 across the tooth [-]
    below : rolling angles along the fillet from the foot to the root circle [rad]
    land : angles on the root circle from there to the middle of the space; none where fillets meet [rad]
    depth : from bore to surface, 0 to 1 [-]
    """

    above: FloatArray
    lengths: FloatArray
    across: FloatArray
    below: FloatArray
    land: FloatArray
    depth: FloatArray


def stations(profile: ToothProfile, tip: float, bore: float, size: float) -> Stations:
    """Stations for elements of about one size at the surface; radii and size in modules."""
    foot = _foot(profile)
    bottom, joint = profile.fillet_range
    start = profile.form_length
    root = profile.root_radius
    flank = (tip**2 - profile.base_radius**2 - start**2) / (2.0 * profile.base_radius)
    # Even steps along the flank, not along the base tangent.
    squares = np.linspace(start**2, tip**2 - profile.base_radius**2, _count(flank, size) + 1)
    _, half, _ = profile.fillet_points(np.array([foot]))
    end = profile.root_half_angle
    middle = math.pi / profile.teeth
    land = (middle - end) * root
    return Stations(
        above=_even(foot, joint, _arc(profile, foot, joint), size),
        lengths=_with_middles(np.sqrt(squares)),
        across=_even(-1.0, 1.0, 2.0 * half[0], size),
        below=_even(foot, bottom, _arc(profile, bottom, foot), size),
        land=_even(end, middle, land, size) if land > _NO_LAND else np.empty(0),
        depth=_rows(root, bore, size),
    )


def sector(profile: ToothProfile, tip: float, bore: float, places: Stations) -> Sector:
    """Mesh one pitch of a tooth of module 1 between two radii [modules], nodes at the stations."""
    # The tooth: rows of nodes from the foot to the tip, columns across.
    u_1, h_1, _ = profile.fillet_points(places.above)
    u_2, h_2, *_ = profile.involute_points(places.lengths)
    u = np.concatenate([u_1, u_2[1:]])
    h = np.concatenate([h_1, h_2[1:]])
    foot = math.hypot(u[0], h[0])
    half = math.atan2(h[0], u[0])
    top = math.atan2(h[-1], u[-1])
    eta = places.across
    s = np.linspace(0.0, 1.0, u.size)[:, None]
    x = u[:, None] + (1.0 - s) ** 2 * foot * (np.cos(eta * half) - math.cos(half))
    x += s**2 * tip * (np.cos(eta * top) - math.cos(top))
    y = h[:, None] * eta
    y[0] = foot * np.sin(eta * half)
    # The rim: the surface from space to space, and rows below it.
    u_3, h_3, _ = profile.fillet_points(places.below)
    radius = np.hypot(u_3, h_3)
    angle = np.arctan2(h_3, u_3)
    more = places.land[1:]
    radius = np.append(radius, np.full(more.size, profile.root_radius))
    angle = np.append(angle, more)
    angle[-1] = math.pi / profile.teeth
    radii = np.concatenate([radius[::-1], np.full(eta.size - 2, foot), radius])
    angles = np.concatenate([-angle[::-1], eta[1:-1] * half, angle])
    rim = bore + places.depth[:, None] * (radii - bore)
    # Numbers: the rim row by row, then the tooth above its foot.
    below = np.arange(rim.size).reshape(rim.shape)
    first = radius.size - 1
    last = radius.size + eta.size - 2
    rest = rim.size + np.arange(x[1:].size).reshape(-1, eta.size)
    above = np.concatenate([below[-1:, first : last + 1], rest])
    points = [np.stack([rim * np.cos(angles), rim * np.sin(angles)], -1), np.stack([x[1:], y[1:]], -1)]
    lines = [below[-1, : first + 1], above[:, 0], above[-1], above[::-1, -1], below[-1, last:]]
    return Sector(
        profile=profile,
        nodes=np.concatenate([grid.reshape(-1, 2) for grid in points]),
        elements=np.concatenate([_quads(above), _quads(below)]),
        behind=below[:, 0],
        ahead=below[:, -1],
        bore=below[0],
        flank=_edges(above[places.above.size - 1 :, -1]),
        lengths=places.lengths,
        surface=np.concatenate([_edges(line) for line in lines]),
    )


def _foot(profile: ToothProfile) -> float:
    """Roll angle at which the fillet makes 45 degrees with the centre line."""
    bottom, joint = profile.fillet_range

    def excess(roll: float) -> float:
        rolls = roll + np.array([-5e-5, 5e-5]) * (joint - bottom)
        u, h, _ = profile.fillet_points(rolls)
        return float(abs(h[1] - h[0]) - abs(u[1] - u[0]))

    low, high = (bottom + share * (joint - bottom) for share in (1e-3, 0.97))
    if excess(low) <= 0.0:
        return low
    return high if excess(high) >= 0.0 else float(root_in_bracket(excess, low, high))


def _arc(profile: ToothProfile, start: float, end: float) -> float:
    u, h, _ = profile.fillet_points(np.linspace(start, end, 33))
    return float(np.hypot(np.diff(u), np.diff(h)).sum())


def _count(length: float, size: float) -> int:
    return max(2, math.ceil(length / size))


def _even(start: float, end: float, length: float, size: float) -> FloatArray:
    """Even stations from start to end for elements of about ``size`` over a length."""
    return np.linspace(start, end, 2 * _count(length, size) + 1)


def _with_middles(ends: FloatArray) -> FloatArray:
    full = np.empty(2 * ends.size - 1)
    full[::2] = ends
    full[1::2] = 0.5 * (ends[1:] + ends[:-1])
    return full


def _rows(root: float, bore: float, size: float) -> FloatArray:
    """Rows of nodes of the rim as shares of its height, from the bore up."""
    finer = size / _COARSE
    radius = root
    step = 0.8 * size
    ends = [root]
    while radius - 1.4 * step > bore:
        radius -= step
        ends.append(radius)
        step = min((1.0 + _GROWTH * finer) * step, _LARGEST * finer * radius)
    middle = [0.5 * (root + bore)] if len(ends) == 1 else []
    shares = (np.array([bore, *middle, *ends[::-1]]) - bore) / (root - bore)
    return _with_middles(shares)


def _quads(grid: IntArray) -> IntArray:
    rows, columns = (np.arange(0, n - 2, 2) for n in grid.shape)
    windows = [grid[rows[:, None] + i, columns + j] for i in range(3) for j in range(3)]
    return np.stack(windows, axis=-1).reshape(-1, 9)


def _edges(line: IntArray) -> IntArray:
    return np.stack([line[:-2:2], line[1:-1:2], line[2::2]], axis=-1)
