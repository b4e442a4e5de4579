"""Forces of the tooth contacts for one state of the two bodies: the compiled heart of the exact model.

The geometry comes from ``multibody.contact.kinematics``; this file adds the element laws k(xi), c(xi),
mu(xi), e(xi) and the switches of the finite-motion effects (``multibody.contact.effects``).

State: q = (x_p, y_p, phi_p, x_g, y_g, phi_g), deviations from the nominal position and rotation, world axes
x, y, angles counter-clockwise. In the drive sense the pinion turns clockwise and the gear counter-clockwise.
"""

from __future__ import annotations

import math

import numpy as np

from lumped.typing import FloatArray, IntArray
from multibody.contact.compiled import compiled
from multibody.contact.kinematics import (
    COAST,
    DRIVE,
    MAX_PAIRS,
    add_wrench,
    line_of_action,
    mesh_phase,
    overlap_rate,
    pairs_in_contact,
    sliding_velocity,
)

# Bits of the effect switches, and of the linear mesh, which has none of the effects.
ROTATION_PHASE, MOVING_LINE, SLIDING, ENTRY_SHIFT, CONTACT_LOSS, BACK_SIDE, LINEAR = 1, 2, 4, 8, 16, 32, 64

# Places in the parameter vector. Lengths in m, angles in rad, speeds in rad/s.
(
    RADIUS_P, RADIUS_G, PITCH, TIP_P, TIP_G,  # base radii, base pitch, tangent lengths of the tip circles
    CHI_P, CHI_G, CHI_P_BACK, CHI_G_BACK,  # angles of the flanks in their bodies: drive and coast side
    CENTRE_PX, CENTRE_PY, CENTRE_GX, CENTRE_GY,  # nominal centres
    L_XA, L_XP, L_XD, L_XY,  # nominal path of contact
    OMEGA_P, OMEGA_G,  # nominal speeds
    V_REG,  # velocity over which friction changes sign; 0 = at once
    T_LOW, T_HIGH,  # the nominal phase is clamped to this open time interval (a smooth segment)
    N_PARAMETERS,
) = range(23)  # fmt: skip

# Rows of the law table's offsets.
STIFFNESS, DAMPING, FRICTION, ERROR = 0, 1, 2, 3

# Columns of a contact record.
# OVERLAP and its rate are those pressed elastically (tooth error taken off); CLOSING is the overlap's own
# rate.
XI, LOAD, FRICTION_FORCE, MU, K, SLIDE, OVERLAP, OVERLAP_RATE, C, FLANK, CLOSING = range(11)
N_RECORD = 11


@compiled
def law(table: FloatArray, offsets: IntArray, which: int, xi: float) -> tuple[float, float]:
    """Value and slope of one element law at xi, clamped to the ends of its path.

    ``table`` has one row per polynomial piece: its left end, its right end, then coefficients, highest
    power of (xi - left) first; ``offsets[which]`` is the first row of a law.
    """
    low, high = offsets[which], offsets[which + 1] - 1
    last = table.shape[1]
    x = min(max(xi, table[low, 0]), table[high, 1])
    while low < high:
        middle = (low + high + 1) // 2
        if x >= table[middle, 0]:
            low = middle
        else:
            high = middle - 1
    s = x - table[low, 0]
    value = slope = 0.0
    for column in range(2, last):
        slope = slope * s + value
        value = value * s + table[low, column]
    return value, slope


@compiled
def signed_friction(
    table: FloatArray, offsets: IntArray, xi: float, slide: float, p: FloatArray, flags: int, flank: float
) -> float:
    """Friction coefficient with the sign of the sliding velocity.

    The law is known as mu(xi) along the nominal path, where xi - L_XP = v_s/(Omega_p + Omega_g). With the
    actual sliding velocity it is read at the position where the nominal motion slides as fast, and its sign
    is that of v_s.
    """
    if not flags & SLIDING:
        return flank * law(table, offsets, FRICTION, xi)[0]
    equivalent = p[L_XP] + flank * slide / (p[OMEGA_P] + p[OMEGA_G])
    magnitude = abs(law(table, offsets, FRICTION, equivalent)[0])
    if p[V_REG] > 0.0:
        return magnitude * math.tanh(slide / p[V_REG])
    return math.copysign(magnitude, slide) if slide != 0.0 else 0.0


@compiled
def mesh_position(
    t: float, q: FloatArray, p: FloatArray, flags: int, flank: float
) -> tuple[float, float, float, float, float, float]:
    """Line of action of one side of the teeth, and where they stand on it.

    Parameters
    ----------
    t, q, p, flags : as ``contact_forces``
    flank : +1 drive, -1 coast

    Returns
    -------
    (ex, ey, length, delta, rho, xi) : unit vector e from X to Y and length [m] of the line of action; overlap
        [m]; flank distance rho_p [m] of one tooth pair from X, with which ``engaged`` finds the pairs in
        contact, and the same pair's position [m] on the path of contact, where the element laws are read. The
        other pairs follow at whole pitches
    """
    rp, rg = p[RADIUS_P], p[RADIUS_G]
    tau = min(max(t, p[T_LOW]), p[T_HIGH])
    turn_p, turn_g = -p[OMEGA_P] * tau, p[OMEGA_G] * tau
    moving = (flags & MOVING_LINE) != 0
    px, py, gx, gy = p[CENTRE_PX], p[CENTRE_PY], p[CENTRE_GX], p[CENTRE_GY]
    if moving:
        px, py, gx, gy = px + q[0], py + q[1], gx + q[3], gy + q[4]
    chi_p, chi_g = (p[CHI_P], p[CHI_G]) if flank > 0.0 else (p[CHI_P_BACK], p[CHI_G_BACK])
    ex, ey, length, psi = line_of_action(px, py, gx, gy, rp + rg, flank)
    first, delta = mesh_phase(
        psi, length, turn_p + q[2], turn_g + q[5], rp, rg, p[PITCH], chi_p, chi_g, flank
    )
    beyond = delta  # excess of rho_p + rho_g over the length, which places the contact point
    if not moving:
        delta += ex * (q[0] - q[3]) + ey * (q[1] - q[4])
    if not flags & ROTATION_PHASE:
        first, beyond = mesh_phase(psi, length, turn_p, turn_g, rp, rg, p[PITCH], chi_p, chi_g, flank)
    xi = first + 0.5 * (p[L_XY] - length - beyond)
    rho = xi + 0.5 * (length - p[L_XY] + delta) if flags & ENTRY_SHIFT else xi
    return ex, ey, length, delta, rho, xi


