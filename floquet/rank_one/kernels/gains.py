"""What the Taylor kernel works on: the gains of a system, summed over one piece and carried to one step."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from floquet.rank_one.kernels.compiled import compiled
from floquet.rank_one.kernels.lanes import LANES, load, plus, scaled, store, zero
from floquet.rank_one.kernels.majorant import MAX_TERMS, norm, powers_of_radii
from lumped.typing import FloatArray

MAX_STEPS = 20_000
"""Steps per period at most."""


class Problem(NamedTuple):
    """A family of rank-one feedback systems: each gain is a sum of Q parts, weighted for every point.

    Attributes
    ----------
    phases : (P+1,) ends of the pieces as parts of the period, 0 to 1
    w, wd : (Q, P, d+1, LANES) coefficients in powers of the piece's u in [-1, 1], lowest first, coordinates
        in the first lanes; the damping factor zeta multiplies wd
    degrees : (P, 2) of w and wd
    sizes : (Q, P, 2) bounds on the norms of w and wd over the piece, without the reference
    ratios : (P,) rho where wd = rho w for all parts, else nan
    unequal : (Q, P) bound on the norm of wd - rho w there
    fit_error : (Q, P, 2) largest |error| of w and wd by their polynomials on each piece
    edge_error : (Q, P+1, 2) integral over the phase of a further |error| of w, wd at either side of each end
    flow_error : (P,) bound on what the error of the transition matrix over each piece has besides
    C, omega, v : (m, m) [1/s], (m,) [rad/s], (m,)
    drive : bound on the rate [1/s] at which C lets the state grow; 0 where all supports are damped
    noise : bound on the error of A [1/s] by the change to modal coordinates and the rounding of C and omega
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
    flow_error: FloatArray
    C: FloatArray
    drive: float
    noise: float
    omega: FloatArray
    v: FloatArray
    reference: FloatArray


class Limits(NamedTuple):
    """Accuracy and length of the steps.

    Attributes
    ----------
    tolerance : of each step's truncation, relative to 1
    angle : largest majorant exponent per half of a step
    """

    tolerance: float
    angle: float


