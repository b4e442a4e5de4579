"""Element laws of the tooth pairs: tabulated stiffness, loads and stored energy over the compression.

Sources: docs/theory/contact_energy.md, "Energy of one pair".
"""

from __future__ import annotations

import math

import numpy as np

from lumped.compiler import compiled
from lumped.typing import FloatArray
from multibody.contact import kinematics as kn

#: Where teeth touch beyond their tips the damper takes hold gradually: it is whole at this share of the mean
#: load. Acting at once it would make the load jump by c times the speed of approach at the first touch.
GRADUAL = 1.0 / 15.0
#: Below this share of the mean load a pair is linear: Hertz's logarithm would make it infinitely soft.
_LINEAR_BELOW = 1e-3
#: Steps for the load of Hertz's contact, of which four are the most needed.
_MOST_STEPS = 20
#: Steps more than double the digits: behind one of this size, relative, nothing but rounding is left.
_LAST_STEP = 1e-8


@compiled
def law_at(table: FloatArray, low: int, high: int, xi: float) -> tuple[float, float]:
    """A law in the rows ``low`` to ``high`` of a table at xi, and its slope; beyond its path it is constant.

    A row per piece: left end, right end, coefficients, highest power of (xi - left) first.
    """
    x = min(max(xi, table[low, 0]), table[high, 1])
    while low < high:
        middle = (low + high + 1) // 2
        if x >= table[middle, 0]:
            low = middle
        else:
            high = middle - 1
    s = x - table[low, 0]
    value = slope = 0.0
    for column in range(2, table.shape[1]):
        slope = slope * s + value
        value = value * s + table[low, column]
    return value, slope if x == xi else 0.0


@compiled
def stiffness_and_slope(table: FloatArray, xi: float) -> tuple[float, float]:
    """Stiffness of one tooth pair at xi [N/m] and its slope [N/m^2], or another law that fills a table."""
    return law_at(table, int(np.int64(0)), table.shape[0] - 1, xi)


@compiled
def stiffness_at(table: FloatArray, xi: float) -> float:
    """Stiffness of one tooth pair at xi [N/m], see ``stiffness_and_slope``."""
    return float(stiffness_and_slope(table, xi)[0])


@compiled
def compliances(
    load: float, stiffness: float, softening: float, nominal: float
) -> tuple[float, float, float]:
    """Compression of one tooth pair over its load p/N [m/N], dp/dN [m/N] and d^2p/dN^2/2 [m/N^2].

    Hertz's contact by Weber and Banaschek, p = N (1/k - D/2 ln(S/N_0^2)) with S = N^2 + N_1^2, is linear
    below N_1 and where it is pulled. ``stiffness`` is k at the load N_0 = ``nominal``, ``softening`` D [m/N].
    """
    if softening == 0.0 or load <= 0.0:
        return 1.0 / stiffness, 1.0 / stiffness, 0.0
    square = load * load + (_LINEAR_BELOW * nominal) ** 2
    secant = 1.0 / stiffness - 0.5 * softening * math.log(square / nominal**2)
    share = load * load / square
    bend = softening * load / square * (share - 1.5)
    return secant, secant - softening * share, bend


@compiled
def elastic_load(pressed: float, stiffness: float, softening: float, nominal: float) -> float:
    """Load of one tooth pair alone [N], by Chebyshev's method; arguments as ``two_loads``."""
    if stiffness <= 0.0:
        return 0.0
    load = stiffness * pressed
    if softening == 0.0 or pressed <= 0.0:
        return load
    for _ in range(_MOST_STEPS):
        secant, tangent, bend = compliances(load, stiffness, softening, nominal)
        step = (load * secant - pressed) / tangent
        step += bend * step * step / tangent
        load -= step
        if abs(step) <= _LAST_STEP * load:
            break
    return load


