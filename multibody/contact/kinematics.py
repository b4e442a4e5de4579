"""Contact kinematics of two involute gears as rigid bodies in the plane, exact for finite motions.

Nothing here knows a stiffness, a load or a nominal motion: only centre positions, rotation angles (counter-
clockwise, rad), velocities, base radii and tip radii. The line of action runs from the pinion's tangent point
X to the gear's, Y; along it are e, the flank distances rho_p and rho_g from X and Y, and the overlap delta.

Sources: docs/theory/multibody.md, "Line of action", "Overlap, wrench and contact point".
"""

from __future__ import annotations

import math
from typing import NamedTuple

from lumped.compiler import called
from lumped.typing import FloatArray
from multibody.contact.records import MAX_PAIRS, PHI_G, PHI_P, X_G, X_P, Y_G, Y_P, Record, uncounted

# Bits of the effect switches, and of the linear mesh, which has none of the effects.
ROTATION_PHASE = 1
MOVING_LINE = 2
SLIDING = 4
ENTRY_SHIFT = 8
CONTACT_LOSS = 16
BACK_SIDE = 32
LINEAR = 64
FRICTION_LOAD = 128
PATH_WORK = 256
TIP_CONTACT = 512
CONTACT_LAW = 1024
NEIGHBOURS = 2048
CLEARANCE = 4096

#: Length beyond the tips in which contact is looked for, over the base pitch.
_REACH = 0.4
#: Flanks: the one that drives in the pinion's running sense, and the back side.
DRIVE = 1.0
COAST = -1.0


class Line(NamedTuple):
    """Line of action of one side of the teeth.

    ex, ey : unit vector e from X to Y
    length : |XY| [m]
    flank : +1 drive, -1 coast
    radius_p, radius_g : base radii [m]
    """

    ex: float
    ey: float
    length: float
    flank: float
    radius_p: float
    radius_g: float


@uncounted
def line_of_action(
    along: float, off: float, nominal: float, base_sum: float, flank: float
) -> tuple[float, float, float, float]:
    """Unit vector e (from X to Y), growth L - L_0 [m] and angle psi [rad] of the actual line of action.

    The gear's centre stands at d = (L_0 + u_x, R + u_y) from the pinion's, R = ``base_sum``, L_0 =
    ``nominal``; ``along`` and ``off`` are u [m], of which alone changes are made: else they drown in the
    rounding of L_0. Returns (ex, ey, grown, psi), NaN when the base circles overlap
    """
    dx, dy = nominal + along, base_sum + off
    longer = along * (along + 2.0 * nominal) + off * (off + 2.0 * base_sum)  # L^2 - L_0^2
    square = nominal * nominal + longer
    if not square > 0.0:
        return math.nan, math.nan, math.nan, math.nan
    grown = longer / (nominal + math.sqrt(square))
    length = nominal + grown
    across = length * dy + base_sum * dx
    if flank > 0.0:  # L dy - R dx without the nominal part, which is zero
        across = nominal * off + grown * dy - base_sum * along
    centres = dx * dx + dy * dy
    ex, ey = (length * dx + flank * base_sum * dy) / centres, across / centres
    return ex, ey, grown, math.atan2(ey, ex)


@uncounted
def wrap(value: float, period: float) -> float:
    """``value`` modulo ``period``, in [-period/2, period/2)."""
    return value - period * math.floor(value / period + 0.5)


class Side(NamedTuple):
    """The teeth of one side, drive or coast, as they stand at psi = phi_p = phi_g = 0, L = L_0.

    flank : +1 drive, -1 coast
    radius_p, radius_g : base radii [m]
    pitch : base pitch [m]
    chi : angle of a pinion flank [rad]
    overlap : -s (r_bp chi_p + r_bg (chi_g - pi)) - L_0 of that flank and the nearest gear flank [m]
    """

    flank: float
    radius_p: float
    radius_g: float
    pitch: float
    chi: float
    overlap: float


