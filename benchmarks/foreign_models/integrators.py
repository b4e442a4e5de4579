"""Integrators that users take: fixed steps, those of scipy, exponentials, harmonic balance, shooting."""

from __future__ import annotations

import numpy as np
import scipy.linalg
from scipy.integrate import solve_ivp

from benchmarks.foreign_models.kernels import jacobian, rates, run_fixed
from benchmarks.foreign_models.model import STATES

#: Largest number of Newton steps towards a periodic motion.
NEWTON_STEPS = 25


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
