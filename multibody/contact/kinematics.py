"""Contact kinematics of two involute gears as rigid bodies in the plane, exact for finite motions.

Before it stands where the numbers of the model are: effect switches, parameters, records of the contacts.
Nothing here knows a stiffness, a load or a nominal motion: only centre positions, rotation angles (counter-
clockwise, rad), velocities, base radii and tip radii. The line of action runs from the pinion's tangent point
X to the gear's, Y; along it are e, the flank distances rho_p and rho_g from X and Y, and the overlap delta.

Sources: docs/theory/multibody.md, "Line of action", "Overlap, wrench and contact point".
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from lumped.compiler import compiled
from lumped.path_function import FIT_DEGREE
from lumped.typing import FloatArray

#: Most tooth pairs in contact at once: contact ratio below 4.
MAX_PAIRS = 4
#: Parameters of the friction laws, named in ``multibody.contact.friction``.
N_FRICTION = 18

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

# Places in the parameter vector. Lengths in m, angles in rad, speeds in rad/s.
(
    RADIUS_P, RADIUS_G, PITCH, TIP_P, TIP_G,  # base radii, base pitch, tangent lengths of the tip circles
    EDGE_P, EDGE_G,  # tangent lengths at which undercuts end the flanks, 0 without undercut
    CHI_P, APART, CHI_P_BACK, APART_BACK,  # chi_p and overlap of mesh_phase: drive and coast side
    CENTRE_PX, CENTRE_PY, CENTRE_GX, CENTRE_GY,  # nominal centres
    L_XA, L_XP, L_XD, L_XY,  # nominal path of contact
    OMEGA_P, OMEGA_G,  # nominal speeds
    V_REG,  # velocity over which friction changes sign; 0 = at once
    T_LOW, T_HIGH,  # the nominal phase is clamped to this open time interval (a smooth segment)
    DAMPING,  # c/sqrt(k) of a tooth pair, 2 zeta sqrt(m_e) [sqrt(kg)]
    SOFTENING, NOMINAL_FORCE,  # D of Hertz's contact [m/N], and the load at which the table's k holds [N]
    K_ROWS, C_ROWS, E_ROWS, GAP_ROWS, TILT_ROWS,  # in the table of the linear, loaded mesh, or 0
    OWN,  # where the block of ``machine.own_block`` starts, or 0
    RELIEFS,  # number of reliefs that act
    FIRST_RELIEF,  # of each: gear, roll angles of start and end [rad], amount [m], power of growth
) = range(35)  # fmt: skip
#: Columns of one relief, and the most reliefs: tip and root of both flanks.
RELIEF_COLUMNS = 5
MOST_RELIEFS = 4
#: Where the parameters of the friction laws start, see ``multibody.contact.friction``.
FRICTION = FIRST_RELIEF + RELIEF_COLUMNS * MOST_RELIEFS
#: How far pairs 1, 2, ... base pitches apart move each other: the number of such functions, then each as
#: a row of ``elements.stiffness_and_slope`` over the position of the pair behind [m/N].
COUPLED = FRICTION + N_FRICTION
FIRST_COUPLED = COUPLED + 1
COUPLED_COLUMNS = FIT_DEGREE + 3
#: The rows of ``friction_size``'s table, if there is one, stand behind all others.
N_PARAMETERS = FIRST_COUPLED + COUPLED_COLUMNS * (MAX_PAIRS - 1)

# Places in the block of teeth that differ: of pinion and gear eccentricity [m], its angle at t = 0 [rad],
# number of teeth, tooth at A at t = 0; then the numbers of faults and of ripples, the errors of the pinion's
# teeth and of the gear's [m], their rise along the own base tangents from the pitch point [-], their tip
# relief beyond the design's [m], a row for each fault, and one for each ripple of a torque.
ECCENTRICITY, ANGLE, TEETH, FIRST, OWN_COLUMNS = range(5)
OWN_FAULTS = 2 * OWN_COLUMNS
OWN_RIPPLES = OWN_FAULTS + 1
OWN_ERRORS = OWN_RIPPLES + 1
# Columns of a ripple: gear (1) or pinion (0), periods a turn, amplitude [N m], phase at t = 0 [rad].
RIPPLE_GEAR, RIPPLE_ORDER, RIPPLE, RIPPLE_PHASE, RIPPLE_COLUMNS = range(5)
# Columns of a fault: gear (1) or pinion (0), tooth from 0; of a crack the compliance over the square of the
# arm of the load [1/(N m)], place of the root section on the centre line of the tooth [m], half its angle on
# the base circle [rad]; of a spall both ends [m], compliance between them [m/N], depth [m]; where the flank
# ends [m]. Lengths are on the own base tangent.
(
    FAULT_GEAR, FAULT_TOOTH, CRACK, ROOT, HALF_TOOTH, SPALL_START, SPALL_END, SPALL, PIT, FLANK_END,
    FAULT_COLUMNS,
) = range(11)  # fmt: skip

# Columns of a contact record.
# OVERLAP and its rate are those pressed elastically (tooth error taken off); CLOSING is the overlap's own
# rate.
# ELASTIC is the load without the damper, ENERGY what the two teeth store, PATH their force along the path of
# contact (``path_force``), and PATH_RATE the velocity of the contact along it.
(
    XI, LOAD, FRICTION_FORCE, MU, K, SLIDE, OVERLAP, OVERLAP_RATE, C, FLANK, CLOSING,
    ELASTIC, ENERGY, PATH, PATH_RATE,
) = range(15)  # fmt: skip
N_RECORD = 15

# Rows of what is known of the pairs before their loads are.
(
    POSITION, PRESSED, PRESSING, RELIEF_SLOPE, BY_P, BY_G, BY_L, STIFFNESS, SLOPE, NORMAL, BEYOND, ARMS,
) = range(12)  # fmt: skip
# The flank distances take two rows; behind them stand how pairs move each other, and its slopes.
COUPLINGS = ARMS + 2
SLOPES = COUPLINGS + MAX_PAIRS
N_STATE = SLOPES + MAX_PAIRS

#: How far beyond the tips contact is looked for, over the base pitch.
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


@compiled
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


@compiled
def wrap(value: float, period: float) -> float:
    """``value`` modulo ``period``, in [-period/2, period/2)."""
    return value - period * math.floor(value / period + 0.5)


@compiled
def mesh_phase(
    psi: float,
    grown: float,
    phi_p: float,
    phi_g: float,
    rolled: float,
    radius_p: float,
    radius_g: float,
    pitch: float,
    chi_p: float,
    overlap: float,
    flank: float,
) -> tuple[float, float]:
    """Where the teeth stand on the line of action; pinion flanks are paired with the nearest gear flanks.

    psi, grown : angle [rad] and growth [m] of the line of action
    phi_p, phi_g : rotation angles beyond the rolling [rad]
    rolled : arc by which both base circles have turned in the drive sense, which leaves the overlap [m]
    chi_p : angle of the pinion's flank [rad]
    overlap : at psi = phi_p = phi_g = 0, L = L_0: -s (r_bp chi_p + r_bg (chi_g - pi)) - L_0 [m]
    Returns (rho, delta) : distance of the first pinion flank from X in [0, pitch), overlap of the flanks [m]
    """
    rho_p = flank * radius_p * (psi - phi_p - chi_p)
    turned = (radius_p + radius_g) * psi - radius_p * phi_p - radius_g * phi_g
    # % is exact for any number of turns; subtracting whole pitches leaves metres after 1e16 of them.
    return (rho_p + flank * rolled) % pitch, wrap(flank * turned - grown + overlap, pitch)


@compiled
def overlap_rate(line: Line, vx: float, vy: float, omega_p: float, omega_g: float) -> float:
    """Rate of the overlap [m/s]; (vx, vy) is the velocity of the pinion's centre relative to the gear's."""
    turning = line.radius_p * omega_p + line.radius_g * omega_g
    return line.ex * vx + line.ey * vy - line.flank * turning


@compiled
def sliding_velocity(
    line: Line, vx: float, vy: float, omega_p: float, omega_g: float, arm_p: float, arm_g: float
) -> float:
    """Velocity of the pinion's material relative to the gear's along -n, the arms from X and Y [m/s]."""
    nx, ny = -line.flank * line.ey, line.flank * line.ex
    return -(nx * vx + ny * vy) - line.flank * (omega_p * arm_p + omega_g * arm_g)


@compiled
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
    wrench[0] += fx
    wrench[1] += fy
    wrench[2] += flank * (line.radius_p * normal + arm_p * friction)
    wrench[3] -= fx
    wrench[4] -= fy
    wrench[5] += flank * (line.radius_g * normal + arm_g * friction)


@compiled
def add_gradient(wrench: FloatArray, line: Line, by_p: float, by_g: float, by_length: float) -> None:
    """Add by_p grad(rho_p) + by_g grad(rho_g) + by_length grad(L) to ``wrench``: the force of any energy.

    The factors are minus its derivatives [N]; source: docs/theory/contact_energy.md, "Wrench".
    """
    ex, ey, length, flank, radius_p, radius_g = line
    tilt = flank * (radius_p + radius_g) / length
    along_x, along_y = ex - tilt * ey, ey + tilt * ex  # centre to centre, over L
    turning = flank * (radius_p * by_p + radius_g * by_g) / length
    fx, fy = turning * ey - by_length * along_x, -turning * ex - by_length * along_y
    wrench[0] += fx
    wrench[1] += fy
    wrench[2] -= flank * radius_p * by_p
    wrench[3] -= fx
    wrench[4] -= fy
    wrench[5] -= flank * radius_g * by_g


@compiled
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


@compiled
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


@compiled
def corner_reach(gap: float, tip: float, length: float, radius: float, mate: float) -> float:
    """How far beyond its tip circle a corner still touches: the inverse of ``corner_gap`` [m].

    Newton's method from gap = (tip/radius)^2 (1/tip + 1/rho) beyond^2/2, rho the mate's radius of curvature.
    """
    if gap <= 0.0 or length <= tip:
        return 0.0
    bend = (tip / radius) ** 2 * (1.0 / tip + 1.0 / (length - tip))
    beyond = math.sqrt(2.0 * gap / bend)
    for _ in range(4):
        found, slope, _ = corner_gap(beyond, tip, length, radius, mate)
        if not slope > 0.0:
            break
        beyond = max(beyond - (found - gap) / slope, 0.1 * beyond)
    return beyond


@compiled
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
    """Gap that corners beyond the path leave [m], its derivatives by both flank distances and the length.

    A corner is that of a tip, or the edge of an undercut. Only one of them ever decides the gap.
    """

    gap: float
    by_p: float
    by_g: float
    by_length: float


@compiled
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


@compiled
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


@compiled
def mesh_position(
    t: float, q: FloatArray, p: FloatArray, flags: int, flank: float
) -> tuple[Line, float, float, float]:
    """Line of action of one side of the teeth, and where they stand on it; arguments as ``contact_forces``.

    Returns the line, the overlap, and of one tooth pair rho_p for ``engaged`` and its position xi [m]
    """
    rp, rg = p[RADIUS_P], p[RADIUS_G]
    tau = min(max(t, p[T_LOW]), p[T_HIGH])
    rolled = p[OMEGA_P] * tau * rp
    moving = (flags & MOVING_LINE) != 0
    along, off = (q[3] - q[0], q[4] - q[1]) if moving else (0.0, 0.0)
    chi, apart = (p[CHI_P], p[APART]) if flank > 0.0 else (p[CHI_P_BACK], p[APART_BACK])
    ex, ey, grown, psi = line_of_action(along, off, p[L_XY], rp + rg, flank)
    first, delta = mesh_phase(psi, grown, q[2], q[5], rolled, rp, rg, p[PITCH], chi, apart, flank)
    beyond = delta  # excess of rho_p + rho_g over the length, which places the contact point
    if not moving:
        delta += ex * (q[0] - q[3]) + ey * (q[1] - q[4])
    if not flags & ROTATION_PHASE:
        first, beyond = mesh_phase(psi, grown, 0.0, 0.0, rolled, rp, rg, p[PITCH], chi, apart, flank)
    xi = first - 0.5 * (grown + beyond)
    rho = xi + 0.5 * (grown + delta) if flags & (ENTRY_SHIFT | TIP_CONTACT) else xi
    return Line(ex, ey, p[L_XY] + grown, flank, rp, rg), delta, rho, xi


@compiled
def engaged(rho: float, delta: float, length: float, p: FloatArray, flags: int, arms: FloatArray) -> int:
    """Find the tooth pairs in contact: on the actual flanks, or on the nominal path without entry shift."""
    edge_p, edge_g = p[EDGE_P], p[EDGE_G]
    if flags & TIP_CONTACT:  # candidates; those beyond the ends touch where they press
        reach = _REACH * p[PITCH]
        ends_p = (edge_p - reach if edge_p > 0.0 else 0.0, p[TIP_P] + reach)
        ends_g = (edge_g - reach if edge_g > 0.0 else 0.0, p[TIP_G] + reach)
        return pairs_in_contact(rho, delta, length, p[PITCH], ends_p, ends_g, arms)
    if flags & ENTRY_SHIFT:
        ends_p, ends_g = (edge_p, p[TIP_P]), (edge_g, p[TIP_G])
        return pairs_in_contact(rho, delta, length, p[PITCH], ends_p, ends_g, arms)
    ends_p, ends_g = (0.0, p[L_XD]), (0.0, p[L_XY] - p[L_XA])
    return pairs_in_contact(rho, 0.0, p[L_XY], p[PITCH], ends_p, ends_g, arms)


@compiled
def off_axis(own: FloatArray, t: float, state: FloatArray, omega_p: float, omega_g: float) -> FloatArray:
    """Rows of (x, y, phi) of both: state of the base circles' centres, rates, their way from the axes."""
    found = np.empty((3, 6))
    for j in range(6):
        found[0, j] = state[0, j]
        found[1, j] = state[1, j]
    for which in range(2):
        # the pinion turns clockwise
        row = OWN_COLUMNS * which
        sense = 1.0 - 2.0 * which
        x, y = 3 * which, 3 * which + 1
        turned = (omega_g if which else omega_p) * t - sense * state[0, x + 2]
        rate = (omega_g if which else omega_p) - sense * state[1, x + 2]
        size = own[row + ECCENTRICITY]
        angle = turned + own[row + ANGLE]
        along = -sense * size * math.cos(angle)
        off = size * math.sin(angle)
        found[2, x] = along
        found[2, y] = off
        found[0, x] += along
        found[0, y] += off
        found[1, x] += sense * off * rate
        found[1, y] -= sense * along * rate
    return found


