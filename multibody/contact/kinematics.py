"""Contact kinematics of two involute gears as rigid bodies in the plane, exact for finite motions.

Nothing here knows a stiffness, a load or a nominal motion: only centre positions, rotation angles (counter-
clockwise, rad), velocities, base radii and tip radii. The line of action runs from the pinion's tangent point
X to the gear's, Y; along it are e, the flank distances rho_p and rho_g from X and Y, and the overlap delta.

Sources: docs/theory/multibody.md, "Line of action", "Overlap, wrench and contact point".
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import NamedTuple

import numpy as np

from lumped.compiler import Compiler
from lumped.typing import FloatArray
from multibody.contact import layout as kn

_PACKAGE = Path(__file__).parents[1]
compiled = Compiler(path for path in _PACKAGE.rglob("*.py") if b"@compiled" in path.read_bytes())

#: How far beyond the tips contact is looked for, over the base pitch.
_REACH = 0.4
#: Flanks: the one that drives in the pinion's running sense, and the back side.
DRIVE, COAST = 1.0, -1.0


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
    ex, ey, flank = line.ex, line.ey, line.flank
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
    turn = beyond / radius
    sine, cosine = math.sin(turn), math.cos(turn)
    # Where the corner stands from the mate's tangent point: back along the line, and off it.
    back = length - radius * sine - tip * cosine
    off = 2.0 * radius * math.sin(0.5 * turn) ** 2 + tip * sine
    tangent = math.sqrt(back * back + off * (off + 2.0 * mate))
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
    rho: float, delta: float, length: float, pitch: float, tip_p: float, tip_g: float, arms: FloatArray
) -> int:
    """Find every pair of teeth whose flanks meet between base and tip circles; returns their number.

    tip_p, tip_g : rho at the tip circles, tangent lengths sqrt(r_a^2 - r_b^2) [m]
    arms : (MAX_PAIRS, 2) receives the flank distances (rho_p, rho_g), newest pair first [m]
    """
    count = 0
    rho_p = rho
    while rho_p <= tip_p and count < kn.MAX_PAIRS:
        rho_g = length + delta - rho_p
        if 0.0 <= rho_g <= tip_g:
            arms[count, 0] = rho_p
            arms[count, 1] = rho_g
            count += 1
        rho_p += pitch
    return count


class Corners(NamedTuple):
    """Gap that tip corners beyond the path leave [m], its derivatives by both flank distances and the length.

    Only one of them is ever beyond its tip.
    """

    gap: float
    by_p: float
    by_g: float
    by_length: float


@compiled
def corners_at(line: Line, rho_p: float, rho_g: float, tip_p: float, tip_g: float) -> Corners:
    """Gap at the tip corners of the tooth pair with flank distances rho_p and rho_g [m]."""
    length, radius_p, radius_g = line.length, line.radius_p, line.radius_g
    gap_p, by_p, length_p = corner_gap(rho_p - tip_p, tip_p, length, radius_p, radius_g)
    gap_g, by_g, length_g = corner_gap(rho_g - tip_g, tip_g, length, radius_g, radius_p)
    return Corners(gap_p + gap_g, by_p, by_g, length_p + length_g)


@compiled
def mesh_position(
    t: float, q: FloatArray, p: FloatArray, flags: int, flank: float
) -> tuple[Line, float, float, float]:
    """Line of action of one side of the teeth, and where they stand on it; arguments as ``contact_forces``.

    Returns the line, the overlap, and of one tooth pair rho_p for ``engaged`` and its position xi [m]
    """
    rp, rg = p[kn.RADIUS_P], p[kn.RADIUS_G]
    tau = min(max(t, p[kn.T_LOW]), p[kn.T_HIGH])
    rolled = p[kn.OMEGA_P] * tau * rp
    moving = (flags & kn.MOVING_LINE) != 0
    along, off = (q[3] - q[0], q[4] - q[1]) if moving else (0.0, 0.0)
    chi, apart = (p[kn.CHI_P], p[kn.APART]) if flank > 0.0 else (p[kn.CHI_P_BACK], p[kn.APART_BACK])
    ex, ey, grown, psi = line_of_action(along, off, p[kn.L_XY], rp + rg, flank)
    first, delta = mesh_phase(psi, grown, q[2], q[5], rolled, rp, rg, p[kn.PITCH], chi, apart, flank)
    beyond = delta  # excess of rho_p + rho_g over the length, which places the contact point
    if not moving:
        delta += ex * (q[0] - q[3]) + ey * (q[1] - q[4])
    if not flags & kn.ROTATION_PHASE:
        first, beyond = mesh_phase(psi, grown, 0.0, 0.0, rolled, rp, rg, p[kn.PITCH], chi, apart, flank)
    xi = first - 0.5 * (grown + beyond)
    rho = xi + 0.5 * (grown + delta) if flags & (kn.ENTRY_SHIFT | kn.TIP_CONTACT) else xi
    return Line(ex, ey, p[kn.L_XY] + grown, flank, rp, rg), delta, rho, xi


@compiled
def engaged(rho: float, delta: float, length: float, p: FloatArray, flags: int, arms: FloatArray) -> int:
    """Find the tooth pairs in contact: on the actual flanks, or on the nominal path without entry shift."""
    if flags & kn.TIP_CONTACT:  # candidates; those beyond the tips touch where they press
        reach = _REACH * p[kn.PITCH]
        return pairs_in_contact(
            rho, delta, length, p[kn.PITCH], p[kn.TIP_P] + reach, p[kn.TIP_G] + reach, arms
        )
    if flags & kn.ENTRY_SHIFT:
        return pairs_in_contact(rho, delta, length, p[kn.PITCH], p[kn.TIP_P], p[kn.TIP_G], arms)
    return pairs_in_contact(rho, 0.0, p[kn.L_XY], p[kn.PITCH], p[kn.L_XD], p[kn.L_XY] - p[kn.L_XA], arms)


@compiled
def off_axis(own: FloatArray, t: float, state: FloatArray, omega_p: float, omega_g: float) -> FloatArray:
    """Rows of (x, y, phi) of both: state of the base circles' centres, rates, their way from the axes."""
    found = np.empty((3, 6))
    for j in range(6):
        found[0, j], found[1, j] = state[0, j], state[1, j]
    for which in range(2):
        row, sense = kn.OWN_COLUMNS * which, 1.0 - 2.0 * which  # the pinion turns clockwise
        x, y = 3 * which, 3 * which + 1
        turned = (omega_g if which else omega_p) * t - sense * state[0, x + 2]
        rate = (omega_g if which else omega_p) - sense * state[1, x + 2]
        size, angle = own[row + kn.ECCENTRICITY], turned + own[row + kn.ANGLE]
        along, off = -sense * size * math.cos(angle), size * math.sin(angle)
        found[2, x], found[2, y] = along, off
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


