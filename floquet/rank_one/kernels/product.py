"""The product of the steps of one period, and how their errors reach its end, compiled."""

from __future__ import annotations

import math

from floquet.rank_one.kernels.simd import LANES, load, plus, plus_square, scaled, store, total, zero
from lumped.compiler import compiled
from lumped.typing import FloatArray

BLOCKS = 34
"""Blocks of steps held at once at most: enough for 2^32 steps."""
_EPS = 2.220446049250313e-16
_PIVOT = 0.1  # of the norm of a matrix: larger diagonal elements are pivots without a search
_SLACK = 1.0 + 1e-11  # rounding of a bound itself
_FLOOR = 1e-150  # squares of what is smaller may be lost


@compiled(_nrt=False, forceinline=True)
def frobenius(rows: FloatArray) -> float:
    """Bound on the norm of rows[:, 0:n], zero beyond; squares may be lost to underflow."""
    n = rows.shape[0]
    squares = zero()
    for c in range(0, n, LANES):
        for i in range(n):
            squares = plus_square(load(rows, (i, c)), squares)
    return math.sqrt(total(squares)) + _FLOOR


@compiled(_nrt=False, forceinline=True)
def copy(source: FloatArray, out: FloatArray) -> None:
    """Out = source, as many rows as out has."""
    n = out.shape[0]
    for c in range(0, n, LANES):
        for i in range(n):
            store(out, (i, c), load(source, (i, c)))


@compiled(_nrt=False, forceinline=True)
def multiply(left: FloatArray, right: FloatArray, out: FloatArray) -> None:
    """Out = left[:, 0:n] @ right, all (n, lanes)."""
    n = left.shape[0]
    for c in range(0, n, LANES):
        for i in range(n):
            row = zero()
            for q in range(n):
                row = plus(left[i, q], load(right, (q, c)), row)
            store(out, (i, c), row)


@compiled(_nrt=False, forceinline=True)
def invert(A: FloatArray, unit: FloatArray, work: FloatArray, out: FloatArray) -> None:
    """Out[:, 0:n] = inverse of A[:, 0:n], (n, lanes), by Gauss-Jordan elimination with row pivots.

    Not finite where A is singular. ``unit`` has the rows of the unit matrix, ``work`` is scratch like A. The
    diagonal is taken as it is where it is not small: over a short step A is next to the unit matrix.
    """
    n = A.shape[0]
    lanes = A.shape[1]
    copy(A, work)
    copy(unit, out)
    small = _PIVOT * frobenius(A)
    for k in range(n):
        p = k
        if abs(work[k, k]) < small:
            for i in range(k + 1, n):
                if abs(work[i, k]) > abs(work[p, k]):
                    p = i
        factor = 1.0 / work[p, k]
        own = k - k % LANES
        if p != k:
            for c in range(0, lanes, LANES):
                left, right = load(work, (p, c)), load(out, (p, c))
                store(work, (p, c), load(work, (k, c)))
                store(out, (p, c), load(out, (k, c)))
                store(work, (k, c), left)
                store(out, (k, c), right)
        for step in range(LANES, lanes + LANES, LANES):
            c = (own + step) % lanes  # last that of the factors of this round
            left, right = scaled(factor, load(work, (k, c))), scaled(factor, load(out, (k, c)))
            store(work, (k, c), left)
            store(out, (k, c), right)
            for i in range(n):
                if i != k:
                    turned = -work[i, k]
                    store(work, (i, c), plus(turned, left, load(work, (i, c))))
                    store(out, (i, c), plus(turned, right, load(out, (i, c))))


