"""A measured record over the prediction: each channel over a mesh cycle, and its mesh orders."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from validation.plots.style import BLACK, BLUE, RED, legend_outside, new_figure, scaled, write_beside

#: Mesh orders that are drawn.
_ORDERS = 10.0


def record_figure(data: xr.Dataset) -> Figure:
    """Each channel in a row: both motions over a mesh cycle, and both amplitudes over the mesh order.

    ``data`` is ``RecordComparison.figure_data``. Bars: 2 standard uncertainties. A row has one unit.
    """
    names = [str(name) for name in data["channel"].to_numpy()]
    figure, axes = new_figure(len(names), 2, height=0.6 + 2.0 * len(names), width_ratios=(1.2, 1.0))
    for (left, right), name in zip(axes, names, strict=True):
        one = data.sel(channel=name)
        measured, predicted = (one[f"{which}_motion"].to_numpy() for which in ("measured", "predicted"))
        factor, unit = scaled(measured, predicted, unit=str(one["units"].item()))
        x = one["phase"].to_numpy()
        left.plot(x, measured / factor, color=RED, linewidth=1.0, gid="measured", label="measured")
        look = {"linewidth": 1.2, "linestyle": "--", "gid": "predicted", "label": "predicted"}
        left.plot(x, predicted / factor, color=BLUE, **look)
        left.set(xlabel="mesh cycles [-]", ylabel=f"{name} [{unit}]", xlim=(x[0], round(x[-1])))
        place = (0.02, 1.0)
        write_beside(left, str(one["apart"].item()), place, (0, 2), "axes fraction", fontsize=8.0)
        order = one["order"].to_numpy()
        shown = (order <= _ORDERS) & np.isfinite(one["measured"].to_numpy())
        width = 0.4 * float(np.diff(order).min(initial=1.0))
        for side, which, colour in ((-0.5, "measured", RED), (0.5, "predicted", BLUE)):
            size, doubt = (one[key].to_numpy()[shown] / factor for key in (which, f"{which}_deviation"))
            at = order[shown] + side * width
            right.bar(at, size, width=width, color=colour, gid=f"{which}_orders")
            right.vlines(
                at, np.maximum(size - 2.0 * doubt, 0.0), size + 2.0 * doubt, color=BLACK, linewidth=0.7
            )
        right.set(xlabel="mesh order [-]", ylabel=f"amplitude [{unit}]", ylim=(0.0, None))
    legend_outside(figure, axes[0, 0].get_legend_handles_labels()[0], 2)
    return figure
