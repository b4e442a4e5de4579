"""Periodic motion of x' = A(t) x + b(t), without letting anything settle.

Sources: docs/theory/floquet.md, "Forced motion from the same matrix".
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from floquet.engine.monodromy import checked_effort
from floquet.engine.multipliers import Certificate, Spectrum, multipliers_with_bounds
from floquet.engine.propagation import Propagation, error_of_product, propagate
from floquet.engine.propagators.one_step import Propagator
from floquet.engine.propagators.registry import propagator
from floquet.engine.system import PeriodicSystem
from lumped.arguments import real_numbers
from lumped.errors import NumericalError
from lumped.typing import FloatArray


@dataclass(frozen=True, eq=False)
class PeriodicMotion:
    """The solution with x(T) = x(0).

    Attributes
    ----------
    times : (k,) [s]
    states : (k, n) x at ``times``
    initial : (n,) x(0)
    initial_error : estimate of the 2-norm of the error of x(0) in the coordinates x_i / scaling_i
    scaling : (n,) scales of the states, such that the forcing over one period is of order one
    closure : |x(T) - x(0)| in the same coordinates, x(T) by marching through the period
    spectrum : multipliers of the system: where its ``verdict`` is "unstable" the motion exists, but nothing
        that starts beside it stays there
    """

    times: FloatArray
    states: FloatArray
    initial: FloatArray
    initial_error: float
    scaling: FloatArray
    closure: float
    spectrum: Spectrum

    @property
    def certificate(self) -> Certificate:
        """What all errors here are, those of the spectrum too: an estimate."""
        return self.spectrum.certificate


def periodic_motion(
    system: PeriodicSystem,
    times: npt.ArrayLike = (0.0,),
    rtol: float = 1e-10,
    *,
    method: str | Propagator = "gauss",
    max_substeps: int = 200_000,
) -> PeriodicMotion:
    """Periodic motion under the forcing of the system, whether it is stable or not: see its ``spectrum``.

    The flow of (x, 1) over one period is [[M, g], [0, 1]]; x(0) solves (I - M) x(0) = g.

    Parameters
    ----------
    system : with forcing ``b``; without one the motion is zero
    times : (k,) when to return x, 0 <= t <= T [s]
    rtol : wanted accuracy of the flow relative to its norm, 1e-14 to 1e-1
    method, max_substeps : as in `monodromy`

    Raises
    ------
    ParameterError : times outside the period, or rtol out of range
    NumericalError
        A multiplier is +1 within the error, as it is for a free rigid motion: no periodic motion, or many.
    """
    rtol, max_substeps = checked_effort(rtol, max_substeps)
    wanted = real_numbers(
        "times", times, 0.0, system.period, unit="s", action="Reduce them modulo the period."
    )
    scale = _scales(system)
    augmented = _augmented(system, wanted)
    flow = propagate(augmented, propagator(method), rtol, max_substeps, np.append(scale, 1.0))
    product, delta, _ = error_of_product(flow)
    n = system.dimension
    M, g = product[:n, :n], product[:n, n]
    closed = np.eye(n) - M
    singular = np.linalg.svd(closed, compute_uv=False)
    if not singular[-1] > 2.0 * delta:
        raise NumericalError(
            f"no periodic motion can be told: the smallest singular value of I - M is {singular[-1]:.2g} "
            f"with an error of {delta:.2g}, so a multiplier is at +1. Deflate free rigid motions, change the "
            "period slightly, add damping, or ask for a smaller rtol."
        )
    y = np.linalg.solve(closed, g)
    states, closure = _march(flow, np.append(y, 1.0))
    at = np.searchsorted(flow.times, wanted - 1e-12 * system.period)
    # (I - M)(x - y) = (error of M) y + error of g, both parts of the error of the augmented product.
    error = delta * math.hypot(float(np.linalg.norm(y)), 1.0) / (float(singular[-1]) - delta)
    return PeriodicMotion(
        times=wanted,
        states=states[at, :n] * scale,
        initial=y * scale,
        initial_error=error,
        scaling=scale,
        closure=closure,
        spectrum=Spectrum(*multipliers_with_bounds(M, delta), system.period),
    )


def _scales(system: PeriodicSystem) -> FloatArray:
    """Balancing scales times the power of two that makes the forcing over one period of order one."""
    d = system.balancing()
    middle = 0.5 * (system.edges[:-1] + system.edges[1:])
    size = float(np.abs(system.forcing(middle) / d).max()) * system.period
    return d * 2.0 ** round(math.log2(size)) if size > 0.0 else d


def _augmented(system: PeriodicSystem, times: FloatArray) -> PeriodicSystem:
    """The homogeneous system of (x, 1), with ``times`` among its breakpoints."""
    n = system.dimension

    def A(t: FloatArray) -> FloatArray:
        out = np.zeros((t.size, n + 1, n + 1))
        out[:, :n, :n] = system.evaluate(t)
        out[:, :n, n] = system.forcing(t)
        return out

    return PeriodicSystem(A, system.period, [*system.edges[1:-1], *times], vectorized=True)


def _march(flow: Propagation, start: FloatArray) -> tuple[FloatArray, float]:
    states = np.empty((flow.times.size, start.size))
    states[0] = start
    for k, step in enumerate(flow.steps):
        states[k + 1] = step @ states[k]
    return states, float(np.linalg.norm(states[-1] - states[0]))
