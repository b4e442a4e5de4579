"""Unloaded error of a tooth pair: tip and root relief of both flanks, and the gap before A and behind D.

Errors are lengths along the line of action, positive where material is missing, so that the teeth come too
late to touch. Relief is given per gear over its roll angle, L/r_b for a contact at the length L on the base
tangent.

Sources: docs/theory/mesh_physics.md, "Load sharing and static transmission error".
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lumped.mesh.records import Records
from lumped.mesh.statics import flank_end_gaps
from lumped.mesh.unloaded import RELIEF, reliefs_at
from lumped.path_function import PathFunction
from lumped.typing import FloatArray

if TYPE_CHECKING:
    from lumped.gear_geometry.geometry import Geometry
    from lumped.schema.pair import GearPair
    from lumped.schema.relief import ProfileRelief


def relief_error(pair: GearPair, xi: FloatArray) -> FloatArray:
    """Sum of the reliefs of both flanks at positions xi of any shape [m]."""
    place = np.asarray(xi, dtype=np.float64)
    return reliefs_at(reliefs_of(pair), place.ravel()).reshape(place.shape)


def error_function(pair: GearPair) -> PathFunction:
    """Unloaded error e(xi) of a tooth pair from A to D [m], exactly, with switches where a relief starts."""
    low = pair.geometry.L_XA
    high = pair.geometry.L_XD
    switches = relief_starts(pair)
    breaks = np.array([low, *switches, high])
    # Each piece is a parabola: three values fix it.
    s = np.array([1e-9, 0.5, 1.0 - 1e-9])
    width = np.diff(breaks)
    values = relief_error(pair, breaks[:-1] + np.multiply.outer(s, width))
    return PathFunction(breaks, np.linalg.solve(np.vander(s), values) / width ** [[2], [1], [0]], switches)


def relief_starts(pair: GearPair) -> FloatArray:
    """Positions strictly between A and D where a relief starts, increasing [m]."""
    low = pair.geometry.L_XA
    high = pair.geometry.L_XD
    reliefs = reliefs_of(pair)
    starts = reliefs["origin"] + reliefs["sense"] * reliefs["start"] * reliefs["radius"]
    return np.asarray(np.unique(starts[(starts > low) & (starts < high)]), dtype=np.float64)


def corner_gap(geometry: Geometry, xi: FloatArray) -> FloatArray:
    """Gap between perfect flanks outside the path of contact, 0 within it [m].

    Before A the corner of the gear's tip faces the pinion's flank, or the edge of an undercut pinion the
    gear's flank; behind D the corner of the pinion's tip faces the gear's flank, or the edge of an undercut
    gear the pinion's. The gap is measured on the tangent from the corner to the flank's base circle:
    involutes of one base circle are parallel curves. Of tip and edge the larger gap counts: the flanks end at
    both. xi of any shape outside is where longer teeth would touch [m].
    """
    g = geometry
    place = np.asarray(xi, dtype=float)
    places = place.ravel()
    radii = (g.base_radius_pinion, g.base_radius_gear)
    tips = (g.tip_length_pinion, g.tip_length_gear)
    edges = (g.undercut_pinion, g.undercut_gear)
    beyond_tip = g.L_XY - places - tips[1], places - tips[0]
    beyond_edge = edges[0] - places, edges[1] - (g.L_XY - places)
    before = flank_end_gaps(beyond_tip[0], tips[1], beyond_edge[0], edges[0], g.L_XY, *radii)
    behind = flank_end_gaps(beyond_tip[1], tips[0], beyond_edge[1], edges[1], g.L_XY, *radii[::-1])
    return np.asarray((before + behind).reshape(place.shape), dtype=np.float64)


def relief_record(
    relief: ProfileRelief, end: float, radius: float, origin: float = 0.0, sense: float = 1.0
) -> tuple[float, ...]:
    """Return RELIEF of a relief that reaches its amount at the length ``end`` on the base tangent [m].

    ``end`` of tip relief is the tip circle; of root relief the start of the active flank, which is the mate's
    tip or the edge of an undercut. ``radius``, ``origin`` and ``sense`` are fields of RELIEF. By default xi
    is the length on the gear's own base tangent.
    """
    parabolic = float(relief.shape != "linear")
    return relief.amount, relief.start_roll_angle, end / radius, parabolic, radius, origin, sense


def reliefs_of(pair: GearPair) -> Records:
    """Return RELIEF (n,) of both flanks over the path of contact."""
    g = pair.geometry
    sides = (
        ("pinion", pair.pinion, g.base_radius_pinion, g.tip_length_pinion, g.L_XA, 0.0, 1.0),
        ("gear", pair.gear, g.base_radius_gear, g.tip_length_gear, g.L_XY - g.L_XD, g.L_XY, -1.0),
    )
    reliefs: list[tuple[float, ...]] = []
    for gear_name, gear, radius, tip, root, origin, sense in sides:
        for name, relief, end in (("tip", gear.tip_relief, tip), ("root", gear.root_relief, root)):
            if relief is None or relief.amount == 0.0:
                continue
            if not root < relief.start_roll_angle * radius < tip:
                raise relief.off(pair.flank(int(gear_name == "gear")), f"{gear_name}.{name}_relief")
            reliefs.append(relief_record(relief, end, radius, origin, sense))
    return np.array(reliefs, RELIEF)
