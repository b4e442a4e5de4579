"""Tip corners: where the flanks of a tooth pair end, and where a tip corner begins to push.

Flanks end where the tip corner of one gear leaves the flank of the mate. Beyond this end the tip has a gap
from the flank. An undercut mate has an edge at the end of its own flank, and the edge has a gap, too; the
larger of the two gaps counts. ``write_gap`` in ``lumped/mesh/element.py`` adds it to the gap that the errors
of the teeth leave. A corner pushes where the approach of the gears exceeds the sum: the compression is
positive then.

Sources: docs/theory/contact_energy.md, "Tip corner".
"""

from __future__ import annotations

import math
from typing import NamedTuple

from lumped.compiler import called, inlined
from lumped.mesh.records import ContactLaw, Record


class FlankEnd(NamedTuple):
    """One end of the flanks of a tooth pair. The mate is the gear whose flank the tip corner leaves.

    Attributes
    ----------
    beyond_tip : distance of the contact beyond the first contact of the tip corner; negative inside [m]
    tip : length of the tip corner on its base tangent [m]
    beyond_edge : distance of the contact beyond the edge of an undercut mate; negative inside [m]
    edge : length of this edge on the mate's base tangent; 0 where the mate has no undercut [m]
    line : length of the line of action [m]
    flank_radius : base radius of the mate [m]
    tip_radius : base radius of the gear with the tip corner [m]
    """

    beyond_tip: float
    tip: float
    beyond_edge: float
    edge: float
    line: float
    flank_radius: float
    tip_radius: float


class CornerPoint(NamedTuple):
    """Place of a corner. Axes start at the flank's tangent point.

    Attributes
    ----------
    t : coordinate along the line of action [m]
    n : coordinate across it, away from the centre of the flank's gear [m]
    sine, cosine : of the angle by which the corner's gear has turned since the corner's first contact
    """

    t: float
    n: float
    sine: float
    cosine: float


class CornerGap(NamedTuple):
    """Gap of one corner from the mate's flank.

    Attributes
    ----------
    gap : [m]
    slope : slope of the gap over the distance beyond the first contact [-]
    tilt : sine of the angle between the normal at the corner and the line of action [-]
    """

    gap: float
    slope: float
    tilt: float


class FlankEndGap(NamedTuple):
    """Gap at one end of the flanks: the larger of the gaps of tip corner and edge. One of the slopes is 0.

    Attributes
    ----------
    gap : [m]
    tip_slope : slope of the gap over ``FlankEnd.beyond_tip``, where the tip corner has the larger gap [-]
    edge_slope : slope of the gap over minus ``FlankEnd.beyond_edge``, where the edge has the larger gap [-]
    tilt : sine of the angle between the normal at the corner and the line of action [-]
    """

    gap: float
    tip_slope: float
    edge_slope: float
    tilt: float


@inlined
def place_pair(pair: Record, position: float, flanks: Record, line: Record, law: ContactLaw) -> None:
    """Write the position xi of a pair, and its distances from the ends of the flanks without load."""
    pair.position = position
    pair.before_start = flanks.start - position + law.radius_gear * line.turn
    pair.behind_end = position - flanks.end + law.radius_pinion * line.turn
    pair.before_edge = flanks.edge_pinion - position - law.radius_pinion * line.turn
    pair.behind_edge = flanks.edge_gear - (flanks.length - position) - law.radius_gear * line.turn
    pair.tip_pinion = flanks.end
    pair.tip_gear = flanks.length - flanks.start
    pair.edge_pinion = flanks.edge_pinion
    pair.edge_gear = flanks.edge_gear
    pair.corner_before = flanks.corner_before
    pair.corner_behind = flanks.corner_behind


@inlined
def half_way_out(approach: float, line: Record) -> float:
    """Distance by which deflected teeth touch further out [m]: half of approach and bearing deflection."""
    half: float = 0.5 * (approach + line.lengthening)
    return half


@inlined
def start_of_flanks(pair: Record, approach: float, line: Record, law: ContactLaw) -> FlankEnd:
    """Return the end before A: the gear's tip corner on the pinion's flank, at an approach of the gears."""
    half = half_way_out(approach, line)
    return FlankEnd(
        beyond_tip=pair.before_start + half,
        tip=pair.tip_gear,
        beyond_edge=pair.before_edge - half,
        edge=pair.edge_pinion,
        line=line.length,
        flank_radius=law.radius_pinion,
        tip_radius=law.radius_gear,
    )


@inlined
def end_of_flanks(pair: Record, approach: float, line: Record, law: ContactLaw) -> FlankEnd:
    """Return the end behind D: the pinion's tip corner on the gear's flank, at an approach of the gears."""
    half = half_way_out(approach, line)
    return FlankEnd(
        beyond_tip=pair.behind_end + half,
        tip=pair.tip_pinion,
        beyond_edge=pair.behind_edge - half,
        edge=pair.edge_gear,
        line=line.length,
        flank_radius=law.radius_gear,
        tip_radius=law.radius_pinion,
    )


