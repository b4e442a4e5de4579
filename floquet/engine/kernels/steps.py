"""Taylor steps of x' = A(t) x for many steps, and products of many steps for many systems, compiled.

Sources: docs/theory/proven_bounds.md, "The matrix of a step" and "The product".
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from floquet.engine.kernels.simd import LANES, aligned_empty, load, plus, plus_product, scaled, store, zero
from lumped.compiler import called, compiled, inlined
from lumped.typing import FloatArray, IntArray

_U = 1.1102230246251565e-16
_SLACK = 1.0 + 1e-9  # covers the rounding of the bounds themselves
_FLOOR = 1e-300  # covers what underflow may lose
_BLOCKS = 34  # of the binary counter: enough for 2^32 steps


@called
def _load(B: FloatArray, start: int, lanes: FloatArray, first: IntArray, end: IntArray) -> None:
    """Copy eight steps of B (k, powers, n, n) into lanes (powers, n, n, 8), with zeros after the last step.

    ``first`` and ``end`` (powers, n) enclose the columns of each row that are not zero in all of these steps.
    """
    powers, n, _, _ = lanes.shape
    for j in range(powers):
        for i in range(n):
            first[j, i] = n
            end[j, i] = 0
            for p in range(n):
                for lane in range(LANES):
                    entry = 0.0
                    if start + lane < B.shape[0]:
                        entry = B[start + lane, j, i, p]
                    lanes[j, i, p, lane] = entry
                    if entry != 0.0:
                        first[j, i] = min(first[j, i], p)
                        end[j, i] = p + 1


@inlined
def _next_coefficient(B: FloatArray, first: IntArray, end: IntArray, k: int, X: FloatArray) -> None:
    """X[k + 1] = sum_j B_j X[k - j]/(k + 1), of eight steps.

    The product of a row of B_j and X[k - j] is summed first, then the products of all j.
    """
    powers, n, _, _ = B.shape
    for i in range(n):
        for c in range(n):
            entry = zero()
            for j in range(min(k, powers - 1) + 1):
                row = zero()
                for p in range(first[j, i], end[j, i]):
                    row = plus_product(load(B, (j, i, p, 0)), load(X, (k - j, p, c, 0)), row)
                entry = plus(1.0, row, entry)
            store(X, (k + 1, i, c, 0), scaled(1.0 / (k + 1.0), entry))


@compiled(nogil=True, long_loops=True)
def taylor_flows(B: FloatArray, terms: IntArray, flows: FloatArray) -> None:
    """Transition matrices (k, n, n) of X' = sum_j B_j s^j X over 0 <= s <= 1, B (k, powers, n, n).

    The coefficients obey (k + 1) X_{k+1} = sum_j B_j X_{k-j}; each step has at least its number of terms
    (k,). Smallest Taylor terms are added first. What is zero in B is left out, which rounds nothing.
    """
    powers = B.shape[1]
    n = B.shape[2]
    lanes = aligned_empty(powers * n * n * LANES).reshape((powers, n, n, LANES))
    X = aligned_empty((terms.max() + 1) * n * n * LANES).reshape((terms.max() + 1, n, n, LANES))
    first = np.empty((powers, n), np.int64)
    end = np.empty((powers, n), np.int64)
    row = np.empty(LANES)
    for start in range(0, B.shape[0], LANES):
        _load(B, start, lanes, first, end)
        count = min(LANES, B.shape[0] - start)
        most = terms[start : start + count].max()
        for i in range(n):
            for c in range(n):
                for lane in range(LANES):
                    X[0, i, c, lane] = 1.0 if i == c else 0.0
        for k in range(most):
            _next_coefficient(lanes, first, end, k, X)
        for i in range(n):
            for c in range(n):
                entry = load(X, (most, i, c, 0))
                for k in range(most - 1, -1, -1):
                    entry = plus(1.0, load(X, (k, i, c, 0)), entry)
                store(row, (0,), entry)
                for lane in range(count):
                    flows[start + lane, i, c] = row[lane]


@called
def _copy(source: FloatArray, out: FloatArray) -> None:
    """Out = source; an assignment of arrays would allocate a copy."""
    for i in range(source.shape[0]):
        for c in range(source.shape[1]):
            out[i, c] = source[i, c]


@called
def _multiply(left: FloatArray, right: FloatArray, out: FloatArray) -> None:
    """Out = left @ right."""
    n = left.shape[0]
    for i in range(n):
        for c in range(n):
            out[i, c] = 0.0
        for p in range(n):
            entry = left[i, p]
            for c in range(n):
                out[i, c] += entry * right[p, c]


@compiled()
def frobenius_bound(matrix: FloatArray) -> float:
    """Bound on the Frobenius norm, of the matrix divided by its largest entry: squares do not underflow."""
    n = matrix.shape[0]
    largest = _FLOOR
    for i in range(n):
        for c in range(n):
            size = abs(matrix[i, c])
            if not size <= largest:  # also where it is nan
                largest = size
    squares = 0.0
    for i in range(n):
        for c in range(n):
            ratio = matrix[i, c] / largest
            squares += ratio * ratio
    return largest * math.sqrt(squares) * _SLACK + _FLOOR


@compiled()
def two_norm_bound(matrix: FloatArray) -> float:
    """Bound on the 2-norm: |A|^2 <= |A^T A|_F, of A divided by its Frobenius norm."""
    n = matrix.shape[0]
    size = frobenius_bound(matrix)
    squares = 0.0
    for i in range(n):
        for c in range(n):
            entry = 0.0
            for p in range(n):
                entry += (matrix[p, i] / size) * (matrix[p, c] / size)
            squares += entry * entry
    return size * math.sqrt(math.sqrt(squares) + 1e-12) * _SLACK


class _Blocks(NamedTuple):
    """Products of 2^rank steps each, a binary counter from the last step backwards; and products of blocks.

    Attributes
    ----------
    matrices : (blocks, n, n)
    sizes, errors : (blocks,) bounds on the Frobenius norms, and on those of their errors
    ranks : (blocks,)
    tails : (blocks, n, n) products of the blocks up to each one
    tail_sizes, tail_errors : (blocks,) bounds on the 2-norms of the tails, and on those of their errors
    """

    matrices: FloatArray
    sizes: FloatArray
    errors: FloatArray
    ranks: IntArray
    tails: FloatArray
    tail_sizes: FloatArray
    tail_errors: FloatArray


@called
def _join_last_two(blocks: _Blocks, last: int, rounding: float, product: FloatArray) -> None:
    """Replace the last two blocks A and B by A B: its error is a e_B + e_A b + e_A e_B + rounding a b."""
    a = blocks.sizes[last - 1]
    b = blocks.sizes[last]
    error_a = blocks.errors[last - 1]
    error_b = blocks.errors[last]
    _multiply(blocks.matrices[last - 1], blocks.matrices[last], product)
    _copy(product, blocks.matrices[last - 1])
    blocks.sizes[last - 1] = frobenius_bound(product)
    blocks.errors[last - 1] = a * error_b + error_a * b + error_a * error_b + rounding * a * b
    blocks.ranks[last - 1] += 1


@called
def _extend_tail(blocks: _Blocks, last: int, rounding: float) -> None:
    """Multiply the tail A of the blocks before the last one by the last block B, and bound size and error."""
    if last == 0:
        _copy(blocks.matrices[0], blocks.tails[0])
        blocks.tail_errors[0] = blocks.errors[0]
    else:
        a = blocks.tail_sizes[last - 1]
        b = blocks.sizes[last]
        error_a = blocks.tail_errors[last - 1]
        error_b = blocks.errors[last]
        _multiply(blocks.tails[last - 1], blocks.matrices[last], blocks.tails[last])
        n = blocks.tails.shape[1]
        blocks.tail_errors[last] = a * error_b + error_a * (b + error_b) + rounding * a * b * n
    blocks.tail_sizes[last] = two_norm_bound(blocks.tails[last])


@compiled()
def _flow_and_sizes_before(steps: FloatArray, flow: FloatArray, sizes_before: FloatArray) -> None:
    """Flow = product of steps (m, n, n); bounds (m,) on the norm of the product before each step."""
    n = flow.shape[0]
    product = np.empty((n, n))
    for i in range(n):
        for c in range(n):
            flow[i, c] = 1.0 if i == c else 0.0
    for k in range(steps.shape[0]):
        sizes_before[k] = frobenius_bound(flow)
        _multiply(steps[k], flow, product)
        _copy(product, flow)


@compiled(nogil=True, long_loops=True)
def product_bounds(
    steps: FloatArray, errors: FloatArray, ends: IntArray, flows: FloatArray, bounds: FloatArray
) -> None:
    """Products (k, n, n) of runs of steps (m, n, n), with PROVEN bounds (k,) on their Frobenius errors.

    Run i are the steps ``ends[i]`` to ``ends[i + 1]``, in order of time; ``errors`` (m,) bound the 2-norms of
    the errors of the steps. S_j is the *exact* flow after step j, Q_j the computed product before it: the
    error of the product is the sum of S_j (E_j + R_j) Q_j. S_j is known as a product of blocks of 2^k steps.
    Bounds are not finite where a product is beyond floating point.
    """
    n = steps.shape[1]
    rounding = 2.0 * n * _U
    blocks = _Blocks(
        np.empty((_BLOCKS, n, n)), np.empty(_BLOCKS), np.empty(_BLOCKS), np.empty(_BLOCKS, np.int64),
        np.empty((_BLOCKS, n, n)), np.empty(_BLOCKS), np.empty(_BLOCKS),
    )  # fmt: skip
    product = np.empty((n, n))
    sizes_before = np.empty(steps.shape[0])
    for run in range(flows.shape[0]):
        start = ends[run]
        end = ends[run + 1]
        _flow_and_sizes_before(steps[start:end], flows[run], sizes_before[start:end])
        count = 0
        total = 0.0
        for k in range(end - 1, start - 1, -1):
            size_after = 1.0
            if count > 0:
                size_after = blocks.tail_sizes[count - 1] + blocks.tail_errors[count - 1]
            size = frobenius_bound(steps[k])
            total += size_after * (errors[k] + rounding * size) * sizes_before[k]
            _copy(steps[k], blocks.matrices[count])
            blocks.sizes[count] = size
            blocks.errors[count] = errors[k]
            blocks.ranks[count] = 0
            while count > 0 and blocks.ranks[count - 1] == blocks.ranks[count]:
                _join_last_two(blocks, count, rounding, product)
                count -= 1
            _extend_tail(blocks, count, rounding)
            count += 1
        bounds[run] = total * _SLACK
