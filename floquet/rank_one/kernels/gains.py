"""What the Taylor kernel works on: gains over one piece and one step, and how many terms are enough.

With a_j >= |A_j|, g(R) = sum_j a_j R^(j+1)/(j+1), the terms of x' = sum_j A_j u^j x beyond degree p sum to at
most exp(g(R)) R^-p/(R - 1) for all |u| <= 1 and R > 1, which gives p before any vector is computed.

Sources: docs/theory/proven_bounds.md, "The matrix of a step".
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from floquet.rank_one.kernels.simd import (
    LANES,
    least,
    load,
    plus,
    plus_square,
    scaled,
    store,
    total,
    zero,
)
from lumped.compiler import compiled
from lumped.typing import FloatArray

MAX_TERMS = 64
"""Largest Taylor degree."""
RADII = np.geomspace(1.3, 60.0, 2 * LANES)
"""The R at which the bound is tried."""
MAX_STEPS = 20_000
"""Steps per period at most."""
_ROOM = 6_000_000  # entries of their matrices together


class Problem(NamedTuple):
    """A family of rank-one feedback systems: each gain is a sum of Q parts, weighted for every point.

    Attributes
    ----------
    phases : (P+1,) ends of the pieces as parts of the period, 0 to 1
    w, wd : (Q, P, d+1, lanes) coefficients in powers of the piece's u in [-1, 1], lowest first, coordinates
        in the first lanes; the damping factor zeta multiplies wd
    degrees : (P, 2) of w and wd
    sizes : (Q, P, 2) bounds on the norms of w and wd over the piece, without the reference
    ratios : (P,) rho where wd = rho w for all parts, else nan
    unequal : (Q, P) bound on the norm of wd - rho w there
    fit_error : (Q, P, 2) largest |error| of w and wd by their polynomials on each piece
    edge_error : (Q, P+1, 2) integral over the phase of a further |error| of w, wd at either side of each end
    C, omega, v : (2, m, m), what does not depend on speed [1/s] and what is to be divided by the period; (m,)
        [rad/s]; (m,)
    drive : bound on the rate [1/s] at which C lets the state grow; 0 where all supports are damped
    noise : bound on the error of A [1/s] by the change to modal coordinates and the rounding of C and omega
    gyroscopic_drive, gyroscopic_noise : what adds to drive and noise, times the period
    reference : (m,) constant part of w that omega^2 already has, so that w - reference acts
    """

    phases: FloatArray
    w: FloatArray
    wd: FloatArray
    degrees: npt.NDArray[np.int64]
    sizes: FloatArray
    ratios: FloatArray
    unequal: FloatArray
    fit_error: FloatArray
    edge_error: FloatArray
    C: FloatArray
    drive: float
    noise: float
    gyroscopic_drive: float
    gyroscopic_noise: float
    omega: FloatArray
    v: FloatArray
    reference: FloatArray


class Limits(NamedTuple):
    """Truncation of a step relative to 1, and the largest majorant exponent per half of a step."""

    tolerance: float
    angle: float


class Piece(NamedTuple):
    """Scratch: the gains of one piece at one point, and the same in the time of one step.

    The time of a step is u in [-1, 1] about its middle, its unit half of the step, h.

    Attributes
    ----------
    w, wd : (d+1, lanes) over the piece
    ws, wds : the same over one step, times h^2 and h
    degrees : of w and wd on this piece
    a, powers : majorant, and what `enough_terms` needs besides
    Z, s, sd : (terms, m, lanes), (terms, LANES): coefficients of eta, v . eta and its derivative, with at
        least three coordinates; at the end of Z the newest ones of eta'
    v, hC, h2_omega2, h2_reference : (m,), (2, m, m), (m,), (m,); after hC the C of the point
    sizes : |v/omega|, |v|, max omega + |C|, |reference| |v/omega|, drive and noise of the point
    ends : (4, 2m, lanes) states at the end and at the start of the step, and room to work
    unit : (lanes, lanes) rows of the unit matrix
    """

    w: FloatArray
    wd: FloatArray
    ws: FloatArray
    wds: FloatArray
    degrees: npt.NDArray[np.int64]
    a: FloatArray
    powers: FloatArray
    Z: FloatArray
    s: FloatArray
    sd: FloatArray
    v: FloatArray
    hC: FloatArray
    h2_omega2: FloatArray
    h2_reference: FloatArray
    sizes: FloatArray
    ends: FloatArray
    unit: FloatArray


@compiled(_nrt=False)
def norm(row: FloatArray) -> float:
    total = 0.0
    for value in row:
        total += value * value
    return math.sqrt(total)


@compiled()
def powers_of_radii(count: int) -> FloatArray:
    """What p at all RADII in two rows of lanes is made of, (2, count + 2, LANES).

    R^(j+1)/((j+1) log R) for a_j, j = 0..count-1; 1/log R for the logarithm of 1/tolerance; and what is left.
    """
    powers = np.empty((2, count + 2, LANES))
    for i in range(2 * LANES):
        R = RADII[i]
        row = i // LANES
        lane = i % LANES
        for j in range(count):
            powers[row, j, lane] = R ** (j + 1) / (j + 1) / math.log(R)
        powers[row, count, lane] = 1.0 / math.log(R)
        powers[row, count + 1, lane] = -math.log(R - 1.0) / math.log(R)
    return powers


@compiled()
def most_steps(n: int) -> int:
    """Steps per period at most with n states, whose matrices are all in memory."""
    return min(MAX_STEPS, _ROOM // (n * n))


@compiled()
def scratch_for(problem: Problem) -> Piece:
    """Allocate the scratch of one thread."""
    m = problem.v.size
    dw = problem.w.shape[2]
    dd = problem.wd.shape[2]
    slots = max(m, 3)
    lanes = problem.w.shape[3]
    wide = -(-2 * m // LANES) * LANES
    v = np.zeros(slots)
    lean = np.zeros(m)
    for q in range(m):  # loops, for each array expression takes the compiler half a second
        v[q] = problem.v[q]
        lean[q] = problem.v[q] / problem.omega[q]
    sizes = np.zeros(6)
    unit = np.zeros((wide, wide))
    sizes[0] = norm(lean)
    sizes[1] = norm(problem.v)
    sizes[3] = norm(problem.reference) * sizes[0]
    for i in range(wide):
        unit[i, i] = 1.0
    return Piece(
        np.zeros((dw, lanes)), np.zeros((dd, lanes)), np.zeros((dw, lanes)), np.zeros((dd, lanes)),
        np.zeros(2, dtype=np.int64), np.zeros(max(dw, dd)), powers_of_radii(max(dw, dd)),
        np.zeros((MAX_TERMS + 3, slots, wide)),
        np.zeros((MAX_TERMS + 2, LANES)), np.zeros((MAX_TERMS + 2, LANES)),
        v, np.zeros((2, slots, slots)), np.zeros(slots), np.zeros(slots),
        sizes, np.zeros((4, 2 * m, wide)), unit,
    )  # fmt: skip


# What follows runs for every step of every point: no slices and no array expressions, which would allocate.
# _nrt=False: without it every call counts the references of all arrays of its tuples, half of the run time.
# forceinline: a call that is not inlined passes every number of all arrays of its tuples, up to 80 ns.


@compiled(_nrt=False, forceinline=True)
def load_point(problem: Problem, T: float, piece: Piece) -> None:
    """Write what of the constant part goes with the period: gyroscopic terms grow with speed."""
    m = problem.v.size
    omega = 0.0
    still = 0.0
    moving = 0.0
    for q in range(m):
        omega = max(omega, problem.omega[q])
        for p in range(m):
            still += problem.C[0, q, p] ** 2
            moving += problem.C[1, q, p] ** 2
            piece.hC[1, q, p] = problem.C[0, q, p] + problem.C[1, q, p] / T
    piece.sizes[2] = omega + math.sqrt(still) + math.sqrt(moving) / T
    piece.sizes[4] = problem.drive + problem.gyroscopic_drive / T
    piece.sizes[5] = problem.noise + problem.gyroscopic_noise / T


@compiled(_nrt=False, forceinline=True)
def _row_norm(poly: FloatArray, j: int) -> float:
    """Norm of poly[j], zero beyond its coordinates."""
    squares = zero()
    for c in range(0, poly.shape[1], LANES):
        squares = plus_square(load(poly, (j, c)), squares)
    return math.sqrt(total(squares))


@compiled(_nrt=False, forceinline=True)
def _summed(
    polys: FloatArray, i: int, degree: int, weights: FloatArray, factor: float, out: FloatArray
) -> None:
    """Out = factor * sum of weights[q] polys[q, i], row by row."""
    for c in range(0, out.shape[1], LANES):
        for j in range(degree + 1):
            row = zero()
            for q in range(weights.size):
                row = plus(factor * weights[q], load(polys, (q, i, j, c)), row)
            store(out, (j, c), row)


@compiled(_nrt=False, forceinline=True)
def _part_of(poly: FloatArray, degree: int, part: int, parts: int, factor: float, out: FloatArray) -> None:
    """Out = factor times poly in the time of one of so many equal parts, by synthetic division."""
    middle = (2.0 * part + 1.0) / parts - 1.0
    for c in range(0, out.shape[1], LANES):
        if parts == 1:
            for j in range(degree + 1):
                store(out, (j, c), scaled(factor, load(poly, (j, c))))
            continue
        for j in range(degree + 1):
            store(out, (j, c), load(poly, (j, c)))
        for j in range(degree):
            for i in range(degree - 1, j - 1, -1):
                store(out, (i, c), plus(middle, load(out, (i + 1, c)), load(out, (i, c))))
        power = factor
        for j in range(degree + 1):
            store(out, (j, c), scaled(power, load(out, (j, c))))
            power /= parts


@compiled(_nrt=False, forceinline=True)
def load_piece(
    problem: Problem, i: int, gains: FloatArray, zeta: float, T: float, piece: Piece
) -> tuple[float, float, float, float, float]:
    """Sum the parts of piece i.

    Returns a bound on |A| per unit time, one on its error, the ratio wd/w where it is the same for all powers
    and coordinates, else nan, and bounds on the integrals of further errors of A at the start and at the end.
    """
    nu = piece.sizes[0]
    nu_rate = piece.sizes[1]
    calm = piece.sizes[2]
    rho = problem.ratios[i]
    fit = problem.fit_error
    piece.degrees[0] = problem.degrees[i, 0]
    piece.degrees[1] = problem.degrees[i, 1]
    _summed(problem.w, i, piece.degrees[0], gains, 1.0, piece.w)
    if math.isnan(rho):
        _summed(problem.wd, i, piece.degrees[1], gains, zeta, piece.wd)
    rate = calm
    error = piece.sizes[5]
    first = 0.0
    last = 0.0
    edge = problem.edge_error
    for q in range(gains.size):
        g = abs(gains[q])
        rate += g * (problem.sizes[q, i, 0] * nu + abs(zeta) * problem.sizes[q, i, 1] * nu_rate)
        error += g * (fit[q, i, 0] * nu + fit[q, i, 1] * abs(zeta) * nu_rate)
        first += g * T * (edge[q, i, 0] * nu + edge[q, i, 1] * abs(zeta) * nu_rate)
        last += g * T * (edge[q, i + 1, 0] * nu + edge[q, i + 1, 1] * abs(zeta) * nu_rate)
        if not math.isnan(rho):
            error += g * abs(zeta) * problem.unequal[q, i] * nu_rate
    return rate, error, zeta * rho, first, last


@compiled(_nrt=False, forceinline=True)
def load_step(problem: Problem, piece: Piece, part: int, parts: int, h: float, ratio: float) -> int:
    """Write the gains over a step of length 2 h and their majorant a; return the degree of a."""
    m = problem.v.size
    nu = piece.sizes[0]
    nu_rate = piece.sizes[1]
    calm = piece.sizes[2]
    merged = not math.isnan(ratio)
    dw, dd = piece.degrees[0], piece.degrees[1]
    change = 0.0
    _part_of(piece.w, dw, part, parts, h * h, piece.ws)
    for q in range(m):
        piece.h2_omega2[q] = (h * problem.omega[q]) ** 2
        piece.h2_reference[q] = -h * h * problem.reference[q]
        change += (piece.ws[0, q] + piece.h2_reference[q]) ** 2
        for p in range(m):
            piece.hC[0, q, p] = h * piece.hC[1, q, p]
    # ws holds h^2 w and wds h wd.
    per_h = 1.0 / h
    piece.a[0] = h * calm + math.sqrt(change) * nu * per_h
    if merged:
        piece.a[0] += _row_norm(piece.ws, 0) * per_h * abs(ratio) * nu_rate
        for j in range(1, dw + 1):
            piece.a[j] = _row_norm(piece.ws, j) * per_h * (nu + abs(ratio) * nu_rate)
        return int(dw)
    _part_of(piece.wd, dd, part, parts, h, piece.wds)
    piece.a[0] += _row_norm(piece.wds, 0) * nu_rate
    for j in range(1, max(dw, dd) + 1):
        size = _row_norm(piece.ws, j) * per_h * nu if j <= dw else 0.0
        piece.a[j] = size + _row_norm(piece.wds, j) * nu_rate if j <= dd else size
    return int(max(dw, dd))


@compiled(fastmath={"contract"}, _nrt=False, forceinline=True)
def enough_terms(a: FloatArray, degree: int, log_tolerance: float, powers: FloatArray) -> tuple[int, float]:
    """Degree p after which the neglected terms sum to less than the tolerance, -1 above MAX_TERMS.

    ``a`` (d+1,) is the majorant, ``powers`` as of `powers_of_radii`. The second result is the sum of all r_k,
    which measures rounding.
    """
    last = powers.shape[1] - 1
    first = plus(-log_tolerance, load(powers, (0, last - 1)), load(powers, (0, last)))
    second = plus(-log_tolerance, load(powers, (1, last - 1)), load(powers, (1, last)))
    exponent = 0.0
    for j in range(degree + 1):
        first = plus(a[j], load(powers, (0, j)), first)
        second = plus(a[j], load(powers, (1, j)), second)
        exponent += a[j] / (j + 1.0)
    best = least(first, second)
    size = math.exp(exponent)
    if not best <= MAX_TERMS:
        return -1, size
    return max(1, math.ceil(best)), size