class Piece(NamedTuple):
    """Scratch: the gains of one piece at one point, and the same in the time of one step.

    The time of a step is u in [-1, 1] about its middle, its unit half of the step, h.

    Attributes
    ----------
    w, wd : (d+1, LANES) over the piece
    ws, wds : the same over one step, times h^2 and h
    degrees : of w and wd on this piece
    a, powers : majorant, and what ``enough_terms`` needs besides
    Z, s, sd : (terms, 3, LANES), (terms, LANES): coefficients of eta, v . eta and its derivative
    v, hC, h2_omega2, h2_reference : (3,), (3, 3), (3,), (3,)
    sizes : |v/omega|, |v|, max omega + |C|, and |reference| |v/omega|
    ends : (4, 2m, LANES) states at the end and at the start of the step, and room to work
    unit : (LANES, LANES) rows of the unit matrix
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


@compiled()
def scratch_for(problem: Problem) -> Piece:
    """Allocate the scratch of one thread."""
    m = problem.v.size
    dw, dd = problem.w.shape[2], problem.wd.shape[2]
    v, omega = np.zeros(3), 0.0
    lean, C_size = np.zeros(m), 0.0
    for q in range(m):  # loops, for each array expression takes the compiler half a second
        v[q] = problem.v[q]
        lean[q] = problem.v[q] / problem.omega[q]
        omega = max(omega, problem.omega[q])
        for p in range(m):
            C_size += problem.C[q, p] ** 2
    sizes, unit = np.zeros(4), np.zeros((LANES, LANES))
    sizes[0], sizes[1] = norm(lean), norm(problem.v)
    sizes[2], sizes[3] = omega + math.sqrt(C_size), norm(problem.reference) * sizes[0]
    for i in range(LANES):
        unit[i, i] = 1.0
    return Piece(
        np.zeros((dw, LANES)), np.zeros((dd, LANES)), np.zeros((dw, LANES)), np.zeros((dd, LANES)),
        np.zeros(2, dtype=np.int64), np.zeros(max(dw, dd)), powers_of_radii(max(dw, dd)),
        np.zeros((MAX_TERMS + 2, 3, LANES)),
        np.zeros((MAX_TERMS + 2, LANES)), np.zeros((MAX_TERMS + 2, LANES)),
        v, np.zeros((3, 3)), np.zeros(3), np.zeros(3),
        sizes, np.zeros((4, 2 * m, LANES)), unit,
    )  # fmt: skip


# What follows runs for every step of every point: no slices and no array expressions, which would allocate.
# _nrt=False: without it every call counts the references of all arrays of its tuples, half of the run time.


@compiled(_nrt=False)
def _row_norm(poly: FloatArray, j: int, m: int) -> float:
    """Norm of poly[j, 0:m]."""
    total = 0.0
    for r in range(m):
        total += poly[j, r] * poly[j, r]
    return math.sqrt(total)


@compiled(_nrt=False)
def _summed(
    polys: FloatArray, i: int, degree: int, weights: FloatArray, factor: float, out: FloatArray
) -> None:
    """Out = factor * sum of weights[q] polys[q, i], row by row."""
    for j in range(degree + 1):
        total = zero()
        for q in range(weights.size):
            total = plus(factor * weights[q], load(polys, (q, i, j)), total)
        store(out, (j,), total)


@compiled(_nrt=False)
def _part_of(poly: FloatArray, degree: int, part: int, parts: int, factor: float, out: FloatArray) -> None:
    """Out = factor times poly in the time of one of so many equal parts, by synthetic division."""
    if parts == 1:
        for j in range(degree + 1):
            store(out, (j,), scaled(factor, load(poly, (j,))))
        return
    for j in range(degree + 1):
        store(out, (j,), load(poly, (j,)))
    middle = (2.0 * part + 1.0) / parts - 1.0
    for j in range(degree):
        for i in range(degree - 1, j - 1, -1):
            store(out, (i,), plus(middle, load(out, (i + 1,)), load(out, (i,))))
    for j in range(degree + 1):
        store(out, (j,), scaled(factor, load(out, (j,))))
        factor /= parts


@compiled(_nrt=False)
def load_piece(
    problem: Problem, i: int, gains: FloatArray, zeta: float, T: float, piece: Piece
) -> tuple[float, float, float, float, float]:
    """Sum the parts of piece i.

    Returns
    -------
    bound on |A| per unit time, bound on its error, the ratio wd/w where it is the same for all powers and
    coordinates, else nan, and bounds on the integrals over time of further errors of A at the start and at
    the end
    """
    nu, nu_rate, calm = piece.sizes[0], piece.sizes[1], piece.sizes[2]
    rho, fit = problem.ratios[i], problem.fit_error
    piece.degrees[0], piece.degrees[1] = problem.degrees[i, 0], problem.degrees[i, 1]
    _summed(problem.w, i, piece.degrees[0], gains, 1.0, piece.w)
    if math.isnan(rho):
        _summed(problem.wd, i, piece.degrees[1], gains, zeta, piece.wd)
    rate, error, first, last = calm, problem.noise, 0.0, 0.0
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


@compiled(_nrt=False)
def load_step(problem: Problem, piece: Piece, part: int, parts: int, h: float, ratio: float) -> int:
    """Write the gains over one of the steps of length 2 h into which a piece is cut, and their majorant a.

    Returns the degree of a.
    """
    m = problem.v.size
    nu, nu_rate, calm = piece.sizes[0], piece.sizes[1], piece.sizes[2]
    merged = not math.isnan(ratio)
    dw, dd = piece.degrees[0], piece.degrees[1]
    change = 0.0
    _part_of(piece.w, dw, part, parts, h * h, piece.ws)
    for q in range(m):
        piece.h2_omega2[q] = (h * problem.omega[q]) ** 2
        piece.h2_reference[q] = -h * h * problem.reference[q]
        change += (piece.ws[0, q] + piece.h2_reference[q]) ** 2
        for p in range(m):
            piece.hC[q, p] = h * problem.C[q, p]
    for j in range(piece.a.size):
        piece.a[j] = 0.0
    # ws holds h^2 w and wds h wd.
    piece.a[0] = h * calm + math.sqrt(change) * nu / h
    for j in range(dw + 1):
        size = _row_norm(piece.ws, j, m) / h
        if j > 0:
            piece.a[j] = size * nu
        if merged:
            piece.a[j] += size * abs(ratio) * nu_rate
    if merged:
        return int(dw)
    _part_of(piece.wd, dd, part, parts, h, piece.wds)
    for j in range(dd + 1):
        piece.a[j] += _row_norm(piece.wds, j, m) * nu_rate
    return int(max(dw, dd))
