"""Taylor propagation of a rank-one feedback system with a majorant error bound, compiled.

In modal coordinates of a reference problem (`floquet.rank_one`) the system reads

    eta'' + C eta' + omega^2 eta + w(t) (v . eta) + wd(t) (v . eta') = f(t),

with w, wd, f polynomials on every piece of the period. In the energy coordinates x = (omega eta, eta') the
part omega^2 is skew, so that one step of length h has the matrix A(tau) = sum_j A_j tau^j, 0 <= tau <= 1,
with

    |A_0| <= a_0 = h (max omega + |C| + |w_0| |v/omega| + |wd_0| |v|),   |A_j| <= a_j likewise without
    omega, C,

which is what `floquet.kernels.majorant` needs.
"""

from __future__ import annotations

import math

import numba
import numpy as np

from floquet.kernels.gains import Limits, Piece, Problem, load_piece, load_step, row_norm, scratch_for
from floquet.kernels.lanes import LANES, load, plus, scaled, store, zero
from floquet.kernels.majorant import enough_terms, norm
from floquet.kernels.product import FORCED, carry
from floquet.system import FloatArray

_EPS = 2.220446049250313e-16


@numba.njit(cache=True, fastmath={"contract"}, error_model="numpy", _nrt=False)
def series(problem: Problem, piece: Piece, terms: int, h: float, ratio: float) -> None:
    """Fill Z[k] (3, LANES), the Taylor coefficients in step time, k = 2..terms+1, from Z[0] and Z[1].

    With wd = ratio w the two convolutions merge into one with s + (ratio/h) s'. All three coordinates side by
    side, and the newest values last in every sum: what is older need not wait for them.
    """
    v, C, o, ref = piece.v, piece.hC, piece.h2_omega2, piece.h2_reference
    Z, s, sd, w, wd, f = piece.Z, piece.s, piece.sd, piece.ws, piece.wds, piece.fs
    merged = not math.isnan(ratio)
    lag = ratio / h if merged else 0.0
    dw, dd, df = piece.degrees[0], piece.degrees[1], piece.degrees[2]
    x0, x1, x2 = load(Z, (0, 0)), load(Z, (0, 1)), load(Z, (0, 2))
    y0, y1, y2 = load(Z, (1, 0)), load(Z, (1, 1)), load(Z, (1, 2))
    here = plus(v[2], x2, plus(v[1], x1, scaled(v[0], x0)))
    there = plus(v[2], y2, plus(v[1], y1, scaled(v[0], y0)))
    for k in range(terms):
        c = k + 1.0
        rate = scaled(c, there)
        t0, t1, t2 = scaled(o[0], x0), scaled(o[1], x1), scaled(o[2], x2)
        t0, t1, t2 = plus(ref[0], here, t0), plus(ref[1], here, t1), plus(ref[2], here, t2)
        if merged:
            for i in range(min(dw, k), 0, -1):
                old = load(sd, (k - i,))
                t0, t1, t2 = plus(w[i, 0], old, t0), plus(w[i, 1], old, t1), plus(w[i, 2], old, t2)
            rate = plus(lag * c, there, here)
            t0, t1, t2 = plus(w[0, 0], rate, t0), plus(w[0, 1], rate, t1), plus(w[0, 2], rate, t2)
        else:
            for i in range(min(dw, k), 0, -1):
                old = load(s, (k - i,))
                t0, t1, t2 = plus(w[i, 0], old, t0), plus(w[i, 1], old, t1), plus(w[i, 2], old, t2)
            for i in range(min(dd, k), 0, -1):
                old = load(sd, (k - i,))
                t0, t1, t2 = plus(wd[i, 0], old, t0), plus(wd[i, 1], old, t1), plus(wd[i, 2], old, t2)
            t0, t1, t2 = plus(w[0, 0], here, t0), plus(w[0, 1], here, t1), plus(w[0, 2], here, t2)
            t0, t1, t2 = plus(wd[0, 0], rate, t0), plus(wd[0, 1], rate, t1), plus(wd[0, 2], rate, t2)
        store(s, (k,), here)
        store(sd, (k,), rate)
        t0 = plus(c * C[0, 2], y2, plus(c * C[0, 1], y1, plus(c * C[0, 0], y0, t0)))
        t1 = plus(c * C[1, 2], y2, plus(c * C[1, 1], y1, plus(c * C[1, 0], y0, t1)))
        t2 = plus(c * C[2, 2], y2, plus(c * C[2, 1], y1, plus(c * C[2, 0], y0, t2)))
        factor = -1.0 / (c * (c + 1.0))
        x0, x1, x2 = y0, y1, y2
        y0, y1, y2 = scaled(factor, t0), scaled(factor, t1), scaled(factor, t2)
        store(Z, (k + 2, 0), y0)
        store(Z, (k + 2, 1), y1)
        store(Z, (k + 2, 2), y2)
        if k <= df:
            for r in range(problem.v.size):
                Z[k + 2, r, FORCED] -= factor * f[k, r]
                if k == 0:
                    Z[2, r, FORCED + 1] -= factor * h * h * problem.input[r]
            y0, y1, y2 = load(Z, (k + 2, 0)), load(Z, (k + 2, 1)), load(Z, (k + 2, 2))
        here, there = there, plus(v[2], y2, plus(v[1], y1, scaled(v[0], y0)))
    store(s, (terms,), here)
    store(s, (terms + 1,), there)


@numba.njit(cache=True, error_model="numpy", _nrt=False)
def start_from_rest(problem: Problem, piece: Piece, h: float) -> None:
    """Unit initial states x = (omega eta, eta') in the first 2m columns, rest in the others."""
    m = problem.v.size
    for q in range(m):
        store(piece.Z, (0, q), zero())
        store(piece.Z, (1, q), zero())
        piece.Z[0, q, q] = 1.0 / problem.omega[q]
        piece.Z[1, q, m + q] = h


