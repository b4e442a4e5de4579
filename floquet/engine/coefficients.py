"""Coefficients of A(t), and matrices of them, that are given as formulas: their breaks are known.

Piecewise polynomials and Fourier series, their sums and products.

Sources: docs/theory/floquet.md, "From matrices of mass, damping and stiffness".
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from lumped.arguments import real_array, real_number, real_numbers
from lumped.errors import refuse, shown
from lumped.typing import FloatArray


class Coefficient(ABC):
    """A function of time that is analytic between its breaks.

    Attributes
    ----------
    breaks : times at which it jumps or has a kink [s]
    """

    breaks: tuple[float, ...] = ()

    @abstractmethod
    def __call__(self, times: npt.ArrayLike) -> FloatArray:
        """Values at times [s], any shape."""

    def repeats(self, period: float) -> bool:
        """Whether it is the same one period later; one with breaks is asked for its first period only."""
        if self.breaks:
            return True
        times = period * np.array([0.0, 0.17, 0.31, 0.47, 0.61, 0.83])
        now, later = self(times), self(times + period)
        return bool(np.abs(later - now).max() <= 1e-9 * np.abs(now).max())

    def __add__(self, other: Coefficient | float) -> Coefficient:
        """The sum."""
        return _Joined(np.add, self, _known(other))

    def __mul__(self, other: Coefficient | float) -> Coefficient:
        """The product."""
        return _Joined(np.multiply, self, _known(other))

    def __neg__(self) -> Coefficient:
        """The negative."""
        return self * -1.0

    def __sub__(self, other: Coefficient | float) -> Coefficient:
        """The difference."""
        return self + _known(other) * -1.0

    __radd__, __rmul__ = __add__, __mul__

    def __rsub__(self, other: float) -> Coefficient:
        """The difference from a number."""
        return -self + other


class PiecewisePolynomial(Coefficient):
    """One polynomial on each interval between increasing times.

    Parameters
    ----------
    breaks : (P+1,) ends of the pieces [s]; beyond them the first and the last piece go on
    coefficients : (P, d+1) of the powers of the time since the start of the piece, lowest first
    """

    def __init__(self, breaks: npt.ArrayLike, coefficients: npt.ArrayLike) -> None:
        self._ends = real_numbers("breaks", breaks, increasing=True, unit="s")
        self._rows = np.atleast_2d(real_array("coefficients", coefficients))
        if self._rows.shape[0] != self._ends.size - 1 or not np.isfinite(self._rows).all():
            allowed = f"({self._ends.size - 1}, degree + 1), finite"
            raise refuse("coefficients", f"shape {self._rows.shape}", allowed, "Give one row per piece.")
        self.breaks = tuple(self._ends.tolist())

    def _piece(self, times: FloatArray) -> npt.NDArray[np.intp]:
        return np.clip(np.searchsorted(self._ends, times, side="right") - 1, 0, self._ends.size - 2)

    def __call__(self, times: npt.ArrayLike) -> FloatArray:
        """See `Coefficient`."""
        t = np.asarray(times, dtype=float)
        piece = self._piece(t)
        value = np.zeros_like(t)
        for j in range(self._rows.shape[1] - 1, -1, -1):
            value = value * (t - self._ends[piece]) + self._rows[piece, j]
        return value


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
        self._omega = 2.0 * math.pi / real_number("period", period, 0.0, above=True, unit="s")
        self._mean = real_number("mean", mean)
        self._a, self._b = (np.zeros(count) for _ in range(2))
        self._a[: len(cosines)], self._b[: len(sines)] = cosines, sines
        self._order = np.arange(1, count + 1)

    def __call__(self, times: npt.ArrayLike) -> FloatArray:
        """See `Coefficient`."""
        angle = np.multiply.outer(np.asarray(times, dtype=float) * self._omega, self._order)
        return np.asarray(self._mean + np.cos(angle) @ self._a + np.sin(angle) @ self._b)


class _Joined(Coefficient):
    """The sum or the product of two."""

    def __init__(self, join: np.ufunc, first: Coefficient, second: Coefficient) -> None:
        self._join, self._first, self._second = join, first, second
        self.breaks = first.breaks + second.breaks

    def __call__(self, times: npt.ArrayLike) -> FloatArray:
        return np.asarray(self._join(self._first(times), self._second(times)))


def _known(value: Coefficient | float) -> Coefficient:
    """A coefficient; numbers are constants."""
    if isinstance(value, Coefficient):
        return value
    return FourierSeries(1.0, real_number("coefficient", value))


class KnownMatrix:
    """A(t) whose entries are given as formulas: a `PeriodicSystem` of it knows its breaks.

    Parameters
    ----------
    entries : (n, n) nested sequences of `Coefficient` and numbers

    Attributes
    ----------
    dimension : n
    breaks : times at which an entry jumps or has a kink [s]
    """

    def __init__(self, entries: Sequence[Sequence[Coefficient | float]]) -> None:
        self.dimension = len(entries)
        if not entries or any(len(row) != self.dimension for row in entries):
            raise refuse("entries", f"{self.dimension} rows", "a square matrix", "Give n rows of n entries.")
        self._entries = [
            (i, j, _known(value))
            for i, row in enumerate(entries)
            for j, value in enumerate(row)
            if isinstance(value, Coefficient) or value != 0.0
        ]
        self.breaks = tuple(sorted({t for _, _, entry in self._entries for t in entry.breaks}))

    def __call__(self, times: FloatArray) -> FloatArray:
        """A at times (k,) -> (k, n, n)."""
        out = np.zeros((np.size(times), self.dimension, self.dimension))
        for i, j, entry in self._entries:
            out[:, i, j] = entry(times)
        return out


class PeriodicMatrix(KnownMatrix):
    """B_0 + f_1(t) B_1 + f_2(t) B_2 + ...

    Parameters
    ----------
    constant : B_0, (n, n), or a number where n = 1
    terms : pairs (f_j, B_j) of a `Coefficient` and a matrix of the same shape

    Attributes
    ----------
    dimension : n
    breaks : times at which a coefficient jumps or has a kink [s]
    functions : the f_j
    matrices : (1 + terms, n, n) B_0, B_1, ...

    Raises
    ------
    ParameterError : a matrix that is not square, of another shape, or not of finite numbers
    """

    def __init__(self, constant: npt.ArrayLike, *terms: tuple[Coefficient, npt.ArrayLike]) -> None:
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

    def __call__(self, times: FloatArray) -> FloatArray:
        """See `KnownMatrix`."""
        factors = np.stack([np.ones(np.shape(times)), *(f(times) for f in self.functions)], axis=-1)
        return np.tensordot(factors, self.matrices, axes=1)


def square(field: str, value: npt.ArrayLike, n: int | None = None) -> FloatArray:
    """Return a square matrix, of n rows where n is given; a number is a matrix of one row.

    Raises
    ------
    ParameterError : anything else
    """
    matrix = real_array(field, value)
    matrix = matrix.reshape(1, 1) if matrix.ndim == 0 else matrix
    rows = n or len(matrix)
    if matrix.shape != (rows, rows) or not rows:
        wanted = f"a square matrix ({n}, {n})" if n else "a square matrix (n, n)"
        raise refuse(field, f"shape {matrix.shape}", wanted, "Check its rows and columns.")
    return matrix
