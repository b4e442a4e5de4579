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
_PROPORTIONAL = 1e-13


class Problem(NamedTuple):
    """A family of rank-one feedback systems: each gain is a sum of Q parts, weighted for every point.

    Attributes
    ----------
    phases : (P+1,) ends of the pieces as parts of the period, 0 to 1
    w, wd, f, fr : (Q, P, m, d+1) coefficients in powers of the piece's u in [-1, 1], lowest first; the
        damping factor zeta multiplies wd, and the forcing is f + (zeta/T) fr
    fit_error : (Q, P, 4) largest |error| of w, wd, f, fr by their polynomials on each piece
    C, omega, v : (m, m) [1/s], (m,) [rad/s], (m,)
    input : (m,) constant forcing whose motion from rest is carried beside that of f
    reference : (m,) constant part of w that omega^2 already has, so that w - reference acts
    """

    phases: FloatArray
    w: FloatArray
    wd: FloatArray
    f: FloatArray
    fr: FloatArray
    fit_error: FloatArray
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
    w, wd, f : (d+1, m) over the piece
    ws, wds, fs : the same over one step
    degrees : of w, wd, f on this piece
    a, r : majorant
    Z, s, sd : (terms, m, LANES), (terms, LANES): coefficients of eta, v . eta and its derivative
    hC, h2_omega2 : (m, m), (m,)
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
    hC: FloatArray
    h2_omega2: FloatArray
    sizes: FloatArray


@numba.njit(cache=True, error_model="numpy")
def scratch_for(problem: Problem) -> Piece:
    """Allocate the scratch of one thread."""
    m = problem.v.size
    dw, dd = problem.w.shape[3], problem.wd.shape[3]
    df = max(problem.f.shape[3], problem.fr.shape[3])
    return Piece(
        np.zeros((dw, m)), np.zeros((dd, m)), np.zeros((df, m)),
        np.zeros((dw, m)), np.zeros((dd, m)), np.zeros((df, m)),
        np.zeros(3, dtype=np.int64), np.zeros(max(dw, dd)), np.zeros(MAX_TERMS + 2),
        np.zeros((MAX_TERMS + 2, m, LANES)),
        np.zeros((MAX_TERMS + 2, LANES)), np.zeros((MAX_TERMS + 2, LANES)),
        np.zeros((m, m)), np.zeros(m),
        np.array([norm(problem.v / problem.omega), norm(problem.v),
                  problem.omega.max() + norm(problem.C.ravel())]),
    )  # fmt: skip


# What follows runs for every step of every point: no slices and no array expressions, which would allocate or
# count references.


@numba.njit(cache=True, error_model="numpy")
def _degree(poly: FloatArray) -> int:
    for j in range(poly.shape[0] - 1, 0, -1):
        for r in range(poly.shape[1]):
            if poly[j, r] != 0.0:
                return j
    return 0


@numba.njit(cache=True, error_model="numpy")
def _row(poly: FloatArray, j: int) -> float:
    """Norm of poly[j]."""
    total = 0.0
    for r in range(poly.shape[1]):
        total += poly[j, r] * poly[j, r]
    return math.sqrt(total)


@numba.njit(cache=True, error_model="numpy")
def _change(poly: FloatArray, reference: FloatArray) -> float:
    """Norm of poly[0] - reference."""
    total = 0.0
    for r in range(poly.shape[1]):
        total += (poly[0, r] - reference[r]) ** 2
    return math.sqrt(total)


@numba.njit(cache=True, error_model="numpy")
def _add(polys: FloatArray, part: int, i: int, factor: float, out: FloatArray) -> None:
    """Add factor times polys[part, i] (m, d+1) to out (d+1, m)."""
    if factor != 0.0:
        for r in range(polys.shape[2]):
            for j in range(polys.shape[3]):
                out[j, r] += factor * polys[part, i, r, j]


@numba.njit(cache=True, error_model="numpy")
def _clear(poly: FloatArray) -> None:
    for j in range(poly.shape[0]):
        for r in range(poly.shape[1]):
            poly[j, r] = 0.0


