"""Forces of the tooth contacts for one state of the two bodies: the compiled heart of the exact model.

State: q = (x_p, y_p, phi_p, x_g, y_g, phi_g), deviations from the nominal position and rotation, world axes
x, y, angles counter-clockwise. In the drive sense the pinion turns clockwise and the gear counter-clockwise.

Sources: docs/theory/multibody.md, "Overlap, wrench and contact point"; docs/theory/contact_energy.md.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from lumped.compiler import called, compiled, inlined
from lumped.typing import FloatArray, IntArray
from multibody.contact import kinematics as kn
from multibody.contact.elements import (
    GRADUAL,
    ContactLaw,
    contact_law,
    coupling_at,
    elastic_load,
    gradual,
    relief_at,
    shared_loads,
    stored_energy,
    table_value_and_slope,
)
from multibody.contact.friction import SurfaceMotion, signed_friction
from multibody.contact.kinematics import (
    COAST,
    DRIVE,
    Corners,
    GearRates,
    MeshPosition,
    add_gradient,
    add_wrench,
    corners_at,
    engaged,
    gear_rates,
    line_rates,
    mesh_position,
    overlap_rate,
    sliding_velocity,
)
from multibody.contact.linear_mesh import linear_forces
from multibody.contact.records import (
    CONTACTS_SIZE,
    COORDINATES,
    MAX_PAIRS,
    PAIR,
    PHI_G,
    PHI_P,
    RATES,
    WRENCH,
    Record,
    Records,
    contacts_of,
    machine_of,
    opened_contacts,
    table_of,
)
from multibody.contact.tooth_pairs import (
    WAYS,
    OwnPair,
    OwnTeeth,
    TurnedArcs,
    moments_about_axes,
    own_teeth_of,
    ripple_torques,
    set_base_circle_motion,
    teeth_of_pair,
    tooth_pair,
    turned_arcs,
)


class Tables(NamedTuple):
    """Tables of a machine: stiffness of a tooth pair over xi, and the lumped model's friction coefficient."""

    stiffness: FloatArray
    friction: FloatArray


class SideMotion(NamedTuple):
    """One side of the teeth at one instant.

    position : where its teeth stand
    gears : velocities of the gears
    approach_rate : rate of the overlap [m/s]
    psi_rate, length_rate : rates of angle and length of the line of action [rad/s, m/s]
    contact_rate : velocity of the contact along the path, d(xi)/dt [m/s]
    """

    position: MeshPosition
    gears: GearRates
    approach_rate: float
    psi_rate: float
    length_rate: float
    contact_rate: float


class Workspace(NamedTuple):
    """Memory of one evaluation.

    pairs : PAIR (MAX_PAIRS,)
    arms : (MAX_PAIRS, 2) flank distances of the pairs found
    base_circles : (3, 6) coordinates, rates and ways of the base circles' centres of eccentric gears
    """

    pairs: Records
    arms: FloatArray
    base_circles: FloatArray


class TeethMotion(NamedTuple):
    """Records of all teeth, and how far the base circles have turned."""

    teeth: OwnTeeth
    arcs: TurnedArcs


@called
def side_motion(
    t: float, q: FloatArray, rates: GearRates, machine: Record, flags: int, flank: float
) -> SideMotion:
    """One side of the teeth at time t [s], with the coordinates q (6,) of the base circles' centres."""
    position = mesh_position(t, q, machine, flags, flank)
    line = position.line
    # The nominal speeds roll, and would only blur it.
    approach_rate = overlap_rate(line, rates.vx, rates.vy, rates.phi_p, rates.phi_g)
    psi_rate, length_rate = line_rates(line, rates, flags)
    rolling = machine.rolling
    omega_p = rates.omega_p if flags & kn.ROTATION_PHASE else -rolling.omega_p
    omega_g = rates.omega_g if flags & kn.ROTATION_PHASE else rolling.omega_g
    turning = line.radius_p * (psi_rate - omega_p) - line.radius_g * (psi_rate - omega_g)
    return SideMotion(position, rates, approach_rate, psi_rate, length_rate, 0.5 * flank * turning)


