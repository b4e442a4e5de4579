"""Compiled functions of the user: the equations of motion and steps in time.

They stand in one file: the cache of numba looks at the file of a function, not at what the function calls.
Source: He, Cho and Singh, J. Sound Vib. 309 (2008) 843-851, equations (1) to (9) as docs/theory/equations.md.
"""

from __future__ import annotations

import numpy as np
from numba import njit


@njit(cache=True)
def column(time, numbers, entries):
    """Entry of the tables at a time."""
    cycles = time / numbers.period + numbers.phase
    return min(int((cycles - np.floor(cycles)) * entries), entries - 1)


@njit(cache=True)
def pair_load(delta, rate, entry, numbers):
    """Normal load of one tooth pair."""
    compression = delta - entry.error
    elastic = entry.stiffness * compression
    if numbers.hardening != 0.0:
        elastic *= abs(compression / numbers.reference_compression) ** numbers.hardening
    load = elastic + entry.damping * (rate - entry.error_rate)
    if numbers.unilateral > 0.0 and load < 0.0:
        load = 0.0
    return load


@njit(cache=True)
def friction_of(load, entry, numbers):
    """Friction force of one tooth pair: by its normal load, or by its share of a load that does not vary."""
    if numbers.static_load > 0.0:
        return entry.mu * entry.share * numbers.static_load
    return entry.mu * load


@njit(cache=True)
def approach(state, numbers):
    """Approach of the flanks delta."""
    turned = numbers.base_p * state[0] - numbers.base_g * state[1]
    return turned + numbers.x_in_approach * (state[2] - state[3])


@njit(cache=True)
def rates(time, state, numbers, table, out):
    """Rates of a state, equations (1), (2) and (6) to (9)."""
    delta = approach(state, numbers)
    delta_rate = approach(state[6:], numbers)
    j = column(time, numbers, table.shape[1])
    normal, friction, moment_p, moment_g = 0.0, 0.0, 0.0, 0.0
    for i in range(table.shape[0]):
        entry = table[i, j]
        if entry.stiffness == 0.0 and entry.damping == 0.0:
            continue
        load = pair_load(delta, delta_rate, entry, numbers)
        normal += load
        rubbing = friction_of(load, entry, numbers)
        friction += rubbing
        moment_p += entry.arm_p * rubbing
        moment_g += entry.arm_g * rubbing
    drive = numbers.torque_p - numbers.drive_stiffness * state[0]
    drive += numbers.ripple * np.cos(2.0 * np.pi * numbers.ripple_order * time / numbers.period)
    out[:6] = state[6:]
    out[6] = (drive - numbers.base_p * normal - numbers.moment_sign_p * moment_p) / numbers.inertia_p
    out[7] = (
        -numbers.torque_g + numbers.base_g * normal + numbers.moment_sign_g * moment_g
    ) / numbers.inertia_g
    if numbers.rigid > 0.0:
        out[8:12] = 0.0
        return
    spring_xp = numbers.stiffness_xp * state[2] + numbers.damping_xp * state[8]
    spring_xg = numbers.stiffness_xg * state[3] + numbers.damping_xg * state[9]
    spring_yp = numbers.stiffness_yp * state[4] + numbers.damping_yp * state[10]
    spring_yg = numbers.stiffness_yg * state[5] + numbers.damping_yg * state[11]
    out[8] = (numbers.load_xp - spring_xp - numbers.force_sign_xp * normal) / numbers.mass_p
    out[9] = (numbers.load_xg - spring_xg + numbers.force_sign_xg * normal) / numbers.mass_g
    out[10] = (numbers.load_yp - spring_yp + numbers.force_sign_yp * friction) / numbers.mass_p
    out[11] = (numbers.load_yg - spring_yg - numbers.force_sign_yg * friction) / numbers.mass_g


