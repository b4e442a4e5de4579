"""Motion in time and over speed; the multibody model and measured points beside it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from lumped import Geometry
from lumped.model.steady import UNSTABLE
from validation.plots.style import (
    BLACK,
    BLUE,
    DOTTED,
    GREEN,
    GREY,
    RED,
    legend_above,
    legend_outside,
    look,
    mark_operation,
    mesh_cycles,
    new_figure,
    scale_y,
)

#: Mesh cycles of both models that are shown.
_SHOWN_CYCLES = 2


def history_figure(g: Geometry, result: xr.Dataset) -> Figure:
    """Draw the transmission error, and the normal load of each tooth pair, over the time of a run.

    ``result``: dataset of ``simulate`` or ``steady_state`` of either model.
    """
    figure, axes = new_figure(2, 1, height=4.2, sharex=True)
    top, bottom = axes[:, 0]
    x = mesh_cycles(result, g)
    dte = result["dte"].to_numpy()
    top.plot(x, dte / scale_y(top, "transmission error", "m", dte), color=BLUE, linewidth=1.0)
    load = np.where(result["contact"].to_numpy() > 0, result["normal_load"].to_numpy(), np.nan)
    factor = scale_y(bottom, "normal load", "N", load)
    for i, row in enumerate(load):
        bottom.plot(x, row / factor, **look(i), linewidth=1.0, label=f"pair {i}")
    bottom.axhline(0.0, color=GREY, linewidth=0.6)
    bottom.set(xlabel="time [mesh cycles]", xlim=(x[0], x[-1]))
    legend_above(bottom, len(load))
    return figure


def sweep_figure(sweep: xr.Dataset, operating_rpm: float, static_load: float) -> Figure:
    """Draw the peak to peak of the transmission error, and the largest and smallest tooth load, over speed.

    Crosses mark unstable motions. ``sweep``: result of ``lumped.speed_sweep``; ``static_load``: T_p/r_bp
    [N], by which loads are divided.
    """
    figure, axes = new_figure(2, 1, height=4.2, sharex=True)
    top, bottom = axes[:, 0]
    speed = sweep["speed"].to_numpy()
    values = sweep["dte_peak_to_peak"].to_numpy()
    factor = scale_y(top, "transmission error,\npeak to peak", "m", values)
    top.plot(speed, values / factor, color=BLUE)
    unstable = sweep["spectral_radius"].to_numpy() > UNSTABLE
    if unstable.any():
        top.plot(speed[unstable], values[unstable] / factor, "x", color=RED, markersize=4.5)
    top.set_ylim(0.0, None)
    low = sweep["normal_load_min"].to_numpy() / static_load
    bottom.plot(speed, sweep["normal_load_max"].to_numpy() / static_load, color=BLUE, label="largest")
    bottom.plot(speed, low, color=GREEN, linestyle="--", label="smallest")
    apart = np.nan_to_num(low) < 0.0
    if apart.any():
        shade: dict[str, Any] = {"color": RED, "alpha": 0.3, "linewidth": 0}
        bottom.fill_between(speed, low, 0.0, where=apart, **shade, label="contact loss: not valid")
    bottom.axhline(0.0, color=GREY, linewidth=0.6)
    bottom.set(ylabel="tooth load over\nstatic load [-]", xlabel="pinion speed [rpm]")
    bottom.set_xlim(speed[0], speed[-1])
    mark_operation(top, operating_rpm, "operating point")
    mark_operation(bottom, operating_rpm, "")
    legend_above(bottom, 3)
    return figure


def overlay_figure(points: xr.Dataset) -> Figure:
    """Draw their curves and ours over the mesh phase: their means with their scatter, and our motion."""
    name_of_theirs = "record" if points.attrs["role"] == "measurement" else "your model"
    names = [str(name) for name in points["channel"].to_numpy()]
    columns = min(len(names), 2)
    rows = -(-len(names) // columns)
    figure, axes = new_figure(rows, columns, height=0.6 + 2.3 * rows)
    panels: list[Axes] = axes.ravel().tolist()
    for ax in panels[len(names) :]:
        ax.set_visible(False)
    for ax, name in zip(panels, names, strict=False):
        one = points.sel(channel=name)
        x, theirs, ours, scatter = (one[key].to_numpy() for key in ("phase", "theirs", "ours", "scatter"))
        factor = scale_y(ax, name, str(one["units"].item()), theirs, ours)
        edges = (theirs - scatter) / factor, (theirs + scatter) / factor
        ax.fill_between(x, *edges, color=RED, alpha=0.2, linewidth=0)
        dots: dict[str, Any] = {"marker": "o", "markersize": 2.4, "linestyle": "none"}
        ax.plot(x, theirs / factor, color=RED, **dots, label=name_of_theirs)
        ax.plot(x, ours / factor, color=BLUE, linewidth=1.2, label="spurcheck")
        ax.axhline(0.0, color=GREY, linewidth=0.6)
        ax.set(xlim=(0.0, float(np.ceil(10 * x[-1]) / 10)), xlabel="mesh cycles since the pair was at A")
    legend_outside(figure, panels[0].get_legend_handles_labels()[0], 2)
    return figure


def cross_check_figure(
    g: Geometry, reference: xr.Dataset, others: Mapping[str, xr.Dataset], keep: NDArray[np.bool_]
) -> Figure:
    """Draw the transmission error of all models over the last mesh cycles, and the differences to ``lumped``.

    ``others``: fidelity -> multibody motion at the times of ``reference``; ``keep``: whether a time is off
    the switches. A time at a switch may belong to either side of a jump: no difference is drawn there.
    """
    figure, axes = new_figure(2, 1, height=3.9, sharex=True, height_ratios=(1.6, 1.0))
    top, bottom = axes[:, 0]
    time = reference["time"].to_numpy()
    shown = time >= time[-1] - (_SHOWN_CYCLES + 1e-9) * g.mesh_period
    x = (time[shown] - time[shown][0]) / g.mesh_period
    base = reference["dte"].to_numpy()[shown]
    factor = scale_y(top, "transmission error", "m", base)
    top.plot(x, base / factor, color=BLACK, linewidth=2.6, alpha=0.35, label="lumped")
    colours = {"linear": BLUE, "exact": RED}
    dashes = {"linear": DOTTED, "exact": "-"}
    for name, result in others.items():
        look_of: dict[str, Any] = {"color": colours[name], "linestyle": dashes[name], "linewidth": 1.2}
        top.plot(x, result["dte"].to_numpy()[shown] / factor, **look_of, label=f"multibody {name}")
    # The linear difference is integration error, nine decades down: it is a number in the table, not a curve.
    drawn = [name for name in others if name != "linear"] or list(others)
    differences = [
        np.where(keep[shown], others[name]["dte"].to_numpy()[shown] - base, np.nan) for name in drawn
    ]
    factor = scale_y(bottom, f"{' and '.join(drawn)} -\nlumped", "m", *differences)
    for name, difference in zip(drawn, differences, strict=True):
        bottom.plot(x, difference / factor, color=colours[name], linewidth=1.0)
    bottom.axhline(0.0, color=BLACK, linewidth=0.5)
    bottom.set(xlabel="time, last cycles of the run [mesh cycles]", xlim=(0.0, _SHOWN_CYCLES))
    legend_above(top, 1 + len(others))
    return figure