@inlined
def like_teeth(machine: Record) -> OwnPair:
    """A pair of teeth without errors and faults."""
    return OwnPair(0.0, 0.0, 0.0, 0.0, machine.geometry.tip_p, machine.geometry.tip_g, 0.0, 0.0)


@called
def set_corner_gap(
    pair: Record, side: SideMotion, machine: Record, own: OwnPair, error: float, error_slope: float
) -> bool:
    """Add the gap of tip corners to a pair; False where no load of a neighbour could make it touch.

    ``error`` and ``error_slope`` are the material missing on both flanks and its slope over xi.
    """
    geometry = machine.geometry
    line = side.position.line
    edge_p = geometry.edge_p
    edge_g = geometry.edge_g
    corners = corners_at(line, pair.arm_p, pair.arm_g, (own.tip_p, own.tip_g), (edge_p, edge_g))
    beyond_tip = pair.arm_p > own.tip_p or pair.arm_g > own.tip_g
    beyond = beyond_tip or pair.arm_p < edge_p or pair.arm_g < edge_g
    pair.compression = side.position.overlap - error - own.error - corners.gap
    if beyond and pair.compression < -abs(side.position.overlap):
        return False
    pair.compression_rate = (
        side.approach_rate
        - error_slope * side.contact_rate
        - corners.by_p * line.flank * line.radius_p * (side.psi_rate - side.gears.omega_p)
        - corners.by_g * line.flank * line.radius_g * (side.psi_rate - side.gears.omega_g)
        - corners.by_length * side.length_rate
    )
    set_corner_slopes(pair, corners)
    pair.beyond = 1 if beyond else 0
    return True


@inlined
def set_corner_slopes(pair: Record, corners: Corners) -> None:
    """Write the slopes of the gap of tip corners into a pair."""
    pair.corner_by_p = corners.by_p
    pair.corner_by_g = corners.by_g
    pair.corner_by_length = corners.by_length


@called
def set_gap(pair: Record, side: SideMotion, machine: Record, flags: int, own: OwnPair) -> bool:
    """Write compression, its rate and the slopes of the gap into a pair at ``pair.position``.

    False where the teeth are further apart than any neighbour could move them.
    """
    geometry = machine.geometry
    error, error_slope = relief_at(machine, pair.position, own.relief_p, own.relief_g)
    error_slope += own.rise
    pair.beyond = 0
    if not flags & kn.TIP_CONTACT:
        pair.compression = side.position.overlap - error - own.error
        pair.compression_rate = side.approach_rate - error_slope * side.contact_rate
        set_corner_slopes(pair, Corners(0.0, 0.0, 0.0, 0.0))
    else:
        if pair.position < geometry.L_XA or pair.position > geometry.L_XD:
            error_slope = 0.0
            inside = min(max(pair.position, geometry.L_XA), geometry.L_XD)
            error = relief_at(machine, inside, own.relief_p, own.relief_g)[0]
        if not set_corner_gap(pair, side, machine, own, error, error_slope):
            return False
    pair.error_slope = error_slope
    return True


@called
def set_stiffness(pair: Record, stiffness: FloatArray, own: OwnPair) -> None:
    """Write the stiffness of a pair, softened by the faults of its teeth, and its slope over xi."""
    k, slope = table_value_and_slope(stiffness, pair.position)
    share = 1.0 / (1.0 + own.compliance * k)
    pair.stiffness = share * k
    pair.stiffness_slope = share * share * (slope - k * k * own.compliance_slope)


