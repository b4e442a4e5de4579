"""Stability charts: the multipliers of a family of periodic systems over a grid of parameters."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import numpy.typing as npt

from floquet.engine.monodromy import checked_effort
from floquet.engine.multipliers import VERDICTS, radii_with_bounds, verdicts
from floquet.engine.node_boxes import FlatChart, Plane
from floquet.engine.node_workers import GridNodes, results_of
from floquet.engine.nodes import BatchedFamily, Family, refuse_other_sizes
from floquet.engine.refinement import NodeValues, gaps, search_leaves
from lumped.arguments import of_type, one_of, real_numbers, some_of, whole_number
from lumped.display.progress import reported_to, shows_progress
from lumped.errors import refuse, shown
from lumped.labelling import Variable, labelled_dataset
from lumped.typing import BoolArray, ComplexArray, FloatArray, IntArray, Progress, ProgressRequest

if TYPE_CHECKING:
    import xarray as xr

Axes = Mapping[str, npt.ArrayLike]


@dataclass(frozen=True)
class ChartAxis:
    """One parameter of a chart.

    Attributes
    ----------
    units, long_name : labels of the axis
    low, high : allowed range, without its lower end where ``open_low``
    """

    units: str
    long_name: str
    low: float = field(default=-np.inf, kw_only=True)
    high: float = field(default=np.inf, kw_only=True)
    open_low: bool = field(default=False, kw_only=True)

    def check(self, name: str, values: FloatArray) -> None:
        """Raise ParameterError when a value is outside the range of the axis."""
        below = values <= self.low if self.open_low else values < self.low
        bad = values[below | (values > self.high)]
        if bad.size:
            sign = ">" if self.open_low else ">="
            allowed = f"{sign} {self.low:g}" + ("" if np.isinf(self.high) else f" and <= {self.high:g}")
            value = f"{bad[0]:g} {self.units}".removesuffix(" 1")
            raise refuse(f"axes[{name!r}]", value, allowed, "Correct the axis values.")


def checked_axes(axes: Axes) -> dict[str, FloatArray]:
    """Return the axes as 1-D float arrays; refuse what is empty, not finite, not 1-D or repeats values."""
    if not isinstance(axes, Mapping) or not axes:
        raise refuse("axes", shown(axes), "at least one name -> values", "Give the parameters to vary.")
    result = {}
    for name, values in axes.items():
        array = real_numbers(f"axes[{name!r}]", values)
        if np.unique(array).size != array.size:
            raise refuse(f"axes[{name!r}]", shown(values), "values that differ", "Remove the repetitions.")
        result[str(name)] = array
    return result


@dataclass(frozen=True, eq=False)
class NodeResults:
    """Results at some points of a chart.

    Attributes
    ----------
    points : (k,) places of the points in the chart
    radius, error, verdict, proven : (k,) as in `ChartPoints`
    gaps : (k,) see `gaps`; empty where nobody asks for them
    multipliers, multiplier_errors : (k, size) the largest modulus first; (k, 0) where nobody asks for them
    """

    points: IntArray
    radius: FloatArray
    error: FloatArray
    verdict: npt.NDArray[np.int8]
    proven: BoolArray
    gaps: FloatArray
    multipliers: ComplexArray
    multiplier_errors: FloatArray


@dataclass(frozen=True)
class Wanted:
    """Which results of a point are wanted besides radius, error and verdict.

    Attributes
    ----------
    multipliers : the multipliers and bounds on their errors
    gaps : see `gaps`
    """

    multipliers: bool
    gaps: bool


def node_results(
    points: IntArray,
    values: ComplexArray,
    errors: FloatArray,
    proven: bool | BoolArray,
    wanted: Wanted,
    coupled: int | None = None,
    neutral: bool | BoolArray = False,
) -> NodeResults:
    """Return the results of points (k,) from multipliers (k, size) and bounds on their errors.

    The ``coupled`` multipliers come first. ``neutral`` (k,): all multipliers are proven to be simple and on
    the unit circle.
    """
    radius, error = radii_with_bounds(values, errors)
    columns = (
        np.argsort(-np.abs(values), axis=1, kind="stable")
        if wanted.multipliers
        else np.empty((points.size, 0), dtype=np.intp)
    )
    return NodeResults(
        points,
        radius,
        error,
        verdicts(radius, error, neutral),
        np.broadcast_to(np.asarray(proven, dtype=bool), points.shape),
        gaps(values[:, :coupled]) if wanted.gaps else np.empty(0),
        np.take_along_axis(values, columns, 1),
        np.take_along_axis(errors, columns, 1),
    )


class ChartPoints:
    """Results at the points of a chart, in C order of its grid.

    Attributes
    ----------
    radius, error : (count,) spectral radius and the bound on its error, or an estimate of the error
    verdict : (count,) 1 stable, 0 undecided, -1 unstable, 2 neutral
    proven : (count,) whether the error is a proven bound
    known : (count,) whether the point was evaluated; the others are interpolated
    gaps : of the points that are evaluated at present; None where every point of the chart is evaluated
    multipliers, multiplier_errors : (count, size) the largest modulus first; None without ``everything``
    cells : verdicts (N-1, M-1) of the cells between nodes; None: not asked for
    """

    def __init__(self, count: int, *, everything: bool = False) -> None:
        self.everything = everything
        self.radius = np.empty(count)
        self.error = np.empty(count)
        self.verdict = np.zeros(count, dtype=np.int8)
        self.proven = np.zeros(count, dtype=bool)
        self.known = np.zeros(count, dtype=bool)
        self.gaps: GapsOfBatch | None = None
        self.cells: IntArray | None = None
        self.multipliers: ComplexArray | None = None
        self.multiplier_errors: FloatArray | None = None

    def put(
        self,
        points: IntArray,
        values: ComplexArray,
        errors: FloatArray,
        proven: bool | BoolArray,
        coupled: int | None = None,
        neutral: bool | BoolArray = False,
    ) -> None:
        """Store multipliers (k, size) of points (k,) and bounds on their errors, the ``coupled`` first.

        ``neutral`` (k,): all multipliers are proven to be on the unit circle, and motions bounded.
        """
        self.store(node_results(points, values, errors, proven, self.wanted, coupled, neutral))

    @property
    def wanted(self) -> Wanted:
        """Results of a point that are wanted at present."""
        return Wanted(self.everything, self.gaps is not None)

    def store(self, results: NodeResults) -> None:
        """Store the results of some points."""
        points = results.points
        self.radius[points] = results.radius
        self.error[points] = results.error
        self.verdict[points] = results.verdict
        self.proven[points] = results.proven
        self.known[points] = True
        if self.gaps is not None:
            self.gaps.put(points, results.gaps)
        if not self.everything:
            return
        if self.multipliers is None or self.multiplier_errors is None:
            shape = self.radius.size, results.multipliers.shape[1]
            self.multipliers = np.empty(shape, dtype=complex)
            self.multiplier_errors = np.empty(shape)
        self.multipliers[points] = results.multipliers
        self.multiplier_errors[points] = results.multiplier_errors

    def store_part(self, places: IntArray, part: ChartPoints) -> None:
        """Store all points of a part of this chart, interpolated points too. ``places``: of the points."""
        for name in ("radius", "error", "verdict", "proven", "known"):
            getattr(self, name)[places] = getattr(part, name)


class GapsOfBatch:
    """The `gaps` of the points that one call evaluates: a chart needs the gaps of no other points.

    Attributes
    ----------
    values : (k,) gaps, in the order of the points
    """

    def __init__(self, points: IntArray) -> None:
        self.values = np.zeros(points.size)
        self._order = np.argsort(points)
        self._sorted = points[self._order]

    def put(self, points: IntArray, values: FloatArray) -> None:
        """Store the gaps of some of the points."""
        self.values[self._order[np.searchsorted(self._sorted, points)]] = values


#: Charts of no more nodes are evaluated at each of them: it takes no longer.
SMALL = 4096
#: Evaluates points by their place in the chart and puts them into its `ChartPoints`.
Evaluate = Callable[[IntArray], None]


def refine_planes(
    grid: Mapping[str, FloatArray],
    plane: tuple[str, str],
    points: ChartPoints,
    evaluate: Evaluate,
    *,
    cycles: FloatArray | None = None,
    lowest_alone: bool = False,
    progress: Progress | None = None,
) -> None:
    """Evaluate a chart near its edges of instability and interpolate the rest, see `refine`.

    Parameters
    ----------
    plane : the two axes over which the chart refines itself, at each value of the other axes
    cycles : cycles in a unit of time at the values of the first axis of the plane
    lowest_alone : True: the row at the lowest value of the second axis seeds the search, where regions are
        widest at this value; False: three rows seed the search
    """
    names = list(grid)
    shape = [values.size for values in grid.values()]
    strides = dict(zip(names, np.append(np.cumprod(shape[:0:-1])[::-1], 1).tolist(), strict=True))
    first, second = (np.argsort(grid[name]) for name in plane)
    others = [np.arange(grid[name].size) * strides[name] for name in names if name not in plane]
    starts = np.sum(np.meshgrid(*others, indexing="ij"), axis=0).ravel() if others else np.zeros(1, int)
    rows = (0,) if lowest_alone else (0, second.size // 2, -1)
    smooth = np.ones(first.size) if cycles is None else cycles[first]
    for k, start in enumerate(starts):
        places = Plane(start + first * strides[plane[0]], second * strides[plane[1]])

        def ask(nodes: IntArray, places: Plane = places) -> NodeValues:
            i, j = np.divmod(nodes, places.columns.size)
            chosen = places.rows[i] + places.columns[j]
            batch = points.gaps = GapsOfBatch(chosen)
            evaluate(chosen)
            return NodeValues(points.radius[chosen], points.verdict[chosen], batch.values)

        def tell(fraction: float, stage: str = "", /, k: int = k) -> None:
            if progress is not None:
                progress((k + fraction) / starts.size)

        leaves = search_leaves((first.size, second.size), smooth, ask, rows=rows, progress=tell)
        leaves.fill(places, FlatChart(points.radius, points.error, points.verdict))
        tell(1.0)
    points.gaps = None


@shows_progress("chart")
def scan(
    evaluate: Family | BatchedFamily,
    axes: Axes,
    *,
    batched: bool = False,
    labels: Mapping[str, tuple[str, str]] | None = None,
    refine: bool = False,
    store: Literal["all", "radius"] = "all",
    rtol: float = 1e-8,
    workers: int = 1,
    progress: ProgressRequest = None,
) -> xr.Dataset:
    """Evaluate the multipliers of a family of periodic systems on the product grid of the axes.

    Parameters
    ----------
    evaluate : parameters -> `PeriodicSystem`, or its `Spectrum` where that is known otherwise; every point
        must give the same number of multipliers
    axes : name -> values
    batched : True: ``evaluate`` gets arrays (N,) of each parameter and returns `PeriodicSystems`. This takes
        0.013 to 0.08 ms a node of 2 to 6 states; errors are estimates
    labels : name -> unit, "1" for none, and plain name of an axis
    refine : whether the chart is evaluated near its edges of instability alone and interpolated elsewhere,
        over its first two axes of more than one value; it then has no multipliers
    store : "all"; "radius" leaves the multipliers out, which take 24 bytes a state and node
    rtol : of the monodromy matrix of a `PeriodicSystem`
    workers : processes that evaluate nodes; the chart is the same to the last bit. With more than one, other
        processes must be able to import ``evaluate``: a function at the head of a module
    progress : True (a bar), False (none), None (a bar where the call takes over two seconds), or a function
        that is called with the finished fraction

    Returns
    -------
    xarray.Dataset over the axes, see `chart_dataset`

    Raises
    ------
    ParameterError : unusable axes, or a function that no other process can import with several workers
    NumericalError
        A point fails; the message names it.
    """
    progress = reported_to(progress)
    grid = checked_axes(axes)
    labels = dict(labels or {})
    some_of("labels", labels, grid)
    one_of("store", store, ("all", "radius"))
    whole_number("workers", workers, 1, 1024, "Use as many as there are cores.")
    of_type("batched", batched, bool, "True or False")
    of_type("refine", refine, bool, "True or False")
    rtol = checked_effort(rtol, 2)[0]
    shape = tuple(values.size for values in grid.values())
    plane = [name for name, values in grid.items() if values.size > 1][:2]
    if refine and len(plane) < 2:
        raise refuse("refine", refine, "two axes of more than one value", "Leave it out.")
    points = ChartPoints(math.prod(shape), everything=store == "all" and not refine)
    nodes = GridNodes(evaluate, grid, batched, rtol)
    first_size = 0
    with results_of(nodes, workers) as results:

        def at(places: IntArray) -> None:
            nonlocal first_size
            groups = nodes.groups(places)
            done = 0
            for group, spectra in zip(groups, results(groups), strict=True):
                for result in spectra:
                    size = result.multipliers.shape[1]
                    first_size = first_size or size
                    if size != first_size:
                        refuse_other_sizes(first_size, size, nodes.points(group[result.points[:1]])[0])
                    points.put(
                        group[result.points],
                        result.multipliers,
                        result.errors,
                        result.proven,
                        neutral=result.neutral,
                    )
                done += group.size
                if progress is not None and not refine:
                    progress(done / points.radius.size)

        if refine:
            refine_planes(grid, (plane[0], plane[1]), points, at, progress=progress)
        else:
            at(np.arange(points.radius.size))
    chart = chart_dataset(grid, points)
    for name, (unit, text) in labels.items():
        chart[name].attrs.update(units=unit, long_name=text)
    return chart


def chart_dataset(grid: Mapping[str, FloatArray], points: ChartPoints) -> xr.Dataset:
    """Label results as a chart: radius, error, verdict, proven, known, and where asked for multipliers.

    Where ``known`` is False a node is interpolated: its error is the largest misfit known near it, its
    verdict that of the evaluated nodes around it. The attribute ``certificate`` is "proven", "estimate" or
    "mixed".
    """
    shape = tuple(values.size for values in grid.values())
    dims = tuple(grid)
    each: dict[str, tuple[npt.NDArray[Any], str]] = {
        "spectral_radius": (points.radius, "spectral radius, largest modulus of the multipliers"),
        "error": (
            points.error,
            "error of the spectral radius: a bound where evaluated, an estimate elsewhere",
        ),
        "verdict": (
            points.verdict,
            "stability verdict, undecided where the bound contains 1, neutral: proven on it",
        ),
        "proven": (points.proven, "whether the error is a proven bound, else an estimate"),
        "known": (points.known, "whether the node was evaluated, else interpolated"),
    }
    variables: dict[str, Variable] = {
        name: (dims, values.reshape(shape), "1", text) for name, (values, text) in each.items()
    }
    if points.multipliers is not None and points.multiplier_errors is not None:
        full = (*dims, "multiplier")
        shape_of_multipliers = (*shape, -1)
        text = "Floquet multipliers, largest modulus first"
        variables["multipliers"] = (full, points.multipliers.reshape(shape_of_multipliers), "1", text)
        text = "bound on the error of each multiplier"
        variables["multiplier_errors"] = (
            full,
            points.multiplier_errors.reshape(shape_of_multipliers),
            "1",
            text,
        )
    dataset = labelled_dataset(variables, {name: (values, "", name) for name, values in grid.items()})
    dataset["verdict"].attrs.update(flag_values=[*VERDICTS], flag_meanings=" ".join(VERDICTS.values()))
    proven = points.proven
    dataset.attrs["certificate"] = "proven" if proven.all() else "mixed" if proven.any() else "estimate"
    return dataset