@compiled
def move_moments(ways: FloatArray, wrench: FloatArray) -> None:
    """Make the moments about the base circles' centres those about the axes."""
    for x in (0, 3):
        wrench[x + 2] += ways[x] * wrench[x + 1] - ways[x + 1] * wrench[x]


@compiled
def ripple_torques(
    own: FloatArray, t: float, q: FloatArray, omega_p: float, omega_g: float
) -> tuple[float, float]:
    """What the ripples add to the driving and to the braking torque, at these angles of the rotors."""
    torques = np.zeros(2)
    row = OWN_ERRORS + 3 * (int(own[TEETH]) + int(own[OWN_COLUMNS + TEETH]))
    row += FAULT_COLUMNS * int(own[OWN_FAULTS])
    for _ in range(int(own[OWN_RIPPLES])):
        which = int(own[row + RIPPLE_GEAR])
        angle = omega_g * t + q[5] if which else omega_p * t - q[2]  # the pinion turns clockwise
        turned = own[row + RIPPLE_ORDER] * angle + own[row + RIPPLE_PHASE]
        torques[which] += own[row + RIPPLE] * math.cos(turned)
        row += RIPPLE_COLUMNS
    return torques[0], torques[1]


class OwnPair(NamedTuple):
    """What its two teeth make of a pair.

    error, rise : material missing on both flanks [m], and its slope along the path of contact
    softer, slope : compliance that faults add [m/N], and its slope along the path of contact
    tip_p, tip_g : where the flanks end, distances from X and Y [m]
    relief_p, relief_g : tip relief beyond that of the design [m]
    """

    error: float
    rise: float
    softer: float
    slope: float
    tip_p: float
    tip_g: float
    relief_p: float
    relief_g: float


