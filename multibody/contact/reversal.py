"""Where sliding changes its sign: is the sign function safe, or must friction change over a small velocity?

At the pitch point the sliding velocity passes through zero with the nominal acceleration

    a_s = d/dt [(Omega_p + Omega_g)(xi - L_XP)] = (Omega_p + Omega_g) Omega_p r_bp .

A friction force that jumps from -mu N to +mu N accelerates the sliding by up to a_f = mu N/m_s on either
side, with 1/m_s = 1/m_p + 1/m_g + X_p^2/J_p + X_g^2/J_g. Once the vibration takes away so much of a_s that
less than a_f is left, friction can hold the teeth at zero sliding: a sliding mode, in which sign() has no
solution and every step-size control comes to a halt. The vibration is driven by friction itself and
amplified at most by Q = 1/(2 zeta) of the bearings off the line of action, so sign() is taken as safe where
a_s > (1 + Q) a_f.
"""

from __future__ import annotations

import numpy as np

from multibody.contact import kernels as kn
from multibody.contact.machine import Machine

#: Velocity over which tanh changes the sign of friction [m/s]. Halving it changes the transmission error at
#: 79.1 N m and 800 rpm of the 28/28 pair by some 1e-4 of its peak to peak.
SMALL_VELOCITY = 1e-4
#: A law is continuous at the pitch point if it jumps by less than this share of its largest value.
_CONTINUOUS = 1e-3
_BESIDE = 1e-9  # m
_PLACES = 101  # at which the largest coefficient is looked for


def friction_velocity(machine: Machine) -> tuple[float, str]:
    """Choose the velocity over which friction changes its sign.

    Parameters
    ----------
    machine : numbers of the gear pair

    Returns
    -------
    (velocity, reason) : [m/s], 0 for the sign function; and why, in words
    """
    if _beside_pitch_point(machine) <= _CONTINUOUS * _largest(machine):
        return 0.0, "sign(): the friction law is continuous at the pitch point"
    nominal, by_friction, needed = _accelerations(machine)
    share = nominal / by_friction
    numbers = f"sliding passes zero at {nominal:.3g} m/s^2, {share:.3g} times what friction can change"
    if nominal > needed * by_friction:
        return 0.0, f"sign(): {numbers}, more than the {needed:.3g} times that resonance could take away"
    return SMALL_VELOCITY, (
        f"tanh over {SMALL_VELOCITY * 1e3:g} mm/s: {numbers}, less than the {needed:.3g} times that "
        "resonance could take away, so friction may hold the teeth at zero sliding"
    )


def _accelerations(machine: Machine) -> tuple[float, float, float]:
    """Return a_s and a_f [m/s^2], and the 1 + Q that a_s/a_f must exceed, see above."""
    p = machine.parameters
    arm_p, arm_g = p[kn.L_XP], p[kn.L_XY] - p[kn.L_XP]
    mobility = float((1.0 / machine.mass).sum())
    mobility += arm_p**2 / machine.inertia[0] + arm_g**2 / machine.inertia[1]
    load = machine.torque_pinion / p[kn.RADIUS_P]
    by_friction = _beside_pitch_point(machine) * load * mobility
    nominal = (p[kn.OMEGA_P] + p[kn.OMEGA_G]) * p[kn.OMEGA_P] * p[kn.RADIUS_P]
    if machine.train is None:
        critical = 2.0 * np.sqrt(machine.bearing_stiffness[:, 1] * machine.mass)
        ratio = float((machine.bearing_damping[:, 1] / critical).min())  # of the less damped bearing
    else:
        ratio = machine.train.damping_ratio
    needed = 1.0 + (0.5 / ratio if ratio > 0.0 else np.inf)
    return float(nominal), float(by_friction), needed


def _largest(machine: Machine) -> float:
    """Largest friction coefficient on the path of contact."""
    p = machine.parameters
    return max(abs(kn.nominal_friction(p, xi)) for xi in np.linspace(p[kn.L_XA], p[kn.L_XD], _PLACES))


def _beside_pitch_point(machine: Machine) -> float:
    """Larger friction coefficient just before and after the pitch point."""
    place = float(machine.parameters[kn.L_XP])
    return max(abs(kn.nominal_friction(machine.parameters, place + side * _BESIDE)) for side in (-1.0, 1.0))
