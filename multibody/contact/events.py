"""When the contact force will next jump or bend: a tooth enters or leaves, passes a switch, or sliding turns.

A step that straddles a jump of the force is no longer of the integrator's order. The Taylor polynomial of the
motion says when that will be, so that the integrator can stop there and start again behind it. A wrong
prediction costs time and nothing else: the force does not depend on it.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from lumped.compiler import called, compiled
from lumped.path_function import PathFunction
from lumped.typing import FloatArray
from multibody.contact import kinematics as kn
from multibody.contact.elements import GRADUAL, compliances, contact_law, coupling_at, relief_at
from multibody.contact.friction import FrictionSwitch
from multibody.contact.kernels import contact_forces
from multibody.contact.kinematics import (
    DRIVE,
    GearRates,
    Line,
    MeshPosition,
    corner_gap,
    corner_reach,
    gear_rates,
    line_rates,
    mesh_position,
    overlap_rate,
    sliding_velocity,
    wrap,
)
from multibody.contact.records import (
    CONTACTS_SIZE,
    COORDINATES,
    EVENT,
    RATES,
    Record,
    Records,
    contacts_of,
    machine_of,
)

#: Kinds of events: a flank enters or leaves contact, a contact passes a switch of a law, sliding turns.
ENTRY = 0
EXIT = 1
SWITCH = 2
SLIDING = 3
#: First touch of a tip corner before the path of contact, where the damper of one behind the path lets it
#: go, and its last touch.
FIRST_TOUCH = 4
LET_GO = 5
LAST_TOUCH = 6
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
    friction: Sequence[FrictionSwitch],
    pitch: float,
    *,
    corners: bool = False,
) -> Records:
    """EVENT (n,) of what makes the force jump or bend once per mesh cycle.

    bends : where a relief starts [m]
    friction : jumps and kinks of the friction law
    corners : whether tip corners touch beyond the path of contact
    """
    step = _STEP * pitch
    sizes = {
        place: _change(stiffness, int(np.searchsorted(stiffness.breaks, place)), step)
        for place in stiffness.switches.tolist()
    }
    by_size = sorted(sizes, key=lambda place: -sizes[place])
    largest = [place for place in by_size if sizes[place] > _NEGLIGIBLE]
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
        rows += [(SWITCH, end) for end, one in zip((low, high), bent, strict=True) if one or bends]
    return np.array(rows, dtype=EVENT)


def _change(law: PathFunction, j: int, step: float) -> float:
    """Bound on the difference of the polynomials at break j, one step from j, over the largest value.

    The bound sums the jumps of value, slope and curvature. Outside the path of contact a law is zero.
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


@called
def edge_reach(gap: float, edge: float, length: float, radius: float) -> float:
    """About how far back from an edge a gap is closed [m], to the leading order of ``corner_off``."""
    bend = (edge / radius) ** 2 * (1.0 / edge + 1.0 / (length - edge))
    return math.sqrt(2.0 * max(gap, 0.0) / bend)


@called
def let_go(gap: float, stiffness: float, line: Line, rates: GearRates, machine: Record, flags: int) -> float:
    """How far beyond D the pinion's tip corner, the flanks pressed by ``gap``, lets go [m].

    There the damper pulls as the spring presses: at the load c u, u the rate at which the compression falls,
    or where it acts with the share x^2 (3 - 2 x) at x N_f, where c u x (3 - 2 x) = N_f.
    """
    rp = line.radius_p
    rg = line.radius_g
    tip = machine.geometry.tip_p
    law = contact_law(machine, flags)
    psi_rate, length_rate = line_rates(line, rates, flags)
    full = GRADUAL * law.nominal_force
    damping = machine.pair_law.damping * math.sqrt(max(stiffness, 0.0))
    approach_rate = overlap_rate(line, rates.vx, rates.vy, rates.omega_p, rates.omega_g)
    beyond = corner_reach(gap, tip, line.length, rp, rg)
    for _ in range(_MOST_ITERATIONS):
        _, by_p, by_length = corner_gap(beyond, tip, line.length, rp, rg)
        pull = damping * (by_p * rp * (psi_rate - rates.omega_p) + by_length * length_rate - approach_rate)
        if not 9.0 * pull > 8.0 * full:
            break
        load = pull if pull > full else 0.25 * (3.0 + math.sqrt(9.0 - 8.0 * full / pull)) * full
        gap_left = gap - load * compliances(load, stiffness, law)[0]
        before = beyond
        beyond = corner_reach(gap_left, tip, line.length, rp, rg)
        if abs(beyond - before) < _BENDS * machine.geometry.pitch:
            break
    return float(beyond)


