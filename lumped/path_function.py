"""A quantity of one tooth pair as a piecewise polynomial over the path of contact.

Stiffness, damping, friction coefficient and tooth error all reach the equations in this one form, so that
the lumped model, the Floquet kernels and the multibody contact element read the same numbers.

Sources: piecewise Chebyshev approximation, error read off the tail: Trefethen, Approximation Theory and
Approximation Practice, 2013.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.polynomial import chebyshev, polynomial
from numpy.typing import ArrayLike, NDArray

from lumped.display.result import DisplayedResult
from lumped.errors import NumericalError
from lumped.typing import FloatArray

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

Array = TypeVar("Array", NDArray[np.float64], NDArray[np.longdouble])

#: Degree of the fitted pieces. Converting a Chebyshev to a monomial basis costs about (1 + sqrt 2)^degree
#: rounding errors, 2.5e-13 at degree 8, so the fit stays below its tolerances.
FIT_DEGREE = 8
_MAX_CUTS = 44
#: A function counts as smooth at a break if the polynomial before the break also holds behind it: over this
#: share of the shorter piece, and to this share of the largest value.
_BEYOND = 0.25
_SMOOTH = 1e-6
#: Breaks that are closer than this share of the interval differ by rounding alone, so they are one break.
_ROUNDING = 1e-13
#: Pieces that are longer than this share of the interval err by the tolerance at most, see
#: ``PathFunction.fit``.
_FULL_LENGTH = 0.125
#: Most pieces. More of them mean rounding noise or an undeclared kink; a table of 1000 rows has 1000 pieces.
_MAX_PIECES = 4000

_NODES = np.asarray(chebyshev.chebpts1(FIT_DEGREE + 1), dtype=np.float64)
# Twice as dense as the nodes and all but at the ends, where a jump hides and a root's error is largest.
_PROBES = np.asarray((1.0 - 1e-6) * chebyshev.chebpts2(2 * FIT_DEGREE + 5), dtype=np.float64)
#: Positions at which ``fit`` samples a piece, as shares of half of its length: nodes, then probes. Laws that
#: follow from one computation can share it piece by piece.
FIT_POINTS = np.concatenate([_NODES, _PROBES])
_AT_PROBES = np.asarray(chebyshev.chebvander(_PROBES, FIT_DEGREE).T, dtype=np.float64)
# Chebyshev coefficients from values at the nodes: discrete orthogonality, (2 - [k = 0])/n T_k(x_j)
_TO_SERIES = np.asarray(chebyshev.chebvander(_NODES, FIT_DEGREE) * (2.0 / _NODES.size), dtype=np.float64)
_TO_SERIES[:, 0] *= 0.5
# Row k: coefficients of T_k(t - 1) in powers of t, lowest first.
_TO_POWERS = np.zeros((FIT_DEGREE + 1, FIT_DEGREE + 1))
for _k in range(FIT_DEGREE + 1):
    _TO_POWERS[_k, : _k + 1] = polynomial.Polynomial(chebyshev.cheb2poly([0.0] * _k + [1.0]))(
        polynomial.Polynomial([-1.0, 1.0])
    ).coef


@dataclass(frozen=True, eq=False, repr=False)
class PathFunction(DisplayedResult):
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
        from lumped.path_values import values_at

        array = np.asarray(xi, dtype=float)
        places = array.ravel()[:]
        places.setflags(write=False)  # as breaks are: an array of another kind is another compilation
        return values_at(self.breaks, self.coefficients, places).reshape(array.shape)

    @cached_property
    def slope(self) -> PathFunction:
        """The piecewise derivative df/dxi."""
        poly = self._polynomials.derivative()
        return PathFunction(self.breaks, poly.c, self.switches)

    @cached_property
    def antiderivative(self) -> PathFunction:
        """The continuous function with this slope that is zero at the start."""
        poly = self._polynomials.antiderivative()
        return PathFunction(self.breaks, poly.c, self.switches)

    @cached_property
    def bends(self) -> FloatArray:
        """Inner breaks at which the function is not smooth: switches, and the knots of a table [m].

        At all other breaks, where ``fit`` has cut a piece, the polynomial before the break also holds behind
        it.
        """
        pieces = np.diff(self.breaks)
        beyond = _BEYOND * np.minimum(pieces[:-1], pieces[1:])
        before = shifted(self.coefficients[:, :-1], pieces[:-1])
        powers = np.arange(len(before) - 1, -1, -1)[:, None]
        difference = np.sum(np.abs(before - self.coefficients[:, 1:]) * beyond**powers, axis=0)
        result: FloatArray = self.breaks[1:-1][difference > _SMOOTH * np.abs(self.coefficients[-1]).max()]
        return result

    def mean(self) -> float:
        """Mean value over the interval."""
        return self._mean

    @cached_property
    def _mean(self) -> float:  # of a stiffness each speed asks for it
        low, high = self.interval
        return float(self._polynomials.integrate(low, high)) / (high - low)

    @property
    def _polynomials(self) -> PPoly:
        from scipy.interpolate import PPoly

        return PPoly(self.coefficients, self.breaks)

    def scaled(self, factor: float) -> PathFunction:
        """The function multiplied by a constant."""
        return PathFunction(self.breaks, self.coefficients * factor, self.switches)

    def split(self, positions: ArrayLike) -> PathFunction:
        """The same function with further breaks at positions inside the interval [m], any shape."""
        low, high = self.interval
        new = np.ravel(np.asarray(positions, dtype=float))
        breaks = np.unique(np.concatenate([self.breaks, new[(new > low) & (new < high)]]))
        piece = np.searchsorted(self.breaks, breaks[:-1], side="right") - 1
        coefficients = shifted(self.coefficients[:, piece], breaks[:-1] - self.breaks[piece])
        return PathFunction(breaks, coefficients, self.switches)

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
        by_length: bool = False,
        cut: Callable[[FloatArray, FloatArray], FloatArray] = lambda low, high: 0.5 * (low + high),
    ) -> PathFunction:
        """Fit a vectorised callable by polynomials, cutting pieces in two until the error is small enough.

        The callable is sampled strictly inside each piece (Chebyshev points of the first kind), so one-sided
        limits at a break are taken from the right piece. All pieces of a round are sampled in one call.
        Breaks that differ by rounding count as one: a polynomial on a piece as short as the rounding of its
        positions has slopes that are rounding over rounding.

        Parameters
        ----------
        function : callable (k,) -> (k,), smooth inside every piece
        breaks : end points and inner breaks [m]
        switches : the breaks that are jumps or kinks [m]
        tolerance : largest absolute error at the probes between the nodes, in the function's own unit
        by_length : whether pieces shorter than an eighth of the interval may err the more the shorter they
            are, as a motion sees error times length
        cut : ends of pieces -> where to cut them [m]; by default in the middle

        Raises
        ------
        NumericalError : a value is not finite, or a piece does not converge, as when a kink is missing from
            ``breaks``
        """
        breaks = _distinct_breaks(np.asarray(breaks, dtype=float), np.asarray(switches, dtype=float))
        low = breaks[:-1].copy()
        high = breaks[1:].copy()
        most = max(_MAX_PIECES, 4 * low.size)  # a table brings as many pieces as it has points
        result: list[tuple[FloatArray, FloatArray, FloatArray]] = []
        for last in [False] * _MAX_CUTS + [True]:
            half = 0.5 * (high - low)
            values = _values(function, low, half)
            series = values[:, : _NODES.size] @ _TO_SERIES
            error = np.abs(series @ _AT_PROBES - values[:, _NODES.size :]).max(axis=1)
            # A piece at the resolution of positions cannot be cut further.
            if by_length:
                error *= np.minimum(1.0, 2.0 * half / (_FULL_LENGTH * (breaks[-1] - breaks[0])))
            good = error <= (1e3 * tolerance if last else tolerance)
            result.append((low[good], half[good], series[good]))
            if good.all():
                break
            low = low[~good]
            high = high[~good]
            if last or low.size + sum(start.size for start, *_ in result) > most:
                raise NumericalError(
                    f"No polynomial fit to {tolerance:.2g} near xi = {low[0]:.6g} m: the function is noisy "
                    "there, or has a jump or kink that is no break; name it, or raise the tolerance."
                )
            middle = cut(low, high)
            low = np.concatenate([low, middle])
            high = np.concatenate([middle, high])
        start, half, series = (np.concatenate(part) for part in zip(*result, strict=True))
        order = np.argsort(start)
        coefficients = _coefficients(series[order], half[order])
        return cls(np.append(start[order], breaks[-1]), coefficients, np.asarray(switches))

    @classmethod
    def interpolated(
        cls, function: Callable[[FloatArray], FloatArray], low: float, high: float
    ) -> PathFunction:
        """The polynomial of degree ``FIT_DEGREE`` through a callable (k,) -> (k,) at the Chebyshev points.

        For a function that is so smooth that one piece has no error worth a look.
        """
        half = 0.5 * (high - low)
        series = function(low + half * (1.0 + _NODES)) @ _TO_SERIES
        return cls(np.array([low, high]), _coefficients(series[None], np.array([half])), np.empty(0))


def _coefficients(series: FloatArray, half: FloatArray) -> FloatArray:
    """Coefficients of ``PathFunction``, from series (pieces, terms) on pieces of half lengths (pieces,)."""
    powers = series @ _TO_POWERS / half[:, None] ** np.arange(FIT_DEGREE + 1)
    return np.asarray(powers.T[::-1], dtype=np.float64)


def one_of_each(marks: FloatArray, near: float, rank: NDArray[np.generic]) -> FloatArray:
    """Return one mark of each group of marks that follow each other in steps below ``near``.

    Parameters
    ----------
    marks : (k,) increasing
    near : smallest step between two marks that differ
    rank : (k,) the first mark with the highest rank of a group stays
    """
    group = np.cumsum(np.diff(marks, prepend=-np.inf) >= near)
    order = np.lexsort((marks, -rank.astype(np.int64), group))
    first = np.diff(group[order], prepend=-1) != 0
    return np.asarray(marks[order[first]], dtype=np.float64)


def _distinct_breaks(breaks: FloatArray, switches: FloatArray) -> FloatArray:
    """Breaks that differ by more than rounding. Of close ones an end stays, else a switch, else the first."""
    rank = np.isin(breaks, switches).astype(np.int64)
    rank[[0, -1]] = 2
    return one_of_each(breaks, _ROUNDING * (breaks[-1] - breaks[0]), rank)


def shifted(coefficients: Array, by: ArrayLike) -> Array:
    """Return coefficients (order, ...), highest power first, about points shifted by ``by`` (...)."""
    result = coefficients.copy()
    for last in range(len(result) - 1, 0, -1):  # synthetic division
        for i in range(1, last + 1):
            result[i] += by * result[i - 1]
    return result


def _values(function: Callable[[FloatArray], FloatArray], low: FloatArray, half: FloatArray) -> FloatArray:
    """Values (pieces, points) at the ``FIT_POINTS`` of every piece."""
    xi = low[:, None] + half[:, None] * (1.0 + FIT_POINTS)
    values = function(xi.ravel()).reshape(xi.shape)
    if not np.isfinite(values).all():
        worst = xi[~np.isfinite(values)][0]
        raise NumericalError(f"The function is not finite at xi = {worst:.6g} m; check its parameters.")
    return values
