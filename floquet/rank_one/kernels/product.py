"""The product of the steps of one period, and how their errors reach its end, compiled."""

from __future__ import annotations

import math

from floquet.rank_one.kernels.compiled import compiled
from floquet.rank_one.kernels.lanes import LANES, load, plus, plus_square, scaled, store, zero
from lumped.typing import FloatArray

FORCED = 6
"""First of the two lanes that carry forced motion: under the forcing, and under the input."""
_EPS = 2.220446049250313e-16


@compiled(_nrt=False)
def frobenius(rows: FloatArray, scratch: FloatArray) -> float:
    """Norm of rows[:, 0:n], by way of the first row of ``scratch``."""
    n = rows.shape[0]
    total = zero()
    for i in range(n):
        total = plus_square(load(rows, (i,)), total)
    store(scratch, (0,), total)
    square = 0.0
    for lane in range(n):
        square += scratch[0, lane]
    return math.sqrt(square)


@compiled(_nrt=False)
def multiply(left: FloatArray, right: FloatArray, out: FloatArray) -> None:
    """Out = left[:, 0:n] @ right, all (n, LANES)."""
    n = left.shape[0]
    for i in range(n):
        total = zero()
        for q in range(n):
            total = plus(left[i, q], load(right, (q,)), total)
        store(out, (i,), total)


@compiled(_nrt=False)
def invert(A: FloatArray, unit: FloatArray, work: FloatArray, out: FloatArray) -> None:
    """Out[:, 0:n] = inverse of A[:, 0:n], (n, LANES), by Gauss-Jordan elimination with row pivots.

    Not finite where A is singular. ``unit`` has the rows of the unit matrix, ``work`` is scratch like A.
    """
    n = A.shape[0]
    for i in range(n):
        store(work, (i,), load(A, (i,)))
        store(out, (i,), load(unit, (i,)))
    for k in range(n):
        p = k
        for i in range(k + 1, n):
            if abs(work[i, k]) > abs(work[p, k]):
                p = i
        factor = 1.0 / work[p, k]
        left, right = scaled(factor, load(work, (p,))), scaled(factor, load(out, (p,)))
        store(work, (p,), load(work, (k,)))
        store(out, (p,), load(out, (k,)))
        store(work, (k,), left)
        store(out, (k,), right)
        for i in range(n):
            if i != k:
                factor = -work[i, k]
                store(work, (i,), plus(factor, left, load(work, (i,))))
                store(out, (i,), plus(factor, right, load(out, (i,))))


@compiled(_nrt=False)
def divide(
    end: FloatArray, start: FloatArray, unit: FloatArray, scratch: FloatArray, step: FloatArray
) -> tuple[float, float]:
    """Flow over a step, P = E S^-1, from those from its middle to its end E and to its start S.

    Parameters
    ----------
    end, start : (n, LANES), the columns from FORCED on being states from rest in the middle
    unit : rows of the unit matrix
    scratch : (2, n, LANES)
    step : (n, LANES), out: P, and in the columns from FORCED on states at the end from rest at the start

    Returns
    -------
    |P| and a bound on |P S - E|, Frobenius norms
    """
    n = end.shape[0]
    inverse, back = scratch[0], scratch[1]
    invert(start, unit, back, inverse)
    multiply(end, inverse, step)
    multiply(step, start, back)
    for i in range(n):
        store(back, (i,), plus(-1.0, load(end, (i,)), load(back, (i,))))
    residual, size = frobenius(back, inverse), frobenius(step, inverse)
    residual += (n + 1.0) * _EPS * size * frobenius(start, inverse)
    for i in range(n):
        for lane in range(FORCED, LANES):
            step[i, lane] = -back[i, lane]
    return size, residual


@compiled(_nrt=False)
def carry(
    steps: FloatArray,
    local: FloatArray,
    layout: FloatArray,
    count: int,
    flow: FloatArray,
    weights: FloatArray,
    work: FloatArray,
) -> float:
    """Product of the steps, its error bound and the weight with which each step's error reaches the end.

    The first-order error is sum S_j E_j Q_j, S_j the product of the steps after step j and Q_j that of those
    before it, bounded by sum |S_j| |E_j| |Q_j|. The error of a piece that is no step's has the S of its last
    and the Q of its first step.

    Parameters
    ----------
    steps : (count, n, LANES), the columns from FORCED on are states at the end of the step from rest
    local : (count,) bound on |E_j|
    layout : (count, 4) as from ``steps_of_period``
    flow : (n, LANES), out: the product, with the states from rest in the columns from FORCED on
    weights : (count, 2), out: |S_j|, and |Q_j|
    work : (3, n, LANES) scratch

    Returns
    -------
    bound on the Frobenius norm of the error of the product, rounding of the multiplications included
    """
    n = flow.shape[0]
    product, scratch = work[0], work[1]
    for i in range(n):
        for lane in range(LANES):
            flow[i, lane] = 1.0 if i == lane and lane < n else 0.0
    for k in range(count):
        weights[k, 1] = frobenius(flow, scratch)
        multiply(steps[k], flow, product)
        for i in range(n):
            store(flow, (i,), load(product, (i,)))
            for lane in range(FORCED, LANES):
                flow[i, lane] += steps[k, i, lane]
    after = work[2]
    for i in range(n):
        for lane in range(LANES):
            after[i, lane] = 1.0 if i == lane and lane < n else 0.0
    total = 0.0
    for k in range(count - 1, -1, -1):
        weights[k, 0] = frobenius(after, scratch)
        # n eps |P| is the rounding of multiplying by this step.
        local[k] += n * _EPS * frobenius(steps[k], scratch)
        total += weights[k, 0] * local[k] * weights[k, 1]
        if layout[k, 1] == layout[k, 2] - 1.0:
            total += weights[k, 0] * layout[k, 3] * weights[k - int(layout[k, 1]), 1]
        if k > 0:
            multiply(after, steps[k], product)
            for i in range(n):
                store(after, (i,), load(product, (i,)))
    return total
