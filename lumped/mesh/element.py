"""The force between the teeth that mesh at one instant: gap, load, damper and friction of each pair.

This is the only place of the lumped model where an approach of the gears becomes a force. Statics, motions by
momentary load and the linear form call it. Whether teeth are alike or differ, and where they are, is in the
records ``pairs`` and ``line`` that the callers hand in.

Sources: docs/theory/contact_energy.md, "Energy of one pair", "Tip corner", "Neighbours".
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from lumped.compiler import compiled
from lumped.typing import FloatArray

#: Of functions that kernels alone call, and that allocate nothing: counting references would take most of
#: their time, and what Python would call takes as long to compile as the function itself.
inlined = compiled(_nrt=False, forceinline=True, no_cpython_wrapper=True)
#: The same where one kernel calls a function at several places: a copy at each would take long to compile.
called = compiled(_nrt=False, no_cpython_wrapper=True)

#: One record, or an array of records, of a dtype below.
Record = Any
Records = np.ndarray[Any, np.dtype[np.void]]


def record(**fields: str) -> np.dtype[np.void]:
    """A dtype of float fields; the values of the keywords are their meaning.

    Its records have their fields as attributes also where numba is switched off to step through a kernel.
    """
    return np.dtype((np.record, [(name, np.float64) for name in fields]))


#: One tooth pair at one instant, as it is without load. Lengths along the line of action [m].
PAIR = record(
    position="xi, from the pinion's tangent point to the contact",
    stiffness="k at the mean load [N/m]; 0 where the pair is not followed",
    damping="c of a pair that carries its full load [N s/m]",
    friction="mu, signed as the sliding",
    gap="between the flanks, without tip corners",
    gap_slope="of that gap over xi",
    before_start="way of the contact beyond the gear's tip corner, before the start; negative inside",
    behind_end="the same beyond the pinion's tip corner, behind the end",
    before_edge="way of the contact beyond the edge of an undercut pinion, before the start",
    behind_edge="the same beyond the edge of an undercut gear, behind the end",
    tip_pinion="length of the pinion's tip corner on its base tangent",
    tip_gear="the same of the gear",
    edge_pinion="the same of the edge that an undercut of the pinion leaves; 0 without one",
    edge_gear="the same of the gear",
    corner_before="least gap of the corner over the square of that way [1/m]",
    corner_behind="the same behind the end",
)
#: The same pair under an approach of the gears.
CONTACT = record(
    gap="with tip corners",
    gap_by_position="its slope over xi",
    gap_by_approach="its slope over the approach",
    tilt="sine of the angle between the normal at a tip corner and the line of action",
    compression="approach less gap",
    load="elastic load N [N]",
    tangent="its slope over the compression of all pairs together [N/m]",
    residual="of the equation of the load, in the iteration",
    damper_share="share of its damper that acts, where it is asked for",
)
#: Where the flanks of a pair end, positions xi on the line of action without load [m].
FLANKS = record(
    start="of the gear's tip: L_XA, unless an undercut of the pinion ends contact before",
    end="of the pinion's tip: L_XD, unless an undercut of the gear ends contact before",
    length="L_XY",
    edge_pinion="as of PAIR",
    edge_gear="as of PAIR",
    corner_before="as of PAIR [1/m]; 0 is a bound too",
    corner_behind="the same behind the end",
)
#: The line of action at one instant.
LINE = record(
    length="from tangent point to tangent point, loaded bearings included",
    lengthening="that of the loaded bearings alone",
    turn="angle by which eccentric gears turn it; a positive one lets both tips touch further outside [rad]",
    gap_rate="rate of the gap of all pairs by eccentric gears [m/s]",
    moment_pinion="moment of the mesh force on the pinion by its eccentricity, over the force",
    moment_gear="the same of the gear",
)
#: What all pairs together do to the gears, or its part of one kind in the linear form, see ``linearise``.
FORCE = record(
    normal="[N]",
    friction="[N]",
    friction_moment="mu N xi [N m]",
    separating="force of tip corners that pushes the gears apart [N]",
)
#: Rows of FORCE in the linear form: per approach, per rate of the approach, and what is left without either.
BY_APPROACH, BY_RATE, AT_REST = range(3)
#: Most steps of an iteration.
_MOST_STEPS = 200
#: Change of the loads in a Newton step, over their sum, that ends the iteration: quick, where loads are
#: wanted, whose error is its square; exact, where tangents are fitted, whose error it is.
QUICK = 1e-8
EXACT = 1e-13


class ContactLaw(NamedTuple):
    """Load N of a pair over its compression p: p = N (1/k - D/2 ln((N^2 + N_1^2)/F^2)).

    Attributes
    ----------
    force : F, at which k holds: the mean mesh force [N]
    softening : D of Hertz's contact; 0 is a linear spring [m/N]
    linear_below : N_1 [N]
    converged : relative change that ends the iteration of the loads: QUICK or EXACT
    full_damper : load from which on the damper of a pair acts fully [N]
    coupled : whether the load of a pair moves its neighbours
    apart : compression below which no neighbour brings a pair into contact, 0 or less [m]
    windows : prescribed contact: every pair touches in its window of the path, without tip corners
    radius_pinion, radius_gear : base radii [m]
    rolling_speed : rate of xi [m/s]
    """

    force: float
    softening: float
    linear_below: float
    converged: float
    full_damper: float
    coupled: bool
    apart: float
    windows: bool
    radius_pinion: float
    radius_gear: float
    rolling_speed: float


class CornerGap(NamedTuple):
    """Gap of a tip corner from the mate's flank [m], its slope over the way beyond, and the tilt there."""

    gap: float
    slope: float
    tilt: float


