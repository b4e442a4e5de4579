"""Compiled equilibrium of the loaded mesh: load of a pair over its compression, gap of tip corners, approach.

Sources: docs/theory/contact_energy.md, "Energy of one pair", "Tip corner".
"""

from __future__ import annotations

import math

import numpy as np

from lumped.compiler import compiled
from lumped.typing import FloatArray

#: Newton's steps for the load of a pair, of which six are the most needed, and for the approach.
_LOAD_STEPS, _APPROACH_STEPS = 20, 200
#: Steps by chords; then Newton's, within a bracket that always closes.
_QUICK_STEPS = 12
#: Most times that the loads of neighbours are relaxed; each gains a decade or more.
_SWEEPS = 100
#: Relative change at which an iteration has converged.
_SETTLED = 2e-15
#: For the approach, that of the first loads and of tangents, and the least step whose chord is a slope.
_COARSE, _SLOPE, _CHORD = 1e-5, 1e-2, 1e-7


@compiled
def load_of(
    compression: float, stiffness: float, softening: float, nominal: float, least: float, guess: float
) -> tuple[float, float]:
    """Load [N] and tangent stiffness [N/m] of one pair, see ``ContactLaw``; zero where it does not press.

    ``guess`` is a load near by, or 0.
    """
    if not (compression > 0.0 and stiffness > 0.0):
        return 0.0, 0.0
    if softening == 0.0:
        return stiffness * compression, stiffness
    load = guess if guess > 0.0 else stiffness * compression
    tangent = 1.0 / stiffness
    for _ in range(_LOAD_STEPS):
        square = load * load + least * least
        secant = 1.0 / stiffness - 0.5 * softening * math.log(square / (nominal * nominal))
        tangent = secant - softening * load * load / square
        step = (load * secant - compression) / tangent
        load -= step
        if abs(step) <= _SETTLED * load:
            break
    return load, 1.0 / tangent


@compiled
def shared_loads(
    compression: FloatArray,
    stiffness: FloatArray,
    coupling: FloatArray,
    softening: float,
    nominal: float,
    least: float,
    loads: FloatArray,
    tangents: FloatArray,
    self_tangents: FloatArray,
    settled: float = _SETTLED,
    settled_tangents: float = _SETTLED,
) -> None:
    """Loads of tooth pairs that move each other, and how they grow when all are compressed further together.

    Each pair has ``load_of`` what its neighbours leave of its compression, p_i - sum_j w_ij N_j; loads that
    are relaxed one after the other find the minimum of a convex energy. A pair of k_i = 0 is not followed;
    ``coupling`` is w_ij, zero on the diagonal [m/N]. ``loads`` are a first guess and receive N_i,
    ``tangents`` receive dN_i/dp at a common p, ``self_tangents`` the same of each pair without the others
    (zero where not followed). Both are relaxed until a sweep changes their sum by less than the shares
    ``settled`` and ``settled_tangents``.
    """
    most = _SWEEPS if coupling.any() else 1
    for _ in range(most):
        change = total = 0.0
        for i in range(loads.size):
            if stiffness[i] > 0.0:
                pressed = compression[i]
                for j in range(loads.size):
                    pressed -= coupling[i, j] * loads[j]
                load, self_tangents[i] = load_of(pressed, stiffness[i], softening, nominal, least, loads[i])
                change += abs(load - loads[i])
                total += load
                loads[i] = load
        if change <= settled * total:
            break
    for i in range(loads.size):  # to assign whole arrays takes the compiler two seconds
        tangents[i] = self_tangents[i]
    for _ in range(most):
        change = total = 0.0
        for i in range(loads.size):
            if self_tangents[i] > 0.0:
                left = 1.0
                for j in range(loads.size):
                    left -= coupling[i, j] * tangents[j]
                change += abs(self_tangents[i] * left - tangents[i])
                tangents[i] = self_tangents[i] * left
                total += tangents[i]
        if change <= settled_tangents * total:
            break


@compiled
def corner_at(
    beyond: float, start: float, tangent: float, flank_radius: float, tip_radius: float
) -> tuple[float, float]:
    """Gap of a tip corner from the mate's flank [m], ``beyond`` before its first contact at ``start``.

    Beside it the sine of the angle by which the flank's normal at the corner is turned out of the line of
    action, so that it pushes the gears apart.

    Axes with the flank's tangent point as origin, t along the line of action, n away from the flank's centre;
    ``tangent`` is the length of the line of action.
    """
    if beyond <= 0.0:
        return 0.0, 0.0
    corner = tangent - start  # length on the tip's base tangent of its corner
    turn = beyond / tip_radius
    t = tangent - (tip_radius * math.sin(turn) + corner * math.cos(turn))
    n = 2.0 * tip_radius * math.sin(0.5 * turn) ** 2 + corner * math.sin(turn)
    length = math.sqrt(max(t * t + n * (n + 2.0 * flank_radius), 0.0))
    angle = math.atan2(t, n + flank_radius) - math.atan2(length, flank_radius)
    return length + flank_radius * angle - (start - beyond), -math.sin(angle)


