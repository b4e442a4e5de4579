"""Element laws of the tooth pairs: tabulated stiffness, loads and stored energy over the compression.

Sources: docs/theory/contact_energy.md, "Energy of one pair".
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from lumped.compiler import called, inlined
from lumped.typing import FloatArray
from multibody.contact.kinematics import CONTACT_LAW
from multibody.contact.records import Record, Records, uncounted

#: Where teeth touch beyond their tips the damper takes hold gradually: it is whole at this share of the mean
#: load. Acting at once it would make the load jump by c times the speed of approach at the first touch.
GRADUAL = 1.0 / 15.0
#: Below this share of the mean load a pair is linear: Hertz's logarithm would make it infinitely soft.
_LINEAR_BELOW = 1e-3
#: Steps for the load of Hertz's contact, of which four are the most needed.
_MOST_STEPS = 20
#: Steps more than double the digits: behind one of this size, relative, nothing but rounding is left.
_LAST_STEP = 1e-8


class ContactLaw(NamedTuple):
    """Hertz's contact of every tooth pair.

    softening : D [m/N]; 0 makes every pair a linear spring
    nominal_force : load N_0 at which the tabulated stiffness holds [N]
    """

    softening: float
    nominal_force: float


@inlined
def contact_law(machine: Record, flags: int) -> ContactLaw:
    """The law of a machine; without the effect of Hertz's contact every pair is a linear spring."""
    law = machine.pair_law
    return ContactLaw(law.softening if flags & CONTACT_LAW else 0.0, law.nominal_force)


@inlined
def polynomial(piece: FloatArray, s: float) -> tuple[float, float]:
    """Value and slope of a polynomial piece at the distance s from its left end."""
    value = slope = 0.0
    for column in range(2, piece.size):
        slope = slope * s + value
        value = value * s + piece[column]
    return value, slope


@called
def table_value_and_slope(table: FloatArray, xi: float) -> tuple[float, float]:
    """Value of a piecewise polynomial at xi, and its slope. Beyond its ends the value stays constant.

    A row per piece: left end, right end, coefficients, highest power of (xi - left) first.
    """
    low = int(np.int64(0))  # of a literal 0 numba would compile the callees again
    high = table.shape[0] - 1
    x = min(max(xi, table[low, 0]), table[high, 1])
    while low < high:
        middle = (low + high + 1) // 2
        if x >= table[middle, 0]:
            low = middle
        else:
            high = middle - 1
    value, slope = polynomial(table[low], x - table[low, 0])
    return value, slope if x == xi else 0.0


@uncounted
def table_value(table: FloatArray, xi: float) -> float:
    """Value of a piecewise polynomial at xi, see ``table_value_and_slope``."""
    return float(table_value_and_slope(table, xi)[0])


@uncounted
def compliances(load: float, stiffness: float, law: ContactLaw) -> tuple[float, float, float]:
    """Compression of one tooth pair over its load p/N [m/N], dp/dN [m/N] and d^2p/dN^2/2 [m/N^2].

    Hertz's contact by Weber and Banaschek, p = N (1/k - D/2 ln(S/N_0^2)) with S = N^2 + N_1^2. The pair is
    linear below N_1 and where it is pulled. ``stiffness`` is k at the load N_0.
    """
    softening = law.softening
    nominal = law.nominal_force
    if softening == 0.0 or load <= 0.0:
        return 1.0 / stiffness, 1.0 / stiffness, 0.0
    square = load * load + (_LINEAR_BELOW * nominal) ** 2
    secant = 1.0 / stiffness - 0.5 * softening * math.log(square / nominal**2)
    share = load * load / square
    bend = softening * load / square * (share - 1.5)
    return secant, secant - softening * share, bend


@uncounted
def elastic_load(compression: float, stiffness: float, law: ContactLaw) -> float:
    """Load of one tooth pair alone [N], by Chebyshev's method."""
    if stiffness <= 0.0:
        return 0.0
    load = stiffness * compression
    if law.softening == 0.0 or compression <= 0.0:
        return load
    for _ in range(_MOST_STEPS):
        secant, tangent, bend = compliances(load, stiffness, law)
        step = (load * secant - compression) / tangent
        step += bend * step * step / tangent
        load -= step
        if abs(step) <= _LAST_STEP * load:
            break
    return load


