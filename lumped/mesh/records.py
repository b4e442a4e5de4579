"""The records of the mesh: a tooth pair, its contact, the line of action and the force on the gears.

Every compiled function of this folder reads and writes these records. A record is one entry of a numpy array
with named fields, so a formula says ``pair.stiffness`` and no function knows a column by its number.

Sources: docs/theory/contact_energy.md, "Energy of one pair"; docs/theory/mesh_physics.md.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from lumped.compiler import inlined

#: One record, or an array of records, of a dtype below.
Record = Any
Records = np.ndarray[Any, np.dtype[np.void]]


def record(**fields: str) -> np.dtype[np.void]:
    """Return a dtype with one float field for each keyword; the value of a keyword explains its field.

    The scalar type is ``numpy.record``: fields are attributes also where numba is switched off for debugging.
    """
    return np.dtype((np.record, [(name, np.float64) for name in fields]))


#: One tooth pair at one instant, without load. All lengths are along the line of action [m].
PAIR = record(
    position="xi, from the pinion's tangent point to the contact",
    stiffness="k at the mean load [N/m]; 0 where the pair is too far from its path to be computed",
    damping="c of a pair that carries its full load [N s/m]",
    mu="friction coefficient mu, with the sign of the sliding",
    gap="gap between the flanks, without tip corners",
    gap_slope="slope of that gap over xi",
    before_start="distance of the contact beyond the gear's tip corner, before the start; negative inside",
    behind_end="distance of the contact beyond the pinion's tip corner, behind the end; negative inside",
    before_edge="distance of the contact beyond the edge of an undercut pinion, before the start",
    behind_edge="distance of the contact beyond the edge of an undercut gear, behind the end",
    tip_pinion="length of the pinion's tip corner on its base tangent",
    tip_gear="length of the gear's tip corner on its base tangent",
    edge_pinion="length of the edge that an undercut leaves on the pinion's flank; 0 without an undercut",
    edge_gear="length of the edge that an undercut leaves on the gear's flank; 0 without an undercut",
    corner_before="lower bound of the corner's gap over the square of ``before_start`` [1/m]",
    corner_behind="lower bound of the corner's gap over the square of ``behind_end`` [1/m]",
)
#: The contact of one tooth pair at one approach of the gears.
CONTACT = record(
    gap="gap of the pair, tip corners included [m]",
    gap_by_position="slope of the gap over xi",
    gap_by_approach="slope of the gap over the approach",
    tilt="sine of the angle between the normal at a tip corner and the line of action",
    compression="approach less gap [m]",
    load="elastic load N_el [N]",
    tangent="slope of the load over a compression that all pairs share [N/m]",
    residual="residual of the load's equation; after ``element.eliminate`` the change of the load [N]",
    damper_share="share of the damper that acts; only ``statics.middle_contacts`` writes it",
)
#: Where the flanks of a tooth pair end: positions xi on the line of action without load [m].
FLANKS = record(
    start="end of the gear's tip: L_XA, unless an undercut of the pinion ends contact earlier",
    end="end of the pinion's tip: L_XD, unless an undercut of the gear ends contact earlier",
    length="L_XY, length of the line of action",
    edge_pinion="as in PAIR",
    edge_gear="as in PAIR",
    corner_before="as in PAIR [1/m]; 0 is a valid lower bound",
    corner_behind="as in PAIR [1/m]; 0 is a valid lower bound",
)
#: The line of action at one instant.
LINE = record(
    length="distance between the tangent points, with the deflection of the bearings [m]",
    lengthening="part of that length which the deflection of the bearings adds [m]",
    turn="angle by which eccentric gears turn the line [rad]; a positive one lets tips touch further out",
    gap_rate="rate at which eccentric gears open the gap of every pair [m/s]",
    moment_pinion="lever arm that the pinion's eccentricity gives the mesh force [m]",
    moment_gear="lever arm that the gear's eccentricity gives the mesh force [m]",
)
#: The force of all pairs on the gears, or one row of the linear form, see ``linear.linearise``.
FORCE = record(
    normal="sum of N [N]",
    friction_force="sum of mu N [N]",
    friction_moment="sum of mu N xi [N m]",
    separating="force of tip corners that pushes the gears apart [N]",
)
#: Rows of FORCE in the linear form: per approach, per rate of the approach, and the part without either.
BY_APPROACH, BY_RATE, AT_REST = range(3)
#: Relative change of the loads in one Newton step that ends the iteration. QUICK is enough for loads, because
#: their error is the square of the last change. Tangents that are fitted carry the change itself: EXACT.
QUICK = 1e-8
EXACT = 1e-13


class ContactLaw(NamedTuple):
    """Law of the contact: load N of a pair over its compression p.

    p = N (1/k - D/2 ln((N^2 + N_1^2)/F^2))

    Attributes
    ----------
    force : F, the mean mesh force, at which k holds [N]
    softening : D of Hertz's contact; 0 makes the pair a linear spring [m/N]
    linear_below : N_1 [N]
    converged : relative change that ends the iteration of the loads: QUICK or EXACT
    full_damper : load above which the whole damper of a pair acts [N]
    coupled : whether the load of a pair moves its neighbours; never with prescribed contact
    apart_below : compression below which no neighbour can bring a pair into contact, 0 or less [m]
    prescribed : prescribed contact: every pair touches inside its window of the path, without tip corners
    radius_pinion, radius_gear : base radii [m]
    rolling_speed : rate of xi [m/s]
    """

    force: float
    softening: float
    linear_below: float
    converged: float
    full_damper: float
    coupled: bool
    apart_below: float
    prescribed: bool
    radius_pinion: float
    radius_gear: float
    rolling_speed: float


@inlined
def add_force(force: Record, normal: float, pair: Record, tilt: float) -> None:
    """Add the force of one pair with a normal load N to the force on the gears."""
    force.normal += normal
    force.friction_force += pair.mu * normal
    force.friction_moment += pair.mu * normal * pair.position
    force.separating += tilt * normal


@inlined
def clear_force(force: Record) -> None:
    """Set all fields of a force to zero."""
    force.normal = 0.0
    force.friction_force = 0.0
    force.friction_moment = 0.0
    force.separating = 0.0