class OwnPair(NamedTuple):
    """What its two teeth make of a pair.

    error, rise : material missing on both flanks [m], and its slope along the path of contact
    softer, slope : compliance that faults add [m/N], and its slope along the path of contact
    tip_p, tip_g : where the flanks end, distances from X and Y [m]
    """

    error: float
    rise: float
    softer: float
    slope: float
    tip_p: float
    tip_g: float


@compiled
def own_pair(
    own: FloatArray, p: FloatArray, turned_p: float, turned_g: float, arms: FloatArray, xi: float
) -> OwnPair:
    """The pair with flanks at the distances ``arms`` from X and Y, in contact at xi [m].

    ``turned_p`` and ``turned_g`` are arcs of the base circles: of pair 0 the first is its distance from X,
    and the second its distance from Y, which falls. A crack bends the tooth about its root section, whose
    centre is r_b - u cos(rho/r_b - half tooth) off the line of action: the tangent's foot on the base circle
    is that angle off the tooth's centre line.
    """
    number_p = math.floor((turned_p - arms[0]) / p[kn.PITCH] + 0.5)
    number_g = math.floor((arms[1] - turned_g) / p[kn.PITCH] + 0.5)
    z_p, z_g = int(own[kn.TEETH]), int(own[kn.OWN_COLUMNS + kn.TEETH])
    pinion = (int(own[kn.FIRST]) + number_p) % z_p
    gear = (int(own[kn.OWN_COLUMNS + kn.FIRST]) + number_g) % z_g
    errors, rises = own[kn.OWN_ERRORS :], own[kn.OWN_ERRORS + z_p + z_g :]
    rise, held = rises[pinion] - rises[z_p + gear], min(max(xi, p[kn.L_XA]), p[kn.L_XD])
    error = errors[pinion] + errors[z_p + gear] + rise * (held - p[kn.L_XP])
    rise = rise if held == xi else 0.0
    softer, slope, tip_p, tip_g = 0.0, 0.0, p[kn.TIP_P], p[kn.TIP_G]
    for i in range(int(own[kn.OWN_FAULTS])):
        row = kn.OWN_ERRORS + 2 * (z_p + z_g) + kn.FAULT_COLUMNS * i
        of_gear = own[row + kn.FAULT_GEAR] == 1.0
        if own[row + kn.FAULT_TOOTH] != (gear if of_gear else pinion):
            continue
        end, radius = own[row + kn.FLANK_END], p[kn.RADIUS_G] if of_gear else p[kn.RADIUS_P]
        sense, place = (-1.0, p[kn.L_XY] - xi) if of_gear else (1.0, xi)
        if of_gear:
            tip_g = min(tip_g, end)
        else:
            tip_p = min(tip_p, end)
        if place > end:
            sense, place = 0.0, end
        turn = place / radius - own[row + kn.HALF_TOOTH]
        arm = radius - own[row + kn.ROOT] * math.cos(turn)
        softer += own[row + kn.CRACK] * arm * arm
        slope += sense * 2.0 * own[row + kn.CRACK] * arm * own[row + kn.ROOT] * math.sin(turn) / radius
        if own[row + kn.SPALL_START] <= place < own[row + kn.SPALL_END]:
            softer += own[row + kn.SPALL]
            error += own[row + kn.PIT]
    return OwnPair(error, rise, softer, slope, tip_p, tip_g)
