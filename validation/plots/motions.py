"""Motions along and off the line of action, in time and by mesh order."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from lumped import Geometry
from validation.cross_check.metrics import MeshOrders
from validation.plots.style import BLUE, DASHES, RED, legend, mesh_cycles, new_figure, scaled

_PANELS = (("x", "along the line of action"), ("y", "off the line of action"))


def motions_figure(g: Geometry, motion: xr.Dataset) -> Figure:
    """Displacements of both gears about their means, along (LOA) and off (OLOA) the line of action.

    Parameters
    ----------
    g : geometry of the pair
    motion : dataset of ``lumped.steady_state``
    """
    figure, axes = new_figure(1, 2, height=2.7)
    x = mesh_cycles(motion, g)
    for ax, (axis, label) in zip(axes[0], _PANELS, strict=True):
        curves = {gear: motion[f"{axis}_{gear}"].to_numpy() for gear in "pg"}
        moving = {gear: values - values.mean() for gear, values in curves.items()}
        factor, unit = scaled(*moving.values(), unit="m")
        for gear, name, colour, dash in (("p", "pinion", BLUE, DASHES[0]), ("g", "gear", RED, DASHES[1])):
            mean, mean_unit = scaled(curves[gear], unit="m")
            text = f"{name}, mean {curves[gear].mean() / mean:.3g} {mean_unit}"
            ax.plot(x, moving[gear] / factor, color=colour, linestyle=dash, label=text)
        ax.set_xlim(0.0, 1.0)
        ax.set_xlabel("time [mesh cycles]")
        ax.set_ylabel(f"{label}\nabout the mean [{unit}]")
        legend(ax, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=1)
    return figure


def orders_figure(orders: Mapping[str, MeshOrders]) -> Figure:
    """Amplitudes of the displacements by mesh order.

    Parameters
    ----------
    orders : mesh orders of x_p, x_g, y_p, y_g
    """
    figure, axes = new_figure(1, 2, height=2.5)
    for ax, (axis, label) in zip(axes[0], _PANELS, strict=True):
        chosen = {gear: orders[f"{axis}_{gear}"] for gear in "pg"}
        factor, unit = scaled(*(o.amplitude[1:] for o in chosen.values()), unit="m")
        for offset, (gear, name, colour) in zip(
            (-0.2, 0.2), (("p", "pinion", BLUE), ("g", "gear", RED)), strict=True
        ):
            found = chosen[gear]
            ax.bar(
                found.order[1:] + offset, found.amplitude[1:] / factor, width=0.38, color=colour, label=name
            )
        ax.set_xticks(np.asarray(chosen["p"].order[1:]))
        ax.set_xlabel("mesh order [-]")
        ax.set_ylabel(f"{label}\namplitude [{unit}]")
        ax.grid(False, axis="x")
    legend(axes[0, 0], loc="upper right")
    return figure
