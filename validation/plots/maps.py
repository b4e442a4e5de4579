"""Maps: a result over two axes as colour, all with one colour map and a colour bar with numbers."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm, Normalize
from matplotlib.figure import Figure

from validation.plots.axes import label_axis, scale_of
from validation.plots.style import RED, one_panel, write_beside

#: Perceived alike with every colour vision deficiency, and in print.
COLOURS = "cividis"
#: Mesh orders that a waterfall reaches at the highest speed.
_MESH_ORDERS = 5
#: Letters in a line beside a colour bar.
_BAR_WIDTH = 44


def map_figure(
    values: xr.DataArray, x: str, y: str, *, log: bool = False, height: float = 3.4
) -> tuple[Figure, Axes]:
    """Return the figure of a result over two of its coordinates, and its axes. ``height`` [inch]."""
    figure, ax = one_panel(height)
    values = values.transpose(y, x).sortby([x, y])
    factor, unit = scale_of(values)
    shown = values.to_numpy() / factor
    finite = shown[np.isfinite(shown)]
    norm: Any = Normalize(finite.min(), finite.max())
    if log:
        norm = LogNorm(max(finite.max() * 1e-3, 1e-30), finite.max(), clip=True)
    across = label_axis(ax, "x", values[x])
    up = label_axis(ax, "y", values[y])
    drawn = ax.pcolormesh(
        values[x].to_numpy() / across,
        values[y].to_numpy() / up,
        shown,
        cmap=COLOURS,
        norm=norm,
        shading="nearest",
        rasterized=True,
    )
    bar = figure.colorbar(drawn, ax=ax, pad=0.01)
    bar.set_label(f"{values.attrs['long_name']} [{unit}]", fontsize=8.5)
    bar.outline.set_linewidth(0.5)
    ax.grid(False)
    return figure, ax


def orders_map_figure(data: xr.Dataset, operating_rpm: float, resonances: list[float]) -> Figure:
    """Draw orders of the bearing force over speed, and the speeds at which an order meets a natural
    frequency.

    ``data``: ``amplitude`` over ``speed_rpm`` and ``order``; ``resonances``: resonant speeds of order 1
    [rpm].
    """
    figure, ax = map_figure(data["amplitude"], "speed_rpm", "order", log=True)
    low, high = ax.get_xlim()
    orders = data["order"].to_numpy()
    for first in resonances:
        place = first / orders
        inside = (place >= low) & (place <= high)
        ax.plot(place[inside], orders[inside], color=RED, linewidth=0.8, marker="o", markersize=2.5)
    ax.axvline(operating_rpm, color="white", linewidth=1.0, linestyle="--")
    ax.set_yticks(orders)
    return figure


def waterfall_figure(data: xr.Dataset, frequencies: Iterable[float] = ()) -> Figure:
    """Draw the amplitudes of a run-up over frequency and speed.

    Mesh orders are rays, natural frequencies vertical lines.

    Parameters
    ----------
    data : of ``validation.signals.waterfall``
    frequencies : natural frequencies of the averaged pair [Hz]
    """
    figure, ax = one_panel(4.2)
    factor, unit = scale_of(data["amplitude"])
    shown = data["amplitude"].to_numpy()[:, 1:] / factor
    hertz = data["frequency"].to_numpy()
    speed = data["speed_rpm"].to_numpy()
    grid = np.broadcast_to(speed[:, None], shown.shape)
    norm = LogNorm(shown.max() * 1e-3, shown.max(), clip=True)
    drawn = ax.pcolormesh(hertz[:, 1:] / 1e3, grid, shown, cmap=COLOURS, norm=norm, shading="nearest")
    drawn.set_rasterized(True)
    bar = figure.colorbar(drawn, ax=ax, pad=0.01)
    words = f"{data['amplitude'].attrs['long_name']} [{unit}]"
    bar.set_label(textwrap.fill(words, _BAR_WIDTH), fontsize=8.5)
    bar.outline.set_linewidth(0.5)
    mesh = float(np.interp(data.attrs["mesh_order"], data["order"], hertz[int(np.argmax(speed))])) / 1e3
    end = _MESH_ORDERS * mesh
    for order in range(1, _MESH_ORDERS):
        write_beside(ax, f"{order}×", (order * mesh, speed.max()), (0, 2), ha="center")
    for frequency in frequencies:
        if frequency / 1e3 < end:
            ax.axvline(frequency / 1e3, color=RED, linewidth=0.8, linestyle="--")
    across = data["frequency"].attrs["long_name"]
    up = data["speed_rpm"].attrs["long_name"]
    ax.set(
        xlim=(0.0, end),
        ylim=(speed.min(), speed.max()) if speed.size > 1 else None,
        xlabel=f"{across} [kHz]; 1×, 2×: mesh orders, red: natural frequencies",
        ylabel=f"{up} [rpm]",
    )
    ax.set_facecolor("#e8e8e8")
    ax.grid(False)
    return figure
