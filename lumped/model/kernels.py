"""Compiled Gauss steps with a rank-one mesh, and chains of affine maps."""

from __future__ import annotations

import numpy as np

from lumped.compiler import compiled
from lumped.typing import FloatArray, IntArray


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

    ``which`` (k,) is the length of each step, a row of the next five, which are those of
    ``lumped.model.propagation.without_mesh``; then (k, s, m) the gains of the mesh at the stages.
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
        solve_in_place(matrix, p)
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
def solve_in_place(matrix: FloatArray, right: FloatArray) -> None:
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


def merged(maps: FloatArray, group: IntArray) -> FloatArray:
    """``chained``, but the maps themselves where no two are of one group."""
    result: FloatArray = maps if group.size == group[-1] + 1 else chained(maps, group)
    return result


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
        copy(waiting[held], maps[j])
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
            copy(before, product)
            held -= 1
            doubled[held - 1] += 1
        if last:
            copy(found[group[j]], waiting[0])
            held = 0
    return found


@compiled
def copy(to: FloatArray, source: FloatArray) -> None:
    """``to[:] = source``, for which numba would compile the message about other shapes: two seconds."""
    for row in range(to.shape[0]):
        for column in range(to.shape[1]):
            to[row, column] = source[row, column]