@inlined
def corner_point(beyond: float, corner: float, line: float, corner_radius: float) -> CornerPoint:
    """Place of a corner that has moved ``beyond`` its first contact with the flank [m]."""
    turn = beyond / corner_radius
    sine = math.sin(turn)
    cosine = math.cos(turn)
    t = line - corner_radius * sine - corner * cosine
    n = 2.0 * corner_radius * math.sin(0.5 * turn) ** 2 + corner * sine
    return CornerPoint(t, n, sine, cosine)


@called
def corner_gap(
    beyond: float, corner: float, line: float, flank_radius: float, corner_radius: float
) -> CornerGap:
    """Gap of a corner, ``beyond`` its first contact [m], from the flank of the other gear.

    The gap is measured on the tangent from the corner to the base circle of the flank's gear.

    Parameters
    ----------
    beyond : distance of the contact beyond the first contact of the corner [m]
    corner : length of the corner on the base tangent of its own gear [m]
    line : length of the line of action [m]
    flank_radius, corner_radius : base radii of the gears with the flank and with the corner [m]
    """
    t, n, sine, cosine = corner_point(beyond, corner, line, corner_radius)
    tangent = math.sqrt(max(t * t + n * (n + 2.0 * flank_radius), 0.0))
    angle = math.atan2(t, n + flank_radius) - math.atan2(tangent, flank_radius)
    t_rate = (corner * sine - corner_radius * cosine) / corner_radius
    n_rate = (corner_radius * sine + corner * cosine) / corner_radius
    slope = math.cos(angle) * t_rate - math.sin(angle) * n_rate + 1.0
    return CornerGap(tangent + flank_radius * angle - (line - corner - beyond), slope, -math.sin(angle))


@inlined
def tip_gap(end: FlankEnd) -> CornerGap:
    """Gap of the tip corner from the mate's flank."""
    return corner_gap(end.beyond_tip, end.tip, end.line, end.flank_radius, end.tip_radius)


@inlined
def edge_gap(end: FlankEnd) -> CornerGap:
    """Gap of the mate's edge from the flank of the gear with the tip. Its slope is over -``beyond_edge``."""
    return corner_gap(-end.beyond_edge, end.edge, end.line, end.tip_radius, end.flank_radius)


@called
def tip_faces_flank(end: FlankEnd) -> bool:
    """Whether the tip corner faces the mate's flank, so that its gap counts in ``flank_end_gap``.

    A tip corner faces the flank beyond its first contact. A tip that reaches past the mate's tangent point
    has no first contact. Such a tip faces the flank as soon as it is outside the edge. The test here begins
    at half the edge's length already: there the gap of the tip is still smaller than the gap of the edge.
    """
    if end.beyond_tip > 0.0:
        return True
    if end.tip <= end.line or end.beyond_edge <= 0.0 or end.edge <= 0.0:
        return False
    point = corner_point(end.beyond_tip, end.tip, end.line, end.tip_radius)
    t = point.t
    n = point.n
    return t * t + n * (n + 2.0 * end.flank_radius) > 0.25 * end.edge * end.edge


@called
def flank_end_gap(end: FlankEnd) -> FlankEndGap:
    """Gap at one end of the flanks: the larger gap of tip corner and edge; 0 inside the flanks."""
    gap = 0.0
    slope = 0.0
    tilt = 0.0
    if tip_faces_flank(end):
        gap, slope, tilt = tip_gap(end)
    if end.edge > 0.0 and end.beyond_edge > 0.0:
        edge = edge_gap(end)
        if edge.gap > gap:
            return FlankEndGap(edge.gap, 0.0, edge.slope, edge.tilt)
    return FlankEndGap(gap, slope, 0.0, tilt)


@inlined
def gap_unless_inside(end: FlankEnd) -> FlankEndGap:
    """Gap as of ``flank_end_gap``, without a call where neither tip corner nor edge is at the contact."""
    if end.beyond_tip <= 0.0 and (end.edge <= 0.0 or end.beyond_edge <= 0.0):
        return FlankEndGap(0.0, 0.0, 0.0, 0.0)
    return flank_end_gap(end)


@called
def tip_minus_edge(end: FlankEnd) -> float:
    """Positive where the tip corner has the larger gap of tip corner and edge; 0 where they exchange [m].

    Gaps grow with the square of the distance beyond, so the difference is that of the roots of both gaps.
    Without an edge it is the distance beyond the tip: 0 where the tip corner leaves the flank.
    """
    if end.edge <= 0.0:
        return end.beyond_tip
    root_of_tip = min(end.beyond_tip, 0.0)
    root_of_edge = 0.0
    if tip_faces_flank(end):
        root_of_tip = math.sqrt(max(tip_gap(end).gap, 0.0) * end.tip_radius)
    if end.beyond_edge > 0.0:
        root_of_edge = math.sqrt(max(edge_gap(end).gap, 0.0) * end.tip_radius)
    return root_of_tip - root_of_edge
