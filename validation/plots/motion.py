"""Motion in time, by mesh order and over speed; measured points beside it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lumped import Geometry, mesh_cycle
from lumped.model.steady import UNSTABLE
from lumped.schema.pair import GearPair
from validation.cross_check.metrics import MeshOrders
from validation.plots.style import (
    BLACK,
    BLUE,
    DASHES,
    GREEN,
    GREY,
    LINES,
    RED,
    legend,
    legend_above,
    legend_outside,
    look,
    mark_operation,
    mark_switches,
    mesh_cycles,
    new_figure,
    scale_y,
    scaled,
    switches_in_cycles,
)


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
    static_load : T_p/r_bp; where the smallest load is negative beside it, contact is lost [N]
    branches : ``dataset`` of ``floquet.response_branches``, of which the stable motions are drawn
    """
    figure, axes = new_figure(2, 1, height=4.9)
    figure.set_figwidth(4.6)
    top, bottom = axes[:, 0]
    time = lumped["time"].to_numpy()
    last = time >= time[-1] - (1.0 + 1e-9) * period
    x = (time[last] - time[last][0]) / period
    here = lumped["dte"].to_numpy()[last]
    factor = scale_y(top, "transmission error", "m", here)
    top.plot(x, here / factor, color=BLUE, linewidth=2.6, alpha=0.5, label="this model")
    other = multibody["dte"].to_numpy()[last]
    top.plot(x, other / factor, color=RED, linewidth=1.1, label="independent model")
    top.set(xlabel="time [mesh cycles]", xlim=(0.0, 1.0))
    legend_above(top, 2)
    speed, values = sweep["speed"].to_numpy(), sweep["dte_peak_to_peak"].to_numpy()
    wrong = sweep["normal_load_min"].to_numpy() < -1e-9 * static_load
    wrong |= sweep["spectral_radius"].to_numpy() > UNSTABLE
    factor = scale_y(bottom, "peak to peak", "m", values)
    bottom.plot(speed, np.where(wrong, np.nan, values) / factor, color=BLUE, label="holds")
    if wrong.any():
        dotted: dict[str, Any] = {"color": GREY, "linewidth": 0.9, "linestyle": ":", "zorder": 1.5}
        bottom.plot(speed, values / factor, label="not as computed", **dotted)
    if branches is not None:
        for number in np.unique(branches["branch"]):
            one = branches.isel(point=branches["branch"].to_numpy() == number)
            stable = np.where(one["stable"], one["dte_peak_to_peak"] / factor, np.nan)
            bottom.plot(one["speed_rpm"], stable, color=GREEN)
        bottom.plot([], [], color=GREEN, label="unilateral contact")
    bottom.set(xlabel="pinion speed [rpm]", ylim=(0.0, None), xlim=(speed[0], speed[-1]))
    mark_operation(bottom, operating_rpm, "")
    if speed[0] <= operating_rpm <= speed[-1]:
        point = float(np.ptp(here)) / factor
        bottom.plot([operating_rpm], [point], "o", color=RED, markersize=5, label="operating point")
    legend_above(bottom, 2 if branches is not None else 3)
    return figure


def history_figure(g: Geometry, result: xr.Dataset) -> Figure:
    """Transmission error, and normal load per tooth pair, over the time of a run.

    ``result``: dataset of ``simulate`` or ``steady_state`` of either model.
    """
    figure, axes = new_figure(2, 1, height=4.2, sharex=True)
    top, bottom = axes[:, 0]
    x, dte = mesh_cycles(result, g), result["dte"].to_numpy()
    top.plot(x, dte / scale_y(top, "transmission error", "m", dte), color=BLUE, linewidth=1.0)
    load = np.where(result["contact"].to_numpy() > 0, result["normal_load"].to_numpy(), np.nan)
    factor = scale_y(bottom, "normal load", "N", load)
    for i, row in enumerate(load):
        bottom.plot(x, row / factor, **look(i), linewidth=1.0, label=f"pair {i}")
    bottom.axhline(0.0, color=GREY, linewidth=0.6)
    bottom.set(xlabel="time [mesh cycles]", xlim=(x[0], x[-1]))
    legend_above(bottom, len(load))
    return figure


def transmission_error_figure(pair: GearPair, g: Geometry, motion: xr.Dataset, orders: MeshOrders) -> Figure:
    """Periodic dynamic transmission error: over one mesh cycle, and the amplitudes of its mesh orders.

    ``motion``: dataset of ``lumped.steady_state``; ``orders``: mesh orders of ``motion["dte"]``.
    """
    figure, axes = new_figure(1, 2, height=2.7, width_ratios=(1.5, 1.0))
    left, right = axes[0]
    dte = motion["dte"].to_numpy()
    factor = scale_y(left, "dynamic transmission error", "m", dte)
    left.plot(mesh_cycles(motion, g), dte / factor, color=BLUE)
    left.axhline(float(dte.mean()) / factor, color=GREY, linewidth=0.8, linestyle=":")
    left.set(xlim=(0.0, 1.0), xlabel="time [mesh cycles]")
    mark_switches(left, switches_in_cycles(mesh_cycle(pair)))
    amplitude = orders.amplitude[1:]
    heights = amplitude / scale_y(right, "amplitude", "m", amplitude)
    right.bar(orders.order[1:], heights, width=0.6, color=BLUE)
    right.set_xticks(orders.order[1:])
    right.set(xlabel="mesh order [-]")
    right.grid(False, axis="x")
    return figure


