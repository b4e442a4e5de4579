"""Teeth that differ: transmission error over a turn, load of each meeting pair, orders with sidebands."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from validation.plots.style import BLUE, RED, legend_above, new_figure, scale_y


def turn_figure(data: xr.Dataset) -> Figure:
    """Draw the transmission error over turns of the pinion, with unlike teeth and with like teeth.

    ``data``: ``dte`` and ``healthy`` over ``turn``.
    """
    figure, axes = new_figure(1, 1, height=2.2)
    ax = axes[0, 0]
    shown = data["dte"].to_numpy()
    factor = scale_y(ax, "transmission error", "m", shown)
    ax.plot(data["turn"], shown / factor, color=BLUE, linewidth=0.6, label="teeth as given")
    ax.plot(data["turn"], data["healthy"] / factor, color=RED, linewidth=0.6, alpha=0.7, label="like teeth")
    ax.set(xlabel="turns of the pinion", xlim=(0.0, float(np.ceil(data["turn"][-1]))))
    legend_above(ax, 2)
    return figure


def loads_figure(data: xr.Dataset) -> Figure:
    """Draw the largest load of each meeting pair, or of each tooth, over the mean mesh force.

    ``data``: ``share`` over ``pinion_tooth`` and ``gear_tooth``, NaN for teeth that never meet; or over
    ``tooth``, with the attributes ``shaft`` and ``healthy``, the value of like teeth.
    """
    words = "largest load over\nmean mesh force [-]"
    share = data["share"].to_numpy()
    figure, axes = new_figure(1, 1, height=2.8 if share.ndim == 2 else 2.2)
    ax = axes[0, 0]
    if share.ndim == 2:
        places = data["gear_tooth"], data["pinion_tooth"]
        image = ax.pcolormesh(*places, share, cmap="viridis", shading="nearest")
        figure.colorbar(image, ax=ax, label=words)
        ax.set(xlabel="tooth of the gear", ylabel="tooth of the pinion")
        ax.grid(visible=False)
        return figure
    ax.bar(data["tooth"], share, color=BLUE, width=0.6, label="teeth as given")
    ax.axhline(data.attrs["healthy"], color=RED, linewidth=1.0, label="like teeth")
    ax.set(xlabel=f"tooth of the {data.attrs['shaft']}", ylabel=words, ylim=(0.0, None))
    legend_above(ax, 2)
    return figure


def sidebands_figure(data: xr.Dataset) -> Figure:
    """Amplitudes of the transmission error over the orders of a shaft, past the second mesh harmonic.

    ``data``: ``amplitude`` and ``healthy`` over ``order``; the attributes ``shaft`` and ``teeth``.
    """
    figure, axes = new_figure(1, 1, height=2.3)
    ax = axes[0, 0]
    teeth = int(data.attrs["teeth"])
    order = data["order"].to_numpy()
    values = data["amplitude"].to_numpy()
    healthy = data["healthy"].to_numpy()
    shown = (np.abs(order - np.round(order)) < 1e-6) & (order > 0.5) & (order < 2.5 * teeth)
    least = max(float(values[shown].max()) * 1e-5, 1e-14)
    factor = scale_y(ax, "amplitude", "m", values)
    shown &= values > least
    ax.vlines(order[shown], least / factor, values[shown] / factor, color=BLUE, label="teeth as given")
    both = shown & (healthy > least)
    ax.plot(order[both], healthy[both] / factor, "o", color=RED, markersize=4, label="like teeth")
    ax.set(yscale="log", ylim=(least / factor, None), xlabel=f"order of the {data.attrs['shaft']}")
    ax.set_xticks([1, teeth, 2 * teeth])
    legend_above(ax, 2)
    return figure