class FlankEnd(NamedTuple):
    """Gap where the flanks end in a tip corner and, of undercut mates, in an edge [m], and the tilt there.

    Its slopes are those over the own flank distance of the gear with the tip, and of that with the edge; one
    of them is 0.
    """

    gap: float
    tip_slope: float
    edge_slope: float
    tilt: float


class MeshForce(NamedTuple):
    """What all pairs together do to the gears: fields of FORCE, and what the dampers take [W]."""

    normal: float
    friction: float
    friction_moment: float
    separating: float
    damper_power: float


@inlined
def place_pair(pair: Record, position: float, flanks: Record, line: Record, law: ContactLaw) -> None:
    """Put a pair at a position, between the ends of its flanks."""
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


@called
def corner_gap(beyond: float, tip: float, length: float, flank_radius: float, tip_radius: float) -> CornerGap:
    """Gap of a tip corner from the mate's flank, ``beyond`` its first contact.

    Axes from the flank's tangent point: t along the line of action, n away from the flank's centre.
    ``tip`` is the length of the corner on its base tangent, ``length`` that of the line of action.
    """
    turn = beyond / tip_radius
    sine, cosine = math.sin(turn), math.cos(turn)
    t = length - tip_radius * sine - tip * cosine
    n = 2.0 * tip_radius * math.sin(0.5 * turn) ** 2 + tip * sine
    tangent = math.sqrt(max(t * t + n * (n + 2.0 * flank_radius), 0.0))
    angle = math.atan2(t, n + flank_radius) - math.atan2(tangent, flank_radius)
    t_rate = (tip * sine - tip_radius * cosine) / tip_radius
    n_rate = (tip_radius * sine + tip * cosine) / tip_radius
    slope = math.cos(angle) * t_rate - math.sin(angle) * n_rate + 1.0
    return CornerGap(tangent + flank_radius * angle - (length - tip - beyond), slope, -math.sin(angle))


@called
def tip_touches(
    beyond: float, tip: float, back: float, edge: float, length: float, flank_radius: float, tip_radius: float
) -> bool:
    """Whether a tip corner can decide the gap of ``flank_end``.

    It can beyond its first contact. A corner that passes the tangent point has none: it can as soon as it is
    outside the edge, and before that its gap is smaller than the edge's, from half the edge's length on.
    """
    if beyond > 0.0:
        return True
    if tip <= length or back <= 0.0 or edge <= 0.0:
        return False
    turn = beyond / tip_radius
    t = length - tip_radius * math.sin(turn) - tip * math.cos(turn)
    n = 2.0 * tip_radius * math.sin(0.5 * turn) ** 2 + tip * math.sin(turn)
    return t * t + n * (n + 2.0 * flank_radius) > 0.25 * edge * edge


@called
def flank_end(
    beyond: float, tip: float, back: float, edge: float, length: float, flank_radius: float, tip_radius: float
) -> FlankEnd:
    """Gap of a contact ``beyond`` the tip corner of one gear and ``back`` from the edge of the other [m].

    The mate of the tip corner is the gear with the edge, whose undercut ends its flank there: of both gaps
    the larger is left. Lengths as of ``corner_gap``; an ``edge`` of 0 is none.
    """
    gap = slope = tilt = 0.0
    if tip_touches(beyond, tip, back, edge, length, flank_radius, tip_radius):
        gap, slope, tilt = corner_gap(beyond, tip, length, flank_radius, tip_radius)
    if edge > 0.0 and back > 0.0:
        other = corner_gap(-back, edge, length, tip_radius, flank_radius)
        if other.gap > gap:
            return FlankEnd(other.gap, 0.0, other.slope, other.tilt)
    return FlankEnd(gap, slope, 0.0, tilt)


