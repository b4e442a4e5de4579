"""Taylor propagation of a rank-one feedback system with a majorant error bound, compiled.

The states are x = (omega eta, eta'), the energy coordinates of `ModalForm`. A step has the length 2 h. In the
time u of the step, |u| <= 1, the equation of motion has the matrix A(u) = sum_j A_j u^j, see `StepEquation`.
The Taylor series starts in the middle of the step. Its sums at u = 1 and u = -1 are the flows E and S from
the middle to the end and to the start. The flow over the step is P = E S^-1.

Proven here: the bound on the error of the flow over a step (`_error_of_step`), and with `carry` the bound on
the error of the monodromy matrix (`propagate_points`). Sources: docs/theory/proven_bounds.md, "The matrix of
a step" and "The product".
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

from floquet.engine.kernels.simd import LANES, aligned_rows, load, plus, scaled, store, zero
from floquet.rank_one.kernels.gains import (
    ConstantPart,
    Limits,
    Piece,
    Point,
    Points,
    Problem,
    Series,
    StepEquation,
    Workspace,
    enough_terms,
    load_constant_part,
    load_piece,
    load_step,
    most_steps,
    workspace_for,
)
from floquet.rank_one.kernels.product import (
    Steps,
    carry,
    divide,
    product_workspace,
    steps_for,
)
from lumped.compiler import compiled, inlined
from lumped.typing import FloatArray, IntArray

#: The same as ``inlined``; a product and a sum may become one instruction with one rounding.
contracted = compiled(fastmath={"contract"}, _nrt=False, forceinline=True, no_cpython_wrapper=True)

_U = 0.5 * 2.220446049250313e-16
_BOUND_SLACK = 1.0 + 1e-6  # covers the rounding of the bound on a step, and of the number of terms above all


class _Three(NamedTuple):
    """Eight columns of each of three coordinates, in registers of the processor."""

    first: Any
    second: Any
    third: Any


@contracted
def _load_three(coefficients: FloatArray, k: int) -> _Three:
    return _Three(load(coefficients, (k, 0)), load(coefficients, (k, 1)), load(coefficients, (k, 2)))


@contracted
def _store_three(coefficients: FloatArray, k: int, x: _Three) -> None:
    store(coefficients, (k, 0), x.first)
    store(coefficients, (k, 1), x.second)
    store(coefficients, (k, 2), x.third)


@contracted
def _dot(row: FloatArray, x: _Three) -> Any:
    """Scalar product of a row of three numbers with x."""
    return plus(row[2], x.third, plus(row[1], x.second, scaled(row[0], x.first)))


@contracted
def _scale_each(factors: FloatArray, x: _Three) -> _Three:
    """Each coordinate of x times a factor."""
    return _Three(scaled(factors[0], x.first), scaled(factors[1], x.second), scaled(factors[2], x.third))


@contracted
def _scale_all(factor: float, x: _Three) -> _Three:
    """All coordinates of x times the same factor."""
    return _Three(scaled(factor, x.first), scaled(factor, x.second), scaled(factor, x.third))


@contracted
def _add_feedback(gain: FloatArray, deflection: Any, total: _Three) -> _Three:
    """Total + gain times the deflection; the gain has three coordinates."""
    return _Three(
        plus(gain[0], deflection, total.first),
        plus(gain[1], deflection, total.second),
        plus(gain[2], deflection, total.third),
    )


@contracted
def _add_power(polynomial: FloatArray, i: int, deflection: Any, total: _Three) -> _Three:
    """Total + coefficient i of the gain times the deflection."""
    return _Three(
        plus(polynomial[i, 0], deflection, total.first),
        plus(polynomial[i, 1], deflection, total.second),
        plus(polynomial[i, 2], deflection, total.third),
    )


@contracted
def _add_row(row: FloatArray, i: int, factor: float, x: _Three, total: Any) -> Any:
    """Total + factor times row i of a matrix times x."""
    partial = plus(factor * row[i, 0], x.first, total)
    partial = plus(factor * row[i, 1], x.second, partial)
    return plus(factor * row[i, 2], x.third, partial)


@contracted
def _add_matrix(matrix: FloatArray, factor: float, x: _Three, total: _Three) -> _Three:
    """Total + factor times a 3 x 3 matrix times x."""
    return _Three(
        _add_row(matrix, 0, factor, x, total.first),
        _add_row(matrix, 1, factor, x, total.second),
        _add_row(matrix, 2, factor, x, total.third),
    )


@contracted
def _add_older(polynomial: FloatArray, degree: int, history: FloatArray, k: int, total: _Three) -> _Three:
    """Total + the convolution of a gain with a series at power k, without the newest value of the series."""
    for i in range(min(degree, k), 0, -1):
        total = _add_power(polynomial, i, load(history, (k - i,)), total)
    return total


@contracted
def _expand_three(equation: StepEquation, piece: Piece, terms: int, h: float, series: Series) -> None:
    """Fill the Taylor coefficients of eta up to power terms + 1, of three coordinates, from those of 0 and 1.

    Power k of the equation of motion gives the coefficient of power k + 2. With wd = ratio w both gains act
    as one gain w on deflection + (ratio/h) deflection rate. All three coordinates stay in registers. The
    newest values come last in every sum, so the sum of the older values need not wait for them.
    """
    one_gain = not math.isnan(piece.ratio)
    lag = piece.ratio / h if one_gain else 0.0
    position = _load_three(series.eta, 0)
    velocity = _load_three(series.eta, 1)
    deflection = _dot(equation.v, position)
    next_deflection = _dot(equation.v, velocity)
    for k in range(terms):
        power = k + 1.0
        rate = scaled(power, next_deflection)
        force = _scale_each(equation.h2_omega2, position)
        force = _add_feedback(equation.h2_reference, deflection, force)
        if one_gain:
            force = _add_older(equation.h2_w, piece.w_degree, series.deflection_rate, k, force)
            rate = plus(lag * power, next_deflection, deflection)
            force = _add_power(equation.h2_w, 0, rate, force)
        else:
            force = _add_older(equation.h2_w, piece.w_degree, series.deflection, k, force)
            force = _add_older(equation.h_wd, piece.wd_degree, series.deflection_rate, k, force)
            force = _add_power(equation.h2_w, 0, deflection, force)
            force = _add_power(equation.h_wd, 0, rate, force)
        store(series.deflection, (k,), deflection)
        store(series.deflection_rate, (k,), rate)
        force = _add_matrix(equation.h_C, power, velocity, force)
        position = velocity
        velocity = _scale_all(-1.0 / (power * (power + 1.0)), force)
        _store_three(series.eta, k + 2, velocity)
        deflection = next_deflection
        next_deflection = _dot(equation.v, velocity)


@contracted
def _convolved(polynomial: FloatArray, degree: int, q: int, history: FloatArray, k: int, total: Any) -> Any:
    """Total + the convolution of coordinate q of a gain with a series at power k."""
    for i in range(min(degree, k), -1, -1):
        total = plus(polynomial[i, q], load(history, (k - i,)), total)
    return total


@compiled(fastmath={"contract"}, _nrt=False, no_cpython_wrapper=True)
def _expand_many(equation: StepEquation, piece: Piece, terms: int, h: float, series: Series) -> None:
    """`_expand_three` for any number of coordinates, eight columns after the other.

    Where both gains act as one, ``series.deflection_rate`` holds deflection + (ratio/h) deflection rate.
    """
    one_gain = not math.isnan(piece.ratio)
    lag = piece.ratio / h if one_gain else 0.0
    m = equation.v.size
    eta = series.eta
    for c in range(0, 2 * m, LANES):
        deflection = zero()
        for q in range(m):
            deflection = plus(equation.v[q], load(eta, (0, q, c)), deflection)
        for k in range(terms):
            power = k + 1.0
            next_deflection = zero()
            for q in range(m):
                velocity = load(eta, (k + 1, q, c))
                next_deflection = plus(equation.v[q], velocity, next_deflection)
                store(series.newest_rate, (q, c), scaled(power, velocity))
            rate = scaled(power, next_deflection)
            if one_gain:
                rate = plus(lag * power, next_deflection, deflection)
            store(series.deflection, (k,), deflection)
            store(series.deflection_rate, (k,), rate)
            factor = -1.0 / (power * (power + 1.0))
            for q in range(m):
                # In one expression: its order decides which product is rounded alone.
                force = plus(
                    equation.h2_reference[q], deflection, scaled(equation.h2_omega2[q], load(eta, (k, q, c)))
                )
                if one_gain:
                    force = _convolved(equation.h2_w, piece.w_degree, q, series.deflection_rate, k, force)
                else:
                    force = _convolved(equation.h2_w, piece.w_degree, q, series.deflection, k, force)
                    force = _convolved(equation.h_wd, piece.wd_degree, q, series.deflection_rate, k, force)
                for p in range(m):
                    force = plus(equation.h_C[q, p], load(series.newest_rate, (p, c)), force)
                store(eta, (k + 2, q, c), scaled(factor, force))
            deflection = next_deflection


@inlined
def _start_at_unit_states(problem: Problem, work: Workspace, h: float) -> None:
    """Unit initial states x = (omega eta, eta') in the first 2m columns: coefficients of powers 0 and 1."""
    m = problem.v.size
    for c in range(0, 2 * m, LANES):
        for q in range(m):
            store(work.series.eta, (0, q, c), scaled(1.0 / problem.omega[q], load(work.unit, (q, c))))
            store(work.series.eta, (1, q, c), scaled(h, load(work.unit, (m + q, c))))


class _PowerSums(NamedTuple):
    """Sums of the even and of the odd powers of a Taylor series at u = 1, and of its derivative."""

    even: Any
    odd: Any
    even_rate: Any
    odd_rate: Any


@contracted
def _power_sums(eta: FloatArray, q: int, c: int, terms: int) -> _PowerSums:
    """Sums of coordinate q in eight columns from c on, smallest terms first.

    The derivative of an odd power is an even power: odd powers of eta give ``even_rate``.
    """
    largest_even = terms + 1 - (terms + 1) % 2
    even = zero()
    odd = zero()
    even_rate = zero()
    odd_rate = zero()
    if largest_even == terms:
        odd = load(eta, (terms + 1, q, c))
        even_rate = scaled(terms + 1.0, odd)
    for k in range(largest_even, 0, -2):
        of_even_power = load(eta, (k, q, c))
        of_odd_power = load(eta, (k - 1, q, c))
        even = plus(1.0, of_even_power, even)
        odd_rate = plus(float(k), of_even_power, odd_rate)
        odd = plus(1.0, of_odd_power, odd)
        even_rate = plus(float(k - 1), of_odd_power, even_rate)
    even = plus(1.0, load(eta, (0, q, c)), even)
    return _PowerSums(even, odd, even_rate, odd_rate)


@contracted
def _sum_at_ends(problem: Problem, terms: int, h: float, work: Workspace) -> None:
    """Energy coordinates at both ends of the step, u = 1 and u = -1."""
    m = problem.v.size
    for c in range(0, 2 * m, LANES):
        for q in range(m):
            sums = _power_sums(work.series.eta, q, c, terms)
            omega = problem.omega[q]
            store(work.end, (q, c), scaled(omega, plus(1.0, sums.odd, sums.even)))
            store(work.start, (q, c), scaled(omega, plus(-1.0, sums.odd, sums.even)))
            store(work.end, (m + q, c), scaled(1.0 / h, plus(1.0, sums.odd_rate, sums.even_rate)))
            store(work.start, (m + q, c), scaled(1.0 / h, plus(-1.0, sums.odd_rate, sums.even_rate)))


class _MajorantSums(NamedTuple):
    """Sums of the majorant of a step.

    Attributes
    ----------
    degree : of the majorant
    total : sum of a_j
    by_modulus : sum of a_j/(j + 1) with the constant part of the gain and the reference added by modulus
    exponential : bound on exp(sum of a_j/(j + 1)), the sum of the norms of all Taylor terms
    """

    degree: int
    total: float
    by_modulus: float
    exponential: float


@inlined
def _majorant_sums(work: Workspace, degree: int, h: float, exponential: float) -> _MajorantSums:
    total = 0.0
    by_modulus = 2.0 * h * work.norms.reference
    for j in range(degree + 1):
        total += work.equation.majorant[j]
        by_modulus += work.equation.majorant[j] / (j + 1.0)
    return _MajorantSums(degree, total, by_modulus, exponential)


@inlined
def _rounding_of_ends(m: int, piece: Piece, sums: _MajorantSums) -> float:
    """Bound on the rounding of the flows to both ends: sqrt(2m) u e^g(1) (N g~ + sum a_j + 10).

    Each coefficient goes through at most N roundings of the sum of the moduli of its terms. The errors grow
    along the recurrence like its solution. The last two terms are the sums at both ends.
    """
    gain_degrees = piece.w_degree + (piece.wd_degree if math.isnan(piece.ratio) else 0)
    roundings = gain_degrees + 2.0 * max(m, 3) + 14.0
    return _U * math.sqrt(2.0 * m) * sums.exponential * (roundings * sums.by_modulus + sums.total + 10.0)


@inlined
def _misfit_of_part(piece: Piece, part: int, parts: int, h: float) -> float:
    """Bound on the integral of the error of A over one of ``parts`` steps of a piece.

    A further error at an end of the piece acts in the step at that end, not in all steps alike.
    """
    misfit = 2.0 * h * piece.misfit
    if part == 0:
        misfit += piece.start_error
    if part == parts - 1:
        misfit += piece.end_error
    return misfit


@inlined
def _growth_of_half(constant: ConstantPart, sums: _MajorantSums, h: float) -> float:
    """Bound on the factor by which half of a step lets a state grow, in either direction of time.

    The skew part of A and damping do not let the energy grow; what is left of the majorant lets it grow at
    most.
    """
    return math.exp(sums.total + h * (constant.drive - constant.size)) * (1.0 + 1e-12)


@inlined
def _error_of_step(size: float, residual: float, error_of_ends: float, misfit: float, growth: float) -> float:
    """PROVEN bound on the error of the flow P over a step, in the 2-norm.

    Parameters
    ----------
    size, residual : |P| and a bound on |P S - E|
    error_of_ends : bound d on the errors of E and S by truncation and rounding
    misfit : bound on the integral of the error of A over the step
    growth : bound on |S^-1|
    """
    error = (residual + (1.0 + size) * error_of_ends) * growth * _BOUND_SLACK
    exp_of_misfit = 1.0 + 2.0 * misfit if misfit < 1.0 else math.exp(misfit)  # exp(misfit) at least
    return error + misfit * (growth * growth * exp_of_misfit)


@inlined
def _expand(problem: Problem, piece: Piece, terms: int, h: float, work: Workspace) -> None:
    """Taylor series of a step, and its sums at both ends."""
    _start_at_unit_states(problem, work, h)
    if problem.v.size <= 3:
        _expand_three(work.equation, piece, terms, h, work.series)
    else:
        _expand_many(work.equation, piece, terms, h, work.series)
    _sum_at_ends(problem, terms, h, work)


@inlined
def _steps_of_piece(
    problem: Problem, piece: Piece, constant: ConstantPart, limits: Limits, work: Workspace, first: int,
    steps: Steps,
) -> int:  # fmt: skip
    """Write the steps of one piece from index ``first`` on; the number of steps, -1 if they are too many."""
    log_tolerance = math.log(limits.tolerance)
    parts = max(1, math.ceil(0.5 * piece.length * piece.size / limits.angle))
    part = 0
    while part < parts:
        if first + parts > steps.errors.size:
            return -1
        h = 0.5 * piece.length / parts
        degree = load_step(problem, piece, constant, part, parts, h, work)
        terms, exponential = enough_terms(work.equation.majorant, degree, log_tolerance, work.radius_table)
        if terms < 0:
            # The polynomials vary too much within the step: begin the piece again with half of the step.
            part = 0
            parts *= 2
            continue
        _expand(problem, piece, terms, h, work)
        k = first + part
        size, residual = divide(work.end, work.start, work.unit, work.matrices, steps.matrices[k])
        sums = _majorant_sums(work, degree, h, exponential)
        error_of_ends = limits.tolerance + _rounding_of_ends(problem.v.size, piece, sums)
        misfit = _misfit_of_part(piece, part, parts, h)
        growth = _growth_of_half(constant, sums, h)
        steps.errors[k] = _error_of_step(size, residual, error_of_ends, misfit, growth)
        steps.sizes[k] = size
        part += 1
    return parts


@inlined
def steps_of_period(problem: Problem, point: Point, limits: Limits, work: Workspace, steps: Steps) -> int:
    """Write all steps of one period at one point, and bounds on the errors of the steps.

    Returns the number of steps; -1 if a period would take more steps than there is memory for, or a step more
    than MAX_TERMS.
    """
    count = 0
    constant = load_constant_part(problem, point.period, work)
    for i in range(problem.phases.size - 1):
        piece = load_piece(problem, i, point, constant, work)
        in_piece = _steps_of_piece(problem, piece, constant, limits, work, count, steps)
        if in_piece < 0:
            return -1
        count += in_piece
    return count


class RecordedSteps(NamedTuple):
    """The steps of the last point, for those who ask; with room for none, nothing is recorded.

    Attributes
    ----------
    matrices : (most, n, n) computed flows over the steps, the first step first; or (0, n, n)
    errors : (most,) bounds on the 2-norms of their errors
    sizes : (most,) their Frobenius norms
    number : (1,) of steps
    """

    matrices: FloatArray
    errors: FloatArray
    sizes: FloatArray
    number: IntArray


@inlined
def _record(steps: Steps, count: int, recorded: RecordedSteps) -> None:
    """Copy the steps of a point, without the columns that fill up the lanes."""
    n = recorded.matrices.shape[1]
    recorded.number[0] = count
    for k in range(count):
        recorded.errors[k] = steps.errors[k]
        recorded.sizes[k] = steps.sizes[k]
        for i in range(n):
            for j in range(n):
                recorded.matrices[k, i, j] = steps.matrices[k, i, j]


@compiled(nogil=True)
def propagate_points(
    problem: Problem,
    points: Points,
    limits: Limits,
    M: FloatArray,
    bound: FloatArray,
    recorded: RecordedSteps,
) -> int:
    """Monodromy matrices M (N, 2m, 2m) in x = (omega eta, eta') of N points.

    ``bound`` (N,) receives PROVEN bounds on the Frobenius norms of the errors of the matrices, ``recorded``
    the steps of the last point.

    Returns the index of the first point that needs more than ``most_steps`` or MAX_TERMS; -1: there is none.
    """
    work = workspace_for(problem)
    n = 2 * problem.v.size
    lanes = work.unit.shape[0]
    most = most_steps(n)
    steps = steps_for(most, n, lanes)
    product_work = product_workspace(most, n, lanes)
    flow = aligned_rows(n, lanes)
    for k in range(points.periods.size):
        point = Point(points.weights[k], points.zeta[k], points.periods[k])
        count = steps_of_period(problem, point, limits, work, steps)
        if count < 0:
            return k
        bound[k] = carry(steps, count, product_work, flow)
        for i in range(n):
            for j in range(n):
                M[k, i, j] = flow[i, j]
        if k == points.periods.size - 1 and recorded.errors.size > 0:
            _record(steps, count, recorded)
    return -1
