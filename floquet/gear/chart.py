"""Stability charts of gear pairs.

Sources: docs/theory/floquet.md, "Computing M".
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import product
from typing import TYPE_CHECKING, Literal

import numpy as np

from floquet.engine.chart import Axes, chart_dataset
from floquet.gear.axes import GearVariation, gear_axis, gear_grid, vary
from floquet.gear.feedback import feedback_system, separate_modes
from floquet.gear.plane import Plane, Store, plane_multipliers
from lumped.arguments import one_of, real_number
from lumped.errors import refuse
from lumped.model.periodic_system import Supports
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray, Progress

if TYPE_CHECKING:
    import xarray as xr

_INNER = ("speed_rpm", "damping_ratio", "friction_coefficient")
# The chart is cut along speed, which bounds its memory and lets it tell its progress: points of a slice.
_SLICE = 1 << 18
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
    variation = GearVariation.of(load_gear_pair(pair), supports)
    pair, grid = variation.pair, gear_grid(axes, supports)
    points = math.prod(values.size for values in grid.values())
    if points > _LARGEST:
        raise refuse("points of the chart", points, f"at most {_LARGEST}", "Give the axes smaller counts.")
    one_of("store", store, ("all", "radius"))
    if friction_law is not None:
        pair = pair.with_({"friction.law": friction_law})
    rtol = real_number("rtol", rtol, 1e-13, 1e-3, action="Use 1e-8 for charts, 1e-10 for verdicts.")
    dataset = _compiled_chart(pair, supports, grid, rtol, progress, store == "all")
    for name in grid:
        axis = gear_axis(name)
        dataset[name].attrs.update(units=axis.units, long_name=axis.long_name)
    dataset.attrs.update(
        title=f"stability chart of {pair.name}",
        friction_law=pair.friction.law,
        supports=supports,
        rtol=rtol,
    )
    return dataset


def _compiled_chart(
    pair: GearPair,
    supports: Supports,
    grid: Mapping[str, FloatArray],
    rtol: float,
    progress: Progress | None,
    multipliers: bool,
) -> xr.Dataset:
    """Fit the block once per point of the slow axes, then run the kernel over the fast ones.

    Damping only scales wd, the mean friction coefficient only scales what friction adds to w, and speed only
    changes the period, and with many friction laws scales friction too.
    """
    # A friction axis that is zero throughout has no reference to scale.
    inner = [n for n in grid if n in _INNER and (n != "friction_coefficient" or grid[n].max() > 0.0)]
    index = np.arange(math.prod(values.size for values in grid.values()))
    index = index.reshape([values.size for values in grid.values()])
    steps = {name: grid[name].size if name in inner else 1 for name in grid}
    if "speed_rpm" in inner:
        steps["speed_rpm"] = max(1, _SLICE * steps["speed_rpm"] // math.prod(steps.values()))
    everywhere = vary(pair, {}, supports)
    size = 2 * (feedback_system(everywhere).squares.size + separate_modes(everywhere)[0].size)
    store, done = Store(index.size, size, multipliers), 0
    for block in product(
        *([slice(i, i + steps[name]) for i in range(0, grid[name].size, steps[name])] for name in grid)
    ):
        here = {name: values[part] for (name, values), part in zip(grid.items(), block, strict=True)}
        mesh = np.meshgrid(*(here[name] for name in inner), indexing="ij")
        flat = {name: values.ravel() for name, values in zip(inner, mesh, strict=True)}
        point = {name: float(values[0]) for name, values in here.items() if name not in inner}
        plane = Plane(pair, supports, point, flat, index[block].ravel())
        plane_multipliers(plane, store, rtol)
        done += plane.index.size
        if progress is not None:
            progress(done / index.size)
    return chart_dataset(
        grid, store.multipliers, store.errors, store.radius, store.radius_error, store.proven
    )
