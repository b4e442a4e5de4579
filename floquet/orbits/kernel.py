"""Taylor propagation of a system with unilateral contacts, with its events and its derivatives, compiled.

The Taylor coefficients of the state and of its derivatives follow from one recursion, and the functions whose
zeros are events are polynomials of the step, which is cut at an event by evaluating them there.

Sources: docs/theory/orbits.md, "Propagation" and "Jump matrices"; step size from the last two terms: Jorba
and Zou, Experimental Mathematics 14 (2005) 99.
"""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt

from floquet.orbits.polynomials import crossing, extremes, shift, slope, value
from lumped.compiler import compiled
from lumped.typing import FloatArray

#: What a contact does: it carries load, its flanks still overlap but would pull, or there is a gap.
GAP = 0
RECOVERING = 1
CLOSED = 2
_GAUSS_NODES, _GAUSS_WEIGHTS = (np.ascontiguousarray(a) for a in np.polynomial.legendre.leggauss(12))


@compiled(nogil=True)
def _series(
    z: FloatArray, v: FloatArray, load: FloatArray, d: FloatArray, w: FloatArray,
    order: int, state: npt.NDArray[np.int64],
    k: FloatArray, c: FloatArray, e: FloatArray, b: FloatArray, a: FloatArray, u: FloatArray,
    K: FloatArray, C: FloatArray, F: FloatArray, H: FloatArray, T: float, parameter: float, columns: int,
) -> None:  # fmt: skip
    """Fill the Taylor coefficients; z (R+1, m, q), v (R+1, n, q) with order 0 given, q the columns.

    d, w (I, R+1, q) are penetration and its damper's rate, load (I, R+1, q) is T^2 N of closed contacts.
    Column 0 is the state, the last but one its derivative by T, the last by the parameter.
    """
    n, m = K.shape
    contacts = u.shape[0]
    for j in range(order + 1):
        if j < order:
            for i in range(m):
                for q in range(columns):
                    z[j + 1, i, q] = v[j, i, q] / (j + 1)
        for i in range(contacts):
            if state[i] < 0:
                continue
            for q in range(columns):
                d[i, j, q] = u[i, 0] * z[j, 0, q]
                w[i, j, q] = u[i, 0] * v[j, 0, q]
            for p in range(1, m):
                x = u[i, p]
                for q in range(columns):
                    d[i, j, q] += x * z[j, p, q]
                    w[i, j, q] += x * v[j, p, q]
            if j < e.shape[1]:
                d[i, j, 0] -= e[i, j]
            if j < b.shape[1]:
                w[i, j, 0] -= b[i, j]
            if state[i] != CLOSED or j == order:
                continue
            for q in range(columns):
                load[i, j, q] = 0.0
            for p in range(min(j + 1, k.shape[1])):
                x = T * T * k[i, p]
                y = T * c[i, p]
                if x == 0.0 and y == 0.0:
                    continue
                for q in range(columns):
                    load[i, j, q] += x * d[i, j - p, q] + y * w[i, j - p, q]
                if columns > 1:  # by T itself
                    load[i, j, columns - 2] += 2.0 * T * k[i, p] * d[i, j - p, 0] + c[i, p] * w[i, j - p, 0]
        if j == order:
            break
        for r in range(n):
            for q in range(columns):
                v[j + 1, r, q] = 0.0
            for p in range(m):
                x = T * T * K[r, p]
                y = T * C[r, p]
                if x == 0.0 and y == 0.0:
                    continue
                for q in range(columns):
                    v[j + 1, r, q] -= x * z[j, p, q] + y * v[j, p, q]
                if columns > 1:
                    v[j + 1, r, columns - 2] -= 2.0 * T * K[r, p] * z[j, p, 0] + C[r, p] * v[j, p, 0]
            if j == 0:
                v[1, r, 0] += T * T * (F[r] + parameter * H[r])
                if columns > 1:
                    v[1, r, columns - 2] += 2.0 * T * (F[r] + parameter * H[r])
                    v[1, r, columns - 1] += T * T * H[r]
            for i in range(contacts):
                if state[i] == CLOSED:
                    for p in range(min(j + 1, a.shape[2])):
                        x = a[i, r, p]
                        if x == 0.0:
                            continue
                        for q in range(columns):
                            v[j + 1, r, q] += x * load[i, j - p, q]
            for q in range(columns):
                v[j + 1, r, q] /= j + 1


