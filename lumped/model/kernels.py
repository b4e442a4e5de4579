"""Compiled Gauss steps of a system with a feedback of rank one, and chains of affine maps.

Sources: E. Hairer, S. P. Norsett and G. Wanner, Solving Ordinary Differential Equations I, section II.7.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from lumped.compiler import compiled
from lumped.mesh.records import AT_REST, BY_APPROACH, BY_RATE
from lumped.typing import FloatArray, IntArray

#: Decorator of functions that only kernels call.
called = compiled(no_cpython_wrapper=True)
#: The same decorator for short functions of an inner loop: they allocate nothing and are copied into the
#: loop.
inlined = compiled(_nrt=False, forceinline=True, no_cpython_wrapper=True)


class FreeSteps(NamedTuple):
    """Gauss steps without the mesh: k step lengths with s stages, and the response to unit forces of the
    mesh.

    p are the accelerations u . z'' along the deflection at the stages.

    Attributes
    ----------
    along : (k, columns, rows) rows of unit states and forcings: p (s), end of the step (2m), and further rows
        that the caller wants, e.g. the rates (s, m) of all coordinates at the stages
    by_force : (k, s, forces, rows) the same rows per unit of each force at each stage
    by_p : (k, 2s, s) deflection at the stages, then its rate, per p
    reach : (k, s) time from the start of the step to each stage [s]
    """

    along: FloatArray
    by_force: FloatArray
    by_p: FloatArray
    reach: FloatArray


class FreeEquations(NamedTuple):
    """Equations of motion without the mesh, z'' = K z + C v + f, and the directions of the mesh forces.

    Attributes
    ----------
    constant : (m, 2m + forcings) K, C, then f of each forcing
    deflection : (m,) u
    directions : (forces, m) acceleration of the coordinates per unit of each force of the mesh
    nodes : (s,) c of the method
    to_rate, to_place : (s,) b and b a: v and z at the end of a step of length 1 per acceleration at a stage
    between : (s, s) a: v at the stages per acceleration at a stage
    with_rates : whether the rates of all coordinates at the stages are further rows of ``FreeSteps``
    """

    constant: FloatArray
    deflection: FloatArray
    directions: FloatArray
    nodes: FloatArray
    to_rate: FloatArray
    to_place: FloatArray
    between: FloatArray
    with_rates: bool


@inlined
def add_acceleration(
    acceleration: float, stage: int, coordinate: int, h: float, equations: FreeEquations, rows: FloatArray
) -> None:
    """Add what an acceleration W of one coordinate at one stage does to the rows of ``FreeSteps``.

    p = u W at this stage; z + h^2 (b a) W and v + h b W at the end; v + h a W at the stages.
    """
    stages = equations.nodes.size
    m = equations.deflection.size
    rows[stage] += equations.deflection[coordinate] * acceleration
    rows[stages + coordinate] += h * h * equations.to_place[stage] * acceleration
    rows[stages + m + coordinate] += h * equations.to_rate[stage] * acceleration
    if equations.with_rates:
        for other in range(stages):
            row = stages + 2 * m + other * m + coordinate
            rows[row] += h * equations.between[other, stage] * acceleration


@inlined
def add_coasting(column: int, h: float, equations: FreeEquations, rows: FloatArray) -> None:
    """Add the rows of a unit state without accelerations: z + h v and v at the end, v at the stages."""
    stages = equations.nodes.size
    m = equations.deflection.size
    if column < 2 * m:
        rows[stages + column] += 1.0
    if m <= column < 2 * m:
        rows[stages + column - m] += h
        if equations.with_rates:
            for stage in range(stages):
                rows[stages + 2 * m + stage * m + column - m] += 1.0


@compiled(nogil=True)
def add_free_steps(
    lengths: FloatArray, inverse: FloatArray, equations: FreeEquations, free: FreeSteps
) -> None:
    """Add to ``along`` and ``by_force``, which are 0 before, those of some step lengths (k,) [s].

    The accelerations at the stages are W = Y (K (z + h c v) + C v + f) by the constant part, and W = Y n by
    the mesh.

    Parameters
    ----------
    inverse : (k, groups, s, coupled, s, coupled) Y of each group of coupled coordinates
    """
    stages = equations.nodes.size
    m = equations.deflection.size
    constant = equations.constant
    coupled = inverse.shape[3]
    steady = np.empty(coupled)  # W by forces that are alike at all stages, and by forces that grow with c
    growing = np.empty(coupled)
    for length in range(lengths.size):
        h = lengths[length]
        for coordinate in range(m):
            group = coordinate // coupled
            first = group * coupled
            for stage in range(stages):
                of_stage = inverse[length, group, stage, coordinate - first]
                for i in range(coupled):
                    steady[i] = 0.0
                    growing[i] = 0.0
                    for other in range(stages):
                        steady[i] += of_stage[other, i]
                        growing[i] += equations.nodes[other] * of_stage[other, i]
                for column in range(constant.shape[1]):
                    acceleration = 0.0
                    for i in range(coupled):
                        acceleration += steady[i] * constant[first + i, column]
                        if m <= column < 2 * m:
                            acceleration += growing[i] * h * constant[first + i, column - m]
                    if acceleration != 0.0:
                        rows = free.along[length, column]
                        add_acceleration(acceleration, stage, coordinate, h, equations, rows)
                for other in range(stages):
                    for number in range(equations.directions.shape[0]):
                        acceleration = 0.0
                        for i in range(coupled):
                            acceleration += of_stage[other, i] * equations.directions[number, first + i]
                        if acceleration != 0.0:
                            rows = free.by_force[length, other, number]
                            add_acceleration(acceleration, stage, coordinate, h, equations, rows)
        for column in range(constant.shape[1]):  # last: what is small beside 1 is summed without it
            add_coasting(column, h, equations, free.along[length, column])


class Propagated(NamedTuple):
    """Columns that ``propagate`` has taken through steps; the first columns are recorded at every step.

    Attributes
    ----------
    ends : (runs, columns, 2m) states at the ends of the runs
    states : (runs, steps, recorded, 2m) states at the start of every step
    inside : (runs, steps, recorded, 2s + further) deflection at the stages, rate of the deflection at the
        stages, further rows of ``FreeSteps.along``
    """

    ends: FloatArray
    states: FloatArray
    inside: FloatArray


class StepMemory(NamedTuple):
    """Memory for one step.

    Attributes
    ----------
    feedback : (2s, rows) rows per deflection at each stage, then per rate of the deflection at each stage;
        filled up with zeros to a multiple of four, as ``add_rows`` needs
    at_rest : (rows,) rows by the forces without motion
    stage_motion : (2s,) deflection at the stages, then its rate; filled up with zeros as ``feedback`` is
    rows : (rows,) p, end of the step and further rows of one column
    p : (s,) of one column
    matrix, inverse : (s, s) of the equations for p
    """

    feedback: FloatArray
    at_rest: FloatArray
    stage_motion: FloatArray
    rows: FloatArray
    p: FloatArray
    matrix: FloatArray
    inverse: FloatArray


@called
def _copy(target: FloatArray, source: FloatArray) -> None:
    """Copy a matrix. numba would spend two seconds on ``target[:] = source`` and its error message."""
    for row in range(target.shape[0]):
        for column in range(target.shape[1]):
            target[row, column] = source[row, column]


@called
def write_feedback(
    strength: FloatArray, by_force: FloatArray, feedback: FloatArray, at_rest: FloatArray
) -> None:
    """Write ``feedback`` and ``at_rest`` of ``StepMemory`` from the strengths of the forces in one step.

    Parameters
    ----------
    strength : (s, 3, forces) each force at each stage: by approach, by rate and at rest
    by_force : (s, forces, rows) as in ``FreeSteps``
    """
    stages = strength.shape[0]
    rows = at_rest.size
    for row in range(rows):
        at_rest[row] = 0.0
    for stage in range(stages):
        for row in range(rows):
            feedback[stage, row] = 0.0
            feedback[stages + stage, row] = 0.0
        for force in range(strength.shape[2]):
            by_deflection = strength[stage, BY_APPROACH, force]
            by_rate = strength[stage, BY_RATE, force]
            without_motion = strength[stage, AT_REST, force]
            if by_deflection != 0.0 or by_rate != 0.0 or without_motion != 0.0:
                for row in range(rows):
                    factor = by_force[stage, force, row]
                    feedback[stage, row] += by_deflection * factor
                    feedback[stages + stage, row] += by_rate * factor
                    at_rest[row] += without_motion * factor


@called
def add_rows(total: FloatArray, factors: FloatArray, rows: FloatArray, first: int) -> None:
    """Add factors times rows to a total, from the entry ``first`` on.

    Four rows are added together, because a processor then loads and stores less. The number of factors is a
    multiple of four.
    """
    for i in range(0, factors.size, 4):
        f0 = factors[i]
        f1 = factors[i + 1]
        f2 = factors[i + 2]
        f3 = factors[i + 3]
        if f0 == 0.0 and f1 == 0.0 and f2 == 0.0 and f3 == 0.0:  # most of a unit column
            continue
        four = rows[i : i + 4]
        for row in range(first, total.size):
            total[row] += f0 * four[0, row] + f1 * four[1, row] + f2 * four[2, row] + f3 * four[3, row]


@called
def invert_stages(by_p: FloatArray, memory: StepMemory) -> None:
    """Write the inverse of the equations for p: 1 - feedback by_p."""
    feedback = memory.feedback
    matrix = memory.matrix
    inverse = memory.inverse
    stages = memory.p.size
    for row in range(stages):
        for column in range(stages):
            unit = 1.0 if row == column else 0.0
            matrix[row, column] = unit
            inverse[row, column] = unit
            for i in range(2 * stages):
                matrix[row, column] -= feedback[i, row] * by_p[i, column]
    solve_in_place(matrix, inverse)


@inlined
def write_coasting(
    state: FloatArray, deflection: FloatArray, reach: FloatArray, stage_motion: FloatArray
) -> None:
    """Write the motion of the stages without accelerations: the rate stays, the deflection grows with it."""
    m = deflection.size
    stages = reach.size
    start = 0.0
    rate = 0.0
    for j in range(m):
        start += deflection[j] * state[j]
        rate += deflection[j] * state[m + j]
    for stage in range(stages):
        stage_motion[stage] = start + reach[stage] * rate
        stage_motion[stages + stage] = rate


@inlined
def solve_stages(by_p: FloatArray, memory: StepMemory) -> None:
    """Solve for p of one column, and add the part of p to the coasting motion of the stages."""
    rows = memory.rows
    stage_motion = memory.stage_motion
    p = memory.p
    stages = p.size
    for i in range(2 * stages):
        for row in range(stages):
            rows[row] += memory.feedback[i, row] * stage_motion[i]
    for row in range(stages):
        p[row] = 0.0
        for i in range(stages):
            p[row] += memory.inverse[row, i] * rows[i]
    for row in range(2 * stages):
        for i in range(stages):
            stage_motion[row] += by_p[row, i] * p[i]


@inlined
def propagate_column(
    state: FloatArray, length: int, free: FreeSteps, deflection: FloatArray, memory: StepMemory
) -> None:
    """Write ``rows`` and ``stage_motion`` of one column over a step: p, end and further rows.

    Parameters
    ----------
    state : (columns of FreeSteps.along,) state (2m), then the weights of the forcings
    length : index of the step length in ``free``
    """
    rows = memory.rows
    weight = state[2 * deflection.size]
    for row in range(rows.size):
        rows[row] = memory.at_rest[row] * weight
    add_rows(rows, state, free.along[length], 0)
    write_coasting(state, deflection, free.reach[length], memory.stage_motion)
    solve_stages(free.by_p[length], memory)
    add_rows(rows, memory.stage_motion, memory.feedback, memory.p.size)


@called
def step_memory(stages: int, rows: int) -> StepMemory:
    """Return the memory for steps with s stages."""
    padded = -(-2 * stages // 4) * 4
    return StepMemory(
        np.zeros((padded, rows)),
        np.empty(rows),
        np.zeros(padded),
        np.empty(rows),
        np.empty(stages),
        np.empty((stages, stages)),
        np.empty((stages, stages)),
    )


@compiled(nogil=True, long_loops=True)
def propagate(
    columns: FloatArray,
    recorded: int,
    strength: FloatArray,
    length_of_step: IntArray,
    free: FreeSteps,
    deflection: FloatArray,
) -> Propagated:
    """Take columns through Gauss steps of z'' = free part + forces of rank one, each run from its own start.

    Parameters
    ----------
    columns : (runs, columns, 2m + forcings) states at the starts, then the weights of the forcings. The
        forces without motion have the weight of the first forcing
    recorded : number of columns that are recorded at every step; with 0, further rows are not computed
    strength : (runs, steps, s, 3, forces) each force by approach, by rate and at rest
    length_of_step : (runs or 1, steps) index of each step's length in ``free``
    free : steps without the mesh
    deflection : (m,) u
    """
    runs = columns.shape[0]
    count = columns.shape[1]
    steps = strength.shape[1]
    stages = strength.shape[2]
    n = 2 * deflection.size
    further = free.along.shape[2] - stages - n if recorded > 0 else 0
    ends = np.empty((runs, count, n))
    states = np.empty((runs, steps, recorded, n))
    inside = np.empty((runs, steps, recorded, 2 * stages + further))
    memory = step_memory(stages, stages + n + further)
    state = np.empty((count, columns.shape[2]))
    for run in range(runs):
        _copy(state, columns[run])
        for step in range(steps):
            length = length_of_step[run if length_of_step.shape[0] > 1 else 0, step]
            write_feedback(strength[run, step], free.by_force[length], memory.feedback, memory.at_rest)
            invert_stages(free.by_p[length], memory)
            for column in range(count):
                propagate_column(state[column], length, free, deflection, memory)
                if column < recorded:
                    for row in range(n):
                        states[run, step, column, row] = state[column, row]
                    for row in range(2 * stages):
                        inside[run, step, column, row] = memory.stage_motion[row]
                    for row in range(further):
                        inside[run, step, column, 2 * stages + row] = memory.rows[stages + n + row]
                for row in range(n):
                    state[column, row] = memory.rows[stages + row]
        for column in range(count):
            for row in range(n):
                ends[run, column, row] = state[column, row]
    return Propagated(ends, states, inside)


@called
def swap_rows(matrix: FloatArray, row: int, other: int) -> None:
    """Swap two rows of a matrix."""
    for column in range(matrix.shape[1]):
        value = matrix[row, column]
        matrix[row, column] = matrix[other, column]
        matrix[other, column] = value


@called
def solve_in_place(matrix: FloatArray, right: FloatArray) -> None:
    """Solve matrix (s, s) x = right (s, columns) by elimination with pivots; ``right`` becomes x."""
    size, columns = right.shape
    for i in range(size):
        pivot = i
        for row in range(i + 1, size):
            if abs(matrix[row, i]) > abs(matrix[pivot, i]):
                pivot = row
        if pivot != i:
            swap_rows(matrix, i, pivot)
            swap_rows(right, i, pivot)
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


@compiled(long_loops=True)
def states_along(maps: FloatArray, initial: FloatArray, weights: FloatArray) -> FloatArray:
    """States (k + 1, n) at the ends of k intervals whose affine maps are known.

    Parameters
    ----------
    maps : (k, n, n + columns) transition, then one column for each forcing; columns without a weight are
        zeros
    initial : (n,) state at the start
    weights : (forcings,)
    """
    k = maps.shape[0]
    n = maps.shape[1]
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
    """``chained``; where every map is a group of its own, the maps themselves."""
    result: FloatArray = maps if group.size == group[-1] + 1 else chained(maps, group)
    return result


@called
def multiply_maps(first: FloatArray, second: FloatArray, product: FloatArray) -> None:
    """Write the product of two affine maps (n, n + columns): ``second`` after ``first``."""
    n = first.shape[0]
    width = first.shape[1]
    for row in range(n):
        for column in range(width):
            product[row, column] = second[row, column] if column >= n else 0.0
        for inner in range(n):
            factor = second[row, inner]
            for column in range(width):
                product[row, column] += factor * first[inner, column]


@compiled(long_loops=True)
def chained(maps: FloatArray, group: IntArray) -> FloatArray:
    """Multiply consecutive affine maps of the same group into one map; (groups, n, n + columns).

    Products of equally many maps are multiplied with each other, as in a binary tree, so that rounding grows
    with the logarithm of the number of maps.

    Parameters
    ----------
    maps : (k, n, n + columns)
    group : (k,) group of each map: 0, 1, ..., without gaps
    """
    k, n, width = maps.shape
    products = np.empty((group[k - 1] + 1, n, width))
    most = int(np.log2(k)) + 2
    waiting = np.empty((most, n, width))
    doublings = np.empty(most, dtype=np.int64)
    product = np.empty((n, width))
    count = 0
    for j in range(k):
        _copy(waiting[count], maps[j])
        doublings[count] = 0
        count += 1
        last = j == k - 1 or group[j + 1] != group[j]
        while count > 1 and (last or doublings[count - 1] == doublings[count - 2]):
            multiply_maps(waiting[count - 2], waiting[count - 1], product)
            _copy(waiting[count - 2], product)
            count -= 1
            doublings[count - 1] += 1
        if last:
            _copy(products[group[j]], waiting[0])
            count = 0
    return products