@called
def pairs_near_contact(
    side: SideMotion, machine: Record, flags: int, tables: Tables, motion: TeethMotion, work: Workspace
) -> int:
    """Write the pairs of one side that touch or may touch, without loads. Return the number of pairs."""
    arms = work.arms
    pairs = work.pairs
    position = side.position
    own = like_teeth(machine)
    count = int(np.int64(0))  # of a literal 0 numba would compile the callees again
    for candidate in range(engaged(position, machine, flags, arms)):
        pair = pairs[count]
        rho_p = arms[candidate, 0]
        rho_g = arms[candidate, 1]
        pair.arm_p = rho_p
        pair.arm_g = rho_g
        pair.position = 0.5 * (rho_p - rho_g + machine.geometry.L_XY)
        if machine.own_teeth and position.line.flank > 0.0:
            numbers = teeth_of_pair(machine, motion.teeth, motion.arcs, rho_p, rho_g)
            own = tooth_pair(machine, motion.teeth, numbers, pair.position)
        if not set_gap(pair, side, machine, flags, own):
            continue
        # Here ``beyond`` is that of a tip corner in contact. Without corners a pair beyond a tip may still
        # pull, as its neighbours may. ``add_side`` leaves such a pair out where it is not compressed.
        pair.may_pull = 0 if flags & kn.CONTACT_LOSS or pair.beyond else 1
        if rho_p > own.tip_p or rho_g > own.tip_g:
            pair.beyond = 1
        set_stiffness(pair, tables.stiffness, own)
        count += 1
    return count


@called
def set_couplings(count: int, pairs: Records, machine: Record) -> None:
    """Write how far the load of each pair moves each other one. The newest, furthest behind, comes first."""
    for i in range(count):
        pairs[i].couplings[i] = 0.0
        for j in range(i):
            coupling, slope = coupling_at(machine, i - j, pairs[j].position)
            pairs[i].couplings[j] = coupling
            pairs[j].couplings[i] = coupling
            pairs[i].coupling_slopes[j] = slope
            pairs[j].coupling_slopes[i] = slope


@called
def set_elastic_loads(count: int, pairs: Records, machine: Record, coupled: bool, law: ContactLaw) -> None:
    """Write the load of each pair without its damper."""
    if coupled:
        set_couplings(count, pairs, machine)
        shared_loads(count, pairs, law)
        return
    for i in range(count):
        pair = pairs[i]
        load = elastic_load(pair.compression, pair.stiffness, law)
        pair.elastic_load = load if pair.may_pull else max(load, 0.0)


class MovedByNeighbours(NamedTuple):
    """How far the loads of the other pairs move a pair [m], and the slope of that way over xi [-]."""

    way: float
    slope: float


@inlined
def moved_by_neighbours(number: int, count: int, pairs: Records, coupled: bool) -> MovedByNeighbours:
    """How far the loads of the other pairs move the pair of a number."""
    way = 0.0
    slope = 0.0
    if coupled:
        pair = pairs[number]
        for j in range(count):
            if j != number:
                way += pair.couplings[j] * pairs[j].elastic_load
                slope += pair.coupling_slopes[j] * pairs[j].elastic_load
    return MovedByNeighbours(way, slope)


@inlined
def damping_of(pair: Record, machine: Record, flags: int, own_compression: float) -> float:
    """Coefficient c of a pair's damper, which takes hold gradually with the load [N s/m].

    ``own_compression``: approach less all gaps and less what the neighbours move [m].
    """
    damping = machine.pair_law.damping * math.sqrt(max(pair.stiffness, 0.0))
    if flags & kn.TIP_CONTACT:
        damping *= gradual(pair.elastic_load / (GRADUAL * machine.pair_law.nominal_force))
    if flags & kn.CONTACT_LOSS and own_compression <= 0.0:
        return 0.0
    return float(damping)


@inlined
def surface_motion(pair: Record, side: SideMotion) -> SurfaceMotion:
    """How both surfaces move at the contact point of a pair, which turns with the line of action."""
    line = side.position.line
    gears = side.gears
    arm_p = 0.5 * (pair.arm_p - pair.arm_g + line.length)
    arm_g = line.length - arm_p
    sliding = sliding_velocity(line, gears.vx, gears.vy, gears.omega_p, gears.omega_g, arm_p, arm_g)
    rolling = arm_p * (side.psi_rate - gears.omega_p) + arm_g * (gears.omega_g - side.psi_rate)
    return SurfaceMotion(sliding, line.flank * rolling, arm_p, arm_g)


