"""Boxes of nodes of a chart over two axes, compiled: judge boxes, cut boxes, and fill boxes.

Evaluated nodes are in lists sorted by their place. The nodes of a box are read from these lists, so the work
and the memory of a search grow with the number of evaluated nodes. Only `fill_leaves` visits every node.

Sources: docs/theory/floquet.md, "Charts that refine themselves".
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from lumped.compiler import called, compiled, inlined
from lumped.typing import BoolArray, FloatArray, IntArray

#: Nodes along the first axis of the boxes of the first round; these boxes have all nodes of the second axis.
FIRST_WIDTH = 64
#: Misfits along both axes within this factor cut a box along both.
_ALIKE = 2.0
#: Largest over least excess of the radius above 1 in an unstable box that is a leaf. Near an edge of
#: instability the excess falls to 0, perhaps between nodes.
_EXCESS = 8.0
#: Largest change of the gaps in a box that is a leaf, over the least of these gaps.
_PER_DECAY = 1.5
#: Cuts of boxes at most on the way from the first round to one cell: each halves a side.
_DEPTH = 64


class EvaluatedNodes(NamedTuple):
    """The k evaluated nodes of a chart of N x M nodes, sorted by place.

    Attributes
    ----------
    columns : (k,) index j along the second axis of node (i, j), increasing in each row i
    row_starts : (N+1,) index of the first evaluated node of each row i; the last is k
    radius : (k,) spectral radius
    growth : (k,) cycles in a unit of time times the logarithm of the radius
    gap : (k,) distance of multipliers from a tongue
    verdict : (k,) 1 stable, 0 undecided, -1 unstable, 2 neutral
    """

    columns: IntArray
    row_starts: IntArray
    radius: FloatArray
    growth: FloatArray
    gap: FloatArray
    verdict: npt.NDArray[np.int8]


class BoxTree(NamedTuple):
    """Boxes of nodes. A box that is cut has two or four children, which stand one after the other.

    Attributes
    ----------
    first, last : (boxes,) indices of the first and the last node along the first axis
    low, high : (boxes,) the same along the second axis
    child : (boxes,) index of the first child; -1: the box is not cut
    children : (boxes,) number of children
    misfit : (boxes,) largest misfit of the radius at evaluated nodes of a box that is a leaf
    """

    first: IntArray
    last: IntArray
    low: IntArray
    high: IntArray
    child: IntArray
    children: IntArray
    misfit: FloatArray


class Box(NamedTuple):
    """Indices of the first and the last node along both axes."""

    first: int
    last: int
    low: int
    high: int


class CornerGrowth(NamedTuple):
    """Growth rates at the corners of a box, by the ends of the first axis, then of the second axis."""

    first_low: float
    last_low: float
    first_high: float
    last_high: float


class Judgement(NamedTuple):
    """Whether a box is cut along its axes; neither: the box is a leaf.

    Attributes
    ----------
    along, up : cut along the first axis, along the second axis
    misfit : largest misfit of the radius at evaluated nodes
    """

    along: bool
    up: bool
    misfit: float


class Change(NamedTuple):
    """Largest change of a quantity along the first axis and along the second axis."""

    across: float
    upward: float


class Plane(NamedTuple):
    """Place of node (i, j) in flat arrays of a chart: ``rows[i] + columns[j]``."""

    rows: IntArray
    columns: IntArray


class FlatChart(NamedTuple):
    """Flat arrays of a chart: spectral radius, its error, verdict."""

    radius: FloatArray
    error: FloatArray
    verdict: npt.NDArray[np.int8]


@inlined
def _next_in_row(nodes: EvaluatedNodes, i: int, j: int) -> int:
    """Index of the first evaluated node of row i at column j or beyond, by bisection."""
    start = nodes.row_starts[i]
    end = nodes.row_starts[i + 1]
    while start < end:
        middle = (start + end) // 2
        if nodes.columns[middle] < j:
            start = middle + 1
        else:
            end = middle
    return int(start)


@inlined
def _growth(nodes: EvaluatedNodes, i: int, j: int) -> float:
    return float(nodes.growth[_next_in_row(nodes, i, j)])


@inlined
def _gap(nodes: EvaluatedNodes, i: int, j: int) -> float:
    return float(nodes.gap[_next_in_row(nodes, i, j)])


@inlined
def _at(tree: BoxTree, k: int) -> Box:
    """Box k of the tree."""
    return Box(tree.first[k], tree.last[k], tree.low[k], tree.high[k])


@called
def _corner_growth(box: Box, nodes: EvaluatedNodes) -> CornerGrowth:
    return CornerGrowth(
        _growth(nodes, box.first, box.low),
        _growth(nodes, box.last, box.low),
        _growth(nodes, box.first, box.high),
        _growth(nodes, box.last, box.high),
    )


@inlined
def _interpolated(start: float, end: float, share: float) -> float:
    return start * (1.0 - share) + end * share


@inlined
def _share(i: int, start: int, end: int) -> float:
    """Position of index i between two indices, 0 to 1."""
    return (i - start) / max(end - start, 1)


@called
def _gap_change(box: Box, nodes: EvaluatedNodes) -> Change:
    """Largest change of the gap between neighbours of the nine nodes of a box."""
    i_middle = (box.first + box.last) // 2
    j_middle = (box.low + box.high) // 2
    across = 0.0
    upward = 0.0
    for j in (box.low, j_middle, box.high):
        middle = _gap(nodes, i_middle, j)
        across = max(across, abs(middle - _gap(nodes, box.first, j)))
        across = max(across, abs(_gap(nodes, box.last, j) - middle))
    for i in (box.first, i_middle, box.last):
        middle = _gap(nodes, i, j_middle)
        upward = max(upward, abs(middle - _gap(nodes, i, box.low)))
        upward = max(upward, abs(_gap(nodes, i, box.high) - middle))
    return Change(across, upward)


@inlined
def _differs_on_row(box: Box, nodes: EvaluatedNodes, i: int) -> bool:
    """Whether verdicts differ on the edge of a box along the second axis, at index i of the first axis."""
    start = _next_in_row(nodes, i, box.low)
    index = start
    while index < nodes.row_starts[i + 1] and nodes.columns[index] <= box.high:
        if nodes.verdict[index] != nodes.verdict[start]:
            return True
        index += 1
    return False


@inlined
def _differs_on_column(box: Box, nodes: EvaluatedNodes, j: int) -> bool:
    """Whether verdicts differ on the edge of a box along the first axis, at index j of the second axis."""
    verdict = nodes.verdict[_next_in_row(nodes, box.first, j)]
    for i in range(box.first + 1, box.last + 1):
        index = _next_in_row(nodes, i, j)
        if index < nodes.row_starts[i + 1] and nodes.columns[index] == j and nodes.verdict[index] != verdict:
            return True
    return False


@inlined
def _divided(box: Box, along: bool, up: bool, misfit: float) -> Judgement:
    """Cut a box along the axes asked for, or else along the only axis with more than one cell."""
    divisible_along = box.last - box.first > 1
    divisible_up = box.high - box.low > 1
    return Judgement(
        divisible_along and (along or not divisible_up), divisible_up and (up or not divisible_along), misfit
    )


@inlined
def _divided_by_change(box: Box, change: Change, misfit: float) -> Judgement:
    """Cut a box along the axis of the larger change; along both where the changes are alike."""
    along = change.across * _ALIKE >= change.upward
    up = change.upward * _ALIKE >= change.across
    return _divided(box, along, up, misfit)


@called
def _divided_by_verdicts(box: Box, nodes: EvaluatedNodes) -> Judgement:
    """Cut a box across its edges on which verdicts differ; along both axes where there is no such edge."""
    along = _differs_on_column(box, nodes, box.low) or _differs_on_column(box, nodes, box.high)
    up = _differs_on_row(box, nodes, box.first) or _differs_on_row(box, nodes, box.last)
    if not (along or up):
        along = True
        up = True
    return _divided(box, along, up, 0.0)


@called
def _judged(box: Box, nodes: EvaluatedNodes, cycles: FloatArray, tolerance: float) -> Judgement:
    """Judge a box by all evaluated nodes in it: see docs/theory/floquet.md, steps 3 and 4."""
    if box.last - box.first <= 1 and box.high - box.low <= 1:
        return Judgement(False, False, 0.0)
    corners = _corner_growth(box, nodes)
    verdict = nodes.verdict[_next_in_row(nodes, box.first, box.low)]
    misfit = 0.0
    across = 0.0
    upward = 0.0
    least_radius = math.inf
    largest_radius = -math.inf
    least_gap = math.inf
    largest_gap = -math.inf
    is_bilinear = True
    for i in range(box.first, box.last + 1):
        s = _share(i, box.first, box.last)
        low = _interpolated(corners.first_low, corners.last_low, s)
        high = _interpolated(corners.first_high, corners.last_high, s)
        index = _next_in_row(nodes, i, box.low)
        while index < nodes.row_starts[i + 1] and nodes.columns[index] <= box.high:
            if nodes.verdict[index] != verdict:
                return _divided_by_verdicts(box, nodes)
            j = nodes.columns[index]
            radius = nodes.radius[index]
            growth = _interpolated(low, high, _share(j, box.low, box.high))
            error = abs(math.exp(growth / cycles[i]) - radius)
            allowed = tolerance * max(radius, 1.0)
            if abs(verdict) == 1:
                allowed = min(allowed, 0.5 * abs(radius - 1.0))
            is_bilinear = is_bilinear and error <= allowed
            misfit = max(misfit, error)
            if j in (box.low, box.high):
                across = max(across, error)
            if i in (box.first, box.last):
                upward = max(upward, error)
            least_radius = min(least_radius, radius)
            largest_radius = max(largest_radius, radius)
            least_gap = min(least_gap, nodes.gap[index])
            largest_gap = max(largest_gap, nodes.gap[index])
            index += 1
    change = Change(across, upward)
    if not is_bilinear:
        return _divided_by_change(box, change, misfit)
    if verdict >= 0 and largest_gap - least_gap > _PER_DECAY * least_gap:
        return _divided_by_change(box, _gap_change(box, nodes), misfit)
    if verdict < 0 and largest_radius - 1.0 > _EXCESS * (least_radius - 1.0):
        return _divided_by_change(box, change, misfit)
    return Judgement(False, False, misfit)


@inlined
def _add(tree: BoxTree, k: int, box: Box) -> int:
    """Put a box into the tree at index k; returns the next index."""
    tree.first[k] = box.first
    tree.last[k] = box.last
    tree.low[k] = box.low
    tree.high[k] = box.high
    tree.child[k] = -1
    tree.children[k] = 0
    return k + 1


@called
def _cut(tree: BoxTree, k: int, judgement: Judgement, count: int) -> int:
    """Add halves or quarters of box k behind ``count`` boxes; returns the new number of boxes."""
    box = _at(tree, k)
    i = (box.first + box.last) // 2 if judgement.along else box.last
    j = (box.low + box.high) // 2 if judgement.up else box.high
    tree.child[k] = count
    size = count
    size = _add(tree, size, Box(box.first, i, box.low, j))
    if judgement.up:
        size = _add(tree, size, Box(box.first, i, j, box.high))
    if judgement.along:
        size = _add(tree, size, Box(i, box.last, box.low, j))
    if judgement.along and judgement.up:
        size = _add(tree, size, Box(i, box.last, j, box.high))
    tree.children[k] = size - count
    return size


@compiled(nogil=True)
def judge_boxes(
    tree: BoxTree, count: int, chosen: IntArray, nodes: EvaluatedNodes, cycles: FloatArray, tolerance: float
) -> int:
    """Judge the chosen boxes of a tree of ``count`` boxes, and cut those that are no leaves.

    The corners, the middles of edges and the centre of each box are evaluated. ``cycles`` (N,) belong to the
    rows. The arrays of the tree have room for four children of each chosen box. Returns the new number of
    boxes; all new boxes stand behind the old boxes.
    """
    size = count
    for k in chosen:
        judgement = _judged(_at(tree, k), nodes, cycles, tolerance)
        tree.misfit[k] = judgement.misfit
        if judgement.along or judgement.up:
            size = _cut(tree, k, judgement, size)
    return size


@inlined
def _contains(tree: BoxTree, k: int, i: int, j: int) -> bool:
    box = _at(tree, k)
    return bool(box.first <= i <= box.last and box.low <= j <= box.high)


@called
def _mark_below(tree: BoxTree, root: int, i: int, j: int, marks: BoolArray, waiting: IntArray) -> None:
    """Mark all boxes without children under a box of the first round that contain node (i, j)."""
    waiting[0] = root
    size = 1
    while size > 0:
        size -= 1
        k = waiting[size]
        if tree.child[k] < 0:
            marks[k] = True
            continue
        for child in range(tree.child[k], tree.child[k] + tree.children[k]):
            if _contains(tree, child, i, j):
                waiting[size] = child
                size += 1


@compiled(nogil=True)
def mark_boxes(tree: BoxTree, roots: int, rows: IntArray, columns: IntArray, marks: BoolArray) -> None:
    """Mark all boxes without children that contain one of the nodes (rows, columns); edges are in the box.

    The tree begins with ``roots`` boxes of the first round, `FIRST_WIDTH` apart along the first axis.
    """
    waiting = np.empty(4 * _DEPTH, dtype=np.int64)
    for k in range(rows.size):
        root = min(rows[k] // FIRST_WIDTH, roots - 1)
        for neighbour in range(max(root - 1, 0), root + 1):
            if _contains(tree, neighbour, rows[k], columns[k]):
                _mark_below(tree, neighbour, rows[k], columns[k], marks, waiting)


@called
def _fill_part(
    part: Box,
    error: float,
    verdict: int,
    nodes: EvaluatedNodes,
    cycles: FloatArray,
    plane: Plane,
    chart: FlatChart,
) -> None:
    """Interpolate the nodes of a part that are not evaluated."""
    corners = _corner_growth(part, nodes)
    for i in range(part.first, part.last + 1):
        s = _share(i, part.first, part.last)
        low = _interpolated(corners.first_low, corners.last_low, s) / cycles[i]
        high = _interpolated(corners.first_high, corners.last_high, s) / cycles[i]
        slope = (high - low) / max(part.high - part.low, 1)
        index = _next_in_row(nodes, i, part.low)
        end = nodes.row_starts[i + 1]
        for j in range(part.low, part.high + 1):
            if index < end and nodes.columns[index] == j:
                index += 1
                continue
            place = plane.rows[i] + plane.columns[j]
            chart.radius[place] = math.exp(low + slope * (j - part.low))
            chart.error[place] = error
            chart.verdict[place] = verdict


@compiled(nogil=True)
def fill_leaves(
    tree: BoxTree,
    leaves: IntArray,
    nodes: EvaluatedNodes,
    cycles: FloatArray,
    tolerance: float,
    plane: Plane,
    chart: FlatChart,
) -> None:
    """Interpolate all nodes that are not evaluated, in the four quarters of each leaf.

    The error is the largest misfit of the leaf, at least the tolerance. The verdict is that of the leaf. A
    node on the common edge of several leaves gets the radius and the error of the last of these leaves.
    """
    for k in leaves:
        box = _at(tree, k)
        i = (box.first + box.last) // 2
        j = (box.low + box.high) // 2
        error = max(tolerance, tree.misfit[k])
        verdict = nodes.verdict[_next_in_row(nodes, box.first, box.low)]
        for first, last in ((box.first, i), (i, box.last)):
            for low, high in ((box.low, j), (j, box.high)):
                if first < last and low < high:  # a side of one cell has no middle
                    _fill_part(Box(first, last, low, high), error, verdict, nodes, cycles, plane, chart)