class Turn(NamedTuple):
    """Displacements that move the teeth along the line of action.

    psi : angle of the line of action [rad]
    grown : growth L - L_0 of the line of action [m]
    phi_p, phi_g : rotation angles beyond the rolling [rad]
    rolled : arc by which both base circles have turned in the drive sense, which leaves the overlap [m]
    """

    psi: float
    grown: float
    phi_p: float
    phi_g: float
    rolled: float


@uncounted
def side_of(machine: Record, flank: float) -> Side:
    """The teeth of one side of a machine at t = 0."""
    geometry = machine.geometry
    rolling = machine.rolling
    chi = rolling.chi_drive if flank > 0.0 else rolling.chi_coast
    apart = rolling.apart_drive if flank > 0.0 else rolling.apart_coast
    return Side(flank, geometry.radius_p, geometry.radius_g, geometry.pitch, chi, apart)


@uncounted
def mesh_phase(side: Side, turn: Turn) -> tuple[float, float]:
    """Where the teeth stand on the line of action; pinion flanks are paired with the nearest gear flanks.

    Returns (rho, delta) : distance of the first pinion flank from X in [0, pitch), overlap of the flanks [m]
    """
    rho_p = side.flank * side.radius_p * (turn.psi - turn.phi_p - side.chi)
    radii = side.radius_p + side.radius_g
    arcs = radii * turn.psi - side.radius_p * turn.phi_p - side.radius_g * turn.phi_g
    # % is exact for any number of turns; subtracting whole pitches leaves metres after 1e16 of them.
    rho = (rho_p + side.flank * turn.rolled) % side.pitch
    return rho, wrap(side.flank * arcs - turn.grown + side.overlap, side.pitch)


class GearRates(NamedTuple):
    """Velocities of both gears.

    vx, vy : velocity of the pinion's centre relative to the gear's centre [m/s]
    phi_p, phi_g : rates of the rotation angles beyond the nominal rotation [rad/s]
    omega_p, omega_g : actual rotation, counter-clockwise [rad/s]
    """

    vx: float
    vy: float
    phi_p: float
    phi_g: float
    omega_p: float
    omega_g: float


@called
def gear_rates(machine: Record, v: FloatArray) -> GearRates:
    """Velocities of the gears from the rates v (6,) of (x_p, y_p, phi_p, x_g, y_g, phi_g)."""
    rolling = machine.rolling
    return GearRates(
        vx=v[X_P] - v[X_G],
        vy=v[Y_P] - v[Y_G],
        phi_p=v[PHI_P],
        phi_g=v[PHI_G],
        omega_p=v[PHI_P] - rolling.omega_p,
        omega_g=v[PHI_G] + rolling.omega_g,
    )


@called
def line_rates(line: Line, rates: GearRates, flags: int) -> tuple[float, float]:
    """Rates of the angle psi [rad/s] and of the length L [m/s] of the line of action.

    d(psi)/dt = s n . (v_g - v_p)/L, from differentiating e.
    """
    if not flags & MOVING_LINE:
        return 0.0, 0.0
    psi_rate = (line.ey * rates.vx - line.ex * rates.vy) / line.length
    radii = line.radius_p + line.radius_g
    return psi_rate, line.flank * radii * psi_rate - (line.ex * rates.vx + line.ey * rates.vy)


@called
def overlap_rate(line: Line, vx: float, vy: float, omega_p: float, omega_g: float) -> float:
    """Rate of the overlap [m/s]; (vx, vy) is the velocity of the pinion's centre relative to the gear's."""
    turning = line.radius_p * omega_p + line.radius_g * omega_g
    return line.ex * vx + line.ey * vy - line.flank * turning


@called
def sliding_velocity(
    line: Line, vx: float, vy: float, omega_p: float, omega_g: float, arm_p: float, arm_g: float
) -> float:
    """Velocity of the pinion's material relative to the gear's along -n, the arms from X and Y [m/s]."""
    nx, ny = -line.flank * line.ey, line.flank * line.ex
    return -(nx * vx + ny * vy) - line.flank * (omega_p * arm_p + omega_g * arm_g)