@called
def add_contact_wrench(
    wrench: FloatArray, pair: Record, side: SideMotion, flags: int, surface: SurfaceMotion, contact: Record
) -> None:
    """Add the force of a contact to the wrench: normal load, friction, tip corners, work along the path."""
    line = side.position.line
    normal = contact.load
    add_wrench(wrench, line, normal, contact.friction_force, surface.rho_p, surface.rho_g)
    if flags & (kn.PATH_WORK | kn.TIP_CONTACT):
        along = 0.5 * contact.path_force if flags & kn.PATH_WORK else 0.0
        by_p = normal * pair.corner_by_p + along
        by_g = normal * pair.corner_by_g - along
        add_gradient(wrench, line, by_p, by_g, normal * pair.corner_by_length)


@called
def set_contact(
    contact: Record,
    pair: Record,
    side: SideMotion,
    neighbours: MovedByNeighbours,
    machine: Record,
    flags: int,
    law: ContactLaw,
) -> None:
    """Write normal load, damper and stored energy of a pair that touches into its CONTACT record."""
    elastic = pair.elastic_load
    damping = damping_of(pair, machine, flags, pair.compression - neighbours.way)
    energy, energy_slope = stored_energy(elastic, pair.stiffness, pair.stiffness_slope, law)
    # Half of w_ij N_i N_j is counted at either pair, and half of its slope at constant compression.
    energy += 0.5 * elastic * neighbours.way
    energy_slope -= 0.5 * elastic * neighbours.slope
    normal = elastic + damping * pair.compression_rate
    if flags & kn.CONTACT_LOSS and normal < 0.0:
        normal = 0.0
    contact.position = pair.position
    contact.load = normal
    contact.stiffness = pair.stiffness
    contact.damping = damping
    contact.compression = pair.compression
    contact.compression_rate = pair.compression_rate
    contact.flank = side.position.line.flank
    contact.approach_rate = side.approach_rate
    contact.elastic_load = elastic
    contact.energy = energy
    contact.path_force = normal * pair.error_slope - energy_slope
    contact.path_rate = side.contact_rate


@inlined
def set_friction(
    contact: Record, surface: SurfaceMotion, machine: Record, flags: int, table: FloatArray
) -> None:
    """Write the friction of a contact, by the motion of its surfaces and its normal load."""
    mu = signed_friction(machine, table, flags, contact.flank, contact.position, surface, contact.load)
    contact.friction_coefficient = mu
    contact.friction_force = mu * contact.load
    contact.sliding_velocity = surface.sliding


@called
def add_side(
    side: SideMotion,
    machine: Record,
    flags: int,
    tables: Tables,
    pairs: Records,
    count: int,
    wrench: FloatArray,
    contacts: Records,
) -> int:
    """Add the forces of ``count`` pairs of one side to the wrench. Return the number of contacts written.

    A pair beyond the ends of the flanks touches only under compression. So does a pair of the back side.
    """
    law = contact_law(machine, flags)
    coupled = machine.coupling_count > 0 and (flags & kn.NEIGHBOURS) != 0
    set_elastic_loads(count, pairs, machine, coupled, law)
    back_side = side.position.line.flank < 0.0 and (flags & kn.CONTACT_LOSS) != 0
    written = int(np.int64(0))  # of a literal 0 numba would compile the callees again
    for i in range(count):
        pair = pairs[i]
        neighbours = moved_by_neighbours(i, count, pairs, coupled)
        if pair.compression - neighbours.way <= 0.0 and (pair.beyond or back_side):
            continue
        contact = contacts[written]
        surface = surface_motion(pair, side)
        set_contact(contact, pair, side, neighbours, machine, flags, law)
        set_friction(contact, surface, machine, flags, tables.friction)
        add_contact_wrench(wrench, pair, side, flags, surface, contact)
        written += 1
    return written