@compiled
def stored_energy(
    load: float, stiffness: float, slope: float, softening: float, nominal: float
) -> tuple[float, float]:
    """Energy U = N p - C of one pair [J], C the integral of p over N, and its slope along the path [J/m].

    The slope is at constant compression; ``slope`` is that of k.
    """
    if stiffness <= 0.0:
        return 0.0, 0.0
    along = 0.5 * slope * (load / stiffness) ** 2
    stored = 0.5 * load * load / stiffness
    if softening == 0.0 or load <= 0.0:
        return stored, along
    least = (_LINEAR_BELOW * nominal) ** 2
    square = load * load + least
    # N p - C of the logarithm: the integral of N ln(S) is (S ln(S) - S)/2.
    rise = math.log(square / nominal**2)
    ends = square * (rise - 1.0) - least * (math.log(_LINEAR_BELOW**2) - 1.0)
    return stored - 0.5 * softening * (load * load * rise - 0.5 * ends), along


@compiled
def two_loads(
    pressed: tuple[float, float],
    stiffness: tuple[float, float],
    coupling: float,
    softening: float,
    nominal: float,
) -> tuple[float, float]:
    """Loads of two tooth pairs that touch and move each other [N]; arguments as ``shared_loads``.

    From the loads of linear springs by Chebyshev's method: Newton's step, and what the bend adds to it.
    """
    first = 1.0 / stiffness[0]
    second = 1.0 / stiffness[1]
    determinant = first * second - coupling * coupling
    one = (second * pressed[0] - coupling * pressed[1]) / determinant
    other = (first * pressed[1] - coupling * pressed[0]) / determinant
    if softening == 0.0:
        return one, other
    for _ in range(_MOST_STEPS):
        secant, first, bend_one = compliances(one, stiffness[0], softening, nominal)
        rest_one = one * secant + coupling * other - pressed[0]
        secant, second, bend_other = compliances(other, stiffness[1], softening, nominal)
        rest_other = other * secant + coupling * one - pressed[1]
        inverse = 1.0 / (first * second - coupling * coupling)
        step_one = (second * rest_one - coupling * rest_other) * inverse
        step_other = (first * rest_other - coupling * rest_one) * inverse
        rest_one = bend_one * step_one * step_one
        rest_other = bend_other * step_other * step_other
        step_one += (second * rest_one - coupling * rest_other) * inverse
        step_other += (first * rest_other - coupling * rest_one) * inverse
        one, other = one - step_one, other - step_other
        if abs(step_one) + abs(step_other) <= _LAST_STEP * (abs(one) + abs(other)):
            break
    return one, other


@compiled
def _many_loads(
    count: int,
    pressed: FloatArray,
    stiffness: FloatArray,
    touch: int,
    coupling: FloatArray,
    softening: float,
    nominal: float,
    loads: FloatArray,
) -> None:
    """Loads of more than two pairs that touch (bits ``touch``), by Newton's steps from ``loads``."""
    matrix = np.empty((count, count))
    rest = np.empty(count)
    for _ in range(_MOST_STEPS):
        for i in range(count):
            secant = 1.0
            tangent = 1.0
            acts = touch >> i & 1
            if acts:
                secant, tangent, _ = compliances(loads[i], stiffness[i], softening, nominal)
            rest[i] = loads[i] * secant - pressed[i] if acts else 0.0
            for j in range(count):
                matrix[i, j] = coupling[i, j] if acts and touch >> j & 1 else 0.0
                rest[i] += matrix[i, j] * loads[j]
            matrix[i, i] = tangent
        # Gauss's elimination; the matrix is symmetric and positive definite.
        for i in range(count):
            for k in range(i + 1, count):
                share = matrix[k, i] / matrix[i, i]
                for j in range(i, count):
                    matrix[k, j] -= share * matrix[i, j]
                rest[k] -= share * rest[i]
        step = total = 0.0
        for i in range(count - 1, -1, -1):
            for j in range(i + 1, count):
                rest[i] -= matrix[i, j] * rest[j]
            rest[i] /= matrix[i, i]
            if touch >> i & 1:
                loads[i] -= rest[i]
                step += abs(rest[i])
                total += abs(loads[i])
        if step <= _LAST_STEP * total:
            break