@uncounted
def add_wrench(
    wrench: FloatArray, line: Line, normal: float, friction: float, arm_p: float, arm_g: float
) -> None:
    """Add one contact's forces to ``wrench`` = (Fx, Fy, M) of the pinion, (Fx, Fy, M) of the gear [N, N m].

    The pinion receives -N e + F n, the gear the opposite, both at the contact point; moments are about the
    centres, counter-clockwise. ``friction`` F has the sign of the sliding velocity.
    """
    ex = line.ex
    ey = line.ey
    flank = line.flank
    nx, ny = -flank * ey, flank * ex
    fx, fy = -normal * ex + friction * nx, -normal * ey + friction * ny
    wrench[X_P] += fx
    wrench[Y_P] += fy
    wrench[PHI_P] += flank * (line.radius_p * normal + arm_p * friction)
    wrench[X_G] -= fx
    wrench[Y_G] -= fy
    wrench[PHI_G] += flank * (line.radius_g * normal + arm_g * friction)


@uncounted
def add_gradient(wrench: FloatArray, line: Line, by_p: float, by_g: float, by_length: float) -> None:
    """Add by_p grad(rho_p) + by_g grad(rho_g) + by_length grad(L) to ``wrench``: the force of any energy.

    The factors are minus its derivatives [N]; source: docs/theory/contact_energy.md, "Wrench".
    """
    ex, ey, length, flank, radius_p, radius_g = line
    tilt = flank * (radius_p + radius_g) / length
    along_x, along_y = ex - tilt * ey, ey + tilt * ex  # centre to centre, over L
    turning = flank * (radius_p * by_p + radius_g * by_g) / length
    fx, fy = turning * ey - by_length * along_x, -turning * ex - by_length * along_y
    wrench[X_P] += fx
    wrench[Y_P] += fy
    wrench[PHI_P] -= flank * radius_p * by_p
    wrench[X_G] -= fx
    wrench[Y_G] -= fy
    wrench[PHI_G] -= flank * radius_g * by_g


@uncounted
def corner_gap(
    beyond: float, tip: float, length: float, radius: float, mate: float
) -> tuple[float, float, float]:
    """How much more two teeth have to approach until the tip corner of one meets the flank of the other [m].

    It touches along a tangent of the mate's base circle (docs/theory/contact_energy.md, "Tip corner").

    beyond : flank distance of the gear with the corner, less that of its tip circle [m]
    tip, radius : tangent length of the tip circle and base radius of the gear with the corner [m]
    length, mate : of the line of action, and base radius of the other gear [m]
    Returns the gap, zero up to the tip; its derivatives by the flank distance and by ``length``
    """
    if beyond <= 0.0:
        return 0.0, 0.0, 0.0
    return corner_off(beyond, tip, length, radius, mate)


@called
def corner_off(
    beyond: float, tip: float, length: float, radius: float, mate: float
) -> tuple[float, float, float]:
    """The gap of ``corner_gap`` for a corner on either side of its contact on the line of action.

    A negative ``beyond`` is the way back from the edge of an undercut flank.
    """
    turn = beyond / radius
    sine, cosine = math.sin(turn), math.cos(turn)
    # Where the corner stands from the mate's tangent point: back along the line, and off it.
    back = length - radius * sine - tip * cosine
    off = 2.0 * radius * math.sin(0.5 * turn) ** 2 + tip * sine
    tangent = math.sqrt(max(back * back + off * (off + 2.0 * mate), 0.0))
    angle = math.atan2(back, off + mate) - math.atan2(tangent, mate)
    gap = tangent + mate * angle - (length - tip - beyond)
    ratio = tip / radius
    by_distance = 1.0 - math.cos(angle) * (cosine - ratio * sine) - math.sin(angle) * (sine + ratio * cosine)
    return gap, by_distance, math.cos(angle) - 1.0


