"""Stability charts of gear pairs: one fit of the gains serves all points over speed, damping and friction.

The unstable regions of a chart have names, widths and edges. Sources: docs/theory/floquet.md, "Computing M",
"Where instability is, and what it is called".
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy import ndimage

from floquet.engine.chart import SMALL, Axes, ChartPoints, chart_dataset, refine_planes
from floquet.engine.tongues import Tongue, label_tongue
from floquet.gear.axes import (
    GEAR_AXES,
    FrictionFamily,
    GearVariation,
    chart_axes,
    friction_families,
    gear_grid,
    operating_rpm,
    vary,
)
from floquet.gear.multipliers import (
    Feedback,
    OffLineOfAction,
    feedback_system,
    fitted_block,
    gear_block,
    stays_bounded,
    stays_symmetric,
)
from floquet.rank_one.batch import fast_monodromies, fast_multipliers
from floquet.rank_one.boxes import proven_cells
from floquet.rank_one.system import RankOneSystem
from lumped.arguments import of_type, one_of, real_number
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
_FEWEST_PARTS = (800, 200)  # of each of these axes; a part is proven as a whole
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
    result = solved(variation, grid, rtol, plane, everything=store == "all", prove=prove, progress=progress)
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


def _finer(values: FloatArray, least: int) -> tuple[FloatArray, int]:
    """Cut each interval of increasing values into equal parts, so that there are at least ``least`` parts.

    Returns the finer values, and the number of parts of each interval.
    """
    parts = max(1, -(-least // (values.size - 1)))
    share = np.arange(parts) / parts
    finer = values[:-1, None] * (1.0 - share) + values[1:, None] * share
    return np.append(finer.ravel(), values[-1]), parts


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
    progress: Progress | None = None,
) -> ChartPoints:
    """Multipliers of a variation of a pair at all points of a grid, or their spectral radii alone.

    With a ``plane`` of two axes only nodes near the edges of instability in this plane are evaluated.
    """
    count = math.prod(values.size for values in grid.values())
    points = ChartPoints(count, everything=everything)
    evaluate = _Points(variation, grid, rtol, points)
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
    for k, row in enumerate(index):
        for i in range(0, row.size, _CHUNK):
            evaluate(row[i : i + _CHUNK])
            if progress is not None:
                progress((k * row.size + min(i + _CHUNK, row.size)) / count)
    return points


class _Points:
    """Evaluates points of a chart. Points with the same values of all slow axes share one `ChartSlice`.

    Attributes
    ----------
    each : number of points that share the values of the slow axes
    """

    def __init__(
        self, variation: GearVariation, grid: Mapping[str, FloatArray], rtol: float, points: ChartPoints
    ) -> None:
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

    def __call__(self, places: IntArray) -> None:
        """Put the multipliers at some places of the chart into its points."""
        indices = dict(zip(self.grid, np.unravel_index(places, self.shape), strict=True))
        key = np.zeros(places.size, dtype=np.intp)
        for name in self.slow:
            key = key * self.grid[name].size + indices[name]
        for slice_number in np.unique(key):
            of_slice = np.flatnonzero(key == slice_number)
            if slice_number not in self._slices:
                point = {name: float(self.grid[name][indices[name][of_slice[0]]]) for name in self.slow}
                self._slices[slice_number] = ChartSlice(self.variation, self.grid, self.inner, point)
            slice_indices = {name: indices[name][of_slice] for name in self.inner}
            for part in np.split(np.arange(of_slice.size), range(_CHUNK, of_slice.size, _CHUNK)):
                chosen = {name: values[part] for name, values in slice_indices.items()}
                self._slices[slice_number].solve(places[of_slice[part]], chosen, self.points, self.rtol)

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


class _FamilyBlock(NamedTuple):
    """Common data of all speeds of one friction family.

    Attributes
    ----------
    system : the feedback block
    separate : motions that the mesh does not couple
    levels : number of the parts of the gains that have a factor of friction
    period_times_rpm : mesh period [s] times pinion speed [rpm]
    feedback : the coordinates of the system
    """

    system: RankOneSystem
    separate: OffLineOfAction
    levels: int
    period_times_rpm: float
    feedback: Feedback


class ChartSlice:
    """Points of a chart that differ in speed, mesh damping and mean friction only.

    Damping only scales wd. The mean friction coefficient only scales the part of w by friction. Speed only
    changes the period; with many friction laws speed scales friction too. Therefore one fit of the feedback
    block serves all points of the slice.

    Parameters
    ----------
    variation : of the chart
    grid : name -> values of its axes
    inner : names of the axes along which points of the slice differ
    point : values of the other axes
    """

    def __init__(
        self,
        variation: GearVariation,
        grid: Mapping[str, FloatArray],
        inner: list[str],
        point: Mapping[str, float],
    ) -> None:
        largest_friction = (
            float(grid["friction_coefficient"].max()) if "friction_coefficient" in inner else 1.0
        )
        # Damping and friction of the reference, to which the factors of the slice relate.
        references = {"damping_ratio": 1.0, "friction_coefficient": largest_friction}
        self.reference = vary(variation, {**point, **{n: references[n] for n in inner if n in references}})
        operating_speed = np.array([operating_rpm(self.reference.pair)])
        self.speeds = grid["speed_rpm"] if "speed_rpm" in inner else operating_speed
        self.damping = grid["damping_ratio"] if "damping_ratio" in inner else np.ones(1)
        self.friction = (
            grid["friction_coefficient"] / largest_friction if "friction_coefficient" in inner else np.ones(1)
        )
        self._blocks: dict[int, _FamilyBlock] = {}

    @cached_property
    def families(self) -> list[FrictionFamily]:
        """Families of speeds. Friction needs only one fit for a family."""
        return friction_families(self.reference, self.speeds)

    @cached_property
    def _rows(self) -> tuple[IntArray, IntArray]:
        """Number of the family of each speed, and the row of the speed in this family."""
        family = np.empty(self.speeds.size, dtype=np.intp)
        row = np.empty(self.speeds.size, dtype=np.intp)
        for k, one in enumerate(self.families):
            family[one.members] = k
            row[one.members] = np.arange(one.members.size)
        return family, row

    def _block(self, k: int, rtol: float) -> _FamilyBlock:
        """Fit the feedback block of family k once."""
        if k not in self._blocks:
            family = self.families[k]
            variation = GEAR_AXES["speed_rpm"].apply(self.reference, family.speed_rpm)
            feedback = feedback_system(variation)
            levels = [] if variation.pair.friction.law == "none" else [0.0]
            levels += [] if family.level is None else [family.level]
            block = fitted_block(feedback, variation.stiffness_variation, max(0.01 * rtol, 1e-12), levels)
            period_times_rpm = block.period * operating_rpm(variation.pair)
            self._blocks[k] = _FamilyBlock(
                block, OffLineOfAction.of(feedback), len(levels), period_times_rpm, feedback
            )
        return self._blocks[k]

    def cells(self, rtol: float, progress: Progress | None) -> IntArray:
        """Verdicts (N-1, M-1) of the cells between neighbouring speeds and damping ratios, `proven_cells`."""
        order = np.argsort(self.speeds)
        speeds = self.speeds[order]
        damping = np.sort(self.damping)
        verdict = np.zeros((speeds.size - 1, damping.size - 1), dtype=np.intp)
        family_of_speed = self._rows[0][order]
        for i, j in self._smooth_runs(speeds, family_of_speed):
            family = self.families[family_of_speed[i]]
            block = self._block(int(family_of_speed[i]), rtol)
            # Motions that the mesh does not couple must die out, too: else only instability can be proven.
            exponents = block.separate.exponents
            separate_fade = bool((exponents.real + block.separate.errors < 0.0).all())
            fewest_speeds, fewest_ratios = _FEWEST_PARTS if separate_fade else (1, 1)
            rpm, speed_parts = _finer(speeds[i:j], fewest_speeds)
            ratios, damping_parts = _finer(damping, fewest_ratios)

            def factors(
                T: FloatArray, block: _FamilyBlock = block, family: FrictionFamily = family
            ) -> FloatArray | None:
                result = family.factors_at(block.period_times_rpm / T)
                return None if result is None else result[:, : block.levels]

            periods = block.period_times_rpm / rpm[::-1]
            result = proven_cells(block.system, periods, ratios, factors, progress)[::-1]
            parts = result.reshape(j - i - 1, speed_parts, damping.size - 1, damping_parts)
            lowest = parts.min(axis=(1, 3))
            highest = parts.max(axis=(1, 3))
            decided = lowest if separate_fade else np.minimum(lowest, 0)
            verdict[i : j - 1] = np.where(lowest == highest, decided, 0)
        return verdict

    def _smooth_runs(self, speeds: FloatArray, family_of_speed: IntArray) -> Iterator[tuple[int, int]]:
        """First index and end of runs of two or more neighbouring speeds in which factors are smooth."""
        for i, j in _runs(family_of_speed):
            family = self.families[family_of_speed[i]]
            for first, end in _runs(family.smooth_groups(speeds[i:j])):
                if end - first > 1:
                    yield i + first, i + end

    def solve(
        self, places: IntArray, indices: Mapping[str, IntArray], points: ChartPoints, rtol: float
    ) -> None:
        """Put the multipliers at places (k,) into ``points``.

        ``indices`` maps each inner axis to the indices (k,) of its values.
        """
        zeros = np.zeros(places.size, dtype=np.intp)
        speed = indices.get("speed_rpm", zeros)
        damping = self.damping[indices.get("damping_ratio", zeros)]
        friction = self.friction[indices.get("friction_coefficient", zeros)]
        family_of_speed, row_in_family = self._rows
        for number in np.unique(family_of_speed[speed]):
            members = np.flatnonzero(family_of_speed[speed] == number)
            family = self.families[number]
            block = self._block(int(number), rtol)
            T = block.period_times_rpm / self.speeds[speed[members]]
            factors = friction[members, None] * family.factors[row_in_family[speed[members]]]
            result = fast_multipliers(
                block.system, T, damping[members], factors[:, : block.levels], tolerance=2e-4 * rtol
            )
            separate, separate_errors = block.separate.multipliers(T)
            values = np.concatenate([result.multipliers, separate], axis=1)
            errors = np.concatenate([result.errors, separate_errors], axis=1)
            undamped = damping[members] * self.reference.pair.mesh.damping_ratio == 0.0
            rubs = factors[:, : block.levels].any(axis=1)
            symplectic = undamped & stays_symmetric(block.feedback, self.reference.supports, rubs)
            neutral = stays_bounded(result.multipliers, result.errors, symplectic, block.separate)
            points.put(places[members], values, errors, True, result.multipliers.shape[1], neutral)


def _runs(numbers: IntArray) -> Iterator[tuple[int, int]]:
    """First index and end of runs of equal numbers."""
    return pairwise([0, *(1 + np.flatnonzero(np.diff(numbers))).tolist(), numbers.size])


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
