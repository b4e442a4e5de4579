"""Stability charts of any size: the method chosen by the number of points, the memory bounded by slices."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from floquet import PROPAGATORS, stability_chart
from floquet.chart import checked_axes
from floquet.gear_axes import gear_axis
from lumped import GearPair
from lumped.errors import refuse

FloatArray = NDArray[np.float64]
Progress = Callable[[float], None]
"""Called with the finished fraction."""

METHODS = ("auto", "taylor", "chebyshev", *sorted(PROPAGATORS))
#: From here on interpolation costs less processor time than every point by itself (measured on the presets).
INTERPOLATE_FROM = 25_000
#: Points in memory at once with all their multipliers, 240 bytes each and as much again while they are made.
_SLICE = 1 << 17
_SPEEDS = 128  # in a slice at least: interpolation over few speeds saves nothing
_LARGEST = 25_000_000
_RATES = ("damping_ratio", "friction_coefficient")
_MULTIPLIERS = ("multipliers", "multiplier_errors")


def dense_chart(
    pair: GearPair,
    axes: Mapping[str, FloatArray],
    *,
    method: str = "auto",
    rtol: float = 1e-8,
    multipliers: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Stability chart over any axes, slice by slice.

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
    for name, values in grid.items():
        gear_axis(name).check(name, values)
    points = math.prod(values.size for values in grid.values())
    if points > _LARGEST:
        raise refuse("points of the chart", points, f"at most {_LARGEST}", "Give the axes smaller counts.")
    if method not in METHODS:
        raise refuse("method", method, ", ".join(METHODS), "Choose among these.")
    chosen = chart_method(grid) if method == "auto" else method
    along = _slicing_axis(grid)
    rows = max(1 if along != "speed_rpm" else _SPEEDS, _SLICE * grid[along].size // points)
    parts, done = [], 0
    for first in range(0, grid[along].size, rows):
        part = grid[along][first : first + rows]

        def tell(finished: int, _: int, before: int = done) -> None:
            if progress is not None:
                progress((before + finished) / points)

        chart = stability_chart(pair, {**grid, along: part}, rtol=rtol, method=chosen, progress=tell)
        # A copy, so that the multipliers of the slice can go.
        parts.append(chart if multipliers else chart.drop_vars(_MULTIPLIERS).copy(deep=True))
        del chart
        done += points // grid[along].size * part.size
    if len(parts) == 1:
        return parts[0]
    joined: xr.Dataset = xr.concat(parts, dim=along, combine_attrs="override")
    return joined.transpose(*grid, ...)


def chart_method(axes: Mapping[str, FloatArray]) -> str:
    """Method that costs least: "chebyshev" for many points over speed, damping and friction, else "taylor".

    Parameters
    ----------
    axes : of the chart
    """
    fast = [np.size(values) for name, values in axes.items() if name in ("speed_rpm", *_RATES)]
    many = "speed_rpm" in axes and math.prod(fast) >= INTERPOLATE_FROM
    return "chebyshev" if many else "taylor"


def _slicing_axis(axes: Mapping[str, FloatArray]) -> str:
    """Axis along which slices repeat no work: one that needs a fit at each value anyway, or else speed."""
    slow = [name for name in axes if name not in (*_RATES, "speed_rpm")]
    return next(iter([*slow, *(name for name in ("speed_rpm",) if name in axes), *axes]))
