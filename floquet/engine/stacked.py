"""Matrices A(t) of many systems at once: their Taylor polynomials on steps of any of them.

The systems have as many states and terms. Functions of one kind are evaluated together, others one by one.

Sources: docs/theory/proven_bounds.md, "Coefficients given as formulas".
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from itertools import groupby

import numpy as np

from floquet.engine.coefficients import (
    Coefficient,
    FourierSeries,
    Harmonics,
    OfTwo,
    PeriodicMatrix,
    PiecewisePolynomial,
    Polynomials,
    Product,
    Series,
    harmonics_taylor,
    polynomial_taylor,
    product_taylor,
    sum_taylor,
)
from lumped.typing import FloatArray, IntArray

_U = 0.5 * float(np.finfo(np.float64).eps)


class _Functions(ABC):
    """One function of each of S systems."""

    @abstractmethod
    def taylor(self, owner: IntArray, start: FloatArray, length: FloatArray, degree: int) -> Series:
        """Polynomials of the functions of the systems ``owner`` (k,), see `Coefficient.taylor`."""


class _Harmonics(_Functions):
    """Fourier series with as many harmonics."""

    def __init__(self, functions: Sequence[FourierSeries]) -> None:
        parts = zip(*(function.harmonics for function in functions), strict=True)
        self._all = Harmonics(*(np.concatenate(part) for part in parts))

    def taylor(self, owner: IntArray, start: FloatArray, length: FloatArray, degree: int) -> Series:
        """See `_Functions`."""
        return Series(*harmonics_taylor(Harmonics(*(p[owner] for p in self._all)), start, length, degree))


class _Pieces(_Functions):
    """Piecewise polynomials with as many pieces of the same degree."""

    def __init__(self, functions: Sequence[PiecewisePolynomial]) -> None:
        self._ends = np.array([function.breaks for function in functions])
        self._rows = np.stack([function.rows for function in functions])

    def taylor(self, owner: IntArray, start: FloatArray, length: FloatArray, degree: int) -> Series:
        """See `_Functions`; the last piece that starts at or before the step, or the first one."""
        piece = (self._ends[owner, 1:-1] <= start[:, None]).sum(axis=1)
        polynomials = Polynomials(self._ends[owner, piece], self._rows[owner, piece])
        return Series(*polynomial_taylor(polynomials, start, length, degree))


class _OfTwo(_Functions):
    """Sums, or products."""

    def __init__(self, functions: Sequence[OfTwo]) -> None:
        self._parts = [_stack([f.first for f in functions]), _stack([f.second for f in functions])]
        self._join = product_taylor if isinstance(functions[0], Product) else sum_taylor

    def taylor(self, owner: IntArray, start: FloatArray, length: FloatArray, degree: int) -> Series:
        """See `_Functions`."""
        first, second = (part.taylor(owner, start, length, degree) for part in self._parts)
        return Series(*self._join(first, second))


class _OneByOne(_Functions):
    """Functions of different kinds; one function of all systems is evaluated once."""

    def __init__(self, functions: Sequence[Coefficient]) -> None:
        self._functions = functions
        self._same = all(function is functions[0] for function in functions)

    def taylor(self, owner: IntArray, start: FloatArray, length: FloatArray, degree: int) -> Series:
        """See `_Functions`."""
        if self._same:
            return Series(*self._functions[0].taylor(start, length, degree))
        result = Series(np.empty((start.size, degree + 1)), np.empty(start.size))
        for number in np.unique(owner):
            steps = owner == number
            one = self._functions[number].taylor(start[steps], length[steps], degree)
            result.coefficients[steps], result.errors[steps] = one
        return result


def _kind(function: Coefficient) -> tuple[object, ...]:
    """Functions with the same kind are evaluated together."""
    if isinstance(function, FourierSeries):
        return FourierSeries, function.harmonics.cosines.shape
    if isinstance(function, PiecewisePolynomial):
        return PiecewisePolynomial, function.rows.shape
    if isinstance(function, OfTwo):
        return type(function), _kind(function.first), _kind(function.second)
    return (id(function),)


def _stack(functions: Sequence[Coefficient]) -> _Functions:
    kinds = {_kind(function) for function in functions}
    makers = ((FourierSeries, _Harmonics), (PiecewisePolynomial, _Pieces), (OfTwo, _OfTwo))
    if len(kinds) == 1 and any(function is not functions[0] for function in functions):
        for kind, maker in makers:
            if isinstance(functions[0], kind):
                return maker(functions)  # type: ignore[arg-type]
    return _OneByOne(functions)


class StackedMatrices:
    """A(t) of S systems in balanced coordinates, A_ij d_j/d_i.

    The scaling is by powers of two, which is exact.

    Parameters
    ----------
    matrices : of the systems, with as many states and terms
    scalings : (S, n) d
    """

    def __init__(self, matrices: Sequence[PeriodicMatrix], scalings: FloatArray) -> None:
        scale = (scalings[:, None, :] / scalings[:, :, None])[:, None]
        self._matrices = np.stack([matrix.matrices for matrix in matrices]) * scale
        self._sizes = np.linalg.norm(self._matrices, axis=(2, 3))
        errors = np.stack([matrix.errors for matrix in matrices]) * scale
        self._inexact = np.linalg.norm(errors, axis=(2, 3))
        self._functions = [
            _stack(functions) for functions in zip(*(matrix.functions for matrix in matrices), strict=True)
        ]

    @property
    def dimension(self) -> int:
        """Number of states n."""
        return int(self._matrices.shape[-1])

    def taylor(self, owner: IntArray, start: FloatArray, length: FloatArray, degree: int) -> Series:
        """Polynomials (k, degree + 1, n, n) of A of the systems ``owner`` (k,) on steps, see `Coefficient`.

        The errors (k,) bound Frobenius norms.
        """
        n = self.dimension
        out = np.zeros((start.size, degree + 1, n, n))
        out[:, 0] = self._matrices[owner, 0]
        rounded = (len(self._functions) + 2.0) * _U
        total = self._inexact[owner, 0] + rounded * self._sizes[owner, 0]
        for term, function in enumerate(self._functions, 1):
            series, error = function.taylor(owner, start, length, degree)
            out += series[:, :, None, None] * self._matrices[owner, term][:, None]
            reach = np.abs(series).sum(axis=1) + error
            size, inexact = self._sizes[owner, term], self._inexact[owner, term]
            total += error * (size + inexact) + reach * (inexact + rounded * size)
        return Series(out, total * (1.0 + 1e-9))


def alike(matrices: Sequence[PeriodicMatrix]) -> list[IntArray]:
    """Groups of matrices with as many states and terms, as indices."""
    shapes = [matrix.matrices.shape for matrix in matrices]
    order = sorted(range(len(shapes)), key=shapes.__getitem__)
    return [np.array([*group]) for _, group in groupby(order, key=shapes.__getitem__)]
