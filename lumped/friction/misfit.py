"""How far the polynomials of a friction law are from its formula, rounding included: a bound, not a sample.

Inside an ellipse with the ends of a piece as foci, semi-axes (r + 1/r)/2 and (r - 1/r)/2 times half its
length, a law is analytic and at most M. Interpolated at n + 1 Chebyshev points it errs by 4 M r^-n/(r - 1)
at most. With n = 64 a rough M serves. What is left, the polynomial of degree 64 less that of the fit, is
known by its Chebyshev coefficients.

Sources: Trefethen, Approximation Theory and Approximation Practice, 2013, theorem 8.2.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import chebyshev

from lumped.friction.base import Analytic, ContactPath, FrictionLaw, FrictionSettings
from lumped.path_function import PathFunction
from lumped.typing import BoolArray, FloatArray

_U = 0.5 * float(np.finfo(np.float64).eps)
_DEGREE = 64
_NODES = np.asarray(chebyshev.chebpts1(_DEGREE + 1), dtype=np.float64)
_TO_SERIES = np.asarray(chebyshev.chebvander(_NODES, _DEGREE) * (2.0 / _NODES.size), dtype=np.float64)
_TO_SERIES[:, 0] *= 0.5
#: Lebesgue's constant of these points, rounded up: 2/pi log 65 + 1.
_LEBESGUE = 4.0
#: Largest r; smallest one with which a piece counts as clear of what is singular.
_LARGEST = 2.5
_CLEAR = 1.1
#: The same of a position, relative to L_XY, with the search of switches, see `ContactPath.crossings`.
_PLACE = 4.0 * _U + 1e-14


@dataclass(frozen=True, eq=False)
class Ellipses:
    """Around pieces (k,) from ``low`` to ``high`` [m], clear of some points: see the head of this file.

    Attributes
    ----------
    centre, half : (k,) middle and half the length of each piece [m]
    ratio : (k,) r; 1 where a point is at the end of the piece
    """

    centre: FloatArray
    half: FloatArray
    ratio: FloatArray

    @classmethod
    def clear_of(cls, low: FloatArray, high: FloatArray, points: Sequence[complex] = ()) -> Ellipses:
        """Ellipses that come to these points at most half as near as the pieces do."""
        centre = 0.5 * (low + high)
        half = 0.5 * (high - low)
        ratio = np.full(centre.shape, _LARGEST)
        for point in points:
            if point.imag == 0.0:
                axis = np.maximum(0.5 * (np.abs(centre - point.real) / half + 1.0), 1.0)
                free = axis + np.sqrt(axis**2 - 1.0)
            else:
                beside = np.maximum(np.abs(centre - point.real) - half, 0.0)
                axis = 0.5 * np.hypot(beside, point.imag) / half
                free = axis + np.sqrt(axis**2 + 1.0)
            ratio = np.minimum(ratio, free)
        return cls(centre, half, ratio)

    @property
    def clear(self) -> BoolArray:
        """Whether a piece (k,) is clear of singular points. If not, the law itself is the bound."""
        return np.asarray(self.ratio >= _CLEAR)

    @property
    def reach(self) -> FloatArray:
        """Larger semi-axis (k,) [m]."""
        return 0.5 * self.half * (self.ratio + 1.0 / self.ratio)

    def distances(self, point: complex) -> tuple[FloatArray, FloatArray]:
        """Bounds (k,), from below and above, on the distance [m] of a point to all of an ellipse."""
        apart = np.abs(self.centre - point)
        if point.imag == 0.0:
            return np.maximum(apart - self.reach, 0.0), apart + self.reach
        beside = np.maximum(np.abs(self.centre - point.real) - self.half, 0.0)
        rise = 0.5 * self.half * (self.ratio - 1.0 / self.ratio)
        return np.hypot(beside, point.imag) - rise, apart + self.reach


def entraining(around: Ellipses, path: ContactPath) -> tuple[FloatArray, FloatArray]:
    """Bounds (k,) on |v_e| [m/s] in ellipses."""
    point = path.still
    rate = abs(path.omega_pinion - path.omega_gear)
    if point is None:
        both = np.full(around.centre.shape, path.omega_pinion * path.L_XY)
        return both, both
    low, high = around.distances(point)
    return rate * low, rate * high


def constant(size: Callable[[ContactPath, FrictionSettings], float]) -> Analytic:
    """`FrictionLaw.analytic` of a law that is constant between its switches."""

    def analytic(
        low: FloatArray, high: FloatArray, path: ContactPath, settings: FrictionSettings
    ) -> tuple[FloatArray, FloatArray]:
        return np.full(low.shape, _LARGEST), np.full(low.shape, size(path, settings))

    return analytic


def fit_misfit(
    function: PathFunction, law: FrictionLaw, path: ContactPath, settings: FrictionSettings
) -> FloatArray:
    """PROVEN bound (m,) on |mu - function| on each piece of a fit; 0 for a law that has no formula."""
    low, high = function.breaks[:-1], function.breaks[1:]
    around = law.most_around(low, high, path, settings)
    if around is None:
        return np.zeros(low.size)
    ratio, most = around
    half = 0.5 * (high - low)
    width = high - low
    xi = 0.5 * (low + high)[:, None] + half[:, None] * _NODES
    mu = law.signed(xi.ravel(), path, settings).reshape(xi.shape)
    remainder = np.abs((mu - function(xi)) @ _TO_SERIES).sum(axis=1)
    powers = np.arange(len(function.coefficients))[::-1, None]
    terms = (np.abs(function.coefficients) * width**powers).sum(axis=0)
    r = np.maximum(ratio, _CLEAR)
    slope = most / (0.5 * half * (r + 1.0 / r - 2.0))
    rounding = law.roundings * _U * np.abs(mu).max(axis=1) + 20.0 * _U * terms + _PLACE * path.L_XY * slope
    clear = remainder + 4.0 * most * r**-_DEGREE / (r - 1.0) + _LEBESGUE * rounding
    return np.asarray(np.where(ratio >= _CLEAR, clear, most + terms))
