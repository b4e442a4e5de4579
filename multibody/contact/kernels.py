"""Forces of the tooth contacts for one state of the two bodies: the compiled heart of the exact model.

The geometry comes from ``multibody.contact.kinematics`` and the friction laws from
``multibody.contact.friction``; this file adds stiffness, damping and relief of a tooth pair, and the switches
of the finite-motion effects (``multibody.run.effects``).

State: q = (x_p, y_p, phi_p, x_g, y_g, phi_g), deviations from the nominal position and rotation, world axes
x, y, angles counter-clockwise. In the drive sense the pinion turns clockwise and the gear counter-clockwise.
"""

from __future__ import annotations

import math

import numpy as np

from lumped.path_function import FIT_DEGREE
from lumped.typing import FloatArray, IntArray
from multibody.contact import friction as fr
from multibody.contact.elements import (
    elastic_load,
    gradual,
    law_at,
    shared_loads,
    stiffness_and_slope,
    stiffness_at,
    stored_energy,
)
from multibody.contact.kinematics import (
    COAST,
    DRIVE,
    MAX_PAIRS,
    Corners,
    Line,
    add_gradient,
    add_wrench,
    compiled,
    corners_at,
    line_of_action,
    mesh_phase,
    overlap_rate,
    pairs_in_contact,
    sliding_velocity,
)

# Bits of the effect switches, and of the linear mesh, which has none of the effects.
ROTATION_PHASE, MOVING_LINE, SLIDING, ENTRY_SHIFT, CONTACT_LOSS, BACK_SIDE, LINEAR = 1, 2, 4, 8, 16, 32, 64
FRICTION_LOAD, PATH_WORK, TIP_CONTACT, CONTACT_LAW, NEIGHBOURS, CLEARANCE = 128, 256, 512, 1024, 2048, 4096

# Places in the parameter vector. Lengths in m, angles in rad, speeds in rad/s.
(
    RADIUS_P, RADIUS_G, PITCH, TIP_P, TIP_G,  # base radii, base pitch, tangent lengths of the tip circles
    CHI_P, APART, CHI_P_BACK, APART_BACK,  # chi_p and overlap of mesh_phase: drive and coast side
    CENTRE_PX, CENTRE_PY, CENTRE_GX, CENTRE_GY,  # nominal centres
    L_XA, L_XP, L_XD, L_XY,  # nominal path of contact
    OMEGA_P, OMEGA_G,  # nominal speeds
    V_REG,  # velocity over which friction changes sign; 0 = at once
    T_LOW, T_HIGH,  # the nominal phase is clamped to this open time interval (a smooth segment)
    DAMPING,  # c/sqrt(k) of a tooth pair, 2 zeta sqrt(m_e) [sqrt(kg)]
    SOFTENING, NOMINAL_FORCE,  # D of Hertz's contact [m/N], and the load at which the table's k holds [N]
    K_ROWS, C_ROWS, E_ROWS,  # rows of k, c, e in the table of the linear mesh with loaded contact, or 0
    RELIEFS,  # number of reliefs that act
    FIRST_RELIEF,  # of each: gear, roll angles of start and end [rad], amount [m], power of growth
) = range(30)  # fmt: skip
#: Columns of one relief, and the most reliefs: tip and root of both flanks.
RELIEF_COLUMNS, MOST_RELIEFS = 5, 4
#: Where the parameters of the friction laws start, see ``multibody.contact.friction``.
FRICTION = FIRST_RELIEF + RELIEF_COLUMNS * MOST_RELIEFS
#: How far pairs 1, 2, ... base pitches apart move each other: the number of such functions, then each as
#: a row of ``elements.stiffness_and_slope`` over the position of the pair behind [m/N].
COUPLED = FRICTION + fr.N_FRICTION
FIRST_COUPLED, COUPLED_COLUMNS = COUPLED + 1, FIT_DEGREE + 3
#: The rows of ``friction_size``'s table, if there is one, stand behind all others.
N_PARAMETERS = FIRST_COUPLED + COUPLED_COLUMNS * (MAX_PAIRS - 1)

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
    POSITION, PRESSED, PRESSING, RELIEF_SLOPE, BY_P, BY_G, BY_L, STIFFNESS, SLOPE, NORMAL, ARMS,
) = range(11)  # fmt: skip
# The flank distances take two rows; behind them stand how pairs move each other, and its slopes.
COUPLINGS = ARMS + 2
SLOPES = COUPLINGS + MAX_PAIRS
N_STATE = SLOPES + MAX_PAIRS

