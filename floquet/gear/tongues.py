"""Boundaries of the tongues of instability of a gear pair over speed, and their labels.

Sources: docs/theory/floquet.md, "Where instability is, and what it is called".
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from floquet.engine.tongues import (
    Tongue,
    UnstableInterval,
    combinations,
    seeded_nodes,
    tongue_coordinates,
    unstable_intervals,
)
from floquet.gear.axes import GEAR_AXES, GearVariation, checked_range, gear_grid, vary
from floquet.gear.chart import solved
from floquet.gear.multipliers import gear_block
from floquet.gear.regions import label_variation
from floquet.rank_one.system import RankOneSystem
from lumped.arguments import real_number, whole_number
from lumped.errors import refuse
from lumped.labelling import labelled_dataset
from lumped.model.periodic_system import Supports
from lumped.schema.files import AnyPair
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray, Progress

if TYPE_CHECKING:
    import xarray as xr

_MOST = 20_000  # speeds of the grid of a search


def predicted_lines(pair: AnyPair | GearVariation, orders: int = 12) -> dict[Tongue, float]:
    """Pinion speeds [rpm] at which the mesh frequency is (omega_i +- omega_j)/k.

    omega are the natural frequencies of the time-averaged undamped feedback block, k = 1..orders.

    Parameters
    ----------
    pair : the gear pair
    orders : largest k
    """
    variation = GearVariation.of(pair)
    orders = whole_number("orders", orders, 1, 1000)
    omega = gear_block(variation).modal().omega
    per_rpm = variation.pair.pinion.teeth * 2.0 * np.pi / 60.0  # mesh frequency [rad/s] per rpm
    return {
        Tongue(i + 1, j + 1, sign, k): float(total / k / per_rpm)
        for i, j, sign, total in combinations(omega)
        for k in range(1, orders + 1)
    }


def stability_boundaries(
    pair: AnyPair,
    speed_rpm: tuple[float, float] = (500.0, 20000.0),
    axes: dict[str, npt.ArrayLike] | None = None,
    *,
    nodes: int = 400,
    orders: int = 12,
    xtol: float = 1e-8,
    rtol: float = 1e-9,
    supports: Supports = "springs",
    progress: Progress | None = None,
) -> xr.Dataset:
    """Boundaries, spectral radius = 1, of the tongues of instability over speed.

    Along speed the search starts from a grid that meets every tongue of a damped pair, whatever its
    order (`search_grid`), and from a graded cluster at every predicted line (omega_i +- omega_j)/k, for pairs
    with hardly any damping; ends are found by bisection.

    Parameters
    ----------
    pair : the gear pair
    speed_rpm : range searched [rpm]
    axes : one more axis {name: values} out of `GEAR_AXES` other than speed, with the meaning that it has in
        `stability_chart`; default the pair as it is
    nodes : evenly spaced speeds of the search besides
    orders : largest k of the clusters
    xtol : relative accuracy of the boundaries
    rtol : of the monodromy matrices
    supports : "springs", the pair's ``bearings``, or its "shafts"; labels then number the modes that count
    progress : told the finished fraction

    Returns
    -------
    Dataset over ``tongue`` (coordinates label, mode_i, mode_j, sign, order) and the axis: ``present``;
    ``lower`` and ``upper`` [rpm], the boundaries; ``peak`` [rpm] and ``peak_radius``; ``open_end``, whether
    the tongue runs out of the range. Where ``present`` is False the numbers are NaN. Where one label has
    several intervals at one value, lower and upper enclose them all, ``intervals`` counts them, and
    ``interval_lower`` and ``interval_upper`` over ``interval`` have them one by one. ``complete`` over the
    axis: whether the grid is as fine as the damping asks for; where it is not, thin tongues of orders above
    ``orders`` may be missing.

    Raises
    ------
    ParameterError : unusable range or axis
    """
    own = GearVariation.of(pair, supports)
    low, high = checked_range("speed_rpm", speed_rpm)
    nodes = whole_number("nodes", nodes, 0, 1_000_000)
    xtol, rtol = real_number("xtol", xtol, 1e-15, 0.1), real_number("rtol", rtol, 1e-13, 1e-3)
    checked = gear_grid(axes, supports) if axes is not None else {}
    if axes is not None and (len(checked) != 1 or "speed_rpm" in checked):
        raise refuse("axes", ", ".join(checked), "one other than speed_rpm", "Scan other axes one at a time.")
    name, values = next(iter(checked.items())) if axes else ("value", np.array([np.nan]))
    intervals: dict[Tongue, dict[int, list[UnstableInterval]]] = {}
    complete = np.ones(values.size, dtype=bool)
    for index, value in enumerate(values):
        here = vary(own, {name: float(value)} if axes else {})
        lines = np.array(list(predicted_lines(here, orders).values()))
        dense, complete[index] = search_grid(gear_block(here), low, high)

        def radius(speeds: FloatArray, here: GearVariation = here) -> FloatArray:
            return solved(here, {"speed_rpm": speeds}, rtol).radius

        start = np.union1d(dense, seeded_nodes(lines, low, high, nodes))
        for interval in unstable_intervals(radius, start, xtol=xtol):
            label = label_variation(vary(here, {"speed_rpm": interval.peak}))
            intervals.setdefault(label, {}).setdefault(index, []).append(interval)
        if progress is not None:
            progress((index + 1) / values.size)
    result = _boundaries_dataset(own.pair, intervals, name, values, complete).assign_attrs(supports=supports)
    return result if axes else result.isel({name: 0}, drop=True)


def search_grid(block: RankOneSystem, low: float, high: float) -> tuple[FloatArray, bool]:
    """Speeds so dense that every tongue of instability of any order raises the radius at one of them.

    Near k Omega = omega_i + omega_j two modes that decay with a and are coupled with strength g have, at the
    detuning d = (k Omega - omega_i - omega_j)/2, the exponents -a +- sqrt(g^2 - d^2) (Hsu 1963; differences
    likewise), unstable somewhere only if g > a. Then the larger one stands out of all other modes, of least
    decay b <= a, over |d| < b at least: steps of b/omega_max put two speeds into this window.

    Returns the speeds, and whether the steps are that small, which would at times take more than 20000.
    """
    needed = -float(block.mean_exponents().real.max()) / float(block.modal().omega.max())
    span = math.log(high / low)
    complete = needed * _MOST > span
    return np.geomspace(low, high, math.ceil(span / needed) + 1 if complete else _MOST), complete


def _boundaries_dataset(
    pair: GearPair,
    result: dict[Tongue, dict[int, list[UnstableInterval]]],
    name: str,
    values: FloatArray,
    complete: npt.NDArray[np.bool_],
) -> xr.Dataset:
    tongues = sorted(result)
    shape = (len(tongues), values.size)
    most = max((len(parts) for columns in result.values() for parts in columns.values()), default=0)
    ends, numbers = np.full((2, *shape, most), np.nan), np.full((4, *shape), np.nan)
    open_end, count = np.zeros(shape, dtype=bool), np.zeros(shape, dtype=np.int64)
    for row, tongue in enumerate(tongues):
        for column, parts in result[tongue].items():
            lower, upper = np.array([(part.lower, part.upper) for part in parts]).T
            top = max(parts, key=lambda part: part.peak_radius)
            ends[:, row, column, : len(parts)] = lower, upper
            numbers[:, row, column] = lower.min(), upper.max(), top.peak, top.peak_radius
            open_end[row, column] = any(part.open_below or part.open_above for part in parts)
            count[row, column] = len(parts)
    dims, each, axis = ("tongue", name), ("tongue", name, "interval"), GEAR_AXES.get(name)
    return labelled_dataset(
        {
            "lower": (dims, numbers[0], "rpm", "lower boundary of the tongue"),
            "upper": (dims, numbers[1], "rpm", "upper boundary of the tongue"),
            "peak": (dims, numbers[2], "rpm", "speed of the largest spectral radius in the tongue"),
            "peak_radius": (dims, numbers[3], "1", "largest spectral radius in the tongue"),
            "present": (dims, count > 0, "1", "tongue exists at this value"),
            "open_end": (dims, open_end, "1", "tongue runs out of the range searched"),
            "intervals": (dims, count, "1", "number of intervals of this label"),
            "interval_lower": (each, ends[0], "rpm", "lower ends of the intervals"),
            "interval_upper": (each, ends[1], "rpm", "upper ends of the intervals"),
            "complete": (name, complete, "1", "grid as fine as the damping asks for"),
        },
        {name: (values, axis.units, axis.long_name) if axis else (values, "1", "value")},
        {"title": f"stability boundaries of {pair.name}", "friction_law": pair.friction.law},
    ).assign_coords(tongue_coordinates("tongue", tongues))