@compiled
def gap_at(place: float, relief: float, half: float, longer: float, ends: FloatArray) -> tuple[float, float]:
    """Gap of a pair at xi = ``place`` [m], its contact point ``half`` beyond where the tips leave the line.

    Beside it the tilt of its normal, as of ``corner_at``.

    ``relief`` is the material missing there, ``longer`` by how much the line of action is longer than nominal
    [m]; ``ends`` are L_XA, L_XD, L_XY and the base radii of pinion and gear [m].
    """
    early, late = ends[0] - place + half, place - ends[1] + half
    length = ends[2] + longer
    before, early_tilt = corner_at(early, ends[0] + longer, length, ends[3], ends[4])
    behind, late_tilt = corner_at(late, length - ends[1], length, ends[4], ends[3])
    return relief + before + behind, early_tilt + late_tilt


@compiled
def gaps_at(
    place: FloatArray, relief: FloatArray, half: FloatArray, longer: FloatArray, ends: FloatArray
) -> FloatArray:
    """``gap_at`` at n positions, (2, n)."""
    found = np.empty((2, place.size))
    for i in range(place.size):
        found[0, i], found[1, i] = gap_at(place[i], relief[i], half[i], longer[i], ends)
    return found


@compiled
def middle_loads(
    compression: FloatArray,
    stiffness: FloatArray,
    coupling: FloatArray,
    softening: float,
    nominal: float,
    least: float,
) -> FloatArray:
    """Load [N], tangent [N/m] and compression by its own load [m] of the middle one of (n, pairs); (n, 3)."""
    found = np.empty((compression.shape[0], 3))
    middle = compression.shape[1] // 2
    for i in range(compression.shape[0]):
        loads, tangents = np.zeros(compression.shape[1]), np.zeros(compression.shape[1])
        shared_loads(
            compression[i],
            stiffness[i],
            coupling[i],
            softening,
            nominal,
            least,
            loads,
            tangents,
            np.zeros(loads.size),
            _SETTLED,
            _SETTLED,
        )
        found[i, 0], found[i, 1], found[i, 2] = loads[middle], tangents[middle], compression[i, middle]
        for j in range(loads.size):
            found[i, 2] -= coupling[i, middle, j] * loads[j]
    return found


@compiled
def approaches(
    place: FloatArray,
    stiffness: FloatArray,
    relief: FloatArray,
    coupling: FloatArray,
    force: float,
    lengthening: float,
    softening: float,
    least: float,
    ends: FloatArray,
) -> FloatArray:
    """Static approach delta at n phases, where the loads of all pairs make the force; (n,) [m], or NaN.

    ``place``, ``stiffness``, ``relief`` (n, pairs) are xi_i, k_i and the material missing on both flanks;
    ``coupling`` as in ``shared_loads``, ``force`` the mean load, at which k holds, ``lengthening`` that of
    the line of action by the loaded bearings, ``softening`` and ``least`` as in ``ContactLaw``, ``ends``
    as in ``gap_at``.
    """
    found = np.full(place.shape[0], np.nan)
    pairs = place.shape[1]
    loads, gaps = np.zeros(pairs), np.zeros(pairs)
    tangents, self_tangents = np.zeros(pairs), np.zeros(pairs)
    for i in range(place.shape[0]):
        largest = stiffness[i].max()
        if not largest > 0.0:
            continue
        low, high, delta = 0.0, math.inf, force / largest
        if i > 0 and found[i - 1] > 0.0:  # the phase before may be near by: start from there
            delta = found[i - 1]
        self_tangents[:] = 0.0
        for j in range(pairs):
            if not stiffness[i, j] > 0.0:
                loads[j] = 0.0
        settled, before, total_before, slope = _COARSE, delta, 0.0, 0.0
        for number in range(_APPROACH_STEPS):
            half = 0.5 * (delta + lengthening)
            for j in range(pairs):
                if stiffness[i, j] > 0.0:
                    gaps[j] = gap_at(place[i, j], relief[i, j], half, lengthening, ends)[0]
            shared_loads(
                delta - gaps,
                stiffness[i],
                coupling[i],
                softening,
                force,
                least,
                loads,
                tangents,
                self_tangents,
                settled,
                _SLOPE,
            )
            total, quick = loads.sum() - force, number < _QUICK_STEPS
            if abs(delta - before) > _CHORD * delta:
                slope = (total - total_before) / (delta - before)
            if not (slope > 0.0 and quick):
                slope = tangents.sum()
            before, total_before = delta, total
            # A total within the error of the loads is on no known side of the root.
            known = settled * force if quick else 0.0
            if total < -known:
                low = delta
            elif total >= known:
                high = delta
            # Where the step leaves the bracket, or nothing touches yet, bisect or double.
            following = delta - total / slope if slope > 0.0 else math.inf
            if not low < following < high:
                following = 0.5 * (low + high) if high < math.inf else 2.0 * delta
            change = abs(following - delta)
            delta = following
            if change <= _SETTLED * delta and settled == _SETTLED:
                found[i] = delta
                break
            # The next step leaves an error of this step's square: loads need not be more exact than that.
            settled = max(min(1e-2 * (change / delta) ** 2, _COARSE), _SETTLED) if quick else _SETTLED
    return found
