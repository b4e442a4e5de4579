"""The figure of a report's first page."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from lumped.model.steady import UNSTABLE
from validation.plots.style import BLUE, GREEN, GREY, RED, legend_above, mark_operation, new_figure, scaled

_WIDTH = 4.6


def first_figure(
    lumped: xr.Dataset,
    multibody: xr.Dataset,
    period: float,
    sweep: xr.Dataset,
    operating_rpm: float,
    static_load: float,
    branches: xr.Dataset | None = None,
) -> Figure:
    """Transmission error of both models over the last mesh cycle, and its peak to peak over speed.

    Parameters
    ----------
    lumped, multibody : histories of ``dte`` at the same times
    period : mesh period [s]
    sweep : dataset of ``lumped.speed_sweep``
    operating_rpm : operating speed, marked [rpm]
    static_load : T_p/r_bp; where the smallest load is negative beside it, teeth separate [N]
    branches : ``dataset`` of ``floquet.response_branches``, of which the stable motions are drawn
    """
    figure, axes = new_figure(2, 1, height=4.9)
    figure.set_figwidth(_WIDTH)
    top, bottom = axes[:, 0]
    time = lumped["time"].to_numpy()
    last = time >= time[-1] - (1.0 + 1e-9) * period
    x = (time[last] - time[last][0]) / period
    factor, unit = scaled(lumped["dte"].to_numpy()[last], unit="m")
    for run, look in (
        (lumped, {"color": BLUE, "linewidth": 2.6, "alpha": 0.5, "label": "this model"}),
        (multibody, {"color": RED, "linewidth": 1.1, "label": "independent model"}),
    ):
        top.plot(x, run["dte"].to_numpy()[last] / factor, **look)
    top.set(xlabel="time [mesh cycles]", ylabel=f"transmission error [{unit}]", xlim=(0.0, 1.0))
    legend_above(top, 2)
    speed, values = sweep["speed"].to_numpy(), sweep["dte_peak_to_peak"].to_numpy()
    wrong = sweep["normal_load_min"].to_numpy() < -1e-9 * static_load
    wrong |= sweep["spectral_radius"].to_numpy() > UNSTABLE
    factor, unit = scaled(values, unit="m")
    bottom.plot(speed, np.where(wrong, np.nan, values) / factor, color=BLUE, label="holds")
    if wrong.any():
        look = {"color": GREY, "linewidth": 0.9, "linestyle": ":", "zorder": 1.5}
        bottom.plot(speed, values / factor, label="not as computed", **look)
    if branches is not None:
        for number in np.unique(branches["branch"]):
            one = branches.isel(point=branches["branch"].to_numpy() == number)
            stable = np.where(one["stable"], one["dte_peak_to_peak"] / factor, np.nan)
            bottom.plot(one["speed_rpm"], stable, color=GREEN)
        bottom.plot([], [], color=GREEN, label="teeth push only")
    bottom.set(xlabel="pinion speed [rpm]", ylabel=f"peak to peak [{unit}]", ylim=(0.0, None))
    bottom.set_xlim(speed[0], speed[-1])
    mark_operation(bottom, operating_rpm, "")
    if speed[0] <= operating_rpm <= speed[-1]:
        here = float(np.ptp(lumped["dte"].to_numpy()[last])) / factor
        bottom.plot([operating_rpm], [here], "o", color=RED, markersize=5, label="operating point")
    legend_above(bottom, 2 if branches is not None else 3)
    return figure
