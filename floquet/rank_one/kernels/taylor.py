"""Taylor propagation of a rank-one feedback system with a majorant error bound, compiled.

In energy coordinates x = (omega eta, eta') of `ModalForm` a step of length 2 h has A(u) = sum_j A_j u^j, |u|
<= 1, with |A_0| <= a_0 = h (max omega + |C| + |w_0| |v/omega| + |wd_0| |v|), the others likewise without
omega and C. The series starts in the middle of the step; its sums at u = 1 and -1 are the flows E and S to
the end and the start, and P = E S^-1 is that of the step.

Sources: docs/theory/proven_bounds.md, "The matrix of a step".
"""

from __future__ import annotations

import math

import numpy as np

from floquet.rank_one.kernels.gains import (
    MAX_TERMS,
    Limits,
    Piece,
    Problem,
    enough_terms,
    load_piece,
    load_point,
    load_step,
    most_steps,
    scratch_for,
)
from floquet.rank_one.kernels.product import BLOCKS, carry, copy, divide, frobenius, multiply
from floquet.rank_one.kernels.simd import LANES, load, plus, scaled, store, zero
from lumped.compiler import compiled
from lumped.typing import FloatArray

_U = 0.5 * 2.220446049250313e-16


@compiled(fastmath={"contract"}, _nrt=False, forceinline=True)
def _series(piece: Piece, terms: int, h: float, ratio: float) -> None:
    """Fill Z[k] (3, LANES), the Taylor coefficients in step time, k = 2..terms+1, from Z[0] and Z[1].

    With wd = ratio w the two convolutions merge into one with s + (ratio/h) s'. All three coordinates side by
    side in registers, and the newest values last in every sum: what is older need not wait for them.
    """
    v = piece.v
    C = piece.hC
    o = piece.h2_omega2
    ref = piece.h2_reference
    Z = piece.Z
    s = piece.s
    sd = piece.sd
    w = piece.ws
    wd = piece.wds
    merged = not math.isnan(ratio)
    lag = ratio / h if merged else 0.0
    dw, dd = piece.degrees[0], piece.degrees[1]
    x0 = load(Z, (0, 0))
    x1 = load(Z, (0, 1))
    x2 = load(Z, (0, 2))
    y0 = load(Z, (1, 0))
    y1 = load(Z, (1, 1))
    y2 = load(Z, (1, 2))
    here = plus(v[2], x2, plus(v[1], x1, scaled(v[0], x0)))
    there = plus(v[2], y2, plus(v[1], y1, scaled(v[0], y0)))
    for k in range(terms):
        c = k + 1.0
        rate = scaled(c, there)
        t0 = scaled(o[0], x0)
        t1 = scaled(o[1], x1)
        t2 = scaled(o[2], x2)
        t0 = plus(ref[0], here, t0)
        t1 = plus(ref[1], here, t1)
        t2 = plus(ref[2], here, t2)
        if merged:
            for i in range(min(dw, k), 0, -1):
                old = load(sd, (k - i,))
                t0 = plus(w[i, 0], old, t0)
                t1 = plus(w[i, 1], old, t1)
                t2 = plus(w[i, 2], old, t2)
            rate = plus(lag * c, there, here)
            t0 = plus(w[0, 0], rate, t0)
            t1 = plus(w[0, 1], rate, t1)
            t2 = plus(w[0, 2], rate, t2)
        else:
            for i in range(min(dw, k), 0, -1):
                old = load(s, (k - i,))
                t0 = plus(w[i, 0], old, t0)
                t1 = plus(w[i, 1], old, t1)
                t2 = plus(w[i, 2], old, t2)
            for i in range(min(dd, k), 0, -1):
                old = load(sd, (k - i,))
                t0 = plus(wd[i, 0], old, t0)
                t1 = plus(wd[i, 1], old, t1)
                t2 = plus(wd[i, 2], old, t2)
            t0 = plus(w[0, 0], here, t0)
            t1 = plus(w[0, 1], here, t1)
            t2 = plus(w[0, 2], here, t2)
            t0 = plus(wd[0, 0], rate, t0)
            t1 = plus(wd[0, 1], rate, t1)
            t2 = plus(wd[0, 2], rate, t2)
        store(s, (k,), here)
        store(sd, (k,), rate)
        t0 = plus(c * C[0, 0, 2], y2, plus(c * C[0, 0, 1], y1, plus(c * C[0, 0, 0], y0, t0)))
        t1 = plus(c * C[0, 1, 2], y2, plus(c * C[0, 1, 1], y1, plus(c * C[0, 1, 0], y0, t1)))
        t2 = plus(c * C[0, 2, 2], y2, plus(c * C[0, 2, 1], y1, plus(c * C[0, 2, 0], y0, t2)))
        factor = -1.0 / (c * (c + 1.0))
        x0 = y0
        x1 = y1
        x2 = y2
        y0 = scaled(factor, t0)
        y1 = scaled(factor, t1)
        y2 = scaled(factor, t2)
        store(Z, (k + 2, 0), y0)
        store(Z, (k + 2, 1), y1)
        store(Z, (k + 2, 2), y2)
        here = there
        there = plus(v[2], y2, plus(v[1], y1, scaled(v[0], y0)))