#: How far beyond the tips contact is looked for, over the base pitch.
_REACH = 0.4
#: Where teeth touch beyond their tips the damper takes hold gradually: it is whole at this share of the mean
#: load. Acting at once it would make the load jump by c times the speed of approach at the first touch.
GRADUAL = 1.0 / 15.0


@compiled
def relief_at(p: FloatArray, xi: float) -> tuple[float, float]:
    """Material missing from both flanks that touch at xi [m], and its slope over xi.

    Each relief grows over the roll angle of its own gear, the flank's distance from the base circle over the
    base radius, from its start to the end of the flank.
    """
    error = slope = 0.0
    for i in range(int(p[RELIEFS])):
        row = FIRST_RELIEF + RELIEF_COLUMNS * i
        pinion = p[row] == 0.0
        sense = 1.0 / p[RADIUS_P] if pinion else -1.0 / p[RADIUS_G]
        roll = xi / p[RADIUS_P] if pinion else (p[L_XY] - xi) / p[RADIUS_G]
        width = p[row + 2] - p[row + 1]
        share = (roll - p[row + 1]) / width
        if share > 0.0:
            power = p[row + 4]
            error += p[row + 3] * share**power
            slope += p[row + 3] * power * share ** (power - 1.0) * sense / width
    return error, slope


@compiled
def friction_size(
    p: FloatArray, slide: float, rolling: float, rho_p: float, rho_g: float, distance: float, load: float
) -> float:
    """Size of the friction coefficient at one contact, see ``friction.magnitude``.

    A law without a formula there is read from the lumped model's table, where the nominal motion slides as
    fast.
    """
    f = p[FRICTION:]
    if f[fr.LAW] == fr.TABLE:
        table = p[N_PARAMETERS:].reshape((-1, int(f[fr.COLUMNS])))
        return abs(stiffness_at(table, p[L_XP] + distance))
    return float(fr.magnitude(f, slide, rolling, rho_p, rho_g, distance, load))


@compiled
def nominal_friction(p: FloatArray, xi: float) -> float:
    """Signed friction coefficient of the nominal motion at xi, under the full static load w_n."""
    f = p[FRICTION:]
    distance = xi - p[L_XP]
    sliding = (p[OMEGA_P] + p[OMEGA_G]) * abs(distance)
    rho_g = p[L_XY] - xi
    rolling = p[OMEGA_P] * xi + p[OMEGA_G] * rho_g
    mu = friction_size(p, sliding, rolling, xi, rho_g, distance, f[fr.NOMINAL_LOAD])
    return math.copysign(mu, distance) if distance != 0.0 else 0.0


@compiled
def signed_friction(
    p: FloatArray,
    flags: int,
    flank: float,
    xi: float,
    slide: float,
    rolling: float,
    rho_p: float,
    rho_g: float,
    normal: float,
) -> float:
    """Friction coefficient with the sign of the sliding velocity, by the law at this contact.

    Without the effect of the actual sliding velocity the contact slides and rolls as in the nominal motion at
    xi, without that of the momentary load it carries w_n.

    slide, rolling : actual sliding velocity and sum of the rolling velocities [m/s]
    normal : load of the contact [N]
    """
    f = p[FRICTION:]
    load = max(normal, 0.0) / f[fr.FACE_WIDTH] if flags & FRICTION_LOAD else f[fr.NOMINAL_LOAD]
    speeds = p[OMEGA_P] + p[OMEGA_G]
    if not flags & SLIDING:
        slide, rho_p, rho_g = flank * speeds * (xi - p[L_XP]), xi, p[L_XY] - xi
        rolling = p[OMEGA_P] * rho_p + p[OMEGA_G] * rho_g
    if slide == 0.0:
        return 0.0
    mu = friction_size(p, abs(slide), rolling, rho_p, rho_g, slide / speeds, load)
    if flags & SLIDING and p[V_REG] > 0.0:
        return mu * math.tanh(slide / p[V_REG])
    return math.copysign(mu, slide)


