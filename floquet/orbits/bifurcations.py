"""Where stability or the number of periodic motions changes along a branch, and where an event appears.

Sources: docs/theory/orbits.md, "Bifurcations"; Kuznetsov, Elements of applied bifurcation theory, 2004, ch.
10.
"""

from __future__ import annotations

import contextlib
from bisect import bisect_left
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np
from scipy.optimize import brentq

from floquet.orbits.branch import Continuation, Path
from floquet.orbits.deadline import ENDLESS, Deadline
from floquet.orbits.orbit import Orbit
from lumped.errors import NumericalError
from lumped.typing import FloatArray

Kind = Literal["fold", "period doubling", "Neimark-Sacker", "grazing"]
_Test = Callable[[Orbit, FloatArray], float]
#: A test function this much below its values around is zero there; else it jumps, at a corner.
_ZERO = 1e-5
#: Part of a step to which a place is refined; a contact begins to open or to close in a step of its test
#: function, which is halved, and no other result builds on that place.
_REFINED = 1e-13
_GRAZES = 1e-7
#: Inside a tongue the linear system has motions of any amplitude at one speed: a branch that neither turns.
_ROUNDING = 1e-11
#: Least cosine between a tangent and the chord for a cubic between neighbours.
_AHEAD = 0.5


@dataclass(frozen=True, eq=False)
class Bifurcation:
    """A point on a branch.

    Attributes
    ----------
    kind : "fold": two motions meet; "period doubling": a multiplier is -1; "Neimark-Sacker": a complex pair
        has modulus 1, the motion begins to beat; "grazing": a contact begins to part or to strike
    orbit : the motion there
    place : where it is on the branch: the index of the orbit before it, and the part of the way to the next
    sharp : whether the test function vanishes there; not so at a corner, where a contact begins to strike and
        the multipliers jump
    """

    kind: Kind
    orbit: Orbit
    place: float
    sharp: bool


def with_bifurcations(along: Continuation, path: Path, result: list[Bifurcation]) -> list[Orbit]:
    """The orbits of a path and the orbits of its bifurcations, in order along the path.

    Two bifurcations of one step have a motion between them, because bifurcations are marginally stable: this
    motion shows whether the branch is stable there.
    """
    places = [
        *((float(j), orbit) for j, orbit in enumerate(path.orbits)),
        *((b.place, b.orbit) for b in result),
    ]
    ordered = sorted(b.place for b in result)
    for one, two in pairwise(ordered):
        j = int(one)
        middle = 0.5 * (one + two)
        if two < j + 1 and two > one:
            chord = path.X[j + 1] - path.X[j]
            with contextlib.suppress(NumericalError):
                at = path.X[j] + (middle - j) * chord
                places.append((middle, along.correct(at, chord / np.linalg.norm(chord))[1]))
    return [orbit for _, orbit in sorted(places, key=lambda item: item[0])]


def bifurcations(
    along: Continuation, path: Path, intervals: Sequence[int] | None = None, deadline: Deadline = ENDLESS
) -> tuple[list[Bifurcation], list[int]]:
    """Return the bifurcations between the points of a path in order, each refined.

    ``intervals`` are the indices of the points after which they are looked for, the most useful first; None:
    all. Second come those for which the deadline left no time.
    """
    result = list[Bifurcation]()
    left = list[int]()
    for j in range(len(path.orbits) - 1) if intervals is None else intervals:
        tests = _tests(path, j)
        if tests and deadline.passed:
            left.append(j)
            continue
        points = [_refined(along, path, j, kind, test) for kind, test in tests]
        result += [point for point in points if point.kind != "Neimark-Sacker" or _turns(point.orbit)]
    return sorted(result, key=lambda point: int(point.place)), left


def doubling_direction(along: Continuation, orbit: Orbit) -> FloatArray:
    """Scaled tangent at which the branch of twice the cycles leaves a period doubling."""
    values, vectors = np.linalg.eig(orbit.monodromy)
    vector = np.real(vectors[:, int(np.argmin(np.abs(values + 1.0)))])
    tangent = np.zeros(along.scale.size)
    tangent[: orbit.system.size] = vector / along.scale[: orbit.system.size]
    return np.asarray(tangent / np.linalg.norm(tangent))


