"""Stability charts of gear pairs: one fit of the gains serves all points over speed, damping and friction.

The unstable regions of a chart have names, widths and edges. Sources: docs/theory/floquet.md, "Computing M",
"Where instability is, and what it is called".
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np
import numpy.typing as npt
from scipy import ndimage

from floquet.engine.chart import (
    SMALL,
    Axes,
    ChartPoints,
    chart_dataset,
    refine_planes,
)
from floquet.engine.tongues import Tongue, label_tongue
from floquet.gear.axes import (
    GEAR_AXES,
    GearVariation,
    chart_axes,
    gear_grid,
    operating_rpm,
    vary,
)
from floquet.gear.multipliers import (
    gear_block,
)
from floquet.gear.slices import ChartSlice, SlicePart, solve_slice
from floquet.rank_one.batch import fast_monodromies
from lumped.arguments import of_type, one_of, real_number
from lumped.calls import checked_executor, results_of
from lumped.display.progress import reported_to, shows_progress
from lumped.errors import LawRangeWarning, refuse
from lumped.labelling import Variable, labelled_dataset, provenance
from lumped.model.periodic_system import Supports
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.typing import FloatArray, IntArray, Progress, ProgressRequest

if TYPE_CHECKING:
    import xarray as xr

_INNER = ("speed_rpm", "damping_ratio", "friction_coefficient")
_CELLS = ("speed_rpm", "damping_ratio")  # axes of a chart whose cells can be proven
_CHUNK = 32_768  # points in memory with their matrices
_LARGEST = 25_000_000
_COUNTED = 1_000_000  # nodes that are counted at once
_NAMED = 200  # largest number of regions that are named


@shows_progress("stability chart")
def stability_chart(
    pair: AnyPair | GearVariation,
    axes: Axes | None = None,
    *,
    friction_law: str | None = None,
    refine: bool = True,
    prove: bool = False,
    rtol: float = 1e-10,
    store: Literal["all", "radius"] = "radius",
    supports: Supports | None = None,
    executor: Executor | None = None,
    progress: ProgressRequest = None,
) -> xr.Dataset:
    """Stability chart of a gear pair, of its linear form with like teeth.

    The motion of ``spurcheck.predict``, whose contact follows the momentary load, has another stability.

    Over two axes the chart refines itself: nodes near edges of instability are evaluated, all other nodes are
    interpolated. Both sides of every edge are evaluated. Only an unstable region that lies between evaluated
    nodes and does not reach the lowest damping can be missed. Over axes without damping, curves on which two
    multipliers meet are evaluated too, because thin tongues lie on these curves.

    Parameters
    ----------
    pair : the gear pair, or a variation of it
    axes : name -> values, names out of `GEAR_AXES`: speed_rpm, damping_ratio (mesh), friction_coefficient,
        torque, stiffness_variation, bearing_stiffness, in their stated units; at most 25 million points;
        default 801 speeds about the operating speed and 201 mesh damping ratios
    friction_law : law to use instead of the pair's: "coulomb" for a constant |mu| that changes sign at the
        pitch point, the others for mu that varies along the path. With an axis friction_coefficient the law
        is scaled to that mean of |mu|.
    refine : False evaluates every node
    prove : whether stability between the nodes is decided too, over speed and mesh damping: every cell
        between four nodes is proven stable, proven unstable, or stays unproven, and the corners of the
        latter are evaluated. No region is missed then outside of unproven cells.
    rtol : wanted accuracy of the monodromy matrices, relative to their scale; 1e-13 to 1e-3
    store : "radius"; or "all" for the multipliers too, which every node must be evaluated for: 258 bytes a
        point instead of 19
    supports : "springs", the pair's ``bearings``, or its "shafts" with the modes that count most; by default
        the shafts of a pair that has them
    executor : what computes the points: a cluster of ``spurcheck.open_cluster``, or any executor of
        ``concurrent.futures``. The result is the same. Worth it over axes besides speed, mesh damping and
        friction: each of their values needs its own fit. None: this process
    progress : True (a bar), False (none), None (a bar where the call takes over two seconds), or a function
        that is called with the finished fraction

    Returns
    -------
    xarray.Dataset over the axes: spectral_radius, error, verdict, proven, known and, with store "all",
    multipliers and multiplier_errors (10 each: the feedback block and the off-line-of-action block, on shafts
    two for each mode; the rigid rotation is no part of them). Where ``known`` is False a node is
    interpolated; its error is an estimate, and ``proven`` is False too: the attribute ``certificate`` is then
    "mixed", else "proven". Over ``region`` the unstable regions, the largest first:
    ``region_label``, ``region_width`` in speed (or the first axis), ``region_nodes``, ``region_radius`` and
    ``region_<axis>``, the evaluated node where it is largest. Attributes ``thinnest_width`` of all regions
    and ``nearest_edge_<axis>``, where along an axis the stability changes next to the pair itself; NaN:
    nowhere.
    With ``prove`` also ``cell_verdict`` (1 stable, -1 unstable everywhere in a cell, 0 unproven) over the
    middles of the cells, ``speed_rpm_cell`` and ``damping_ratio_cell``, increasing, and the attribute
    ``proven_share`` of the area.

    Raises
    ------
    ParameterError : unknown axis, values outside the range of an axis, or too many points
    NumericalError
        A point fails; the message names it.
    """
    progress = reported_to(progress)
    variation = GearVariation.of(pair, supports)
    grid = gear_grid(chart_axes(variation.pair) if axes is None else axes, variation.supports)
    points = math.prod(values.size for values in grid.values())
    if points > _LARGEST:
        raise refuse("points of the chart", points, f"at most {_LARGEST}", "Give the axes smaller counts.")
    one_of("store", store, ("all", "radius"))
    checked_executor(executor)
    of_type("refine", refine, bool, "True or False")
    if of_type("prove", prove, bool, "True or False"):
        _check_cells(grid)
    rtol = real_number("rtol", rtol, 1e-13, 1e-3, action="Use 1e-8 for charts, 1e-10 for verdicts.")
    if friction_law is not None:
        variation = replace(variation, pair=variation.pair.with_({"friction.law": friction_law}))
    plane = _plane(grid) if refine else None
    if plane is not None and store == "all":
        action = "Give refine=False, which evaluates every node."
        raise refuse("store", store, '"radius" for a chart that refines itself', action)
    result = solved(
        variation,
        grid,
        rtol,
        plane,
        everything=store == "all",
        prove=prove,
        executor=executor,
        progress=progress,
    )
    cells = None if result.cells is None else _verdicts_of_cells(grid, result.cells)
    dataset = chart_dataset(grid, result)
    if cells is not None:
        dataset = dataset.merge(cells, combine_attrs="override").assign_attrs(cells.attrs)
    for name in grid:
        dataset[name].attrs.update(units=GEAR_AXES[name].units, long_name=GEAR_AXES[name].long_name)
    title = f"stability chart of {variation.pair.name}"
    law = variation.pair.friction.law
    dataset = dataset.assign_attrs(
        **provenance(variation.pair), title=title, friction_law=law, supports=variation.supports, rtol=rtol
    )
    rpm = operating_rpm(variation.pair)
    teeth = variation.pair.pinion.teeth
    dataset = dataset.assign_attrs(operating_speed_rpm=rpm, mesh_cycles_per_revolution=teeth)
    return with_regions(variation, dataset)


def _check_cells(grid: Mapping[str, FloatArray]) -> None:
    """Refuse a chart for which no proof between the nodes is possible."""
    if set(grid) != set(_CELLS) or min(values.size for values in grid.values()) < 2:
        action = "Give two or more values of both, or leave prove out."
        raise refuse("prove", "True", "over the axes speed_rpm and damping_ratio, no others", action)


def _verdicts_of_cells(grid: Mapping[str, FloatArray], cells: IntArray) -> xr.Dataset:
    """The verdicts of cells (speed, damping) and the share of the area that is proven."""
    axes = [np.sort(grid[name]) for name in _CELLS]
    area = np.outer(*map(np.diff, axes))
    names = tuple(f"{name}_cell" for name in _CELLS)
    text = "verdict everywhere in the cell: 1 stable, -1 unstable, 0 not proven"
    middles = {}
    for name, v in zip(names, axes, strict=True):
        axis = GEAR_AXES[name.removesuffix("_cell")]
        middles[name] = 0.5 * (v[1:] + v[:-1]), axis.units, f"{axis.long_name}, middle"
    share = float(area[cells != 0].sum() / area.sum())
    verdicts = {"cell_verdict": (names, cells.astype(np.int8), "1", text)}
    return labelled_dataset(verdicts, middles, {"proven_share": share})


def _plane(grid: Mapping[str, FloatArray]) -> tuple[str, str] | None:
    """The two axes over which a chart refines itself; None: there are few nodes.

    Speed, damping and friction come first, then the axes with most nodes.
    """
    axes = sorted((n for n in grid if grid[n].size > 1), key=lambda n: -grid[n].size)
    axes.sort(key=lambda n: _INNER.index(n) if n in _INNER else len(_INNER))
    if len(axes) < 2 or grid[axes[0]].size * grid[axes[1]].size <= SMALL:
        return None
    first, second = axes[:2]
    return (second, first) if first == "damping_ratio" else (first, second)


def solved(
    variation: GearVariation,
    grid: Mapping[str, FloatArray],
    rtol: float,
    plane: tuple[str, str] | None = None,
    *,
    everything: bool = False,
    prove: bool = False,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> ChartPoints:
    """Multipliers of a variation of a pair at all points of a grid, or their spectral radii alone.

    With a ``plane`` of two axes only nodes near the edges of instability in this plane are evaluated.
    """
    count = math.prod(values.size for values in grid.values())
    points = ChartPoints(count, everything=everything)
    if executor is not None and plane is not None and _apart(grid, plane):
        _solve_parts(variation, grid, rtol, plane, points, executor, progress)
        return points
    evaluate = _Points(variation, grid, rtol, points, executor)
    if prove:
        points.cells = evaluate.cells(progress)
    if plane is not None:
        cycles = grid[plane[0]] if plane[0] == "speed_rpm" else None
        lowest = plane[1] == "damping_ratio"
        refine_planes(
            grid, plane, points, evaluate, cycles=cycles, lowest_alone=lowest, progress=progress
        )  # fmt: skip
        if points.cells is not None:
            evaluate(evaluate.unproven(points.cells))
        return points
    # Slow axes outermost, then speed: few fits of the gains for each call.
    names = list(grid)
    shape = [values.size for values in grid.values()]
    order = sorted(range(len(names)), key=lambda i: (names[i] in _INNER, names[i] != "speed_rpm"))
    index = np.arange(count).reshape(shape).transpose(order).reshape(-1, evaluate.each)
    if executor is not None:
        evaluate(index.ravel(), progress)
        return points
    for k, row in enumerate(index):
        for i in range(0, row.size, _CHUNK):
            evaluate(row[i : i + _CHUNK])
            if progress is not None:
                progress((k * row.size + min(i + _CHUNK, row.size)) / count)
    return points


def _apart(grid: Mapping[str, FloatArray], plane: tuple[str, str]) -> list[str]:
    """Axes at each value of which a chart over a plane is computed for itself.

    A friction axis scales friction by its largest value, so its values stay together.
    """
    return [name for name in grid if name not in (*plane, *_INNER) and grid[name].size > 1]


def _solve_parts(
    variation: GearVariation,
    grid: Mapping[str, FloatArray],
    rtol: float,
    plane: tuple[str, str],
    points: ChartPoints,
    executor: Executor,
    progress: Progress | None,
) -> None:
    """Compute and store the parts of a chart, one for each combination of values of the axes ``_apart``."""
    names = list(grid)
    apart = _apart(grid, plane)
    places = np.arange(points.radius.size).reshape([values.size for values in grid.values()])
    places = np.moveaxis(places, [names.index(name) for name in apart], range(len(apart)))
    combinations = list(np.ndindex(places.shape[: len(apart)]))
    parts = (
        dict(grid) | {name: grid[name][[i]] for name, i in zip(apart, combination, strict=True)}
        for combination in combinations
    )
    results = results_of(solved, ((variation, part, rtol, plane) for part in parts), executor)
    for number, (combination, result) in enumerate(zip(combinations, results, strict=True)):
        points.store_part(places[combination].ravel(), result)
        if progress is not None:
            progress((number + 1) / len(combinations))


class _Points:
    """Evaluates points of a chart. Points with the same values of all slow axes share one `ChartSlice`.

    Attributes
    ----------
    each : number of points that share the values of the slow axes
    """

    def __init__(
        self,
        variation: GearVariation,
        grid: Mapping[str, FloatArray],
        rtol: float,
        points: ChartPoints,
        executor: Executor | None = None,
    ) -> None:
        self.executor = executor
        self.variation = variation
        self.grid = grid
        self.rtol = rtol
        self.points = points
        self.shape = [values.size for values in grid.values()]
        # A friction axis that is zero throughout has no reference to scale.
        self.inner = [n for n in grid if n in _INNER and (n != "friction_coefficient" or grid[n].max() > 0.0)]
        self.slow = [n for n in grid if n not in self.inner]
        self.each = math.prod(grid[n].size for n in self.inner)
        self._slices: dict[int, ChartSlice] = {}

    def __call__(self, places: IntArray, progress: Progress | None = None) -> None:
        """Put the multipliers at some places of the chart into its points."""
        wanted = self.points.wanted
        if self.executor is None:
            for part in self._parts(places):
                if part.slice_number not in self._slices:
                    self._slices[part.slice_number] = ChartSlice(
                        self.variation, self.grid, self.inner, part.point
                    )
                for result in self._slices[part.slice_number].solve(
                    part.places, part.indices, wanted, self.rtol
                ):
                    self.points.store(result)
            return
        calls = (
            (self.variation, self.grid, self.inner, part.point, part.places, part.indices, wanted, self.rtol)
            for part in self._parts(places)
        )
        done = 0
        for results in results_of(solve_slice, calls, self.executor):
            for result in results:
                self.points.store(result)
                done += result.points.size
            if progress is not None:
                progress(done / places.size)

    def _parts(self, places: IntArray) -> Iterator[SlicePart]:
        """Yield parts of the places. The points of a part are of one slice."""
        indices = dict(zip(self.grid, np.unravel_index(places, self.shape), strict=True))
        key = np.zeros(places.size, dtype=np.intp)
        for name in self.slow:
            key = key * self.grid[name].size + indices[name]
        for slice_number in np.unique(key):
            of_slice = np.flatnonzero(key == slice_number)
            point = {name: float(self.grid[name][indices[name][of_slice[0]]]) for name in self.slow}
            for part in np.split(of_slice, range(_CHUNK, of_slice.size, _CHUNK)):
                part_indices = {name: indices[name][part] for name in self.inner}
                yield SlicePart(int(slice_number), point, places[part], part_indices)

    def cells(self, progress: Progress | None) -> IntArray:
        """Verdicts of the cells of a chart over speed and damping, both increasing."""
        self._slices[0] = ChartSlice(self.variation, self.grid, self.inner, {})
        return self._slices[0].cells(self.rtol, progress)

    def unproven(self, cells: IntArray) -> IntArray:
        """Nodes without evaluation at cells whose verdict is not proven."""
        speed, damping = (np.argsort(self.grid[name]) for name in _CELLS)
        places = np.arange(self.points.known.size).reshape(self.shape)
        if self.inner[0] != _CELLS[0]:
            places = places.T
        places = places[np.ix_(speed, damping)]
        verdict = self.points.verdict[places]
        undecided = np.zeros(places.shape, dtype=bool)
        for corner in ((a, b) for a in (slice(1, None), slice(-1)) for b in (slice(1, None), slice(-1))):
            undecided[corner] |= (cells == 0) | (cells != verdict[corner])
        return np.asarray(places[undecided & ~self.points.known[places]])


def label_variation(variation: GearVariation) -> Tongue:
    """Label the fastest growing motion of a pair by its mode shape, see `label_tongue`."""
    block = gear_block(variation)
    matrix = fast_monodromies(block).matrices[0]
    return label_tongue(matrix, block.modal().omega, 2.0 * np.pi / block.period)


@dataclass(frozen=True)
class LabelledRegion:
    """One connected unstable region of a chart.

    Attributes
    ----------
    label : tongue at the evaluated node of its largest spectral radius
    point : axis name -> value of that node
    radius : the spectral radius there
    nodes : number of unstable nodes of the region
    width : largest width along the speed, or else the first axis, in its unit
    """

    label: Tongue
    point: dict[str, float]
    radius: float
    nodes: int
    width: float


def label_regions(pair: AnyPair | GearVariation, chart: xr.Dataset) -> list[LabelledRegion]:
    """Name every connected unstable region of a chart by the mode shape at its most unstable node.

    Parameters
    ----------
    pair : the pair of the chart, with the friction law of the chart; the chart names its supports
    chart : dataset of `stability_chart` over any axes

    Returns
    -------
    regions, the largest first; of more than 200 the largest 200
    """
    source = pair if isinstance(pair, GearVariation) else load_gear_pair(pair)
    variation = GearVariation.of(source, chart.attrs.get("supports"))
    radius = chart["spectral_radius"]
    names = list(map(str, radius.dims))
    along = names.index("speed_rpm") if "speed_rpm" in names else 0
    axis = chart[names[along]].to_numpy()
    cells = np.abs(np.gradient(axis)) if axis.size > 1 else np.zeros(1)
    numbered, count = ndimage.label(chart["verdict"].to_numpy() == -1, structure=np.ones((3,) * radius.ndim))
    nodes = _counts(numbered, count)
    boxes = ndimage.find_objects(numbered)
    regions = []
    for index in np.argsort(-nodes, kind="stable")[:_NAMED]:
        box = boxes[index]
        inside = numbered[box] == index + 1
        values = np.where(inside & chart["known"].to_numpy()[box], radius.to_numpy()[box], -np.inf)
        place = np.unravel_index(int(np.argmax(values)), inside.shape)
        point = {
            n: float(chart[n].to_numpy()[part.start + i])
            for n, part, i in zip(names, box, place, strict=True)
        }
        width = float((np.moveaxis(inside, along, -1) @ cells[box[along]]).max())
        top = float(values[place])
        with warnings.catch_warnings():  # the chart has told where its law leaves its range
            warnings.simplefilter("ignore", LawRangeWarning)
            label = label_variation(vary(variation, point))
        regions.append(LabelledRegion(label, point, top, int(nodes[index]), width))
    return regions


def _counts(numbered: npt.NDArray[np.integer], count: int) -> IntArray:
    """Number of nodes of each of so many regions; a copy of all numbers as 8 bytes each would be large."""
    result = np.zeros(count + 1, dtype=np.int64)
    flat = numbered.ravel()
    for start in range(0, flat.size, _COUNTED):
        result += np.bincount(flat[start : start + _COUNTED], minlength=count + 1)
    return result[1:]


def with_regions(variation: GearVariation, chart: xr.Dataset) -> xr.Dataset:
    """Add the unstable regions of a chart over ``region``, and the edges of instability next to the pair.

    The attribute ``nearest_edge_<axis>`` is the value of an axis at which stability changes, the one nearest
    to the value of the pair. The other axes are at the nodes nearest to the pair. NaN: there is no such edge.
    """
    regions = label_regions(variation, chart)
    names = list(map(str, chart["spectral_radius"].dims))
    along = "speed_rpm" if "speed_rpm" in names else names[0]
    each: dict[str, Variable] = {
        "region_radius": ("region", np.array([r.radius for r in regions]), "1", "largest multiplier"),
        "region_nodes": ("region", np.array([r.nodes for r in regions], dtype=int), "1", "unstable nodes"),
    }
    widths = np.array([r.width for r in regions])
    each["region_width"] = "region", widths, GEAR_AXES[along].units, f"largest width in {along}"
    for name in names:
        values = np.array([r.point[name] for r in regions])
        each[f"region_{name}"] = "region", values, GEAR_AXES[name].units, GEAR_AXES[name].long_name
    result = labelled_dataset(each, {})
    labels = np.array([str(r.label) for r in regions], dtype=object)
    result = result.assign_coords(region_label=("region", labels))
    attrs = {"thinnest_width": float(widths.min(initial=np.inf)) if regions else np.nan}
    attrs |= {f"nearest_edge_{name}": _edge(variation, chart, name) for name in names}
    return chart.merge(result, combine_attrs="override").assign_attrs(attrs)


def _edge(variation: GearVariation, chart: xr.Dataset, name: str) -> float:
    """Value of an axis where stability changes, nearest to the value of the pair, see `with_regions`."""
    operating_values = {n: GEAR_AXES[n].own(variation.pair) for n in map(str, chart["verdict"].dims)}
    others = {n: value for n, value in operating_values.items() if n != name}
    if any(not chart[n].min() <= value <= chart[n].max() for n, value in others.items()):
        return float("nan")
    nearest = {n: int(np.abs(chart[n].to_numpy() - value).argmin()) for n, value in others.items()}
    line = chart["verdict"].isel(nearest).sortby(name)
    values = line[name].to_numpy()
    unstable = line.to_numpy() < 0
    edges = 0.5 * (values[1:] + values[:-1])[unstable[1:] != unstable[:-1]]
    return float(edges[np.argmin(np.abs(edges - operating_values[name]))]) if edges.size else float("nan")