@compiled(_nrt=False, forceinline=True)
def divide(
    end: FloatArray, start: FloatArray, unit: FloatArray, scratch: FloatArray, step: FloatArray
) -> tuple[float, float]:
    """Flow over a step, P = E S^-1, from those from its middle to its end E and to its start S, (n, lanes).

    Returns |P| and a bound on |P S - E|, Frobenius norms. ``scratch`` is (2, n, lanes).
    """
    n = end.shape[0]
    inverse = scratch[0]
    back = scratch[1]
    invert(start, unit, back, inverse)
    multiply(end, inverse, step)
    multiply(step, start, back)
    for c in range(0, n, LANES):
        for i in range(n):
            store(back, (i, c), plus(-1.0, load(end, (i, c)), load(back, (i, c))))
    residual = frobenius(back)
    size = frobenius(step)
    residual += (n + 1.0) * _EPS * size * frobenius(start)
    return size, residual


@compiled(_nrt=False, forceinline=True)
def spectral(A: FloatArray, square: FloatArray) -> float:
    """Bound on the 2-norm of A[:, 0:n]: |A|^2 <= |A^T A|_F, too large by at most the fourth root of n.

    |A|_F where the fourth powers in that would be lost to underflow.
    """
    size = frobenius(A)
    n = A.shape[0]
    if size < 1e-60:
        return size * _SLACK
    for c in range(0, n, LANES):
        for i in range(n):
            row = zero()
            for q in range(n):
                row = plus(A[q, i], load(A, (q, c)), row)
            store(square, (i, c), row)
    return math.sqrt(frobenius(square)) * _SLACK


@compiled(_nrt=False)
def carry(
    steps: FloatArray,
    local: FloatArray,
    sizes: FloatArray,
    count: int,
    flow: FloatArray,
    before: FloatArray,
    work: FloatArray,
    table: FloatArray,
) -> float:
    """Product of the steps; returns a bound on the Frobenius norm of its error, rounding included.

    With Q_j the computed product before step j, E_j its error and S_j the *exact* flow behind it, that is
    the sum of S_j E_j Q_j (docs/theory/proven_bounds.md, "The product"). S_j is known as a
    product of blocks of 2^k steps, a binary counter from the last step backwards.

    Steps are (count, n, lanes), ``local`` bounds |E_j|, ``sizes`` the Frobenius norms of the steps; the
    product goes to ``flow``. Scratch: ``before`` bounds |Q_j|, ``work`` is (2 BLOCKS + 1, n, lanes),
    ``table`` (5, BLOCKS) holds norm, error, rank of the blocks and norm, error of their product.
    """
    n = flow.shape[0]
    product = work[0]
    copy(steps[0], flow)
    before[0] = math.sqrt(n) * _SLACK
    for k in range(1, count):
        before[k] = frobenius(flow)
        multiply(steps[k], flow, product)
        copy(product, flow)
    top = 0
    bound = 0.0
    for k in range(count - 1, -1, -1):
        after = table[3, top - 1] + table[4, top - 1] if top > 0 else 1.0
        # n eps |P| is the rounding of multiplying by this step.
        bound += after * (local[k] + n * _EPS * sizes[k]) * before[k]
        copy(steps[k], work[1 + top])
        rank = 0
        table[0, top] = sizes[k]
        table[1, top] = local[k]
        table[2, top] = 0.0
        top += 1
        while top > 1 and table[2, top - 2] == rank:
            one = top - 2
            two = top - 1
            a = table[0, one]
            b = table[0, two]
            da = table[1, one]
            db = table[1, two]
            multiply(work[1 + one], work[1 + two], product)
            copy(product, work[1 + one])
            rank += 1
            table[0, one] = frobenius(product)
            table[1, one] = a * db + da * b + da * db + n * _EPS * a * b
            table[2, one] = rank
            top = one + 1
        # The product of all blocks, which is the flow from here to the end, and its error.
        last = top - 1
        base = 1 + BLOCKS
        if last == 0:
            copy(work[1], work[base])
            table[4, 0] = table[1, 0]
        else:
            multiply(work[base + last - 1], work[1 + last], work[base + last])
            a = table[3, last - 1]
            da = table[4, last - 1]
            b = table[0, last]
            db = table[1, last]
            table[4, last] = a * db + da * (b + db) + n * n * _EPS * a * b
        table[3, last] = spectral(work[base + last], product)
    return bound * _SLACK
