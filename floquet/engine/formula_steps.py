"""Transition matrices with proven errors of systems whose A(t) is known as a formula, many systems at once.

Which other bounds are proven, and where, is in ``floquet/proven.py``.

Sources: docs/theory/proven_bounds.md, "The matrix of a step" and "The product".
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from floquet.engine.coefficients import PeriodicMatrix
from floquet.engine.kernels.steps import product_bounds, taylor_flows
from floquet.engine.propagation import Propagation
from floquet.engine.stacked import StackedMatrices
from floquet.engine.system import PeriodicSystem
from lumped.errors import NumericalError
from lumped.typing import BoolArray, FloatArray, IntArray

_U = 0.5 * float(np.finfo(np.float64).eps)
_DEGREE = 14
_ANGLE = 0.7  # largest sum of |A_j| h of a step
_TERMS = np.array([14, 17, 20, 28, 40])  # numbers of Taylor terms to choose from
_TAIL = 0.02  # part of the allowed error of a step that the neglected terms may make
_RADII = np.array([1.5, 2.0, 3.0, 4.5, 7.0, 11.0, 18.0, 30.0, 60.0])
_CHUNK = 600_000  # entries of the matrices of the steps that are computed together: some 300 MB
_COMPILED = 16  # states; beyond, the matrix products of the linear algebra library are faster
_MOST_PARTS = 64  # into which a step is cut at once
_SLACK = 1.0 + 1e-9  # covers the rounding of the bounds themselves

Formulas = tuple[PeriodicSystem, PeriodicMatrix]
"""A system, and its A(t)."""


class Flows(NamedTuple):
    """Steps of one period of each of S systems, in balanced coordinates.

    Attributes
    ----------
    starts : (m,) of all steps, in order of systems and of time [s]
    steps, errors : (m, n, n) transition matrices, and bounds (m,) on the 2-norms of their errors
    ends : (S+1,) the steps of system i are those from ends[i] to ends[i + 1]
    matrices, bounds : (S, n, n) monodromy matrices, and bounds (S,) on the Frobenius norms of their errors
    scalings : (S, n) the balanced coordinates are x_i/d_i
    """

    starts: FloatArray
    steps: FloatArray
    errors: FloatArray
    ends: IntArray
    matrices: FloatArray
    bounds: FloatArray
    scalings: FloatArray


def proven_propagation(
    system: PeriodicSystem, A: PeriodicMatrix, rtol: float, max_substeps: int
) -> tuple[Propagation, FloatArray, float]:
    """Steps of one period, and their product in balanced coordinates with a bound on its Frobenius error."""
    flows = proven_flows([(system, A)], rtol, max_substeps)
    ends = np.append(flows.starts, system.period)
    none = np.zeros_like(flows.errors)
    propagation = Propagation(ends, flows.steps, flows.errors, rounding=none, scaling=flows.scalings[0])
    return propagation, flows.matrices[0], float(flows.bounds[0])


def proven_flows(systems: Sequence[Formulas], rtol: float, max_substeps: int) -> Flows:
    """Monodromy matrices of systems with as many states and terms. A step whose bound is too large is cut.

    Raises
    ------
    NumericalError
        One of the systems needs more steps, falls to rounding, or grows beyond floating point. The message
        does not name the system.
    """
    scalings = np.stack([system.balancing() for system, _ in systems])
    stack = StackedMatrices([A for _, A in systems], scalings)
    pieces = [np.unique(np.clip([0.0, s.period, *A.breaks], 0.0, s.period)) for s, A in systems]
    owner = np.repeat(np.arange(len(systems)), [piece.size - 1 for piece in pieces])
    start = np.concatenate([piece[:-1] for piece in pieces])
    end = np.concatenate([piece[1:] for piece in pieces])
    done = []
    counts = np.zeros(len(systems), dtype=np.int64)
    chunk = min(4096, 1 + _CHUNK // stack.dimension**2)
    while start.size:
        if (counts + np.bincount(owner, minlength=counts.size) > max_substeps).any():
            raise NumericalError(
                f"more than {max_substeps} substeps per period are needed. Use a larger max_substeps, or "
                "check the units of A and the period."
            )
        of_chunk, first, last = owner[:chunk], start[:chunk], end[:chunk]
        middle = 0.5 * (first + last)
        indivisible = (middle <= first) | (middle >= last)
        result = _steps(stack, of_chunk, first, last, indivisible, rtol)
        good = result.good
        if (~good & indivisible).any():
            raise NumericalError(
                f"A is too large near t = {first[~good & indivisible][0]:.17g} s: the step fell to rounding."
            )
        done.append((of_chunk[good], first[good], result.flows, result.errors[good]))
        counts += np.bincount(of_chunk[good], minlength=counts.size)
        cut = _cut(of_chunk[~good], first[~good], last[~good], result.rates[~good])
        owner, start, end = (
            np.concatenate([new, old[chunk:]]) for new, old in zip(cut, (owner, start, end), strict=True)
        )
    owner, start, steps, errors = (np.concatenate(parts) for parts in zip(*done, strict=True))
    order = np.lexsort((start, owner))
    steps, errors = steps[order], errors[order]
    ends = np.concatenate([[0], np.cumsum(counts)])
    matrices, bounds = _products(steps, errors, ends)
    return Flows(start[order], steps, errors, ends, matrices, bounds, scalings)


def _cut(
    owner: IntArray, start: FloatArray, end: FloatArray, rates: FloatArray
) -> tuple[IntArray, FloatArray, FloatArray]:
    """Cut each step in two or more: as many as the angle at its start, rates (k,), would need."""
    with np.errstate(invalid="ignore"):
        parts = np.clip(np.nan_to_num(np.ceil(1.1 * rates / _ANGLE), nan=2.0), 2, _MOST_PARTS).astype(int)
    middle = 0.5 * (start + end)
    width = (end - start) / parts
    # Where parts are not wider than a rounding of the time, halves are.
    parts = np.where(width > 64.0 * _U * np.maximum(np.abs(start), np.abs(end)), parts, 2)
    each = np.repeat(np.arange(start.size), parts)
    number = np.arange(each.size) - np.repeat(np.cumsum(parts) - parts, parts)

    def edge(k: IntArray) -> FloatArray:
        inner = start[each] + k * ((end - start) / parts)[each]
        inner = np.where(parts[each] == 2, middle[each], inner)
        return np.where(k == 0, start[each], np.where(k == parts[each], end[each], inner))

    return owner[each], edge(number), edge(number + 1)


class _StepBounds(NamedTuple):
    """Bounds on k steps.

    Attributes
    ----------
    terms : (k,) number of Taylor terms
    angle : (k,) sum of a_j, |A_j| h <= a_j
    last_terms : (k,) largest of the last two a_j
    truncation : (k,) neglected Taylor terms
    rounding : (k,) of the Taylor terms
    misfit : (k,) integral of the error of A
    errors : (k,) of the transition matrix, 2-norm
    """

    terms: IntArray
    angle: FloatArray
    last_terms: FloatArray
    truncation: FloatArray
    rounding: FloatArray
    misfit: FloatArray
    errors: FloatArray


def _step_bounds(a: FloatArray, h: FloatArray, error_of_A: FloatArray, n: int, rtol: float) -> _StepBounds:
    """Bounds from a (k, degree + 1), a_j >= |A_j| h, also of the matrix of moduli."""
    powers_over_index = np.arange(1, _DEGREE + 2)
    # h and the products h A_j are rounded.
    misfit = h * error_of_A + 4.0 * _U * a.sum(axis=1)
    with np.errstate(over="ignore", invalid="ignore"):
        powers = _RADII[:, None] ** powers_over_index / powers_over_index
        g = a @ powers.T  # (k, radii)
        log_tails = (g - np.log(_RADII - 1.0))[:, None] - _TERMS[:, None] * np.log(_RADII)
        truncations = np.exp(log_tails.min(axis=2)) * _SLACK  # (k, numbers of terms)
        integral = (a / powers_over_index).sum(axis=1)
        size = np.exp(integral)  # of all Taylor terms together
        roundings = (_DEGREE + n + 8.0) * integral + a.sum(axis=1) + 6.0
        rounding = math.sqrt(n) * _U * size * roundings
        small = truncations <= _TAIL * _allowed(rounding, rtol)[:, None]
        choice = np.where(small.any(axis=1), small.argmax(axis=1), _TERMS.size - 1)
        truncation = truncations[np.arange(len(a)), choice]
        errors = (truncation + rounding + misfit * size**2 * np.exp(misfit)) * _SLACK
    return _StepBounds(
        _TERMS[choice], a.sum(axis=1), a[:, -2:].max(axis=1), truncation, rounding, misfit, errors
    )


def _allowed(rounding: FloatArray, rtol: float) -> FloatArray:
    """Error (k,) that a step may have."""
    return np.maximum(1e-3 * rtol, 8.0 * rounding)


def _good(bounds: _StepBounds, indivisible: BoolArray, rtol: float) -> BoolArray:
    """Which steps need not be cut."""
    allowed = _allowed(bounds.rounding, rtol)
    good = (bounds.angle <= _ANGLE) & (bounds.truncation + bounds.misfit <= allowed)
    # Where rounding of A itself is more than that, and its polynomials end, shorter steps do not help.
    good |= (bounds.angle <= 0.05) & (bounds.last_terms <= allowed) & np.isfinite(bounds.errors)
    # A step that cannot be cut is good where its bound is, as with an impulse.
    good |= indivisible & (bounds.errors <= rtol)
    return np.asarray(good)


def _library_flows(B: FloatArray, terms: int) -> FloatArray:
    """`taylor_flows` of large systems with the same number of terms, by the linear algebra library."""
    n = B.shape[-1]
    used = np.flatnonzero(B.any(axis=(0, 2, 3)))
    used = used[used > 0]
    X = np.zeros((terms + 1, len(B), n, n))
    X[0] = np.eye(n)
    for k in range(terms):
        term = B[:, 0] @ X[k]
        for j in used[used <= k]:
            term += B[:, j] @ X[k - j]
        X[k + 1] = term / (k + 1)
    flow = X[terms].copy()
    for k in range(terms - 1, -1, -1):
        flow += X[k]
    return np.asarray(flow)


class _Steps(NamedTuple):
    """Steps of `_steps`.

    Attributes
    ----------
    flows : (g, n, n) transition matrices of the good steps
    errors : (k,) bounds on the 2-norms of the errors of the transition matrices
    good : (k,) which steps need not be cut
    rates : (k,) |A| h at the start of each step
    """

    flows: FloatArray
    errors: FloatArray
    good: BoolArray
    rates: FloatArray


def _steps(
    stack: StackedMatrices, owner: IntArray, start: FloatArray, end: FloatArray, indivisible: BoolArray,
    rtol: float,
) -> _Steps:  # fmt: skip
    """Transition matrices of the good steps with PROVEN bounds on their errors."""
    h = end - start
    n = stack.dimension
    B, error_of_A = stack.taylor(owner, start, h, _DEGREE)
    B *= h[:, None, None, None]
    a = np.sqrt(np.einsum("kjab,kjab->kj", B, B)) * _SLACK
    bounds = _step_bounds(a, h, error_of_A, n, rtol)
    good = _good(bounds, indivisible, rtol)
    flows = np.empty((int(good.sum()), n, n))
    if not flows.size:
        return _Steps(flows, bounds.errors, good, a[:, 0])
    terms = bounds.terms[good]
    if n <= _COMPILED:
        taylor_flows(B[good], terms, flows)
    else:
        flows[:] = _library_flows(B[good], int(terms.max()))
    return _Steps(flows, bounds.errors, good, a[:, 0])


def _products(steps: FloatArray, errors: FloatArray, ends: IntArray) -> tuple[FloatArray, FloatArray]:
    """Products of runs of steps and bounds, see `product_bounds`; refuses what is not finite."""
    n = steps.shape[1]
    flows = np.empty((ends.size - 1, n, n))
    bounds = np.empty(ends.size - 1)
    product_bounds(np.ascontiguousarray(steps), errors, ends, flows, bounds)
    if not np.isfinite(flows).all():
        raise NumericalError(
            "the state grows beyond the range of floating point within one period, so the system is unstable "
            "on any practical scale. Check the signs of damping and stiffness, or shorten the period."
        )
    return flows, bounds


def proven_product(steps: FloatArray, errors: FloatArray) -> tuple[FloatArray, float]:
    """Product of steps (m, n, n) with the bound of `product_bounds`.

    ``errors`` (m,) bound those of the steps. They are 2-norms, the bound is a Frobenius norm.
    """
    flows, bounds = _products(steps, errors, np.array([0, len(steps)]))
    return flows[0], float(bounds[0])