@compiled(nogil=True)
def _step_size(z: FloatArray, v: FloatArray, order: int, columns: int, tolerance: float, h: float) -> float:
    """Largest step up to h whose last two terms are below the tolerance, each column by its own size."""
    n, m = v.shape[1], z.shape[1]
    for q in range(columns):
        size = 0.0
        last = 0.0
        before = 0.0
        for r in range(n):
            size = max(size, abs(v[0, r, q]))
            last = max(last, abs(v[order, r, q]))
            before = max(before, abs(v[order - 1, r, q]))
        for r in range(m):
            size = max(size, abs(z[0, r, q]))
            last = max(last, abs(z[order, r, q]))
            before = max(before, abs(z[order - 1, r, q]))
        if size == 0.0:
            size = max(last, before)  # starts from rest: the first steps are by the forcing alone
        if last > 0.0:
            h = min(h, (tolerance * size / last) ** (1.0 / order))
        if before > 0.0:
            h = min(h, (tolerance * size / before) ** (1.0 / (order - 1)))
    return h


@compiled(nogil=True)
def _watched(
    alpha: FloatArray, beta: FloatArray, d: FloatArray, w: FloatArray, T: float, out: FloatArray
) -> None:
    """Series of alpha d + beta w / T, which has the sign of the load."""
    for j in range(out.size):
        out[j] = 0.0
    for p in range(alpha.size):
        if alpha[p] != 0.0 or beta[p] != 0.0:
            for j in range(min(d.size, out.size - p)):
                out[j + p] += alpha[p] * d[j] + beta[p] / T * w[j]


