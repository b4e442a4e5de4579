"""Event-aligned propagation over one period: step sizes, local errors, products."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from numpy.polynomial import chebyshev

from floquet.engine.propagators.one_step import Propagator
from floquet.engine.system import PeriodicSystem
from lumped.errors import NumericalError, ResolutionWarning
from lumped.typing import BoolArray, FloatArray

_EPS = float(np.finfo(np.float64).eps)
_CHUNK = 4_000_000  # numbers held at once by a batch of steps: about 32 MB per temporary
LOOKS = 2048
"""Points per period at which A is looked at besides the nodes of the steps."""
_LOOK_DEGREE = 11
_LOOK_FACTOR = 1e4  # what A may differ by there, h |dA| in units of rtol
_SEED = 20080926
_MAX_SPLIT = 16  # parts into which a refused step is cut at most


@dataclass(frozen=True, eq=False)
class Propagation:
    """Transition matrices over the substeps of one period, in balanced coordinates x_i / d_i.

    Attributes
    ----------
    times : (m+1,) ends of the substeps [s], all switches among them
    steps : (m, n, n) transition matrix of each substep
    truncation : (m,) estimated Frobenius norm of the truncation error of each step matrix
    rounding : (m,) the same of its rounding error, which no smaller step can remove
    scaling : (n,) d, powers of two (`PeriodicSystem.balancing`)
    """

    times: FloatArray
    steps: FloatArray
    truncation: FloatArray
    rounding: FloatArray
    scaling: FloatArray


def _step_batch(
    system: PeriodicSystem, method: Propagator, start: FloatArray, end: FloatArray, d: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Step matrices (k, n, n) over [start, end] and max |A| per step, (k,), in balanced coordinates."""
    n = system.dimension
    s = method.nodes.size
    chunk = max(1, _CHUNK // (s * n) ** 2)
    steps = np.empty((start.size, n, n))
    size = np.empty(start.size)
    for first in range(0, start.size, chunk):
        part = slice(first, first + chunk)
        step_start = start[part]
        step_end = end[part]
        times = step_start[:, None] + (step_end - step_start)[:, None] * method.nodes
        times = system.inside(times, step_start[:, None], step_end[:, None]).ravel()
        A = system.evaluate(times).reshape(step_start.size, s, n, n) * (d[None, :] / d[:, None])
        # An unstable explicit step shows as a non-finite step, which the caller refuses.
        with np.errstate(over="ignore", invalid="ignore"):
            steps[part] = method.step_matrices(A, step_end - step_start)
            size[part] = np.sqrt(np.square(A).sum(axis=(2, 3)).max(axis=1))
    return steps, size


def _initial_grid(system: PeriodicSystem, method: Propagator, d: FloatArray) -> tuple[FloatArray, FloatArray]:
    """First guess: steps of about order/8 radians of the largest |A|, each segment divided evenly."""
    start = []
    end = []
    for a, b in zip(system.edges[:-1], system.edges[1:], strict=True):
        times = a + (b - a) * (np.arange(5) + 0.5) / 5.0
        A = system.evaluate(times) * (d[None, :] / d[:, None])
        angle = (b - a) * np.linalg.norm(A, axis=(1, 2)).max()
        count = max(1, math.ceil(8.0 * angle / max(method.order, 4)))
        if count > 10_000_000:
            raise NumericalError(
                f"the segment {a:g} to {b:g} s spans about {angle:.3g} rad. "
                "Check the units of A and the period."
            )
        grid = np.linspace(a, b, count + 1)
        start.append(grid[:-1])
        end.append(grid[1:])
    return np.concatenate(start), np.concatenate(end)


def propagate(
    system: PeriodicSystem, method: Propagator, rtol: float, max_substeps: int = 200_000
) -> Propagation:
    """Transition matrices of one period, each step accurate to rtol h/T of its norm in balanced coordinates.

    Every step is computed once in full and once as two halves. The difference is the local error, and the
    halves are returned. A step with too large an error is cut; the order of the method decides the parts.
    """
    d = system.balancing()
    start, end = _initial_grid(system, method, d)
    done: list[tuple[FloatArray, FloatArray, FloatArray, FloatArray]] = []
    accepted = 0
    warned = False
    rng = np.random.default_rng(_SEED)
    n = system.dimension
    while start.size:
        if accepted + 2 * start.size > max_substeps:
            raise NumericalError(
                f"more than {max_substeps} substeps per period are needed for rtol = {rtol:g} with method "
                f"{method.name} of order {method.order}. Use a method of higher order (gauss), a larger "
                "rtol or a larger max_substeps; or add missing switch times to breakpoints."
            )
        middle = 0.5 * (start + end)
        full_step, size = _step_batch(system, method, start, end, d)
        first, _ = _step_batch(system, method, start, middle, d)
        second, _ = _step_batch(system, method, middle, end, d)
        with np.errstate(over="ignore", invalid="ignore"):
            halves = second @ first
            truncation = np.linalg.norm(full_step - halves, axis=(1, 2))
            norm = np.linalg.norm(halves, axis=(1, 2))
        h = end - start
        # Rounding of one step: n eps for the product and the solve, and eps |A| h for evaluating A itself.
        rounding = 2.0 * _EPS * (math.sqrt(n) + size * h) * norm
        with np.errstate(invalid="ignore"):
            ratio = truncation / np.maximum(rtol * h / system.period * norm, rounding)
        ratio[~np.isfinite(ratio)] = np.inf
        good = ratio <= 1.0
        missed = np.flatnonzero(good)
        missed = missed[_unseen(system, method, start[missed], end[missed], d, rtol, rng)]
        good[missed] = False
        ratio[missed] = np.inf
        if missed.size and not warned:
            warned = True
            warnings.warn(
                f"A(t) has a feature near t = {middle[missed[0]]:g} s that the samples of a step "
                f"had missed; it is now resolved, but others narrower than {system.period / LOOKS:.2g} s may "
                "not be. Name such times as breakpoints, or give A as a PeriodicMatrix.",
                ResolutionWarning,
                stacklevel=3,
            )
        if (h[~good] < 1e3 * _EPS * system.period).any():
            t = start[~good][0]
            raise NumericalError(
                f"the step size fell to rounding at t = {t:.17g} s, so A is not smooth there. "
                "Add that time to breakpoints if A jumps, or check A for a singularity."
            )
        for a, matrices in ((start, first), (middle, second)):
            done.append((a[good], matrices[good], 0.5 * truncation[good], 0.5 * rounding[good]))
        accepted += 2 * int(good.sum())
        start, end = _cut(start[~good], end[~good], ratio[~good], method.order)
    t, steps, truncation, rounding = (np.concatenate(parts) for parts in zip(*done, strict=True))
    order = np.argsort(t)
    times = np.append(t[order], system.period)
    return Propagation(times, steps[order], truncation[order], rounding[order], scaling=d)


def _unseen(
    system: PeriodicSystem,
    method: Propagator,
    start: FloatArray,
    end: FloatArray,
    d: FloatArray,
    rtol: float,
    rng: np.random.Generator,
) -> BoolArray:
    """Steps (k,) in which A at random points differs from the polynomial through its samples at the nodes.

    A is evaluated once in each of `LOOKS` parts of a period. The polynomial goes through the values at the
    nodes of both halves of the step.
    """
    if start.size == 0:
        return np.zeros(0, dtype=bool)
    x = np.unique(np.concatenate([method.nodes - 1.0, method.nodes]).round(12))
    degree = min(x.size - 1, _LOOK_DEGREE)
    onto = np.linalg.pinv(chebyshev.chebvander(x, degree))
    h = end - start
    scale = d[None, :] / d[:, None]

    def at(places: FloatArray, owner: npt.NDArray[np.intp]) -> FloatArray:
        low = start[owner]
        high = end[owner]
        times = system.inside(low + (high - low) * 0.5 * (places + 1.0), low, high)
        return system.evaluate(times) * scale

    every = np.arange(start.size)
    nodes = at(np.tile(x, start.size), np.repeat(every, x.size))
    series = np.einsum("dx,kxab->kdab", onto, nodes.reshape(start.size, x.size, *scale.shape))
    counts = np.maximum(2, np.ceil(h / system.period * LOOKS)).astype(int)
    owner = np.repeat(every, counts)
    part = np.arange(owner.size) - np.repeat(np.cumsum(counts) - counts, counts)
    places = 2.0 * (part + rng.random(owner.size)) / counts[owner] - 1.0
    worst = np.zeros(start.size)
    for first in range(0, owner.size, 4096):
        some = slice(first, first + 4096)
        expected = np.einsum("qd,qdab->qab", chebyshev.chebvander(places[some], degree), series[owner[some]])
        gap = np.linalg.norm(at(places[some], owner[some]) - expected, axis=(1, 2))
        np.maximum.at(worst, owner[some], gap)
    size = np.linalg.norm(nodes, axis=(1, 2)).reshape(start.size, x.size).max(axis=1)
    return np.asarray(h * worst > np.maximum(_LOOK_FACTOR * rtol, 1e-8) * (1.0 + h * size))


def _cut(start: FloatArray, end: FloatArray, ratio: FloatArray, order: int) -> tuple[FloatArray, FloatArray]:
    """Cut each refused step into as many parts as the method's order asks for, 2 to 16."""
    with np.errstate(over="ignore"):
        parts = np.ceil(1.1 * np.minimum(ratio, 1e300) ** (1.0 / order))
    parts = np.clip(parts, 2, _MAX_SPLIT).astype(int)
    owner = np.repeat(np.arange(start.size), parts)
    index = np.arange(owner.size) - np.repeat(np.cumsum(parts) - parts, parts)
    width = (end - start)[owner] / parts[owner]
    new_start = start[owner] + index * width
    new_end = np.where(index == parts[owner] - 1, end[owner], start[owner] + (index + 1) * width)
    return new_start, new_end


def error_of_product(propagation: Propagation) -> tuple[FloatArray, float, float]:
    """Monodromy matrix in balanced coordinates, an estimate of its error, and the part due to rounding.

    S_j is the product of the steps after step j, Q_j the product before step j, E_j the estimated error of
    step j. The estimate is sum |S_j| |E_j| |Q_j|, of first order.
    """
    steps = propagation.steps
    m, n, _ = steps.shape
    before = np.empty((m + 1, n, n))
    after = np.empty((m + 1, n, n))
    before[0] = after[m] = np.eye(n)
    with np.errstate(over="ignore", invalid="ignore", under="ignore"):
        for j in range(m):
            np.matmul(steps[j], before[j], out=before[j + 1])
        for j in range(m - 1, -1, -1):
            np.matmul(after[j + 1], steps[j], out=after[j])
        weight = np.linalg.norm(after[1:], ord=2, axis=(1, 2)) if np.isfinite(after).all() else np.inf
        weight = weight * np.linalg.norm(before[:-1], axis=(1, 2))
    M = before[m]
    if not np.isfinite(M).all() or not np.isfinite(weight).all():
        raise NumericalError(
            "the state grows beyond the range of floating point within one period, so the system is unstable "
            "on any practical scale. Check the signs of damping and stiffness, or shorten the period."
        )
    # Multiplying m factors rounds m times; n eps per product.
    product = 2.0 * _EPS * math.sqrt(n) * np.linalg.norm(steps, axis=(1, 2))
    # Rounding errors of different steps are independent, unlike truncation errors, and add up like their
    # squares; 4 is four standard deviations even if every single estimate were exact.
    rounding = 4.0 * float(np.linalg.norm(weight * (propagation.rounding + product)))
    return M, float(np.dot(weight, propagation.truncation)) + rounding, rounding
