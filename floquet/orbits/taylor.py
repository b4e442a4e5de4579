"""Taylor coefficients of a system between two events, and the longest step at which the series are exact.

The coefficients of order j + 1 follow from the coefficients of order j, of the state and of all its
derivatives at once. In every loop the columns are innermost: they are contiguous in memory, and the processor
takes several of them in one instruction.

Sources: docs/theory/orbits.md, "Propagation"; step size from the last two terms: Jorba and Zou, Experimental
Mathematics 14 (2005) 99.
"""

from __future__ import annotations

from floquet.orbits.polynomials import shift
from floquet.orbits.records import (
    ABSENT,
    BY_PARAMETER,
    BY_PERIOD,
    CLOSED,
    ContactLaws,
    LinearPart,
    Request,
    Series,
)
from lumped.compiler import inlined
from lumped.typing import FloatArray, IntArray


@inlined
def shift_laws(table: ContactLaws, piece: int, phase: float, states: IntArray, laws: ContactLaws) -> None:
    """Laws of the present contacts as polynomials from the start of the step.

    The step starts ``phase`` after its piece.

    The recursion multiplies laws by series, so that both must be polynomials from the same phase.
    """
    for i in range(states.size):
        if states[i] == ABSENT:
            continue
        shift(table.stiffness[piece, i], phase, laws.stiffness[i])
        shift(table.damping[piece, i], phase, laws.damping[i])
        shift(table.clearance[piece, i], phase, laws.clearance[i])
        shift(table.clearance_rate[piece, i], phase, laws.clearance_rate[i])
        shift(table.sign_by_penetration[piece, i], phase, laws.sign_by_penetration[i])
        shift(table.sign_by_rate[piece, i], phase, laws.sign_by_rate[i])
        for r in range(table.acceleration.shape[2]):
            shift(table.acceleration[piece, i, r], phase, laws.acceleration[i, r])


@inlined
def taylor_coefficients(
    series: Series, laws: ContactLaws, states: IntArray, direction: FloatArray, linear: LinearPart,
    request: Request,
) -> None:  # fmt: skip
    """Fill the series of the step from order 0 of z and v, with the contacts in their present states."""
    for j in range(request.order + 1):
        if j < request.order:
            _displacement(series, j)
        for i in range(states.size):
            if states[i] == ABSENT:
                continue
            _penetration(series, laws, direction, i, j)
            if states[i] == CLOSED and j < request.order:
                _load(series, laws, request, i, j)
        if j == request.order:
            break
        for r in range(series.v.shape[1]):
            _linear_acceleration(series, linear, request, r, j)
            for i in range(states.size):
                if states[i] == CLOSED:
                    _contact_acceleration(series, laws, i, r, j)
            for q in range(series.v.shape[2]):
                series.v[j + 1, r, q] /= j + 1


@inlined
def _displacement(series: Series, j: int) -> None:
    """z_(j+1) = v_j/(j+1)."""
    for p in range(series.z.shape[1]):
        for q in range(series.z.shape[2]):
            series.z[j + 1, p, q] = series.v[j, p, q] / (j + 1)


@inlined
def _penetration(series: Series, laws: ContactLaws, direction: FloatArray, i: int, j: int) -> None:
    """Penetration d = u . z - e and d' = u . v - e' of contact i."""
    d = series.penetration
    rate = series.penetration_rate
    for q in range(d.shape[2]):
        d[i, j, q] = direction[i, 0] * series.z[j, 0, q]
        rate[i, j, q] = direction[i, 0] * series.v[j, 0, q]
    for p in range(1, series.z.shape[1]):
        u = direction[i, p]
        for q in range(d.shape[2]):
            d[i, j, q] += u * series.z[j, p, q]
            rate[i, j, q] += u * series.v[j, p, q]
    if j < laws.clearance.shape[1]:
        d[i, j, 0] -= laws.clearance[i, j]
    if j < laws.clearance_rate.shape[1]:
        rate[i, j, 0] -= laws.clearance_rate[i, j]