@numba.njit(cache=True, error_model="numpy")
def load_piece(
    problem: Problem, i: int, gains: FloatArray, zeta: float, T: float, piece: Piece
) -> tuple[float, float, float, float]:
    """Sum the parts of piece i.

    Returns
    -------
    bound on |A| per unit time, bound on its error, bound on the error of f, and the ratio wd/w where it is
    the same for all powers and coordinates, else nan
    """
    m = problem.v.size
    nu, nu_rate, calm = piece.sizes[0], piece.sizes[1], piece.sizes[2]
    _clear(piece.w)
    _clear(piece.wd)
    _clear(piece.f)
    error = error_f = 0.0
    for part in range(problem.w.shape[0]):
        g = gains[part]
        _add(problem.w, part, i, g, piece.w)
        _add(problem.wd, part, i, g * zeta, piece.wd)
        _add(problem.f, part, i, g, piece.f)
        _add(problem.fr, part, i, g * zeta / T, piece.f)
        fit = problem.fit_error
        error += abs(g) * (fit[part, i, 0] * nu + fit[part, i, 1] * abs(zeta) * nu_rate)
        error_f += abs(g) * (fit[part, i, 2] + fit[part, i, 3] * abs(zeta) / T)
    dw, dd = _degree(piece.w), _degree(piece.wd)
    piece.degrees[0], piece.degrees[1], piece.degrees[2] = dw, dd, _degree(piece.f)
    size_w = _change(piece.w, problem.reference)
    for j in range(1, dw + 1):
        size_w += _row(piece.w, j)
    size_wd = 0.0
    for j in range(dd + 1):
        size_wd += _row(piece.wd, j)
    rate = calm + size_w * nu + size_wd * nu_rate
    above = below = 0.0
    common = min(dw, dd)
    for j in range(common + 1):
        for r in range(m):
            above += piece.w[j, r] * piece.wd[j, r]
            below += piece.w[j, r] * piece.w[j, r]
    ratio = above / below if below > 0.0 else 0.0
    distance = 0.0
    for j in range(max(dw, dd) + 1):
        for r in range(m):
            w = piece.w[j, r] if j <= dw else 0.0
            wd = piece.wd[j, r] if j <= dd else 0.0
            distance += abs(wd - ratio * w)
    if distance <= _PROPORTIONAL * size_wd:
        piece.degrees[1] = 0
        error += distance * nu_rate
    else:
        ratio = math.nan
    return rate, error, error_f, ratio


@numba.njit(cache=True, error_model="numpy")
def load_step(problem: Problem, piece: Piece, u: float, du: float, h: float, ratio: float) -> int:
    """Write the gains over one step of length h, which starts at u and covers du, and their majorant a.

    Returns the degree of a.
    """
    m = problem.v.size
    nu, nu_rate, calm = piece.sizes[0], piece.sizes[1], piece.sizes[2]
    merged = not math.isnan(ratio)
    dw, dd, df = piece.degrees[0], piece.degrees[1], piece.degrees[2]
    for q in range(m):
        piece.h2_omega2[q] = (h * problem.omega[q]) ** 2
        for p in range(m):
            piece.hC[q, p] = h * problem.C[q, p]
    shift(piece.w, dw, u, du, piece.ws)
    shift(piece.f, df, u, du, piece.fs)
    for j in range(piece.a.size):
        piece.a[j] = 0.0
    piece.a[0] = h * calm
    if not merged:
        shift(piece.wd, dd, u, du, piece.wds)
        for j in range(dd + 1):
            piece.a[j] += h * _row(piece.wds, j) * nu_rate
            for q in range(m):
                piece.wds[j, q] *= h
    for j in range(dw + 1):
        if merged:
            piece.a[j] += h * _row(piece.ws, j) * abs(ratio) * nu_rate
        if j == 0:
            piece.a[0] += h * _change(piece.ws, problem.reference) * nu
        else:
            piece.a[j] += h * _row(piece.ws, j) * nu
        for q in range(m):
            piece.ws[j, q] *= h * h
    for j in range(df + 1):
        for q in range(m):
            piece.fs[j, q] *= h * h
    return int(dw if merged else max(dw, dd))


