"""Compiled evaluation of path functions and of the equations of motion as forces."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from lumped.compiler import Compiler
from lumped.typing import BoolArray, FloatArray

compiled = Compiler([Path(__file__)])


@compiled
def evaluate_path(breaks: FloatArray, coefficients: FloatArray, xi: float) -> float:
    """Value of a path function at one position; zero outside (see ``PathFunction``)."""
    last = breaks.size - 1
    if xi < breaks[0] or xi > breaks[last]:
        return 0.0
    low, high = 0, last
    while high - low > 1:
        middle = (low + high) // 2
        if xi >= breaks[middle]:
            low = middle
        else:
            high = middle
    local = xi - breaks[low]
    value = 0.0
    for power in range(coefficients.shape[0]):
        value = value * local + coefficients[power, low]
    return value


@compiled
def laws_at(
    offsets: FloatArray,
    shift: FloatArray,
    contact: BoolArray,
    k_breaks: FloatArray,
    k_coefficients: FloatArray,
    c_breaks: FloatArray,
    c_coefficients: FloatArray,
    mu_breaks: FloatArray,
    mu_coefficients: FloatArray,
    e_breaks: FloatArray,
    e_coefficients: FloatArray,
    de_breaks: FloatArray,
    de_coefficients: FloatArray,
) -> FloatArray:
    """Five path functions (5, pairs, k) of all pairs where ``contact`` (pairs, k), zero elsewhere.

    Parameters
    ----------
    offsets : (pairs,) xi_i at the start of the cycle [m]
    shift : (k,) distance moved along the line of action [m]
    """
    values = np.zeros((5, offsets.size, shift.size))
    for pair in range(offsets.size):
        _law_along(k_breaks, k_coefficients, offsets[pair], shift, contact[pair], values[0, pair])
        _law_along(c_breaks, c_coefficients, offsets[pair], shift, contact[pair], values[1, pair])
        _law_along(mu_breaks, mu_coefficients, offsets[pair], shift, contact[pair], values[2, pair])
        _law_along(e_breaks, e_coefficients, offsets[pair], shift, contact[pair], values[3, pair])
        _law_along(de_breaks, de_coefficients, offsets[pair], shift, contact[pair], values[4, pair])
    return values


@compiled
def _law_along(
    breaks: FloatArray,
    coefficients: FloatArray,
    offset: float,
    shift: FloatArray,
    contact: BoolArray,
    values: FloatArray,
) -> None:
    """One of them for one pair; neighbours mostly lie on the same piece, which is tried first."""
    last, piece = breaks.size - 1, 0
    for i in range(shift.size):
        xi = offset + shift[i]
        if not contact[i] or not breaks[0] <= xi <= breaks[last]:
            continue
        if not (breaks[piece] <= xi and (xi < breaks[piece + 1] or piece == last - 1)):
            piece = min(np.searchsorted(breaks, xi, side="right"), last) - 1
        local = xi - breaks[piece]
        value = coefficients[0, piece]
        for power in range(1, coefficients.shape[0]):
            value = value * local + coefficients[power, piece]
        values[i] = value


@compiled
def state_rate(
    time: float,
    state: FloatArray,
    start: float,
    end: float,
    offsets: FloatArray,
    speed: float,
    start_of_contact: float,
    end_of_contact: float,
    k_breaks: FloatArray,
    k_coefficients: FloatArray,
    c_breaks: FloatArray,
    c_coefficients: FloatArray,
    mu_breaks: FloatArray,
    mu_coefficients: FloatArray,
    e_breaks: FloatArray,
    e_coefficients: FloatArray,
    de_breaks: FloatArray,
    de_coefficients: FloatArray,
    mass: FloatArray,
    damping: FloatArray,
    stiffness: FloatArray,
    deflection: FloatArray,
    normal: FloatArray,
    friction_arm: FloatArray,
    external: FloatArray,
) -> FloatArray:
    """Rates of the 12 states within one smooth segment [start, end] of the mesh cycle, eqs. 1 to 9.

    Parameters
    ----------
    time : since the start of the cycle [s]; clamped into the segment, so that its ends are one-sided
    state : (12,)
    start, end : distance moved along the line of action at the segment's ends [m]
    offsets : (pairs,) xi_i at the start of the cycle [m]
    speed : Omega_p r_bp [m/s]
    start_of_contact, end_of_contact : where a pair can touch [m]
    external : (6,) torques T_p and -T_g, zero for the translations [N m]
    """
    rate = np.empty(12)
    delta = 0.0
    delta_rate = 0.0
    for j in range(6):
        rate[j] = state[6 + j]
        delta += deflection[j] * state[j]
        delta_rate += deflection[j] * state[6 + j]
        rate[6 + j] = external[j] - stiffness[j] * state[j] - damping[j] * state[6 + j]
    moved = min(max(speed * time, start), end)
    middle = 0.5 * (start + end)
    for i in range(offsets.size):
        if not start_of_contact <= offsets[i] + middle <= end_of_contact:
            continue
        xi = offsets[i] + moved
        error = evaluate_path(e_breaks, e_coefficients, xi)
        error_rate = evaluate_path(de_breaks, de_coefficients, xi) * speed
        load = evaluate_path(k_breaks, k_coefficients, xi) * (delta - error)
        load += evaluate_path(c_breaks, c_coefficients, xi) * (delta_rate - error_rate)
        friction = evaluate_path(mu_breaks, mu_coefficients, xi) * load
        for j in range(6):
            arm = friction_arm[j, 0] + friction_arm[j, 1] * xi
            rate[6 + j] += normal[j] * load + arm * friction
    for j in range(6):
        rate[6 + j] /= mass[j]
    return rate
