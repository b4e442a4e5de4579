"""A measured record beside its prediction, one panel per channel."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from validation.plots.style import BLUE, GREY, RED, legend_outside, new_figure, scaled


def overlay_figure(points: xr.Dataset) -> Figure:
    """Measured means per phase bin with their scatter, and the prediction, over the mesh phase.

    Parameters
    ----------
    points : of ``validation.measurements.overlay``
    """
    names = [str(name) for name in points["channel"].to_numpy()]
    columns = min(len(names), 2)
    rows = -(-len(names) // columns)
    figure, axes = new_figure(rows, columns, height=0.6 + 2.3 * rows)
    panels: list[Axes] = axes.ravel().tolist()
    for ax, name in zip(panels, names, strict=False):
        one = points.sel(channel=name)
        x = one["phase"].to_numpy()
        measured, predicted = one["measured"].to_numpy(), one["predicted"].to_numpy()
        scatter = one["scatter"].to_numpy()
        factor, unit = scaled(measured, predicted, unit=str(one["units"].item()))
        ax.fill_between(
            x, (measured - scatter) / factor, (measured + scatter) / factor, color=RED, alpha=0.2, linewidth=0
        )
        ax.plot(
            x, measured / factor, color=RED, marker="o", markersize=2.4, linestyle="none", label="measured"
        )
        ax.plot(x, predicted / factor, color=BLUE, linewidth=1.2, label="predicted")
        ax.axhline(0.0, color=GREY, linewidth=0.6)
        ax.set_xlim(0.0, float(np.ceil(10 * x[-1]) / 10))
        ax.set(xlabel="mesh cycles since the pair was at A", ylabel=f"{name} [{unit}]")
    for ax in panels[len(names) :]:
        ax.set_visible(False)
    legend_outside(figure, panels[0].get_legend_handles_labels()[0], 2)
    return figure