def _tests(path: Path, j: int) -> list[tuple[Kind, _Test]]:
    """Kinds of bifurcations between points j and j + 1, each with its test function, which changes sign."""
    one, two = ends = [(path.orbits[i], path.tangents[i]) for i in (j, j + 1)]
    tests: list[tuple[Kind, _Test]] = [("fold", _speed_along), ("period doubling", _doubling)]
    if abs(_unstable_pairs(one[0]) - _unstable_pairs(two[0])) == 2:
        rank = min(int(np.sum(np.abs(orbit.multipliers) > 1.0)) for orbit, _ in ends)
        tests.append(("Neimark-Sacker", lambda o, _: float(np.abs(o.multipliers[rank])) - 1.0))
    result = [
        (kind, test)
        for kind, test in tests
        if test(*one) * test(*two) < 0.0 and min(abs(test(*one)), abs(test(*two))) > _ROUNDING
    ]
    if one[0].contact_lost != two[0].contact_lost:
        result.append(("grazing", lambda o, _: 1.0 if o.contact_lost else -1.0))
    elif one[0].strikes != two[0].strikes:
        result.append(("grazing", lambda o, _: 1.0 if o.strikes else -1.0))
    return result


def _speed_along(orbit: Orbit, tangent: FloatArray) -> float:
    return float(tangent[-1])


def _doubling(orbit: Orbit, tangent: FloatArray) -> float:
    """det(Phi + I), each factor scaled to one or less."""
    mu = orbit.multipliers
    return float(np.real(np.prod((1.0 + mu) / (1.0 + np.abs(mu)))))


def _unstable_pairs(orbit: Orbit) -> int:
    """Number of complex multipliers outside the unit circle."""
    mu = orbit.multipliers
    return int(np.sum((np.abs(mu) > 1.0) & (mu.imag != 0.0)))


def _turns(orbit: Orbit) -> bool:
    """Whether the multiplier nearest to the unit circle is complex; a pair may have met on the real axis."""
    mu = orbit.multipliers
    return bool(abs(mu[int(np.argmin(np.abs(np.abs(mu) - 1.0)))].imag) > _ZERO)


def _refined(along: Continuation, path: Path, j: int, kind: Kind, test: _Test) -> Bifurcation:
    """The zero of a test function between points j and j + 1, by Newton's method across the chord."""
    chord = path.X[j + 1] - path.X[j]
    chord = chord / np.linalg.norm(chord)
    places = [0.0, 1.0]
    known = [_TestedPoint(path.X[i], path.orbits[i], path.tangents[i], test) for i in (j, j + 1)]
    around = max(abs(one.value) for one in known)

    def value(part: float) -> float:
        at = bisect_left(places, part)
        if at == len(places) or places[at] != part:
            one = known[at - 1]
            two = known[at]
            share = (part - places[at - 1]) / (places[at] - places[at - 1])
            X, orbit, turned, _ = along.correct(_between(one, two, chord, share), chord)
            places.insert(at, part)
            known.insert(at, _TestedPoint(X, orbit, turned, test))
        return known[at].value

    try:
        room = _GRAZES if kind == "grazing" else _REFINED
        part = float(brentq(value, 0.0, 1.0, xtol=room, rtol=1e-14, maxiter=80))
        value(part)
    except (NumericalError, RuntimeError):
        part = places[int(np.argmin([abs(one.value) for one in known]))]
    result = known[places.index(part)]
    sharp = kind != "grazing" and abs(result.value) <= _ZERO * around
    return Bifurcation(kind, result.orbit, j + part, sharp)


class _TestedPoint:
    """A point between two of a path, with its tangent and the value of a test there."""

    def __init__(self, X: FloatArray, orbit: Orbit, tangent: FloatArray, test: _Test) -> None:
        self.X = X
        self.orbit = orbit
        self.tangent = tangent
        self.value = test(orbit, tangent)


def _between(one: _TestedPoint, two: _TestedPoint, chord: FloatArray, t: float) -> FloatArray:
    """A point of the cubic through two with their tangents; straight where these turn away from the chord."""
    X, Y = one.X, two.X
    length = float(chord @ (Y - X))
    ahead = [float(chord @ point.tangent) for point in (one, two)]
    if min(ahead) < _AHEAD:
        return np.asarray(X + t * (Y - X))
    a, b = one.tangent * (length / ahead[0]), two.tangent * (length / ahead[1])
    cubic = (2 * t**3 - 3 * t**2 + 1) * X + (t**3 - 2 * t**2 + t) * a
    return np.asarray(cubic + (3 * t**2 - 2 * t**3) * Y + (t**3 - t**2) * b)