@uncounted
def stored_energy(load: float, stiffness: float, slope: float, law: ContactLaw) -> tuple[float, float]:
    """Energy U = N p - C that one pair stores [J], and slope of U over xi at constant compression [J/m].

    C is the integral of the compression p over the load N. ``slope`` is the slope of the stiffness over xi.
    """
    if stiffness <= 0.0:
        return 0.0, 0.0
    along = 0.5 * slope * (load / stiffness) ** 2
    stored = 0.5 * load * load / stiffness
    if law.softening == 0.0 or load <= 0.0:
        return stored, along
    nominal = law.nominal_force
    least = (_LINEAR_BELOW * nominal) ** 2
    square = load * load + least
    # N p - C of the logarithm: the integral of N ln(S) is (S ln(S) - S)/2.
    rise = math.log(square / nominal**2)
    ends = square * (rise - 1.0) - least * (math.log(_LINEAR_BELOW**2) - 1.0)
    return stored - 0.5 * law.softening * (load * load * rise - 0.5 * ends), along


@called
def two_loads(one: Record, other: Record, coupling: float, law: ContactLaw) -> tuple[float, float]:
    """Loads of two tooth pairs that touch and move each other [N].

    Chebyshev's method, from the loads of linear springs: Newton's step, corrected by the second derivative.
    """
    first = 1.0 / one.stiffness
    second = 1.0 / other.stiffness
    determinant = first * second - coupling * coupling
    load_one = (second * one.compression - coupling * other.compression) / determinant
    load_other = (first * other.compression - coupling * one.compression) / determinant
    if law.softening == 0.0:
        return load_one, load_other
    for _ in range(_MOST_STEPS):
        secant, first, bend_one = compliances(load_one, one.stiffness, law)
        rest_one = load_one * secant + coupling * load_other - one.compression
        secant, second, bend_other = compliances(load_other, other.stiffness, law)
        rest_other = load_other * secant + coupling * load_one - other.compression
        inverse = 1.0 / (first * second - coupling * coupling)
        step_one = (second * rest_one - coupling * rest_other) * inverse
        step_other = (first * rest_other - coupling * rest_one) * inverse
        rest_one = bend_one * step_one * step_one
        rest_other = bend_other * step_other * step_other
        step_one += (second * rest_one - coupling * rest_other) * inverse
        step_other += (first * rest_other - coupling * rest_one) * inverse
        load_one -= step_one
        load_other -= step_other
        if abs(step_one) + abs(step_other) <= _LAST_STEP * (abs(load_one) + abs(load_other)):
            break
    return load_one, load_other


@called
def _newton_equations(count: int, pairs: Records, law: ContactLaw) -> None:
    """Write derivatives and residual of p_i = N_i c_i + sum_j w_ij N_j into each pair."""
    for i in range(count):
        pair = pairs[i]
        secant = 1.0
        tangent = 1.0
        if pair.touches:
            secant, tangent, _ = compliances(pair.elastic_load, pair.stiffness, law)
        residual = pair.elastic_load * secant - pair.compression if pair.touches else 0.0
        for j in range(count):
            derivative = pair.couplings[j] if pair.touches and pairs[j].touches else 0.0
            pair.equation[j] = derivative
            residual += derivative * pairs[j].elastic_load
        pair.equation[i] = tangent
        pair.residual = residual


@called
def _eliminate(count: int, pairs: Records) -> None:
    """Gauss's elimination below the diagonal; the matrix is symmetric and positive definite."""
    for i in range(count):
        pivot = pairs[i]
        for k in range(i + 1, count):
            below = pairs[k]
            share = below.equation[i] / pivot.equation[i]
            for j in range(i, count):
                below.equation[j] -= share * pivot.equation[j]
            below.residual -= share * pivot.residual


@called
def _many_loads(count: int, pairs: Records, law: ContactLaw) -> None:
    """Loads of more than two pairs that touch, by Newton's steps from the present loads of the pairs."""
    for _ in range(_MOST_STEPS):
        _newton_equations(count, pairs, law)
        _eliminate(count, pairs)
        step = total = 0.0
        for i in range(count - 1, -1, -1):
            pair = pairs[i]
            for j in range(i + 1, count):
                pair.residual -= pair.equation[j] * pairs[j].residual
            pair.residual /= pair.equation[i]
            if pair.touches:
                pair.elastic_load -= pair.residual
                step += abs(pair.residual)
                total += abs(pair.elastic_load)
        if step <= _LAST_STEP * total:
            break