@compiled(no_cpython_wrapper=True)
def contact_forces(
    t: float, state: FloatArray, packed: FloatArray, flags: int, flat_contacts: FloatArray
) -> int:
    """Wrench of tooth contacts and torque ripples on the gears at time t [s], and a record of each contact.

    Parameters
    ----------
    state : (3, 6) deviations from nominal position and rotation [m, rad], their rates, and the wrench, which
        is written: (Fx, Fy, M) of pinion and gear [N, N m]. It is one array, because each argument takes
        time in the call from Python
    packed, flags : numbers of the machine, see ``records``, and effect switches of ``kinematics``
    flat_contacts : receives the CONTACT records, drive flank first; back sides only when pressed

    Returns
    -------
    Number of contacts, or -1 when a force is not finite
    """
    work = Workspace(np.empty(MAX_PAIRS, PAIR), np.empty((MAX_PAIRS, 2)), np.empty((3, 6)))
    return write_forces(t, state, packed, flags, contacts_of(flat_contacts), work)


@called
def write_forces(
    t: float, state: FloatArray, packed: FloatArray, flags: int, contacts: Records, work: Workspace
) -> int:
    """Write wrench and contacts of ``contact_forces``, with the memory of a workspace.

    With teeth that differ, contacts and moments are first of the centres of the base circles, which eccentric
    gears move, and then of the axes.
    """
    machine = machine_of(packed)[0]
    blocks = machine.blocks
    tables = Tables(table_of(packed, blocks.stiffness), table_of(packed, blocks.friction))
    motion = TeethMotion(own_teeth_of(packed), turned_arcs(machine, t, state[COORDINATES]))
    q = state[COORDINATES]
    v = state[RATES]
    wrench = state[WRENCH]
    wrench[:] = 0.0
    if machine.own_teeth:
        set_base_circle_motion(machine, t, state, work.base_circles)
        q = work.base_circles[COORDINATES]
        v = work.base_circles[RATES]
    rates = gear_rates(machine, v)
    written = int(np.int64(0))  # of a literal 0 numba would compile the callees again
    for number in range(2 if flags & kn.BACK_SIDE else 1):
        flank = DRIVE if number == 0 else COAST
        side = side_motion(t, q, rates, machine, flags, flank)
        if not math.isfinite(side.position.overlap):
            return -1
        count = pairs_near_contact(side, machine, flags, tables, motion, work)
        written += add_side(side, machine, flags, tables, work.pairs, count, wrench, contacts[written:])
    if machine.own_teeth:
        moments_about_axes(work.base_circles[WAYS], wrench)
    if machine.ripples_on_gears:
        ripples = ripple_torques(packed, t, state[COORDINATES])
        wrench[PHI_P] -= ripples[0]
        wrench[PHI_G] -= ripples[1]
    return written if all_finite(wrench) else -1


@inlined
def all_finite(wrench: FloatArray) -> bool:
    """Whether no force or moment is infinite or not a number."""
    total = 0.0
    for i in range(wrench.size):
        total += wrench[i]
    return math.isfinite(total)


@compiled
def tooth_forces(
    t: float, state: FloatArray, packed: FloatArray, flags: int, flat_contacts: FloatArray
) -> int:
    """Wrench and contact records of one state; arguments and result as ``contact_forces``."""
    if flags & kn.LINEAR:
        return linear_forces(t, state, packed, flags, flat_contacts)
    return contact_forces(t, state, packed, flags, flat_contacts)


class ContactStates(NamedTuple):
    """Contacts at n states.

    wrenches : (n, 6) of pinion and gear [N, N m]
    contacts : CONTACT (n, 2 MAX_PAIRS)
    counts : (n,) how many of the contacts count
    """

    wrenches: FloatArray
    contacts: Records
    counts: IntArray


def tooth_forces_over(
    times: FloatArray, q: FloatArray, v: FloatArray, packed: FloatArray, flags: int
) -> ContactStates:
    """``tooth_forces`` at n times [s] with states q, v (n, 6 or more).

    A loop in Python: a kernel would compile for a second.
    """
    states = np.empty((times.size, 3, 6))
    states[:, COORDINATES] = q[:, :6]
    states[:, RATES] = v[:, :6]
    flat_contacts = np.zeros((times.size, CONTACTS_SIZE))
    counts = [
        tooth_forces(t, state, packed, flags, contacts)
        for t, state, contacts in zip(times.tolist(), states, flat_contacts, strict=True)
    ]
    wrenches = states[:, WRENCH].copy()
    return ContactStates(wrenches, opened_contacts(flat_contacts), np.array(counts, np.int64))
