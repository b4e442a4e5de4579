"""Integrators that users take: fixed steps, implicit steps, those of scipy, harmonic balance, exponentials."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy.linalg
from numba import njit
from scipy.integrate import solve_ivp

from benchmarks.foreign_models.model import STATES, rates

#: Largest number of Newton steps towards a periodic motion.
NEWTON_STEPS = 25


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
    """Implicit step: theta 1/2 is the trapezoidal rule, which is Newmark's beta 1/4; theta 1 is backward Euler."""
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


FIXED = {"rk4": 0, "heun": 1, "euler": 2, "euler_cromer": 3, "newmark": 4, "backward_euler": 5}
SCIPY = {"radau": "Radau", "lsoda": "LSODA", "bdf": "BDF", "rk45": "RK45", "dop853": "DOP853"}


def run_scipy(
    method: str, start: np.ndarray, times: np.ndarray, numbers: np.void, table: np.ndarray, rtol: float
) -> np.ndarray:
    """States at times by ``solve_ivp``, with a step small enough to see every tooth pair."""

    def function(time: float, state: np.ndarray) -> np.ndarray:
        out = np.empty(STATES)
        rates(time, state, numbers, table, out)
        return out

    tolerance = np.r_[np.full(6, rtol * 1e-5), np.full(6, rtol * 1e-1)]
    solution = solve_ivp(
        function,
        (times[0], times[-1]),
        start,
        SCIPY[method],
        t_eval=times,
        rtol=rtol,
        atol=tolerance,
        max_step=float(numbers["period"]) / 250,
    )
    states: np.ndarray = solution.y.T
    return states


def linear_form(times: np.ndarray, numbers: np.void, table: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Matrices and right sides of the linear equations at times."""
    matrices = np.array([jacobian(time, np.zeros(STATES), numbers, table) for time in times])
    sides = np.empty((times.size, STATES))
    for n, time in enumerate(times):
        rates(time, np.zeros(STATES), numbers, table, sides[n])
    return matrices, sides


def run_exponentials(
    start: np.ndarray, times: np.ndarray, steps: int, numbers: np.void, table: np.ndarray
) -> np.ndarray:
    """States at times by matrix exponentials of coefficients that are constant over a step of the cycle.

    The samples of a cycle are the steps of the cycle.
    """
    step = float(numbers["period"]) / steps
    matrices, sides = linear_form(times[0] + (np.arange(steps) + 0.5) * step, numbers, table)
    blocks = np.zeros((steps, STATES + 1, STATES + 1))
    blocks[:, :STATES, :STATES], blocks[:, :STATES, STATES] = matrices * step, sides * step
    maps = scipy.linalg.expm(blocks)
    states = np.empty((times.size, STATES))
    state = np.r_[start, 1.0]
    for n in range(times.size):
        states[n] = state[:STATES]
        state = maps[n % steps] @ state
    return states


def harmonic_balance(times: np.ndarray, orders: int, numbers: np.void, table: np.ndarray) -> np.ndarray:
    """States at times from Fourier series of the displacements with so many orders of the mesh frequency."""
    period = float(numbers["period"])
    count = 16 * orders
    matrices, sides = linear_form((np.arange(count) + 0.5) * period / count, numbers, table)
    omega = 2.0 * np.pi / period
    shift = np.exp(-1j * np.pi * np.fft.fftfreq(count, 1.0 / count) / count)
    series = np.fft.fft(matrices[:, 6:, :], axis=0) / count * shift[:, None, None]
    right = np.fft.fft(sides[:, 6:], axis=0) / count * shift[:, None]
    index = np.arange(-orders, orders + 1)
    system = np.zeros((index.size, 6, index.size, 6), complex)
    for column, m in enumerate(index):
        block = series[(index - m) % count]
        system[:, :, column, :] -= block[:, :, :6] + 1j * omega * m * block[:, :, 6:]
        system[column, :, column, :] -= np.eye(6) * (omega * m) ** 2
    size = index.size * 6
    # The angle of both gears together is free: 1 N m/rad on the pinion's mean angle fixes it.
    middle = orders
    system[middle, 0, middle, 0] += 1e6
    solution = np.linalg.solve(system.reshape(size, size), right[index % count].reshape(size))
    modes = solution.reshape(index.size, 6)
    wave = np.exp(1j * omega * np.outer(times, index))
    displacements = (wave @ modes).real
    velocities = (wave @ (1j * omega * index[:, None] * modes)).real
    return np.hstack([displacements, velocities])


def periodic_start(
    numbers: np.void, table: np.ndarray, steps: int, guess: np.ndarray, balanced: bool = True
) -> tuple[np.ndarray, float]:
    """State at the start of a mesh cycle and brake torque of a periodic motion, by shooting.

    ``balanced``: the brake torque is the unknown that keeps the mean speed, and the pinion starts at angle 0.
    """
    scale = np.r_[np.full(6, 1e-6), np.full(6, 1e-6 * 2.0 * np.pi / float(numbers["period"]))]
    scale[[0, 1, 6, 7]] /= max(float(numbers["base_p"]), 1e-3)
    torque = float(numbers["torque_g"])
    torque_scale = 1e-3 * abs(torque) + 1e-3

    def end(state: np.ndarray, brake: float) -> np.ndarray:
        numbers["torque_g"] = brake
        result: np.ndarray = run_fixed(0, state, 0.0, float(numbers["period"]), steps, 2, numbers, table)[1]
        return result

    state = guess.copy()
    residual = end(state, torque) - state
    for _ in range(NEWTON_STEPS):
        units = np.eye(STATES)
        columns = [
            (end(state + scale * one, torque) - state - scale * one - residual) / scale for one in units
        ]
        matrix = np.array(columns).T
        if balanced:
            by_torque = (end(state, torque + torque_scale) - state - residual) / scale
            matrix = np.hstack([matrix, by_torque[:, None]])
            gauge = np.zeros(STATES + 1)
            gauge[0] = 1.0
            matrix = np.vstack([matrix, gauge])
            target = -np.r_[residual / scale, state[0] / scale[0]]
        else:
            target = -residual / scale
        change = np.linalg.lstsq(matrix, target, rcond=1e-13)[0]
        best, size = None, np.linalg.norm(residual / scale)
        for share in (1.0, 0.5, 0.25, 0.1, 0.03):
            trial = state + share * scale * change[:STATES]
            brake = torque + share * torque_scale * change[STATES] if balanced else torque
            off = end(trial, brake) - trial
            if np.linalg.norm(off / scale) < size or share == 0.03:
                best = trial, brake, off
                break
        assert best is not None
        state, torque, residual = best
        if np.linalg.norm(residual / scale) < 1e-11 * (1.0 + np.linalg.norm(state / scale)):
            break
    numbers["torque_g"] = torque
    return state, torque


Integrator = Callable[..., np.ndarray]