@compiled(fastmath={"contract"}, _nrt=False)
def _series_of_many(piece: Piece, terms: int, h: float, ratio: float) -> None:
    """`_series` for any number of coordinates, eight columns after the other."""
    v = piece.v
    C = piece.hC
    o = piece.h2_omega2
    ref = piece.h2_reference
    Z = piece.Z
    s = piece.s
    sd = piece.sd
    w = piece.ws
    wd = piece.wds
    merged = not math.isnan(ratio)
    lag = ratio / h if merged else 0.0
    dw = piece.degrees[0]
    dd = piece.degrees[1]
    m = v.size
    rates = MAX_TERMS + 2
    for column in range(0, 2 * m, LANES):
        here = zero()
        for q in range(m):
            here = plus(v[q], load(Z, (0, q, column)), here)
        for k in range(terms):
            c = k + 1.0
            there = zero()
            for q in range(m):
                y = load(Z, (k + 1, q, column))
                there = plus(v[q], y, there)
                store(Z, (rates, q, column), scaled(c, y))
            rate = scaled(c, there)
            if merged:
                rate = plus(lag * c, there, here)
            store(s, (k,), here)
            store(sd, (k,), rate)
            factor = -1.0 / (c * (c + 1.0))
            for q in range(m):
                t = plus(ref[q], here, scaled(o[q], load(Z, (k, q, column))))
                if merged:
                    for i in range(min(dw, k), -1, -1):
                        t = plus(w[i, q], load(sd, (k - i,)), t)
                else:
                    for i in range(min(dw, k), -1, -1):
                        t = plus(w[i, q], load(s, (k - i,)), t)
                    for i in range(min(dd, k), -1, -1):
                        t = plus(wd[i, q], load(sd, (k - i,)), t)
                for p in range(m):
                    t = plus(C[0, q, p], load(Z, (rates, p, column)), t)
                store(Z, (k + 2, q, column), scaled(factor, t))
            here = there


@compiled(_nrt=False, forceinline=True)
def _unit_states(problem: Problem, piece: Piece, h: float) -> None:
    """Unit initial states x = (omega eta, eta') in the first 2m columns."""
    m = problem.v.size
    for c in range(0, 2 * m, LANES):
        for q in range(m):
            store(piece.Z, (0, q, c), scaled(1.0 / problem.omega[q], load(piece.unit, (q, c))))
            store(piece.Z, (1, q, c), scaled(h, load(piece.unit, (m + q, c))))


@compiled(fastmath={"contract"}, _nrt=False, forceinline=True)
def _ends_of_step(
    problem: Problem, piece: Piece, terms: int, h: float, end: FloatArray, start: FloatArray
) -> None:
    """Energy coordinates at both ends of the step, (2m, lanes), summed from the smallest terms on."""
    m, Z = problem.v.size, piece.Z
    top = terms + 1 - (terms + 1) % 2  # the largest even power
    for c in range(0, 2 * m, LANES):
        for q in range(m):
            even = zero()
            odd = zero()
            even_rate = zero()
            odd_rate = zero()
            if top == terms:
                odd = load(Z, (terms + 1, q, c))
                even_rate = scaled(terms + 1.0, odd)
            for k in range(top, 0, -2):
                x, y = load(Z, (k, q, c)), load(Z, (k - 1, q, c))
                even = plus(1.0, x, even)
                odd_rate = plus(float(k), x, odd_rate)
                odd = plus(1.0, y, odd)
                even_rate = plus(float(k - 1), y, even_rate)
            even = plus(1.0, load(Z, (0, q, c)), even)
            store(end, (q, c), scaled(problem.omega[q], plus(1.0, odd, even)))
            store(start, (q, c), scaled(problem.omega[q], plus(-1.0, odd, even)))
            store(end, (m + q, c), scaled(1.0 / h, plus(1.0, odd_rate, even_rate)))
            store(start, (m + q, c), scaled(1.0 / h, plus(-1.0, odd_rate, even_rate)))