@compiled
def shared_loads(
    count: int,
    pressed: FloatArray,
    stiffness: FloatArray,
    pulls: int,
    coupling: FloatArray,
    softening: float,
    nominal: float,
    loads: FloatArray,
) -> None:
    """Loads N_i of tooth pairs that move each other, p_i = N_i c_i(N_i) + sum_j w_ij N_j where they touch.

    Pairs that would pull are let go, those that would overlap taken in, until none is left: the energy is
    convex, so there is one answer. ``pressed`` are p_i, approach less all gaps [m], ``pulls`` bits of the
    pairs that cannot lose contact, ``coupling`` w_ij, zero on the diagonal [m/N].
    """
    touch = int(np.int64(0))
    for i in range(count):
        loads[i] = 0.0
        if stiffness[i] > 0.0 and (pulls >> i & 1 or pressed[i] > 0.0):
            touch |= 1 << i
            loads[i] = stiffness[i] * pressed[i]
    for _ in range(2 * count + 1):
        number = 0
        one = 0
        other = 0
        for i in range(count):
            if touch >> i & 1:
                number = number + 1
                one = other
                other = i
        if number == 1:
            loads[other] = elastic_load(pressed[other], stiffness[other], softening, nominal)
        elif number == 2:
            loads[one], loads[other] = two_loads(
                (pressed[one], pressed[other]),
                (stiffness[one], stiffness[other]),
                coupling[one, other],
                softening,
                nominal,
            )
        elif number > 2:
            _many_loads(count, pressed, stiffness, touch, coupling, softening, nominal, loads)
        settled = True
        for i in range(count):
            left = pressed[i]
            for j in range(count):
                left -= coupling[i, j] * loads[j]
            if touch >> i & 1:
                if loads[i] <= 0.0 and not pulls >> i & 1:
                    touch = touch & ~(1 << i)
                    loads[i] = 0.0
                    settled = False
            elif stiffness[i] > 0.0 and left > 0.0:
                touch = touch | 1 << i
                settled = False
        if settled:
            break


@compiled
def gradual(share: float) -> float:
    """Smooth step from 0 at 0 to 1 at 1."""
    x = min(max(share, 0.0), 1.0)
    return x * x * (3.0 - 2.0 * x)


@compiled
def relief_at(p: FloatArray, xi: float, own_p: float, own_g: float) -> tuple[float, float]:
    """Material missing from both flanks at xi [m], each relief growing over its own roll angle; its slope.

    ``own_p``, ``own_g``: tip relief of the teeth of pinion and gear beyond that of the design [m].
    """
    error = slope = 0.0
    for i in range(int(p[kn.RELIEFS])):
        row = kn.FIRST_RELIEF + kn.RELIEF_COLUMNS * i
        pinion = p[row] == 0.0
        sense = 1.0 / p[kn.RADIUS_P] if pinion else -1.0 / p[kn.RADIUS_G]
        roll = xi / p[kn.RADIUS_P] if pinion else (p[kn.L_XY] - xi) / p[kn.RADIUS_G]
        width = p[row + 2] - p[row + 1]
        share = (roll - p[row + 1]) / width
        if share > 0.0:
            power = p[row + 4]
            amount = p[row + 3]
            if width > 0.0:  # a tip relief: a root relief grows as the roll angle falls
                amount += own_p if pinion else own_g
            error += amount * share**power
            slope += amount * power * share ** (power - 1.0) * sense / width
    return error, slope


@compiled
def coupling_at(p: FloatArray, apart: int, xi: float) -> tuple[float, float]:
    """Motion of a pair by a unit load on one ``apart`` pitches off, the one behind at xi; its slope [m/N]."""
    if apart > p[kn.COUPLED]:
        return 0.0, 0.0
    first = kn.FIRST_COUPLED + kn.COUPLED_COLUMNS * (apart - 1)
    row = p[first : first + kn.COUPLED_COLUMNS].reshape((1, kn.COUPLED_COLUMNS))
    return stiffness_and_slope(row, xi)
