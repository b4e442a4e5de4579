"""Coefficients of A(t) that are given as formulas, and matrices of such coefficients.

Piecewise polynomials and Fourier series, their sums and products. Each gives its Taylor polynomial on an
interval with a bound on the remainder and on the rounding. A callable cannot give such a bound.

Sources: docs/theory/proven_bounds.md, "Coefficients given as formulas".
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from floquet.engine.neutral import hamiltonian
from lumped.arguments import real_array, real_number, real_numbers
from lumped.errors import refuse, shown
from lumped.typing import FloatArray

_U = 0.5 * float(np.finfo(np.float64).eps)
_SAME_PERIOD = 1e-9  # part of a period by which two statements of one period may differ


class Coefficient(ABC):
    """A function of time that is analytic between its breaks.

    Attributes
    ----------
    breaks : times at which the function jumps or has a kink [s]
    """

    breaks: tuple[float, ...] = ()

    @abstractmethod
    def __call__(self, times: npt.ArrayLike) -> FloatArray:
        """Values at times [s], any shape."""

    @abstractmethod
    def taylor(self, start: FloatArray, length: FloatArray, degree: int) -> tuple[FloatArray, FloatArray]:
        """Polynomials on intervals start + length s [s], 0 <= s <= 1, (k,), that no break lies inside.

        Returns (k, degree + 1) coefficients of the powers of s, and (k,) bounds on their errors.
        """

    @property
    def own_period(self) -> float | None:
        """The shortest period that the function states [s]; None: a constant, a sum or a product."""
        return None

    @abstractmethod
    def repeats(self, period: float) -> bool:
        """Whether the function repeats after a period [s] of the system, to 1e-9 of the period.

        The period of the system is a whole number of periods of the function.
        """

    def over(self, period: float) -> Coefficient:
        """The function with all its pieces from 0 to the period [s] of the system, which it `repeats`."""
        del period
        return self

    def __add__(self, other: Coefficient | float) -> Coefficient:
        """The sum."""
        return Sum(self, _as_coefficient(other))

    def __mul__(self, other: Coefficient | float) -> Coefficient:
        """The product."""
        return Product(self, _as_coefficient(other))

    def __neg__(self) -> Coefficient:
        """The negative."""
        return self * -1.0

    def __sub__(self, other: Coefficient | float) -> Coefficient:
        """The difference."""
        return self + _as_coefficient(other) * -1.0

    __radd__ = __add__
    __rmul__ = __mul__

    def __rsub__(self, other: float) -> Coefficient:
        """The difference from a number."""
        return -self + other


class PiecewisePolynomial(Coefficient):
    """One polynomial on each interval between increasing times.

    In a `PeriodicSystem` the pieces together are one period of the function, or the period of the system is a
    whole number of times as long.

    Parameters
    ----------
    breaks : (P+1,) ends of the pieces [s]; a polynomial by itself continues beyond the ends
    coefficients : (P, d+1) of the powers of the time since the start of the piece, lowest power first
    """

    def __init__(self, breaks: npt.ArrayLike, coefficients: npt.ArrayLike) -> None:
        self._ends = real_numbers("breaks", breaks, increasing=True, unit="s")
        self.rows = np.atleast_2d(real_array("coefficients", coefficients))
        if self.rows.shape[0] != self._ends.size - 1 or not np.isfinite(self.rows).all():
            allowed = f"({self._ends.size - 1}, degree + 1), finite"
            raise refuse("coefficients", f"shape {self.rows.shape}", allowed, "Give one row per piece.")
        self.breaks = tuple(self._ends.tolist())
        self._span = float(self._ends[-1] - self._ends[0])

    @property
    def own_period(self) -> float:
        """See `Coefficient`: the pieces together."""
        return self._span

    def repeats(self, period: float) -> bool:
        """See `Coefficient`."""
        return _whole(period, self._span) > 0

    def over(self, period: float) -> PiecewisePolynomial:
        """See `Coefficient`; the breaks of each repetition are rounded."""
        start, end = self._ends[[0, -1]]
        count = _whole(period, self._span)
        if count == 1 and start <= 0.0 and end >= period * (1.0 - _SAME_PERIOD):
            return self
        first = math.floor(-start / self._span)
        last = first + count + bool(start + first * self._span < 0.0)
        ends = np.concatenate([self._ends[:-1] + k * self._span for k in range(first, last)])
        ends = np.append(ends, start + last * self._span)
        repeated = PiecewisePolynomial(ends, np.tile(self.rows, (last - first, 1)))
        repeated._span = count * self._span
        return repeated

    def _piece(self, times: FloatArray) -> npt.NDArray[np.intp]:
        return np.clip(np.searchsorted(self._ends, times, side="right") - 1, 0, self._ends.size - 2)

    def __call__(self, times: npt.ArrayLike) -> FloatArray:
        """See `Coefficient`."""
        t = np.asarray(times, dtype=float)
        piece = self._piece(t)
        value = np.zeros_like(t)
        for j in range(self.rows.shape[1] - 1, -1, -1):
            value = value * (t - self._ends[piece]) + self.rows[piece, j]
        return value

    def taylor(self, start: FloatArray, length: FloatArray, degree: int) -> tuple[FloatArray, FloatArray]:
        """See `Coefficient`."""
        piece = self._piece(start)  # the middle of a piece one unit in the last place wide rounds to its end
        return polynomial_taylor(Polynomials(self._ends[piece], self.rows[piece]), start, length, degree)


class Polynomials(NamedTuple):
    """A polynomial for each of k steps.

    Attributes
    ----------
    origins : (k,) times [s] from which their time counts
    rows : (k, d+1) of the powers of this time, lowest power first
    """

    origins: FloatArray
    rows: FloatArray


def polynomial_taylor(
    polynomials: Polynomials, start: FloatArray, length: FloatArray, degree: int
) -> tuple[FloatArray, FloatArray]:
    """`Coefficient.taylor` of polynomials; the time since their origin is wrong by 2 u of the times."""
    origins, rows = polynomials
    x = start - origins
    highest = rows.shape[1] - 1
    reach = np.abs(x) + length
    sizes = np.abs(rows) * reach[:, None] ** np.arange(highest + 1)
    slope = (sizes * np.arange(highest + 1)).sum(axis=1) / reach
    place = 4.0 * _U * (np.abs(start) + np.abs(origins) + length)
    shifted = rows.copy()
    for j in range(highest):
        for i in range(highest - 1, j - 1, -1):
            shifted[:, i] += x * shifted[:, i + 1]
    shifted *= length[:, None] ** np.arange(highest + 1)
    errors = (4.0 * highest + 8.0) * _U * sizes.sum(axis=1) + place * slope
    errors += np.abs(shifted[:, degree + 1 :]).sum(axis=1)
    out = np.zeros((start.size, degree + 1))
    out[:, : highest + 1] = shifted[:, : degree + 1]
    return out, errors


class FourierSeries(Coefficient):
    """Mean + sum of cosines[k-1] cos(k Omega t) + sines[k-1] sin(k Omega t), Omega = 2 pi/period.

    Parameters
    ----------
    period : [s]
    mean : constant term
    cosines, sines : coefficients of the harmonics 1, 2, ...
    """

    def __init__(
        self, period: float, mean: float, cosines: Sequence[float] = (), sines: Sequence[float] = ()
    ) -> None:
        count = max(len(cosines), len(sines))
        self._period = real_number("period", period, 0.0, above=True, unit="s")
        self._omega = 2.0 * math.pi / self._period
        self._mean = real_number("mean", mean)
        self._a, self._b = (np.zeros(count) for _ in range(2))
        self._a[: len(cosines)] = cosines
        self._b[: len(sines)] = sines
        self._order = np.arange(1, count + 1)

    @property
    def own_period(self) -> float | None:
        """See `Coefficient`; harmonics of the orders 2, 4, 6 alone have half the period, and so on."""
        orders = self._order[(self._a != 0.0) | (self._b != 0.0)]
        return self._period / float(np.gcd.reduce(orders)) if orders.size else None

    def repeats(self, period: float) -> bool:
        """See `Coefficient`."""
        own_period = self.own_period
        return own_period is None or _whole(period, own_period) > 0

    def __call__(self, times: npt.ArrayLike) -> FloatArray:
        """See `Coefficient`."""
        angle = np.multiply.outer(np.asarray(times, dtype=float) * self._omega, self._order)
        return np.asarray(self._mean + np.cos(angle) @ self._a + np.sin(angle) @ self._b)

    def taylor(self, start: FloatArray, length: FloatArray, degree: int) -> tuple[FloatArray, FloatArray]:
        """See `Coefficient`."""
        return harmonics_taylor(self.harmonics, start, length, degree)

    @property
    def harmonics(self) -> Harmonics:
        """The numbers of the series, as those of one step."""
        return Harmonics(np.array([self._omega]), np.array([self._mean]), self._a[None], self._b[None])


class Harmonics(NamedTuple):
    """A Fourier series for each of k steps; k = 1: the same one for all steps.

    Attributes
    ----------
    omega : (k,) angular frequency of the first harmonic [rad/s]
    mean : (k,)
    cosines, sines : (k, harmonics)
    """

    omega: FloatArray
    mean: FloatArray
    cosines: FloatArray
    sines: FloatArray


def harmonics_taylor(
    harmonics: Harmonics, start: FloatArray, length: FloatArray, degree: int
) -> tuple[FloatArray, FloatArray]:
    """`Coefficient.taylor` of Fourier series; cos and sin of the library are taken to be right to 4 u."""
    omega, mean, a, b = harmonics
    order = np.arange(1, a.shape[1] + 1)
    angle = (start * omega)[:, None] * order
    turn = (length * omega)[:, None] * order
    cos = np.cos(angle)
    sin = np.sin(angle)
    derivatives = [a * cos + b * sin, b * cos - a * sin]
    size = np.abs(a) + np.abs(b)
    out = np.zeros((start.size, degree + 1))
    factor = np.ones_like(turn)
    for j in range(degree + 1):
        sign = 1.0 if j % 4 < 2 else -1.0
        out[:, j] = sign * (derivatives[j % 2] * factor).sum(axis=1)
        factor = factor * turn / (j + 1)
    out[:, 0] += mean
    # Lagrange's remainder, and the rounding of the angle, of cos and sin and of the sums. 1e-3: the rest.
    rounding = (4.0 * np.abs(angle) + 4.0 * degree + 16.0 + order.size) * _U * np.exp(np.minimum(turn, 500.0))
    return out, 1.001 * (size * (factor + rounding)).sum(axis=1) + 2.0 * _U * np.abs(mean)


class OfTwo(Coefficient):
    """A sum or a product."""

    def __init__(self, first: Coefficient, second: Coefficient) -> None:
        self.first = first
        self.second = second
        self.breaks = first.breaks + second.breaks

    def repeats(self, period: float) -> bool:
        """See `Coefficient`: both parts repeat, or without breaks the samples of the sum or product do."""
        if self.first.repeats(period) and self.second.repeats(period):
            return True
        if self.breaks:
            return False
        times = period * np.array([0.0, 0.17, 0.31, 0.47, 0.61, 0.83])
        first = self(times)
        return bool(np.abs(self(times + period) - first).max() <= _SAME_PERIOD * np.abs(first).max())

    def over(self, period: float) -> Coefficient:
        """See `Coefficient`."""
        return type(self)(self.first.over(period), self.second.over(period)) if self.breaks else self


class Sum(OfTwo):
    """A sum of two coefficients."""

    def __call__(self, times: npt.ArrayLike) -> FloatArray:
        return self.first(times) + self.second(times)

    def taylor(self, start: FloatArray, length: FloatArray, degree: int) -> tuple[FloatArray, FloatArray]:
        parts = (Series(*f.taylor(start, length, degree)) for f in (self.first, self.second))
        return sum_taylor(*parts)


class Product(OfTwo):
    """A product of two coefficients."""

    def __call__(self, times: npt.ArrayLike) -> FloatArray:
        return self.first(times) * self.second(times)

    def taylor(self, start: FloatArray, length: FloatArray, degree: int) -> tuple[FloatArray, FloatArray]:
        parts = (Series(*f.taylor(start, length, degree)) for f in (self.first, self.second))
        return product_taylor(*parts)


class Series(NamedTuple):
    """Polynomials (k, degree + 1) on k steps, and bounds (k,) on their errors."""

    coefficients: FloatArray
    errors: FloatArray


def sum_taylor(first: Series, second: Series) -> tuple[FloatArray, FloatArray]:
    """`Coefficient.taylor` of a sum."""
    (a, da), (b, db) = first, second
    return a + b, (da + db + 2.0 * _U * (np.abs(a) + np.abs(b)).sum(axis=1)) * (1.0 + 8.0 * _U)


def product_taylor(first: Series, second: Series) -> tuple[FloatArray, FloatArray]:
    """`Coefficient.taylor` of a product."""
    (a, da), (b, db) = first, second
    degree = a.shape[1] - 1
    out = np.zeros((len(a), 2 * degree + 1))
    for j in range(degree + 1):
        out[:, j : j + degree + 1] += a[:, j, None] * b
    size_a = np.abs(a).sum(axis=1)
    size_b = np.abs(b).sum(axis=1)
    errors = np.abs(out[:, degree + 1 :]).sum(axis=1) + da * size_b + db * size_a + da * db
    errors += (degree + 8.0) * 2.0 * _U * size_a * size_b
    return out[:, : degree + 1], errors * (1.0 + 8.0 * _U)


def _whole(period: float, of_function: float) -> int:
    """How many periods of a function are one period of a system; 0: no whole number."""
    count = round(period / of_function)
    return count if abs(period - count * of_function) <= _SAME_PERIOD * of_function * max(count, 1) else 0


def _as_coefficient(value: Coefficient | float) -> Coefficient:
    """A coefficient as it is; a number as a constant coefficient."""
    if isinstance(value, Coefficient):
        return value
    return FourierSeries(1.0, real_number("coefficient", value))


class PeriodicMatrix:
    """B_0 + f_1(t) B_1 + f_2(t) B_2 + ...: a `PeriodicSystem` of such a matrix has PROVEN bounds.

    Parameters
    ----------
    constant : B_0, (n, n), or a number where n = 1
    terms : pairs (f_j, B_j) of a `Coefficient` and a matrix of the same shape
    errors : (1 + terms, n, n) bounds on the errors of the entries of B_0, B_1, ...; None: they are exact

    Attributes
    ----------
    dimension : n
    breaks : times at which a coefficient jumps or has a kink [s]
    functions : the f_j
    matrices, errors : (1 + terms, n, n) B_0, B_1, ..., and bounds on the errors of their entries

    Raises
    ------
    ParameterError : a matrix that is not square, of another shape, or not of finite numbers
    """

    def __init__(
        self,
        constant: npt.ArrayLike,
        *terms: tuple[Coefficient, npt.ArrayLike],
        errors: FloatArray | None = None,
    ) -> None:
        matrices = [square("constant", constant)]
        self.dimension = matrices[0].shape[0]
        for k, (function, matrix) in enumerate(terms, 1):
            if not isinstance(function, Coefficient):
                wanted = "a FourierSeries or a PiecewisePolynomial"
                raise refuse(f"function of term {k}", shown(function), wanted, "Give (function, matrix).")
            matrices.append(square(f"matrix of term {k}", matrix, self.dimension))
        self.matrices = np.stack(matrices)
        self.functions = tuple(function for function, _ in terms)
        self.breaks = tuple(sorted({t for function in self.functions for t in function.breaks}))
        self.errors = np.zeros_like(self.matrices) if errors is None else errors

    @property
    def hamiltonian(self) -> bool:
        """Whether J A(t) is symmetric at all times, J = [[0, I], [-I, 0]], by the exact matrices."""
        return not self.errors.any() and hamiltonian(self.matrices)

    def over(self, name: str, period: float) -> PeriodicMatrix:
        """The matrix with all pieces of its functions from 0 to the period [s]; refuses another period.

        ``name`` is that of the matrix in the refusal.
        """
        for k, function in enumerate(self.functions, 1):
            if not function.repeats(period):
                allowed = f"a function that repeats after the period, {period:g} s"
                stated = function.own_period
                value = "another period" if stated is None else f"the period {stated:g} s"
                raise refuse(f"{name}, term {k}", value, allowed, "Correct one of the two periods.")
        functions = [function.over(period) for function in self.functions]
        if all(new is old for new, old in zip(functions, self.functions, strict=True)):
            return self
        return PeriodicMatrix(
            self.matrices[0], *zip(functions, self.matrices[1:], strict=True), errors=self.errors
        )

    def __call__(self, times: FloatArray) -> FloatArray:
        """Values at times (k,), (k, n, n)."""
        factors = np.stack([np.ones(np.shape(times)), *(f(times) for f in self.functions)], axis=-1)
        return np.tensordot(factors, self.matrices, axes=1)


def square(field: str, value: npt.ArrayLike, n: int | None = None) -> FloatArray:
    """Return a square matrix of n rows; n None: of any number of rows. A number is a matrix of one row."""
    matrix = real_array(field, value)
    matrix = matrix.reshape(1, 1) if matrix.ndim == 0 else matrix
    rows = n or len(matrix)
    if matrix.shape != (rows, rows) or not rows:
        wanted = f"a square matrix ({n}, {n})" if n else "a square matrix (n, n)"
        raise refuse(field, f"shape {matrix.shape}", wanted, "Check its rows and columns.")
    return matrix