@compiled
def engaged(rho: float, delta: float, length: float, p: FloatArray, flags: int, arms: FloatArray) -> int:
    """Find the tooth pairs in contact: on the actual flanks, or on the nominal path without entry shift.

    ``rho`` is from ``mesh_position``; the rest as ``kinematics.pairs_in_contact``.
    """
    if flags & ENTRY_SHIFT:
        return pairs_in_contact(rho, delta, length, p[PITCH], p[TIP_P], p[TIP_G], arms)
    return pairs_in_contact(rho, 0.0, p[L_XY], p[PITCH], p[L_XD], p[L_XY] - p[L_XA], arms)


@compiled
def contact_forces(
    t: float,
    q: FloatArray,
    v: FloatArray,
    p: FloatArray,
    flags: int,
    table: FloatArray,
    offsets: IntArray,
    wrench: FloatArray,
    contacts: FloatArray,
) -> int:
    """Wrench of all tooth contacts and one record per contact.

    Parameters
    ----------
    t : time [s]
    q, v : (6,) deviations from nominal position and rotation, and their rates [m, rad, s]
    p : (N_PARAMETERS,) parameters in the order named above
    flags : effect switches, a sum of bits
    table, offsets : the element laws, see ``law``
    wrench : (6,) receives (Fx, Fy, M) of pinion and gear [N, N m]
    contacts : (2 MAX_PAIRS, N_RECORD) receives the records, drive flank first; back sides only when pressed

    Returns
    -------
    number of contacts, or -1 when a force is not finite
    """
    wrench[:] = 0.0
    rp, rg = p[RADIUS_P], p[RADIUS_G]
    omega_p, omega_g = v[2] - p[OMEGA_P], v[5] + p[OMEGA_G]
    vx, vy = v[0] - v[3], v[1] - v[4]
    unilateral = (flags & CONTACT_LOSS) != 0
    arms = np.empty((MAX_PAIRS, 2))
    count = 0
    for side in range(2 if flags & BACK_SIDE else 1):
        flank = DRIVE if side == 0 else COAST
        ex, ey, length, delta, rho, _ = mesh_position(t, q, p, flags, flank)
        if not math.isfinite(delta):
            return -1
        pairs = engaged(rho, delta, length, p, flags, arms)
        rate = overlap_rate(ex, ey, vx, vy, omega_p, omega_g, rp, rg, flank)
        # d(psi)/dt = s n . (v_g - v_p)/L, from differentiating e.
        psi_rate = (ey * vx - ex * vy) / length if flags & MOVING_LINE else 0.0
        wp, wg = (omega_p, omega_g) if flags & ROTATION_PHASE else (-p[OMEGA_P], p[OMEGA_G])
        xi_rate = 0.5 * flank * (rp * (psi_rate - wp) - rg * (psi_rate - wg))
        for i in range(pairs):
            xi = 0.5 * (arms[i, 0] - arms[i, 1] + p[L_XY])
            arm_p = 0.5 * (arms[i, 0] - arms[i, 1] + length)
            arm_g = length - arm_p
            error, error_slope = law(table, offsets, ERROR, xi)
            pressed, pressing = delta - error, rate - error_slope * xi_rate
            if side == 1 and unilateral and pressed <= 0.0:
                continue
            stiffness = law(table, offsets, STIFFNESS, xi)[0]
            damping = law(table, offsets, DAMPING, xi)[0]
            normal = stiffness * pressed + damping * pressing
            if unilateral and (pressed <= 0.0 or normal < 0.0):
                normal = 0.0
            slide = sliding_velocity(ex, ey, vx, vy, omega_p, omega_g, arm_p, arm_g, flank)
            mu = signed_friction(table, offsets, xi, slide, p, flags, flank)
            add_wrench(wrench, ex, ey, normal, mu * normal, arm_p, arm_g, rp, rg, flank)
            record = contacts[count]
            record[XI], record[LOAD], record[FRICTION_FORCE], record[MU] = xi, normal, mu * normal, mu
            record[K], record[C], record[SLIDE] = stiffness, damping, slide
            record[OVERLAP], record[OVERLAP_RATE], record[FLANK] = pressed, pressing, flank
            record[CLOSING] = rate
            count += 1
    total = 0.0
    for i in range(6):
        total += wrench[i]
    return count if math.isfinite(total) else -1
