"""Axes, curves and bars whose labels and units come from the result that is drawn."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from lumped.typing import FloatArray
from validation.plots.style import look, scaled

#: Units that take no prefix.
_AS_IS = frozenset({"rpm", "%", "1/rev", "mesh cycles"})


def unit_of(*arrays: xr.DataArray) -> str:
    """The unit that results share.

    Raises
    ------
    ValueError : results of different units on one axis
    """
    units = {str(array.attrs["units"]) for array in arrays}
    if len(units) != 1:
        raise ValueError(f"one axis for different units: {', '.join(sorted(units))}")
    return units.pop()


def scale_of(*arrays: xr.DataArray) -> tuple[float, str]:
    """Divisor and unit as printed of results that share an axis; "-" for a ratio."""
    unit = unit_of(*arrays)
    if unit in _AS_IS or unit == "1":
        return 1.0, "-" if unit == "1" else unit
    return scaled(*(array.to_numpy() for array in arrays), unit=unit)


def label_axis(ax: Axes, which: str, *arrays: xr.DataArray, text: str = "") -> float:
    """Label the axis "x" or "y" by name and unit of what is drawn along it; return the divisor of its values.

    Parameters
    ----------
    ax : the panel
    which : "x" or "y"
    *arrays : results that share the axis
    text : a common name, where there are several
    """
    factor, unit = scale_of(*arrays)
    name = text or str(arrays[0].attrs["long_name"])
    ax.set(**{f"{which}label": f"{name} [{unit}]"})
    return factor


def draw_curves(ax: Axes, data: xr.Dataset, names: list[str], text: str = "", **style: Any) -> None:
    """Draw results over their common coordinate; labels of axes and curves are those of the results.

    Parameters
    ----------
    ax : the panel
    data : has the curves, each over one dimension with a coordinate
    names : of its variables, of one unit
    text : label of the vertical axis where there are several curves
    """
    curves = [data[name] for name in names]
    x = data[str(curves[0].dims[0])]
    across, up = label_axis(ax, "x", x), label_axis(ax, "y", *curves, text=text)
    for number, curve in enumerate(curves):
        ax.plot(
            x.to_numpy() / across,
            curve.to_numpy() / up,
            label=str(curve.attrs["long_name"]),
            gid=str(curve.name),
            **(look(number) | style),
        )


def drawn(ax: Axes, name: str) -> FloatArray:
    """Values (2, n) of the curve that ``draw_curves`` made of a variable, as drawn."""
    line = next(line for line in ax.lines if line.get_gid() == name)
    return np.asarray(line.get_xydata(), dtype=np.float64).T
