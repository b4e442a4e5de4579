"""Compiled path functions, Gauss steps with a rank-one mesh, and chains of affine maps."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from lumped.compiler import Compiler
from lumped.typing import BoolArray, FloatArray, IntArray

compiled = Compiler([Path(__file__)])


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
def free_steps(
    h: FloatArray,
    stiffness: FloatArray,
    damping: FloatArray,
    deflection: FloatArray,
    forces: FloatArray,
    a: FloatArray,
    aa: FloatArray,
    b: FloatArray,
    ba: FloatArray,
    c: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
    """Gauss steps of lengths h (k,) without the mesh, of coordinates that are problems of their own.

    Parameters
    ----------
    stiffness, damping, deflection : (m,) z'' by z and by z', and u
    forces : (m, forcings) z'' by each forcing
    a, aa, b, ba, c : (s, s) and (s,) tableau, and its products a a and b a

    Returns
    -------
    arrays of ``lumped.model.propagation._without_mesh``
    """
    s, m, columns = c.size, deflection.size, 2 * deflection.size + forces.shape[1]
    end, p = np.zeros((h.size, 2 * m, columns)), np.zeros((h.size, s, columns))
    by_feedback, start = np.zeros((h.size, s, m, s + 2 * m)), np.zeros((h.size, 2 * s, columns))
    by_p = np.empty((h.size, 2 * s, s))
    left, solved = np.empty((s, s)), np.empty((m, s, 3 + s))
    for j in range(h.size):
        t = h[j]
        for i in range(m):
            # Accelerations at the stages by z and by v at the start, by a unit force, and by a force at each.
            # Most coordinates are held like one before.
            u, like = deflection[i], 0
            while like < i and (stiffness[like] != stiffness[i] or damping[like] != damping[i]):
                like += 1
            right = solved[like]
            if like == i:
                for row in range(s):
                    for column in range(s):
                        unit = 1.0 if row == column else 0.0
                        left[row, column] = (
                            unit - t**2 * stiffness[i] * aa[row, column] - t * damping[i] * a[row, column]
                        )
                        right[row, 3 + column] = unit
                    right[row, 0] = stiffness[i]
                    right[row, 1] = t * stiffness[i] * c[row] + damping[i]
                    right[row, 2] = 1.0
                _solve(left, right)
            end[j, i, i], end[j, i, m + i], end[j, m + i, m + i] = 1.0, t, 1.0
            for row in range(s):
                to_z, to_v = t**2 * ba[row], t * b[row]
                for of in range(2):
                    end[j, i, of * m + i] += to_z * right[row, of]
                    end[j, m + i, of * m + i] += to_v * right[row, of]
                    p[j, row, of * m + i] = u * right[row, of]
                for f in range(forces.shape[1]):
                    by_force = right[row, 2] * forces[i, f]
                    end[j, i, 2 * m + f] += to_z * by_force
                    end[j, m + i, 2 * m + f] += to_v * by_force
                    p[j, row, 2 * m + f] += u * by_force
                for stage in range(s):
                    by_feedback[j, stage, i, row] = u * right[row, 3 + stage]
                    by_feedback[j, stage, i, s + i] += to_z * right[row, 3 + stage]
                    by_feedback[j, stage, i, s + m + i] += to_v * right[row, 3 + stage]
                start[j, row, i], start[j, s + row, m + i], start[j, row, m + i] = u, u, t * c[row] * u
        for row in range(s):
            for column in range(s):
                by_p[j, row, column], by_p[j, s + row, column] = t**2 * aa[row, column], t * a[row, column]
    return end, p, by_feedback, start, by_p


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
) -> tuple[FloatArray, FloatArray]:
    """Maps (k, 2m, columns) of Gauss steps, and to delta and its rate at their stages (k, 2, s, columns).

    See ``lumped.model.propagation``; columns are states and forcings.

    Parameters
    ----------
    which : (k,) length of each step, a row of the next five
    free_end, free_p, by_feedback, start, by_p : of ``_without_mesh``
    stiffness, damping, error : (k, s, m) gains of the mesh at the stages
    """
    k, stages, m = stiffness.shape
    rows, columns = stages + 2 * m, free_end.shape[2]
    maps = np.empty((k, 2 * m, columns))
    to, fixed = np.empty((2 * stages, rows)), np.empty(rows)
    matrix, p = np.empty((stages, stages)), np.empty((stages, columns))
    inside = np.empty((k, 2, stages, columns))
    for j in range(k):
        inner = inside[j].reshape(2 * stages, columns)
        of = which[j]
        for row in range(rows):
            fixed[row] = 0.0
        for stage in range(stages):
            for row in range(rows):
                to[stage, row], to[stages + stage, row] = 0.0, 0.0
            for i in range(m):
                by_k, by_c, by_e = stiffness[j, stage, i], damping[j, stage, i], error[j, stage, i]
                for row in range(rows):
                    factor = by_feedback[of, stage, i, row]
                    to[stage, row] += factor * by_k
                    to[stages + stage, row] += factor * by_c
                    fixed[row] += factor * by_e
        for row in range(stages):
            for column in range(columns):
                p[row, column] = free_p[of, row, column]
            p[row, 2 * m] += fixed[row]
            for column in range(stages):
                matrix[row, column] = 0.0
            matrix[row, row] = 1.0
            for i in range(2 * stages):
                factor = to[i, row]
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
                factor = to[i, stages + row]
                for column in range(columns):
                    maps[j, row, column] += factor * inner[i, column]
    return maps, inside


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
    """States (k + 1, n) from x(0) (n,) by k affine maps (k, n, n + columns), forcings weighted (forcings,).

    Columns without a weight are zeros.
    """
    k, n = maps.shape[0], maps.shape[1]
    x = np.empty((k + 1, n))
    for row in range(n):
        x[0, row] = initial[row]
    for j in range(k):
        for row in range(n):
            value = 0.0
            for column in range(n):
                value += maps[j, row, column] * x[j, column]
            for forcing in range(weights.size):
                value += maps[j, row, n + forcing] * weights[forcing]
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
