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
from typing import NamedTuple

import numba
import numpy as np
import numpy.typing as npt

from floquet.kernels.lanes import LANES, load, plus, scaled, store, zero
from floquet.kernels.majorant import MAX_TERMS, enough_terms, norm, shift
from floquet.kernels.product import FORCED, carry
from floquet.system import FloatArray

_EPS = 2.220446049250313e-16


class Problem(NamedTuple):
    """A family of rank-one feedback systems: each gain is a sum of Q parts, weighted for every point.

    Attributes
    ----------
    phases : (P+1,) ends of the pieces as parts of the period, 0 to 1
    w, wd : (Q, P, d+1, LANES) coefficients in powers of the piece's tau in [0, 1], lowest first, coordinates
        in the first lanes; the damping factor zeta multiplies wd
    f, fr : (Q, P, m, d+1) in powers of u = 2 tau - 1; the forcing is f + (zeta/T) fr
    degrees : (P, 2) of w and wd
    sizes : (Q, P, 2) bounds on the norms of w and wd over the piece, without the reference
    ratios : (P,) rho where wd = rho w for all parts, else nan
    unequal : (Q, P) bound on the norm of wd - rho w there
    fit_error : (Q, P, 4) largest |error| of w, wd, f, fr by their polynomials on each piece
    flow_error : (P,) bound on what the error of the transition matrix over each piece has besides
    C, omega, v : (m, m) [1/s], (m,) [rad/s], (m,)
    input : (m,) constant forcing whose motion from rest is carried beside that of f
    reference : (m,) constant part of w that omega^2 already has, so that w - reference acts
    """

    phases: FloatArray
    w: FloatArray
    wd: FloatArray
    f: FloatArray
    fr: FloatArray
    degrees: npt.NDArray[np.int64]
    sizes: FloatArray
    ratios: FloatArray
    unequal: FloatArray
    fit_error: FloatArray
    flow_error: FloatArray
    C: FloatArray
    omega: FloatArray
    v: FloatArray
    input: FloatArray
    reference: FloatArray


class Limits(NamedTuple):
    """Accuracy and effort.

    Attributes
    ----------
    tolerance : of each step's truncation, relative to 1
    angle : largest majorant exponent per step
    max_steps : steps per period at most
    """

    tolerance: float
    angle: float
    max_steps: int


class Piece(NamedTuple):
    """Scratch: the gains of one piece at one point, and the same in the time of one step.

    Attributes
    ----------
    w, wd : (d+1, LANES) over the piece; f : (d+1, m)
    ws, wds, fs : the same over one step, times h^2, h and h^2
    degrees : of w, wd, f on this piece
    a, r : majorant
    Z, s, sd : (terms, 3, LANES), (terms, LANES): coefficients of eta, v . eta and its derivative
    v, hC, h2_omega2, h2_reference : (3,), (3, 3), (3,), (3,)
    sizes : |v/omega|, |v| and max omega + |C|
    """

    w: FloatArray
    wd: FloatArray
    f: FloatArray
    ws: FloatArray
    wds: FloatArray
    fs: FloatArray
    degrees: npt.NDArray[np.int64]
    a: FloatArray
    r: FloatArray
    Z: FloatArray
    s: FloatArray
    sd: FloatArray
    v: FloatArray
    hC: FloatArray
    h2_omega2: FloatArray
    h2_reference: FloatArray
    sizes: FloatArray


@numba.njit(cache=True, error_model="numpy")
def scratch_for(problem: Problem) -> Piece:
    """Allocate the scratch of one thread."""
    m = problem.v.size
    dw, dd = problem.w.shape[2], problem.wd.shape[2]
    df = max(problem.f.shape[3], problem.fr.shape[3])
    v = np.zeros(3)
    v[:m] = problem.v
    return Piece(
        np.zeros((dw, LANES)), np.zeros((dd, LANES)), np.zeros((df, m)),
        np.zeros((dw, LANES)), np.zeros((dd, LANES)), np.zeros((df, m)),
        np.zeros(3, dtype=np.int64), np.zeros(max(dw, dd)), np.zeros(MAX_TERMS + 2),
        np.zeros((MAX_TERMS + 2, 3, LANES)),
        np.zeros((MAX_TERMS + 2, LANES)), np.zeros((MAX_TERMS + 2, LANES)),
        v, np.zeros((3, 3)), np.zeros(3), np.zeros(3),
        np.array([norm(problem.v / problem.omega), norm(problem.v),
                  problem.omega.max() + norm(problem.C.ravel())]),
    )  # fmt: skip


# What follows runs for every step of every point: no slices and no array expressions, which would allocate or
# count references.


@numba.njit(cache=True, error_model="numpy", _nrt=False)
def _row(poly: FloatArray, j: int, m: int) -> float:
    """Norm of poly[j, 0:m]."""
    total = 0.0
    for r in range(m):
        total += poly[j, r] * poly[j, r]
    return math.sqrt(total)


