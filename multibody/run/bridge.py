"""A few steps of DOPRI5 without exudyn, over what is left before an event or the end of an interval.

To start exudyn's solver costs as much as three of its steps. These steps solve the same equations with the
same method and within the same tolerance; where they would not, exudyn takes over.

Sources: J. R. Dormand and P. J. Prince, "A family of embedded Runge-Kutta formulae", J. Comput. Appl. Math. 6
(1980) 19-26.
"""

from __future__ import annotations

import numpy as np

from lumped.typing import FloatArray
from multibody.contact import kernels as kn
from multibody.contact.compiled import compiled
from multibody.contact.forces import tooth_forces
from multibody.contact.kinematics import MAX_PAIRS

_TIMES = np.array([1 / 5, 3 / 10, 4 / 5, 8 / 9, 1.0, 1.0])
_STAGES = np.array(
    [
        [1 / 5, 0, 0, 0, 0, 0],
        [3 / 40, 9 / 40, 0, 0, 0, 0],
        [44 / 45, -56 / 15, 32 / 9, 0, 0, 0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0, 0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0],
        [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
    ]
)
#: Result of fifth order less that of fourth.
_ERROR = np.array([71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40])


@compiled
def bridge(
    times: FloatArray,
    q: FloatArray,
    v: FloatArray,
    a: FloatArray,
    p: FloatArray,
    flags: int,
    table: FloatArray,
    bodies: FloatArray,
    rtol: float,
    atol: float,
) -> bool:
    """Fill states at the times; whether every step is within its tolerance.

    Parameters
    ----------
    times : (n,) increasing [s]
    q, v, a : (n, 6) coordinates, velocities and accelerations, of which the first rows are given
    p, flags, table : as ``kernels.contact_forces``
    bodies : (4, 6) as ``Machine.bodies``
    rtol, atol : largest error of a step: rtol times the value, and atol
    """
    wrench, contacts = np.empty(6), np.empty((2 * MAX_PAIRS, kn.N_RECORD))
    speeds, rates = np.empty((7, 6)), np.empty((7, 6))
    for j in range(times.size - 1):
        h = times[j + 1] - times[j]
        for i in range(6):
            speeds[0, i], rates[0, i] = v[j, i], a[j, i]
        place, speed = q[j + 1], v[j + 1]
        for stage in range(6):
            for i in range(6):
                further = faster = 0.0
                for k in range(stage + 1):
                    further += _STAGES[stage, k] * speeds[k, i]
                    faster += _STAGES[stage, k] * rates[k, i]
                place[i], speed[i] = q[j, i] + h * further, v[j, i] + h * faster
            if (
                tooth_forces(times[j] + h * _TIMES[stage], place, speed, p, flags, table, wrench, contacts)
                < 0
            ):
                return False
            for i in range(6):
                force = wrench[i] + bodies[3, i] - bodies[1, i] * place[i] - bodies[2, i] * speed[i]
                speeds[stage + 1, i], rates[stage + 1, i] = speed[i], force / bodies[0, i]
        for i in range(6):
            a[j + 1, i] = rates[6, i]
            further = faster = 0.0
            for k in range(7):
                further += _ERROR[k] * speeds[k, i]
                faster += _ERROR[k] * rates[k, i]
            if not (
                h * abs(further) <= atol + rtol * abs(place[i])
                and h * abs(faster) <= atol + rtol * abs(speed[i])
            ):
                return False
    return True
