"""Matrices that are a constant and a few periodic terms, known as formulas.

Sources: docs/theory/proven_bounds.md, "Coefficients given as formulas".
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from floquet.engine.coefficients import Coefficient, KnownMatrix
from lumped.arguments import real_array
from lumped.errors import refuse, shown
from lumped.typing import FloatArray

_U = 0.5 * float(np.finfo(np.float64).eps)


class PeriodicMatrix(KnownMatrix):
    """B_0 + f_1(t) B_1 + f_2(t) B_2 + ...

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
    matrices : (1 + terms, n, n) B_0, B_1, ...

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
        self._errors = np.zeros_like(self.matrices) if errors is None else errors

    def __call__(self, times: FloatArray) -> FloatArray:
        """See `KnownMatrix`."""
        factors = np.stack([np.ones(np.shape(times)), *(f(times) for f in self.functions)], axis=-1)
        return np.tensordot(factors, self.matrices, axes=1)

    def taylor(
        self, start: FloatArray, length: FloatArray, degree: int, scaling: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """See `KnownMatrix`; the scaling is by powers of two, which is exact."""
        scale = scaling / scaling[:, None]
        matrices = self.matrices * scale
        sizes = np.linalg.norm(matrices, axis=(1, 2))
        inexact = np.linalg.norm(self._errors * scale, axis=(1, 2))
        out = np.zeros((start.size, degree + 1, *matrices.shape[1:]))
        out[:, 0] = matrices[0]
        rounded = (len(self.functions) + 2.0) * _U
        total = np.full(start.size, inexact[0] + rounded * sizes[0])
        for function, matrix, size, off in zip(
            self.functions, matrices[1:], sizes[1:], inexact[1:], strict=True
        ):
            series, error = function.taylor(start, length, degree)
            out += series[:, :, None, None] * matrix
            reach = np.abs(series).sum(axis=1) + error
            total += error * (size + off) + reach * (off + rounded * size)
        return out, total * (1.0 + 1e-9)

    def faulty_terms(self, period: float) -> list[int]:
        """Numbers, from 1, of the terms that do not repeat after the period."""
        return [k for k, f in enumerate(self.functions, 1) if not f.repeats(period)]

    def varied(self, factor: float) -> PeriodicMatrix:
        """The same with all periodic terms multiplied by a factor."""
        terms = zip(self.functions, factor * self.matrices[1:], strict=True)
        return PeriodicMatrix(self.matrices[0], *terms)


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