@called
def tip_decides(
    beyond: float, tip: float, back: float, edge: float, length: float, flank_radius: float, tip_radius: float
) -> float:
    """Positive where the tip corner decides the gap of ``flank_end``, and passes 0 where it begins to [m]."""
    if edge <= 0.0:
        return beyond
    of_tip = min(beyond, 0.0)
    of_edge = 0.0
    if tip_touches(beyond, tip, back, edge, length, flank_radius, tip_radius):
        gap = corner_gap(beyond, tip, length, flank_radius, tip_radius).gap
        of_tip = math.sqrt(max(gap, 0.0) * tip_radius)
    if back > 0.0:
        gap = corner_gap(-back, edge, length, tip_radius, flank_radius).gap
        of_edge = math.sqrt(max(gap, 0.0) * tip_radius)
    return of_tip - of_edge


@inlined
def ways_beyond(pair: Record, approach: float, line: Record) -> tuple[float, float]:
    """Ways of the contact beyond the tip corners of gear and pinion [m]; inside both are negative.

    Deflected teeth touch further outside by half of what the approach and the bearings add.
    """
    half = 0.5 * (approach + line.lengthening)
    return pair.before_start + half, pair.behind_end + half


@inlined
def ways_back(pair: Record, approach: float, line: Record) -> tuple[float, float]:
    """Ways of the contact back from the edges of undercut pinion and gear [m]; inside both are negative.

    Deflected teeth touch further up the flanks by half of what the approach and the bearings add.
    """
    half = 0.5 * (approach + line.lengthening)
    return pair.before_edge - half, pair.behind_edge - half


@inlined
def deciding_tips(pair: Record, approach: float, line: Record, law: ContactLaw) -> tuple[float, float]:
    """``tip_decides`` of a pair at the start and at the end of its flanks."""
    before, behind = ways_beyond(pair, approach, line)
    first, last = ways_back(pair, approach, line)
    return (
        tip_decides(
            before, pair.tip_gear, first, pair.edge_pinion, line.length, law.radius_pinion, law.radius_gear
        ),
        tip_decides(
            behind, pair.tip_pinion, last, pair.edge_gear, line.length, law.radius_gear, law.radius_pinion
        ),
    )


@inlined
def ends_of_pair(pair: Record, approach: float, line: Record, law: ContactLaw) -> tuple[FlankEnd, FlankEnd]:
    """Gaps of a pair at the start and at the end of its flanks."""
    before, behind = ways_beyond(pair, approach, line)
    first, last = ways_back(pair, approach, line)
    return (
        flank_end(
            before, pair.tip_gear, first, pair.edge_pinion, line.length, law.radius_pinion, law.radius_gear
        ),
        flank_end(
            behind, pair.tip_pinion, last, pair.edge_gear, line.length, law.radius_gear, law.radius_pinion
        ),
    )


@inlined
def open_gap(pair: Record, approach: float, line: Record, law: ContactLaw, contact: Record) -> None:
    """Write gap, its slopes, tilt and compression of a pair at an approach."""
    contact.gap = pair.gap
    contact.gap_by_position = pair.gap_slope
    contact.gap_by_approach = 0.0
    contact.tilt = 0.0
    start, end = ends_of_pair(pair, approach, line, law)
    contact.gap += start.gap + end.gap
    contact.gap_by_position += (start.edge_slope - start.tip_slope) + (end.tip_slope - end.edge_slope)
    contact.gap_by_approach += 0.5 * (start.tip_slope + start.edge_slope + end.tip_slope + end.edge_slope)
    contact.tilt += start.tilt + end.tilt
    contact.compression = approach - contact.gap


@inlined
def close_gap(pair: Record, approach: float, line: Record, law: ContactLaw, contact: Record) -> None:
    """``open_gap``, but for the corner of a pair that is surely apart: its compression is a bound then."""
    before, behind = ways_beyond(pair, approach, line)
    least = pair.corner_before * max(before, 0.0) ** 2 + pair.corner_behind * max(behind, 0.0) ** 2
    contact.compression = approach - pair.gap - least
    if contact.compression > law.apart:
        open_gap(pair, approach, line, law, contact)


