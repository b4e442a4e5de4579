"""Largest flow within a cycle of one point of a rank-one feedback system.

Sources: docs/theory/proven_bounds.md, "Between the nodes of a chart".
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from floquet.rank_one.kernels.gains import Limits, Point, Points, Problem, most_steps
from floquet.rank_one.kernels.taylor import RecordedSteps, propagate_points
from lumped.typing import FloatArray

_U = 0.5 * float(np.finfo(np.float64).eps)
_SLACK = 1.0 + 1e-11  # covers the rounding of a norm


class LargestFlow(NamedTuple):
    """The largest flow within a cycle.

    Attributes
    ----------
    size : largest 2-norm of the computed flows between any two ends of steps, from above
    error : sum of the errors of the steps and of their products, each over the size of the flow before
    """

    size: float
    error: float


def largest_flow(problem: Problem, point: Point, limits: Limits) -> LargestFlow:
    """Largest flow between any two ends of steps; not numbers where a cycle takes too many steps."""
    steps = _steps(problem, point, limits)
    if steps is None:
        return LargestFlow(math.nan, math.nan)
    count = int(steps.number[0])
    n = steps.matrices.shape[1]
    error = float((steps.errors[:count] + 2.0 * n * n * _U * steps.sizes[:count]).sum())
    flows = np.empty((count, n, n))  # from the start of each step to the end of the present one
    size = 1.0
    with np.errstate(over="ignore", invalid="ignore"):
        for j in range(count):
            flows[j] = np.eye(n)
            flows[: j + 1] = steps.matrices[j] @ flows[: j + 1]
            size = _largest_norm(flows[: j + 1], size)
    return LargestFlow(size, error)


def _largest_norm(flows: FloatArray, known: float) -> float:
    """Bound on the 2-norms of flows (N, n, n) above a known one, else that; not a number where a flow is not.

    |F|^8 <= |(F^T F)^4|_F, too large by at most the 16th root of n.
    """
    larger = flows[~(np.linalg.norm(flows, axis=(1, 2)) <= known)]
    if larger.shape[0] == 0:
        return known
    square = larger.transpose(0, 2, 1) @ larger
    fourth = square @ square
    sizes = np.linalg.norm(fourth @ fourth, axis=(1, 2)) ** 0.125 * _SLACK
    return float(np.append(sizes, known).max())


def no_steps(n: int) -> RecordedSteps:
    """Room for no step of n states: nobody asks for them."""
    return RecordedSteps(np.empty((0, n, n)), np.empty(0), np.empty(0), np.zeros(1, dtype=np.int64))


def _steps(problem: Problem, point: Point, limits: Limits) -> RecordedSteps | None:
    """Steps of a cycle; None: there are too many."""
    n = 2 * problem.v.size
    most = most_steps(n)
    steps = RecordedSteps(np.empty((most, n, n)), np.empty(most), np.empty(most), np.zeros(1, dtype=np.int64))
    points = Points(point.weights[None], np.array([point.zeta]), np.array([point.period]))
    failed = propagate_points(problem, points, limits, np.empty((1, n, n)), np.empty(1), steps)
    return steps if failed < 0 else None