@compiled
def tooth_pair(
    own: FloatArray, p: FloatArray, turned_p: float, turned_g: float, arms: FloatArray, xi: float
) -> OwnPair:
    """The pair with flanks at the distances ``arms`` from X and Y, in contact at xi [m].

    ``turned_p`` and ``turned_g`` are arcs of the base circles: of pair 0 the first is its distance from X,
    and the second its distance from Y, which falls. A crack bends the tooth about its root section, whose
    centre is r_b - u cos(rho/r_b - half tooth) off the line of action: the tangent's foot on the base circle
    is that angle off the tooth's centre line.
    """
    number_p = math.floor((turned_p - arms[0]) / p[PITCH] + 0.5)
    number_g = math.floor((arms[1] - turned_g) / p[PITCH] + 0.5)
    z_p, z_g = int(own[TEETH]), int(own[OWN_COLUMNS + TEETH])
    pinion = (int(own[FIRST]) + number_p) % z_p
    gear = (int(own[OWN_COLUMNS + FIRST]) + number_g) % z_g
    errors = own[OWN_ERRORS:]
    rises = own[OWN_ERRORS + z_p + z_g :]
    reliefs = rises[z_p + z_g :]
    rise = rises[pinion] - rises[z_p + gear]
    held = min(max(xi, p[L_XA]), p[L_XD])
    error = errors[pinion] + errors[z_p + gear] + rise * (held - p[L_XP])
    rise = rise if held == xi else 0.0
    softer = 0.0
    slope = 0.0
    tip_p = p[TIP_P]
    tip_g = p[TIP_G]
    for i in range(int(own[OWN_FAULTS])):
        row = OWN_ERRORS + 3 * (z_p + z_g) + FAULT_COLUMNS * i
        of_gear = own[row + FAULT_GEAR] == 1.0
        if own[row + FAULT_TOOTH] != (gear if of_gear else pinion):
            continue
        end = own[row + FLANK_END]
        radius = p[RADIUS_G] if of_gear else p[RADIUS_P]
        sense, place = (-1.0, p[L_XY] - xi) if of_gear else (1.0, xi)
        if of_gear:
            tip_g = min(tip_g, end)
        else:
            tip_p = min(tip_p, end)
        if place > end:
            sense = 0.0
            place = end
        turn = place / radius - own[row + HALF_TOOTH]
        arm = radius - own[row + ROOT] * math.cos(turn)
        softer += own[row + CRACK] * arm * arm
        slope += sense * 2.0 * own[row + CRACK] * arm * own[row + ROOT] * math.sin(turn) / radius
        if own[row + SPALL_START] <= place < own[row + SPALL_END]:
            softer += own[row + SPALL]
            error += own[row + PIT]
    return OwnPair(error, rise, softer, slope, tip_p, tip_g, reliefs[pinion], reliefs[z_p + gear])
