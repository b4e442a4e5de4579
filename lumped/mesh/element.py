"""The element of the mesh: from an approach of the gears to the gap and the elastic load of every tooth pair.

The elastic load of the lumped model is computed here and nowhere else. Three users stand on it:

- ``lumped.mesh.statics``: the approach under the mean force.
- ``lumped.mesh.unilateral_force``: the force in a motion by momentary load, in which teeth only push.
- ``lumped.mesh.linear``: the linear form about the static state, in which teeth may pull.

Whether teeth are alike or differ, and where they are, is in the records ``pairs`` and ``line`` that the
callers write. Tip corners are in ``lumped.mesh.tip_corners``, dampers in ``lumped.mesh.damper``.

Sources: docs/theory/contact_energy.md, "Energy of one pair", "Neighbours".
"""

from __future__ import annotations

import math

from lumped.compiler import called, inlined, inlined_optimised
from lumped.mesh.records import ContactLaw, Record, Records
from lumped.mesh.tip_corners import end_of_flanks, gap_unless_inside, start_of_flanks
from lumped.typing import FloatArray

#: Most steps of an iteration.
_MOST_STEPS = 200


@inlined
def write_gap(pair: Record, approach: float, line: Record, law: ContactLaw, contact: Record) -> None:
    """Write gap, slopes of the gap, tilt and compression of a pair at an approach, tip corners included."""
    start = gap_unless_inside(start_of_flanks(pair, approach, line, law))
    end = gap_unless_inside(end_of_flanks(pair, approach, line, law))
    contact.gap = pair.gap
    contact.gap_by_position = pair.gap_slope
    contact.gap_by_approach = 0.0
    contact.tilt = 0.0
    contact.gap += start.gap + end.gap
    contact.gap_by_position += (start.edge_slope - start.tip_slope) + (end.tip_slope - end.edge_slope)
    contact.gap_by_approach += 0.5 * (start.tip_slope + start.edge_slope + end.tip_slope + end.edge_slope)
    contact.tilt += start.tilt + end.tilt
    contact.compression = approach - contact.gap


@inlined
def write_gap_unless_apart(
    pair: Record, approach: float, line: Record, law: ContactLaw, contact: Record
) -> None:
    """Write the gap of a pair as ``write_gap`` does, unless a cheap lower bound shows that the pair is apart.

    The lower bound replaces the gap of the tip corners by a parabola below it. If the compression by this
    bound is too small for contact, only ``compression`` is written, with the value of the bound.
    """
    before = start_of_flanks(pair, approach, line, law).beyond_tip
    behind = end_of_flanks(pair, approach, line, law).beyond_tip
    least_gap = pair.corner_before * max(before, 0.0) ** 2 + pair.corner_behind * max(behind, 0.0) ** 2
    contact.compression = approach - pair.gap - least_gap
    if contact.compression > law.apart_below:
        write_gap(pair, approach, line, law, contact)


@inlined
def compliances(load: float, stiffness: float, law: ContactLaw) -> tuple[float, float]:
    """Secant compliance (compression over load), and slope of the compression over the load [m/N]."""
    if law.softening == 0.0:
        return 1.0 / stiffness, 1.0 / stiffness
    square = load * load + law.linear_below**2
    secant = 1.0 / stiffness - 0.5 * law.softening * math.log(square / law.force**2)
    return secant, secant - law.softening * load * load / square


@inlined
def single_load(stiffness: float, law: ContactLaw, contact: Record) -> None:
    """Write load and tangent of a pair that no neighbour moves.

    Newton steps start from the load that ``contact`` has already, that of an approach close by.
    """
    if contact.compression <= 0.0:
        contact.load = 0.0
        contact.tangent = 0.0
        return
    if law.softening == 0.0:
        contact.load = stiffness * contact.compression
        contact.tangent = stiffness
        return
    if contact.load <= 0.0:
        contact.load = stiffness * contact.compression
    for _ in range(_MOST_STEPS):
        secant, slope = compliances(contact.load, stiffness, law)
        change = (contact.load * secant - contact.compression) / slope
        contact.load -= change
        contact.tangent = 1.0 / slope
        if abs(change) <= law.converged * contact.load:
            break