def tooth_forces_figure(pair: GearPair, g: Geometry, motion: xr.Dataset) -> Figure:
    """Normal load and friction force per tooth pair and in total, over one mesh cycle.

    ``motion``: dataset of ``lumped.steady_state``.
    """
    figure, axes = new_figure(2, 1, height=4.4, sharex=True)
    x = mesh_cycles(motion, g)
    touching = motion["contact"].to_numpy() > 0
    for ax, name in zip(axes[:, 0], ("normal_load", "friction_force"), strict=True):
        values = motion[name].to_numpy()
        factor = scale_y(ax, name.replace("_", " "), "N", values, values.sum(axis=0))
        ax.plot(x, values.sum(axis=0) / factor, color=BLACK, linewidth=0.9, label="all pairs")
        for i, row in enumerate(values):
            label = f"pair {i}" + (" (ahead)" if i == 0 else "")
            ax.plot(x, np.where(touching[i], row, np.nan) / factor, **look(i), linewidth=1.8, label=label)
        ax.axhline(0.0, color=GREY, linewidth=0.6)
        mark_switches(ax, switches_in_cycles(mesh_cycle(pair)), letters=ax is axes[0, 0])
    axes[1, 0].set(xlabel="time [mesh cycles]", xlim=(0.0, 1.0))
    legend_above(axes[0, 0], 4, letters=True)
    return figure


def motions_figure(g: Geometry, motion: xr.Dataset) -> Figure:
    """Displacements of both gears about their means, along (LOA) and off (OLOA) the line of action.

    ``motion``: dataset of ``lumped.steady_state``.
    """
    figure, axes = new_figure(1, 2, height=2.7)
    x = mesh_cycles(motion, g)
    for ax, axis, label in zip(axes[0], "xy", ("along", "off"), strict=True):
        curves = {gear: motion[f"{axis}_{gear}"].to_numpy() for gear in "pg"}
        moving = {gear: values - values.mean() for gear, values in curves.items()}
        factor = scale_y(ax, f"{label} the line of action\nabout the mean", "m", *moving.values())
        for gear, name, colour, dash in (("p", "pinion", BLUE, DASHES[0]), ("g", "gear", RED, DASHES[1])):
            mean, mean_unit = scaled(curves[gear], unit="m")
            text = f"{name}, mean {curves[gear].mean() / mean:.3g} {mean_unit}"
            ax.plot(x, moving[gear] / factor, color=colour, linestyle=dash, label=text)
        ax.set(xlim=(0.0, 1.0), xlabel="time [mesh cycles]")
        legend(ax, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=1)
    return figure


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
    speed, values = sweep["speed"].to_numpy(), sweep["dte_peak_to_peak"].to_numpy()
    factor = scale_y(top, "transmission error,\npeak to peak", "m", values)
    top.plot(speed, values / factor, color=BLUE)
    unstable = sweep["spectral_radius"].to_numpy() > UNSTABLE
    if unstable.any():
        top.plot(speed[unstable], values[unstable] / factor, "x", color=RED, markersize=4.5)
    top.set_ylim(0.0, None)
    low = sweep["normal_load_min"].to_numpy() / static_load
    bottom.plot(speed, sweep["normal_load_max"].to_numpy() / static_load, color=BLUE, label="largest")
    bottom.plot(speed, low, color=LINES[2], linestyle="--", label="smallest")
    apart = np.nan_to_num(low) < 0.0
    if apart.any():
        shade: dict[str, Any] = {"color": RED, "alpha": 0.3, "linewidth": 0}
        bottom.fill_between(speed, low, 0.0, where=apart, **shade, label="contact loss: not valid")
    bottom.axhline(0.0, color=GREY, linewidth=0.6)
    bottom.set(ylabel="tooth load over\nstatic load [-]", xlabel="pinion speed [rpm]")
    bottom.set_xlim(speed[0], speed[-1])
    mark_operation(top, operating_rpm, "operating point")
    mark_operation(bottom, operating_rpm, "")
    for ax in (top, bottom):
        for place in resonances_rpm:
            if speed[0] <= place <= speed[-1]:
                ax.axvline(place, color=GREY, linewidth=0.7, linestyle=":")
    legend_above(bottom, 3)
    return figure


def overlay_figure(points: xr.Dataset) -> Figure:
    """Measured means per phase bin with their scatter, and the prediction, over the mesh phase.

    ``points``: of ``validation.measurements.overlay``.
    """
    names = [str(name) for name in points["channel"].to_numpy()]
    columns = min(len(names), 2)
    rows = -(-len(names) // columns)
    figure, axes = new_figure(rows, columns, height=0.6 + 2.3 * rows)
    panels: list[Axes] = axes.ravel().tolist()
    for ax in panels[len(names) :]:
        ax.set_visible(False)
    for ax, name in zip(panels, names, strict=False):
        one = points.sel(channel=name)
        x, measured, predicted, scatter = (
            one[key].to_numpy() for key in ("phase", "measured", "predicted", "scatter")
        )
        factor = scale_y(ax, name, str(one["units"].item()), measured, predicted)
        edges = (measured - scatter) / factor, (measured + scatter) / factor
        ax.fill_between(x, *edges, color=RED, alpha=0.2, linewidth=0)
        dots: dict[str, Any] = {"marker": "o", "markersize": 2.4, "linestyle": "none"}
        ax.plot(x, measured / factor, color=RED, **dots, label="measured")
        ax.plot(x, predicted / factor, color=BLUE, linewidth=1.2, label="predicted")
        ax.axhline(0.0, color=GREY, linewidth=0.6)
        ax.set(xlim=(0.0, float(np.ceil(10 * x[-1]) / 10)), xlabel="mesh cycles since the pair was at A")
    legend_outside(figure, panels[0].get_legend_handles_labels()[0], 2)
    return figure
