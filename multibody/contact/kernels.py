"""Forces of the tooth contacts for one state of the two bodies: the compiled heart of the exact model.

State: q = (x_p, y_p, phi_p, x_g, y_g, phi_g), deviations from the nominal position and rotation, world axes
x, y, angles counter-clockwise. In the drive sense the pinion turns clockwise and the gear counter-clockwise.
"""

from __future__ import annotations

import math

import numpy as np

from lumped.compiler import compiled
from lumped.typing import FloatArray, IntArray
from multibody.contact import kinematics as kn
from multibody.contact.elements import (
    GRADUAL,
    coupling_at,
    elastic_load,
    gradual,
    law_at,
    relief_at,
    shared_loads,
    stiffness_and_slope,
    stored_energy,
)
from multibody.contact.friction import nominal_friction, signed_friction
from multibody.contact.kinematics import (
    COAST,
    DRIVE,
    Corners,
    OwnPair,
    add_gradient,
    add_wrench,
    corners_at,
    engaged,
    mesh_position,
    move_moments,
    off_axis,
    overlap_rate,
    ripple_torques,
    sliding_velocity,
    tooth_pair,
)


@compiled
def contact_forces(
    t: float, state: FloatArray, p: FloatArray, flags: int, table: FloatArray, contacts: FloatArray
) -> int:
    """Wrench of all tooth contacts and one record per contact at time t [s].

    state : (3, 6) deviations from nominal position and rotation [m, rad], their rates, and the wrench,
        which is written: (Fx, Fy, M) of pinion and gear [N, N m]; one array, for each costs Python time
    p, flags, table : parameters and effect switches of ``kinematics``, stiffness
    contacts : (2 MAX_PAIRS, N_RECORD) receives the records, drive flank first; back sides only when pressed
    Returns number of contacts, or -1 when a force is not finite
    """
    q = state[0]
    v = state[1]
    wrench = state[2]
    wrench[:] = 0.0
    rp, rg = p[kn.RADIUS_P], p[kn.RADIUS_G]
    teeth = p[int(p[kn.OWN]) :]
    if p[kn.OWN] > 0.0:
        centres = off_axis(teeth, t, state, p[kn.OMEGA_P], p[kn.OMEGA_G])
        ripples = ripple_torques(teeth, t, state[0], p[kn.OMEGA_P], p[kn.OMEGA_G])
        q, v = centres[0], centres[1]
    turned_p = p[kn.L_XA] + rp * (p[kn.OMEGA_P] * t - q[2])
    turned_g = p[kn.L_XY] - p[kn.L_XA] - rg * (p[kn.OMEGA_G] * t + q[5])
    omega_p, omega_g = v[2] - p[kn.OMEGA_P], v[5] + p[kn.OMEGA_G]
    vx, vy = v[0] - v[3], v[1] - v[4]
    unilateral = (flags & kn.CONTACT_LOSS) != 0
    coupled = p[kn.COUPLED] > 0.0 and (flags & kn.NEIGHBOURS) != 0
    softening = p[kn.SOFTENING] if flags & kn.CONTACT_LAW else 0.0
    nominal = p[kn.NOMINAL_FORCE]
    # One array, for each costs as much as a contact's geometry.
    known = np.empty((kn.N_STATE, kn.MAX_PAIRS))
    arms = known[kn.ARMS : kn.COUPLINGS].reshape((kn.MAX_PAIRS, 2))
    coupling = known[kn.COUPLINGS : kn.SLOPES]
    count = int(np.int64(0))
    for side in range(2 if flags & kn.BACK_SIDE else 1):
        flank = DRIVE if side == 0 else COAST
        own_teeth = OwnPair(0.0, 0.0, 0.0, 0.0, p[kn.TIP_P], p[kn.TIP_G], 0.0, 0.0)
        line, delta, rho, _ = mesh_position(t, q, p, flags, flank)
        ex = line.ex
        ey = line.ey
        length = line.length
        if not math.isfinite(delta):
            return -1
        # The nominal speeds roll, and would only blur it.
        rate = overlap_rate(line, vx, vy, v[2], v[5])
        # d(psi)/dt = s n . (v_g - v_p)/L, from differentiating e.
        psi_rate = length_rate = 0.0
        if flags & kn.MOVING_LINE:
            psi_rate = (ey * vx - ex * vy) / length
            length_rate = flank * (rp + rg) * psi_rate - (ex * vx + ey * vy)
        wp, wg = (omega_p, omega_g) if flags & kn.ROTATION_PHASE else (-p[kn.OMEGA_P], p[kn.OMEGA_G])
        xi_rate = 0.5 * flank * (rp * (psi_rate - wp) - rg * (psi_rate - wg))
        candidates = engaged(rho, delta, length, p, flags, arms)
        bound = pairs = int(np.int64(0))  # bound: bits of pairs that cannot lose contact
        for candidate in range(candidates):
            rho_p = arms[candidate, 0]
            rho_g = arms[candidate, 1]
            i = pairs
            xi = 0.5 * (rho_p - rho_g + p[kn.L_XY])
            if p[kn.OWN] > 0.0 and side == 0:
                own_teeth = tooth_pair(teeth, p, turned_p, turned_g, arms[candidate], xi)
            late = own_teeth.error
            tip_p = own_teeth.tip_p
            tip_g = own_teeth.tip_g
            more_p, more_g = own_teeth.relief_p, own_teeth.relief_g
            error, error_slope = relief_at(p, xi, more_p, more_g)
            error_slope += own_teeth.rise
            pressed = delta - error - late
            pressing = rate - error_slope * xi_rate
            corners = Corners(0.0, 0.0, 0.0, 0.0)
            beyond = False
            if flags & kn.TIP_CONTACT:
                if xi < p[kn.L_XA] or xi > p[kn.L_XD]:
                    error_slope = 0.0
                    held = min(max(xi, p[kn.L_XA]), p[kn.L_XD])
                    error = relief_at(p, held, more_p, more_g)[0]
                edges = p[kn.EDGE_P], p[kn.EDGE_G]
                corners = corners_at(line, rho_p, rho_g, (tip_p, tip_g), edges)
                beyond = rho_p > tip_p or rho_g > tip_g or rho_p < edges[0] or rho_g < edges[1]
                pressed = delta - error - late - corners.gap
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
            arms[i, 0] = rho_p
            arms[i, 1] = rho_g
            if not (unilateral or beyond):
                bound |= 1 << i
            known[kn.POSITION, i] = xi
            known[kn.PRESSED, i] = pressed
            known[kn.PRESSING, i] = pressing
            known[kn.RELIEF_SLOPE, i] = error_slope
            known[kn.BY_P, i] = corners.by_p
            known[kn.BY_G, i] = corners.by_g
            known[kn.BY_L, i] = corners.by_length
            k, slope = stiffness_and_slope(table, xi)
            share = 1.0 / (1.0 + own_teeth.softer * k)
            known[kn.STIFFNESS, i] = share * k
            known[kn.SLOPE, i] = share * share * (slope - k * k * own_teeth.slope)
            known[kn.BEYOND, i] = 1.0 if beyond or rho_p > tip_p or rho_g > tip_g else 0.0
            if not coupled:
                load = elastic_load(pressed, known[kn.STIFFNESS, i], softening, nominal)
                known[kn.NORMAL, i] = load if bound >> i & 1 else max(load, 0.0)
        if coupled:
            for i in range(pairs):
                coupling[i, i] = 0.0
                for j in range(i):
                    # The newest pair, furthest behind, comes first.
                    moved, moved_slope = coupling_at(p, i - j, known[kn.POSITION, j])
                    coupling[i, j] = coupling[j, i] = moved
                    known[kn.SLOPES + i, j] = known[kn.SLOPES + j, i] = moved_slope
            pressed_by = known[kn.PRESSED]
            stiff = known[kn.STIFFNESS]
            loads = known[kn.NORMAL]
            shared_loads(pairs, pressed_by, stiff, bound, coupling, softening, nominal, loads)
        for i in range(pairs):
            xi = known[kn.POSITION, i]
            pressed = known[kn.PRESSED, i]
            pressing = known[kn.PRESSING, i]
            elastic = known[kn.NORMAL, i]
            stiffness = known[kn.STIFFNESS, i]
            error_slope = known[kn.RELIEF_SLOPE, i]
            own = pressed
            moved = 0.0
            moved_slope = 0.0
            if coupled:
                for j in range(pairs):
                    if j != i:
                        moved += coupling[i, j] * known[kn.NORMAL, j]
                        moved_slope += known[kn.SLOPES + i, j] * known[kn.NORMAL, j]
                own -= moved
            beyond = known[kn.BEYOND, i] == 1.0
            if own <= 0.0 and (beyond or (side == 1 and unilateral)):
                continue
            arm_p = 0.5 * (arms[i, 0] - arms[i, 1] + length)
            arm_g = length - arm_p
            damping = p[kn.DAMPING] * math.sqrt(max(stiffness, 0.0))
            if flags & kn.TIP_CONTACT:
                damping *= gradual(elastic / (GRADUAL * nominal))
            stored, stored_slope = stored_energy(elastic, stiffness, known[kn.SLOPE, i], softening, nominal)
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
            if flags & (kn.PATH_WORK | kn.TIP_CONTACT):
                along = 0.5 * path if flags & kn.PATH_WORK else 0.0
                by_p, by_g = normal * known[kn.BY_P, i] + along, normal * known[kn.BY_G, i] - along
                add_gradient(wrench, line, by_p, by_g, normal * known[kn.BY_L, i])
            record = contacts[count]
            record[kn.XI] = xi
            record[kn.LOAD] = normal
            record[kn.MU] = mu
            record[kn.FRICTION_FORCE] = mu * normal
            record[kn.K] = stiffness
            record[kn.C] = damping
            record[kn.SLIDE] = slide
            record[kn.OVERLAP] = pressed
            record[kn.OVERLAP_RATE] = pressing
            record[kn.FLANK] = flank
            record[kn.CLOSING] = rate
            record[kn.ELASTIC] = elastic
            record[kn.ENERGY] = stored
            record[kn.PATH] = path
            record[kn.PATH_RATE] = xi_rate
            count += 1
    if p[kn.OWN] > 0.0:
        move_moments(centres[2], wrench)
        wrench[2] -= ripples[0]
        wrench[5] -= ripples[1]
    total = 0.0
    for i in range(6):
        total += wrench[i]
    return count if math.isfinite(total) else -1