@compiled
def mesh_position(
    t: float, q: FloatArray, p: FloatArray, flags: int, flank: float
) -> tuple[Line, float, float, float]:
    """Line of action of one side of the teeth, and where they stand on it; arguments as ``contact_forces``.

    Returns (line, delta, rho, xi) : the line; overlap; flank distance rho_p of one tooth pair from X, with
        which ``engaged`` finds the pairs in contact, and its position on the path of contact [m]. The other
        pairs follow at whole pitches
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
    if flags & TIP_CONTACT:  # candidates; those beyond the tips touch where they press
        reach = _REACH * p[PITCH]
        return pairs_in_contact(rho, delta, length, p[PITCH], p[TIP_P] + reach, p[TIP_G] + reach, arms)
    if flags & ENTRY_SHIFT:
        return pairs_in_contact(rho, delta, length, p[PITCH], p[TIP_P], p[TIP_G], arms)
    return pairs_in_contact(rho, 0.0, p[L_XY], p[PITCH], p[L_XD], p[L_XY] - p[L_XA], arms)


@compiled
def coupling_at(p: FloatArray, apart: int, xi: float) -> tuple[float, float]:
    """Motion of a pair by a unit load on one ``apart`` pitches off, the one behind at xi; its slope [m/N]."""
    if apart > p[COUPLED]:
        return 0.0, 0.0
    first = FIRST_COUPLED + COUPLED_COLUMNS * (apart - 1)
    row = p[first : first + COUPLED_COLUMNS].reshape((1, COUPLED_COLUMNS))
    return stiffness_and_slope(row, xi)


@compiled
def contact_forces(
    t: float, state: FloatArray, p: FloatArray, flags: int, table: FloatArray, contacts: FloatArray
) -> int:
    """Wrench of all tooth contacts and one record per contact.

    t : time [s]
    state : (3, 6) deviations from nominal position and rotation, and their rates [m, rad, s]; and the wrench,
        which is written: (Fx, Fy, M) of pinion and gear [N, N m]. One array, for each costs Python
        time when it is handed over
    p : (N_PARAMETERS,) parameters in the order named above
    flags : effect switches, a sum of bits
    table : the stiffness, see ``elements.stiffness_and_slope``
    contacts : (2 MAX_PAIRS, N_RECORD) receives the records, drive flank first; back sides only when pressed
    Returns number of contacts, or -1 when a force is not finite
    """
    q, v, wrench = state[0], state[1], state[2]
    wrench[:] = 0.0
    rp, rg = p[RADIUS_P], p[RADIUS_G]
    omega_p, omega_g = v[2] - p[OMEGA_P], v[5] + p[OMEGA_G]
    vx, vy = v[0] - v[3], v[1] - v[4]
    unilateral = (flags & CONTACT_LOSS) != 0
    coupled = p[COUPLED] > 0.0 and (flags & NEIGHBOURS) != 0
    softening, nominal = p[SOFTENING] if flags & CONTACT_LAW else 0.0, p[NOMINAL_FORCE]
    # One array, for each costs as much as a contact's geometry.
    known = np.empty((N_STATE, MAX_PAIRS))
    arms, coupling = known[ARMS:COUPLINGS].reshape((MAX_PAIRS, 2)), known[COUPLINGS:SLOPES]
    count = int(np.int64(0))
    for side in range(2 if flags & BACK_SIDE else 1):
        flank = DRIVE if side == 0 else COAST
        line, delta, rho, _ = mesh_position(t, q, p, flags, flank)
        ex, ey, length = line.ex, line.ey, line.length
        if not math.isfinite(delta):
            return -1
        # The nominal speeds roll, and would only blur it.
        rate = overlap_rate(line, vx, vy, v[2], v[5])
        # d(psi)/dt = s n . (v_g - v_p)/L, from differentiating e.
        psi_rate = length_rate = 0.0
        if flags & MOVING_LINE:
            psi_rate = (ey * vx - ex * vy) / length
            length_rate = flank * (rp + rg) * psi_rate - (ex * vx + ey * vy)
        wp, wg = (omega_p, omega_g) if flags & ROTATION_PHASE else (-p[OMEGA_P], p[OMEGA_G])
        xi_rate = 0.5 * flank * (rp * (psi_rate - wp) - rg * (psi_rate - wg))
        candidates = engaged(rho, delta, length, p, flags, arms)
        bound = pairs = int(np.int64(0))  # bound: bits of pairs that cannot lose contact
        for candidate in range(candidates):
            rho_p, rho_g, i = arms[candidate, 0], arms[candidate, 1], pairs
            xi = 0.5 * (rho_p - rho_g + p[L_XY])
            error, error_slope = relief_at(p, xi)
            pressed, pressing = delta - error, rate - error_slope * xi_rate
            corners, beyond = Corners(0.0, 0.0, 0.0, 0.0), False
            if flags & TIP_CONTACT:
                if xi < p[L_XA] or xi > p[L_XD]:
                    error, error_slope = relief_at(p, min(max(xi, p[L_XA]), p[L_XD]))[0], 0.0
                corners = corners_at(line, rho_p, rho_g, p[TIP_P], p[TIP_G])
                beyond = rho_p > p[TIP_P] or rho_g > p[TIP_G]
                pressed = delta - error - corners.gap
                if beyond and pressed < -abs(delta):
                    continue  # further apart than any neighbour could move it
                pressing = (
                    rate
                    - error_slope * xi_rate
                    - corners.by_p * flank * rp * (psi_rate - omega_p)
                    - corners.by_g * flank * rg * (psi_rate - omega_g)
                    - corners.by_length * length_rate
                )
            pairs += 1
            arms[i, 0], arms[i, 1] = rho_p, rho_g
            if not (unilateral or beyond):
                bound |= 1 << i
            known[POSITION, i], known[PRESSED, i], known[PRESSING, i] = xi, pressed, pressing
            known[RELIEF_SLOPE, i] = error_slope
            known[BY_P, i], known[BY_G, i], known[BY_L, i] = corners.by_p, corners.by_g, corners.by_length
            known[STIFFNESS, i], known[SLOPE, i] = stiffness_and_slope(table, xi)
            if not coupled:
                load = elastic_load(pressed, known[STIFFNESS, i], softening, nominal)
                known[NORMAL, i] = load if bound >> i & 1 else max(load, 0.0)
        if coupled:
            for i in range(pairs):
                coupling[i, i] = 0.0
                for j in range(i):
                    # The newest pair, furthest behind, comes first.
                    moved, moved_slope = coupling_at(p, i - j, known[POSITION, j])
                    coupling[i, j] = coupling[j, i] = moved
                    known[SLOPES + i, j] = known[SLOPES + j, i] = moved_slope
            pressed_by, stiff, loads = known[PRESSED], known[STIFFNESS], known[NORMAL]
            shared_loads(pairs, pressed_by, stiff, bound, coupling, softening, nominal, loads)
        for i in range(pairs):
            xi, pressed, pressing = known[POSITION, i], known[PRESSED, i], known[PRESSING, i]
            elastic, stiffness, error_slope = known[NORMAL, i], known[STIFFNESS, i], known[RELIEF_SLOPE, i]
            own, moved, moved_slope = pressed, 0.0, 0.0
            if coupled:
                for j in range(pairs):
                    if j != i:
                        moved += coupling[i, j] * known[NORMAL, j]
                        moved_slope += known[SLOPES + i, j] * known[NORMAL, j]
                own -= moved
            beyond = arms[i, 0] > p[TIP_P] or arms[i, 1] > p[TIP_G]
            if own <= 0.0 and (beyond or (side == 1 and unilateral)):
                continue
            arm_p = 0.5 * (arms[i, 0] - arms[i, 1] + length)
            arm_g = length - arm_p
            damping = p[DAMPING] * math.sqrt(max(stiffness, 0.0))
            if flags & TIP_CONTACT:
                damping *= gradual(elastic / (GRADUAL * nominal))
            stored, stored_slope = stored_energy(elastic, stiffness, known[SLOPE, i], softening, nominal)
            # Half of w_ij N_i N_j is counted at either pair, and half of its slope at constant compression.
            stored += 0.5 * elastic * moved
            stored_slope -= 0.5 * elastic * moved_slope
            if unilateral and own <= 0.0:
                damping = 0.0
            normal = elastic + damping * pressing
            if unilateral and normal < 0.0:
                normal = 0.0
            path = normal * error_slope - stored_slope
            slide = sliding_velocity(line, vx, vy, omega_p, omega_g, arm_p, arm_g)
            # Each surface against the contact point, which turns with the line of action.
            rolling = flank * (arm_p * (psi_rate - omega_p) + arm_g * (omega_g - psi_rate))
            mu = signed_friction(p, flags, flank, xi, slide, rolling, arm_p, arm_g, normal)
            add_wrench(wrench, line, normal, mu * normal, arm_p, arm_g)
            if flags & (PATH_WORK | TIP_CONTACT):
                along = 0.5 * path if flags & PATH_WORK else 0.0
                by_p, by_g = normal * known[BY_P, i] + along, normal * known[BY_G, i] - along
                add_gradient(wrench, line, by_p, by_g, normal * known[BY_L, i])
            record = contacts[count]
            record[XI], record[LOAD], record[FRICTION_FORCE], record[MU] = xi, normal, mu * normal, mu
            record[K], record[C], record[SLIDE] = stiffness, damping, slide
            record[OVERLAP], record[OVERLAP_RATE], record[FLANK] = pressed, pressing, flank
            record[CLOSING], record[ELASTIC], record[ENERGY] = rate, elastic, stored
            record[PATH], record[PATH_RATE] = path, xi_rate
            count += 1
    total = 0.0
    for i in range(6):
        total += wrench[i]
    return count if math.isfinite(total) else -1


@compiled
def linear_forces(
    t: float, state: FloatArray, p: FloatArray, flags: int, table: FloatArray, contacts: FloatArray
) -> int:
    """Generalised forces on (x_p, y_p, phi_p, x_g, y_g, phi_g); arguments as ``contact_forces``.

    The recorded sliding velocity does not act on the friction. With phi_p = -theta_p and phi_g = theta_g the
    overlap is the dynamic transmission error delta = r_bp theta_p - r_bg theta_g + x_p - x_g. Of the flags
    ``CONTACT_LOSS`` acts: a pair loads where its flanks overlap and that pushes. There are no back sides.
    """
    q, v, wrench = state[0], state[1], state[2]
    wrench[:] = 0.0
    rp, rg, pitch = p[RADIUS_P], p[RADIUS_G], p[PITCH]
    tau = min(max(t, p[T_LOW]), p[T_HIGH])
    speed = p[OMEGA_P] * rp
    advance = speed * tau
    advance -= pitch * math.floor(advance / pitch)
    delta = q[0] - q[3] - rp * q[2] - rg * q[5]
    rate = v[0] - v[3] - rp * v[2] - rg * v[5]
    count = 0
    k, c, e = int(p[K_ROWS]), int(p[C_ROWS]), int(p[E_ROWS])
    loaded = k > 0
    first, last = (table[0, 0], table[k - 1, 1]) if loaded else (p[L_XA], p[L_XD])
    xi = p[L_XA] + advance - pitch * math.floor((p[L_XA] + advance - first) / pitch)
    while xi <= last:
        mu = nominal_friction(p, xi)
        if loaded:
            stiffness, stiffness_slope = law_at(table, int(np.int64(0)), k - 1, xi)
            damping = law_at(table, k, k + c - 1, xi)[0]
            error = law_at(table, k + c, k + c + e - 1, xi)[0]
            slope = law_at(table, k + c + e, table.shape[0] - 1, xi)[1]
        else:
            error, slope = relief_at(p, xi)
            stiffness, stiffness_slope = stiffness_and_slope(table, xi)
            damping = p[DAMPING] * math.sqrt(max(stiffness, 0.0))
        pressed, pressing = delta - error, rate - slope * speed
        normal = stiffness * pressed + damping * pressing
        if flags & CONTACT_LOSS and (pressed <= 0.0 or normal < 0.0):
            stiffness = damping = normal = 0.0
        friction = mu * normal
        wrench[0] -= normal
        wrench[1] += friction
        wrench[2] += rp * normal + xi * friction
        wrench[3] += normal
        wrench[4] -= friction
        wrench[5] += rg * normal + (p[L_XY] - xi) * friction
        record = contacts[count]
        record[XI], record[LOAD], record[FRICTION_FORCE], record[MU] = xi, normal, friction, mu
        record[K], record[C], record[FLANK] = stiffness, damping, 1.0
        record[OVERLAP], record[OVERLAP_RATE], record[CLOSING] = pressed, pressing, rate
        gear_arm = p[L_XY] - xi
        slide = (p[OMEGA_P] - v[2]) * xi - (p[OMEGA_G] + v[5]) * gear_arm - (v[1] - v[4])
        record[SLIDE] = slide
        record[ELASTIC], record[ENERGY] = stiffness * pressed, 0.5 * stiffness * pressed**2
        # The damper works on the gap itself, the spring on the error that stands for it with loaded contact.
        error_slope = law_at(table, k + c, k + c + e - 1, xi)[1] if loaded else slope
        elastic = stiffness * pressed
        path = elastic * error_slope + (normal - elastic) * slope
        record[PATH] = path - 0.5 * stiffness_slope * pressed * pressed
        record[PATH_RATE] = speed
        count += 1
        xi += pitch
    total = 0.0
    for i in range(6):
        total += wrench[i]
    return count if math.isfinite(total) else -1


@compiled
def tooth_forces(
    t: float, state: FloatArray, p: FloatArray, flags: int, table: FloatArray, contacts: FloatArray
) -> int:
    """Wrench and contact records of one state; arguments and result as ``contact_forces``."""
    if flags & LINEAR:
        return linear_forces(t, state, p, flags, table, contacts)
    return contact_forces(t, state, p, flags, table, contacts)


@compiled
def tooth_forces_over(
    times: FloatArray,
    q: FloatArray,
    v: FloatArray,
    p: FloatArray,
    flags: int,
    table: FloatArray,
    wrenches: FloatArray,
    contacts: FloatArray,
) -> IntArray:
    """``tooth_forces`` at n states; returns the numbers of contacts (n,).

    times (n,) [s]; q, v, wrenches (n, 6); contacts (n, 2 MAX_PAIRS, N_RECORD); the rest as ``tooth_forces``
    """
    counts, state = np.empty(times.size, np.int64), np.empty((3, 6))
    for i in range(times.size):
        for j in range(6):
            state[0, j], state[1, j] = q[i, j], v[i, j]
        counts[i] = tooth_forces(times[i], state, p, flags, table, contacts[i])
        for j in range(6):
            wrenches[i, j] = state[2, j]
    return counts
