"""Transmission error and tooth loads over a whole run."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from lumped import Geometry
from validation.plots.style import BLUE, DASHES, GREY, LINES, legend_above, mesh_cycles, new_figure, scaled


def history_figure(g: Geometry, result: xr.Dataset) -> Figure:
    """Transmission error, and normal load per tooth pair, over the time of a run.

    Parameters
    ----------
    g : geometry of the pair
    result : dataset of ``simulate`` or ``steady_state`` of either model
    """
    figure, axes = new_figure(2, 1, height=4.2, sharex=True)
    top, bottom = axes[:, 0]
    x = mesh_cycles(result, g)
    dte = result["dte"].to_numpy()
    factor, unit = scaled(dte, unit="m")
    top.plot(x, dte / factor, color=BLUE, linewidth=1.0)
    top.set_ylabel(f"transmission error [{unit}]")
    load = np.where(result["contact"].to_numpy() > 0, result["normal_load"].to_numpy(), np.nan)
    factor, unit = scaled(load, unit="N")
    for i, row in enumerate(load):
        style = DASHES[i % len(DASHES)]
        bottom.plot(
            x, row / factor, color=LINES[i % len(LINES)], linestyle=style, linewidth=1.0, label=f"pair {i}"
        )
    bottom.axhline(0.0, color=GREY, linewidth=0.6)
    bottom.set_ylabel(f"normal load [{unit}]")
    bottom.set_xlabel("time [mesh cycles]")
    bottom.set_xlim(x[0], x[-1])
    legend_above(bottom, len(load))
    figure.align_ylabels()
    return figure
