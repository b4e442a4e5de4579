"""Periodic linear systems x' = A(t) x: what every routine of this package consumes.

Sources: docs/theory/floquet.md, "From the equations to a matrix".
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt
from scipy.linalg import matrix_balance

from floquet.engine.callable_form import as_matrices, dimension_of
from floquet.engine.coefficients import PeriodicMatrix
from floquet.engine.neutral import SkewForm, skew_form
from lumped.arguments import real_number, real_numbers
from lumped.errors import NumericalError, refuse
from lumped.typing import FloatArray

# Points nearer to a switch than this part of the period are moved inwards: far enough that a callable which
# reduces t modulo the period cannot round it onto the switch, near enough that A changes only by rounding.
_INSET = 64 * np.finfo(np.float64).eps


def second_order(stiffness: npt.ArrayLike, damping: npt.ArrayLike) -> FloatArray:
    """State matrices of z'' + C z' + K z = 0, K and C of shape (..., m, m) -> (..., 2m, 2m)."""
    K, C = np.broadcast_arrays(np.asarray(stiffness, dtype=float), np.asarray(damping, dtype=float))
    m = K.shape[-1]
    out = np.zeros((*K.shape[:-2], 2 * m, 2 * m))
    out[..., :m, m:] = np.eye(m)
    out[..., m:, :m] = -K
    out[..., m:, m:] = -C
    return out


@dataclass(frozen=True, eq=False)
class PeriodicSystem:
    """A linear system x' = A(t) x whose coefficients repeat after one period.

    Parameters
    ----------
    A : callable, t [s] -> (n, n); with ``vectorized``, (k,) -> (k, n, n). It is only ever evaluated strictly
        inside the smooth segments, so its value *at* a switch does not matter. Or a `PeriodicMatrix`, whose
        breaks need not be named. The period is then a whole number of periods of each of its functions.
    period : T > 0 [s]
    breakpoints : times in [0, T] at which A jumps or has a kink; 0 and T are always segment ends
    vectorized : True: A takes an array of times (k,) and returns (k, n, n), each matrix of its time alone;
        False: A takes one time. A callable that takes the other form is refused

    Attributes
    ----------
    dimension : n
    edges : (segments + 1,) ends of the smooth segments from 0 to T [s]

    Raises
    ------
    ParameterError
        A period that is not positive, breakpoints outside [0, T], an A that is not square or takes its times
        in another form than ``vectorized`` says, a function of a `PeriodicMatrix` that does not repeat after
        the period.
    NumericalError
        A is not finite somewhere inside a segment.
    """

    A: Callable[..., npt.ArrayLike]
    period: float
    breakpoints: Sequence[float] = ()
    vectorized: bool = False
    dimension: int = field(init=False)
    edges: FloatArray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        if not callable(self.A):
            advice = "Wrap a constant as a function of t."
            raise refuse("A", type(self.A).__name__, "a callable t -> (n, n)", advice)
        period = real_number(
            "period", self.period, 0.0, above=True, unit="s", action="Give the length of one cycle."
        )
        object.__setattr__(self, "period", period)
        if isinstance(self.A, PeriodicMatrix):
            object.__setattr__(self, "A", self.A.over("A", period))
            inside = [t for t in self.A.breaks if 0.0 < t < period]
            object.__setattr__(self, "breakpoints", (*self.breakpoints, *inside))
            object.__setattr__(self, "vectorized", True)
        breaks = np.empty(0)
        if np.size(self.breakpoints):
            advice = "Reduce switch times modulo the period."
            breaks = real_numbers("breakpoints", self.breakpoints, 0.0, period, unit="s", action=advice)
        edges = np.unique(np.concatenate(([0.0], breaks, [self.period])))
        # Two switches that differ only by rounding are one switch; keep 0 and T themselves.
        inner = edges[1:-1]
        gap = 4.0 * _INSET * self.period
        separate = [0.0]
        for t in inner:
            if t - separate[-1] > gap and self.period - t > gap:
                separate.append(float(t))
        object.__setattr__(self, "edges", np.array([*separate, self.period]))
        object.__setattr__(self, "breakpoints", tuple(float(t) for t in breaks))

        low, high = self.edges[:2]
        if isinstance(self.A, PeriodicMatrix):
            dimension = self.A.dimension
        else:
            dimension = dimension_of(self.A, self.vectorized, low, high)
        object.__setattr__(self, "dimension", dimension)

    @property
    def kept_form(self) -> SkewForm | None:
        """The skew form that the coefficients prove every motion keeps; None: no such form is known.

        None for a callable A, of which only samples are known.
        """
        if isinstance(self.A, PeriodicMatrix) and self.A.hamiltonian:
            return SkewForm.exact(skew_form(self.dimension // 2))
        return None

    @property
    def symplectic(self) -> bool:
        """Whether the coefficients prove that the motion keeps a skew form, so that M is symplectic."""
        return self.kept_form is not None

    def _call(self, times: FloatArray) -> FloatArray:
        return as_matrices(self.A(times) if self.vectorized else [self.A(float(t)) for t in times])

    def evaluate(self, times: npt.ArrayLike) -> FloatArray:
        """Return A at times [s] strictly inside smooth segments, (k,) -> (k, n, n); checked finite."""
        t = np.asarray(times, dtype=float)
        values = self._call(t)
        shape = (self.dimension, self.dimension)
        if values.shape != (t.size, *shape):
            value = f"shape {values.shape[1:]} at t = {t[0] if t.size else 0.0:g} s"
            raise refuse("A", value, f"{shape} at every time", "Return the same shape for every time.")
        if not np.isfinite(values).all():
            bad = t[~np.isfinite(values).reshape(t.size, -1).all(axis=1)][0]
            raise NumericalError(
                f"A(t) is not finite at t = {bad:.17g} s. Check the coefficients there; if this is a "
                "switch, add it to breakpoints: nothing is evaluated at the ends of a segment."
            )
        return values

    def inside(self, times: FloatArray, start: FloatArray, end: FloatArray) -> FloatArray:
        """Move times at the ends of an interval [start, end] strictly inside the interval."""
        inset = np.minimum(_INSET * self.period, 0.25 * (end - start))
        return np.clip(times, start + inset, end - inset)

    def balancing(self) -> FloatArray:
        """Return d (n,), powers of two such that A_ij d_j / d_i has rows and columns of like size.

        The norm of a state of mixed units (displacements and rates) has no meaning. So all error bounds of
        this package are in the coordinates x_i / d_i. Multipliers do not depend on d.
        """
        # At several times: in the middle of a segment alone an entry may be zero by chance.
        width = np.diff(self.edges)[:, None]
        places = self.edges[:-1, None] + width * np.array([0.13, 0.5, 0.78])
        # The mean over time: a narrow spike must not scale the whole period.
        magnitude = np.tensordot(np.repeat(width.ravel(), 3), np.abs(self.evaluate(places.ravel())), axes=1)
        _, (scale, _) = matrix_balance(magnitude, permute=False, separate=True)
        return np.asarray(scale, dtype=float)