@compiled
def linear_forces(
    t: float, state: FloatArray, p: FloatArray, flags: int, table: FloatArray, contacts: FloatArray
) -> int:
    """Forces on (x_p, y_p, phi_p, x_g, y_g, phi_g) in the lumped model; arguments as ``contact_forces``.

    Of the flags ``CONTACT_LOSS`` acts: a pair loads where its flanks overlap and that pushes. No back sides.
    """
    q = state[0]
    v = state[1]
    wrench = state[2]
    wrench[:] = 0.0
    rp = p[kn.RADIUS_P]
    rg = p[kn.RADIUS_G]
    pitch = p[kn.PITCH]
    tau = min(max(t, p[kn.T_LOW]), p[kn.T_HIGH])
    speed = p[kn.OMEGA_P] * rp
    advance = speed * tau
    advance -= pitch * math.floor(advance / pitch)
    delta = q[0] - q[3] - rp * q[2] - rg * q[5]
    rate = v[0] - v[3] - rp * v[2] - rg * v[5]
    count = 0
    k = int(p[kn.K_ROWS])
    c = int(p[kn.C_ROWS])
    e = int(p[kn.E_ROWS])
    gap = int(p[kn.GAP_ROWS])
    tilted = k + c + e + gap
    closed = tilted + int(p[kn.TILT_ROWS])
    loaded = k > 0
    first, last = (table[0, 0], table[k - 1, 1]) if loaded else (p[kn.L_XA], p[kn.L_XD])
    xi = p[kn.L_XA] + advance - pitch * math.floor((p[kn.L_XA] + advance - first) / pitch)
    while xi <= last:
        mu = nominal_friction(p, xi)
        if loaded:
            stiffness, stiffness_slope = law_at(table, int(np.int64(0)), k - 1, xi)
            damping = law_at(table, k, k + c - 1, xi)[0]
            error = law_at(table, k + c, k + c + e - 1, xi)[0]
            slope = law_at(table, k + c + e, k + c + e + gap - 1, xi)[1]
            tilt = law_at(table, tilted, closed - 1, xi)[0]
            closing = law_at(table, closed, table.shape[0] - 1, xi)[0]
        else:
            tilt = 0.0
            closing = 1.0
            error, slope = relief_at(p, xi, 0.0, 0.0)
            stiffness, stiffness_slope = stiffness_and_slope(table, xi)
            damping = p[kn.DAMPING] * math.sqrt(max(stiffness, 0.0))
        pressed = delta - error
        pressing = rate - slope * speed
        normal = stiffness * pressed + damping * pressing
        if flags & kn.CONTACT_LOSS and (pressed <= 0.0 or normal < 0.0):
            stiffness = damping = normal = 0.0
        friction = mu * normal
        apart = tilt * normal
        wrench[0] -= normal
        wrench[1] += friction - apart
        wrench[2] += rp * normal + xi * friction
        wrench[3] += normal
        wrench[4] -= friction - apart
        wrench[5] += rg * normal + (p[kn.L_XY] - xi) * friction
        record = contacts[count]
        record[kn.XI] = xi
        record[kn.LOAD] = normal
        record[kn.FRICTION_FORCE] = friction
        record[kn.MU] = mu
        record[kn.K] = stiffness
        record[kn.C] = damping
        record[kn.FLANK] = 1.0
        # The approach moves a tip corner's contact outside, and closes it by less than itself.
        record[kn.OVERLAP] = pressed
        record[kn.OVERLAP_RATE] = closing * pressing
        record[kn.CLOSING] = rate
        gear_arm = p[kn.L_XY] - xi
        slide = (p[kn.OMEGA_P] - v[2]) * xi - (p[kn.OMEGA_G] + v[5]) * gear_arm - (v[1] - v[4])
        record[kn.SLIDE] = slide
        record[kn.ELASTIC] = stiffness * pressed
        record[kn.ENERGY] = 0.5 * stiffness * pressed**2
        # The damper works on the gap itself, the spring on the error that stands for it with loaded contact.
        error_slope = law_at(table, k + c, k + c + e - 1, xi)[1] if loaded else slope
        elastic = stiffness * pressed
        damper = normal - elastic
        path = elastic * error_slope + damper * (closing * slope + (1.0 - closing) * rate / speed)
        path -= 0.5 * stiffness_slope * pressed * pressed
        record[kn.PATH] = path - apart * (v[4] - v[1]) / speed
        record[kn.PATH_RATE] = speed
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
    if flags & kn.LINEAR:
        return linear_forces(t, state, p, flags, table, contacts)
    return contact_forces(t, state, p, flags, table, contacts)


def tooth_forces_over(
    times: FloatArray, q: FloatArray, v: FloatArray, p: FloatArray, flags: int, table: FloatArray
) -> tuple[FloatArray, FloatArray, IntArray]:
    """``tooth_forces`` at n times [s] with states q, v (n, 6 or more); a kernel would compile for a second.

    Returns wrenches (n, 6), contact records (n, 2 MAX_PAIRS, N_RECORD), and how many of each count (n,)
    """
    wrenches = np.empty((times.size, 6))
    counts = np.empty(times.size, np.int64)
    contacts = np.zeros((times.size, 2 * kn.MAX_PAIRS, kn.N_RECORD))
    state = np.empty((3, 6))
    for i, t in enumerate(times.tolist()):
        state[0] = q[i, :6]
        state[1] = v[i, :6]
        counts[i] = tooth_forces(t, state, p, flags, table, contacts[i])
        wrenches[i] = state[2]
    return wrenches, contacts, counts
