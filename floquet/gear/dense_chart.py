"""Stability charts of any size: the method that costs least, and slices that tell how far it is."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Literal

import numpy as np
import xarray as xr

from floquet.engine.chart import checked_axes
from floquet.engine.propagators.registry import PROPAGATORS
from floquet.gear.chart import stability_chart
from lumped import GearPair
from lumped.arguments import one_of
from lumped.errors import refuse
from lumped.typing import FloatArray, Progress

METHODS = ("auto", "taylor", "chebyshev", *PROPAGATORS)
#: From here on interpolation costs less processor time than every point by itself (28/28, laws I to III).
INTERPOLATE_FROM = 100_000
_FAST = ("speed_rpm", "damping_ratio", "friction_coefficient")
# Over fast axes alone the compiled chart tells its progress only at its end, so that it is cut along speed:
# points of a slice, and speeds of one at least, since interpolation over few speeds saves nothing.
_SLICE, _SPEEDS = 1 << 18, 128
_LARGEST = 25_000_000


def dense_chart(
    pair: GearPair,
    axes: Mapping[str, FloatArray],
    *,
    method: str = "auto",
    rtol: float = 1e-8,
    multipliers: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Stability chart over any axes.

    Parameters
    ----------
    pair : the gear pair
    axes : name -> values, see ``floquet.GEAR_AXES``
    method : of ``floquet.stability_chart``; "auto": see `chart_method`
    rtol : accuracy of the monodromy matrices relative to their scale
    multipliers : whether to keep all ten multipliers of every point with their bounds, 240 bytes a point
    progress : told the finished fraction

    Returns
    -------
    Dataset of ``floquet.stability_chart``: spectral_radius, error, verdict, and the multipliers if wanted

    Raises
    ------
    ParameterError : unusable axes or method, or more than 25 million points
    NumericalError : a point fails; the message names it
    """
    grid = checked_axes(axes)
    points = math.prod(values.size for values in grid.values())
    if points > _LARGEST:
        raise refuse("points of the chart", points, f"at most {_LARGEST}", "Give the axes smaller counts.")
    one_of("method", method, METHODS)
    chosen = chart_method(grid) if method == "auto" else method
    store: Literal["all", "radius"] = "all" if multipliers else "radius"
    if set(grid) - set(_FAST) or "speed_rpm" not in grid:
        return stability_chart(pair, grid, rtol=rtol, method=chosen, store=store, progress=progress)
    speeds = grid["speed_rpm"]
    rows = max(_SPEEDS, _SLICE * speeds.size // points)
    parts: list[xr.Dataset] = []
    for first in range(0, speeds.size, rows):
        part = {**grid, "speed_rpm": speeds[first : first + rows]}
        parts.append(stability_chart(pair, part, rtol=rtol, method=chosen, store=store))
        if progress is not None:
            progress(min(first + rows, speeds.size) / speeds.size)
    if len(parts) == 1:
        return parts[0]
    joined: xr.Dataset = xr.concat(parts, dim="speed_rpm", combine_attrs="override")
    return joined.transpose(*grid, ...)


def chart_method(axes: Mapping[str, FloatArray]) -> str:
    """Method that costs least: "chebyshev" for many points over speed, damping and friction, else "taylor".

    Parameters
    ----------
    axes : of the chart
    """
    many = math.prod(np.size(values) for name, values in axes.items() if name in _FAST) >= INTERPOLATE_FROM
    return "chebyshev" if many and "speed_rpm" in axes else "taylor"
