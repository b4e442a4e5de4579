"""Compiled Gauss steps of a system with a feedback of rank one, and chains of affine maps."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from lumped.compiler import compiled
from lumped.typing import FloatArray, IntArray

#: Of functions that kernels alone call.
called = compiled(no_cpython_wrapper=True)


class Propagated(NamedTuple):
    """Columns that were taken through steps; the first of them are kept.

    Attributes
    ----------
    ends : (runs, columns, 2m) states at the ends of the runs
    states : (runs, steps, kept, 2m) at the start of every step
    inside : (runs, steps, kept, 2s + further) deflection at the stages, then its rate, then the further rows
    """

    ends: FloatArray
    states: FloatArray
    inside: FloatArray


@called
def _copy(to: FloatArray, source: FloatArray) -> None:
    """``to[:] = source``, for which numba would compile the message about other shapes: two seconds."""
    for row in range(to.shape[0]):
        for column in range(to.shape[1]):
            to[row, column] = source[row, column]


@called
def feedback_at_stages(strength: FloatArray, by_force: FloatArray, to: FloatArray, fixed: FloatArray) -> None:
    """Write what p and end of a step take from deflections and rates at the stages, and from neither.

    ``strength`` (s, 3, forces) per deflection, per rate and without motion; ``by_force`` (s, forces, rows).
    """
    stages = strength.shape[0]
    rows = fixed.size
    for row in range(rows):
        fixed[row] = 0.0
    for stage in range(stages):
        for row in range(rows):
            to[stage, row] = to[stages + stage, row] = 0.0
        for force in range(strength.shape[2]):
            by_deflection = strength[stage, 0, force]
            by_rate = strength[stage, 1, force]
            at_rest = strength[stage, 2, force]
            if by_deflection != 0.0 or by_rate != 0.0 or at_rest != 0.0:
                for row in range(rows):
                    factor = by_force[stage, force, row]
                    to[stage, row] += by_deflection * factor
                    to[stages + stage, row] += by_rate * factor
                    fixed[row] += at_rest * factor


@called
def add_rows(found: FloatArray, values: FloatArray, rows: FloatArray, first: int) -> None:
    """Add values times rows to what is found from an entry on.

    Four rows together, for a processor loads and stores fewer; there are a multiple of four.
    """
    for i in range(0, values.size, 4):
        f0 = values[i]
        f1 = values[i + 1]
        f2 = values[i + 2]
        f3 = values[i + 3]
        if f0 == 0.0 and f1 == 0.0 and f2 == 0.0 and f3 == 0.0:  # most of a unit column
            continue
        part = rows[i : i + 4]
        for row in range(first, found.size):
            found[row] += f0 * part[0, row] + f1 * part[1, row] + f2 * part[2, row] + f3 * part[3, row]


@compiled(nogil=True)
def propagate(
    columns: FloatArray,
    kept: int,
    strength: FloatArray,
    which: IntArray,
    free: FloatArray,
    by_force: FloatArray,
    by_p: FloatArray,
    reach: FloatArray,
    deflection: FloatArray,
) -> Propagated:
    """Take columns through Gauss steps of z'' = free part + forces of rank one, each run from its own start.

    Parameters
    ----------
    columns : (runs, columns, wide) states at the starts (2m), then the weights of the forcings; the forces
        without motion have that of the first one
    kept : how many columns are kept at every step; with none, further rows are not computed
    strength : (runs, steps, s, 3, forces) of each force per deflection, per its rate and without motion
    which : (runs or 1, steps) the length of each step, a row of the next four
    free : (k, wide, s + 2m + further) p, the stage accelerations along the deflection, end, and further rows
        of a step without forces
    by_force, by_p : of ``lumped.model.propagation.without_mesh``, (k, s, forces, as many) and (k, 2s, s)
    reach : (k, s) time from the start to each stage [s]
    deflection : (m,)
    """
    runs, count, wide = columns.shape
    steps = strength.shape[1]
    stages = strength.shape[2]
    m = deflection.size
    n = 2 * m
    rows = free.shape[2] if kept > 0 else stages + 2 * m
    further = rows - stages - n
    ends = np.empty((runs, count, n))
    states = np.empty((runs, steps, kept, n))
    inside = np.empty((runs, steps, kept, 2 * stages + further))
    fours = -(-2 * stages // 4) * 4  # as ``add_rows`` takes them
    to = np.zeros((fours, rows))
    fixed = np.empty(rows)
    found = np.empty(rows)
    at_stages = np.zeros(fours)
    p = np.empty(stages)
    matrix = np.empty((stages, stages))
    inverse = np.empty((stages, stages))
    now = np.empty((count, wide))
    for run in range(runs):
        _copy(now, columns[run])
        for step in range(steps):
            of = which[run if which.shape[0] > 1 else 0, step]
            feedback_at_stages(strength[run, step], by_force[of], to, fixed)
            for row in range(stages):
                for column in range(stages):
                    matrix[row, column] = inverse[row, column] = 1.0 if row == column else 0.0
                    for i in range(2 * stages):
                        matrix[row, column] -= to[i, row] * by_p[of, i, column]
            solve_in_place(matrix, inverse)
            for column in range(count):
                x = now[column]
                place = rate = 0.0
                for j in range(m):
                    place += deflection[j] * x[j]
                    rate += deflection[j] * x[m + j]
                for row in range(rows):
                    found[row] = fixed[row] * x[n]
                add_rows(found, x, free[of], 0)
                for stage in range(stages):
                    at_stages[stage] = place + reach[of, stage] * rate
                    at_stages[stages + stage] = rate
                for i in range(2 * stages):
                    for row in range(stages):
                        found[row] += to[i, row] * at_stages[i]
                for row in range(stages):
                    p[row] = 0.0
                    for i in range(stages):
                        p[row] += inverse[row, i] * found[i]
                for row in range(2 * stages):
                    for i in range(stages):
                        at_stages[row] += by_p[of, row, i] * p[i]
                if column < kept:
                    for row in range(n):
                        states[run, step, column, row] = x[row]
                    for row in range(2 * stages):
                        inside[run, step, column, row] = at_stages[row]
                add_rows(found, at_stages, to, stages)
                for row in range(further if column < kept else 0):
                    inside[run, step, column, 2 * stages + row] = found[stages + n + row]
                for row in range(n):
                    x[row] = found[stages + row]
        for column in range(count):
            for row in range(n):
                ends[run, column, row] = now[column, row]
    return Propagated(ends, states, inside)


@called
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
    waiting = np.empty((most, n, width))
    doubled = np.empty(most, dtype=np.int64)
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