@inlined
def _load(series: Series, laws: ContactLaws, request: Request, i: int, j: int) -> None:
    """T^2 N = T^2 k d + T c d' of contact i; the derivative by T has 2 T k d + c d' as well."""
    T = request.period
    d = series.penetration
    rate = series.penetration_rate
    load = series.load
    for q in range(load.shape[2]):
        load[i, j, q] = 0.0
    for p in range(min(j + 1, laws.stiffness.shape[1])):
        k = laws.stiffness[i, p]
        c = laws.damping[i, p]
        if T * T * k == 0.0 and T * c == 0.0:
            continue
        for q in range(load.shape[2]):
            load[i, j, q] += T * T * k * d[i, j - p, q] + T * c * rate[i, j - p, q]
        if request.derivatives:
            load[i, j, BY_PERIOD] += 2.0 * T * k * d[i, j - p, 0] + c * rate[i, j - p, 0]


@inlined
def _linear_acceleration(series: Series, linear: LinearPart, request: Request, r: int, j: int) -> None:
    """Row r of T^2 (F + p H - K z) - T C v, as (j + 1) v_(j+1); F + p H has order 0 alone."""
    T = request.period
    z = series.z
    v = series.v
    for q in range(v.shape[2]):
        v[j + 1, r, q] = 0.0
    for p in range(z.shape[1]):
        K = linear.stiffness[r, p]
        C = linear.damping[r, p]
        if T * T * K == 0.0 and T * C == 0.0:
            continue
        for q in range(v.shape[2]):
            v[j + 1, r, q] -= T * T * K * z[j, p, q] + T * C * v[j, p, q]
        if request.derivatives:
            v[j + 1, r, BY_PERIOD] -= 2.0 * T * K * z[j, p, 0] + C * v[j, p, 0]
    if j == 0:
        force = linear.force[r] + request.parameter * linear.parameter_force[r]
        v[1, r, 0] += T * T * force
        if request.derivatives:
            v[1, r, BY_PERIOD] += 2.0 * T * force
            v[1, r, BY_PARAMETER] += T * T * linear.parameter_force[r]


@inlined
def _contact_acceleration(series: Series, laws: ContactLaws, i: int, r: int, j: int) -> None:
    """Row r of a T^2 N of contact i."""
    for p in range(min(j + 1, laws.acceleration.shape[2])):
        a = laws.acceleration[i, r, p]
        if a == 0.0:
            continue
        for q in range(series.v.shape[2]):
            series.v[j + 1, r, q] += a * series.load[i, j - p, q]


@inlined
def step_size(series: Series, request: Request, longest: float) -> float:
    """Longest step whose last two terms are below the tolerance, each column relative to its own size."""
    order = request.order
    step = longest
    for q in range(series.z.shape[2]):
        size = max(_largest(series.v[0, :, q]), _largest(series.z[0, :, q]))
        last = max(_largest(series.v[order, :, q]), _largest(series.z[order, :, q]))
        last_but_one = max(_largest(series.v[order - 1, :, q]), _largest(series.z[order - 1, :, q]))
        if size == 0.0:
            size = max(last, last_but_one)  # starts from rest: the first steps are by the forcing alone
        if last > 0.0:
            step = min(step, (request.tolerance * size / last) ** (1.0 / order))
        if last_but_one > 0.0:
            step = min(step, (request.tolerance * size / last_but_one) ** (1.0 / (order - 1)))
    return step


@inlined
def _largest(coefficients: FloatArray) -> float:
    """Largest absolute value."""
    largest = 0.0
    for one in coefficients:
        largest = max(largest, abs(one))
    return largest


@inlined
def move_to_end(series: Series, step: float) -> None:
    """State and derivatives at the end of the step, as order 0 of the next one.

    Horner's scheme in place, all columns of an order at once.
    """
    z = series.z
    v = series.v
    for j in range(z.shape[0] - 1, 0, -1):
        for p in range(z.shape[1]):
            for q in range(z.shape[2]):
                z[j - 1, p, q] += step * z[j, p, q]
        for r in range(v.shape[1]):
            for q in range(v.shape[2]):
                v[j - 1, r, q] += step * v[j, r, q]
