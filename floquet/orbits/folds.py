"""Curves of folds over a second parameter: where two motions meet, and where folds themselves meet.

Sources: docs/theory/orbits.md, "Fold curves"; bordered matrix: Govaerts, Numerical methods for bifurcations
of dynamical equilibria, 2000, ch. 4.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from scipy.optimize import brentq

from floquet.orbits.branch import Continuation
from floquet.orbits.orbit import Orbit
from lumped.errors import NumericalError
from lumped.typing import FloatArray

FoldEnd = Literal["value", "speed", "turn", "lost", "points"]

_FIRST_STEP = 0.1
_LEAST_STEP = 1e-5
_LARGEST_STEP = 1.0
_MOST_CORRECTIONS = 8
_MOST_POINTS = 400
_BEND = 0.9
#: Change of the scaled unknowns by which derivatives are differenced.
_DIFFERENCE = 1e-4
#: Largest bordered determinant of a fold. The slope of the determinant is of order one.
_SINGULAR = 1e-8
#: Least component of the tangent along the second parameter for a correction at a constant value, which needs
#: fewer systems.
_ALONG = 0.3
#: Tolerance of a turning point as part of a step. The error of the value is of second order.
_TURN = 1e-3
#: A multiplier of a larger modulus is not the multiplier 1 of the fold.
_OUTSIDE = 1.0 + 1e-4


@dataclass(frozen=True, eq=False)
class Fold:
    """A fold at a value of the second parameter.

    Attributes
    ----------
    value : value of the second parameter
    orbit : the motion
    rising : whether the two motions that meet exist at lower speeds, so that a run-up ends both
    """

    value: float
    orbit: Orbit
    rising: bool

    @property
    def stable(self) -> bool:
        """Whether one of the two motions that meet is stable: the fold is a jump."""
        return bool(np.abs(self.orbit.multipliers[1]) < 1.0 and np.abs(self.orbit.multipliers[0]) < _OUTSIDE)


@dataclass(frozen=True, eq=False)
class FoldCurve:
    """Folds along one curve.

    Attributes
    ----------
    points : folds in order along the curve
    end : reason of the end. "value", "speed": an end of the range of values or speeds; "turn": the value
        turns, because two folds meet; "lost": a corner; "points": the largest number of points
    """

    points: tuple[Fold, ...]
    end: FoldEnd


class _Conditions(NamedTuple):
    """Conditions of a fold: the orbit closes, and the bordered determinant vanishes.

    Attributes
    ----------
    residual : residual of the closing conditions and, last, the bordered determinant
    derivative : derivative of the residual by X
    v, w : null vector of the derivatives by all unknowns but the speed, and null vector of the transpose
    fold : the motion
    """

    residual: FloatArray
    derivative: FloatArray
    v: FloatArray
    w: FloatArray
    fold: Fold


class FoldContinuation:
    """Follows folds of n cycles in (x, p, 1/T, second parameter), for values between low and high.

    The unknowns at a value are scaled by the sizes of the system at this value. A system that only changes
    scale then moves along the parameter alone. ``continuation_at`` gives the continuation of orbits at a
    value.
    """

    def __init__(self, continuation_at: Callable[[float], Continuation], low: float, high: float) -> None:
        self.continuation_at = continuation_at
        self.low = low
        self.high = high
        self._size = (high - low) / 20.0

    def _evaluate(self, Y: FloatArray) -> _Conditions:
        """Conditions of a fold at the unknowns Y = (X, second parameter)."""
        value = float(Y[-1]) * self._size
        along = self.continuation_at(value)
        X = Y[:-1]
        F, J, orbit = along.evaluate(X)
        A = J[:, :-1]
        left_vectors, _, right_vectors = np.linalg.svd(A)
        bordered = np.block([[A, left_vectors[:, -1:]], [right_vectors[-1:], np.zeros((1, 1))]])
        unit = np.append(np.zeros(F.size), 1.0)
        v = np.linalg.solve(bordered, unit)
        w = np.linalg.solve(bordered.T, unit)[:-1]
        determinant = v[-1]
        change = _DIFFERENCE * np.append(v[:-1], 0.0)
        bent = (along.evaluate(X + change)[1] - along.evaluate(X - change)[1]) / (2.0 * _DIFFERENCE)
        by_X = -w @ bent
        rising = float(by_X @ np.append(v[:-1], 0.0)) * float(w @ J[:, -1]) < 0.0
        return _Conditions(
            residual=np.append(F, determinant),
            derivative=np.vstack([J, by_X]),
            v=v[:-1],
            w=w,
            fold=Fold(value, orbit, rising),
        )

    def _by_value(self, Y: FloatArray, v: FloatArray, w: FloatArray) -> FloatArray:
        """Derivative of the residual and of the bordered determinant by the second parameter."""
        X = Y[:-1]
        value = float(Y[-1]) * self._size
        (F, J, _), (G, K, _) = (
            self.continuation_at(value + sign * _DIFFERENCE * self._size).evaluate(X) for sign in (1.0, -1.0)
        )
        return np.append(F - G, -w @ ((J - K)[:, :-1] @ v)) / (2.0 * _DIFFERENCE)

    def _correct(self, Y: FloatArray, border: FloatArray) -> tuple[FloatArray, Fold, FloatArray]:
        """Newton's method in the plane through Y with the normal ``border`` -> Y, fold, unit tangent."""
        plane = float(border @ Y)
        by_value = None
        for _ in range(_MOST_CORRECTIONS):
            conditions = self._evaluate(Y)
            if by_value is None:  # needs two more systems: computed once, iterations hardly change it
                by_value = self._by_value(Y, conditions.v, conditions.w)
            right = np.zeros((Y.size, 2))
            right[:-1, 0] = -conditions.residual
            right[-1, 0] = plane - border @ Y
            right[-1, 1] = 1.0
            try:
                matrix = np.vstack([np.column_stack([conditions.derivative, by_value]), border])
                step, tangent = np.linalg.solve(matrix, right).T
            except np.linalg.LinAlgError as error:
                raise NumericalError("the fold has no tangent there.") from error
            determinant = conditions.residual[-1]
            if conditions.fold.orbit.closes and abs(determinant) < _SINGULAR:
                return Y, conditions.fold, tangent / np.linalg.norm(tangent)
            if not np.abs(step).max() < 2.0:
                break
            Y = Y + step
        raise NumericalError("Newton's method did not settle on the fold.")

    def follow(self, value: float, orbit: Orbit, direction: float) -> FoldCurve:
        """Follow folds from a first fold to larger (+1) or smaller values (-1).

        The curve ends where the value turns, or at an end of a range. NumericalError: the start is no fold.
        """
        Y = np.append(self.continuation_at(value).unknowns(orbit), value / self._size)
        Y, fold, tangent = self._correct(Y, direction * np.eye(Y.size)[-1])
        points = [fold]
        step = _FIRST_STEP
        while len(points) < _MOST_POINTS:
            try:
                new, fold, new_tangent = self._correct(Y + step * tangent, self._border(tangent))
                new_tangent *= np.sign(new_tangent @ tangent)
                straight = float(new_tangent @ tangent) > _BEND
                good = straight and float(np.linalg.norm(new - Y)) < 2.0 * step
            except NumericalError:
                good = False
            if not good:
                step *= 0.5
                if step < _LEAST_STEP:
                    return FoldCurve(tuple(points), "lost")
                continue
            if not self.low <= fold.value <= self.high:
                edge = self.low if fold.value < self.low else self.high
                points += self._at_value(Y, new, edge)
                return FoldCurve(tuple(points), "value")
            if new_tangent[-1] * tangent[-1] < 0.0:
                return FoldCurve((*points, self._turning(Y, tangent, step, fold)), "turn")
            points.append(fold)
            Y = new
            tangent = new_tangent
            limits = self.continuation_at(fold.value).limits
            if not limits.slowest <= 1.0 / fold.orbit.period <= limits.fastest:
                return FoldCurve(tuple(points), "speed")
            step = min(1.5 * step, _LARGEST_STEP)
        return FoldCurve(tuple(points), "points")

    @staticmethod
    def _border(tangent: FloatArray) -> FloatArray:
        """Normal of the plane in which `_correct` looks for the next fold."""
        return tangent if abs(tangent[-1]) < _ALONG else np.eye(tangent.size)[-1]

    def _at_value(self, Y: FloatArray, new: FloatArray, value: float) -> list[Fold]:
        """The fold at an end of the range, between two points; empty where Newton's method fails."""
        part = (value / self._size - Y[-1]) / (new[-1] - Y[-1])
        try:
            return [self._correct(Y + part * (new - Y), np.eye(Y.size)[-1])[1]]
        except NumericalError:
            return []

    def _turning(self, Y: FloatArray, tangent: FloatArray, step: float, beyond: Fold) -> Fold:
        """The fold of the extreme value, less than a step beyond Y."""
        folds = [beyond]

        def along(ahead: float) -> float:
            _, fold, new_tangent = self._correct(Y + ahead * tangent, tangent)
            folds.append(fold)
            return float(new_tangent[-1] * np.sign(tangent[-1]))

        with contextlib.suppress(NumericalError, ValueError):
            brentq(along, 0.0, step, xtol=_TURN * step)
        return max(folds, key=lambda fold: fold.value * np.sign(tangent[-1]))
