"""Periodic systems of their matrices of mass, damping and stiffness.

Coordinates are x = T z in which the mean of a conservative system is diagonal: z'' = -P^-1 C T z' - P^-1 K T
z with P = M T. Multipliers do not depend on T, bounds on their errors do.

Sources: docs/theory/floquet.md, "From matrices of mass, damping and stiffness".
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
from scipy.linalg import LinAlgError, cholesky, eigh

from floquet.engine.coefficients import PeriodicMatrix, square
from floquet.engine.neutral import SkewForm, conservative, form_of_motion
from floquet.engine.system import PeriodicSystem, second_order
from lumped.arguments import real_array, real_number
from lumped.errors import NumericalError, refuse
from lumped.typing import FloatArray

Matrix = npt.ArrayLike | PeriodicMatrix | Callable[[float], npt.ArrayLike]
"""A constant matrix, one with periodic terms, or a callable t [s] -> (n, n)."""

_WIDE = np.longdouble
#: Condition number of M, rows and columns scaled, beyond which it counts as singular.
_SINGULAR = 1e13


@dataclass(frozen=True, eq=False)
class SecondOrderSystem(PeriodicSystem):
    """A `PeriodicSystem` of M x'' + C(t) x' + K(t) x = 0; its states are (z, z') with x = coordinates z.

    Attributes
    ----------
    coordinates : (n, n) T; where M is symmetric and positive definite, the modes of M and the symmetric part
        of the mean of K, with modal mass one
    form : the skew form that every motion keeps, see `form_of_motion`; None: M, C and K do not prove one
    """

    coordinates: FloatArray = field(kw_only=True, repr=False)
    form: SkewForm | None = field(default=None, kw_only=True, repr=False)

    @property
    def conservative(self) -> bool:
        """Whether M and K(t) are exactly symmetric and C is exactly skew and constant.

        Then no motion is damped or driven. False where C or K is a callable.
        """
        return self.form is not None

    @property
    def kept_form(self) -> SkewForm | None:
        """See `PeriodicSystem`; proven by M, C and K, because A(t) is rounded."""
        return self.form


def from_second_order(
    M: npt.ArrayLike,
    C: Matrix,
    K: Matrix,
    period: float,
    breakpoints: Sequence[float] = (),
    vectorized: bool = False,
) -> SecondOrderSystem:
    """Return M x'' + C(t) x' + K(t) x = 0 as a `PeriodicSystem`.

    C and K need not be symmetric: gyroscopic and circulatory parts belong to them. Errors are proven bounds,
    rounding of M^-1 K included, where neither of them is a callable. Without damping, stability is proven too
    (verdict "neutral") where M and all matrices of K are exactly symmetric and C is 0 or constant and skew.

    Parameters
    ----------
    M : (n, n) constant and invertible; a number where n = 1
    C, K : constant (n, n), a `PeriodicMatrix`, or a callable t [s] -> (n, n)
    period : T > 0 [s]
    breakpoints : times in [0, T] at which a callable jumps or has a kink; a `PeriodicMatrix` knows its own
    vectorized : True: callables take an array of times (k,) and return (k, n, n)

    Raises
    ------
    ParameterError
        A singular M, matrices of different shapes, a period that is not positive, a term that does not repeat
        after it, breakpoints outside.
    NumericalError
        A callable is not finite somewhere.
    """
    mass = square("M", M)
    n = mass.shape[0]
    period = real_number("period", period, 0.0, above=True, unit="s", action="Give the length of one cycle.")
    scale = 2.0 ** -np.round(0.5 * np.log2(np.maximum(np.abs(mass).max(axis=1), 1e-300)))
    if not np.linalg.cond(mass * scale[:, None] * scale) < _SINGULAR:
        advice = "Condense coordinates without mass, or give them some."
        raise refuse("M", "a singular matrix", "an invertible matrix", advice)
    damping = _checked("C", C, n, period)
    stiffness = _checked("K", K, n, period)
    # Breaks of the formulas, and a first check of the callables.
    places = np.array([0.0, period])
    if np.size(breakpoints):
        places = PeriodicSystem(lambda t: np.zeros((1, 1)), period, breakpoints).edges
    middle = 0.5 * (places[:-1] + places[1:])
    C_of, K_of = (_function(name, B, n, vectorized) for name, B in (("C", damping), ("K", stiffness)))
    C_of(middle)
    mean = np.tensordot(np.diff(places) / period, K_of(middle), axes=1)
    T = _coordinates(mass, mean)
    if isinstance(damping, PeriodicMatrix) and isinstance(stiffness, PeriodicMatrix):
        A = _known(mass, damping, stiffness, T)
        undamped = conservative(mass, damping.matrices, stiffness.matrices)
        form = form_of_motion(mass, damping.matrices[0], T) if undamped else None
        return SecondOrderSystem(A, period, breakpoints, coordinates=T, form=form)
    inverse = np.linalg.inv(mass @ T)

    def sampled(times: FloatArray) -> FloatArray:
        return second_order(inverse @ K_of(times) @ T, inverse @ C_of(times) @ T)

    formulas = [t for B in (damping, stiffness) if isinstance(B, PeriodicMatrix) for t in B.breaks]
    inside = [t for t in formulas if 0.0 < t < period]
    return SecondOrderSystem(sampled, period, (*breakpoints, *inside), vectorized=True, coordinates=T)


def _checked(
    name: str, value: Matrix, n: int, period: float
) -> PeriodicMatrix | Callable[[float], npt.ArrayLike]:
    """C or K as a `PeriodicMatrix`, or the callable that it is."""
    if callable(value) and not isinstance(value, PeriodicMatrix):
        return value
    result = value if isinstance(value, PeriodicMatrix) else PeriodicMatrix(square(name, value, n))
    if result.dimension != n:
        shape = f"({result.dimension}, {result.dimension})"
        raise refuse(name, f"shape {shape}", f"that of M, ({n}, {n})", "Check the coordinates of both.")
    return result.over(name, period)


def _function(
    name: str, value: PeriodicMatrix | Callable[..., npt.ArrayLike], n: int, vectorized: bool
) -> Callable[[FloatArray], FloatArray]:
    """C or K as a function of times (k,) -> (k, n, n), checked."""
    if isinstance(value, PeriodicMatrix):
        return value

    def together(times: FloatArray) -> FloatArray:
        values = real_array(f"{name}(t)", value(times))
        if values.shape != (times.size, n, n):
            action = "Put the times first; without vectorized a callable takes one time."
            allowed = f"({times.size}, {n}, {n}) for {times.size} times"
            raise refuse(f"{name}(t)", f"shape {values.shape}", allowed, action)
        return values

    def at(times: FloatArray) -> FloatArray:
        values = [square(f"{name}(t)", np.asarray(value(float(t))), n) for t in times]
        return np.stack(values)

    return together if vectorized else at


def _coordinates(M: FloatArray, K: FloatArray) -> FloatArray:
    """Modes of the conservative part, (n, n); the unit matrix where M is not symmetric and positive."""
    if np.abs(M - M.T).max() > 1e-12 * np.abs(M).max():
        return np.eye(M.shape[0])
    mass = 0.5 * (M + M.T)
    try:
        cholesky(mass)
        return np.asarray(eigh(0.5 * (K + K.T), mass)[1])
    except LinAlgError:
        return np.eye(M.shape[0])


def _known(M: FloatArray, C: PeriodicMatrix, K: PeriodicMatrix, T: FloatArray) -> PeriodicMatrix:
    """A(t) in the coordinates T, with bounds on the rounding of its matrices."""
    n = M.shape[0]
    solve = _Solution(M, T)

    matrices = np.concatenate([K.matrices, C.matrices])
    solved, inexact = solve(matrices)
    count = len(K.matrices)
    none = np.zeros_like(matrices[:1])

    def blocks(X: FloatArray) -> FloatArray:
        """State matrices of the constant parts, of the terms of K and of the terms of C."""
        stiffness = [X[:count], np.repeat(none, len(X) - count - 1, axis=0)]
        damping = [X[count : count + 1], np.repeat(none, count - 1, axis=0), X[count + 1 :]]
        return second_order(np.concatenate(stiffness), np.concatenate(damping))

    state_matrices = blocks(solved)
    state_matrices[1:, :n, n:] = 0.0
    errors = np.abs(blocks(inexact))
    errors[:, :n, n:] = 0.0
    functions = (*K.functions, *C.functions)
    return PeriodicMatrix(state_matrices[0], *zip(functions, state_matrices[1:], strict=True), errors=errors)


class _Solution:
    """B -> X = (M T)^-1 B T with PROVEN bounds on the errors of the entries of X.

    With W an approximate inverse of P = M T and G = I - W P, the error of X is (I - G)^-1 W (B T - P X). All
    products are in the widest floating point.
    """

    def __init__(self, M: FloatArray, T: FloatArray) -> None:
        n = M.shape[0]
        self.T = T.astype(_WIDE)
        self.size = np.abs(M) @ np.abs(T)
        self.P = M.astype(_WIDE) @ self.T
        W = np.linalg.inv(self.P.astype(float))
        self.W = W.astype(_WIDE)
        self.sizes = np.abs(W)
        self.gamma = float((2.0 * n + 8.0) * np.finfo(_WIDE).eps)
        G = np.abs(np.eye(n) - self.W @ self.P).astype(float)
        G += self.gamma * (self.sizes @ self.size + np.eye(n))
        self.g = float(G.sum(axis=1).max())
        if not self.g < 0.5:
            raise NumericalError("M is too badly conditioned for bounds. Choose other units or coordinates.")

    def __call__(self, B: FloatArray) -> tuple[FloatArray, FloatArray]:
        """X (k, n, n) of B (k, n, n), and bounds on the errors of its entries."""
        Q = B.astype(_WIDE) @ self.T
        X = np.zeros(B.shape)
        for _ in range(3):
            X = (X + self.W @ (Q - self.P @ X)).astype(float)
        residual = Q - self.P @ X
        moduli = np.abs(residual).astype(float) + np.abs(B) @ np.abs(self.T).astype(float)
        moduli += 2.0 * self.size @ np.abs(X)
        error = np.abs(self.W @ residual).astype(float) + self.gamma * (self.sizes @ moduli)
        return X, np.asarray(
            (error + self.g / (1.0 - self.g) * error.max(axis=-2, keepdims=True)) * (1.0 + 1e-9)
        )