@compiled(_nrt=False)
def steps_of_period(
    problem: Problem,
    gains: FloatArray,
    zeta: float,
    T: float,
    limits: Limits,
    piece: Piece,
    steps: FloatArray,
    local: FloatArray,
    sizes: FloatArray,
) -> int:
    """All steps (most, 2m, lanes) of one period at one point, bounds (most,) on their errors and their norms.

    Returns the number of steps; -1 if there would be more than ``most`` or MAX_TERMS.
    """
    m = problem.v.size
    most = steps.shape[0]
    count = 0
    load_point(problem, T, piece)
    log_tolerance = math.log(limits.tolerance)
    for i in range(problem.phases.size - 1):
        length = (problem.phases[i + 1] - problem.phases[i]) * T
        rate, misfit, ratio, first, last = load_piece(problem, i, gains, zeta, T, piece)
        parts = max(1, math.ceil(0.5 * length * rate / limits.angle))
        begin = count
        while count < begin + parts:
            part = count - begin
            if count + parts - part > most:
                return -1
            h = 0.5 * length / parts
            degree = load_step(problem, piece, part, parts, h, ratio)
            terms, size = enough_terms(piece.a, degree, log_tolerance, piece.powers)
            if terms < 0:
                # The polynomials vary too much within the step: begin the piece again with half of it.
                count = begin
                parts *= 2
                continue
            _unit_states(problem, piece, h)
            if m <= 3:
                _series(piece, terms, h, ratio)
            else:
                _series_of_many(piece, terms, h, ratio)
            end = piece.ends[0]
            start = piece.ends[1]
            scratch = piece.ends[2:]
            _ends_of_step(problem, piece, terms, h, end, start)
            size_step, residual = divide(end, start, piece.unit, scratch, steps[count])
            # Neither the skew part of A nor damping lets the energy grow; what is left of a at most does.
            turned = 2.0 * h * piece.sizes[3]
            total = 0.0
            for j in range(degree + 1):
                total += piece.a[j]
                turned += piece.a[j] / (j + 1.0)
            growth = total + h * (piece.sizes[4] - piece.sizes[2])
            # Each coefficient goes through at most this many roundings of the sum of the moduli of its terms,
            # and errors grow along the recurrence as its solution does; then come the sums at both ends.
            count_w = piece.degrees[0] + (piece.degrees[1] if math.isnan(ratio) else 0)
            rounding = (
                _U * math.sqrt(2.0 * m) * size * ((count_w + 2.0 * max(m, 3) + 14.0) * turned + total + 10.0)
            )
            back = math.exp(growth) * (1.0 + 1e-12)
            # What is wrong at an end of the piece acts in the step at that end, not in all of them alike.
            off = 2.0 * h * misfit
            if part == 0:
                off += first
            if part == parts - 1:
                off += last
            spread = back * back * (1.0 + 2.0 * off if off < 1.0 else math.exp(off))  # exp(off) at least
            # 1 + 1e-6: rounding of the bound itself, of the number of terms above all.
            error = (residual + (1.0 + size_step) * (limits.tolerance + rounding)) * back * (1.0 + 1e-6)
            local[count] = error + off * spread
            sizes[count] = size_step
            count += 1
    return count


@compiled(nogil=True)
def propagate_points(
    problem: Problem,
    gains: FloatArray,
    damping_factor: FloatArray,
    periods: FloatArray,
    limits: Limits,
    M: FloatArray,
    bound: FloatArray,
) -> int:
    """Monodromy matrices M (N, 2m, 2m) in x = (omega eta, eta'), and bounds (N,) on their Frobenius errors.

    Gains are (N, Q). Returns the index of the first point that needs more than ``most_steps`` or MAX_TERMS.
    """
    piece = scratch_for(problem)
    n = 2 * problem.v.size
    lanes = piece.unit.shape[0]
    most = most_steps(n)
    steps = np.empty((most, n, lanes))
    local = np.empty(most)
    sizes = np.empty(most)
    before = np.empty(most)
    table = np.zeros((5, BLOCKS))
    work = np.zeros((2 * BLOCKS + 1, n, lanes))
    flow = np.zeros((n, lanes))
    for point in range(periods.size):
        count = steps_of_period(
            problem, gains[point], damping_factor[point], periods[point], limits, piece, steps, local, sizes
        )
        if count < 0:
            return point
        bound[point] = carry(steps, local, sizes, count, flow, before, work, table)
        for i in range(n):
            for j in range(n):
                M[point, i, j] = flow[i, j]
    return -1


@compiled(nogil=True)
def largest_flow(
    problem: Problem, gains: FloatArray, zeta: float, T: float, limits: Limits
) -> tuple[float, float]:
    """Largest 2-norm of the computed flows between any two ends of steps, and the sum of the steps' errors.

    |A|^8 <= |(A^T A)^4|_F, too large by at most the 16th root of n. (nan, nan): too many steps.
    """
    piece = scratch_for(problem)
    n = 2 * problem.v.size
    lanes = piece.unit.shape[0]
    most = most_steps(n)
    steps = np.empty((most, n, lanes))
    flows = np.empty((most, n, lanes))
    work = np.zeros((3, n, lanes))
    local = np.empty(most)
    sizes = np.empty(most)
    count = steps_of_period(problem, gains, zeta, T, limits, piece, steps, local, sizes)
    if count < 0:
        return math.nan, math.nan
    largest = 1.0
    errors = 0.0
    for j in range(count):
        errors += local[j] + 2.0 * n * n * _U * sizes[j]
        copy(piece.unit[:n], flows[j])
        for i in range(j + 1):
            multiply(steps[j], flows[i], work[0])
            copy(work[0], flows[i])
            if frobenius(work[0]) > largest:
                for c in range(n):
                    for q in range(n):
                        work[1, c, q] = work[0, q, c]
                multiply(work[1], work[0], work[2])
                multiply(work[2], work[2], work[0])
                multiply(work[0], work[0], work[1])
                largest = max(largest, math.sqrt(math.sqrt(math.sqrt(frobenius(work[1])))) * (1.0 + 1e-11))
    return largest, errors