@inlined
def compliances(load: float, stiffness: float, law: ContactLaw) -> tuple[float, float]:
    """Compression over load, and slope of the compression over the load [m/N]."""
    if law.softening == 0.0:
        return 1.0 / stiffness, 1.0 / stiffness
    square = load * load + law.linear_below**2
    secant = 1.0 / stiffness - 0.5 * law.softening * math.log(square / law.force**2)
    return secant, secant - law.softening * load * load / square


@inlined
def single_load(stiffness: float, law: ContactLaw, contact: Record) -> None:
    """Elastic load of a pair that no neighbour moves, by Newton steps from the load that ``contact`` has."""
    if contact.compression <= 0.0:
        contact.load = 0.0
        contact.tangent = 0.0
        return
    if law.softening == 0.0:
        contact.load = stiffness * contact.compression
        contact.tangent = stiffness
        return
    if contact.load <= 0.0:
        contact.load = stiffness * contact.compression
    for _ in range(_MOST_STEPS):
        secant, slope = compliances(contact.load, stiffness, law)
        change = (contact.load * secant - contact.compression) / slope
        contact.load -= change
        contact.tangent = 1.0 / slope
        if abs(change) <= law.converged * contact.load:
            break


@inlined
def coupled_loads(
    pairs: Records, law: ContactLaw, coupling: FloatArray, matrix: FloatArray, contacts: Records
) -> None:
    """Elastic loads of pairs that move each other, by Newton steps from those that ``contacts`` have.

    p_i = N_i c(N_i) + sum_j w_ij N_j of the pairs that press, w the ``coupling`` [m/N]; ``matrix`` is the
    place for the matrix of these equations.
    """
    count = pairs.size
    for _ in range(_MOST_STEPS):
        for i in range(count):
            contact = contacts[i]
            left = contact.compression
            for j in range(count):
                left -= coupling[i, j] * contacts[j].load
                matrix[i, j] = 0.0
            matrix[i, i] = 1.0
            contact.residual = 0.0
            contact.tangent = 0.0
            if left > 0.0 or contact.load > 0.0:
                secant, slope = compliances(contact.load, pairs[i].stiffness, law)
                for j in range(count):
                    matrix[i, j] = coupling[i, j]
                matrix[i, i] = slope
                contact.residual = left - contact.load * secant
                contact.tangent = 1.0
        eliminate(matrix, contacts)
        change = total = 0.0
        for i in range(count):
            load = max(contacts[i].load + contacts[i].residual, 0.0)
            change += abs(load - contacts[i].load)
            total += load
            contacts[i].load = load
        if change <= law.converged * total:
            break
    for i in range(count):
        if contacts[i].load == 0.0:
            contacts[i].tangent = 0.0


@inlined
def eliminate(matrix: FloatArray, contacts: Records) -> None:
    """Solve for ``residual`` and ``tangent`` in place; the matrix is positive definite: no pivots."""
    count = contacts.size
    for i in range(count):
        for row in range(i + 1, count):
            factor = matrix[row, i] / matrix[i, i]
            if factor != 0.0:
                for column in range(i + 1, count):
                    matrix[row, column] -= factor * matrix[i, column]
                contacts[row].residual -= factor * contacts[i].residual
                contacts[row].tangent -= factor * contacts[i].tangent
    for i in range(count - 1, -1, -1):
        for column in range(i + 1, count):
            contacts[i].residual -= matrix[i, column] * contacts[column].residual
            contacts[i].tangent -= matrix[i, column] * contacts[column].tangent
        contacts[i].residual /= matrix[i, i]
        contacts[i].tangent /= matrix[i, i]


@inlined
def window_load(pair: Record, approach: float, contact: Record) -> None:
    """Load of a pair with prescribed contact: a spring in its window, which can pull."""
    contact.gap = pair.gap
    contact.gap_by_position = pair.gap_slope
    contact.gap_by_approach = 0.0
    contact.tilt = 0.0
    contact.compression = approach - pair.gap
    contact.load = pair.stiffness * contact.compression
    contact.tangent = pair.stiffness


@inlined
def share_load(
    approach: float,
    pairs: Records,
    line: Record,
    law: ContactLaw,
    coupling: FloatArray,
    matrix: FloatArray,
    contacts: Records,
) -> None:
    """Gaps and elastic loads of all pairs at an approach, into ``contacts``, from the loads there."""
    for i in range(pairs.size):
        pair = pairs[i]
        contact = contacts[i]
        if pair.stiffness <= 0.0:
            contact.compression = 0.0
            contact.load = 0.0
            contact.tangent = 0.0
        elif law.windows:
            window_load(pair, approach, contact)
        else:
            close_gap(pair, approach, line, law, contact)
            if not law.coupled:
                single_load(pair.stiffness, law, contact)
    if law.coupled and not law.windows:
        coupled_loads(pairs, law, coupling, matrix, contacts)


