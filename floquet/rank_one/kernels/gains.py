"""Input of the Taylor kernel: gains over one piece and one step, and how many terms are enough.

The equation of a step is x' = sum_j A_j u^j x, |u| <= 1. Let a_j >= |A_j| and g(R) = sum_j a_j R^(j+1)/(j+1).
The Taylor terms of x beyond degree p then sum to at most exp(g(R)) R^-p/(R - 1) for every R > 1. This bound
gives p before any vector is computed.

Sources: docs/theory/proven_bounds.md, "The matrix of a step".
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from floquet.engine.kernels.simd import (
    LANES,
    aligned_matrices,
    aligned_rows,
    least,
    load,
    plus,
    plus_square,
    scaled,
    store,
    total,
    zero,
)
from lumped.compiler import called, compiled, inlined
from lumped.typing import FloatArray

MAX_TERMS = 64
"""Largest Taylor degree."""
RADII = np.geomspace(1.3, 60.0, 2 * LANES)
"""The radii R at which the bound on the neglected terms is computed; the best of them counts."""
MAX_STEPS = 20_000
"""Steps per period at most."""
_MATRIX_ENTRIES = 6_000_000  # in the matrices of all steps of a period together


#: Index of the last axis of the bounds in `Problem`: gain of the deflection, gain of the deflection's rate.
W = 0
WD = 1


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
    C, gyroscopic : (m, m) damping of the supports [1/s], and G, dimensionless; C + G/T acts
    omega, v : (m,) natural frequencies [rad/s]; the deflection is v . eta
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
    gyroscopic: FloatArray
    drive: float
    noise: float
    gyroscopic_drive: float
    gyroscopic_noise: float
    omega: FloatArray
    v: FloatArray
    reference: FloatArray


class Point(NamedTuple):
    """One member of the family.

    Attributes
    ----------
    weights : (Q,) factors on the parts of the gains
    zeta : damping factor on wd
    period : T [s]
    """

    weights: FloatArray
    zeta: float
    period: float


class Points(NamedTuple):
    """N members of the family; weights (N, Q), zeta (N,), periods (N,) [s], see `Point`."""

    weights: FloatArray
    zeta: FloatArray
    periods: FloatArray


class Limits(NamedTuple):
    """Limits of a step.

    Attributes
    ----------
    tolerance : largest sum of the neglected Taylor terms, relative to 1
    angle : largest exponent of the majorant over half of a step
    """

    tolerance: float
    angle: float


class Norms(NamedTuple):
    """Norms of the vectors of a problem, the same at all points.

    Attributes
    ----------
    deflection : |v/omega|, of the map from a state to the deflection
    deflection_rate : |v|, of the map from a state to the rate of the deflection
    reference : |reference| |v/omega|, of the feedback that omega^2 already has
    """

    deflection: float
    deflection_rate: float
    reference: float


class ConstantPart(NamedTuple):
    """Bounds on the constant part of A at one point [1/s].

    Attributes
    ----------
    size : max omega + |C + G/T|
    drive : rate at which C + G/T lets the state grow
    noise : error of the constant part
    """

    size: float
    drive: float
    noise: float


class Piece(NamedTuple):
    """Gains on one piece of the period at one point: degrees and bounds.

    Attributes
    ----------
    length : [s]
    w_degree, wd_degree : degrees of the polynomials
    ratio : wd/w where all powers and coordinates have the same ratio, else nan
    size : bound on |A| [1/s]
    misfit : bound on the error of A [1/s]
    start_error, end_error : bounds on the integrals of further errors of A at both ends of the piece
    """

    length: float
    w_degree: int
    wd_degree: int
    ratio: float
    size: float
    misfit: float
    start_error: float
    end_error: float


class StepEquation(NamedTuple):
    """Coefficients of the equation of motion over a step.

    eta'' + C eta' + omega^2 eta + (w - reference) (v . eta) + wd (v . eta') = 0

    The unit of time is half of the step, h; the time u is in [-1, 1] about the middle of the step. There are
    at least three coordinates; those that the system does not have are zero.

    Attributes
    ----------
    h2_w, h_wd : (d+1, lanes) gains in powers of u, times h^2 and h
    h2_omega2, h2_reference : (coordinates,) omega^2 and -reference, times h^2
    h_C : (coordinates, coordinates) times h
    v : (coordinates,)
    majorant : (d+1,) a_j >= |A_j|
    """

    h2_w: FloatArray
    h_wd: FloatArray
    h2_omega2: FloatArray
    h2_reference: FloatArray
    h_C: FloatArray
    v: FloatArray
    majorant: FloatArray


class Series(NamedTuple):
    """Taylor coefficients of a step, lowest power first; the columns are the unit initial states.

    Attributes
    ----------
    eta : (terms, coordinates, columns)
    deflection, deflection_rate : (terms, LANES) of v . eta and its derivative, for eight columns
    newest_rate : (coordinates, columns) newest coefficients of eta', with more than three coordinates
    """

    eta: FloatArray
    deflection: FloatArray
    deflection_rate: FloatArray
    newest_rate: FloatArray


class Workspace(NamedTuple):
    """Arrays of one thread: constants of the problem, and arrays that every step overwrites.

    Attributes
    ----------
    norms : of the problem
    C : (m, m) C + G/T of the point [1/s]
    w, wd : (d+1, lanes) gains of the point over the piece
    equation, series : of the step
    radius_table : see `table_of_radii`
    end, start : (2m, lanes) energy coordinates at both ends of the step, by columns
    matrices : (2, 2m, lanes) for `divide`
    unit : (lanes, lanes) rows of the unit matrix
    """

    norms: Norms
    C: FloatArray
    w: FloatArray
    wd: FloatArray
    equation: StepEquation
    series: Series
    radius_table: FloatArray
    end: FloatArray
    start: FloatArray
    matrices: FloatArray
    unit: FloatArray


@called
def norm(row: FloatArray) -> float:
    """Euclidean norm of a vector."""
    total = 0.0
    for value in row:
        total += value * value
    return math.sqrt(total)


@compiled()
def table_of_radii(count: int) -> FloatArray:
    """What does not depend on the step in the degree p at all RADII, (2, count + 2, LANES).

    p = sum_j a_j R^(j+1)/((j+1) log R) + log(1/tolerance)/log R - log(R - 1)/log R. Row j holds the factor of
    a_j, j = 0..count-1; the last two rows hold 1/log R and -log(R - 1)/log R.
    """
    table = aligned_matrices(2, count + 2, LANES)
    for i in range(2 * LANES):
        R = RADII[i]
        row = i // LANES
        lane = i % LANES
        for j in range(count):
            table[row, j, lane] = R ** (j + 1) / (j + 1) / math.log(R)
        table[row, count, lane] = 1.0 / math.log(R)
        table[row, count + 1, lane] = -math.log(R - 1.0) / math.log(R)
    return table


@compiled()
def most_steps(n: int) -> int:
    """Largest number of steps per period with n states; the matrices of all steps are in memory."""
    return min(MAX_STEPS, _MATRIX_ENTRIES // (n * n))


@compiled(no_cpython_wrapper=True)
def _norms_of(problem: Problem) -> Norms:
    m = problem.v.size
    v_over_omega = np.zeros(m)
    for q in range(m):  # a loop, for each array expression takes the compiler half a second
        v_over_omega[q] = problem.v[q] / problem.omega[q]
    deflection = norm(v_over_omega)
    return Norms(deflection, norm(problem.v), norm(problem.reference) * deflection)


@compiled(no_cpython_wrapper=True)
def _equation_for(problem: Problem) -> StepEquation:
    m = problem.v.size
    coordinates = max(m, 3)
    w_terms = problem.w.shape[2]
    wd_terms = problem.wd.shape[2]
    lanes = problem.w.shape[3]
    v = np.zeros(coordinates)
    for q in range(m):
        v[q] = problem.v[q]
    return StepEquation(
        h2_w=aligned_rows(w_terms, lanes),
        h_wd=aligned_rows(wd_terms, lanes),
        h2_omega2=np.zeros(coordinates),
        h2_reference=np.zeros(coordinates),
        h_C=np.zeros((coordinates, coordinates)),
        v=v,
        majorant=np.zeros(max(w_terms, wd_terms)),
    )


@compiled(no_cpython_wrapper=True)
def workspace_for(problem: Problem) -> Workspace:
    """Allocate the workspace of one thread."""
    m = problem.v.size
    coordinates = max(m, 3)
    columns = -(-2 * m // LANES) * LANES
    w_terms = problem.w.shape[2]
    wd_terms = problem.wd.shape[2]
    lanes = problem.w.shape[3]
    unit = aligned_rows(columns, columns)
    for i in range(columns):
        unit[i, i] = 1.0
    series = Series(
        eta=aligned_matrices(MAX_TERMS + 2, coordinates, columns),
        deflection=aligned_rows(MAX_TERMS + 2, LANES),
        deflection_rate=aligned_rows(MAX_TERMS + 2, LANES),
        newest_rate=aligned_rows(coordinates, columns),
    )
    return Workspace(
        norms=_norms_of(problem),
        C=np.zeros((m, m)),
        w=aligned_rows(w_terms, lanes),
        wd=aligned_rows(wd_terms, lanes),
        equation=_equation_for(problem),
        series=series,
        radius_table=table_of_radii(max(w_terms, wd_terms)),
        end=aligned_rows(2 * m, columns),
        start=aligned_rows(2 * m, columns),
        matrices=aligned_matrices(2, 2 * m, columns),
        unit=unit,
    )


# What follows runs for every step of every point: no slices and no array expressions, which would allocate.
# _nrt=False: without it every call counts the references of all arrays of its tuples, half of the run time.
# forceinline: a call that is not inlined passes every number of all arrays of its tuples, up to 80 ns.


@inlined
def load_constant_part(problem: Problem, T: float, work: Workspace) -> ConstantPart:
    """Write C + G/T of a point, and bound the constant part of A.

    Gyroscopic terms grow with speed.
    """
    m = problem.v.size
    omega = 0.0
    damping_squares = 0.0
    gyroscopic_squares = 0.0
    for q in range(m):
        omega = max(omega, problem.omega[q])
        for p in range(m):
            damping_squares += problem.C[q, p] ** 2
            gyroscopic_squares += problem.gyroscopic[q, p] ** 2
            work.C[q, p] = problem.C[q, p] + problem.gyroscopic[q, p] / T
    return ConstantPart(
        omega + math.sqrt(damping_squares) + math.sqrt(gyroscopic_squares) / T,
        problem.drive + problem.gyroscopic_drive / T,
        problem.noise + problem.gyroscopic_noise / T,
    )


@inlined
def _row_norm(poly: FloatArray, j: int) -> float:
    """Norm of poly[j], zero beyond its coordinates."""
    squares = zero()
    for c in range(0, poly.shape[1], LANES):
        squares = plus_square(load(poly, (j, c)), squares)
    return math.sqrt(total(squares))


@inlined
def _weighted_sum(
    polys: FloatArray, i: int, degree: int, weights: FloatArray, factor: float, out: FloatArray
) -> None:
    """Out = factor * sum of weights[q] polys[q, i], row by row."""
    for c in range(0, out.shape[1], LANES):
        for j in range(degree + 1):
            row = zero()
            for q in range(weights.size):
                row = plus(factor * weights[q], load(polys, (q, i, j, c)), row)
            store(out, (j, c), row)


@inlined
def _over_part(poly: FloatArray, degree: int, part: int, parts: int, factor: float, out: FloatArray) -> None:
    """Out = factor times poly in the time of one of ``parts`` equal parts of the piece.

    By synthetic division about the middle of the part.
    """
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


@inlined
def load_piece(problem: Problem, i: int, point: Point, constant: ConstantPart, work: Workspace) -> Piece:
    """Write the gains of a point over piece i, the weighted sums of their parts, and bound them."""
    zeta = abs(point.zeta)
    rho = problem.ratios[i]
    deflection = work.norms.deflection
    deflection_rate = work.norms.deflection_rate
    w_degree = problem.degrees[i, W]
    wd_degree = problem.degrees[i, WD]
    _weighted_sum(problem.w, i, w_degree, point.weights, 1.0, work.w)
    if math.isnan(rho):
        _weighted_sum(problem.wd, i, wd_degree, point.weights, point.zeta, work.wd)
    size = constant.size
    misfit = constant.noise
    start_error = 0.0
    end_error = 0.0
    T = point.period
    sizes = problem.sizes
    fit = problem.fit_error
    edge = problem.edge_error
    for q in range(point.weights.size):
        weight = abs(point.weights[q])
        size += weight * (sizes[q, i, W] * deflection + zeta * sizes[q, i, WD] * deflection_rate)
        misfit += weight * (fit[q, i, W] * deflection + fit[q, i, WD] * zeta * deflection_rate)
        start_error += weight * T * (edge[q, i, W] * deflection + edge[q, i, WD] * zeta * deflection_rate)
        end_error += (
            weight * T * (edge[q, i + 1, W] * deflection + edge[q, i + 1, WD] * zeta * deflection_rate)
        )
        if not math.isnan(rho):
            misfit += weight * zeta * problem.unequal[q, i] * deflection_rate
    return Piece(
        length=(problem.phases[i + 1] - problem.phases[i]) * T,
        w_degree=w_degree,
        wd_degree=wd_degree,
        ratio=point.zeta * rho,
        size=size,
        misfit=misfit,
        start_error=start_error,
        end_error=end_error,
    )


@inlined
def load_step(
    problem: Problem, piece: Piece, constant: ConstantPart, part: int, parts: int, h: float, work: Workspace
) -> int:
    """Write the equation of a step of length 2 h, which is one of ``parts`` equal parts of a piece.

    Returns the degree of the majorant.
    """
    m = problem.v.size
    equation = work.equation
    squares = 0.0
    _over_part(work.w, piece.w_degree, part, parts, h * h, equation.h2_w)
    for q in range(m):
        equation.h2_omega2[q] = (h * problem.omega[q]) ** 2
        equation.h2_reference[q] = -h * h * problem.reference[q]
        squares += (equation.h2_w[0, q] + equation.h2_reference[q]) ** 2
        for p in range(m):
            equation.h_C[q, p] = h * work.C[q, p]
    constant_part = h * constant.size + math.sqrt(squares) * work.norms.deflection * (1.0 / h)
    if not math.isnan(piece.ratio):
        return _majorant_of_one_gain(piece, constant_part, h, work.norms, equation)
    _over_part(work.wd, piece.wd_degree, part, parts, h, equation.h_wd)
    return _majorant_of_two_gains(piece, constant_part, h, work.norms, equation)


@inlined
def _majorant_of_one_gain(
    piece: Piece, constant_part: float, h: float, norms: Norms, equation: StepEquation
) -> int:
    """a_j where wd = ratio w; ``constant_part`` is a_0 without wd. Returns the degree."""
    per_h = 1.0 / h
    ratio = abs(piece.ratio)
    majorant = equation.majorant
    majorant[0] = constant_part
    majorant[0] += _row_norm(equation.h2_w, 0) * per_h * ratio * norms.deflection_rate
    for j in range(1, piece.w_degree + 1):
        majorant[j] = _row_norm(equation.h2_w, j) * per_h * (norms.deflection + ratio * norms.deflection_rate)
    return int(piece.w_degree)


@inlined
def _majorant_of_two_gains(
    piece: Piece, constant_part: float, h: float, norms: Norms, equation: StepEquation
) -> int:
    """a_j where wd has no constant ratio to w; ``constant_part`` is a_0 without wd. Returns the degree."""
    per_h = 1.0 / h
    degree = max(piece.w_degree, piece.wd_degree)
    majorant = equation.majorant
    majorant[0] = constant_part
    majorant[0] += _row_norm(equation.h_wd, 0) * norms.deflection_rate
    for j in range(1, degree + 1):
        majorant[j] = 0.0
        if j <= piece.w_degree:
            majorant[j] += _row_norm(equation.h2_w, j) * per_h * norms.deflection
        if j <= piece.wd_degree:
            majorant[j] += _row_norm(equation.h_wd, j) * norms.deflection_rate
    return int(degree)


@compiled(fastmath={"contract"}, _nrt=False, forceinline=True)
def enough_terms(
    majorant: FloatArray, degree: int, log_tolerance: float, table: FloatArray
) -> tuple[int, float]:
    """Degree p after which the neglected terms sum to less than the tolerance, PROVEN; -1 above MAX_TERMS.

    ``table`` is that of `table_of_radii`. The second result is exp(g(1)), the sum of all r_k: a bound on the
    sum of the Taylor terms, which measures rounding.
    """
    constant = table.shape[1] - 1
    by_tolerance = constant - 1
    first = plus(-log_tolerance, load(table, (0, by_tolerance)), load(table, (0, constant)))
    second = plus(-log_tolerance, load(table, (1, by_tolerance)), load(table, (1, constant)))
    exponent = 0.0
    for j in range(degree + 1):
        first = plus(majorant[j], load(table, (0, j)), first)
        second = plus(majorant[j], load(table, (1, j)), second)
        exponent += majorant[j] / (j + 1.0)
    best = least(first, second)
    size = math.exp(exponent)
    if not best <= MAX_TERMS:
        return -1, size
    return max(1, math.ceil(best)), size