@njit(cache=True)
def tooth_loads(times, states, numbers, table, normal, friction):
    """Write normal loads and friction forces of the tooth pairs at states, of shape (pairs, times)."""
    for n in range(times.size):
        delta, delta_rate = approach(states[n], numbers), approach(states[n, 6:], numbers)
        j = column(times[n], numbers, table.shape[1])
        for i in range(table.shape[0]):
            entry = table[i, j]
            if entry.stiffness == 0.0 and entry.damping == 0.0:
                continue
            normal[i, n] = pair_load(delta, delta_rate, entry, numbers)
            friction[i, n] = friction_of(normal[i, n], entry, numbers)


@njit(cache=True)
def euler_step(time, state, step, numbers, table):
    out = np.empty_like(state)
    rates(time, state, numbers, table, out)
    return state + step * out


@njit(cache=True)
def semi_implicit_step(time, state, step, numbers, table):
    """Euler-Cromer: new velocities first, then displacements with them."""
    out = np.empty_like(state)
    rates(time, state, numbers, table, out)
    new = state.copy()
    new[6:] += step * out[6:]
    new[:6] += step * new[6:]
    return new


@njit(cache=True)
def heun_step(time, state, step, numbers, table):
    first, second = np.empty_like(state), np.empty_like(state)
    rates(time, state, numbers, table, first)
    rates(time + step, state + step * first, numbers, table, second)
    return state + 0.5 * step * (first + second)


@njit(cache=True)
def rk4_step(time, state, step, numbers, table):
    k1, k2 = np.empty_like(state), np.empty_like(state)
    k3, k4 = np.empty_like(state), np.empty_like(state)
    rates(time, state, numbers, table, k1)
    rates(time + 0.5 * step, state + 0.5 * step * k1, numbers, table, k2)
    rates(time + 0.5 * step, state + 0.5 * step * k2, numbers, table, k3)
    rates(time + step, state + step * k3, numbers, table, k4)
    return state + step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)


@njit(cache=True)
def jacobian(time, state, numbers, table):
    """Derivatives of the rates by differences; scales fit micrometres."""
    matrix = np.empty((state.size, state.size))
    base, out = np.empty_like(state), np.empty_like(state)
    rates(time, state, numbers, table, base)
    for j in range(state.size):
        small = 1e-9 if j < 6 else 1e-4
        other = state.copy()
        other[j] += small
        rates(time, other, numbers, table, out)
        matrix[:, j] = (out - base) / small
    return matrix


@njit(cache=True)
def theta_step(time, state, step, numbers, table, theta):
    """Implicit step: theta 1/2 is the trapezoidal rule, Newmark's beta 1/4; theta 1 is backward Euler."""
    now, then = np.empty_like(state), np.empty_like(state)
    rates(time, state, numbers, table, now)
    new = state + step * now
    for _ in range(2):
        rates(time + step, new, numbers, table, then)
        residual = new - state - step * ((1.0 - theta) * now + theta * then)
        matrix = np.eye(state.size) - step * theta * jacobian(time + step, new, numbers, table)
        new = new - np.linalg.solve(matrix, residual)
    return new


@njit(cache=True)
def run_fixed(method, start, time, step, substeps, samples, numbers, table):
    """States at sample times, of shape (samples, states), by fixed steps; ``step`` between samples."""
    states = np.empty((samples, start.size))
    state = start.copy()
    small = step / substeps
    for n in range(samples):
        states[n] = state
        for m in range(substeps):
            at = time + n * step + m * small
            if method == 0:
                state = rk4_step(at, state, small, numbers, table)
            elif method == 1:
                state = heun_step(at, state, small, numbers, table)
            elif method == 2:
                state = euler_step(at, state, small, numbers, table)
            elif method == 3:
                state = semi_implicit_step(at, state, small, numbers, table)
            elif method == 4:
                state = theta_step(at, state, small, numbers, table, 0.5)
            else:
                state = theta_step(at, state, small, numbers, table, 1.0)
    return states
