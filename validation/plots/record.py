"""A measured record over the prediction: each channel over a mesh cycle, and its mesh orders."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from validation.plots.style import BLACK, BLUE, RED, legend_outside, new_figure, scaled, write_beside

#: Mesh orders that are drawn.
_ORDERS = 10.0


def record_figure(data: xr.Dataset) -> Figure:
    """Draw each channel in a row: both motions over a mesh cycle, and both amplitudes over the mesh order.

    ``data``: ``RecordComparison.figure_data``. Bars: 2 standard uncertainties. Each row has one unit.
    """
    names = [str(name) for name in data["channel"].to_numpy()]
    figure, axes = new_figure(len(names), 2, height=0.6 + 2.0 * len(names), width_ratios=(1.2, 1.0))
    for (motion_axes, orders_axes), name in zip(axes, names, strict=True):
        channel = data.sel(channel=name)
        measured, predicted = (channel[f"{kind}_motion"].to_numpy() for kind in ("measured", "predicted"))
        factor, unit = scaled(measured, predicted, unit=str(channel["units"].item()))
        x = channel["phase"].to_numpy()
        motion_axes.plot(x, measured / factor, color=RED, linewidth=1.0, gid="measured", label="measured")
        look = {"linewidth": 1.2, "linestyle": "--", "gid": "predicted", "label": "predicted"}
        motion_axes.plot(x, predicted / factor, color=BLUE, **look)
        motion_axes.set(xlabel="mesh cycles [-]", ylabel=f"{name} [{unit}]", xlim=(x[0], round(x[-1])))
        place = (0.02, 1.0)
        write_beside(motion_axes, str(channel["apart"].item()), place, (0, 2), "axes fraction", fontsize=8.0)
        order = channel["order"].to_numpy()
        shown = (order <= _ORDERS) & np.isfinite(channel["measured"].to_numpy())
        width = 0.4 * float(np.diff(order).min(initial=1.0))
        for side, kind, colour in ((-0.5, "measured", RED), (0.5, "predicted", BLUE)):
            size, doubt = (channel[key].to_numpy()[shown] / factor for key in (kind, f"{kind}_deviation"))
            places = order[shown] + side * width
            orders_axes.bar(places, size, width=width, color=colour, gid=f"{kind}_orders")
            orders_axes.vlines(
                places, np.maximum(size - 2.0 * doubt, 0.0), size + 2.0 * doubt, color=BLACK, linewidth=0.7
            )
        orders_axes.set(xlabel="mesh order [-]", ylabel=f"amplitude [{unit}]", ylim=(0.0, None))
    legend_outside(figure, axes[0, 0].get_legend_handles_labels()[0], 2)
    return figure
