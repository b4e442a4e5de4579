"""Gearbox A 21/43, stage 2: mesh vibration with sliding friction, six degrees of freedom, steel on steel.

x along the line of action, the way the pinion pushes the gear; y across it, the way friction pushes the
pinion behind the pitch point. Units: m, kg, s, N, rad.
"""

from math import cos, floor, pi, radians, sqrt, tan

import numpy as np

# Drawing and CAD
Z1, Z2 = 21, 43
MODULE = 2.5e-3
ALPHA = radians(20.0)
TIP1, TIP2 = MODULE * (Z1 / 2 + 1), MODULE * (Z2 / 2 + 1)
M1, M2 = 0.34, 1.21
J1, J2 = 1.25e-4, 1.62e-3

# Operation
SPEED = 2600.0 * 2 * pi / 60
TORQUE = 70.0

# Mesh: stiffness of a pair of teeth from C' = 14 N/(mm um) and 18 mm, damping ratio, Coulomb friction
K_PAIR = 252e6
ZETA_MESH = 0.07
MU = 0.06

# Bearings along x and y, from the bearing maker
KX1, KY1, KX2, KY2 = 180e6, 110e6, 240e6, 150e6
ZETA_BEARING = 0.05

# Geometry of the line of action: base circles, start A and end D of contact, pitch point P
RB1, RB2 = MODULE * Z1 / 2 * cos(ALPHA), MODULE * Z2 / 2 * cos(ALPHA)
PITCH = pi * MODULE * cos(ALPHA)
LENGTH = (RB1 + RB2) * tan(ALPHA)
A = LENGTH - sqrt(TIP2**2 - RB2**2)
D = sqrt(TIP1**2 - RB1**2)
P = RB1 * tan(ALPHA)
T_MESH = PITCH / (RB1 * SPEED)

M_E = 1 / (RB1**2 / J1 + RB2**2 / J2)
C_PAIR = 2 * ZETA_MESH * sqrt(K_PAIR * M_E)
CX1, CY1 = 2 * ZETA_BEARING * sqrt(KX1 * M1), 2 * ZETA_BEARING * sqrt(KY1 * M1)
CX2, CY2 = 2 * ZETA_BEARING * sqrt(KX2 * M2), 2 * ZETA_BEARING * sqrt(KY2 * M2)


def contacts(t):
    """Distances of the pairs of teeth in contact from the base circle of the pinion."""
    first = A + (t / T_MESH - floor(t / T_MESH)) * PITCH
    return [xi for xi in (first, first + PITCH, first + 2 * PITCH) if xi <= D]


def load(u):
    """Transmission error, and the load of every pair in contact: spring and damper."""
    th1, th2, x1, _, x2, _, dth1, dth2, dx1, _, dx2, _ = u
    delta = RB1 * th1 - RB2 * th2 + x1 - x2
    return delta, K_PAIR * delta + C_PAIR * (RB1 * dth1 - RB2 * dth2 + dx1 - dx2)


def rates(u, xis, mu):
    """Newton and Euler for both gears."""
    _, _, x1, y1, x2, y2, dth1, dth2, dx1, dy1, dx2, dy2 = u
    _, n = load(u)
    forces = [mu * n if xi > P else -mu * n for xi in xis]
    total, friction = n * len(xis), sum(forces)
    moment1 = sum(f * xi for f, xi in zip(forces, xis, strict=True))
    moment2 = sum(f * (LENGTH - xi) for f, xi in zip(forces, xis, strict=True))
    return (
        dth1, dth2, dx1, dy1, dx2, dy2,
        (TORQUE - RB1 * total - moment1) / J1,
        (-TORQUE * RB2 / RB1 + RB2 * total + moment2) / J2,
        (-total - KX1 * x1 - CX1 * dx1) / M1,
        (friction - KY1 * y1 - CY1 * dy1) / M1,
        (total - KX2 * x2 - CX2 * dx2) / M2,
        (-friction - KY2 * y2 - CY2 * dy2) / M2,
    )  # fmt: skip


def simulate(mu=MU, cycles=60, last=3, steps=1000):
    """Motion of the last mesh cycles of a run from rest, Runge-Kutta of order 4 with a fixed step."""
    h = T_MESH / steps
    u = [0.0] * 12
    rows = []
    for i in range(cycles * steps):
        now, middle, end = contacts(i * h), contacts((i + 0.5) * h), contacts((i + 1) * h)
        if i >= (cycles - last) * steps:
            delta, n = load(u)
            rows.append((i * h, delta, *u[2:6], n * len(now)))
        k1 = rates(u, now, mu)
        k2 = rates([a + h / 2 * b for a, b in zip(u, k1, strict=True)], middle, mu)
        k3 = rates([a + h / 2 * b for a, b in zip(u, k2, strict=True)], middle, mu)
        k4 = rates([a + h * b for a, b in zip(u, k3, strict=True)], end, mu)
        slopes = zip(k1, k2, k3, k4, strict=True)
        u = [a + h / 6 * (b + 2 * c + 2 * d + e) for a, (b, c, d, e) in zip(u, slopes, strict=True)]
    names = ("time [s]", "dte [m]", "x_p [m]", "y_p [m]", "x_g [m]", "y_g [m]", "mesh_force [N]")
    return dict(zip(names, np.array(rows).T, strict=True))