@uncounted
def corner_reach(gap: float, tip: float, length: float, radius: float, mate: float) -> float:
    """How far beyond its tip circle a corner still touches: the inverse of ``corner_gap`` [m].

    Newton's method from gap = (tip/radius)^2 (1/tip + 1/rho) beyond^2/2, rho the mate's radius of curvature.
    """
    if gap <= 0.0 or length <= tip:
        return 0.0
    bend = (tip / radius) ** 2 * (1.0 / tip + 1.0 / (length - tip))
    beyond = math.sqrt(2.0 * gap / bend)
    for _ in range(4):
        gap_there, slope, _ = corner_gap(beyond, tip, length, radius, mate)
        if not slope > 0.0:
            break
        beyond = max(beyond - (gap_there - gap) / slope, 0.1 * beyond)
    return beyond


@uncounted
def pairs_in_contact(
    rho: float,
    delta: float,
    length: float,
    pitch: float,
    ends_p: tuple[float, float],
    ends_g: tuple[float, float],
    arms: FloatArray,
) -> int:
    """Find every pair of teeth whose flanks meet between their ends; returns their number.

    ends_p, ends_g : rho between which flanks are looked at: from 0 or the edge of an undercut to the tip
        circles, tangent lengths sqrt(r_a^2 - r_b^2) [m]
    arms : (MAX_PAIRS, 2) receives the flank distances (rho_p, rho_g), newest pair first [m]
    """
    count = 0
    rho_p = rho - pitch if ends_p[0] < 0.0 else rho
    while rho_p <= ends_p[1] and count < MAX_PAIRS:
        rho_g = length + delta - rho_p
        if rho_p >= ends_p[0] and ends_g[0] <= rho_g <= ends_g[1]:
            arms[count, 0] = rho_p
            arms[count, 1] = rho_g
            count += 1
        rho_p += pitch
    return count


class Corners(NamedTuple):
    """Gap at a corner beyond the path [m], and derivatives of the gap.

    A corner is the corner of a tip, or the edge of an undercut. Only one corner decides the gap.

    by_p, by_g : derivatives by the flank distances of pinion and gear
    by_length : derivative by the length of the line of action
    """

    gap: float
    by_p: float
    by_g: float
    by_length: float


@called
def end_of_flank(
    rho: float, tip: float, mate_rho: float, edge: float, length: float, radius: float, mate: float
) -> tuple[float, float, float, float]:
    """Gap where one gear ends at its tip, and its mate at the edge of an undercut [m].

    Of both gaps the larger is left. A corner whose ``tip`` is longer than the line never touches the line,
    and decides once it is outside the edge; nearer to the base circle its gap is the smaller one.

    rho, tip, radius : flank distance, tangent length of the tip circle, base radius of the gear with the tip
    mate_rho, edge, mate : flank distance, tangent length of the edge (0: none), base radius of its mate
    Returns the gap, its derivatives by ``rho``, by ``mate_rho`` and by ``length``
    """
    gap, by_tip, by_length = corner_gap(rho - tip, tip, length, radius, mate)
    if edge > 0.0 and mate_rho < edge:
        if rho <= tip and tip > length:
            turn = (rho - tip) / radius
            back = length - radius * math.sin(turn) - tip * math.cos(turn)
            off = 2.0 * radius * math.sin(0.5 * turn) ** 2 + tip * math.sin(turn)
            if back * back + off * (off + 2.0 * mate) > 0.25 * edge * edge:
                gap, by_tip, by_length = corner_off(rho - tip, tip, length, radius, mate)
        at_edge, by_edge, longer = corner_off(mate_rho - edge, edge, length, mate, radius)
        if at_edge > gap:
            return at_edge, 0.0, by_edge, longer
    return gap, by_tip, 0.0, by_length


