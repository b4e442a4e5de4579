"""Charts over two axes that are evaluated near the edges of instability and interpolated elsewhere.

A box of nodes is a leaf when three conditions hold: all known verdicts in the box are equal; the growth rate
g = n ln(radius), with n cycles in a unit of time, is bilinear to the tolerance; no two multipliers may meet.
Any other box is cut. Complete rows of the second axis seed the search.

Sources: docs/theory/floquet.md, "Charts that refine themselves".
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from lumped.typing import BoolArray, ComplexArray, FloatArray, IntArray, Progress

#: Largest error of the spectral radius at an interpolated node, above 1 relative to the radius.
TOLERANCE = 4e-3
#: Nodes along the first axis of the boxes of the first round; these boxes have all nodes of the second axis.
_FIRST = 64
#: Misfits along both axes within this factor cut a box along both.
_ALIKE = 2.0
_LEAST_RADIUS = 1e-12
#: Largest over least excess of the radius above 1 in an unstable box that is a leaf. Near an edge of
#: instability the excess falls to 0, perhaps between nodes.
_EXCESS = 8.0
#: Largest change of the `gaps` in a box that is a leaf, over the least of these gaps.
_PER_DECAY = 1.5

#: Flat indices (k,) of nodes -> their spectral radius, verdict and `gaps` (k,); gaps of 0 are not followed.
Ask = Callable[[IntArray], tuple[FloatArray, IntArray, FloatArray]]
#: Indices of the first and the last node along the first axis, then along the second axis.
Box = tuple[int, int, int, int]


@dataclass(frozen=True, eq=False)
class Refined:
    """A chart of N x M nodes, first axis first.

    Attributes
    ----------
    radius : spectral radius, interpolated where ``known`` is False
    verdict : 1 stable, 0 undecided, -1 unstable, 2 neutral; the verdict of the leaf where ``known`` is False
    known : whether the node was evaluated
    misfit : largest misfit of the evaluated nodes of the leaf, at least the tolerance; 0 at evaluated nodes
    """

    radius: FloatArray
    verdict: IntArray
    known: BoolArray
    misfit: FloatArray


def gaps(multipliers: ComplexArray) -> FloatArray:
    """Distance (k,) of multipliers (k, n) from a tongue, by the two multipliers that are nearest to a tongue.

    The distance of two multipliers is the angle between them, or the geometric mean of their decays -ln|.|
    where this is larger. A coupling below the distance leaves both stable (Hsu 1963).
    """
    angle = np.angle(multipliers)
    decay = -np.log(np.maximum(np.abs(multipliers), _LEAST_RADIUS))
    root = np.sqrt(np.maximum(decay, 0.0))
    nearest = np.full(len(multipliers), np.inf)
    for j in range(1, multipliers.shape[1]):
        apart = np.abs((angle[:, :j] - angle[:, j, None] + np.pi) % (2.0 * np.pi) - np.pi)
        nearest = np.minimum(nearest, np.maximum(apart, root[:, :j] * root[:, j, None]).min(axis=1))
    return nearest


def refine(
    shape: tuple[int, int],
    cycles: FloatArray,
    ask: Ask,
    tolerance: float = TOLERANCE,
    *,
    rows: Sequence[int] = (0,),
    progress: Progress | None = None,
) -> Refined:
    """Evaluate a chart where its verdict or its growth rate changes, and interpolate the rest.

    ``shape`` is N, M, nodes along both axes, which increase; ``cycles`` (N,) or (N, M), by which the
    logarithm of the radius is smooth; ``ask`` evaluates nodes by their flat index; ``tolerance`` is the
    largest error of the radius at an interpolated node; ``rows`` of the second axis are evaluated first.
    """
    state = _State(shape, np.broadcast_to(np.reshape(cycles, (shape[0], -1)), shape), ask)
    n, m = shape
    for row in rows:
        state.look(np.arange(n), np.full(n, row % m))
    starts = [*range(0, n - 1, _FIRST)]
    new: list[Box] = [(i, min(i + _FIRST, n - 1), 0, m - 1) for i in starts]
    leaves: dict[Box, int] = {}
    done = 0.0
    while new:
        nodes = np.concatenate([_nine(box) for box in new])
        state.look(nodes[:, 0], nodes[:, 1])
        # A node evaluated for a neighbour may lie in a leaf too: this leaf is judged again.
        again = [box for box, count in leaves.items() if state.count(box) != count]
        boxes = [*new, *again]
        new = []
        for box in boxes:
            leaves.pop(box, None)
            cuts = state.cuts(box, tolerance)
            if cuts:
                new += cuts
            else:
                leaves[box] = state.count(box)
        if progress is not None and new:
            area = sum((b - a) * (d - c) for a, b, c, d in leaves)
            done = max(done, area / ((n - 1) * (m - 1)))
            progress(done)
    return state.filled(leaves, tolerance)


def _nine(box: Box) -> IntArray:
    """Corners, middles of edges and centre of a box, (9, 2)."""
    a, b, c, d = box
    return np.array([(i, j) for i in (a, (a + b) // 2, b) for j in (c, (c + d) // 2, d)], dtype=np.intp)


class _State:
    def __init__(self, shape: tuple[int, int], cycles: FloatArray, ask: Ask) -> None:
        self.ask = ask
        self.cycles = cycles
        self.radius, self.growth, self.gap = (np.full(shape, np.nan) for _ in range(3))
        self.verdict = np.zeros(shape, dtype=np.intp)
        self.known = np.zeros(shape, dtype=bool)

    def look(self, i: IntArray, j: IntArray) -> None:
        """Evaluate the nodes that are not known yet."""
        new_nodes = np.unique(i * self.known.shape[1] + j)
        new_nodes = new_nodes[~self.known.ravel()[new_nodes]]
        if not new_nodes.size:
            return
        places = np.unravel_index(new_nodes, self.known.shape)
        self.radius[places], self.verdict[places], self.gap[places] = self.ask(new_nodes)
        self.known[places] = True
        self.growth[places] = self.cycles[places] * np.log(np.maximum(self.radius[places], _LEAST_RADIUS))

    def count(self, box: Box) -> int:
        a, b, c, d = box
        return int(np.count_nonzero(self.known[a : b + 1, c : d + 1]))

    def misfit(self, box: Box) -> tuple[IntArray, IntArray, FloatArray]:
        """Known nodes of a box, and how far their radius is from the bilinear one."""
        a, b, c, d = box
        i, j = np.nonzero(self.known[a : b + 1, c : d + 1])
        i += a
        j += c
        result = np.exp(self._bilinear(box, i, j) / self.cycles[i, j])
        return i, j, np.abs(result - self.radius[i, j])

    def _bilinear(self, box: Box, i: npt.NDArray[np.intp], j: npt.NDArray[np.intp]) -> FloatArray:
        a, b, c, d = box
        s = (i - a) / max(b - a, 1)
        t = (j - c) / max(d - c, 1)
        g = self.growth
        low = g[a, c] * (1.0 - s) + g[b, c] * s
        high = g[a, d] * (1.0 - s) + g[b, d] * s
        return np.asarray(low * (1.0 - t) + high * t, dtype=np.float64)

    def cuts(self, box: Box, tolerance: float) -> list[Box]:
        """The parts into which a box is cut; an empty list: the box is a leaf."""
        a, b, c, d = box
        divisible_along_first = b - a > 1
        divisible_along_second = d - c > 1
        if not (divisible_along_first or divisible_along_second):
            return []
        i, j, error = self.misfit(box)
        verdict = self.verdict[i, j]
        mixed = bool((verdict != verdict[0]).any())
        meeting = False
        if not mixed:
            radius = self.radius[i, j]
            allowed = tolerance * np.maximum(radius, 1.0)
            if abs(verdict[0]) == 1:
                allowed = np.minimum(allowed, 0.5 * np.abs(radius - 1.0))
            if (error <= allowed).all():
                excess = radius - 1.0
                gap = self.gap[i, j]
                meeting = bool(verdict[0] >= 0 and np.ptp(gap) > _PER_DECAY * gap.min())
                if not (meeting or (verdict[0] < 0 and excess.max() > _EXCESS * excess.min())):
                    return []
        along, up = self._ways(box, i, j, error, mixed=mixed, meeting=meeting)
        along = (along and divisible_along_first) or not divisible_along_second
        up = (up and divisible_along_second) or not divisible_along_first
        return parts_of(box, along=along and divisible_along_first, up=up and divisible_along_second)

    def _ways(
        self, box: Box, i: IntArray, j: IntArray, error: FloatArray, *, mixed: bool, meeting: bool
    ) -> tuple[bool, bool]:
        """Whether to cut along the first and along the second axis: by verdicts, gaps or misfits."""
        a, b, c, d = box
        if mixed:
            edges = [self.verdict[i[on], j[on]] for on in (j == c, j == d, i == a, i == b)]
            lower, upper, first_edge, last_edge = (bool((edge != edge[0]).any()) for edge in edges)
            along = lower or upper
            up = first_edge or last_edge
            return (along, up) if along or up else (True, True)
        if meeting:
            gap = self.gap[np.ix_((a, (a + b) // 2, b), (c, (c + d) // 2, d))]
            across, upward = (np.abs(np.diff(gap, axis=axis)).max() for axis in (0, 1))
        else:
            across = error[(j == c) | (j == d)].max(initial=0.0)
            upward = error[(i == a) | (i == b)].max(initial=0.0)
        return across * _ALIKE >= upward, upward * _ALIKE >= across

    def filled(self, leaves: dict[Box, int], tolerance: float) -> Refined:
        """Interpolate the nodes that are not evaluated, in the four quarters of each leaf."""
        misfit = np.zeros(self.known.shape)
        for box in leaves:
            a, b, c, d = box
            box_nodes = slice(a, b + 1), slice(c, d + 1)
            if self.known[box_nodes].all():
                continue
            _, _, error = self.misfit(box)
            size = max(tolerance, float(error.max()))
            verdict = self.verdict[a, c]
            for part in parts_of(box, along=b - a > 1, up=d - c > 1):
                p, q, r, s = part
                inner = slice(p, q + 1), slice(r, s + 1)
                i, j = np.nonzero(~self.known[inner])
                i += p
                j += r
                self.radius[i, j] = np.exp(self._bilinear(part, i, j) / self.cycles[i, j])
                self.verdict[i, j] = verdict
                misfit[i, j] = size
        return Refined(self.radius, self.verdict, self.known, misfit)


def parts_of(box: Box, *, along: bool, up: bool) -> list[Box]:
    """Halves or quarters of a box."""
    a, b, c, d = box
    columns = [(a, (a + b) // 2), ((a + b) // 2, b)] if along else [(a, b)]
    rows = [(c, (c + d) // 2), ((c + d) // 2, d)] if up else [(c, d)]
    return [(*column, *row) for column in columns for row in rows]
