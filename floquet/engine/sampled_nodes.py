"""Many systems given by one vectorised function: monodromy matrices in one call, with estimated errors.

In every step A(t) is replaced by the polynomial through its values at Chebyshev points; the Taylor series of
this polynomial gives the transition matrix. The last coefficients estimate what the polynomial misses.

Sources: docs/theory/floquet.md, "Many systems at once".
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numpy.polynomial import chebyshev
from scipy.linalg import matrix_balance

from floquet.engine.kernels.steps import product_bounds, taylor_flows
from floquet.engine.many_multipliers import FastMultipliers, multipliers_of
from lumped.arguments import real_numbers
from lumped.errors import NumericalError, refuse
from lumped.typing import FloatArray

_EPS = float(np.finfo(np.float64).eps)
_DEGREE = 8
_NODES = chebyshev.chebpts1(_DEGREE + 1)  # inside (-1, 1): A is not evaluated at a break
_ONTO = np.linalg.inv(chebyshev.chebvander(_NODES, _DEGREE))
#: Row j: the Chebyshev polynomial j of 2 s - 1 in powers of s, lowest power first.
_POWERS = np.array([
    np.pad(chebyshev.Chebyshev.basis(j, domain=[0.0, 1.0]).convert(kind=np.polynomial.Polynomial).coef,
           (0, _DEGREE - j))
    for j in range(_DEGREE + 1)
])  # fmt: skip
_TERMS = 24  # of the Taylor series of a step; the rest is below 1e-16 of what a step of 2 rad may be
_ANGLE = 2.0  # largest |A| h of a step
_MOST_STEPS = 5_000
_CHUNK = 500_000  # numbers of the coefficients of the steps that are computed together


@dataclass(frozen=True, eq=False)
class PeriodicSystems:
    """N systems x' = A(t) x whose coefficients are computed in one call.

    Errors are estimates: features of A(t) that are narrower than a step can be missed.

    Parameters
    ----------
    A : callable, phases (k,) of the period, 0 < phase < 1 -> (N, k, n, n) [1/s], A at phase times the period
    period : (N,) or one number, T > 0 [s]
    break_phases : phases between 0 and 1 at which A jumps or has a kink, those of all systems
    """

    A: Callable[[FloatArray], npt.ArrayLike]
    period: npt.ArrayLike
    break_phases: Sequence[float] = ()

    def __post_init__(self) -> None:
        if not callable(self.A):
            raise refuse("A", type(self.A).__name__, "a callable phases -> (N, k, n, n)", "Give a function.")
        advice = "Give the length of one cycle."
        periods = real_numbers("period", np.atleast_1d(self.period), 0.0, above=True, unit="s", action=advice)
        object.__setattr__(self, "period", periods)
        inner = np.empty(0)
        if np.size(self.break_phases):
            inner = real_numbers("break_phases", self.break_phases, 0.0, 1.0, action="Divide by the period.")
        object.__setattr__(self, "break_phases", tuple(np.unique(np.concatenate([[0.0], inner, [1.0]]))))

    def evaluate(self, phases: FloatArray, count: int) -> FloatArray:
        """A T at phases (k,), (count, k, n, n), checked."""
        values = np.asarray(self.A(phases))
        square = values.ndim == 4 and values.shape[2] == values.shape[3] and values.shape[2] > 0
        if not square or values.shape[:2] != (count, phases.size) or values.dtype.kind not in "fiu":
            value = f"shape {values.shape} of {values.dtype}"
            allowed = f"real numbers ({count}, {phases.size}, n, n): systems, phases, matrices"
            raise refuse("A", value, allowed, "Check the shape that the callable returns.")
        if not np.isfinite(values).all():
            raise NumericalError(
                "A is not finite at a phase inside the period. Name its switches as break_phases."
            )
        periods = np.broadcast_to(np.asarray(self.period), (count,))
        return np.asarray(values * periods[:, None, None, None], dtype=float)


def estimated_multipliers(systems: PeriodicSystems, count: int, rtol: float) -> FastMultipliers:
    """Multipliers (count, n) of all systems, and estimates of their errors.

    Raises
    ------
    ParameterError : another number of systems or periods than count, values that are no matrices
    NumericalError : too many steps, or growth beyond floating point
    """
    periods = np.asarray(systems.period)
    if periods.size not in (1, count):
        raise refuse(
            "period", f"{periods.size} numbers", f"one, or one for each of {count} systems", "Match them."
        )
    edges = np.asarray(systems.break_phases)
    first_look = systems.evaluate(_places(edges), count)
    scaling = _balanced(first_look)
    angle = np.linalg.norm(first_look * (scaling / scaling[:, None]), axis=(2, 3))
    of_segment = angle.reshape(count, edges.size - 1, -1).max(axis=(0, 2)) * np.diff(edges)
    steps = np.maximum(1, np.ceil(of_segment / _ANGLE)).astype(int)
    while steps.sum() <= _MOST_STEPS:
        parts = [np.linspace(a, b, k + 1)[:-1] for a, b, k in zip(edges, edges[1:], steps, strict=False)]
        matrices, errors = _propagated(systems, np.append(np.concatenate(parts), 1.0), scaling, count)
        if not np.isfinite(matrices).all():
            raise NumericalError("a state grows beyond the range of floating point within one period.")
        if (errors <= rtol * np.linalg.norm(matrices, axis=(1, 2))).all():
            return multipliers_of(matrices, errors)
        steps *= 2
    raise NumericalError(
        f"more than {_MOST_STEPS} steps per period are needed for rtol = {rtol:g}. Name the switches of A as "
        "break_phases, use a larger rtol, or give each system by itself."
    )


def _places(edges: FloatArray) -> FloatArray:
    """Chebyshev points of each interval between edges, all together."""
    width = np.diff(edges)[:, None]
    return np.asarray((edges[:-1, None] + width * 0.5 * (_NODES + 1.0)).ravel())


def _balanced(values: FloatArray) -> FloatArray:
    """One scaling d (n,) for all systems, of the mean of |A| over systems and phases."""
    sizes = np.abs(values)
    largest = np.maximum(sizes.max(axis=(1, 2, 3), keepdims=True), np.finfo(float).tiny)
    _, (scale, _) = matrix_balance((sizes / largest).mean(axis=(0, 1)), permute=False, separate=True)
    return np.asarray(scale, dtype=float)


def _propagated(
    systems: PeriodicSystems, edges: FloatArray, scaling: FloatArray, count: int
) -> tuple[FloatArray, FloatArray]:
    """Monodromy matrices (count, n, n) in balanced coordinates and estimates (count,) of their errors."""
    n = scaling.size
    width = np.diff(edges)
    flows = np.empty((count, width.size, n, n))
    errors = np.empty((count, width.size))
    chunk = max(1, _CHUNK // (count * (_DEGREE + 1) * n * n))
    for first in range(0, width.size, chunk):
        part = slice(first, first + chunk)
        values = systems.evaluate(_places(edges[first : first + chunk + 1]), count)
        values = values * (scaling / scaling[:, None])
        values = values.reshape(count, -1, _DEGREE + 1, n * n) * width[part][:, None, None]
        series = np.matmul(_ONTO, values)
        rows = np.matmul(_POWERS.T, series).reshape(-1, _DEGREE + 1, n, n)
        out = np.empty((len(rows), n, n))
        taylor_flows(rows, np.full(len(rows), _TERMS), out)
        flows[:, part] = out.reshape(count, -1, n, n)
        sizes = np.linalg.norm(series, axis=3)
        growth = np.exp(np.minimum(sizes.sum(axis=2), 50.0))
        last_terms = sizes[:, :, -2:].sum(axis=2)
        before = sizes[:, :, -4:-2].sum(axis=2)
        # What follows the last two terms falls as they do; and rounding, of values, Taylor terms and sum.
        falling = np.minimum(last_terms / np.maximum(before, np.finfo(float).tiny), 1.0)
        misfit = last_terms * falling + 4.0 * n * _EPS * (1.0 + sizes.sum(axis=2))
        errors[:, part] = misfit * growth
    matrices = np.empty((count, n, n))
    bounds = np.empty(count)
    ends = np.arange(count + 1) * width.size
    product_bounds(flows.reshape(-1, n, n), errors.ravel(), ends, matrices, bounds)
    return matrices, bounds