@compiled(nogil=True)
def propagate(
    x: FloatArray, T: float, parameter: float, cycles: int, derivatives: bool, order: int, tolerance: float,
    phases: FloatArray, present: npt.NDArray[np.bool_],
    k: FloatArray, c: FloatArray, e: FloatArray, b: FloatArray, alpha: FloatArray, beta: FloatArray,
    a: FloatArray, u: FloatArray, K: FloatArray, C: FloatArray, F: FloatArray, H: FloatArray,
    output: FloatArray,
    samples: FloatArray, sampled: FloatArray, loads: FloatArray,
    log: FloatArray, totals: FloatArray, final: FloatArray,
) -> int:  # fmt: skip
    """Propagate over whole cycles from phase 0; phase derivatives throughout, v = dz/dtau.

    ``x`` is (z, v) at the start, ``derivatives`` says whether the columns by x, T and the parameter travel
    along, ``phases`` to ``output`` are of `ContactSystem`. Out: ``sampled`` (cycles S, 2m) and ``loads``
    (cycles S, I) at the ``samples``; ``log`` (L, 3), phase in cycles, contact, new state of each event;
    ``totals`` (6,), integrals of y = output . z and y^2 over the phase, smallest and largest y, largest load
    of a contact, smallest of all together; ``final`` (m + n, 1 or 2m + 3), z and v at the end.

    Returns the number of events, or -1 where more than 1000 a cycle happen or a number is not finite.
    """
    n, m = K.shape
    contacts = u.shape[0]
    pieces = phases.size - 1
    columns = 2 * m + 3 if derivatives else 1
    width = k.shape[2]
    z = np.zeros((order + 1, m, columns))
    v = np.zeros((order + 1, n, columns))
    shape = (contacts, order + 1, columns)
    load = np.zeros(shape)
    d = np.zeros(shape)
    w = np.zeros(shape)
    kk = np.zeros((contacts, width))
    cc = np.zeros((contacts, width))
    ee = np.zeros((contacts, width))
    bb = np.zeros((contacts, width))
    al = np.zeros((contacts, width))
    be = np.zeros((contacts, width))
    aa = np.zeros((contacts, n, a.shape[3]))
    watch = np.zeros((contacts, order + width))
    depth = np.zeros((contacts, order + 1))
    turns = np.zeros(contacts)
    series = np.zeros(order + 1)
    push = np.zeros(order + 1)
    state = np.empty(contacts, np.int64)
    for i in range(m):
        z[0, i, 0] = x[i]
        v[0, i, 0] = x[m + i]
        if derivatives:
            z[0, i, 1 + i] = 1.0
            v[0, i, 1 + m + i] = 1.0
    totals[:] = 0.0
    totals[2] = math.inf
    totals[3] = -math.inf
    totals[5] = math.inf
    events = 0
    for cycle in range(cycles):
        at = 0
        for piece in range(pieces):
            tau = phases[piece]
            end = phases[piece + 1]
            fresh = True
            while tau < end:
                local = tau - phases[piece]
                for i in range(contacts):
                    if not present[piece, i]:
                        state[i] = -1
                        continue
                    shift(k[piece, i], local, kk[i])
                    shift(c[piece, i], local, cc[i])
                    shift(e[piece, i], local, ee[i])
                    shift(b[piece, i], local, bb[i])
                    shift(alpha[piece, i], local, al[i])
                    shift(beta[piece, i], local, be[i])
                    for r in range(n):
                        shift(a[piece, i, r], local, aa[i, r])
                    if fresh:  # the state of a contact follows from the motion alone
                        gap = -ee[i, 0]
                        rate = -bb[i, 0]
                        for p in range(m):
                            gap += u[i, p] * z[0, p, 0]
                            rate += u[i, p] * v[0, p, 0]
                        if gap <= 0.0:
                            state[i] = GAP
                        elif al[i, 0] * gap + be[i, 0] * rate / T > 0.0:
                            state[i] = CLOSED
                        else:
                            state[i] = RECOVERING
                fresh = False
                _series(
                    z, v, load, d, w, order, state, kk, cc, ee, bb, aa, u, K, C, F, H, T, parameter, columns
                )
                h = _step_size(z, v, order, columns, tolerance, end - tau)
                if not h > 0.0:
                    return -1
                # Where the first contact changes its state.
                cut = 2.0 * h
                for i in range(contacts):
                    turns[i] = 2.0 * h
                    if state[i] < 0:
                        continue
                    for j in range(order + 1):
                        depth[i, j] = d[i, j, 0]
                    if state[i] == GAP:
                        turns[i] = crossing(depth[i], h, -1.0)
                    else:
                        _watched(al[i], be[i], depth[i], w[i, :, 0], T, watch[i])
                        turns[i] = min(
                            crossing(depth[i], h, 1.0),
                            crossing(watch[i], h, 1.0 if state[i] == CLOSED else -1.0),
                        )
                    cut = min(cut, turns[i])
                step = min(h, cut)
                # Time means of the output, extremes of it and of the loads.
                for g in range(_GAUSS_NODES.size):
                    s = 0.5 * step * (1.0 + _GAUSS_NODES[g])
                    y = 0.0
                    for p in range(m):
                        inner = 0.0
                        for j in range(order, -1, -1):
                            inner = inner * s + z[j, p, 0]
                        y += output[p] * inner
                    totals[0] += 0.5 * step * _GAUSS_WEIGHTS[g] * y
                    totals[1] += 0.5 * step * _GAUSS_WEIGHTS[g] * y * y
                for j in range(order + 1):
                    series[j] = 0.0
                    for p in range(m):
                        series[j] += output[p] * z[j, p, 0]
                totals[2], totals[3] = extremes(series, step, totals[2], totals[3])
                series[:] = 0.0
                for i in range(contacts):
                    if state[i] == CLOSED:
                        for j in range(order + 1):
                            push[j] = load[i, j, 0]
                        for j in range(order):
                            series[j] += load[i, j, 0]
                        totals[4] = extremes(push, step, -math.inf, totals[4])[1]
                totals[5] = extremes(series, step, totals[5], math.inf)[0]
                # Samples in [tau, tau + step).
                last = tau + step
                while at < samples.size and samples[at] < last:
                    s = samples[at] - tau
                    row = cycle * samples.size + at
                    for p in range(m):
                        inner = 0.0
                        other = 0.0
                        for j in range(order, -1, -1):
                            inner = inner * s + z[j, p, 0]
                            other = other * s + v[j, p, 0]
                        sampled[row, p] = inner
                        sampled[row, m + p] = other
                    for i in range(contacts):
                        loads[row, i] = (
                            _load(load[i, :, 0], order, s) / (T * T) if state[i] == CLOSED else 0.0
                        )
                    at += 1
                # To the end of the step: Horner's scheme in place, all columns of an order at once.
                for j in range(order, 0, -1):
                    for p in range(m):
                        for q in range(columns):
                            z[j - 1, p, q] += step * z[j, p, q]
                    for r in range(n):
                        for q in range(columns):
                            v[j - 1, r, q] += step * v[j, r, q]
                if not math.isfinite(v[0, 0, 0]):
                    return -1
                if cut <= h:
                    for i in range(contacts):
                        if state[i] < 0 or turns[i] > cut * (1.0 + 1e-14):
                            continue
                        rate = value(w[i, :, 0], cut)
                        closing = slope(depth[i], cut)
                        if state[i] == GAP:
                            new = CLOSED if rate > 0.0 or value(be[i], cut) == 0.0 else RECOVERING
                        elif abs(turns[i] - crossing(depth[i], h, 1.0)) <= 1e-14 * cut:
                            new = GAP
                        else:
                            new = RECOVERING if state[i] == CLOSED else CLOSED
                        if (
                            derivatives
                            and (new == GAP) != (state[i] == GAP)
                            and RECOVERING not in (new, state[i])
                        ):
                            _jump(
                                z,
                                v,
                                i,
                                u,
                                value(cc[i], cut),
                                rate,
                                closing,
                                aa[i],
                                cut,
                                T,
                                columns,
                                new == CLOSED,
                            )
                        state[i] = new
                        if events < log.shape[0]:
                            log[events, 0] = cycle + tau + step
                            log[events, 1] = i
                            log[events, 2] = new
                        events += 1
                    if events > 1000 * cycles:
                        return -1
                tau = end if end - (tau + step) <= 1e-15 else tau + step
    totals[4] /= T * T
    totals[5] /= T * T
    for q in range(columns):
        for p in range(m):
            final[p, q] = z[0, p, q]
        for r in range(n):
            final[m + r, q] = v[0, r, q]
    return events


@compiled(nogil=True)
def _load(series: FloatArray, order: int, s: float) -> float:
    """T^2 N of a closed contact."""
    total = 0.0
    for j in range(order - 1, -1, -1):
        total = total * s + series[j]
    return total


@compiled(nogil=True)
def _jump(
    z: FloatArray, v: FloatArray, i: int, u: FloatArray, c: float, rate: float, closing: float,
    a: FloatArray, s: float, T: float, columns: int, closes: bool,
) -> None:  # fmt: skip
    """Apply I + [0; T c a] [u, 0] rate/closing to the derivatives: the damper's load comes at once.

    Where a contact goes at penetration zero while it carries load, the load T c rate goes: the other sign.
    """
    if closing == 0.0:
        return
    factor = T * c * rate / closing
    if not closes:
        factor = -factor
    for q in range(1, columns):
        moved = 0.0
        for p in range(z.shape[1]):
            moved += u[i, p] * z[0, p, q]
        for r in range(v.shape[1]):
            v[0, r, q] += factor * value(a[r], s) * moved
