"""Third parameters of the interactive stability chart: what its slider moves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import xarray as xr

from floquet.gear.axes import gear_axis, operating_value, with_point
from floquet.gear.chart import stability_chart
from floquet.gear.tongues import LabelledRegion, label_regions
from lumped import GearPair
from lumped.errors import ParameterError
from lumped.typing import FloatArray

Grid = dict[str, FloatArray]

#: Accuracy of the monodromy matrices; the page shows six decimals.
_RTOL = 1e-7
#: Factors on the bearing stiffness span what a change of bearing or housing does.
_FACTORS = (0.25, 4.0)
_LEAST_FRICTION_RANGE = 0.1


@dataclass(frozen=True, eq=False)
class Slices:
    """Stability charts over speed and damping at several values of a third parameter.

    Attributes
    ----------
    key : name of the third parameter
    own : index of the value that the pair itself has
    chart : spectral_radius and verdict over (key, damping_ratio, speed_rpm)
    tongues : for each value the unstable regions, the largest first
    """

    key: str
    own: int
    chart: xr.Dataset
    tongues: tuple[tuple[LabelledRegion, ...], ...]


def bearing_slices(pair: GearPair, grid: Grid, count: int) -> Slices:
    """Charts with the stiffness of all bearings multiplied by one factor; 1 is the pair itself.

    Parameters
    ----------
    pair : the gear pair
    grid : speed_rpm and damping_ratio
    count : values of the factor; those that the schema refuses are left out
    """
    factors = with_point(np.geomspace(*_FACTORS, count), 1.0)
    variants = {float(f): made for f in factors if (made := _stiffer(pair, float(f))) is not None}
    charts = [stability_chart(variant, grid, rtol=_RTOL) for variant in variants.values()]
    values = np.array(list(variants))
    attrs = {"units": "1", "long_name": "bearing stiffness factor"}
    axis = xr.DataArray(values, dims="bearing_factor", name="bearing_factor", attrs=attrs)
    tongues = [tuple(label_regions(v, c)) for v, c in zip(variants.values(), charts, strict=True)]
    chart = xr.concat([chart[_VARIABLES] for chart in charts], axis)
    return Slices("bearing_factor", int(np.argmin(np.abs(values - 1.0))), _ordered(chart), tuple(tongues))


def friction_slices(pair: GearPair, grid: Grid, count: int) -> Slices:
    """Charts with the friction law scaled to a mean coefficient that is the same at every speed.

    Parameters
    ----------
    pair : the gear pair
    grid : speed_rpm and damping_ratio
    count : values of the coefficient, from 0
    """
    name = "friction_coefficient"
    own = operating_value(pair, name)
    values = with_point(np.linspace(0.0, min(max(_LEAST_FRICTION_RANGE, 2.0 * own), 1.0), count), own)
    chart = stability_chart(pair, {**grid, name: values}, rtol=_RTOL)
    tongues = [tuple(label_regions(pair, chart.isel({name: [i]}))) for i in range(count)]
    attrs = {"units": "1", "long_name": gear_axis(name).long_name}
    chart[name].attrs.update(attrs)
    return Slices(name, int(np.argmin(np.abs(values - own))), _ordered(chart[_VARIABLES]), tuple(tongues))


#: Third parameter -> how its charts are made; the first is shown first.
SLICES: dict[str, Callable[[GearPair, Grid, int], Slices]] = {
    "bearing_factor": bearing_slices,
    "friction_coefficient": friction_slices,
}

_VARIABLES = ["spectral_radius", "error", "verdict"]


def _stiffer(pair: GearPair, factor: float) -> GearPair | None:
    bearings = pair.bearings
    own = {
        f"bearings.{g}.{d}_stiffness": getattr(getattr(bearings, g), f"{d}_stiffness")
        for g in ("pinion", "gear")
        for d in ("loa", "oloa")
    }
    try:
        return pair.with_({path: factor * value for path, value in own.items()})
    except ParameterError:
        return None


def _ordered(chart: xr.Dataset) -> xr.Dataset:
    return chart.transpose(..., "damping_ratio", "speed_rpm")
