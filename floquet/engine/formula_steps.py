"""Transition matrices with proven errors of systems whose A(t) is known as a formula.

Which other bounds are proven, and where, is in ``floquet/engine/proven.py``.

Sources: docs/theory/proven_bounds.md, "The matrix of a step" and "The product".
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from floquet.engine.coefficients import PeriodicMatrix
from floquet.engine.propagation import Propagation
from floquet.engine.system import PeriodicSystem
from lumped.errors import NumericalError
from lumped.typing import BoolArray, FloatArray, IntArray

_U = 0.5 * float(np.finfo(np.float64).eps)
_DEGREE = 14
_ANGLE = 1.0  # largest sum of |A_j| h of a step
_TERMS = 40
_RADII = np.array([1.5, 2.0, 3.0, 4.5, 7.0, 11.0, 18.0, 30.0, 60.0])
_CHUNK = 600_000  # entries of the matrices of the steps that are computed together: some 300 MB
_SLACK = 1.0 + 1e-9  # covers the rounding of the bounds themselves
_FLOOR = 1e-300  # covers what underflow may lose


def proven_propagation(
    system: PeriodicSystem, A: PeriodicMatrix, rtol: float, max_substeps: int
) -> tuple[Propagation, FloatArray, float]:
    """Steps of one period, and their product in balanced coordinates with a bound on its Frobenius error.

    A step whose bound is too large is cut in two.
    """
    scaling = system.balancing()
    ends = np.unique(np.clip([0.0, system.period, *A.breaks], 0.0, system.period))
    start = ends[:-1]
    end = ends[1:]
    times = []
    steps = []
    errors = []
    step_count = 0
    chunk = min(4096, 1 + _CHUNK // scaling.size**2)
    while start.size:
        if step_count + start.size > max_substeps:
            raise NumericalError(
                f"more than {max_substeps} substeps per period are needed. Use a larger max_substeps, or "
                "check the units of A and the period."
            )
        first = start[:chunk]
        last = end[:chunk]
        middle = 0.5 * (first + last)
        indivisible = (middle <= first) | (middle >= last)
        matrices, error, good = _steps(A, first, last, indivisible, scaling, rtol)
        if (~good & indivisible).any():
            raise NumericalError(
                f"A is too large near t = {first[~good & indivisible][0]:.17g} s: the step fell to rounding."
            )
        times.append(first[good])
        steps.append(matrices)
        errors.append(error[good])
        step_count += int(good.sum())
        start = np.concatenate([first[~good], middle[~good], start[chunk:]])
        end = np.concatenate([middle[~good], last[~good], end[chunk:]])
    order = np.argsort(np.concatenate(times))
    flows = np.concatenate(steps)[order]
    local = np.concatenate(errors)[order]
    product, bound = proven_product(flows, local)
    ends = np.append(np.concatenate(times)[order], system.period)
    return Propagation(ends, flows, local, rounding=np.zeros_like(local), scaling=scaling), product, bound


class _StepBounds(NamedTuple):
    """Bounds on k steps.

    Attributes
    ----------
    angle : (k,) sum of a_j, |A_j| h <= a_j
    last_terms : (k,) largest of the last two a_j
    truncation : (k,) neglected Taylor terms
    rounding : (k,) of the Taylor terms
    misfit : (k,) integral of the error of A
    errors : (k,) of the transition matrix, 2-norm
    """

    angle: FloatArray
    last_terms: FloatArray
    truncation: FloatArray
    rounding: FloatArray
    misfit: FloatArray
    errors: FloatArray


def _step_bounds(a: FloatArray, h: FloatArray, error_of_A: FloatArray, n: int) -> _StepBounds:
    """Bounds from a (k, degree + 1), a_j >= |A_j| h, also of the matrix of moduli."""
    powers_over_index = np.arange(1, _DEGREE + 2)
    # h and the products h A_j are rounded.
    misfit = h * error_of_A + 4.0 * _U * a.sum(axis=1)
    with np.errstate(over="ignore", invalid="ignore"):
        powers = _RADII[:, None] ** powers_over_index / powers_over_index
        g = a @ powers.T  # (k, radii)
        log_tails = g - _TERMS * np.log(_RADII) - np.log(_RADII - 1.0)
        truncation = np.exp(log_tails.min(axis=1)) * _SLACK
        integral = (a / powers_over_index).sum(axis=1)
        size = np.exp(integral)  # of all Taylor terms together
        roundings = (_DEGREE + n + 8.0) * integral + a.sum(axis=1) + 6.0
        rounding = math.sqrt(n) * _U * size * roundings
        errors = (truncation + rounding + misfit * size**2 * np.exp(misfit)) * _SLACK
    return _StepBounds(a.sum(axis=1), a[:, -2:].max(axis=1), truncation, rounding, misfit, errors)


def _good(bounds: _StepBounds, indivisible: BoolArray, rtol: float) -> BoolArray:
    """Which steps need not be cut."""
    allowed = np.maximum(1e-3 * rtol, 8.0 * bounds.rounding)
    good = (bounds.angle <= _ANGLE) & (bounds.truncation + bounds.misfit <= allowed)
    # Where rounding of A itself is more than that, and its polynomials end, shorter steps do not help.
    good |= (bounds.angle <= 0.05) & (bounds.last_terms <= allowed) & np.isfinite(bounds.errors)
    # A step that cannot be cut is good where its bound is, as with an impulse.
    good |= indivisible & (bounds.errors <= rtol)
    return np.asarray(good)


def _flows(B: FloatArray, used: IntArray) -> FloatArray:
    """Transition matrices (k, n, n) of X' = sum_j B_j s^j X over 0 <= s <= 1, smallest Taylor terms first.

    ``used`` are the j > 0 whose B_j is not zero in all steps.
    """
    n = B.shape[-1]
    X = np.zeros((_TERMS + 1, len(B), n, n))
    X[0] = np.eye(n)
    for k in range(_TERMS):
        term = B[:, 0] @ X[k]
        for j in used[used <= k]:
            term += B[:, j] @ X[k - j]
        X[k + 1] = term / (k + 1)
    flow = X[_TERMS].copy()
    for k in range(_TERMS - 1, -1, -1):
        flow += X[k]
    return np.asarray(flow)


def _steps(
    A: PeriodicMatrix, start: FloatArray, end: FloatArray, indivisible: BoolArray, scaling: FloatArray,
    rtol: float,
) -> tuple[FloatArray, FloatArray, BoolArray]:  # fmt: skip
    """Transition matrices of the good steps, PROVEN bounds (k,) on their errors, and good steps (k,).

    Errors are 2-norms.
    """
    h = end - start
    coefficients, error_of_A = A.taylor(start, h, _DEGREE, scaling)
    B = coefficients * h[:, None, None, None]
    a = np.linalg.norm(B, axis=(2, 3)) * _SLACK
    bounds = _step_bounds(a, h, error_of_A, scaling.size)
    good = _good(bounds, indivisible, rtol)
    if not good.any():
        return np.empty((0, scaling.size, scaling.size)), bounds.errors, good
    used = np.flatnonzero(a.any(axis=0))
    return _flows(B[good], used[used > 0]), bounds.errors, good


class _Product(NamedTuple):
    """Product of 2^rank steps, or of several such blocks.

    Attributes
    ----------
    rank : of a block; of several blocks that of the last one
    matrix : (n, n)
    size, error : bounds on the norm of the matrix and on the norm of its error
    """

    rank: int
    matrix: FloatArray
    size: float
    error: float


def _joined(first: _Product, second: _Product, rounding: float) -> _Product:
    """The block ``first.matrix @ second.matrix``; Frobenius norms."""
    a = first.size
    b = second.size
    error = a * second.error + first.error * b + first.error * second.error + rounding * a * b
    matrix = first.matrix @ second.matrix
    return _Product(second.rank + 1, matrix, _size(matrix), error)


def _tail(before: _Product | None, block: _Product, rounding: float) -> _Product:
    """Product of all blocks up to this one; 2-norm. ``before`` is the product without the last block."""
    if before is None:
        return block._replace(size=_two_norm(block.matrix))
    a = before.size
    b = block.size
    error = a * block.error + before.error * (b + block.error) + rounding * a * b * len(block.matrix)
    matrix = before.matrix @ block.matrix
    return _Product(block.rank, matrix, _two_norm(matrix), error)


def _multiplied(steps: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Product of steps (m, n, n), and bounds (m,) on the norm of the product before each step."""
    sizes_before = np.empty(len(steps))
    flow = np.eye(steps.shape[1])
    with np.errstate(over="ignore", invalid="ignore"):
        for j, step in enumerate(steps):
            sizes_before[j] = _size(flow)
            flow = step @ flow
    if not np.isfinite(flow).all() or not np.isfinite(sizes_before).all():
        raise NumericalError(
            "the state grows beyond the range of floating point within one period, so the system is unstable "
            "on any practical scale. Check the signs of damping and stiffness, or shorten the period."
        )
    return flow, sizes_before


