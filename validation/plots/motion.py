"""Motion in time and by mesh order: histories, transmission error, tooth forces, displacements."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from lumped import Geometry, mesh_cycle
from lumped.schema.pair import GearPair
from validation.cross_check.metrics import MeshOrders
from validation.plots.style import (
    BLACK,
    BLUE,
    DASHES,
    GREY,
    RED,
    legend,
    legend_above,
    look,
    mark_switches,
    mesh_cycles,
    new_figure,
    scaled,
    switches_in_cycles,
)


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
        bottom.plot(x, row / factor, **look(i), linewidth=1.0, label=f"pair {i}")
    bottom.axhline(0.0, color=GREY, linewidth=0.6)
    bottom.set(ylabel=f"normal load [{unit}]", xlabel="time [mesh cycles]", xlim=(x[0], x[-1]))
    legend_above(bottom, len(load))
    return figure


def transmission_error_figure(pair: GearPair, g: Geometry, motion: xr.Dataset, orders: MeshOrders) -> Figure:
    """Periodic dynamic transmission error: over one mesh cycle, and the amplitudes of its mesh orders.

    Parameters
    ----------
    pair, g : the gear pair and its geometry
    motion : dataset of ``lumped.steady_state``
    orders : mesh orders of ``motion["dte"]``
    """
    figure, axes = new_figure(1, 2, height=2.7, width_ratios=(1.5, 1.0))
    left, right = axes[0]
    dte = motion["dte"].to_numpy()
    factor, unit = scaled(dte, unit="m")
    left.plot(mesh_cycles(motion, g), dte / factor, color=BLUE)
    left.axhline(float(dte.mean()) / factor, color=GREY, linewidth=0.8, linestyle=":")
    left.set(xlim=(0.0, 1.0), xlabel="time [mesh cycles]", ylabel=f"dynamic transmission error [{unit}]")
    mark_switches(left, switches_in_cycles(mesh_cycle(pair)))
    amplitude = orders.amplitude[1:]
    factor, unit = scaled(amplitude, unit="m")
    right.bar(orders.order[1:], amplitude / factor, width=0.6, color=BLUE)
    right.set_xticks(orders.order[1:])
    right.set(xlabel="mesh order [-]", ylabel=f"amplitude [{unit}]")
    right.grid(False, axis="x")
    return figure


def tooth_forces_figure(pair: GearPair, g: Geometry, motion: xr.Dataset) -> Figure:
    """Normal load and friction force per tooth pair and in total, over one mesh cycle.

    Parameters
    ----------
    pair, g : the gear pair and its geometry
    motion : dataset of ``lumped.steady_state``
    """
    figure, axes = new_figure(2, 1, height=4.4, sharex=True)
    x = mesh_cycles(motion, g)
    touching = motion["contact"].to_numpy() > 0
    for ax, name in zip(axes[:, 0], ("normal_load", "friction_force"), strict=True):
        values = motion[name].to_numpy()
        factor, unit = scaled(values, values.sum(axis=0), unit="N")
        ax.plot(x, values.sum(axis=0) / factor, color=BLACK, linewidth=0.9, label="all pairs")
        for i, row in enumerate(values):
            label = f"pair {i}" + (" (ahead)" if i == 0 else "")
            ax.plot(x, np.where(touching[i], row, np.nan) / factor, **look(i), linewidth=1.8, label=label)
        ax.axhline(0.0, color=GREY, linewidth=0.6)
        ax.set_ylabel(f"{name.replace('_', ' ')} [{unit}]")
    marks = switches_in_cycles(mesh_cycle(pair))
    mark_switches(axes[0, 0], marks)
    mark_switches(axes[1, 0], marks, letters=False)
    axes[1, 0].set(xlabel="time [mesh cycles]", xlim=(0.0, 1.0))
    legend_above(axes[0, 0], 4, letters=True)
    return figure


def motions_figure(g: Geometry, motion: xr.Dataset) -> Figure:
    """Displacements of both gears about their means, along (LOA) and off (OLOA) the line of action.

    Parameters
    ----------
    g : geometry of the pair
    motion : dataset of ``lumped.steady_state``
    """
    figure, axes = new_figure(1, 2, height=2.7)
    panels = (("x", "along the line of action"), ("y", "off the line of action"))
    x = mesh_cycles(motion, g)
    for ax, (axis, label) in zip(axes[0], panels, strict=True):
        curves = {gear: motion[f"{axis}_{gear}"].to_numpy() for gear in "pg"}
        moving = {gear: values - values.mean() for gear, values in curves.items()}
        factor, unit = scaled(*moving.values(), unit="m")
        for gear, name, colour, dash in (("p", "pinion", BLUE, DASHES[0]), ("g", "gear", RED, DASHES[1])):
            mean, mean_unit = scaled(curves[gear], unit="m")
            text = f"{name}, mean {curves[gear].mean() / mean:.3g} {mean_unit}"
            ax.plot(x, moving[gear] / factor, color=colour, linestyle=dash, label=text)
        ax.set(xlim=(0.0, 1.0), xlabel="time [mesh cycles]", ylabel=f"{label}\nabout the mean [{unit}]")
        legend(ax, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=1)
    return figure
