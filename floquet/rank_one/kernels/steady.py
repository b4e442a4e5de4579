"""Periodic motion of a rank-one feedback system under periodic forcing, for many points, compiled."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from floquet.rank_one.kernels.compiled import compiled
from floquet.rank_one.kernels.gains import Limits, Piece, Problem, load_piece, load_step, part_of, scratch_for
from floquet.rank_one.kernels.lanes import LANES
from floquet.rank_one.kernels.majorant import enough_terms, norm
from floquet.rank_one.kernels.product import BLOCKS, FORCED, carry, invert
from floquet.rank_one.kernels.taylor import ends_of_step, series, start_from_rest, steps_of_period
from lumped.typing import FloatArray


class Balance(NamedTuple):
    """A scalar condition on the motion, mean of psi0 - psi (v . eta) - psid (v . eta') + known + a own = 0.

    It determines the amplitude a of the input of `Problem`.

    Attributes
    ----------
    psi : (Q, P, 4, d+1) psi, psid, psi0 and its part that goes with a rate, polynomials like the gains
    known, own : numbers; own = 0 means a = 0, no condition
    """

    psi: FloatArray
    known: float
    own: float


@compiled(nogil=True)
def periodic_points(
    problem: Problem,
    gains: FloatArray,
    damping_factor: FloatArray,
    periods: FloatArray,
    limits: Limits,
    balance: Balance,
    start: FloatArray,
    bound: FloatArray,
    amplitude: FloatArray,
    deflection: FloatArray,
    M: FloatArray,
    M_error: FloatArray,
) -> int:
    """Periodic motion x(T) = x(0) at many points: (I - M) x(0) = state at T from rest.

    Parameters
    ----------
    problem, gains, damping_factor, periods, limits : as in ``propagate_points``
    balance : condition on the amplitude of the input
    start : (N, 2m), out: x(0) in x = (omega eta, eta')
    bound : (N, 2), out: bounds on the errors of x(0) and of the amplitude; inf where I - M may be singular
    amplitude : (N,), out: of the input
    deflection : (N, S), out: v . eta at S even phases j/S
    M, M_error : (N, 2m, 2m), (N,), out: monodromy matrices and bounds on their errors

    Returns
    -------
    index of the first point that needs more than max_steps or MAX_TERMS, -1 if none
    """
    m = problem.v.size
    n = 2 * m
    piece = scratch_for(problem)
    steps = np.empty((limits.max_steps, n, LANES))
    local, layout = np.empty((limits.max_steps, 3)), np.empty((limits.max_steps, 4))
    table = np.zeros((5, BLOCKS))
    weights, work, flow = (
        np.empty((limits.max_steps, 2)),
        np.zeros((2 * BLOCKS + 2, n, LANES)),
        np.zeros((n, LANES)),
    )
    closed = np.empty((n, n))
    both, state = np.zeros((n, 2)), np.zeros((n, 2))
    sampled = np.zeros((deflection.shape[1], 2))
    for point in range(periods.size):
        zeta, T = damping_factor[point], periods[point]
        count = steps_of_period(problem, gains[point], zeta, T, limits, piece, steps, local, layout)
        if count < 0:
            return point
        error = carry(steps, local[:, 0], layout, count, flow, weights, work, table)
        for i in range(n):
            for j in range(n):
                closed[i, j] = (1.0 if i == j else 0.0) - flow[i, j]
                M[point, i, j] = flow[i, j]
        M_error[point] = error
        inverse, regular = _inverse(closed)
        size = norm(inverse.ravel())
        if not regular or not size * error < 1.0:
            bound[point] = math.inf
            continue
        for i in range(n):
            for c in range(2):
                total = 0.0
                for j in range(n):
                    total += inverse[i, j] * flow[j, FORCED + c]
                both[i, c] = state[i, c] = total
        residual = _residuals(steps, local, weights, count, state)
        # The exact map moves x(0) by at most the gap of the march and the residual; |(I - M)^-1| of the exact
        # M turns that into an error.
        sharpness = size / (1.0 - size * error)
        errors = sharpness * np.array([norm(state[:, 0] - both[:, 0]), norm(state[:, 1] - both[:, 1])])
        errors += sharpness * residual
        state[:] = both
        means = _sample(
            problem, gains[point], zeta, T, limits, balance, piece, steps, layout, count, state, sampled
        )
        a = doubt = 0.0
        if balance.own != 0.0:
            below = balance.own - means[1]
            a = -(balance.known - means[0]) / below
            largest = 1.0
            for k in range(count):
                largest = max(largest, weights[k, 1])
            # An error of x(0) grows at most by the largest |Q_k| on its way, and means[2] is what it can do.
            doubt = means[2] * largest * (errors[0] + abs(a) * errors[1]) / abs(below)
        for i in range(n):
            start[point, i] = both[i, 0] + a * both[i, 1]
        for j in range(sampled.shape[0]):
            deflection[point, j] = sampled[j, 0] + a * sampled[j, 1]
        amplitude[point] = a
        bound[point, 0] = errors[0] + abs(a) * errors[1] + doubt * norm(both[:, 1])
        bound[point, 1] = doubt
    return -1


@compiled()
def _inverse(A: FloatArray) -> tuple[FloatArray, bool]:
    """Inverse by Gauss-Jordan elimination with row pivots; False: singular."""
    n = A.shape[0]
    work, inverse = A.copy(), np.eye(n)
    for k in range(n):
        p = k
        for i in range(k + 1, n):
            if abs(work[i, k]) > abs(work[p, k]):
                p = i
        if work[p, k] == 0.0 or not math.isfinite(work[p, k]):
            return inverse, False
        for j in range(n):
            work[k, j], work[p, j] = work[p, j], work[k, j]
            inverse[k, j], inverse[p, j] = inverse[p, j], inverse[k, j]
        factor = 1.0 / work[k, k]
        for j in range(n):
            work[k, j] *= factor
            inverse[k, j] *= factor
        for i in range(n):
            if i != k:
                factor = work[i, k]
                for j in range(n):
                    work[i, j] -= factor * work[k, j]
                    inverse[i, j] -= factor * inverse[k, j]
    return inverse, True


@compiled()
def _advance(step: FloatArray, state: FloatArray) -> None:
    """Carry the motion under f (column 0) and under the input (column 1) over one step."""
    n = state.shape[0]
    following = np.empty((n, 2))
    for i in range(n):
        for c in range(2):
            total = step[i, FORCED + c]
            for q in range(n):
                total += step[i, q] * state[q, c]
            following[i, c] = total
    state[:] = following


@compiled()
def _residuals(
    steps: FloatArray, local: FloatArray, weights: FloatArray, count: int, state: FloatArray
) -> FloatArray:
    """March both motions through the period; return what the steps' errors add at its end."""
    residual = np.zeros(2)
    for k in range(count):
        for c in range(2):
            # local[:, 0] has the rounding of the product in it (`carry`).
            residual[c] += weights[k, 0] * (local[k, 0] * norm(state[:, c]) + local[k, 1 + c])
        _advance(steps[k], state)
    return residual


@compiled(fastmath={"contract"})
def _sample(
    problem: Problem,
    gains: FloatArray,
    zeta: float,
    T: float,
    limits: Limits,
    balance: Balance,
    piece: Piece,
    steps: FloatArray,
    layout: FloatArray,
    count: int,
    state: FloatArray,
    sampled: FloatArray,
) -> FloatArray:
    """Sample v . eta of both motions (S, 2) and return the means of the balance for both.

    The third number is the largest change of a mean per unit of error of the states.
    """
    n, samples, degree = state.shape[0], sampled.shape[0], balance.psi.shape[3]
    balanced = balance.own != 0.0
    nu, nu_rate = norm(problem.v / problem.omega), norm(problem.v)
    psi, shifted = np.zeros((degree, LANES)), np.zeros((degree, LANES))
    c, middle = np.zeros((piece.s.shape[0], 2)), np.zeros((n, 2))
    means = np.zeros(3)
    last, ratio, sample = -1, math.nan, 0
    for k in range(count):
        i, part, parts = int(layout[k, 0]), int(layout[k, 1]), int(layout[k, 2])
        begin = problem.phases[i]
        width = (problem.phases[i + 1] - begin) / parts
        begin += part * width
        end = 1.0 if k == count - 1 else begin + width
        if balanced or (sample < samples and sample < end * samples):
            if i != last:
                _, _, _, ratio, _, _ = load_piece(problem, i, gains, zeta, T, piece)
                psi[:] = 0.0
                for q in range(gains.size):
                    for j in range(degree):
                        psi[j, 0] += gains[q] * balance.psi[q, i, 0, j]
                        psi[j, 1] += gains[q] * zeta * balance.psi[q, i, 1, j]
                        psi[j, 2] += gains[q] * (balance.psi[q, i, 2, j] + zeta / T * balance.psi[q, i, 3, j])
                last = i
            h = 0.5 * width * T
            top = load_step(problem, piece, part, parts, h, ratio)
            log_tolerance = math.log(limits.tolerance)
            terms, _, _ = enough_terms(piece.a, top, log_tolerance, piece.powers, piece.ends[0])
            start_from_rest(problem, piece, h)
            series(problem, piece, terms, h, ratio)
            start, inverse = piece.ends[1], piece.ends[2]
            ends_of_step(problem, piece, terms, h, piece.ends[0], start)
            invert(start, piece.unit, piece.ends[3], inverse)
            for q in range(n):
                for column in range(2):
                    middle[q, column] = 0.0
                    for p in range(n):
                        middle[q, column] += inverse[q, p] * (state[p, column] - start[p, FORCED + column])
            for j in range(terms + 2):
                for column in range(2):
                    total = piece.s[j, FORCED + column]
                    for q in range(n):
                        total += piece.s[j, q] * middle[q, column]
                    c[j, column] = total
            while sample < samples and sample < end * samples:
                u = 2.0 * (sample / samples - begin) / width - 1.0
                for column in range(2):
                    total = 0.0
                    for j in range(terms, -1, -1):
                        total = total * u + c[j, column]
                    sampled[sample, column] = total
                sample += 1
            if balanced:
                part_of(psi, degree - 1, part, parts, 1.0, shifted)
                for e in range(degree):
                    if e % 2 == 0:
                        means[0] -= width * shifted[e, 2] / (e + 1.0)
                    means[2] += width * (abs(shifted[e, 0]) * nu + abs(shifted[e, 1]) * nu_rate)
                    for j in range(e % 2, terms + 1, 2):  # the mean of an odd power of u is zero
                        both = width / (e + j + 1.0)
                        rate = both * shifted[e, 1] * (j + 1.0) / h
                        for column in range(2):
                            means[column] += both * shifted[e, 0] * c[j, column] + rate * c[j + 1, column]
        _advance(steps[k], state)
    return means