@inlined
def acts(pair: Record, contact: Record, law: ContactLaw) -> bool:
    """Whether a pair takes part: it presses, or it is in its window."""
    return contact.load > 0.0 or (law.windows and pair.stiffness > 0.0)


@inlined
def damper_share(load: float, law: ContactLaw) -> float:
    """Share of its damper that a pair with this elastic load has: a smooth step; all of it in windows."""
    if law.windows:
        return 1.0
    share = min(max(load / law.full_damper, 0.0), 1.0)
    return share * share * (3.0 - 2.0 * share)


@inlined
def rolling_rate(contact: Record, line: Record, law: ContactLaw) -> float:
    """Rate at which the gap of a pair grows as the teeth roll, at a constant approach [m/s]."""
    rate: float = contact.gap_by_position * law.rolling_speed + line.gap_rate
    return rate


@inlined
def mesh_force(
    closing: float, pairs: Records, line: Record, law: ContactLaw, contacts: Records, normal: FloatArray
) -> MeshForce:
    """Forces of all pairs whose elastic loads are known, at a rate of the approach; teeth only push.

    N = max(N_el + c p', 0); the damper is N - N_el, also while teeth that do not pull cut the load, so that
    what it takes, (N - N_el) p', is all that the energy of the pairs loses. ``normal`` receives each load.
    """
    total = friction = moment = separating = power = 0.0
    for i in range(pairs.size):
        pair = pairs[i]
        contact = contacts[i]
        normal[i] = 0.0
        if not acts(pair, contact, law):
            continue
        damping = pair.damping * damper_share(contact.load, law)
        compression_rate = closing * (1.0 - contact.gap_by_approach) - rolling_rate(contact, line, law)
        load = max(contact.load + damping * compression_rate, 0.0)
        if load > 0.0 or contact.load > 0.0:
            power += (load - contact.load) * compression_rate
        normal[i] = load
        total += load
        friction += pair.friction * load
        moment += pair.friction * load * pair.position
        separating += contact.tilt * load
    return MeshForce(total, friction, moment, separating, power)


@called
def static_approach(
    guess: float,
    tolerance: float,
    force: float,
    pairs: Records,
    line: Record,
    law: ContactLaw,
    coupling: FloatArray,
    matrix: FloatArray,
    contacts: Records,
) -> float:
    """Approach at which the elastic loads make a force [m], or NaN; ``contacts`` are those there.

    Newton steps in a bracket, from a guess until force or approach is met to the relative tolerance.
    """
    stiffest = 1e-300
    for i in range(pairs.size):
        stiffest = max(stiffest, pairs[i].stiffness)
    scale = force / stiffest
    low = -math.inf
    high = math.inf
    approach = guess
    reach = 2.0 * scale  # of the next step outwards; it doubles, as a light load is far smaller than the gaps
    for _ in range(_MOST_STEPS):
        share_load(approach, pairs, line, law, coupling, matrix, contacts)
        excess = -force
        slope = 0.0
        for i in range(pairs.size):
            excess += contacts[i].load
            if contacts[i].load > 0.0:
                slope += contacts[i].tangent * (1.0 - contacts[i].gap_by_approach)
        if abs(excess) <= tolerance * force:
            return approach
        if excess < 0.0:
            low = approach
        else:
            high = approach
        following = approach - excess / slope if slope > 0.0 else math.inf
        if not low < following < high:  # bisect, or go on until the root is between two approaches
            if low > -math.inf and high < math.inf:
                following = 0.5 * (low + high)
            else:
                following = approach + (reach if excess < 0.0 else -reach)
                reach *= 2.0
        change = abs(following - approach)
        if change <= tolerance * (abs(approach) + scale):
            return approach
        approach = following
    return math.nan


@inlined
def add_force(force: Record, normal: float, pair: Record, tilt: float) -> None:
    """Add what a pair with this normal load does to the gears."""
    force.normal += normal
    force.friction += pair.friction * normal
    force.friction_moment += pair.friction * normal * pair.position
    force.separating += tilt * normal


@inlined
def clear_force(force: Record) -> None:
    """No force."""
    force.normal = 0.0
    force.friction = 0.0
    force.friction_moment = 0.0
    force.separating = 0.0
