"""When the contact force will next jump or bend: a tooth enters or leaves, passes a switch, or sliding turns.

A step that straddles a jump of the force is no longer of the integrator's order. The Taylor polynomial of the
motion says when that will be, so that the integrator can stop there and start again behind it. A wrong
prediction costs time and nothing else: the force does not depend on it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from lumped.compiler import compiled
from lumped.path_function import PathFunction
from lumped.typing import FloatArray
from multibody.contact import kinematics as kn
from multibody.contact.elements import GRADUAL, compliances, coupling_at, relief_at
from multibody.contact.kernels import contact_forces
from multibody.contact.kinematics import (
    DRIVE,
    Line,
    corner_gap,
    corner_reach,
    mesh_position,
    overlap_rate,
    sliding_velocity,
    wrap,
)

#: Kinds of events, the first column of an event table; the second is the place xi [m] of the last two.
ENTRY = 0.0
EXIT = 1.0
SWITCH = 2.0
SLIDING = 3.0
#: First touch of a tip corner before the path of contact, where its damper lets one behind it go, and last
#: touch; of letting go the second column is the stiffness there [N/m].
FIRST_TOUCH = 4.0
LET_GO = 5.0
LAST_TOUCH = 6.0
#: Length of an ordinary step over the base pitch. Where the jumps of a law and its first two derivatives come
#: to less than this share of its largest value within a step, nothing happens.
_STEP = 0.005
_NEGLIGIBLE = 1e-6
#: Most switches of the stiffness per mesh cycle at which to stop, the largest; to stop at each of a table's
#: hundreds would cost more than it saves.
_MOST_SWITCHES = 12
#: A prediction is repeated until it moves by less than this share of the mesh cycle, or so often.
_SHARP = 1e-13
_MOST_ITERATIONS = 10
#: The same where the force only bends; and how often the place of a touch beyond the tips is corrected by
#: what the loads there move.
_BENDS = 1e-10
_PLACES = 2


def event_table(
    stiffness: PathFunction,
    bends: Sequence[float],
    friction: Sequence[tuple[bool, float]],
    pitch: float,
    *,
    corners: bool = False,
) -> FloatArray:
    """Rows (kind, place) of what makes the force jump or bend once per mesh cycle, (n, 2).

    bends : where a relief starts [m]
    friction : jumps and kinks of the friction law, as ``friction_switches`` gives them
    corners : whether tip corners touch beyond the path of contact
    """
    step = _STEP * pitch
    sizes = {
        place: _change(stiffness, int(np.searchsorted(stiffness.breaks, place)), step)
        for place in stiffness.switches.tolist()
    }
    largest = [place for place in sorted(sizes, key=lambda at: -sizes[at]) if sizes[place] > _NEGLIGIBLE]
    rows = [(SLIDING if moves else SWITCH, place) for moves, place in friction]
    rows += [(SWITCH, place) for place in {*bends, *largest[:_MOST_SWITCHES]}]
    low, high = stiffness.interval
    inside = np.array([low + step, high - step])
    if stiffness(inside).any():  # the damping, as sqrt(k), bends also where k starts from 0
        rows += [(ENTRY, 0.0), (EXIT, 0.0)]
    if corners:
        ends = stiffness(np.array([low, np.nextafter(high, low)]))
        rows += [(FIRST_TOUCH, 0.0), (LET_GO, float(ends[1])), (LAST_TOUCH, 0.0)]
        least = _NEGLIGIBLE * float(np.abs(stiffness(stiffness.breaks[:-1])).max())
        bent = np.abs(stiffness(inside) - ends) > least  # beyond, k keeps its value, and so does a relief
        rows += [(SWITCH, at) for at, one in zip((low, high), bent, strict=True) if one or bends]
    return np.array(rows, dtype=float).reshape(-1, 2)


def _change(law: PathFunction, j: int, step: float) -> float:
    """Bound on the difference, a step away, of the polynomials that meet at break j, over the largest value.

    It sums the jumps of value, slope and curvature. Outside its path of contact a law is zero.
    """
    total = 0.0
    for order in range(3):
        before = after = 0.0
        if j > 0:
            width = law.breaks[j] - law.breaks[j - 1]
            before = float(np.polyval(np.polyder(law.coefficients[:, j - 1], order), width))
        if j < law.breaks.size - 1:
            after = float(np.polyval(np.polyder(law.coefficients[:, j], order), 0.0))
        total += abs(after - before) * step**order / math.factorial(order)
    largest = float(np.abs(law(law.breaks[:-1])).max())
    return total / largest if largest > 0.0 else 0.0


@compiled
def edge_reach(gap: float, edge: float, length: float, radius: float) -> float:
    """About how far back from an edge a gap is closed [m], to the leading order of ``corner_off``."""
    bend = (edge / radius) ** 2 * (1.0 / edge + 1.0 / (length - edge))
    return math.sqrt(2.0 * max(gap, 0.0) / bend)


@compiled
def let_go(gap: float, stiffness: float, line: Line, v: FloatArray, p: FloatArray, flags: int) -> float:
    """How far beyond D the pinion's tip corner, the flanks pressed by ``gap``, lets go [m].

    There the damper pulls as the spring presses: at the load c u, u the rate at which the compression falls,
    or where it acts with the share x^2 (3 - 2 x) at x N_f, where c u x (3 - 2 x) = N_f.
    """
    rp = line.radius_p
    rg = line.radius_g
    tip = p[kn.TIP_P]
    length = line.length
    vx, vy = v[0] - v[3], v[1] - v[4]
    omega_p, omega_g = v[2] - p[kn.OMEGA_P], v[5] + p[kn.OMEGA_G]
    turning = lengthening = 0.0
    if flags & kn.MOVING_LINE:
        turning = (line.ey * vx - line.ex * vy) / length
        lengthening = (rp + rg) * turning - (line.ex * vx + line.ey * vy)
    full = GRADUAL * p[kn.NOMINAL_FORCE]
    damping = p[kn.DAMPING] * math.sqrt(max(stiffness, 0.0))
    softening = p[kn.SOFTENING] if flags & kn.CONTACT_LAW else 0.0
    closing = overlap_rate(line, vx, vy, omega_p, omega_g)
    beyond = corner_reach(gap, tip, length, rp, rg)
    for _ in range(_MOST_ITERATIONS):
        _, by_p, by_length = corner_gap(beyond, tip, length, rp, rg)
        pull = damping * (by_p * rp * (turning - omega_p) + by_length * lengthening - closing)
        if not 9.0 * pull > 8.0 * full:
            break
        load = pull if pull > full else 0.25 * (3.0 + math.sqrt(9.0 - 8.0 * full / pull)) * full
        left = gap - load * compliances(load, stiffness, softening, p[kn.NOMINAL_FORCE])[0]
        before = beyond
        beyond = corner_reach(left, tip, length, rp, rg)
        if abs(beyond - before) < _BENDS * p[kn.PITCH]:
            break
    return float(beyond)


@compiled
def moved_by_others(at: float, contacts: FloatArray, count: int, p: FloatArray) -> float:
    """How much of the approach of a pair at xi = ``at`` the loads of the others, pitches off, take [m]."""
    moved = 0.0
    for i in range(count):
        apart = math.floor((contacts[i, kn.XI] - at) / p[kn.PITCH] + 0.5)
        if apart != 0 and contacts[i, kn.FLANK] > 0.0:
            behind = min(at, at + apart * p[kn.PITCH])
            moved += coupling_at(p, abs(apart), behind)[0] * contacts[i, kn.ELASTIC]
    return moved


@compiled
def distance(
    kind: float,
    place: float,
    t: float,
    q: FloatArray,
    v: FloatArray,
    p: FloatArray,
    flags: int,
    contacts: FloatArray,
    count: int,
) -> float:
    """How far one tooth pair has to travel along the path of contact to an event, modulo the base pitch [m].

    Friction jumps or bends at a sliding velocity v_s, given by the place where the nominal motion slides so
    fast, xi = L_XP + v_s/(Omega_p + Omega_g); the actual one is linear along the line of action. ``contacts``
    are the ``count`` pairs whose loads move a tip corner, none where pairs do not move each other.
    """
    line, delta, rho, xi = mesh_position(t, q, p, flags, DRIVE)
    length = line.length
    shifted = flags & (kn.ENTRY_SHIFT | kn.TIP_CONTACT)
    first, last = kind == FIRST_TOUCH, kind in (LET_GO, LAST_TOUCH)
    beyond = gap = 0.0
    # The loads of other pairs depend little on where exactly the pair will be.
    for _ in range(_PLACES if first or last else 0):
        if first:
            gap = delta - relief_at(p, p[kn.L_XA], 0.0, 0.0)[0]
            gap -= moved_by_others(p[kn.L_XA] - beyond, contacts, count, p)
            beyond = corner_reach(gap, p[kn.TIP_G], length, p[kn.RADIUS_G], p[kn.RADIUS_P])
        else:
            gap = delta - relief_at(p, p[kn.L_XD], 0.0, 0.0)[0]
            gap -= moved_by_others(p[kn.L_XD] + beyond, contacts, count, p)
            if kind == LET_GO:
                beyond = let_go(gap, place, line, v, p, flags)
            else:
                beyond = corner_reach(gap, p[kn.TIP_P], length, p[kn.RADIUS_P], p[kn.RADIUS_G])
        if count == 0:
            break
    # Where undercut ends the flank of the mate: its edge lets go as soon as the tip does, at most.
    if kind == EXIT or last:
        end = p[kn.TIP_P] + beyond
        if p[kn.EDGE_G] > 0.0:
            way = edge_reach(gap, p[kn.EDGE_G], length, p[kn.RADIUS_G]) if last else 0.0
            end = min(end, length + delta - p[kn.EDGE_G] + way)
        return float(end if shifted else p[kn.L_XD]) - rho
    if kind == ENTRY or first:
        start = length + delta - p[kn.TIP_G] - beyond
        if p[kn.EDGE_P] > 0.0:
            way = edge_reach(gap, p[kn.EDGE_P], length, p[kn.RADIUS_P]) if first else 0.0
            start = max(start, p[kn.EDGE_P] - way)
        return float(start if shifted else p[kn.L_XA]) - rho
    if kind == SLIDING and flags & kn.SLIDING:
        omega_p, omega_g = v[2] - p[kn.OMEGA_P], v[5] + p[kn.OMEGA_G]
        arm = xi + 0.5 * (length - p[kn.L_XY])
        slide = sliding_velocity(line, v[0] - v[3], v[1] - v[4], omega_p, omega_g, arm, length - arm)
        wanted = (place - p[kn.L_XP]) * (p[kn.OMEGA_P] + p[kn.OMEGA_G])
        return float((wanted - slide) / (omega_g - omega_p))
    return place - xi


@compiled
def time_to_event(
    t: float,
    q: FloatArray,
    v: FloatArray,
    a: FloatArray,
    p: FloatArray,
    flags: int,
    table: FloatArray,
    events: FloatArray,
    near: float,
) -> tuple[float, float]:
    """Time to the next event [s] and its kind; infinite when there is none.

    Over the time ``near`` [s] a Taylor polynomial of q, v, a (6,) foretells the vibration; further ahead only
    the nominal speed is asked.
    """
    pitch = float(p[kn.PITCH])
    speed = float(p[kn.OMEGA_P] * p[kn.RADIUS_P])
    coupled = flags & kn.NEIGHBOURS and flags & kn.TIP_CONTACT and p[kn.COUPLED] > 0.0
    contacts = np.empty((2 * kn.MAX_PAIRS, kn.N_RECORD))
    count = 0
    ahead = np.empty((3, 6))
    later = ahead[0]
    moving = ahead[1]
    if coupled:
        for j in range(6):
            later[j] = q[j]
            moving[j] = v[j]
        count = contact_forces(t, ahead, p, flags, table, contacts)
    way = math.inf
    which = 0
    for i in range(events.shape[0]):
        d = distance(events[i, 0], events[i, 1], t, q, v, p, flags, contacts, count) % pitch
        if d < way:
            way = d
            which = i
    wait = way / speed
    kind = float(events[which, 0]) if events.shape[0] else ENTRY
    if not wait < near:
        return wait, kind
    before = shift = 0.0
    for turn in range(_MOST_ITERATIONS):
        for j in range(6):
            later[j] = q[j] + wait * (v[j] + 0.5 * wait * a[j])
            moving[j] = v[j] + wait * a[j]
        if coupled and kind >= FIRST_TOUCH:
            count = contact_forces(t + wait, ahead, p, flags, table, contacts)
        d = distance(kind, events[which, 1], t + wait, later, moving, p, flags, contacts, count)
        change = wrap(d, pitch) / speed
        share = 1.0  # of the way that the secant through the last two predictions goes
        if turn > 0 and abs(change) < 0.5 * abs(shift):
            share = (wait - before) / (shift - change)
        before = wait
        shift = change
        wait += share * change
        if abs(change) * speed < (_SHARP if kind < FIRST_TOUCH else _BENDS) * pitch:
            break
    return max(wait, 0.0), kind
