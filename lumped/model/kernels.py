"""Compiled evaluation of path functions and of the equations of motion as forces; chains of affine maps."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from lumped.compiler import Compiler
from lumped.typing import BoolArray, FloatArray, IntArray

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


@compiled
def gauss_steps(
    which: IntArray,
    free_end: FloatArray,
    free_p: FloatArray,
    by_feedback: FloatArray,
    start: FloatArray,
    by_p: FloatArray,
    stiffness: FloatArray,
    damping: FloatArray,
    error: FloatArray,
) -> FloatArray:
    """Maps (k, 2m, 2m + columns) of Gauss steps, see ``lumped.model.propagation``.

    Parameters
    ----------
    which : (k,) length of each step, a row of the next five
    free_end, free_p, by_feedback, start, by_p : of ``_without_mesh``
    stiffness, damping, error : (k, s, m) gains of the mesh at the stages
    """
    k, stages, m = stiffness.shape
    rows, columns = stages + 2 * m, free_end.shape[2]
    maps = np.empty((k, 2 * m, columns))
    to, fixed = np.empty((rows, 2 * stages)), np.empty(rows)
    matrix, p = np.empty((stages, stages)), np.empty((stages, columns))
    inner = np.empty((2 * stages, columns))
    for j in range(k):
        of = which[j]
        for row in range(rows):
            fixed[row] = 0.0
        for stage in range(stages):
            for row in range(rows):
                by_k, by_c, by_e = 0.0, 0.0, 0.0
                for i in range(m):
                    factor = by_feedback[of, stage, row, i]
                    by_k += factor * stiffness[j, stage, i]
                    by_c += factor * damping[j, stage, i]
                    by_e += factor * error[j, stage, i]
                to[row, stage], to[row, stages + stage] = by_k, by_c
                fixed[row] += by_e
        for row in range(stages):
            for column in range(columns):
                p[row, column] = free_p[of, row, column]
            p[row, 2 * m] += fixed[row]
            for column in range(stages):
                matrix[row, column] = 0.0
            matrix[row, row] = 1.0
            for i in range(2 * stages):
                factor = to[row, i]
                for column in range(columns):
                    p[row, column] += factor * start[of, i, column]
                for column in range(stages):
                    matrix[row, column] -= factor * by_p[of, i, column]
        _solve(matrix, p)
        for row in range(2 * stages):
            for column in range(columns):
                inner[row, column] = start[of, row, column]
            for i in range(stages):
                factor = by_p[of, row, i]
                for column in range(columns):
                    inner[row, column] += factor * p[i, column]
        for row in range(2 * m):
            for column in range(columns):
                maps[j, row, column] = free_end[of, row, column]
            maps[j, row, 2 * m] += fixed[stages + row]
            for i in range(2 * stages):
                factor = to[stages + row, i]
                for column in range(columns):
                    maps[j, row, column] += factor * inner[i, column]
    return maps


@compiled
def _solve(matrix: FloatArray, right: FloatArray) -> None:
    """Solve matrix (s, s) x = right (s, columns) in place, by elimination with pivots."""
    size, columns = right.shape
    for i in range(size):
        pivot = i
        for row in range(i + 1, size):
            if abs(matrix[row, i]) > abs(matrix[pivot, i]):
                pivot = row
        if pivot != i:
            for column in range(size):
                matrix[i, column], matrix[pivot, column] = matrix[pivot, column], matrix[i, column]
            for column in range(columns):
                right[i, column], right[pivot, column] = right[pivot, column], right[i, column]
        for row in range(i + 1, size):
            factor = matrix[row, i] / matrix[i, i]
            for column in range(i, size):
                matrix[row, column] -= factor * matrix[i, column]
            for column in range(columns):
                right[row, column] -= factor * right[i, column]
    for i in range(size - 1, -1, -1):
        for column in range(columns):
            value = right[i, column]
            for row in range(i + 1, size):
                value -= matrix[i, row] * right[row, column]
            right[i, column] = value / matrix[i, i]


@compiled
def states_along(maps: FloatArray, initial: FloatArray, weights: FloatArray) -> FloatArray:
    """States (k + 1, n) from x(0) (n,) by k affine maps (k, n, n + columns), forcings weighted (columns,)."""
    k, n, width = maps.shape
    x = np.empty((k + 1, n))
    for row in range(n):
        x[0, row] = initial[row]
    for j in range(k):
        for row in range(n):
            value = 0.0
            for column in range(n):
                value += maps[j, row, column] * x[j, column]
            for column in range(n, width):
                value += maps[j, row, column] * weights[column - n]
            x[j + 1, row] = value
    return x


@compiled
def chained(maps: FloatArray, group: IntArray) -> FloatArray:
    """Affine maps (k, n, n + columns) of which consecutive ones of the same group (k,), 0, 1, ..., are one.

    Products of as many maps each are made one, so that rounding grows with the logarithm of their number.
    """
    k, n, width = maps.shape
    found = np.empty((group[k - 1] + 1, n, width))
    most = int(np.log2(k)) + 2
    waiting, doubled = np.empty((most, n, width)), np.empty(most, dtype=np.int64)
    product = np.empty((n, width))
    held = 0
    for j in range(k):
        _copy(waiting[held], maps[j])
        doubled[held] = 0
        held += 1
        last = j == k - 1 or group[j + 1] != group[j]
        while held > 1 and (last or doubled[held - 1] == doubled[held - 2]):
            before, after = waiting[held - 2], waiting[held - 1]
            for row in range(n):
                for column in range(width):
                    product[row, column] = after[row, column] if column >= n else 0.0
                for inner in range(n):
                    factor = after[row, inner]
                    for column in range(width):
                        product[row, column] += factor * before[inner, column]
            _copy(before, product)
            held -= 1
            doubled[held - 1] += 1
        if last:
            _copy(found[group[j]], waiting[0])
            held = 0
    return found


@compiled
def _copy(to: FloatArray, source: FloatArray) -> None:
    """``to[:] = source``, for which numba would compile the message about other shapes: two seconds."""
    for row in range(to.shape[0]):
        for column in range(to.shape[1]):
            to[row, column] = source[row, column]