def proven_product(steps: FloatArray, errors: FloatArray) -> tuple[FloatArray, float]:
    """Product of steps (m, n, n) with a PROVEN bound on its error; ``errors`` (m,) bound those of the steps.

    ``errors`` are 2-norms, the bound is a Frobenius norm. The blocks are a binary counter from the last step
    backwards. Source: docs/theory/proven_bounds.md, "The product".
    """
    rounding = 2.0 * steps.shape[1] * _U
    sizes = np.linalg.norm(steps, axis=(1, 2)) * _SLACK
    flow, sizes_before = _multiplied(steps)
    blocks: list[_Product] = []
    tails: list[_Product] = []
    total = 0.0
    for j in range(len(steps) - 1, -1, -1):
        size_after = tails[-1].size + tails[-1].error if tails else 1.0
        total += size_after * (errors[j] + rounding * sizes[j]) * sizes_before[j]
        block = _Product(0, steps[j], float(sizes[j]), float(errors[j]))
        while blocks and blocks[-1].rank == block.rank:
            block = _joined(blocks.pop(), block, rounding)
            tails.pop()
        blocks.append(block)
        tails.append(_tail(tails[-1] if tails else None, block, rounding))
    return flow, total * _SLACK


def _size(matrix: FloatArray) -> float:
    """Bound on the Frobenius norm, of the matrix divided by its largest entry: squares do not underflow."""
    largest = float(np.abs(matrix).max()) + _FLOOR
    return largest * float(np.linalg.norm(matrix / largest)) * _SLACK + _FLOOR


def _two_norm(matrix: FloatArray) -> float:
    """Bound on the 2-norm: |A|^2 <= |A^T A|_F, of A divided by its Frobenius norm."""
    size = _size(matrix)
    scaled = matrix / size
    return size * math.sqrt(float(np.linalg.norm(scaled.T @ scaled)) + 1e-12) * _SLACK