@inlined
def write_load_equations(
    pairs: Records, law: ContactLaw, coupling: FloatArray, matrix: FloatArray, contacts: Records
) -> None:
    """Write matrix and residuals of a Newton step of ``coupled_loads``.

    ``tangent`` gets the right side of the same equations for a compression that all pairs share. A pair that
    is apart has no equation: its pivot is 0, and so are both right sides.
    """
    count = pairs.size
    for i in range(count):
        contact = contacts[i]
        contact.residual = 0.0
        contact.tangent = 0.0
        matrix[i, i] = 0.0
        if contact.load == 0.0 and contact.compression <= law.apart_below:
            continue
        compression = contact.compression
        for j in range(count):
            compression -= coupling[i, j] * contacts[j].load
        if compression > 0.0 or contact.load > 0.0:
            secant, slope = compliances(contact.load, pairs[i].stiffness, law)
            for j in range(count):
                matrix[i, j] = coupling[i, j]
            matrix[i, i] = slope
            contact.residual = compression - contact.load * secant
            contact.tangent = 1.0


@inlined
def coupled_loads(
    pairs: Records, law: ContactLaw, coupling: FloatArray, matrix: FloatArray, contacts: Records
) -> None:
    """Write loads and tangents of pairs that move each other: p_i = N_i c(N_i) + sum_j w_ij N_j.

    Newton steps start from the loads that ``contacts`` have already.

    Parameters
    ----------
    coupling : w, by which the load of pair j moves pair i [m/N]
    matrix : (pairs, pairs) memory for the matrix of these equations; its content on entry has no meaning
    """
    count = pairs.size
    for _ in range(_MOST_STEPS):
        write_load_equations(pairs, law, coupling, matrix, contacts)
        eliminate(matrix, contacts)
        change = 0.0
        total = 0.0
        for i in range(count):
            load = max(contacts[i].load + contacts[i].residual, 0.0)
            change += abs(load - contacts[i].load)
            total += load
            contacts[i].load = load
        if change <= law.converged * total:
            break
    for i in range(count):
        if contacts[i].load == 0.0:
            contacts[i].tangent = 0.0


@inlined
def eliminate(matrix: FloatArray, contacts: Records) -> None:
    """Solve the equations for both right sides ``residual`` and ``tangent``, in place.

    Each field has a right side on entry and the solution on return: ``residual`` then is the change of the
    load. Gauss elimination needs no pivots: the matrix of the pairs in contact is positive definite. Rows and
    columns of pairs that are apart, whose pivot is 0, are passed over.
    """
    count = contacts.size
    for i in range(count):
        if matrix[i, i] == 0.0:
            continue
        for row in range(i + 1, count):
            if matrix[row, row] == 0.0:
                continue
            factor = matrix[row, i] / matrix[i, i]
            if factor != 0.0:
                for column in range(i + 1, count):
                    matrix[row, column] -= factor * matrix[i, column]
                contacts[row].residual -= factor * contacts[i].residual
                contacts[row].tangent -= factor * contacts[i].tangent
    for i in range(count - 1, -1, -1):
        if matrix[i, i] == 0.0:
            continue
        for column in range(i + 1, count):
            contacts[i].residual -= matrix[i, column] * contacts[column].residual
            contacts[i].tangent -= matrix[i, column] * contacts[column].tangent
        contacts[i].residual /= matrix[i, i]
        contacts[i].tangent /= matrix[i, i]


@inlined
def spring_load(pair: Record, approach: float, contact: Record) -> None:
    """Write gap and load of a pair inside its window of prescribed contact: a linear spring k (delta - gap).

    The elastic load may be negative here. ``unilateral_force`` cuts it to 0, the linear form keeps it.
    """
    contact.gap = pair.gap
    contact.gap_by_position = pair.gap_slope
    contact.gap_by_approach = 0.0
    contact.tilt = 0.0
    contact.compression = approach - pair.gap
    contact.load = pair.stiffness * contact.compression
    contact.tangent = pair.stiffness


@inlined
def follow_tangent(change: float, law: ContactLaw, contact: Record) -> None:
    """Start the Newton steps from the load on the tangent, after a change of the compression [m]."""
    load = contact.load + contact.tangent * change
    if law.softening != 0.0 and contact.load > 0.0 and load > 0.0:
        contact.load = load


