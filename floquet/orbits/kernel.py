"""Propagation of a system with unilateral contacts by Taylor series, from event to event, compiled.

`propagate` is the loop over cycles, pieces of a cycle and steps. What a step does is in
`floquet.orbits.taylor` (series, length and end of a step) and `floquet.orbits.events` (changes of contacts).
The functions whose zeros are events are polynomials on a step. The step is cut at an event by evaluating the
polynomials there; nothing is integrated again.

Sources: docs/theory/orbits.md, "Propagation".
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from floquet.orbits.events import change_states, find_crossings, states_from_motion
from floquet.orbits.polynomials import extremes, value
from floquet.orbits.records import (
    CLOSED,
    FINISHED,
    GREW,
    MOST_EVENTS,
    TOO_MANY_EVENTS,
    Record,
    Request,
    Series,
    SystemTables,
    new_contacts,
    new_laws,
    new_series,
)
from floquet.orbits.taylor import move_to_end, shift_laws, step_size, taylor_coefficients
from lumped.compiler import called, compiled, inlined
from lumped.typing import FloatArray, IntArray

_GAUSS_NODES, _GAUSS_WEIGHTS = (np.ascontiguousarray(a) for a in np.polynomial.legendre.leggauss(12))
#: Phase that is rounding: a step that ends this near to the end of its piece ends there.
_NO_PHASE = 1e-15


@compiled(nogil=True)
def propagate(start: FloatArray, request: Request, system: SystemTables, record: Record) -> int:
    """Propagate from ``start``, (z, v) at phase 0, over whole cycles into the record.

    Returns FINISHED, GREW or TOO_MANY_EVENTS; the record is complete where it is FINISHED.
    """
    series = new_series(system, request.order, record.end.shape[1])
    laws = new_laws(system.laws)
    contacts = new_contacts(system.laws, request.order)
    polynomial = np.empty(request.order + 1)
    _set_start(series, start, request)
    _clear(record.summary)
    states = contacts.states
    phases = system.phases
    for cycle in range(request.cycles):
        record.summary.samples_in_cycle = 0
        for piece in range(phases.size - 1):
            phase = phases[piece]
            end = phases[piece + 1]
            states_from_motion(series, system, piece, request.period, states)
            while phase < end:
                shift_laws(system.laws, piece, phase - phases[piece], states, laws)
                taylor_coefficients(series, laws, states, system.direction, system.linear, request)
                longest = step_size(series, request, end - phase)
                if not longest > 0.0:
                    return GREW
                first_event = find_crossings(series, laws, request.period, longest, contacts)
                step = min(longest, first_event)
                _add_output(series.z, system.output, step, polynomial, record.summary)
                _add_loads(series.load, states, step, polynomial, record.summary)
                _take_samples(series, states, request, cycle, phase, step, record)
                move_to_end(series, step)
                if not math.isfinite(series.v[0, 0, 0]):
                    return GREW
                if first_event <= longest:
                    change_states(
                        series, laws, system.direction, request, step, cycle + phase + step, contacts, record
                    )
                    if record.summary.events > MOST_EVENTS * request.cycles:
                        return TOO_MANY_EVENTS
                phase = end if end - (phase + step) <= _NO_PHASE else phase + step
    _finish(series, request, record)
    return FINISHED


@called
def _set_start(series: Series, start: FloatArray, request: Request) -> None:
    """State (z, v) at phase 0, and the unit matrix as its derivative by itself."""
    m = series.z.shape[1]
    for p in range(m):
        series.z[0, p, 0] = start[p]
        series.v[0, p, 0] = start[m + p]
        if request.derivatives:
            series.z[0, p, 1 + p] = 1.0
            series.v[0, p, 1 + m + p] = 1.0


@called
def _clear(summary: Any) -> None:
    """Sums start at zero, extremes beyond all numbers."""
    summary.output_mean = 0.0
    summary.output_mean_square = 0.0
    summary.least_output = math.inf
    summary.most_output = -math.inf
    summary.largest_load = 0.0
    summary.least_load = math.inf
    summary.events = 0


@inlined
def _add_output(z: FloatArray, output: FloatArray, step: float, polynomial: FloatArray, summary: Any) -> None:
    """Integrals of y and y^2 over the step by Gauss's 12 points, and extremes of y = output . z."""
    for g in range(_GAUSS_NODES.size):
        place = 0.5 * step * (1.0 + _GAUSS_NODES[g])
        y = 0.0
        for p in range(z.shape[1]):
            y += output[p] * value(z[:, p, 0], place)
        weight = 0.5 * step * _GAUSS_WEIGHTS[g]
        summary.output_mean += weight * y
        summary.output_mean_square += weight * y * y
    for j in range(polynomial.size):
        polynomial[j] = 0.0
        for p in range(z.shape[1]):
            polynomial[j] += output[p] * z[j, p, 0]
    least, most = extremes(polynomial, step, summary.least_output, summary.most_output)
    summary.least_output = least
    summary.most_output = most


@inlined
def _add_loads(load: FloatArray, states: IntArray, step: float, polynomial: FloatArray, summary: Any) -> None:
    """Largest load of one contact, and least load of all contacts together, on the step; times T^2."""
    for i in range(states.size):
        if states[i] == CLOSED:
            for j in range(polynomial.size):
                polynomial[j] = load[i, j, 0]
            summary.largest_load = extremes(polynomial, step, -math.inf, summary.largest_load)[1]
    polynomial[:] = 0.0
    for i in range(states.size):
        if states[i] == CLOSED:
            for j in range(
                polynomial.size - 1
            ):  # the last coefficient of a load is 0, see taylor_coefficients
                polynomial[j] += load[i, j, 0]
    summary.least_load = extremes(polynomial, step, summary.least_load, math.inf)[0]


@called
def _take_samples(
    series: Series, states: IntArray, request: Request, cycle: int, phase: float, step: float, record: Record
) -> None:
    """State and loads at the samples in [phase, phase + step)."""
    m = series.z.shape[1]
    samples = request.samples
    taken = record.summary.samples_in_cycle
    while taken < samples.size and samples[taken] < phase + step:
        place = samples[taken] - phase
        row = cycle * samples.size + taken
        for p in range(m):
            record.states[row, p] = value(series.z[:, p, 0], place)
            record.states[row, m + p] = value(series.v[:, p, 0], place)
        for i in range(states.size):
            record.loads[row, i] = 0.0
            if states[i] == CLOSED:
                load = value(series.load[i, : request.order, 0], place)
                record.loads[row, i] = load / (request.period * request.period)
        taken += 1
    record.summary.samples_in_cycle = taken


@called
def _finish(series: Series, request: Request, record: Record) -> None:
    """Means from integrals, loads from T^2 N, and the end of the motion."""
    summary = record.summary
    summary.output_mean /= request.cycles
    summary.output_mean_square /= request.cycles
    summary.largest_load /= request.period * request.period
    summary.least_load /= request.period * request.period
    m = series.z.shape[1]
    for q in range(record.end.shape[1]):
        for p in range(m):
            record.end[p, q] = series.z[0, p, q]
        for r in range(series.v.shape[1]):
            record.end[m + r, q] = series.v[0, r, q]