@called
def _loads_of_touching(count: int, pairs: Records, law: ContactLaw) -> None:
    """Write the loads of the pairs that touch."""
    number = 0
    one = 0
    other = 0
    for i in range(count):
        if pairs[i].touches:
            number = number + 1
            one = other
            other = i
    if number == 1:
        pair = pairs[other]
        pair.elastic_load = elastic_load(pair.compression, pair.stiffness, law)
    elif number == 2:
        loads = two_loads(pairs[one], pairs[other], pairs[one].couplings[other], law)
        pairs[one].elastic_load = loads[0]
        pairs[other].elastic_load = loads[1]
    elif number > 2:
        _many_loads(count, pairs, law)


@called
def _change_touching(count: int, pairs: Records) -> bool:
    """Release pairs that would pull, and add pairs that would overlap. Return whether a pair changed."""
    changed = False
    for i in range(count):
        pair = pairs[i]
        own_compression = pair.compression
        for j in range(count):
            own_compression -= pair.couplings[j] * pairs[j].elastic_load
        if pair.touches:
            if pair.elastic_load <= 0.0 and not pair.may_pull:
                pair.touches = 0
                pair.elastic_load = 0.0
                changed = True
        elif pair.stiffness > 0.0 and own_compression > 0.0:
            pair.touches = 1
            changed = True
    return changed


@uncounted
def shared_loads(count: int, pairs: Records, law: ContactLaw) -> None:
    """Write the loads N_i of tooth pairs that move each other, PAIR records.

    p_i = N_i c_i(N_i) + sum_j w_ij N_j where they touch. Pairs that would pull are let go, and pairs that
    would overlap are taken in, until none is left. The energy is convex, so there is one answer. The
    couplings w_ii are zero.
    """
    for i in range(count):
        pair = pairs[i]
        pair.elastic_load = 0.0
        pair.touches = 0
        if pair.stiffness > 0.0 and (pair.may_pull or pair.compression > 0.0):
            pair.touches = 1
            pair.elastic_load = pair.stiffness * pair.compression
    for _ in range(2 * count + 1):
        _loads_of_touching(count, pairs, law)
        if not _change_touching(count, pairs):
            break


@uncounted
def gradual(share: float) -> float:
    """Smooth step from 0 at 0 to 1 at 1."""
    x = min(max(share, 0.0), 1.0)
    return x * x * (3.0 - 2.0 * x)


@uncounted
def relief_at(machine: Record, xi: float, own_p: float, own_g: float) -> tuple[float, float]:
    """Material that the reliefs of both flanks remove at xi [m], and slope of this material over xi.

    A relief grows over the roll angle of the relieved gear.

    own_p, own_g : tip relief of the teeth of pinion and gear beyond the relief of the design [m]
    """
    geometry = machine.geometry
    error = slope = 0.0
    for i in range(machine.relief_count):
        relief = machine.reliefs[i]
        pinion = relief.gear == 0
        sense = 1.0 / geometry.radius_p if pinion else -1.0 / geometry.radius_g
        roll = xi / geometry.radius_p if pinion else (geometry.L_XY - xi) / geometry.radius_g
        width = relief.end - relief.start
        share = (roll - relief.start) / width
        if share > 0.0:
            power = relief.power
            amount = relief.amount
            if width > 0.0:  # a tip relief: a root relief grows as the roll angle falls
                amount += own_p if pinion else own_g
            error += amount * share**power
            slope += amount * power * share ** (power - 1.0) * sense / width
    return error, slope


@called
def coupling_at(machine: Record, apart: int, xi: float) -> tuple[float, float]:
    """Motion of a pair by a unit load on another one [m/N], and its slope over xi [1/N].

    apart : how many pitches lie between both pairs
    xi : position of the pair behind [m]
    """
    if apart > machine.coupling_count:
        return 0.0, 0.0
    piece = machine.couplings[apart - 1]
    x = min(max(xi, piece[0]), piece[1])
    value, slope = polynomial(piece, x - piece[0])
    return value, slope if x == xi else 0.0
