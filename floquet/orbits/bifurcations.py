"""Bifurcations: places on a branch at which stability, the number of motions or contact events change.

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
#: A test function below this part of the neighbouring values vanishes. Otherwise it jumps: a corner.
_ZERO = 1e-5
#: Tolerance of a place as part of a step. Grazing has a wider tolerance: the test function of grazing is a
#: step, so that bisection finds the place, and no other result depends on this place.
_REFINED = 1e-13
_GRAZES = 1e-7
#: Rounding of a test function. Inside a tongue the linear system has motions of any amplitude at one speed: a
#: branch at a constant speed, without a fold.
_ROUNDING = 1e-11
#: Least cosine between a tangent and the chord for a cubic between neighbours.
_AHEAD = 0.5


@dataclass(frozen=True, eq=False)
class Bifurcation:
    """A point on a branch.

    Attributes
    ----------
    kind : "fold": two motions meet; "period doubling": a multiplier is -1; "Neimark-Sacker": a complex pair
        has modulus 1, the motion begins to beat; "grazing": a contact begins to open or to strike
    orbit : the motion at the point
    place : index of the orbit before the point, plus the part of the interval to the next orbit
    sharp : whether the test function vanishes at the point. False: a corner, where a contact begins to strike
        and the multipliers jump
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
                X = path.X[j] + (middle - j) * chord
                _, orbit, *_ = along.correct(X, chord / np.linalg.norm(chord))
                places.append((middle, orbit))
    return [orbit for _, orbit in sorted(places, key=lambda item: item[0])]


def bifurcations(
    along: Continuation, path: Path, intervals: Sequence[int] | None = None, deadline: Deadline = ENDLESS
) -> tuple[list[Bifurcation], list[int]]:
    """Return the refined bifurcations of a path in order, and the intervals that the deadline has left out.

    ``intervals`` are the intervals to search, the most useful first: interval j lies between the points j and
    j + 1. None: all intervals.
    """
    result = list[Bifurcation]()
    unsearched = list[int]()
    for j in range(len(path.orbits) - 1) if intervals is None else intervals:
        tests = _tests(path, j)
        if tests and deadline.passed:
            unsearched.append(j)
            continue
        points = [_refined(along, path, j, kind, test) for kind, test in tests]
        result += [point for point in points if point.kind != "Neimark-Sacker" or _turns(point.orbit)]
    return sorted(result, key=lambda point: int(point.place)), unsearched


def doubling_direction(along: Continuation, orbit: Orbit) -> FloatArray:
    """Scaled tangent of the branch with twice the cycles at a period doubling."""
    values, vectors = np.linalg.eig(orbit.monodromy)
    vector = np.real(vectors[:, int(np.argmin(np.abs(values + 1.0)))])
    tangent = np.zeros(along.scale.size)
    tangent[: orbit.system.size] = vector / along.scale[: orbit.system.size]
    return np.asarray(tangent / np.linalg.norm(tangent))


def _tests(path: Path, j: int) -> list[tuple[Kind, _Test]]:
    """Kinds of the bifurcations between points j and j + 1, each with the test function that changes sign."""
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
    """Whether the multiplier nearest to the unit circle is complex.

    A pair that changes its modulus may also have met on the real axis.
    """
    mu = orbit.multipliers
    return bool(abs(mu[int(np.argmin(np.abs(np.abs(mu) - 1.0)))].imag) > _ZERO)


def _refined(along: Continuation, path: Path, j: int, kind: Kind, test: _Test) -> Bifurcation:
    """The zero of a test function between points j and j + 1, by Newton's method across the chord."""
    chord = path.X[j + 1] - path.X[j]
    chord = chord / np.linalg.norm(chord)
    places = [0.0, 1.0]
    tested = [_TestedPoint(path.X[i], path.orbits[i], path.tangents[i], test) for i in (j, j + 1)]
    largest_value = max(abs(point.value) for point in tested)

    def value(part: float) -> float:
        i = bisect_left(places, part)
        if i == len(places) or places[i] != part:
            one = tested[i - 1]
            two = tested[i]
            share = (part - places[i - 1]) / (places[i] - places[i - 1])
            X, orbit, tangent, _ = along.correct(_between(one, two, chord, share), chord)
            places.insert(i, part)
            tested.insert(i, _TestedPoint(X, orbit, tangent, test))
        return tested[i].value

    try:
        tolerance = _GRAZES if kind == "grazing" else _REFINED
        part = float(brentq(value, 0.0, 1.0, xtol=tolerance, rtol=1e-14, maxiter=80))
        value(part)
    except (NumericalError, RuntimeError):
        part = places[int(np.argmin([abs(point.value) for point in tested]))]
    result = tested[places.index(part)]
    sharp = kind != "grazing" and abs(result.value) <= _ZERO * largest_value
    return Bifurcation(kind, result.orbit, j + part, sharp)


class _TestedPoint:
    """A point between two points of a path, with the tangent and the value of a test function."""

    def __init__(self, X: FloatArray, orbit: Orbit, tangent: FloatArray, test: _Test) -> None:
        self.X = X
        self.orbit = orbit
        self.tangent = tangent
        self.value = test(orbit, tangent)


def _between(one: _TestedPoint, two: _TestedPoint, chord: FloatArray, t: float) -> FloatArray:
    """Point at the part t of the cubic through two points with their tangents.

    Where a tangent turns away from the chord: the point at the part t of the chord.
    """
    X = one.X
    Y = two.X
    length = float(chord @ (Y - X))
    ahead = [float(chord @ point.tangent) for point in (one, two)]
    if min(ahead) < _AHEAD:
        return np.asarray(X + t * (Y - X))
    a = one.tangent * (length / ahead[0])
    b = two.tangent * (length / ahead[1])
    cubic = (2 * t**3 - 3 * t**2 + 1) * X + (t**3 - 2 * t**2 + t) * a
    return np.asarray(cubic + (3 * t**2 - 2 * t**3) * Y + (t**3 - t**2) * b)