@numba.njit(cache=True, fastmath={"contract"}, error_model="numpy", _nrt=False)
def end_of_step(problem: Problem, piece: Piece, terms: int, h: float, out: FloatArray) -> None:
    """Energy coordinates at the end of the step, (2m, LANES), summed from the smallest terms on."""
    m = problem.v.size
    for q in range(m):
        # Even and odd powers apart: two chains of additions instead of one.
        last = terms + 1
        position, rate = load(piece.Z, (last, q)), scaled(float(last), load(piece.Z, (last, q)))
        other, other_rate = zero(), zero()
        for k in range(terms, 0, -1):
            x = load(piece.Z, (k, q))
            if (last - k) % 2 == 0:
                position, rate = plus(1.0, x, position), plus(float(k), x, rate)
            else:
                other, other_rate = plus(1.0, x, other), plus(float(k), x, other_rate)
        position = plus(1.0, load(piece.Z, (0, q)), plus(1.0, other, position))
        store(out, (q,), scaled(problem.omega[q], position))
        store(out, (m + q,), scaled(1.0 / h, plus(1.0, other_rate, rate)))


@numba.njit(cache=True, error_model="numpy", _nrt=False)
def steps_of_period(
    problem: Problem,
    gains: FloatArray,
    zeta: float,
    T: float,
    limits: Limits,
    piece: Piece,
    steps: FloatArray,
    local: FloatArray,
    layout: FloatArray,
) -> int:
    """All steps of one period at one point.

    Parameters
    ----------
    gains, zeta, T : weights (Q,) of the parts, damping factor, period [s]
    steps : (max_steps, 2m, LANES), out: transition matrix, and states from rest under f and
        under the input in the columns from FORCED on
    local : (max_steps, 3), out: bounds on the errors of the matrix and of both states from rest
    layout : (max_steps, 4), out: piece, number of the step in it, number of steps in it, and the bound on
        what the error of the piece has besides those of its steps

    Returns
    -------
    number of steps; -1 if there would be more than max_steps or MAX_TERMS
    """
    m = problem.v.size
    count = 0
    calm, size_input = piece.sizes[2], norm(problem.input)
    for i in range(problem.phases.size - 1):
        length = (problem.phases[i + 1] - problem.phases[i]) * T
        rate, misfit, misfit_f, ratio = load_piece(problem, i, gains, zeta, T, piece)
        parts = max(1, math.ceil(length * rate / limits.angle))
        part = 0
        while part < parts:
            if count + parts - part > limits.max_steps:
                return -1
            h = length / parts
            degree = load_step(problem, piece, part, parts, h, ratio)
            terms, tail, tail_f, size = enough_terms(piece.a, degree, limits.tolerance, piece.r)
            if terms < 0:
                # The polynomials vary too much within the step: begin the piece again with half of it.
                count -= part
                parts *= 2
                part = 0
                continue
            start_from_rest(problem, piece, h)
            series(problem, piece, terms, h, ratio)
            end_of_step(problem, piece, terms, h, steps[count])
            # Every coefficient is a sum of at most 2 d + 2 m + 4 rounded products of size r_k.
            rounding = _EPS * (2.0 * degree + 2.0 * m + 8.0) * size
            # The skew part of A and the damping C do not let the energy grow; what is left of a does at most.
            growth = -h * calm
            for j in range(degree + 1):
                growth += piece.a[j]
            size_f = 0.0
            for j in range(piece.degrees[2] + 1):
                size_f += row_norm(piece.fs, j, m)
            size_f /= h  # fs holds h^2 f
            spread = h * math.exp(growth)
            local[count, 0] = tail + rounding + misfit * spread
            local[count, 1] = (tail_f + rounding + misfit * spread) * size_f + misfit_f * spread
            local[count, 2] = (tail_f + rounding + misfit * spread) * h * size_input
            layout[count, 0], layout[count, 1], layout[count, 2] = i, part, parts
            layout[count, 3] = problem.flow_error[i]
            count += 1
            part += 1
    return count


@numba.njit(cache=True, error_model="numpy", nogil=True)
def propagate_points(
    problem: Problem,
    gains: FloatArray,
    damping_factor: FloatArray,
    periods: FloatArray,
    limits: Limits,
    M: FloatArray,
    bound: FloatArray,
    forced: FloatArray,
) -> int:
    """Monodromy matrices in energy coordinates for many points.

    Parameters
    ----------
    gains, damping_factor, periods : (N, Q), (N,), (N,) [s]
    M : (N, 2m, 2m), out: Phi(T, 0) in x = (omega eta, eta')
    bound : (N,), out: bound on the Frobenius norm of the error of M: truncation, fit and rounding
    forced : (N, 2m), out: state at T from rest at 0 under f

    Returns
    -------
    index of the first point that needs more than max_steps or MAX_TERMS, -1 if none
    """
    n = 2 * problem.v.size
    piece = scratch_for(problem)
    steps = np.empty((limits.max_steps, n, LANES))
    local, layout = np.empty((limits.max_steps, 3)), np.empty((limits.max_steps, 4))
    weights, work, flow = np.empty((limits.max_steps, 2)), np.zeros((3, n, LANES)), np.zeros((n, LANES))
    for point in range(periods.size):
        count = steps_of_period(
            problem, gains[point], damping_factor[point], periods[point], limits, piece, steps, local, layout
        )
        if count < 0:
            return point
        bound[point] = carry(steps, local[:, 0], layout, count, flow, weights, work)
        for i in range(n):
            forced[point, i] = flow[i, FORCED]
            for j in range(n):
                M[point, i, j] = flow[i, j]
    return -1