@numba.njit(cache=True, fastmath={"contract"}, error_model="numpy")
def series(problem: Problem, piece: Piece, terms: int, h: float, ratio: float) -> None:
    """Fill Z[k] (m, LANES), the Taylor coefficients in step time, k = 2..terms+1, from Z[0] and Z[1].

    With wd = ratio w the two convolutions merge into one with s + (ratio/h) s'.
    """
    v, m = problem.v, problem.v.size
    Z, s, sd, w, wd, f = piece.Z, piece.s, piece.sd, piece.ws, piece.wds, piece.fs
    merged = not math.isnan(ratio)
    dw, dd, df = piece.degrees[0], piece.degrees[1], piece.degrees[2]
    for k in range(2):
        total = zero()
        for r in range(m):
            total = plus(v[r], load(Z, (k, r)), total)
        store(s, (k,), total)
    for k in range(terms):
        here, derivative = load(s, (k,)), scaled(k + 1.0, load(s, (k + 1,)))
        store(sd, (k,), plus(ratio / h, derivative, here) if merged else derivative)
        factor = -1.0 / ((k + 1.0) * (k + 2.0))
        new = zero()
        for r in range(m):
            total = scaled(piece.h2_omega2[r], load(Z, (k, r)))
            total = plus(-h * h * problem.reference[r], here, total)
            for q in range(m):
                total = plus((k + 1.0) * piece.hC[r, q], load(Z, (k + 1, q)), total)
            if merged:
                for i in range(min(dw, k) + 1):
                    total = plus(w[i, r], load(sd, (k - i,)), total)
            else:
                for i in range(min(dw, k) + 1):
                    total = plus(w[i, r], load(s, (k - i,)), total)
                for i in range(min(dd, k) + 1):
                    total = plus(wd[i, r], load(sd, (k - i,)), total)
            total = scaled(factor, total)
            store(Z, (k + 2, r), total)
            if k <= df:
                Z[k + 2, r, FORCED] -= factor * f[k, r]
                if k == 0:
                    Z[2, r, FORCED + 1] -= factor * h * h * problem.input[r]
                total = load(Z, (k + 2, r))
            new = plus(v[r], total, new)
        store(s, (k + 2,), new)


@numba.njit(cache=True, error_model="numpy")
def start_from_rest(problem: Problem, piece: Piece, h: float) -> None:
    """Unit initial states x = (omega eta, eta') in the first 2m columns, rest in the others."""
    m = problem.v.size
    for q in range(m):
        store(piece.Z, (0, q), zero())
        store(piece.Z, (1, q), zero())
        piece.Z[0, q, q] = 1.0 / problem.omega[q]
        piece.Z[1, q, m + q] = h


@numba.njit(cache=True, fastmath={"contract"}, error_model="numpy")
def end_of_step(problem: Problem, piece: Piece, terms: int, h: float, out: FloatArray) -> None:
    """Energy coordinates at the end of the step, (2m, LANES), summed from the smallest terms on."""
    m = problem.v.size
    for q in range(m):
        position, rate = zero(), scaled(terms + 1.0, load(piece.Z, (terms + 1, q)))
        for k in range(terms, 0, -1):
            x = load(piece.Z, (k, q))
            position = plus(1.0, x, position)
            rate = plus(float(k), x, rate)
        position = plus(1.0, load(piece.Z, (0, q)), position)
        store(out, (q,), scaled(problem.omega[q], position))
        store(out, (m + q,), scaled(1.0 / h, rate))


@numba.njit(cache=True, error_model="numpy")
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
    layout : (max_steps, 3), out: piece, number of the step in it, number of steps in it

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
            h, du = length / parts, 2.0 / parts
            degree = load_step(problem, piece, -1.0 + du * part, du, h, ratio)
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
                size_f += _row(piece.fs, j)
            size_f /= h  # fs holds h^2 f
            spread = h * math.exp(growth)
            local[count, 0] = tail + rounding + misfit * spread
            local[count, 1] = (tail_f + rounding + misfit * spread) * size_f + misfit_f * spread
            local[count, 2] = (tail_f + rounding + misfit * spread) * h * size_input
            layout[count, 0], layout[count, 1], layout[count, 2] = i, part, parts
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
    local, layout = np.empty((limits.max_steps, 3)), np.empty((limits.max_steps, 3))
    weights, work, flow = np.empty((limits.max_steps, 2)), np.zeros((3, n, LANES)), np.zeros((n, LANES))
    for point in range(periods.size):
        count = steps_of_period(
            problem, gains[point], damping_factor[point], periods[point], limits, piece, steps, local, layout
        )
        if count < 0:
            return point
        bound[point] = carry(steps, local[:, 0], count, flow, weights, work)
        for i in range(n):
            forced[point, i] = flow[i, FORCED]
            for j in range(n):
                M[point, i, j] = flow[i, j]
    return -1