@uncounted
def corners_at(
    line: Line, rho_p: float, rho_g: float, tips: tuple[float, float], edges: tuple[float, float]
) -> Corners:
    """Gap at the ends of the flanks of the tooth pair with flank distances rho_p and rho_g [m].

    tips, edges : tangent lengths of tip circles and edges of pinion and gear [m], an edge of 0 is none
    """
    length = line.length
    radius_p = line.radius_p
    radius_g = line.radius_g
    end = end_of_flank(rho_p, tips[0], rho_g, edges[1], length, radius_p, radius_g)
    start = end_of_flank(rho_g, tips[1], rho_p, edges[0], length, radius_g, radius_p)
    return Corners(end[0] + start[0], end[1] + start[2], end[2] + start[1], end[3] + start[3])


class MeshPosition(NamedTuple):
    """Position of the teeth of one side.

    line : line of action
    overlap : delta, overlap of the flanks [m]
    rho : rho_p of one tooth pair [m]; ``engaged`` adds whole pitches for the other pairs
    xi : position of this tooth pair [m]
    """

    line: Line
    overlap: float
    rho: float
    xi: float


@called
def mesh_position(t: float, q: FloatArray, machine: Record, flags: int, flank: float) -> MeshPosition:
    """Line of action of one side of the teeth, and the place of the teeth on it, at time t [s].

    q : (6,) deviations (x_p, y_p, phi_p, x_g, y_g, phi_g) from the nominal position and rotation [m, rad]
    """
    geometry = machine.geometry
    rolling = machine.rolling
    side = side_of(machine, flank)
    base_sum = side.radius_p + side.radius_g
    smooth_time = min(max(t, rolling.earliest), rolling.latest)
    rolled = rolling.omega_p * smooth_time * side.radius_p
    moving = (flags & MOVING_LINE) != 0
    along, off = (q[X_G] - q[X_P], q[Y_G] - q[Y_P]) if moving else (0.0, 0.0)
    ex, ey, grown, psi = line_of_action(along, off, geometry.L_XY, base_sum, flank)
    rho_first, delta = mesh_phase(side, Turn(psi, grown, q[PHI_P], q[PHI_G], rolled))
    excess = delta  # of rho_p + rho_g over the length, which places the contact point
    if not moving:
        delta += ex * (q[X_P] - q[X_G]) + ey * (q[Y_P] - q[Y_G])
    if not flags & ROTATION_PHASE:
        rho_first, excess = mesh_phase(side, Turn(psi, grown, 0.0, 0.0, rolled))
    xi = rho_first - 0.5 * (grown + excess)
    rho = xi + 0.5 * (grown + delta) if flags & (ENTRY_SHIFT | TIP_CONTACT) else xi
    line = Line(ex, ey, geometry.L_XY + grown, flank, side.radius_p, side.radius_g)
    return MeshPosition(line, delta, rho, xi)


@called
def engaged(mesh: MeshPosition, machine: Record, flags: int, arms: FloatArray) -> int:
    """Find the tooth pairs in contact: on the actual flanks; without entry shift on the nominal path.

    With the effect of tip corners these pairs are candidates. A pair beyond the ends of the flanks touches
    only under compression.
    """
    geometry = machine.geometry
    edge_p = geometry.edge_p
    edge_g = geometry.edge_g
    pitch = geometry.pitch
    length = mesh.line.length
    if flags & TIP_CONTACT:
        reach = _REACH * pitch
        ends_p = (edge_p - reach if edge_p > 0.0 else 0.0, geometry.tip_p + reach)
        ends_g = (edge_g - reach if edge_g > 0.0 else 0.0, geometry.tip_g + reach)
        return pairs_in_contact(mesh.rho, mesh.overlap, length, pitch, ends_p, ends_g, arms)
    if flags & ENTRY_SHIFT:
        ends_p = (edge_p, geometry.tip_p)
        ends_g = (edge_g, geometry.tip_g)
        return pairs_in_contact(mesh.rho, mesh.overlap, length, pitch, ends_p, ends_g, arms)
    ends_p = (0.0, geometry.L_XD)
    ends_g = (0.0, geometry.L_XY - geometry.L_XA)
    return pairs_in_contact(mesh.rho, 0.0, geometry.L_XY, pitch, ends_p, ends_g, arms)