# Optimised first: the loop over a motion by momentary load is a tenth faster, and compiles no longer.
@inlined_optimised
def write_elastic_loads(
    approach: float,
    pairs: Records,
    line: Record,
    law: ContactLaw,
    coupling: FloatArray,
    matrix: FloatArray,
    contacts: Records,
) -> None:
    """Write the elastic load of every pair at an approach of the gears.

    The gap is written where a pair may touch, see ``write_gap_unless_apart``. Elsewhere gap and slopes in
    ``contacts`` are those of an earlier approach, and no force reads them.

    Parameters
    ----------
    approach : delta [m]
    pairs, line, law : the pairs without load, the line of action, the law of the contact
    coupling : (pairs, pairs) w_ij by which the load of pair j moves pair i [m/N]
    matrix : (pairs, pairs) memory for ``coupled_loads``; its content on entry has no meaning
    contacts : written. On entry they are those of an approach close by, or 0. The Newton steps start on their
        tangents, which makes the steps few. The result does not depend on them beyond ``law.converged``
    """
    for i in range(pairs.size):
        pair = pairs[i]
        contact = contacts[i]
        if pair.stiffness <= 0.0:
            contact.compression = 0.0
            contact.load = 0.0
            contact.tangent = 0.0
        elif law.prescribed:
            spring_load(pair, approach, contact)
        else:
            former = contact.compression
            write_gap_unless_apart(pair, approach, line, law, contact)
            follow_tangent(contact.compression - former, law, contact)
            if not law.coupled:
                single_load(pair.stiffness, law, contact)
    if law.coupled:
        coupled_loads(pairs, law, coupling, matrix, contacts)


@inlined
def in_contact(pair: Record, contact: Record, law: ContactLaw) -> bool:
    """Whether a pair takes part: it carries load or, with prescribed contact, it is inside its window."""
    return contact.load > 0.0 or (law.prescribed and pair.stiffness > 0.0)


@inlined
def rolling_rate(contact: Record, line: Record, law: ContactLaw) -> float:
    """Rate at which the gap of a pair grows as the teeth roll, at a constant approach [m/s]."""
    rate: float = contact.gap_by_position * law.rolling_speed + line.gap_rate
    return rate


@called
def static_approach(
    guess: float,
    tolerance: float,
    force: float,
    pairs: Records,
    line: Record,
    law: ContactLaw,
    coupling: FloatArray,
    matrix: FloatArray,
    contacts: Records,
) -> float:
    """Approach at which the elastic loads sum to a force [m]; NaN where no approach does.

    Newton steps inside a bracket start from a guess. The iteration ends when the force or the approach is met
    to the relative tolerance. ``contacts`` are then those of the last approach.
    """
    stiffest = 1e-300
    for i in range(pairs.size):
        stiffest = max(stiffest, pairs[i].stiffness)
    scale = force / stiffest
    low = -math.inf
    high = math.inf
    approach = guess
    # Length of the next step outwards. It doubles: under a light load it is far smaller than the gaps.
    reach = 2.0 * scale
    for _ in range(_MOST_STEPS):
        write_elastic_loads(approach, pairs, line, law, coupling, matrix, contacts)
        excess = -force
        slope = 0.0
        for i in range(pairs.size):
            excess += contacts[i].load
            if contacts[i].load > 0.0:
                slope += contacts[i].tangent * (1.0 - contacts[i].gap_by_approach)
        if abs(excess) <= tolerance * force:
            return approach
        if excess < 0.0:
            low = approach
        else:
            high = approach
        next_approach = approach - excess / slope if slope > 0.0 else math.inf
        if not low < next_approach < high:
            # Bisect the bracket, or step outwards while the bracket has one end only.
            if low > -math.inf and high < math.inf:
                next_approach = 0.5 * (low + high)
            else:
                next_approach = approach + (reach if excess < 0.0 else -reach)
                reach *= 2.0
        change = abs(next_approach - approach)
        if change <= tolerance * (abs(approach) + scale):
            return approach
        approach = next_approach
    return math.nan