@numba.njit(cache=True, error_model="numpy", _nrt=False)
def _summed(
    polys: FloatArray, i: int, degree: int, weights: FloatArray, factor: float, out: FloatArray
) -> None:
    """Out = factor * sum of weights[q] polys[q, i], row by row."""
    for j in range(degree + 1):
        total = zero()
        for q in range(weights.size):
            total = plus(factor * weights[q], load(polys, (q, i, j)), total)
        store(out, (j,), total)


@numba.njit(cache=True, error_model="numpy", _nrt=False)
def _part_of(poly: FloatArray, degree: int, part: int, parts: int, factor: float, out: FloatArray) -> None:
    """Out = factor times poly in the time of one of so many equal parts, by synthetic division."""
    if parts == 1:
        for j in range(degree + 1):
            store(out, (j,), scaled(factor, load(poly, (j,))))
        return
    for j in range(degree + 1):
        store(out, (j,), load(poly, (j,)))
    for j in range(degree):
        for i in range(degree - 1, j - 1, -1):
            store(out, (i,), plus(part / parts, load(out, (i + 1,)), load(out, (i,))))
    for j in range(degree + 1):
        store(out, (j,), scaled(factor, load(out, (j,))))
        factor /= parts


@numba.njit(cache=True, error_model="numpy", _nrt=False)
def load_piece(
    problem: Problem, i: int, gains: FloatArray, zeta: float, T: float, piece: Piece
) -> tuple[float, float, float, float]:
    """Sum the parts of piece i.

    Returns
    -------
    bound on |A| per unit time, bound on its error, bound on the error of f, and the ratio wd/w where it is
    the same for all powers and coordinates, else nan
    """
    nu, nu_rate, calm = piece.sizes[0], piece.sizes[1], piece.sizes[2]
    rho, fit = problem.ratios[i], problem.fit_error
    piece.degrees[0], piece.degrees[1] = problem.degrees[i, 0], problem.degrees[i, 1]
    piece.degrees[2] = piece.f.shape[0] - 1
    _summed(problem.w, i, piece.degrees[0], gains, 1.0, piece.w)
    if math.isnan(rho):
        _summed(problem.wd, i, piece.degrees[1], gains, zeta, piece.wd)
    rate, error, error_f = calm, 0.0, 0.0
    for j in range(piece.f.shape[0]):
        for r in range(piece.f.shape[1]):
            piece.f[j, r] = 0.0
    for q in range(gains.size):
        g = abs(gains[q])
        rate += g * (problem.sizes[q, i, 0] * nu + abs(zeta) * problem.sizes[q, i, 1] * nu_rate)
        error += g * (fit[q, i, 0] * nu + fit[q, i, 1] * abs(zeta) * nu_rate)
        if not math.isnan(rho):
            error += g * abs(zeta) * problem.unequal[q, i] * nu_rate
        error_f += g * (fit[q, i, 2] + fit[q, i, 3] * abs(zeta) / T)
        for r in range(piece.f.shape[1]):
            for j in range(problem.f.shape[3]):
                piece.f[j, r] += gains[q] * problem.f[q, i, r, j]
            for j in range(problem.fr.shape[3]):
                piece.f[j, r] += gains[q] * zeta / T * problem.fr[q, i, r, j]
    return rate, error, error_f, zeta * rho


@numba.njit(cache=True, error_model="numpy", _nrt=False)
def load_step(problem: Problem, piece: Piece, part: int, parts: int, h: float, ratio: float) -> int:
    """Write the gains over one of the steps of length h into which a piece is cut, and their majorant a.

    Returns the degree of a.
    """
    m = problem.v.size
    nu, nu_rate, calm = piece.sizes[0], piece.sizes[1], piece.sizes[2]
    merged = not math.isnan(ratio)
    dw, dd, df = piece.degrees[0], piece.degrees[1], piece.degrees[2]
    change = 0.0
    _part_of(piece.w, dw, part, parts, h * h, piece.ws)
    for q in range(m):
        piece.h2_omega2[q] = (h * problem.omega[q]) ** 2
        piece.h2_reference[q] = -h * h * problem.reference[q]
        change += (piece.ws[0, q] + piece.h2_reference[q]) ** 2
        for p in range(m):
            piece.hC[q, p] = h * problem.C[q, p]
    shift(piece.f, df, -1.0 + 2.0 * part / parts, 2.0 / parts, piece.fs)
    for j in range(df + 1):
        for q in range(m):
            piece.fs[j, q] *= h * h
    for j in range(piece.a.size):
        piece.a[j] = 0.0
    # ws holds h^2 w and wds h wd.
    piece.a[0] = h * calm + math.sqrt(change) * nu / h
    for j in range(dw + 1):
        size = _row(piece.ws, j, m) / h
        if j > 0:
            piece.a[j] = size * nu
        if merged:
            piece.a[j] += size * abs(ratio) * nu_rate
    if merged:
        return int(dw)
    _part_of(piece.wd, dd, part, parts, h, piece.wds)
    for j in range(dd + 1):
        piece.a[j] += _row(piece.wds, j, m) * nu_rate
    return int(max(dw, dd))


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
                size_f += _row(piece.fs, j, m)
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
