"""Stability charts of gear pairs: the compiled route for dense charts, the general engine as its check.

Sources: docs/theory/floquet.md, "Computing M".
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import product
from typing import TYPE_CHECKING, Literal

import numpy as np

from floquet.engine.chart import Axes, chart_dataset, scan
from floquet.engine.propagators.base import Propagator
from floquet.engine.propagators.registry import PROPAGATORS
from floquet.engine.spectrum import Spectrum
from floquet.gear.axes import GearVariation, gear_axis, gear_grid, vary
from floquet.gear.feedback import feedback_system, separate_modes
from floquet.gear.multipliers import gear_pair_multipliers
from floquet.gear.plane import Plane, Store, plane_multipliers
from lumped.arguments import one_of, real_number
from lumped.errors import refuse
from lumped.model.periodic_system import Supports
from lumped.schema.files import AnyPair, load_gear_pair
from lumped.schema.pair import GearPair
from lumped.typing import FloatArray, Progress

if TYPE_CHECKING:
    import xarray as xr

METHODS = ("auto", "taylor", "chebyshev", *PROPAGATORS)
#: From here on interpolation costs less processor time than every point by itself (28/28, laws I to III).
INTERPOLATE_FROM = 100_000
_INNER = ("speed_rpm", "damping_ratio", "friction_coefficient")
# The compiled chart is cut along speed, which bounds its memory and lets it tell its progress: points of a
# slice, and speeds of one at least, since interpolation over few speeds saves nothing.
_SLICE, _SPEEDS = 1 << 18, 128
_LARGEST = 25_000_000


def stability_chart(
    pair: AnyPair,
    axes: Axes,
    *,
    friction_law: str | None = None,
    rtol: float = 1e-10,
    method: str | Propagator = "taylor",
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
    method : "taylor", the compiled kernel; "chebyshev", the same at some thousand nodes with a checked
        interpolation in speed and in damping or friction between them, for charts of many more points than
        that (speeds at which a friction law changes its regimes are computed directly); "auto", whichever of
        the two costs less; or a method of `monodromy` for an independent check
    store : "all"; or "radius" for the spectral radius, its error and the verdict without the multipliers: 18
        bytes a point instead of 258
    supports : "springs", the pair's ``bearings``, or its "shafts" with the modes that count most
    progress : told the finished fraction

    Returns
    -------
    xarray.Dataset over the axes: spectral_radius, error, verdict, proven and, with store "all", multipliers
    and multiplier_errors (10 each: the feedback block and the off-line-of-action block, on shafts two for
    each mode; the rigid rotation is no part of them). Its attribute ``certificate`` is "proven", "estimate"
    or "mixed", which the variable ``proven`` tells for every point: estimates are what "chebyshev"
    interpolates, what "taylor" gives over speeds that share a friction law to a tolerance, and all of the
    other methods.

    Raises
    ------
    ParameterError : unknown axis or method, values outside the range of an axis, or too many points
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
    if isinstance(method, str):
        method = one_of("method", method, METHODS)
        method = chart_method(grid) if method == "auto" else method
    if isinstance(method, str) and method in ("taylor", "chebyshev"):
        rtol = real_number("rtol", rtol, 1e-13, 1e-3, action="Use 1e-8 for charts, 1e-10 for verdicts.")
        if method == "chebyshev" and "speed_rpm" not in grid:
            raise refuse(
                "method", method, '"taylor" for axes without speed_rpm', "Interpolation is over speed."
            )
        interpolate, everything = method == "chebyshev", store == "all"
        dataset = _compiled_chart(pair, supports, grid, rtol, progress, interpolate, everything)
    else:

        def evaluate(point: dict[str, float]) -> Spectrum:
            return gear_pair_multipliers(vary(pair, point, supports), rtol, method=method)

        dataset = scan(evaluate, grid, progress=progress)
        if store == "radius":
            dataset = dataset.drop_vars(["multipliers", "multiplier_errors"])
    for name in grid:
        axis = gear_axis(name)
        dataset[name].attrs.update(units=axis.units, long_name=axis.long_name)
    dataset.attrs.update(
        title=f"stability chart of {pair.name}",
        friction_law=pair.friction.law,
        supports=supports,
        method=method if isinstance(method, str) else method.name,
        rtol=rtol,
    )
    return dataset


def chart_method(axes: Mapping[str, FloatArray]) -> str:
    """Method that costs least: "chebyshev" for many points over speed, damping and friction, else "taylor".

    Parameters
    ----------
    axes : of the chart
    """
    many = math.prod(np.size(values) for name, values in axes.items() if name in _INNER) >= INTERPOLATE_FROM
    return "chebyshev" if many and "speed_rpm" in axes else "taylor"


def _compiled_chart(
    pair: GearPair,
    supports: Supports,
    grid: Mapping[str, FloatArray],
    rtol: float,
    progress: Progress | None,
    interpolate: bool,
    multipliers: bool,
) -> xr.Dataset:
    """Fit the block once per point of the slow axes, then run the kernel over the fast ones.

    Damping only scales wd, the mean friction coefficient only scales what friction adds to w, and speed only
    changes the period, and with many friction laws scales friction too.
    """
    # A friction axis that is zero throughout has no reference to scale.
    inner = [n for n in grid if n in _INNER and (n != "friction_coefficient" or grid[n].max() > 0.0)]
    if interpolate and len(inner) == 3:
        inner.remove("friction_coefficient")
    index = np.arange(math.prod(values.size for values in grid.values()))
    index = index.reshape([values.size for values in grid.values()])
    steps = {name: grid[name].size if name in inner else 1 for name in grid}
    if "speed_rpm" in inner:
        steps["speed_rpm"] = max(_SPEEDS, _SLICE * steps["speed_rpm"] // math.prod(steps.values()))
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
        plane_multipliers(plane, store, rtol, interpolate)
        done += plane.index.size
        if progress is not None:
            progress(done / index.size)
    return chart_dataset(
        grid, store.multipliers, store.errors, store.radius, store.radius_error, store.proven
    )
