"""Gauss-Legendre collocation for linear systems with smooth coefficients, all steps of a cycle at once."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from lumped.errors import NumericalError
from lumped.path_function import FloatArray
from lumped.periodic_system import LTVSystem

#: Largest angle per step of the fastest frequency [rad]. With 4 stages (order 8) the local error constant is
#: (4!)^4 / (9 (8!)^3) = 5.6e-10, so a step of 0.5 rad errs by about 1e-12.
STEP_ANGLE = 0.5
STAGES = 4


@cache
def gauss_tableau(stages: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Butcher tableau (a, b, c) of the Gauss method with s stages, order 2 s, on [0, 1]."""
    nodes, weights = np.polynomial.legendre.leggauss(stages)
    c, b = 0.5 * (nodes + 1.0), 0.5 * weights
    powers = np.arange(stages)
    vandermonde = c[:, None] ** powers
    a = (c[:, None] ** (powers + 1) / (powers + 1)) @ np.linalg.inv(vandermonde)
    return a, b, c


@dataclass(frozen=True, eq=False)
class StepMaps:
    """Affine maps x(end) = transition x(start) + forced of consecutive steps.

    Attributes
    ----------
    edges : (steps + 1,) times [s]
    transition : (steps, n, n)
    forced : (steps, n, columns) for each forcing: the own one, then one per unit of each extra column
    """

    edges: FloatArray
    transition: FloatArray
    forced: FloatArray

    def over_all(self) -> tuple[FloatArray, FloatArray]:
        """Map over all steps: transition (n, n) and forced (n, columns)."""
        n = self.transition.shape[1]
        total = np.eye(n)
        forced = np.zeros((n, self.forced.shape[2]))
        for phi, f in zip(self.transition, self.forced, strict=True):
            total = phi @ total
            forced = phi @ forced + f
        return total, forced

    def states(self, initial: FloatArray, weights: FloatArray) -> FloatArray:
        """States (steps + 1, n) at the edges from x(0) and the weight (columns,) of each forcing."""
        x = np.empty((self.edges.size, initial.size))
        x[0] = initial
        for j, (phi, f) in enumerate(zip(self.transition, self.forced, strict=True)):
            x[j + 1] = phi @ x[j] + f @ weights
        return x


def fastest_frequency(system: LTVSystem) -> float:
    """Bound on the fastest natural frequency over the cycle [rad/s], from frozen-time eigenvalues."""
    middles = 0.5 * (system.cycle.edges[1:] + system.cycle.edges[:-1])
    values = np.linalg.eigvals(system.matrices(middles))
    return float(np.abs(values).max()) * 1.1


def step_maps(
    system: LTVSystem,
    extra: FloatArray,
    *,
    outputs: FloatArray | None = None,
    step_angle: float = STEP_ANGLE,
    stages: int = STAGES,
) -> StepMaps:
    """Propagate all unit states and forcings over one mesh cycle, step by step, aligned with the switches.

    Parameters
    ----------
    system : the periodic system
    extra : (n, columns) constant forcings to carry beside the system's own
    outputs : times in [0, T_m] that must be step edges [s]
    step_angle : largest angle of the fastest frequency per step [rad]
    stages : of the Gauss method; the order is twice as large

    Raises
    ------
    NumericalError : the result is not finite
    """
    edges, segments = _step_edges(system, outputs, step_angle)
    a, b, c = gauss_tableau(stages)
    n, steps = system.size, edges.size - 1
    h = np.diff(edges)
    matrices = np.empty((steps, stages, n, n))
    forcing = np.empty((steps, stages, n))
    for segment in np.unique(segments):
        rows = segments == segment
        times = (edges[:-1][rows, None] + h[rows, None] * c).ravel()
        matrices[rows] = system.matrices(times, int(segment)).reshape(-1, stages, n, n)
        forcing[rows] = system.forcing(times, int(segment)).reshape(-1, stages, n)
    # Stage slopes K_i = A_i (x + h sum_j a_ij K_j) + f_i, solved for all unit states and forcings together.
    left = -np.einsum("k,kimn,ij->kimjn", h, matrices, a).reshape(steps, stages * n, stages * n)
    left[:, np.arange(stages * n), np.arange(stages * n)] += 1.0
    columns = 1 + extra.shape[1]
    right = np.empty((steps, stages, n, n + columns))
    right[..., :n] = matrices
    right[..., n] = forcing
    right[..., n + 1 :] = extra
    slopes = np.linalg.solve(left, right.reshape(steps, stages * n, n + columns))
    increment = np.einsum("k,i,kimc->kmc", h, b, slopes.reshape(steps, stages, n, n + columns))
    transition = increment[..., :n]
    transition[:, np.arange(n), np.arange(n)] += 1.0
    if not np.isfinite(increment).all():
        raise NumericalError(
            "The mesh cycle could not be integrated: check stiffness and inertia for extremes."
        )
    return StepMaps(edges, transition, increment[..., n:])


def _step_edges(
    system: LTVSystem, outputs: FloatArray | None, step_angle: float
) -> tuple[FloatArray, np.ndarray[tuple[int, ...], np.dtype[np.int64]]]:
    """Step edges (steps + 1,) including switches and outputs, and each step's segment."""
    period, switches = system.period, system.cycle.edges
    marks = np.union1d(switches, np.empty(0) if outputs is None else outputs)
    # Marks that differ by rounding are one, and a switch stays where it is exactly.
    close = np.flatnonzero(np.diff(marks) < 1e-13 * period)
    drop = [j if marks[j + 1] in switches else j + 1 for j in close]
    marks = np.delete(marks, drop)
    largest = step_angle / fastest_frequency(system)
    pieces = np.maximum(1, np.ceil(np.diff(marks) / largest).astype(int))
    parts = [
        np.linspace(low, high, count, endpoint=False)
        for low, high, count in zip(marks[:-1], marks[1:], pieces, strict=True)
    ]
    edges = np.concatenate([*parts, marks[-1:]])
    middles = 0.5 * (edges[1:] + edges[:-1])
    return edges, np.searchsorted(switches, middles, side="right") - 1
