"""Pictures of one mesh cycle: transmission error, tooth forces, bearing forces; and of losses by law."""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from validation.plots.axes import draw_curves, label_axis
from validation.plots.style import GREY, WIDTH, legend_above, new_figure, one_panel


def cycle_figure(
    data: xr.Dataset, names: list[str], text: str = "", size: tuple[float, float] = (2.7, WIDTH)
) -> Figure:
    """Curves of one unit over their coordinate; ``text`` labels several; ``size`` in inches."""
    figure, ax = one_panel(*size)
    draw_curves(ax, data, names, text=text)
    x = data[str(data[names[0]].dims[0])].to_numpy()
    ax.set_xlim(x[0], x[-1])
    if len(names) > 1:
        legend_above(ax, min(len(names), 4))
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
