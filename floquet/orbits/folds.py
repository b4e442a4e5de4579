"""Curves of folds over a second parameter: where two motions meet, and where folds themselves meet.

Sources: docs/theory/orbits.md, "Fold curves"; bordered matrix: Govaerts, Numerical methods for bifurcations
of dynamical equilibria, 2000, ch. 4.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

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
#: Bordered determinant of a fold, whose slope is of order one.
_SINGULAR = 1e-8
#: Where the tangent has no less of the second parameter than this its value is held, which saves systems.
_ALONG = 0.3
#: Part of a step within which a turning point is found; the value there is good to the square.
_TURN = 1e-3
#: A multiplier this much outside the unit circle is not that of the fold.
_OUTSIDE = 1.0 + 1e-4


@dataclass(frozen=True, eq=False)
class Fold:
    """A fold at a value of the second parameter.

    Attributes
    ----------
    value : of the second parameter
    orbit : the motion
    rising : whether the motions that meet there exist at lower speeds, so that they end on running up
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
    points : in order
    end : why it ends: at an end of the range of values or of speeds; where the value turns, as two folds
        meet; or it is lost, at a corner
    """

    points: tuple[Fold, ...]
    end: FoldEnd


class FoldContinuation:
    """Follows folds of n cycles in (x, p, 1/T, second parameter), for values between low and high.

    Unknowns are scaled at each value by that value's own sizes, so that a system that only changes its scale
    moves along the parameter alone. ``at`` gives the continuation of orbits at a value.
    """

    def __init__(self, at: Callable[[float], Continuation], low: float, high: float) -> None:
        self.at = at
        self.low = low
        self.high = high
        self._size = (high - low) / 20.0

    def _evaluate(self, Y: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, Fold]:
        """Residual with the bordered determinant, their derivatives by X, null vectors, and the motion."""
        value = float(Y[-1]) * self._size
        along = self.at(value)
        X = Y[:-1]
        F, J, orbit = along.evaluate(X)
        A = J[:, :-1]
        left, _, right = np.linalg.svd(A)
        border = np.block([[A, left[:, -1:]], [right[-1:], np.zeros((1, 1))]])
        unit = np.append(np.zeros(F.size), 1.0)
        v, w = np.linalg.solve(border, unit), np.linalg.solve(border.T, unit)[:-1]
        change = _DIFFERENCE * np.append(v[:-1], 0.0)
        bent = (along.evaluate(X + change)[1] - along.evaluate(X - change)[1]) / (2.0 * _DIFFERENCE)
        by_X = -w @ bent
        rising = float(by_X @ np.append(v[:-1], 0.0)) * float(w @ J[:, -1]) < 0.0
        return np.append(F, v[-1]), np.vstack([J, by_X]), v[:-1], w, Fold(value, orbit, rising)

    def _by_value(self, Y: FloatArray, v: FloatArray, w: FloatArray) -> FloatArray:
        """Derivative of the residual and of the bordered determinant by the second parameter."""
        X = Y[:-1]
        value = float(Y[-1]) * self._size
        (F, J, _), (G, K, _) = (
            self.at(value + sign * _DIFFERENCE * self._size).evaluate(X) for sign in (1.0, -1.0)
        )
        return np.append(F - G, -w @ ((J - K)[:, :-1] @ v)) / (2.0 * _DIFFERENCE)

    def _correct(self, Y: FloatArray, border: FloatArray) -> tuple[FloatArray, Fold, FloatArray]:
        """Newton's method in the plane through Y across the border -> Y, the fold, the tangent."""
        plane = float(border @ Y)
        by_value = None
        for _ in range(_MOST_CORRECTIONS):
            F, J, v, w, fold = self._evaluate(Y)
            if by_value is None:  # needs two more systems: once for all iterations, which hardly change it
                by_value = self._by_value(Y, v, w)
            right = np.zeros((Y.size, 2))
            right[:-1, 0] = -F
            right[-1, 0] = plane - border @ Y
            right[-1, 1] = 1.0
            try:
                matrix = np.vstack([np.column_stack([J, by_value]), border])
                step, tangent = np.linalg.solve(matrix, right).T
            except np.linalg.LinAlgError as error:
                raise NumericalError("the fold has no tangent there.") from error
            if fold.orbit.closes and abs(F[-1]) < _SINGULAR:
                return Y, fold, tangent / np.linalg.norm(tangent)
            if not np.abs(step).max() < 2.0:
                break
            Y = Y + step
        raise NumericalError("Newton's method did not settle on the fold.")

    def follow(self, value: float, orbit: Orbit, direction: float) -> FoldCurve:
        """Folds from one on, to larger (+1) or smaller values (-1), until the value turns or a range ends.

        Raises NumericalError where there is no fold at the start.
        """
        Y = np.append(self.at(value).unknowns(orbit), value / self._size)
        Y, fold, tangent = self._correct(Y, direction * np.eye(Y.size)[-1])
        points = [fold]
        step = _FIRST_STEP
        while len(points) < _MOST_POINTS:
            try:
                new, fold, turned = self._correct(Y + step * tangent, self._border(tangent))
                turned *= np.sign(turned @ tangent)
                good = float(turned @ tangent) > _BEND and float(np.linalg.norm(new - Y)) < 2.0 * step
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
            if turned[-1] * tangent[-1] < 0.0:
                return FoldCurve((*points, self._turning(Y, tangent, step, fold)), "turn")
            points.append(fold)
            Y = new
            tangent = turned
            limits = self.at(fold.value).limits
            if not limits.slowest <= 1.0 / fold.orbit.period <= limits.fastest:
                return FoldCurve(tuple(points), "speed")
            step = min(1.5 * step, _LARGEST_STEP)
        return FoldCurve(tuple(points), "points")

    @staticmethod
    def _border(tangent: FloatArray) -> FloatArray:
        """Normal of the plane to correct in."""
        return tangent if abs(tangent[-1]) < _ALONG else np.eye(tangent.size)[-1]

    def _at_value(self, Y: FloatArray, new: FloatArray, value: float) -> list[Fold]:
        """The fold at an end of the range, between two points."""
        part = (value / self._size - Y[-1]) / (new[-1] - Y[-1])
        try:
            return [self._correct(Y + part * (new - Y), np.eye(Y.size)[-1])[1]]
        except NumericalError:
            return []

    def _turning(self, Y: FloatArray, tangent: FloatArray, step: float, beyond: Fold) -> Fold:
        """The fold of the extreme value, less than a step ahead."""
        result = [beyond]

        def along(ahead: float) -> float:
            _, fold, turned = self._correct(Y + ahead * tangent, tangent)
            result.append(fold)
            return float(turned[-1] * np.sign(tangent[-1]))

        with contextlib.suppress(NumericalError, ValueError):
            brentq(along, 0.0, step, xtol=_TURN * step)
        return max(result, key=lambda fold: fold.value * np.sign(tangent[-1]))
