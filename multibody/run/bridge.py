"""A few steps of DOPRI5 without exudyn, across and behind an event.

Source: J. R. Dormand and P. J. Prince, J. Comput. Appl. Math. 6 (1980) 19-26.
"""

from __future__ import annotations

import math

import numpy as np

from lumped.typing import FloatArray
from multibody.contact import kinematics as kn
from multibody.contact.kernels import tooth_forces
from multibody.contact.kinematics import compiled

#: Six stages: coefficients of the rates, last the time; then the result of fifth order less that of fourth.
TABLEAU = np.array(
    [
        [1 / 5, 0, 0, 0, 0, 0, 1 / 5],
        [3 / 40, 9 / 40, 0, 0, 0, 0, 3 / 10],
        [44 / 45, -56 / 15, 32 / 9, 0, 0, 0, 4 / 5],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0, 0, 8 / 9],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0, 1.0],
        [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84, 1.0],
        [71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40],
    ]
)
#: Part of the next step that the error of this one allows, and by what a step may change.
_SAFETY, _SHRINK, _GROW = 0.9, 0.2, 5.0
#: What is left before an interval's end is bridged if it is no longer than so many ordinary steps.
FEW = 3.0
#: A step this much smaller than an ordinary one is left to exudyn.
_LEAST = 1e-9


@compiled
def bridge(
    stop: float,
    ordinary: float,
    times: FloatArray,
    states: FloatArray,
    p: FloatArray,
    flags: int,
    table: FloatArray,
    bodies: FloatArray,
    rtol: float,
    atol: float,
    tableau: FloatArray,
) -> tuple[int, float, int]:
    """Steps of DOPRI5 from the first of the times until ``stop``, or until they are of ordinary length.

    To start exudyn's solver costs as much as three of its steps; behind an event the step size is found here.

    ordinary : step of exudyn away from events, and the first to try [s]
    times, states : (n,) ends of the steps [s], (3, n, 6) coordinates, rates, accelerations; the first given
    tableau : ``TABLEAU``; as a constant it would be compiled into unrolled loops
    Returns number of rows filled, step to go on with [s], number of force evaluations
    """
    state, contacts = np.empty((3, 6)), np.empty((2 * kn.MAX_PAIRS, kn.N_RECORD))
    place, speed, wrench = state[0], state[1], state[2]
    speeds, rates = np.empty((7, 6)), np.empty((7, 6))
    q, v, a = states[0], states[1], states[2]
    step, rows, calls = ordinary, 1, 0
    while rows < times.size and times[rows - 1] < stop:
        left, j = stop - times[rows - 1], rows - 1
        if rows > 1 and step >= ordinary and left > FEW * ordinary:
            break
        equal = math.ceil(left / step)
        h = left / equal
        for i in range(6):
            speeds[0, i], rates[0, i] = v[j, i], a[j, i]
        for stage in range(6):
            for i in range(6):
                further = faster = 0.0
                for k in range(stage + 1):
                    further += tableau[stage, k] * speeds[k, i]
                    faster += tableau[stage, k] * rates[k, i]
                place[i], speed[i] = q[j, i] + h * further, v[j, i] + h * faster
            calls += 1
            t = times[j] + h * tableau[stage, 6]
            if tooth_forces(t, state, p, flags, table, contacts) < 0:
                return rows, step, calls
            for i in range(6):
                force = wrench[i] + bodies[3, i] - bodies[1, i] * place[i] - bodies[2, i] * speed[i]
                speeds[stage + 1, i], rates[stage + 1, i] = speed[i], force / bodies[0, i]
        worst = 0.0
        for i in range(6):
            q[rows, i], v[rows, i], a[rows, i] = place[i], speed[i], rates[6, i]
            further = faster = 0.0
            for k in range(7):
                further += tableau[6, k] * speeds[k, i]
                faster += tableau[6, k] * rates[k, i]
            worst = max(worst, h * abs(further) / (atol + rtol * abs(place[i])))
            worst = max(worst, h * abs(faster) / (atol + rtol * abs(speed[i])))
        change = _SAFETY * worst**-0.2 if worst > 0.0 else _GROW
        change = min(max(change, _SHRINK), _GROW)
        if worst <= 1.0:
            times[rows] = stop if equal == 1 else times[j] + h
            rows += 1
            # A step that was cut short tells little about a longer one.
            step = max(change * h, step) if change >= 1.0 else change * h
        else:
            step = min(change, 1.0) * h
            if not step > _LEAST * ordinary:
                break
    return rows, step, calls
