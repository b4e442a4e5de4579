"""The linear mesh: N_i = k(xi_i(t)) (delta - e) + c (delta' - e'), F_i = mu N_i, on fixed directions.

Independent of ``kernels.contact_forces``: generalised forces from constant incidence vectors, with the
pair's contact moving along the nominal path as a function of time alone.
"""

from __future__ import annotations

import math

from lumped.typing import FloatArray
from multibody.contact import kernels as kn
from multibody.contact.compiled import compiled
from multibody.contact.elements import stiffness_and_slope, stiffness_at
from multibody.contact.kernels import nominal_friction, relief_at


@compiled
def linear_forces(
    t: float,
    q: FloatArray,
    v: FloatArray,
    p: FloatArray,
    flags: int,
    table: FloatArray,
    wrench: FloatArray,
    contacts: FloatArray,
) -> int:
    """Generalised forces on (x_p, y_p, phi_p, x_g, y_g, phi_g); arguments as ``kernels.contact_forces``.

    The recorded sliding velocity does not act on the friction. With phi_p = -theta_p and phi_g = theta_g the
    overlap is the dynamic transmission error delta = r_bp theta_p - r_bg theta_g + x_p - x_g. Of the flags
    ``CONTACT_LOSS`` acts: a pair loads where its flanks overlap and that pushes. There are no back sides.
    """
    wrench[:] = 0.0
    rp, rg, pitch = p[kn.RADIUS_P], p[kn.RADIUS_G], p[kn.PITCH]
    tau = min(max(t, p[kn.T_LOW]), p[kn.T_HIGH])
    speed = p[kn.OMEGA_P] * rp
    advance = speed * tau
    advance -= pitch * math.floor(advance / pitch)
    delta = q[0] - q[3] - rp * q[2] - rg * q[5]
    rate = v[0] - v[3] - rp * v[2] - rg * v[5]
    count = 0
    k, c, e = int(p[kn.K_ROWS]), int(p[kn.C_ROWS]), int(p[kn.E_ROWS])
    loaded = k > 0
    first, last = (table[0, 0], table[k - 1, 1]) if loaded else (p[kn.L_XA], p[kn.L_XD])
    xi = p[kn.L_XA] + advance - pitch * math.floor((p[kn.L_XA] + advance - first) / pitch)
    while xi <= last:
        mu = nominal_friction(p, xi)
        if loaded:
            stiffness, stiffness_slope = stiffness_and_slope(table[:k], xi)
            damping = stiffness_at(table[k : k + c], xi)
            error = stiffness_at(table[k + c : k + c + e], xi)
            slope = stiffness_and_slope(table[k + c + e :], xi)[1]
        else:
            error, slope = relief_at(p, xi)
            stiffness, stiffness_slope = stiffness_and_slope(table, xi)
            damping = p[kn.DAMPING] * math.sqrt(max(stiffness, 0.0))
        pressed, pressing = delta - error, rate - slope * speed
        normal = stiffness * pressed + damping * pressing
        if flags & kn.CONTACT_LOSS and (pressed <= 0.0 or normal < 0.0):
            stiffness = damping = normal = 0.0
        friction = mu * normal
        wrench[0] -= normal
        wrench[1] += friction
        wrench[2] += rp * normal + xi * friction
        wrench[3] += normal
        wrench[4] -= friction
        wrench[5] += rg * normal + (p[kn.L_XY] - xi) * friction
        record = contacts[count]
        record[kn.XI], record[kn.LOAD], record[kn.FRICTION_FORCE], record[kn.MU] = xi, normal, friction, mu
        record[kn.K], record[kn.C], record[kn.FLANK] = stiffness, damping, 1.0
        record[kn.OVERLAP], record[kn.OVERLAP_RATE], record[kn.CLOSING] = pressed, pressing, rate
        gear_arm = p[kn.L_XY] - xi
        slide = (p[kn.OMEGA_P] - v[2]) * xi - (p[kn.OMEGA_G] + v[5]) * gear_arm - (v[1] - v[4])
        record[kn.SLIDE] = slide
        record[kn.ELASTIC], record[kn.ENERGY] = stiffness * pressed, 0.5 * stiffness * pressed**2
        # The damper works on the gap itself, the spring on the error that stands for it with loaded contact.
        error_slope = stiffness_and_slope(table[k + c : k + c + e], xi)[1] if loaded else slope
        elastic = stiffness * pressed
        path = elastic * error_slope + (normal - elastic) * slope
        record[kn.PATH] = path - 0.5 * stiffness_slope * pressed * pressed
        record[kn.PATH_RATE] = speed
        count += 1
        xi += pitch
    total = 0.0
    for i in range(6):
        total += wrench[i]
    return count if math.isfinite(total) else -1
