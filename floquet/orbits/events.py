"""When a contact closes, recovers or opens, and how the derivatives of the motion jump there.

A contact is CLOSED, RECOVERING or a GAP. `states_from_motion` decides the state where coefficients jump.
Inside a piece of the cycle `find_crossings` looks for the next zero of d or N, and `change_states` makes the
change:

- CLOSED, RECOVERING -> GAP: d = 0 downwards
- CLOSED -> RECOVERING: N = 0 downwards, while d > 0
- RECOVERING -> CLOSED: N = 0 upwards
- GAP -> CLOSED: d = 0 upwards

Sources: docs/theory/orbits.md, "Model" and "Jump matrices".
"""

from __future__ import annotations

from floquet.orbits.polynomials import crossing, slope, value
from floquet.orbits.records import (
    ABSENT,
    CLOSED,
    GAP,
    RECOVERING,
    ContactLaws,
    Contacts,
    Record,
    Request,
    Series,
    SystemTables,
)
from lumped.compiler import called, inlined
from lumped.typing import FloatArray, IntArray

#: Part of a step by which two events at one instant may differ.
_SAME_INSTANT = 1e-14


@called
def states_from_motion(
    series: Series, system: SystemTables, piece: int, period: float, states: IntArray
) -> None:
    """States of the contacts where a piece begins: they follow from d and N, whatever the states before."""
    laws = system.laws
    for i in range(states.size):
        if not system.present[piece, i]:
            states[i] = ABSENT
            continue
        penetration = -laws.clearance[piece, i, 0]
        rate = -laws.clearance_rate[piece, i, 0]
        for p in range(series.z.shape[1]):
            penetration += system.direction[i, p] * series.z[0, p, 0]
            rate += system.direction[i, p] * series.v[0, p, 0]
        alpha = laws.sign_by_penetration[piece, i, 0]
        beta = laws.sign_by_rate[piece, i, 0]
        if penetration <= 0.0:
            states[i] = GAP
        elif alpha * penetration + beta * rate / period > 0.0:
            states[i] = CLOSED
        else:
            states[i] = RECOVERING


@inlined
def find_crossings(
    series: Series, laws: ContactLaws, period: float, step: float, contacts: Contacts
) -> float:
    """Find where each contact changes its state; return the step to the first change, 2 step without one."""
    first = 2.0 * step
    for i in range(contacts.states.size):
        state = contacts.states[i]
        if state == ABSENT:
            continue
        penetration = contacts.penetration[i]
        for j in range(penetration.size):
            penetration[j] = series.penetration[i, j, 0]
        zeros = contacts.crossings[i]
        if state == GAP:
            zeros.penetration = crossing(penetration, step, -1.0)
            zeros.load = 2.0 * step
        else:
            load_sign = contacts.load_sign[i]
            _load_sign(
                laws.sign_by_penetration[i], laws.sign_by_rate[i], penetration,
                series.penetration_rate[i, :, 0], period, load_sign,
            )  # fmt: skip
            zeros.penetration = crossing(penetration, step, 1.0)
            zeros.load = crossing(load_sign, step, 1.0 if state == CLOSED else -1.0)
        first = min(first, min(zeros.penetration, zeros.load))
    return first


@inlined
def _load_sign(
    alpha: FloatArray, beta: FloatArray, d: FloatArray, rate: FloatArray, period: float, product: FloatArray
) -> None:
    """Series of alpha d + beta d'/T, a product of polynomials."""
    for j in range(product.size):
        product[j] = 0.0
    for p in range(alpha.size):
        if alpha[p] != 0.0 or beta[p] != 0.0:
            for j in range(min(d.size, product.size - p)):
                product[j + p] += alpha[p] * d[j] + beta[p] / period * rate[j]


@called
def change_states(
    series: Series, laws: ContactLaws, direction: FloatArray, request: Request, step: float, phase: float,
    contacts: Contacts, record: Record,
) -> None:  # fmt: skip
    """Change the contacts whose zero is the end of the step, at a phase in cycles, and log the changes.

    z and v of order 0 are at the end of the step already, all other series still start at its beginning.
    """
    for i in range(contacts.states.size):
        before = contacts.states[i]
        zeros = contacts.crossings[i]
        if before == ABSENT or min(zeros.penetration, zeros.load) > step * (1.0 + _SAME_INSTANT):
            continue
        rate = value(series.penetration_rate[i, :, 0], step)
        if before == GAP:
            loaded = rate > 0.0 or value(laws.sign_by_rate[i], step) == 0.0
            after = CLOSED if loaded else RECOVERING
        elif zeros.penetration - zeros.load <= _SAME_INSTANT * step:
            after = GAP
        else:
            after = RECOVERING if before == CLOSED else CLOSED
        closes = before == GAP and after == CLOSED
        opens = before == CLOSED and after == GAP
        closing_speed = slope(contacts.penetration[i], step)
        if request.derivatives and (closes or opens) and closing_speed != 0.0:
            damper = request.period * value(laws.damping[i], step) * rate / closing_speed
            _jump(series, direction[i], damper if closes else -damper, laws.acceleration[i], step)
        contacts.states[i] = after
        _log(record, phase, i, after)


@inlined
def _jump(series: Series, u: FloatArray, damper: float, acceleration: FloatArray, step: float) -> None:
    """Multiply the derivatives by S = I + [0; T c a] [u, 0] d'/(dd/dtau).

    The load of the damper, ``damper`` = T c d'/(dd/dtau), comes at once where a gap closes. Where a contact
    opens under the load of its damper, this load goes at once: ``damper`` has the other sign.
    """
    z = series.z
    v = series.v
    for q in range(1, z.shape[2]):
        penetration = 0.0
        for p in range(z.shape[1]):
            penetration += u[p] * z[0, p, q]
        for r in range(v.shape[1]):
            v[0, r, q] += damper * value(acceleration[r], step) * penetration


@inlined
def _log(record: Record, phase: float, contact: int, state: int) -> None:
    """Count a change of a contact, and log it where there is room."""
    count = record.summary.events
    if count < record.events.size:
        record.events[count].phase = phase
        record.events[count].contact = contact
        record.events[count].state = state
    record.summary.events = count + 1