class Neighbours(NamedTuple):
    """The pairs whose loads move a tip corner.

    contacts : CONTACT records
    number : number of records in use; 0 where pairs do not move each other
    """

    contacts: Records
    number: int


@called
def moved_by_neighbours(position: float, neighbours: Neighbours, machine: Record) -> float:
    """How much of the approach of a pair at a position xi the loads of other pairs take [m]."""
    pitch = machine.geometry.pitch
    moved_by = 0.0
    for i in range(neighbours.number):
        contact = neighbours.contacts[i]
        apart = math.floor((contact.position - position) / pitch + 0.5)
        if apart != 0 and contact.flank > 0.0:
            behind = min(position, position + apart * pitch)
            moved_by += coupling_at(machine, abs(apart), behind)[0] * contact.elastic_load
    return moved_by


class CornerReach(NamedTuple):
    """Where a tip corner touches.

    beyond : how far beyond its tip circle [m]
    gap : approach of the flanks there, less relief and what neighbours take [m]
    """

    beyond: float
    gap: float


@called
def reach_before_start(mesh: MeshPosition, neighbours: Neighbours, machine: Record) -> CornerReach:
    """Where the gear's tip corner first touches, before A.

    The loads of the neighbours depend little on where exactly the pair will be.
    """
    geometry = machine.geometry
    beyond = gap = 0.0
    for _ in range(_PLACES):
        gap = mesh.overlap - relief_at(machine, geometry.L_XA, 0.0, 0.0)[0]
        gap -= moved_by_neighbours(geometry.L_XA - beyond, neighbours, machine)
        beyond = corner_reach(gap, geometry.tip_g, mesh.line.length, geometry.radius_g, geometry.radius_p)
        if neighbours.number == 0:
            break
    return CornerReach(beyond, gap)


@called
def reach_behind_end(
    event: Record, mesh: MeshPosition, rates: GearRates, neighbours: Neighbours, machine: Record, flags: int
) -> CornerReach:
    """Where the pinion's tip corner lets go, or last touches, behind D."""
    geometry = machine.geometry
    beyond = gap = 0.0
    for _ in range(_PLACES):
        gap = mesh.overlap - relief_at(machine, geometry.L_XD, 0.0, 0.0)[0]
        gap -= moved_by_neighbours(geometry.L_XD + beyond, neighbours, machine)
        if event.kind == LET_GO:
            beyond = let_go(gap, event.place, mesh.line, rates, machine, flags)
        else:
            tip = geometry.tip_p
            beyond = corner_reach(gap, tip, mesh.line.length, geometry.radius_p, geometry.radius_g)
        if neighbours.number == 0:
            break
    return CornerReach(beyond, gap)


@called
def distance_to_start(mesh: MeshPosition, reach: CornerReach, machine: Record, flags: int) -> float:
    """Distance to where a pair enters contact [m]. Undercut of the pinion may end its flank before.

    The edge of an undercut touches as late as the tip of the mate, at most.
    """
    geometry = machine.geometry
    if not flags & (kn.ENTRY_SHIFT | kn.TIP_CONTACT):
        return float(geometry.L_XA - mesh.rho)
    length = mesh.line.length
    start = length + mesh.overlap - geometry.tip_g - reach.beyond
    if geometry.edge_p > 0.0:
        back = edge_reach(reach.gap, geometry.edge_p, length, geometry.radius_p)
        start = max(start, geometry.edge_p - back)
    return float(start - mesh.rho)


@called
def distance_to_end(mesh: MeshPosition, reach: CornerReach, machine: Record, flags: int) -> float:
    """Distance to where a pair leaves contact [m]. Undercut of the gear may end its flank before.

    The edge of an undercut lets go as soon as the tip of the mate, at most.
    """
    geometry = machine.geometry
    if not flags & (kn.ENTRY_SHIFT | kn.TIP_CONTACT):
        return float(geometry.L_XD - mesh.rho)
    length = mesh.line.length
    end = geometry.tip_p + reach.beyond
    if geometry.edge_g > 0.0:
        back = edge_reach(reach.gap, geometry.edge_g, length, geometry.radius_g)
        end = min(end, length + mesh.overlap - geometry.edge_g + back)
    return float(end - mesh.rho)


@called
def distance_to_sliding(place: float, mesh: MeshPosition, rates: GearRates, machine: Record) -> float:
    """Distance to where the contact slides as fast as the nominal motion does at a place xi [m].

    Friction jumps or bends at a sliding velocity v_s. The nominal motion has it at xi = L_XP +
    v_s/(Omega_p + Omega_g); the actual sliding velocity is linear along the line of action.
    """
    geometry = machine.geometry
    rolling = machine.rolling
    line = mesh.line
    arm = mesh.xi + 0.5 * (line.length - geometry.L_XY)
    slide = sliding_velocity(line, rates.vx, rates.vy, rates.omega_p, rates.omega_g, arm, line.length - arm)
    sought = (place - geometry.L_XP) * (rolling.omega_p + rolling.omega_g)
    return float((sought - slide) / (rates.omega_g - rates.omega_p))


