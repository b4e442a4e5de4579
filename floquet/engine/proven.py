"""Transition matrices with proven errors of systems whose A(t) is known as a formula.

Sources: docs/theory/proven_bounds.md, "The matrix of a step" and "The product".
"""

from __future__ import annotations

import math

import numpy as np

from floquet.engine.coefficients import PeriodicMatrix
from floquet.engine.propagation import Propagation
from floquet.engine.system import PeriodicSystem
from lumped.errors import NumericalError
from lumped.typing import BoolArray, FloatArray

_U = 0.5 * float(np.finfo(np.float64).eps)
_DEGREE = 14
_ANGLE = 1.0  # of a step, sum of |A_j| h
_TERMS = 40
_RADII = np.array([1.5, 2.0, 3.0, 4.5, 7.0, 11.0, 18.0, 30.0, 60.0])
_CHUNK = 600_000  # entries of the matrices of the steps taken at once: some 300 MB
_SLACK = 1.0 + 1e-9  # rounding of the bounds themselves
_FLOOR = 1e-300  # what underflow may take


def proven_propagation(
    system: PeriodicSystem, known: PeriodicMatrix, rtol: float, max_substeps: int
) -> tuple[Propagation, FloatArray, float]:
    """Steps of one period, their product in balanced coordinates, and a bound on its Frobenius error."""
    d = system.balancing()
    ends = np.unique(np.clip([0.0, system.period, *known.breaks], 0.0, system.period))
    start, end = ends[:-1], ends[1:]
    times = []
    steps = []
    errors = []
    taken = 0
    chunk = min(4096, 1 + _CHUNK // d.size**2)
    while start.size:
        if taken + start.size > max_substeps:
            raise NumericalError(
                f"more than {max_substeps} substeps per period are needed. Use a larger max_substeps, or "
                "check the units of A and the period."
            )
        first, last = start[:chunk], end[:chunk]
        middle = 0.5 * (first + last)
        whole = (middle <= first) | (middle >= last)
        matrices, error, good = _steps(known, first, last, whole, d, rtol)
        if (~good & whole).any():
            raise NumericalError(
                f"A is too large near t = {first[~good & whole][0]:.17g} s: the step fell to rounding."
            )
        times.append(first[good])
        steps.append(matrices)
        errors.append(error[good])
        taken += int(good.sum())
        start = np.concatenate([first[~good], middle[~good], start[chunk:]])
        end = np.concatenate([middle[~good], last[~good], end[chunk:]])
    order = np.argsort(np.concatenate(times))
    flows = np.concatenate(steps)[order]
    local = np.concatenate(errors)[order]
    product, bound = proven_product(flows, local)
    ends = np.append(np.concatenate(times)[order], system.period)
    return Propagation(ends, flows, local, rounding=np.zeros_like(local), scaling=d), product, bound


def _steps(
    known: PeriodicMatrix, start: FloatArray, end: FloatArray, whole: BoolArray, d: FloatArray, rtol: float
) -> tuple[FloatArray, FloatArray, BoolArray]:
    """Transition matrices of the good steps, bounds (k,) on the 2-norms of the errors, and which are good.

    A step that cannot be cut (``whole``) is good where its bound is, as with an impulse.
    """
    h, n = end - start, d.size
    A, wrong = known.taylor(start, h, _DEGREE, d)
    B = A * h[:, None, None, None]
    a = np.linalg.norm(B, axis=(2, 3)) * _SLACK  # (k, degree + 1) >= |B_j|, and of the matrix of moduli
    # h and the products h A_j are rounded.
    off = h * wrong + 4.0 * _U * a.sum(axis=1)
    with np.errstate(over="ignore", invalid="ignore"):
        powers = _RADII[:, None] ** np.arange(1, _DEGREE + 2) / np.arange(1, _DEGREE + 2)
        g = a @ powers.T  # (k, radii)
        tails = g - _TERMS * np.log(_RADII) - np.log(_RADII - 1.0)
        tail = np.exp(tails.min(axis=1)) * _SLACK
        total = (a / np.arange(1, _DEGREE + 2)).sum(axis=1)  # sum of a_j/(j+1): sum of all r_k = exp
        size = np.exp(total)
        rounding = math.sqrt(n) * _U * size * ((_DEGREE + n + 8.0) * total + a.sum(axis=1) + 6.0)
        errors = (tail + rounding + off * size**2 * np.exp(off)) * _SLACK
    room = np.maximum(1e-3 * rtol, 8.0 * rounding)
    good = (a.sum(axis=1) <= _ANGLE) & (tail + off <= room)
    # Where rounding of A itself is more than that, and its polynomials end, shorter steps do not help.
    good |= (a.sum(axis=1) <= 0.05) & (a[:, -2:].max(axis=1) <= room) & np.isfinite(errors)
    good |= whole & (errors <= rtol)
    if not good.any():
        return np.empty((0, n, n)), errors, good
    used = np.flatnonzero(a.any(axis=0))
    B = B[good]
    X = np.zeros((_TERMS + 1, len(B), n, n))
    X[0] = np.eye(n)
    for k in range(_TERMS):
        term = B[:, 0] @ X[k]
        for j in used[(used > 0) & (used <= k)]:
            term += B[:, j] @ X[k - j]
        X[k + 1] = term / (k + 1)
    flow = X[_TERMS].copy()
    for k in range(_TERMS - 1, -1, -1):
        flow += X[k]
    return flow, errors, good


def proven_product(steps: FloatArray, errors: FloatArray) -> tuple[FloatArray, float]:
    """Product of steps (m, n, n) whose 2-norm errors are at most ``errors``, and a bound on its error.

    Source: docs/theory/proven_bounds.md, "The product".
    """
    m, n, _ = steps.shape
    rounding = 2.0 * n * _U
    sizes = np.linalg.norm(steps, axis=(1, 2)) * _SLACK
    before = np.empty(m)
    flow = np.eye(n)
    with np.errstate(over="ignore", invalid="ignore"):
        for j in range(m):
            before[j] = _size(flow)
            flow = steps[j] @ flow
    if not np.isfinite(flow).all() or not np.isfinite(before).all():
        raise NumericalError(
            "the state grows beyond the range of floating point within one period, so the system is unstable "
            "on any practical scale. Check the signs of damping and stiffness, or shorten the period."
        )
    blocks: list[tuple[int, FloatArray, float, float]] = []  # rank, product, norm, error
    tails: list[tuple[FloatArray, float, float]] = []  # product of the first blocks, norm, error
    total = 0.0
    for j in range(m - 1, -1, -1):
        after = tails[-1][1] + tails[-1][2] if tails else 1.0
        total += after * (errors[j] + rounding * sizes[j]) * before[j]
        rank = 0
        block = steps[j]
        norm = float(sizes[j])
        error = float(errors[j])
        while blocks and blocks[-1][0] == rank:
            _, other, size, off = blocks.pop()
            tails.pop()
            error = size * error + off * norm + off * error + rounding * size * norm
            block = other @ block
            rank = rank + 1
            norm = _size(block)
        blocks.append((rank, block, norm, error))
        if tails:
            other, size, off = tails[-1]
            error = size * error + off * (norm + error) + rounding * size * norm * n
            block = other @ block
        tails.append((block, _two_norm(block), error))
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
