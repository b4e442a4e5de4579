"""Charts over two axes that are evaluated near the edges of instability and interpolated elsewhere.

A box of nodes is a leaf when three conditions hold: all known verdicts in the box are equal; the growth rate
g = n ln(radius), with n cycles in a unit of time, is bilinear to the tolerance; no two multipliers may meet.
Any other box is cut. Complete rows of the second axis seed the search. The search is compiled, see
`floquet.engine.node_boxes`.

Sources: docs/theory/floquet.md, "Charts that refine themselves".
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from floquet.engine.node_boxes import (
    FIRST_WIDTH,
    BoxTree,
    EvaluatedNodes,
    FlatChart,
    Plane,
    fill_leaves,
    judge_boxes,
    mark_boxes,
)
from lumped.typing import BoolArray, ComplexArray, FloatArray, IntArray, Progress

#: Largest error of the spectral radius at an interpolated node, above 1 relative to the radius.
TOLERANCE = 4e-3
_LEAST_RADIUS = 1e-12


class NodeValues(NamedTuple):
    """Results at evaluated nodes.

    Attributes
    ----------
    radius : (k,) spectral radius
    verdict : (k,) 1 stable, 0 undecided, -1 unstable, 2 neutral
    gap : (k,) `gaps` of the multipliers; gaps of 0 are not followed
    """

    radius: FloatArray
    verdict: npt.NDArray[np.int8]
    gap: FloatArray


#: Flat indices (k,) of nodes, increasing -> results there.
Ask = Callable[[IntArray], NodeValues]


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
    verdict: npt.NDArray[np.int8]
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

    Arguments are those of `search_leaves`.
    """
    leaves = search_leaves(shape, cycles, ask, tolerance, rows=rows, progress=progress)
    n, m = shape
    chart = FlatChart(np.empty(n * m), np.zeros(n * m), np.zeros(n * m, dtype=np.int8))
    known = np.zeros(n * m, dtype=bool)
    chart.radius[leaves.places] = leaves.nodes.radius
    chart.verdict[leaves.places] = leaves.nodes.verdict
    known[leaves.places] = True
    leaves.fill(Plane(np.arange(n) * m, np.arange(m)), chart)
    return Refined(
        chart.radius.reshape(shape),
        chart.verdict.reshape(shape),
        known.reshape(shape),
        chart.error.reshape(shape),
    )


@dataclass(frozen=True, eq=False)
class Leaves:
    """The leaves of a chart of N x M nodes and all evaluated nodes.

    Attributes
    ----------
    tree : all boxes
    boxes : indices of the leaves in the tree, in the order in which they were judged
    places : (k,) flat indices of the evaluated nodes, increasing
    nodes : the evaluated nodes
    cycles : (N,) cycles in a unit of time
    tolerance : largest error of the radius at an interpolated node
    """

    tree: BoxTree
    boxes: IntArray
    places: IntArray
    nodes: EvaluatedNodes
    cycles: FloatArray
    tolerance: float

    def fill(self, plane: Plane, chart: FlatChart) -> None:
        """Interpolate in a chart all nodes that are not evaluated; the other nodes do not change."""
        fill_leaves(self.tree, self.boxes, self.nodes, self.cycles, self.tolerance, plane, chart)


def search_leaves(
    shape: tuple[int, int],
    cycles: FloatArray,
    ask: Ask,
    tolerance: float = TOLERANCE,
    *,
    rows: Sequence[int] = (0,),
    progress: Progress | None = None,
) -> Leaves:
    """Evaluate a chart where its verdict or its growth rate changes.

    Parameters
    ----------
    shape : N, M, nodes along both axes, which increase
    cycles : (N,) factors by which the logarithm of the radius is smooth
    ask : evaluates nodes by their flat index
    tolerance : largest error of the radius at an interpolated node
    rows : of the second axis, evaluated first
    progress : called with the finished share of the area
    """
    n, m = shape
    nodes = _Nodes(shape, cycles, ask)
    for row in rows:
        nodes.evaluate(np.arange(n, dtype=np.int64) * m + row % m)
    boxes = _Boxes(shape)
    leaves = np.empty(0, dtype=np.int64)
    new = np.arange(boxes.count)
    done = 0.0
    while new.size:
        marks = boxes.marked(nodes.evaluate(boxes.nine_nodes(new)))
        # A node evaluated for a neighbour may lie in a leaf too: this leaf is judged again.
        again = marks[leaves]
        chosen = np.concatenate([new, leaves[again]])
        first_new = boxes.count
        boxes.judge(chosen, nodes.records, nodes.cycles, tolerance)
        leaves = np.concatenate([leaves[~again], chosen[boxes.tree.child[chosen] < 0]])
        new = np.arange(first_new, boxes.count)
        if progress is not None and new.size:
            done = max(done, boxes.share(leaves))
            progress(done)
    return Leaves(boxes.tree, leaves, nodes.places, nodes.records, nodes.cycles, tolerance)