@called
def distance_to_event(
    event: Record, t: float, state: FloatArray, machine: Record, flags: int, neighbours: Neighbours
) -> float:
    """How far one tooth pair has to travel along the path of contact to an event, modulo the base pitch [m].

    state : rows of coordinates and rates (6,) of the gears at time t [s]
    """
    mesh = mesh_position(t, state[COORDINATES], machine, flags, DRIVE)
    rates = gear_rates(machine, state[RATES])
    kind = event.kind
    if kind == ENTRY:
        return distance_to_start(mesh, CornerReach(0.0, 0.0), machine, flags)
    if kind == EXIT:
        return distance_to_end(mesh, CornerReach(0.0, 0.0), machine, flags)
    if kind == FIRST_TOUCH:
        reach = reach_before_start(mesh, neighbours, machine)
        return distance_to_start(mesh, reach, machine, flags)
    if kind in (LAST_TOUCH, LET_GO):
        reach = reach_behind_end(event, mesh, rates, neighbours, machine, flags)
        return distance_to_end(mesh, reach, machine, flags)
    if kind == SLIDING and flags & kn.SLIDING:
        return distance_to_sliding(event.place, mesh, rates, machine)
    return float(event.place - mesh.xi)


@called
def nearest_event(
    t: float, state: FloatArray, machine: Record, flags: int, events: Records, neighbours: Neighbours
) -> tuple[float, int]:
    """Distance to the nearest event along the path [m], infinite without events, and its number."""
    shortest = math.inf
    number = 0
    for i in range(events.size):
        distance = distance_to_event(events[i], t, state, machine, flags, neighbours)
        distance %= machine.geometry.pitch
        if distance < shortest:
            shortest = distance
            number = i
    return shortest, number


@called
def continued(state: FloatArray, q: FloatArray, v: FloatArray, a: FloatArray, wait: float) -> None:
    """Write coordinates and rates into ``state`` as a Taylor polynomial continues them over a time [s]."""
    for j in range(6):
        state[COORDINATES, j] = q[j] + wait * (v[j] + 0.5 * wait * a[j])
        state[RATES, j] = v[j] + wait * a[j]


@compiled
def time_to_event(
    t: float,
    q: FloatArray,
    v: FloatArray,
    a: FloatArray,
    packed: FloatArray,
    flags: int,
    events: Records,
    near: float,
) -> tuple[float, int]:
    """Time to the next event [s] and its kind; infinite when there is none.

    Over the time ``near`` [s] a Taylor polynomial of q, v, a (6,) foretells the vibration; further ahead only
    the nominal speed is asked. The secant through the last two predictions finds the next one.
    """
    machine = machine_of(packed)[0]
    pitch = machine.geometry.pitch
    speed = machine.rolling.omega_p * machine.geometry.radius_p
    coupled = flags & kn.NEIGHBOURS and flags & kn.TIP_CONTACT and machine.coupling_count > 0
    flat_contacts = np.empty(CONTACTS_SIZE)
    contacts = contacts_of(flat_contacts)
    count = 0
    state = np.empty((3, 6))
    continued(state, q, v, a, 0.0)
    if coupled:
        count = contact_forces(t, state, packed, flags, flat_contacts)
    shortest, number = nearest_event(t, state, machine, flags, events, Neighbours(contacts, count))
    wait = shortest / speed
    if events.size == 0:
        return wait, ENTRY
    event = events[number]
    if not wait < near:
        return wait, event.kind
    before = shift = 0.0
    sharp = (_SHARP if event.kind < FIRST_TOUCH else _BENDS) * pitch
    for prediction in range(_MOST_ITERATIONS):
        continued(state, q, v, a, wait)
        if coupled and event.kind >= FIRST_TOUCH:
            count = contact_forces(t + wait, state, packed, flags, flat_contacts)
        distance = distance_to_event(event, t + wait, state, machine, flags, Neighbours(contacts, count))
        change = wrap(distance, pitch) / speed
        share = 1.0  # of the change that the secant takes
        if prediction > 0 and abs(change) < 0.5 * abs(shift):
            share = (wait - before) / (shift - change)
        before = wait
        shift = change
        wait += share * change
        if abs(change) * speed < sharp:
            break
    return max(wait, 0.0), event.kind
