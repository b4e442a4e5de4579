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
#: Steps solved together, a bound on memory.
_BLOCK = 2048
#: Most steps of a mesh cycle; the maps of this many take 1.5 GB.
_MAX_STEPS = 1_000_000


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
        phi, f = self.transition, self.forced
        while phi.shape[0] > 1:  # neighbours are merged two by two
            odd = phi.shape[0] % 2
            first, last = slice(0, phi.shape[0] - odd, 2), slice(1, None, 2)
            merged = phi[last] @ phi[first], phi[last] @ f[first] + f[last]
            phi, f = (
                np.concatenate([new, old[-1:]]) if odd else new
                for new, old in zip(merged, (phi, f), strict=True)
            )
        return phi[0], f[0]

    def states(self, initial: FloatArray, weights: FloatArray) -> FloatArray:
        """States (steps + 1, n) at the edges from x(0) and the weight (columns,) of each forcing."""
        x = np.empty((self.edges.size, initial.size))
        x[0] = initial
        forced = self.forced @ weights
        for j, phi in enumerate(self.transition):
            x[j + 1] = phi @ x[j] + forced[j]
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
    extra : (n, columns) constant forcings of the rates to carry beside the system's own
    outputs : times in [0, T_m] that must be step edges [s]
    step_angle : largest angle of the fastest frequency per step [rad]
    stages : of the Gauss method; the order is twice as large

    Raises
    ------
    NumericalError : the result is not finite
    """
    edges, segments = _step_edges(system, outputs, step_angle)
    n, steps, columns = system.size, edges.size - 1, 1 + extra.shape[1]
    transition, forced = np.empty((steps, n, n)), np.empty((steps, n, columns))
    for segment in np.unique(segments):
        rows = np.flatnonzero(segments == segment)
        for block in np.array_split(rows, 1 + rows.size // _BLOCK):
            start, h = edges[block], edges[block + 1] - edges[block]
            transition[block], forced[block] = _steps(system, int(segment), start, h, extra, stages)
    if not (np.isfinite(transition).all() and np.isfinite(forced).all()):
        raise NumericalError(
            "The mesh cycle could not be integrated: check stiffness and inertia for extremes."
        )
    return StepMaps(edges, transition, forced)


def _steps(
    system: LTVSystem, segment: int, start: FloatArray, h: FloatArray, extra: FloatArray, stages: int
) -> tuple[FloatArray, FloatArray]:
    """Maps of Gauss steps of lengths h (k,) from the times ``start``, all within one segment.

    In x = (z, v) with z' = v only the stage accelerations W_i are unknown,
    W_i = K_i (z + h c_i v + h^2 (a a)_ij W_j) + C_i (v + h a_ij W_j) + f_i,
    half the size of the same method on x' = A x + b; solved for all unit states and forcings together.
    """
    a, b, c = gauss_tableau(stages)
    m, k = system.size // 2, h.size
    times = (start[:, None] + h[:, None] * c).ravel()
    lower = system.matrices(times, segment)[:, m:].reshape(k, stages, m, 2 * m)
    stiffness, damping = lower[..., :m], lower[..., m:]
    step = h[:, None, None, None]
    left = -np.einsum("kimn,ij->kimjn", stiffness * step**2, a @ a)
    left -= np.einsum("kimn,ij->kimjn", damping * step, a)
    left = left.reshape(k, stages * m, stages * m)
    left[:, np.arange(stages * m), np.arange(stages * m)] += 1.0
    right = np.empty((k, stages, m, 2 * m + 1 + extra.shape[1]))
    right[..., :m] = stiffness
    right[..., m : 2 * m] = damping + step * c[:, None, None] * stiffness
    right[..., 2 * m] = system.forcing(times, segment)[:, m:].reshape(k, stages, m)
    right[..., 2 * m + 1 :] = extra[m:]
    w = np.linalg.solve(left, right.reshape(k, stages * m, -1)).reshape(right.shape)
    maps = np.empty((k, 2 * m, right.shape[-1]))
    maps[:, :m] = np.einsum("k,i,kimc->kmc", h**2, b @ a, w)
    maps[:, m:] = np.einsum("k,i,kimc->kmc", h, b, w)
    diagonal = np.arange(m)
    maps[:, np.arange(2 * m), np.arange(2 * m)] += 1.0
    maps[:, diagonal, diagonal + m] += h[:, None]
    return maps[..., : 2 * m], maps[..., 2 * m :]


def _step_edges(
    system: LTVSystem, outputs: FloatArray | None, step_angle: float
) -> tuple[FloatArray, np.ndarray[tuple[int, ...], np.dtype[np.int64]]]:
    """Step edges (steps + 1,) including switches and outputs, and each step's segment."""
    period, switches = system.period, system.cycle.edges
    # Within a step each coefficient is one polynomial: where a law varies fast, its pieces are short.
    marks = np.union1d(switches, system.cycle.knot_times)
    if outputs is not None:
        marks = np.union1d(marks, outputs)
    # Marks that differ by rounding are one, and a switch stays where it is exactly.
    close = np.flatnonzero(np.diff(marks) < 1e-13 * period)
    drop = [j if marks[j + 1] in switches else j + 1 for j in close]
    marks = np.delete(marks, drop)
    largest = step_angle / fastest_frequency(system)
    pieces = np.maximum(1.0, np.ceil(np.diff(marks) / largest))
    if not pieces.sum() <= _MAX_STEPS:
        raise NumericalError(
            f"A mesh cycle of {period:.3g} s takes {pieces.sum():.3g} steps at the fastest vibration, more "
            f"than {_MAX_STEPS}: raise the speed, or lower stiffness or damping where they are extreme."
        )
    parts = [
        np.linspace(low, high, int(count), endpoint=False)
        for low, high, count in zip(marks[:-1], marks[1:], pieces, strict=True)
    ]
    edges = np.concatenate([*parts, marks[-1:]])
    middles = 0.5 * (edges[1:] + edges[:-1])
    return edges, np.searchsorted(switches, middles, side="right") - 1