class _Nodes:
    """The evaluated nodes of a chart.

    Attributes
    ----------
    places : (k,) flat indices of the evaluated nodes, increasing
    records : the evaluated nodes
    cycles : (N,) cycles in a unit of time
    """

    def __init__(self, shape: tuple[int, int], cycles: FloatArray, ask: Ask) -> None:
        self._shape = shape
        self._ask = ask
        self.cycles = np.ascontiguousarray(cycles, dtype=float)
        self.places = np.empty(0, dtype=np.int64)
        none = np.empty(0)
        self.records = self._sorted(NodeValues(none, np.empty(0, dtype=np.int8), none), none)

    def evaluate(self, places: IntArray) -> IntArray:
        """Evaluate the nodes that are not evaluated yet; returns their flat indices."""
        new = np.setdiff1d(places, self.places)
        if not new.size:
            return new
        values = self._ask(new)
        old = self.records
        growth = self.cycles[new // self._shape[1]] * np.log(np.maximum(values.radius, _LEAST_RADIUS))
        places = np.concatenate([self.places, new])
        order = np.argsort(places, kind="stable")
        self.places = places[order]
        joined = NodeValues(
            np.concatenate([old.radius, values.radius])[order],
            np.concatenate([old.verdict, values.verdict.astype(np.int8)])[order],
            np.concatenate([old.gap, values.gap])[order],
        )
        self.records = self._sorted(joined, np.concatenate([old.growth, growth])[order])
        return new

    def _sorted(self, values: NodeValues, growth: FloatArray) -> EvaluatedNodes:
        """Return the records of values in the order of ``places``."""
        n, m = self._shape
        columns = self.places % m
        row_starts = np.searchsorted(self.places, np.arange(n + 1, dtype=np.int64) * m).astype(np.int64)
        return EvaluatedNodes(columns, row_starts, values.radius, growth, values.gap, values.verdict)


class _Boxes:
    """The tree of all boxes of a chart.

    Attributes
    ----------
    tree : arrays, of which the first ``count`` entries are boxes
    count : number of boxes
    """

    def __init__(self, shape: tuple[int, int]) -> None:
        n, m = shape
        starts = np.arange(0, n - 1, FIRST_WIDTH, dtype=np.int64)
        self.count = self._roots = starts.size
        self._shape = shape
        ends = np.minimum(starts + FIRST_WIDTH, n - 1)
        zeros = np.zeros_like(starts)
        self.tree = BoxTree(starts, ends, zeros, zeros + m - 1, zeros - 1, zeros, np.zeros(starts.size))

    def nine_nodes(self, boxes: IntArray) -> IntArray:
        """Flat indices of corners, middles of edges and centre of boxes; some of them several times."""
        first, last, low, high = (v[boxes] for v in self.tree[:4])
        rows = np.stack([first, (first + last) // 2, last])
        columns = np.stack([low, (low + high) // 2, high])
        return np.asarray((rows[:, None] * self._shape[1] + columns[None]).ravel())

    def marked(self, places: IntArray) -> BoolArray:
        """Whether a box that is not cut contains one of the nodes with these flat indices, for each box."""
        marks = np.zeros(self.count, dtype=bool)
        rows, columns = np.divmod(places, self._shape[1])
        mark_boxes(self.tree, self._roots, rows, columns, marks)
        return marks

    def judge(self, chosen: IntArray, nodes: EvaluatedNodes, cycles: FloatArray, tolerance: float) -> None:
        """Judge boxes and add the parts of those that are cut."""
        least_size = self.count + 4 * chosen.size
        if least_size > self.tree.first.size:
            size = 2 * least_size
            self.tree = BoxTree(*(np.concatenate([v, np.zeros(size - v.size, v.dtype)]) for v in self.tree))
        self.count = judge_boxes(self.tree, self.count, chosen, nodes, cycles, tolerance)

    def share(self, boxes: IntArray) -> float:
        """Share of these boxes in the area of the chart."""
        n, m = self._shape
        first, last, low, high = (v[boxes] for v in self.tree[:4])
        return float(((last - first) * (high - low)).sum() / ((n - 1) * (m - 1)))
