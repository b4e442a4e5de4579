"""Axes, curves and bars with labels and units from the result that is drawn."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lumped.typing import FloatArray
from validation.plots.style import GREY, WIDTH, legend_above, look, new_figure, one_panel, scaled

#: Characters in a row of a legend that is as wide as a page.
_ROW = 100
#: Width of the sample of a curve in a legend, in characters.
_HANDLE = 9
#: Units that take no prefix.
_AS_IS = frozenset({"rpm", "%", "1/rev", "mesh cycles"})


def unit_of(*arrays: xr.DataArray) -> str:
    """Return the unit of results that share an axis."""
    units = {str(array.attrs["units"]) for array in arrays}
    if len(units) != 1:
        raise ValueError(f"one axis for different units: {', '.join(sorted(units))}")
    return units.pop()


def scale_of(*arrays: xr.DataArray) -> tuple[float, str]:
    """Return divisor and printed unit of results that share an axis; the unit is "-" for a ratio."""
    unit = unit_of(*arrays)
    if unit in _AS_IS or unit == "1":
        return 1.0, "-" if unit == "1" else unit
    return scaled(*(array.to_numpy() for array in arrays), unit=unit)


def label_axis(ax: Axes, axis: str, *arrays: xr.DataArray, text: str = "") -> float:
    """Label the axis "x" or "y" with ``text``, or the name, and the unit of results. Return the divisor."""
    factor, unit = scale_of(*arrays)
    name = text or str(arrays[0].attrs["long_name"])
    ax.set(**{f"{axis}label": f"{name} [{unit}]"})
    return factor


def draw_curves(ax: Axes, data: xr.Dataset, names: list[str], text: str = "", **style: Any) -> None:
    """Draw variables of one unit over their common coordinate. ``text`` labels the y axis."""
    curves = [data[name] for name in names]
    x = data[str(curves[0].dims[0])]
    across = label_axis(ax, "x", x)
    up = label_axis(ax, "y", *curves, text=text)
    for number, curve in enumerate(curves):
        ax.plot(
            x.to_numpy() / across,
            curve.to_numpy() / up,
            label=str(curve.attrs["long_name"]),
            gid=str(curve.name),
            **(look(number) | style),
        )


def drawn(ax: Axes, name: str) -> FloatArray:
    """Return the values (2, n) of the curve of a variable, as ``draw_curves`` has drawn it."""
    line = next(line for line in ax.lines if line.get_gid() == name)
    return np.asarray(line.get_xydata(), dtype=np.float64).T


def cycle_figure(
    data: xr.Dataset, names: list[str], text: str = "", size: tuple[float, float] = (2.7, WIDTH)
) -> Figure:
    """Draw curves of one unit over their coordinate. ``text`` labels the y axis; ``size`` [inch]."""
    figure, ax = one_panel(*size)
    draw_curves(ax, data, names, text=text)
    x = data[str(data[names[0]].dims[0])].to_numpy()
    ax.set_xlim(x[0], x[-1])
    if len(names) > 1:
        characters = sum(len(str(data[name].attrs["long_name"])) + _HANDLE for name in names)
        legend_above(ax, min(len(names), 4 if characters <= _ROW * size[1] / WIDTH else 2))
    return figure


def two_panels_figure(data: xr.Dataset, top: list[str], bottom: list[str], texts: tuple[str, str]) -> Figure:
    """Draw curves of two units over a common coordinate, one panel each. ``texts`` label the y axes."""
    figure, axes = new_figure(2, 1, height=4.2, sharex=True)
    for ax, names, text in zip(axes[:, 0], (top, bottom), texts, strict=True):
        draw_curves(ax, data, names, text=text)
        ax.axhline(0.0, color=GREY, linewidth=0.6)
        if len(names) > 1:
            legend_above(ax, min(len(names), 4))
    axes[0, 0].set_xlabel("")
    x = data[str(data[top[0]].dims[0])].to_numpy()
    axes[1, 0].set_xlim(x[0], x[-1])
    return figure


def losses_figure(data: xr.Dataset) -> Figure:
    """Draw the loss of the mesh [%] by friction law.

    Attributes of ``data``: ``titles`` of the laws, and ``own``, the number of the law of the pair.
    """
    loss = data["loss"]
    figure, ax = one_panel(0.8 + 0.35 * loss.size)
    label_axis(ax, "x", loss)
    place = list(range(loss.size))
    colours = ["#0072B2" if k == data.attrs["own"] else "#9ecae1" for k in place]
    ax.barh(place, loss.to_numpy(), height=0.6, color=colours)
    ax.set_yticks(place, list(data.attrs["titles"]))
    ax.set_ylabel("friction law")
    ax.invert_yaxis()
    ax.set_xlim(left=0.0)
    ax.grid(False, axis="y")
    return figure
