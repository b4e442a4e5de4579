"""Stability charts of gear pairs: one fit of the gains serves all points over speed, damping and friction.

Sources: docs/theory/floquet.md, "Computing M".
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING, Literal

import numpy as np
import numpy.typing as npt

from floquet.engine.chart import Axes, chart_dataset
from floquet.engine.multipliers import radii_with_bounds
from floquet.gear.axes import GEAR_AXES, GearVariation, friction_families, gear_grid, operating_rpm, vary
from floquet.gear.block import feedback_system, fitted_block
from floquet.gear.multipliers import OffLineOfAction
from floquet.rank_one.batch import fast_multipliers
from lumped.arguments import one_of, real_number
from lumped.errors import refuse
from lumped.model.periodic_system import Supports
from lumped.schema.files import AnyPair
from lumped.typing import ComplexArray, FloatArray, Progress

if TYPE_CHECKING:
    import xarray as xr

_INNER = ("speed_rpm", "damping_ratio", "friction_coefficient")
# The chart is cut along speed, which bounds its memory and lets it tell its progress: points of a slice.
_SLICE = 1 << 18
_CHUNK = 32_768  # points in memory with their matrices
_LARGEST = 25_000_000


def stability_chart(
    pair: AnyPair,
    axes: Axes,
    *,
    friction_law: str | None = None,
    rtol: float = 1e-10,
    store: Literal["all", "radius"] = "all",
    supports: Supports = "springs",
    progress: Progress | None = None,
) -> xr.Dataset:
    """Stability chart of a gear pair.

    Parameters
    ----------
    pair : the gear pair
    axes : name -> values, names out of `GEAR_AXES`: speed_rpm, damping_ratio (mesh), friction_coefficient,
        torque, stiffness_variation, bearing_stiffness, in their stated units; at most 25 million points
    friction_law : law to use instead of the pair's: "coulomb" for a constant |mu| that changes sign at the
        pitch point, the others for mu that varies along the path. With an axis friction_coefficient the law
        is scaled to that mean of |mu|.
    rtol : wanted accuracy of the monodromy matrices, relative to their scale; 1e-13 to 1e-3
    store : "all"; or "radius" for the spectral radius, its error and the verdict without the multipliers: 18
        bytes a point instead of 258
    supports : "springs", the pair's ``bearings``, or its "shafts" with the modes that count most
    progress : told the finished fraction

    Returns
    -------
    xarray.Dataset over the axes: spectral_radius, error, verdict, proven and, with store "all", multipliers
    and multiplier_errors (10 each: the feedback block and the off-line-of-action block, on shafts two for
    each mode; the rigid rotation is no part of them). Its attribute ``certificate`` is "proven", "estimate"
    or "mixed", which the variable ``proven`` tells for every point: estimates are the errors over speeds that
    share a friction law to a tolerance.

    Raises
    ------
    ParameterError : unknown axis, values outside the range of an axis, or too many points
    NumericalError
        A point fails; the message names it.
    """
    variation, grid = GearVariation.of(pair, supports), gear_grid(axes, supports)
    points = math.prod(values.size for values in grid.values())
    if points > _LARGEST:
        raise refuse("points of the chart", points, f"at most {_LARGEST}", "Give the axes smaller counts.")
    one_of("store", store, ("all", "radius"))
    rtol = real_number("rtol", rtol, 1e-13, 1e-3, action="Use 1e-8 for charts, 1e-10 for verdicts.")
    if friction_law is not None:
        variation = replace(variation, pair=variation.pair.with_({"friction.law": friction_law}))
    found = solved(variation, grid, rtol, everything=store == "all", progress=progress)
    dataset = chart_dataset(
        grid, found.multipliers, found.errors, found.radius, found.radius_error, found.proven
    )
    for name in grid:
        dataset[name].attrs.update(units=GEAR_AXES[name].units, long_name=GEAR_AXES[name].long_name)
    title, law = f"stability chart of {variation.pair.name}", variation.pair.friction.law
    return dataset.assign_attrs(title=title, friction_law=law, supports=supports, rtol=rtol)


def solved(
    variation: GearVariation,
    grid: Mapping[str, FloatArray],
    rtol: float,
    *,
    everything: bool = False,
    progress: Progress | None = None,
) -> Store:
    """Multipliers of a variation of a pair at all points of a grid, or their spectral radii alone."""
    count = math.prod(values.size for values in grid.values())
    found, done = Store(count, everything=everything), 0
    for part in _slices(variation, grid):
        part.solve(found, rtol)
        done += part.index.size
        if progress is not None:
            progress(done / count)
    return found


class Store:
    """Multipliers of many points, or no more than their spectral radius.

    Attributes
    ----------
    radius, radius_error : (count,)
    proven : (count,) whether the errors are proven bounds
    multipliers, errors : (count, size) the largest modulus first; None without ``everything``
    """

    def __init__(self, count: int, *, everything: bool) -> None:
        self.everything = everything
        self.radius, self.radius_error = np.empty(count), np.empty(count)
        self.proven = np.zeros(count, dtype=bool)
        self.multipliers: ComplexArray | None = None
        self.errors: FloatArray | None = None

    def put(
        self, points: npt.NDArray[np.intp], values: ComplexArray, errors: FloatArray, *, proven: bool
    ) -> None:
        """Take the multipliers (k, size) of some points (k,) and bounds on their errors."""
        self.radius[points], self.radius_error[points] = radii_with_bounds(values, errors)
        self.proven[points] = proven
        if not self.everything:
            return
        if self.multipliers is None or self.errors is None:
            shape = self.radius.size, values.shape[1]
            self.multipliers, self.errors = np.empty(shape, dtype=complex), np.empty(shape)
        ranking = np.argsort(-np.abs(values), axis=1, kind="stable")
        self.multipliers[points] = np.take_along_axis(values, ranking, 1)
        self.errors[points] = np.take_along_axis(errors, ranking, 1)


def _slices(variation: GearVariation, grid: Mapping[str, FloatArray]) -> Iterator[ChartSlice]:
    """Cut a chart: one slice for each point of the slow axes, in pieces along speed where it is large."""
    # A friction axis that is zero throughout has no reference to scale.
    inner = [n for n in grid if n in _INNER and (n != "friction_coefficient" or grid[n].max() > 0.0)]
    shape = [values.size for values in grid.values()]
    index = np.arange(math.prod(shape)).reshape(shape)
    steps = {name: grid[name].size if name in inner else 1 for name in grid}
    if "speed_rpm" in inner:
        steps["speed_rpm"] = max(1, _SLICE * steps["speed_rpm"] // math.prod(steps.values()))
    for block in product(
        *([slice(i, i + steps[name]) for i in range(0, grid[name].size, steps[name])] for name in grid)
    ):
        here = {name: values[part] for (name, values), part in zip(grid.items(), block, strict=True)}
        mesh = np.meshgrid(*(here[name] for name in inner), indexing="ij")
        flat = {name: values.ravel() for name, values in zip(inner, mesh, strict=True)}
        # The references to which the factors of the slice relate.
        point = {name: float(values.max()) for name, values in here.items() if name != "speed_rpm"}
        point |= {"damping_ratio": 1.0} if "damping_ratio" in inner else {}
        yield ChartSlice(vary(variation, point), flat, index[block].ravel())


@dataclass(frozen=True, eq=False)
class ChartSlice:
    """Points of a chart that differ in speed, mesh damping and mean friction only.

    Damping only scales wd, the mean friction coefficient only scales what friction adds to w, and speed only
    changes the period, and with many friction laws scales friction too: one fit of the block serves them all.

    Attributes
    ----------
    reference : the pair with mesh damping 1 and the largest mean friction, where these are axes
    flat : name -> values (count,) of the axes
    index : (count,) place of the points in the chart
    """

    reference: GearVariation
    flat: Mapping[str, FloatArray]
    index: npt.NDArray[np.intp]

    def solve(self, store: Store, rtol: float) -> None:
        """Put the multipliers of all points into the store; ``rtol`` is relative to each monodromy matrix."""
        count = self.index.size
        speeds = self.flat.get("speed_rpm", np.full(count, operating_rpm(self.reference.pair)))
        damping = self.flat.get("damping_ratio", np.ones(count))
        friction = self.flat.get("friction_coefficient", np.ones(count))
        friction = friction / friction.max()
        unique, which = np.unique(speeds, return_inverse=True)
        for family in friction_families(self.reference, unique):
            row = np.full(unique.size, -1)
            row[family.members] = np.arange(family.members.size)
            part = np.flatnonzero(row[which] >= 0)
            variation = GEAR_AXES["speed_rpm"].apply(self.reference, family.speed_rpm)
            pair, feedback = variation.pair, feedback_system(variation)
            levels = [] if pair.friction.law == "none" else [0.0]
            levels += [] if family.level is None else [family.level]
            block = fitted_block(feedback, variation.stiffness_variation, max(0.01 * rtol, 1e-12), levels)
            periods = block.period * operating_rpm(pair) / speeds
            # At the other speeds of a family the law is that of one speed times factors found by sampling.
            exact = family.members.size == 1 or family.law is None
            separate = OffLineOfAction.of(feedback)
            for chunk in np.split(part, range(_CHUNK, part.size, _CHUNK)):
                T = periods[chunk]
                factors = friction[chunk, None] * family.factors[row[which[chunk]]]
                factors = factors[:, : len(levels)]
                found = fast_multipliers(block, T, damping[chunk], factors, tolerance=2e-4 * rtol)
                values, errors = separate.multipliers(T)
                store.put(
                    self.index[chunk],
                    np.concatenate([found.multipliers, values], axis=1),
                    np.concatenate([found.errors, errors], axis=1),
                    proven=exact,
                )
