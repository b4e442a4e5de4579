"""Points of a tabulated stiffness on the line of action, by formulas of this package."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal, NamedTuple, Protocol

import numpy as np

from lumped.typing import FloatArray
from multibody.gears.circles import Circles

#: Points of a table that are taken, at most: of the file, and at places of pairs.
_MOST_POINTS = 400
_MOST = 60
#: Points closer than this to A, D or the same phase of another point, in base pitches, are left out.
_SAME = 1e-6


class GivenTable(Protocol):
    """Fields of a tabulated stiffness in the parameter file."""

    kind: Literal["pair", "total"]
    axis: Literal["position_mm", "roll_angle_deg", "phase"]
    points: tuple[float, ...]
    stiffness: tuple[float, ...]


class TablePoints(NamedTuple):
    """Points of a table between A and D.

    Attributes
    ----------
    place : distance from X on the line of action [m]
    stiffness : values of the file: of one pair, or of the whole mesh [N/m]
    whole_mesh : whether the values are of the whole mesh
    """

    place: FloatArray
    stiffness: FloatArray
    whole_mesh: bool


def table_points(table: GivenTable, drawn: Circles) -> TablePoints:
    """Points of a table on the line of action.

    A point of a table of the whole mesh is a place of every pair in contact at this phase.
    """
    place = _places(table.points, table.axis, drawn)
    stiffness = np.array(table.stiffness)
    if place.size > _MOST_POINTS:  # distances of all points from each other are computed
        every = np.linspace(0, place.size - 1, _MOST_POINTS).astype(int)
        place = place[every]
        stiffness = stiffness[every]
    whole_mesh = table.kind == "total"
    margin = _SAME * drawn.pitch
    if whole_mesh:
        contact_ratio = (drawn.end - drawn.start) / drawn.pitch
        phase = np.mod((place - drawn.start) / drawn.pitch, 1.0)
        distance = _distances(phase, phase)
        np.fill_diagonal(distance, 1.0)
        # Points of one phase may have two values, and where a pair comes or goes the shares jump.
        switches = np.array([0.0, contact_ratio % 1.0])
        single = np.minimum(distance.min(axis=1), _distances(phase, switches).min(axis=1)) > _SAME
        pairs = np.arange(math.ceil(contact_ratio))
        place = drawn.start + drawn.pitch * np.add.outer(pairs, phase[single]).ravel()
        stiffness = np.tile(stiffness[single], pairs.size)
    between = (place > drawn.start + margin) & (place < drawn.end - margin)
    chosen = np.flatnonzero(between)
    chosen = chosen[np.linspace(0, chosen.size - 1, min(chosen.size, _MOST)).astype(int)]
    return TablePoints(place[chosen], stiffness[chosen], whole_mesh)


def _distances(phases: FloatArray, others: FloatArray) -> FloatArray:
    """Distances of phases from others, round the mesh cycle; (phases, others)."""
    apart = np.abs(np.subtract.outer(phases, others))
    return np.asarray(np.minimum(apart, 1.0 - apart), dtype=np.float64)


def _places(points: Sequence[float], axis: str, drawn: Circles) -> FloatArray:
    """Distances from X of points in millimetres, degrees of the pinion's roll, or mesh cycles after A [m]."""
    values = np.array(points)
    if axis == "position_mm":
        return np.asarray(values / 1000.0, dtype=np.float64)
    if axis == "roll_angle_deg":
        return np.asarray(values * math.pi / 180.0 * drawn.base_pinion, dtype=np.float64)
    return np.asarray(drawn.start + values * drawn.pitch, dtype=np.float64)
