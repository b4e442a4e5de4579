"""Equations of a user whose damper acts on across the gap when teeth separate: only the spring is cut."""

from __future__ import annotations

import numpy as np
from numba import njit

from benchmarks.foreign_models.kernels import approach, column


@njit(cache=True)
def open_load(delta, rate, entry):
    """Normal load of a tooth pair whose spring pushes only and whose damper always acts."""
    return entry.stiffness * max(delta - entry.error, 0.0) + entry.damping * (rate - entry.error_rate)


@njit(cache=True)
def open_rates(time, state, numbers, table, out):
    """Rates of a state without friction and without motion off the line of action."""
    delta, rate = approach(state, numbers), approach(state[6:], numbers)
    j = column(time, numbers, table.shape[1])
    normal = 0.0
    for i in range(table.shape[0]):
        if table[i, j].stiffness > 0.0:
            normal += open_load(delta, rate, table[i, j])
    out[:6] = state[6:]
    out[6] = (numbers.torque_p - numbers.base_p * normal) / numbers.inertia_p
    out[7] = (numbers.base_g * normal - numbers.torque_g) / numbers.inertia_g
    out[8] = (-normal - numbers.stiffness_xp * state[2] - numbers.damping_xp * state[8]) / numbers.mass_p
    out[9] = (normal - numbers.stiffness_xg * state[3] - numbers.damping_xg * state[9]) / numbers.mass_g
    out[10:] = 0.0
    return normal


@njit(cache=True)
def run_open(start, step, substeps, samples, numbers, table):
    """States and mesh force at sample times by the classical Runge-Kutta method, from time 0."""
    states, force = np.empty((samples, start.size)), np.empty(samples)
    k1, k2 = np.empty_like(start), np.empty_like(start)
    k3, k4 = np.empty_like(start), np.empty_like(start)
    state, small = start.copy(), step / substeps
    for n in range(samples):
        states[n] = state
        for m in range(substeps):
            at = n * step + m * small
            normal = open_rates(at, state, numbers, table, k1)
            if m == 0:
                force[n] = normal
            open_rates(at + 0.5 * small, state + 0.5 * small * k1, numbers, table, k2)
            open_rates(at + 0.5 * small, state + 0.5 * small * k2, numbers, table, k3)
            open_rates(at + small, state + small * k3, numbers, table, k4)
            state = state + small / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    return states, force
