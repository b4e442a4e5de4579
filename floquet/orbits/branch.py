"""Branches of periodic motions over the speed by pseudo-arclength continuation.

Sources: docs/theory/orbits.md, "Branches"; Keller, Numerical solution of bifurcation and nonlinear eigenvalue
problems, 1977.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from floquet.orbits.closing import closing_residual
from floquet.orbits.deadline import ENDLESS, Deadline
from floquet.orbits.orbit import Orbit
from floquet.orbits.system import ContactSystem
from lumped.errors import NumericalError
from lumped.typing import FloatArray

End = Literal["range", "amplitude", "closed", "doubling", "lost", "points", "calm", "time"]

_FIRST_STEP = 0.02
_LEAST_STEP = 1e-7
_LARGEST_STEP = 0.2
_CORNER_STEP = 2e-4
_MOST_CORRECTIONS = 8
#: Relative change of T for differences of the coefficients that depend on T.
_PERIOD_STEP = 1e-5
#: Least cosine between the tangents of neighbours.
_BEND = 0.95
#: Relative change of the speed that counts as of order one: less than the width of a resonance, at any speed.
_SPEED = 0.04
#: Logarithm of speeds beyond which Newton's method has gone astray.
_MOST_LOG = 100.0
#: Phase rates are about this many times the displacements.
_RATE = 10.0
#: Distance (the largest step is 0.2) within which a derivative by T through the coefficients is used again.
#: The distance decides how fast Newton's method converges, not to which motion.
_ALIKE = 0.5


@dataclass(frozen=True)
class Family:
    """A system over its period.

    Attributes
    ----------
    at : T [s] -> the system
    constant : whether the coefficients over the phase are equal at all periods
    """

    at: Callable[[float], ContactSystem]
    constant: bool


@dataclass(frozen=True)
class Limits:
    """Ends of branches, and the sizes that scale the unknowns to order one.

    Attributes
    ----------
    slowest, fastest : range of 1/T [1/s]
    length : size of displacements
    parameter : size of the free parameter
    amplitude : largest motion of the output from its mean; a branch ends at a larger motion
    frequency : frequency of the fastest natural motion while contacts hold, with the mean stiffness [1/s]
    points : largest number of orbits in a direction
    calm : orbit of one cycle -> whether the branch may end there, because nothing happens beyond the orbit;
        None: no branch ends for this reason
    """

    slowest: float
    fastest: float
    length: float
    parameter: float
    amplitude: float
    frequency: float
    points: int = 4000
    calm: Callable[[Orbit], bool] | None = None


@dataclass(eq=False)
class Path:
    """Points of a branch in one direction: scaled unknowns X, motions, unit tangents, reason of the end.

    ``step`` is the length of the next step. A path that the deadline has ended continues with this step.
    """

    X: list[FloatArray]
    orbits: list[Orbit]
    tangents: list[FloatArray]
    end: End = "points"
    step: float = _FIRST_STEP

    def append(self, X: FloatArray, orbit: Orbit, tangent: FloatArray) -> None:
        self.X.append(X)
        self.orbits.append(orbit)
        self.tangents.append(tangent)


class Continuation:
    """Follows orbits of n cycles in the unknowns (x, p, log 1/T), each scaled to order one."""

    def __init__(self, family: Family, n: int, limits: Limits) -> None:
        self.family = family
        self.n = n
        self.limits = limits
        system = family.at(1.0 / limits.slowest)
        self.size = system.size
        self.balanced = system.balanced
        state = np.repeat([limits.length, _RATE * limits.length], self.size // 2)
        extra = [limits.parameter] if self.balanced else []
        self.scale = np.concatenate([state, extra, [_SPEED]])
        self._rows = np.concatenate([state, state[-1:] if self.balanced else []])
        # Derivatives come by the start, T and the parameter; the unknowns end with log 1/T.
        self._columns = [*range(self.size), *([self.size + 1] if self.balanced else []), self.size]
        self._coefficients: tuple[FloatArray, FloatArray] | None = None

    def unknowns(self, orbit: Orbit) -> FloatArray:
        """The scaled vector X of an orbit."""
        extra = [orbit.parameter] if self.balanced else []
        return np.asarray(np.concatenate([orbit.start, extra, [-np.log(orbit.period)]]) / self.scale)

    def evaluate(
        self, X: FloatArray, by_coefficients: FloatArray | None = None
    ) -> tuple[FloatArray, FloatArray, Orbit]:
        """Scaled residual F of the closing conditions, derivative of F by X, and the motion.

        The motion is periodic where F = 0. ``by_coefficients`` is a result of the method `by_coefficients`
        at a place nearby. None: the result is computed here.
        """
        x, T, parameter = self._values(X)
        system = self.family.at(T)
        r, J, run = closing_residual(system, x, T, self.n, parameter)
        if not self.family.constant:
            J[:, self.size] += self.by_coefficients(X) if by_coefficients is None else by_coefficients
        J[:, self.size] *= -T
        J = J[:, self._columns] * self.scale / self._rows[:, None]
        return r / self._rows, J, Orbit(system, T, self.n, parameter, run)

    def _values(self, X: FloatArray) -> tuple[FloatArray, float, float]:
        """Start, T and parameter of scaled unknowns."""
        values = X * self.scale
        if abs(values[-1]) > _MOST_LOG:
            raise NumericalError("the branch left for speeds beyond all numbers.")
        return (
            values[: self.size],
            float(np.exp(-values[-1])),
            float(values[self.size]) if self.balanced else 0.0,
        )

    def by_coefficients(self, X: FloatArray) -> FloatArray:
        """Derivative of the residual by T through the coefficients alone, by central differences."""
        x, T, parameter = self._values(X)
        ends = []
        for sign in (1.0, -1.0):
            run = self.family.at(T * (1.0 + sign * _PERIOD_STEP)).run(x, T, self.n, parameter)
            ends.append(np.concatenate([run.end, run.accumulated]))
        return np.asarray((ends[0] - ends[1]) / (2.0 * _PERIOD_STEP * T))

    def _by_coefficients_near(self, X: FloatArray) -> FloatArray | None:
        """Result of `by_coefficients` at a nearby place. None: no coefficient depends on T.

        The nearby place does not move a fold. At a fold the speed component of the tangent vanishes together
        with the determinant of the derivatives by all unknowns but the speed.
        """
        if self.family.constant:
            return None
        if self._coefficients is None or np.linalg.norm(X - self._coefficients[0]) > _ALIKE:
            self._coefficients = X, self.by_coefficients(X)
        return self._coefficients[1]

    def correct(self, X: FloatArray, border: FloatArray) -> tuple[FloatArray, Orbit, FloatArray, int]:
        """Newton's method in the plane through X with the normal ``border``.

        Returns X, orbit, unit tangent and the number of iterations.
        """
        plane = float(border @ X)
        right = np.zeros((X.size, 2))
        right[-1, 1] = 1.0
        by_coefficients = self._by_coefficients_near(X)
        for iteration in range(_MOST_CORRECTIONS):
            F, J, orbit = self.evaluate(X, by_coefficients)
            right[:-1, 0] = -F
            right[-1, 0] = plane - border @ X
            try:
                step, tangent = np.linalg.solve(np.vstack([J, border]), right).T
            except np.linalg.LinAlgError as error:
                raise NumericalError("the branch has no tangent there.") from error
            if orbit.closes:
                return X, orbit, tangent / np.linalg.norm(tangent), iteration
            if not np.abs(step).max() < 10.0:
                break
            X = X + step
        raise NumericalError("Newton's method did not settle on the branch.")

    def follow(
        self,
        orbit: Orbit,
        direction: float = 1.0,
        tangent: FloatArray | None = None,
        deadline: Deadline = ENDLESS,
    ) -> Path:
        """Follow a branch from an orbit towards higher (+1) or lower speeds (-1) until a limit ends the path.

        ``tangent`` replaces the first direction where the orbit is a bifurcation.
        """
        X = self.unknowns(orbit)
        if tangent is None:
            X, orbit, tangent, _ = self.correct(X, direction * np.eye(X.size)[-1])
        path = Path([X], [orbit], [tangent])
        self.extend(path, deadline)
        return path

    def extend(self, path: Path, deadline: Deadline = ENDLESS) -> None:
        """Continue a path from the last orbit until a limit or the deadline ends the path."""
        step = path.step
        path.end = "points"
        while len(path.orbits) < self.limits.points:
            if deadline.passed:
                path.end = "time"
                path.step = step
                break
            X = path.X[-1]
            tangent = path.tangents[-1]
            try:
                new, orbit, new_tangent, iterations = self.correct(X + step * tangent, tangent)
                straight = float(new_tangent @ tangent) > _BEND
                good = straight and float(np.linalg.norm(new - X)) < 2.0 * step
            except NumericalError:
                good = False
            if not good:
                step *= 0.5
                if step < _LEAST_STEP:
                    if not self._pass_corner(path):
                        path.end = "lost"
                        break
                    step = _CORNER_STEP
                continue
            if self.n % 2 == 0 and self._falls_back(path, orbit):
                path.end = "doubling"
                break
            path.append(new, orbit, new_tangent)
            end = self._end(path, step)
            if end is not None:
                path.end = end
                break
            if iterations <= 3:
                step = min(1.5 * step, _LARGEST_STEP)
            elif iterations > 5:
                step *= 0.6

    def _falls_back(self, path: Path, orbit: Orbit) -> bool:
        """Whether the path has passed the motion of half the cycles.

        At this motion the difference between the first and the second half of the cycles changes sign.
        """
        first = path.orbits[1] if len(path.orbits) > 1 else orbit
        one, two = (o.run.states[self.n // 2] - o.start for o in (first, orbit))
        scale = self.scale[: self.size]
        return float((one / scale) @ (two / scale)) <= 0.0

    def _end(self, path: Path, step: float) -> End | None:
        run = path.orbits[-1].run
        rate = 1.0 / path.orbits[-1].period
        if not self.limits.slowest <= rate <= self.limits.fastest:
            return "range"
        if max(run.most - run.mean, run.mean - run.least) > self.limits.amplitude:
            return "amplitude"
        if self.n == 1 and self.limits.calm is not None and self.limits.calm(path.orbits[-1]):
            return "calm"
        return "closed" if len(path.X) > 10 and self._returns(path, step) else None

    def _returns(self, path: Path, step: float) -> bool:
        """Whether the next step reaches the first orbit again, at the start of any cycle of the orbit."""
        for start in path.orbits[0].shifted():
            first = path.X[0].copy()
            first[: self.size] = start / self.scale[: self.size]
            back = first - path.X[-1]
            if float(np.linalg.norm(back)) < step and float(back @ path.tangents[-1]) > 0.0:
                return True
        return False

    def _pass_corner(self, path: Path) -> bool:
        """Continue a path beyond a corner, where an event makes the branch turn sharply.

        The new direction is the tangent of a motion just beyond the corner. Returns whether the path
        continues.
        """
        X = path.X[-1]
        tangent = path.tangents[-1]
        try:
            _, J, _ = self.evaluate(X + 100.0 * _LEAST_STEP * tangent)
        except NumericalError:
            return False
        _, _, right_vectors = np.linalg.svd(J)
        null = right_vectors[-1]
        to_previous = path.X[-2] - X if len(path.X) > 1 else -tangent
        for direction in (null, -null):
            try:
                new, orbit, new_tangent, _ = self.correct(X + _CORNER_STEP * direction, direction)
            except NumericalError:
                continue
            step = new - X
            lengths = float(np.linalg.norm(step) * np.linalg.norm(to_previous))
            goes_back = float(step @ to_previous) > 0.999 * lengths
            if not goes_back and float(new_tangent @ direction) > 0.0:
                path.append(new, orbit, new_tangent)
                return True
        return False
