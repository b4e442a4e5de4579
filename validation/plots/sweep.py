"""Periodic motion over speed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from lumped.model.steady import UNSTABLE
from validation.plots.style import BLUE, GREY, LINES, RED, legend_above, mark_operation, new_figure, scaled


def sweep_figure(
    sweep: xr.Dataset, operating_rpm: float, static_load: float, resonances_rpm: Sequence[float] = ()
) -> Figure:
    """Peak to peak of the transmission error, and largest and smallest tooth load, over pinion speed.

    Crosses mark unstable motions.

    Parameters
    ----------
    sweep : dataset of ``lumped.speed_sweep``
    operating_rpm : operating speed, marked [rpm]
    static_load : T_p/r_bp, to scale the loads [N]
    resonances_rpm : speeds at which the mesh frequency meets a natural frequency of the averaged pair [rpm]
    """
    figure, axes = new_figure(2, 1, height=4.2, sharex=True)
    top, bottom = axes[:, 0]
    speed = sweep["speed"].to_numpy()
    values = sweep["dte_peak_to_peak"].to_numpy()
    factor, unit = scaled(values, unit="m")
    top.plot(speed, values / factor, color=BLUE)
    unstable = sweep["spectral_radius"].to_numpy() > UNSTABLE
    if unstable.any():
        top.plot(speed[unstable], values[unstable] / factor, "x", color=RED, markersize=4.5)
    top.set(ylabel=f"transmission error,\npeak to peak [{unit}]", ylim=(0.0, None))
    low = sweep["normal_load_min"].to_numpy() / static_load
    bottom.plot(speed, sweep["normal_load_max"].to_numpy() / static_load, color=BLUE, label="largest")
    bottom.plot(speed, low, color=LINES[2], linestyle="--", label="smallest")
    apart = np.nan_to_num(low) < 0.0
    if apart.any():
        shade = {"color": RED, "alpha": 0.3, "linewidth": 0, "label": "teeth separate: not valid"}
        bottom.fill_between(speed, low, 0.0, where=apart, **shade)
    bottom.axhline(0.0, color=GREY, linewidth=0.6)
    bottom.set(ylabel="tooth load over\nstatic load [-]", xlabel="pinion speed [rpm]")
    bottom.set_xlim(speed[0], speed[-1])
    mark_operation(top, operating_rpm, "operating point")
    if speed[0] <= operating_rpm <= speed[-1]:
        bottom.axvline(operating_rpm, color=RED, linewidth=1.0)
    for ax in (top, bottom):
        for place in resonances_rpm:
            if speed[0] <= place <= speed[-1]:
                ax.axvline(place, color=GREY, linewidth=0.7, linestyle=":")
    legend_above(bottom, 3)
    return figure
