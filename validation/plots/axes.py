"""Axes, curves and bars whose labels and units come from the result that is drawn."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lumped.typing import FloatArray
from validation.plots.style import GREY, WIDTH, legend_above, look, new_figure, one_panel, scaled

#: Characters that fit in a row of a legend as wide as a page, and those that a curve's sample takes.
_ROW = 100
_HANDLE = 9
#: Units that take no prefix.
_AS_IS = frozenset({"rpm", "%", "1/rev", "mesh cycles"})


def unit_of(*arrays: xr.DataArray) -> str:
    """The one unit that results share."""
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
    """Label the axis "x" or "y" by ``text`` or name, and unit of results; return their divisor."""
    factor, unit = scale_of(*arrays)
    name = text or str(arrays[0].attrs["long_name"])
    ax.set(**{f"{which}label": f"{name} [{unit}]"})
    return factor


def draw_curves(ax: Axes, data: xr.Dataset, names: list[str], text: str = "", **style: Any) -> None:
    """Draw variables of one unit over their coordinate, labelled by themselves; ``text`` names several."""
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
    """Values (2, n) of the curve that ``draw_curves`` made of a variable, as drawn."""
    line = next(line for line in ax.lines if line.get_gid() == name)
    return np.asarray(line.get_xydata(), dtype=np.float64).T


def cycle_figure(
    data: xr.Dataset, names: list[str], text: str = "", size: tuple[float, float] = (2.7, WIDTH)
) -> Figure:
    """Curves of one unit over their coordinate; ``text`` labels several; ``size`` in inches."""
    figure, ax = one_panel(*size)
    draw_curves(ax, data, names, text=text)
    x = data[str(data[names[0]].dims[0])].to_numpy()
    ax.set_xlim(x[0], x[-1])
    if len(names) > 1:
        characters = sum(len(str(data[name].attrs["long_name"])) + _HANDLE for name in names)
        legend_above(ax, min(len(names), 4 if characters <= _ROW * size[1] / WIDTH else 2))
    return figure


def two_panels_figure(data: xr.Dataset, top: list[str], bottom: list[str], texts: tuple[str, str]) -> Figure:
    """Curves of two units over a common coordinate, one panel each; ``texts`` label the vertical axes."""
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
    """Loss of the mesh [%] by friction law; attributes ``titles``, and ``own``, the place of the own law."""
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
