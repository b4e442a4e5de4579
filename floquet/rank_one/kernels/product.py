"""The product of the steps of one period with a bound on its error, compiled.

Matrices are (n, lanes): n columns, and zeros up to a whole number of `LANES`.

Sources: docs/theory/proven_bounds.md, "The matrix of a step" and "The product".
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from floquet.engine.kernels.simd import (
    LANES,
    aligned_empty,
    aligned_matrices,
    aligned_rows,
    load,
    plus,
    plus_square,
    scaled,
    store,
    total,
    zero,
)
from lumped.compiler import compiled, inlined
from lumped.typing import FloatArray

BLOCKS = 34
"""Largest number of blocks in the binary counter of `carry`: enough for 2^32 steps."""
_EPS = 2.220446049250313e-16
_PIVOT = 0.1  # a diagonal element above this part of the norm of its matrix is a pivot without a search
_SLACK = 1.0 + 1e-11  # covers the rounding of a bound itself
_FLOOR = 1e-150  # squares of smaller numbers may underflow


@inlined
def frobenius(rows: FloatArray) -> float:
    """Bound on the Frobenius norm of a matrix, also where squares of its entries underflow."""
    n = rows.shape[0]
    squares = zero()
    for c in range(0, n, LANES):
        for i in range(n):
            squares = plus_square(load(rows, (i, c)), squares)
    return math.sqrt(total(squares)) + _FLOOR


@inlined
def copy(source: FloatArray, out: FloatArray) -> None:
    """Out = the first rows of source, as many as out has."""
    n = out.shape[0]
    for c in range(0, n, LANES):
        for i in range(n):
            store(out, (i, c), load(source, (i, c)))


@inlined
def multiply(left: FloatArray, right: FloatArray, out: FloatArray) -> None:
    """Out = left @ right."""
    n = left.shape[0]
    for c in range(0, n, LANES):
        for i in range(n):
            row = zero()
            for q in range(n):
                row = plus(left[i, q], load(right, (q, c)), row)
            store(out, (i, c), row)


@inlined
def _pivot_row(A: FloatArray, k: int, small: float) -> int:
    """Row of the pivot of column k: row k, or the row of the largest element below where A[k, k] is small."""
    pivot = k
    if abs(A[k, k]) < small:
        for i in range(k + 1, A.shape[0]):
            if abs(A[i, k]) > abs(A[pivot, k]):
                pivot = i
    return pivot


@inlined
def _exchange_rows(A: FloatArray, i: int, k: int) -> None:
    """Exchange rows i and k of A (n, lanes)."""
    for c in range(0, A.shape[1], LANES):
        row = load(A, (i, c))
        store(A, (i, c), load(A, (k, c)))
        store(A, (k, c), row)


@inlined
def _eliminate(A: FloatArray, inverse: FloatArray, k: int, factor: float) -> None:
    """Scale row k by a factor, and subtract multiples of row k that clear column k of A in all other rows.

    In place, eight columns after the other. Column k of A holds the multiples, so the eight columns that
    contain column k come last.
    """
    n = A.shape[0]
    lanes = A.shape[1]
    block_of_column = k - k % LANES
    for offset in range(LANES, lanes + LANES, LANES):
        c = (block_of_column + offset) % lanes
        pivot_row = scaled(factor, load(A, (k, c)))
        pivot_row_of_inverse = scaled(factor, load(inverse, (k, c)))
        store(A, (k, c), pivot_row)
        store(inverse, (k, c), pivot_row_of_inverse)
        for i in range(n):
            if i != k:
                multiple = -A[i, k]
                store(A, (i, c), plus(multiple, pivot_row, load(A, (i, c))))
                store(inverse, (i, c), plus(multiple, pivot_row_of_inverse, load(inverse, (i, c))))


@inlined
def invert(A: FloatArray, unit: FloatArray, scratch: FloatArray, out: FloatArray) -> None:
    """Out = inverse of A by Gauss-Jordan elimination with row pivots; not finite where A is singular.

    ``unit`` has the rows of the unit matrix, ``scratch`` is like A. Over a short step A is next to the unit
    matrix, so a diagonal element that is not small is the pivot without a search.
    """
    copy(A, scratch)
    copy(unit, out)
    small = _PIVOT * frobenius(A)
    for k in range(A.shape[0]):
        pivot = _pivot_row(scratch, k, small)
        factor = 1.0 / scratch[pivot, k]
        if pivot != k:
            _exchange_rows(scratch, pivot, k)
            _exchange_rows(out, pivot, k)
        _eliminate(scratch, out, k, factor)


@compiled(_nrt=False, forceinline=True)
def divide(
    end: FloatArray, start: FloatArray, unit: FloatArray, scratch: FloatArray, step: FloatArray
) -> tuple[float, float]:
    """Flow over a step, P = E S^-1; E and S are the flows from the middle to the end and to the start.

    Returns |P| and a bound on |P S - E|, Frobenius norms. ``scratch`` is (2, n, lanes).
    """
    n = end.shape[0]
    inverse = scratch[0]
    difference = scratch[1]
    invert(start, unit, difference, inverse)
    multiply(end, inverse, step)
    multiply(step, start, difference)
    for c in range(0, n, LANES):
        for i in range(n):
            store(difference, (i, c), plus(-1.0, load(end, (i, c)), load(difference, (i, c))))
    residual = frobenius(difference)
    size = frobenius(step)
    residual += (n + 1.0) * _EPS * size * frobenius(start)
    return size, residual


@inlined
def gram(A: FloatArray, out: FloatArray) -> None:
    """Out = A^T A."""
    n = A.shape[0]
    for c in range(0, n, LANES):
        for i in range(n):
            row = zero()
            for q in range(n):
                row = plus(A[q, i], load(A, (q, c)), row)
            store(out, (i, c), row)


@inlined
def spectral(A: FloatArray, square: FloatArray) -> float:
    """Bound on the 2-norm: |A|^2 <= |A^T A|_F, too large by at most the fourth root of n.

    The Frobenius norm where fourth powers of the entries would underflow.
    """
    size = frobenius(A)
    if size < 1e-60:
        return size * _SLACK
    gram(A, square)
    return math.sqrt(frobenius(square)) * _SLACK


class Steps(NamedTuple):
    """The steps of one period.

    Attributes
    ----------
    matrices : (most, n, lanes)
    errors : (most,) bounds on the norms of the errors
    sizes : (most,) Frobenius norms
    """

    matrices: FloatArray
    errors: FloatArray
    sizes: FloatArray


class Blocks(NamedTuple):
    """Products of 2^rank steps each, a binary counter; and the products of the first 1, 2, ... blocks.

    Attributes
    ----------
    matrices : (BLOCKS, n, lanes)
    sizes, errors : (BLOCKS,) Frobenius norms, and bounds on the errors
    ranks : (BLOCKS,)
    tails : (BLOCKS, n, lanes) products of the blocks up to each one; the last is the flow from the present
        step to the end of the period
    tail_sizes, tail_errors : (BLOCKS,) bounds on the 2-norms of the tails, and on their errors
    """

    matrices: FloatArray
    sizes: FloatArray
    errors: FloatArray
    ranks: npt.NDArray[np.int64]
    tails: FloatArray
    tail_sizes: FloatArray
    tail_errors: FloatArray


class ProductWorkspace(NamedTuple):
    """Arrays of one thread for `carry`.

    Attributes
    ----------
    blocks : see `Blocks`
    sizes_before : (most,) bounds on the norms of the products of the steps before each step
    product : (n, lanes)
    """

    blocks: Blocks
    sizes_before: FloatArray
    product: FloatArray


@compiled(no_cpython_wrapper=True)
def steps_for(most: int, n: int, lanes: int) -> Steps:
    """Allocate the steps of one period."""
    matrices = aligned_empty(most * n * lanes).reshape((most, n, lanes))
    return Steps(matrices, np.empty(most), np.empty(most))


@compiled()
def product_workspace(most: int, n: int, lanes: int) -> ProductWorkspace:
    """Allocate the workspace of `carry` for at most ``most`` steps."""
    blocks = Blocks(
        matrices=aligned_matrices(BLOCKS, n, lanes),
        sizes=np.zeros(BLOCKS),
        errors=np.zeros(BLOCKS),
        ranks=np.zeros(BLOCKS, dtype=np.int64),
        tails=aligned_matrices(BLOCKS, n, lanes),
        tail_sizes=np.zeros(BLOCKS),
        tail_errors=np.zeros(BLOCKS),
    )
    return ProductWorkspace(blocks, np.empty(most), aligned_rows(n, lanes))


@inlined
def _multiply_steps(steps: Steps, count: int, work: ProductWorkspace, flow: FloatArray) -> None:
    """Flow = product of the steps, first step first; bounds on the norm before each step."""
    n = flow.shape[0]
    copy(steps.matrices[0], flow)
    work.sizes_before[0] = math.sqrt(n) * _SLACK
    for k in range(1, count):
        work.sizes_before[k] = frobenius(flow)
        multiply(steps.matrices[k], flow, work.product)
        copy(work.product, flow)


@inlined
def _add_step(steps: Steps, k: int, count: int, blocks: Blocks, product: FloatArray) -> int:
    """Add step k as a block of rank 0 to ``count`` blocks, and join blocks of equal rank; the new count."""
    copy(steps.matrices[k], blocks.matrices[count])
    blocks.sizes[count] = steps.sizes[k]
    blocks.errors[count] = steps.errors[k]
    blocks.ranks[count] = 0
    last = count
    while last > 0 and blocks.ranks[last - 1] == blocks.ranks[last]:
        _join_blocks(blocks, last, product)
        last -= 1
    return last + 1


@inlined
def _join_blocks(blocks: Blocks, last: int, product: FloatArray) -> None:
    """Replace the last two blocks A and B by A B: its error is a e_B + e_A b + e_A e_B + n eps a b."""
    n = product.shape[0]
    a = blocks.sizes[last - 1]
    b = blocks.sizes[last]
    error_a = blocks.errors[last - 1]
    error_b = blocks.errors[last]
    multiply(blocks.matrices[last - 1], blocks.matrices[last], product)
    copy(product, blocks.matrices[last - 1])
    blocks.sizes[last - 1] = frobenius(product)
    blocks.errors[last - 1] = a * error_b + error_a * b + error_a * error_b + n * _EPS * a * b
    blocks.ranks[last - 1] += 1


@inlined
def _extend_tail(blocks: Blocks, last: int, product: FloatArray) -> None:
    """Multiply the tail A of the blocks before the last one by the last block B, and bound size and error."""
    n = product.shape[0]
    if last == 0:
        copy(blocks.matrices[0], blocks.tails[0])
        blocks.tail_errors[0] = blocks.errors[0]
    else:
        multiply(blocks.tails[last - 1], blocks.matrices[last], blocks.tails[last])
        a = blocks.tail_sizes[last - 1]
        b = blocks.sizes[last]
        error_a = blocks.tail_errors[last - 1]
        error_b = blocks.errors[last]
        blocks.tail_errors[last] = a * error_b + error_a * (b + error_b) + n * n * _EPS * a * b
    blocks.tail_sizes[last] = spectral(blocks.tails[last], product)


@compiled(_nrt=False)
def carry(steps: Steps, count: int, work: ProductWorkspace, flow: FloatArray) -> float:
    """Flow = product of the steps; returns a PROVEN bound on the Frobenius norm of the error of the flow.

    Q_j is the computed product before step j, E_j the error of step j and S_j the *exact* flow after step j.
    The error of the product is the sum of S_j E_j Q_j (docs/theory/proven_bounds.md, "The product"). S_j is
    known as a product of blocks of 2^k steps, a binary counter from the last step backwards.
    """
    n = flow.shape[0]
    blocks = work.blocks
    _multiply_steps(steps, count, work, flow)
    block_count = 0
    bound = 0.0
    for k in range(count - 1, -1, -1):
        size_after = 1.0
        if block_count > 0:
            size_after = blocks.tail_sizes[block_count - 1] + blocks.tail_errors[block_count - 1]
        # n eps |P| is the rounding of multiplying by this step.
        bound += size_after * (steps.errors[k] + n * _EPS * steps.sizes[k]) * work.sizes_before[k]
        block_count = _add_step(steps, k, block_count, blocks, work.product)
        _extend_tail(blocks, block_count - 1, work.product)
    return bound * _SLACK
