"""A quantity of one tooth pair as a piecewise polynomial over the path of contact.

Stiffness, damping, friction coefficient and tooth error all reach the equations in this one form, so that
the lumped model, the Floquet kernels and the multibody contact element read the same numbers.

Sources: piecewise Chebyshev approximation, error read off the tail: Trefethen, Approximation Theory and
Approximation Practice, 2013.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import PPoly

from lumped.errors import NumericalError
from lumped.typing import FloatArray

Array = TypeVar("Array", NDArray[np.float64], NDArray[np.longdouble])

#: Degree of the fitted pieces. Converting a Chebyshev to a monomial basis costs about (1 + sqrt 2)^degree
#: rounding errors, 2.5e-13 at degree 8, so the fit stays below its tolerances.
FIT_DEGREE = 8
_MAX_HALVINGS = 40
#: Halving without end means rounding noise or an undeclared kink; a table of 1000 rows has 1000 pieces.
_MAX_PIECES = 4000


@dataclass(frozen=True, eq=False)
class PathFunction:
    """Piecewise polynomial f(xi) on [breaks[0], breaks[-1]], zero outside.

    Attributes
    ----------
    breaks : (m + 1,) increasing positions xi from the pinion's tangent point X [m]
    coefficients : (order, m), highest power first, of (xi - breaks[j]) on piece j, as in
        ``scipy.interpolate.PPoly``
    switches : positions [m] strictly inside the interval where f jumps or has a kink; every one is a break.
        Breaks that are no switches only join pieces of one smooth function.
    """

    breaks: FloatArray
    coefficients: FloatArray
    switches: FloatArray

    def __post_init__(self) -> None:
        breaks = np.ascontiguousarray(self.breaks, dtype=float)
        coefficients = np.ascontiguousarray(self.coefficients, dtype=float)
        switches = np.unique(np.asarray(self.switches, dtype=float))
        if breaks.ndim != 1 or breaks.size < 2 or np.any(np.diff(breaks) <= 0):
            raise NumericalError("A path function needs increasing breaks; check the switch positions.")
        if coefficients.ndim != 2 or coefficients.shape[1] != breaks.size - 1:
            raise NumericalError("A path function needs one column of coefficients per piece.")
        if not (np.isfinite(breaks).all() and np.isfinite(coefficients).all()):
            raise NumericalError("A path function is not finite; check the parameters of its law.")
        for array in (breaks, coefficients, switches):
            array.setflags(write=False)
        object.__setattr__(self, "breaks", breaks)
        object.__setattr__(self, "coefficients", coefficients)
        object.__setattr__(self, "switches", switches)

    @property
    def interval(self) -> tuple[float, float]:
        """First and last position [m]."""
        return float(self.breaks[0]), float(self.breaks[-1])

    def __call__(self, xi: ArrayLike) -> FloatArray:
        """Values at positions xi [m], any shape; zero outside the interval, right-continuous at switches."""
        values = PPoly.construct_fast(self.coefficients, self.breaks, extrapolate=False)(
            np.asarray(xi, dtype=float)
        )
        return np.asarray(np.nan_to_num(values, nan=0.0), dtype=np.float64)

    def derivative(self) -> PathFunction:
        """The piecewise derivative df/dxi."""
        poly = PPoly(self.coefficients, self.breaks).derivative()
        return PathFunction(self.breaks, poly.c, self.switches)

    def mean(self) -> float:
        """Mean value over the interval."""
        low, high = self.interval
        integral = PPoly(self.coefficients, self.breaks).integrate(low, high)
        return float(integral) / (high - low)

    def scaled(self, factor: float) -> PathFunction:
        """The function multiplied by a constant."""
        return PathFunction(self.breaks, self.coefficients * factor, self.switches)

    def split(self, positions: ArrayLike) -> PathFunction:
        """The same function with further breaks at positions inside the interval [m], any shape."""
        low, high = self.interval
        new = np.ravel(np.asarray(positions, dtype=float))
        breaks = np.unique(np.concatenate([self.breaks, new[(new > low) & (new < high)]]))
        piece = np.searchsorted(self.breaks, breaks[:-1], side="right") - 1
        moved = shifted(self.coefficients[:, piece], breaks[:-1] - self.breaks[piece])
        return PathFunction(breaks, moved, self.switches)

    @classmethod
    def constant(cls, value: float, low: float, high: float) -> PathFunction:
        """A constant on [low, high]."""
        return cls(np.array([low, high]), np.array([[value]]), np.empty(0))

    @classmethod
    def fit(
        cls,
        function: Callable[[FloatArray], FloatArray],
        breaks: Sequence[float] | FloatArray,
        switches: Sequence[float] | FloatArray = (),
        *,
        tolerance: float,
    ) -> PathFunction:
        """Fit a vectorised callable by polynomials, halving pieces until the error is below ``tolerance``.

        The callable is sampled strictly inside each piece (Chebyshev points of the first kind), so one-sided
        limits at a break are taken from the right piece.

        Parameters
        ----------
        function : callable (k,) -> (k,), smooth inside every piece
        breaks : end points and inner breaks [m]
        switches : the breaks that are jumps or kinks [m]
        tolerance : largest absolute error, in the function's own unit

        Raises
        ------
        NumericalError : a piece does not converge, as when a kink is missing from ``breaks``
        """
        nodes = chebyshev.chebpts1(FIT_DEGREE + 1)
        probes = np.linspace(-0.99, 0.99, 2 * FIT_DEGREE + 5)
        edges: list[float] = []
        columns: list[FloatArray] = []
        stack = [(float(a), float(b), 0) for a, b in itertools.pairwise(breaks)][::-1]
        most = max(_MAX_PIECES, 4 * len(stack))  # a table brings as many pieces as it has points
        while stack:
            if len(columns) + len(stack) > most:
                raise NumericalError(
                    f"No polynomial fit to {tolerance:.2g} near xi = {stack[-1][0]:.6g} m: the function is "
                    "noisy or has an undeclared kink there; name it as a break or raise the tolerance."
                )
            low, high, depth = stack.pop()
            centre, half = 0.5 * (low + high), 0.5 * (high - low)
            series = np.asarray(
                chebyshev.chebfit(nodes, function(centre + half * nodes), FIT_DEGREE), dtype=np.float64
            )
            error = np.abs(chebyshev.chebval(probes, series) - function(centre + half * probes)).max()
            if not np.isfinite(error):
                raise NumericalError(f"The function is not finite between xi = {low:.6g} and {high:.6g} m.")
            if error > tolerance and depth < _MAX_HALVINGS:
                stack += [(centre, high, depth + 1), (low, centre, depth + 1)]
                continue
            if error > 1e3 * tolerance:
                raise NumericalError(
                    f"No polynomial fit near xi = {centre:.6g} m (error {error:.2g}): "
                    "name the jump or kink there as a break."
                )
            edges.append(low)
            columns.append(_local_monomials(series, half))
        return cls(np.array([*edges, float(breaks[-1])]), np.stack(columns, axis=1), np.asarray(switches))


def shifted(coefficients: Array, by: ArrayLike) -> Array:
    """Coefficients (order, ...), highest power first, about points that lie further on by ``by``, (...)."""
    moved = coefficients.copy()
    for last in range(len(moved) - 1, 0, -1):  # synthetic division
        for i in range(1, last + 1):
            moved[i] += by * moved[i - 1]
    return moved


def _local_monomials(series: FloatArray, half: float) -> FloatArray:
    """Coefficients in powers of (xi - low), highest first, of a Chebyshev series on [low, low + 2 half]."""
    in_s = chebyshev.cheb2poly(series)  # powers of s = (xi - low)/half - 1
    shifted = np.polynomial.Polynomial(in_s)(np.polynomial.Polynomial([-1.0, 1.0])).coef
    padded = np.zeros(FIT_DEGREE + 1)
    padded[: shifted.size] = shifted
    return np.asarray((padded / half ** np.arange(FIT_DEGREE + 1))[::-1], dtype=np.float64)
