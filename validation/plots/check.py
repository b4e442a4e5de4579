"""Figures of a check: every channel over the mesh phase and by mesh orders, the ladder, values over speed."""

from __future__ import annotations

import textwrap

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from validation.files.formatting import percent
from validation.plots.style import (
    BLUE,
    GREY,
    RED,
    legend_outside,
    new_figure,
    one_panel,
    scaled,
    write_beside,
)

#: Characters of a line beside a bar of the ladder.
_WIDTH = 92
#: Height of a rung, of a line of words below it, and of the rest of the figure [inch].
_RUNG, _LINE, _REST = 0.42, 0.13, 0.75


def their_name(role: str) -> str:
    """Return the name of the other model in legends."""
    return "record" if role == "measurement" else "your model"


def motion_figure(data: xr.Dataset) -> Figure:
    """Draw each channel in a row: both motions over the mesh phase, and both amplitudes over the mesh order.

    ``data``: ``validation.check.overlay.figure_data``. The band is the scatter of their samples.
    """
    names = [str(name) for name in data["channel"].to_numpy()]
    theirs_label = their_name(str(data.attrs["role"]))
    figure, axes = new_figure(len(names), 2, height=0.7 + 1.9 * len(names), width_ratios=(1.3, 1.0))
    for (phase_axes, order_axes), name in zip(axes, names, strict=True):
        channel = data.sel(channel=name)
        theirs, ours, scatter = (channel[key].to_numpy() for key in ("theirs", "ours", "scatter"))
        factor, unit = scaled(theirs, ours, unit=str(channel["units"].item()))
        x = channel["phase"].to_numpy()
        edges = (theirs - scatter) / factor, (theirs + scatter) / factor
        phase_axes.fill_between(x, *edges, color=RED, alpha=0.2, linewidth=0)
        dots = {"marker": "o", "markersize": 2.4, "linestyle": "none"}
        phase_axes.plot(x, theirs / factor, color=RED, label=theirs_label, **dots)
        phase_axes.plot(x, ours / factor, color=BLUE, linewidth=1.2, label="spurcheck")
        phase_axes.set(xlabel="mesh cycles since A [-]", ylabel=f"{name} [{unit}]", xlim=(0.0, None))
        words = f"misfit {percent(float(channel['misfit']))}"
        write_beside(phase_axes, words, (0.02, 1.0), (0, 2), "axes fraction", fontsize=8.0)
        order = channel["order"].to_numpy()
        known = np.isfinite(channel["their_orders"].to_numpy())
        width = 0.4 * float(np.diff(order[known]).min(initial=1.0))
        for side, key, colour in ((-0.5, "their_orders", RED), (0.5, "our_orders", BLUE)):
            amplitudes = channel[key].to_numpy()[known] / factor
            order_axes.bar(order[known] + side * width, amplitudes, width=width, color=colour)
        order_axes.set(xlabel="mesh order [-]", ylabel=f"amplitude [{unit}]", ylim=(0.0, None))
    legend_outside(figure, axes[0, 0].get_legend_handles_labels()[0], 2)
    return figure


def ladder_figure(data: xr.Dataset) -> Figure:
    """Draw the misfit after each step of the ladder as bars that fall, with the explanations beside them.

    ``data``: ``validation.check.ladder_data.ladder_data``.
    """
    misfits = 100.0 * data["misfit"].to_numpy()
    texts = [_rung_words(data, j) for j in range(misfits.size)]
    lines = [max(text.count("\n"), 1) for text in texts]
    heights = np.array([_RUNG + _LINE * count for count in lines])
    figure, ax = one_panel(_REST + float(heights.sum()))
    places = np.cumsum(heights) - heights
    limit = 100.0 * float(data.attrs["limit"])
    colours = [BLUE if misfit <= limit else RED for misfit in misfits]
    ax.barh(places, misfits, height=0.16, color=colours, align="edge")
    right = 1.12 * max(float(misfits.max()), limit)  # curves that agree are far below the limit
    ax.set(ylim=(float(heights.sum()), -0.1), xlim=(0.0, right), yticks=[])
    ax.axvline(limit, color=GREY, linewidth=0.8, linestyle="--")
    write_beside(ax, f"limit {limit:.2g} %", (limit, 1.0), (2, 2), ("data", "axes fraction"), color=GREY)
    ax.grid(visible=False, axis="y")
    for place, misfit, text in zip(places, misfits, texts, strict=True):
        write_beside(ax, percent(misfit / 100.0), (misfit, place + 0.08), (3, 0), fontsize=8.5, va="center")
        words_look = {"fontsize": 8.0, "va": "top", "linespacing": 1.25}
        write_beside(ax, text, (0.0, place + 0.18), (2, -1), ("axes fraction", "data"), **words_look)
    ax.set_xlabel("misfit [%]")
    return figure


def _rung_words(data: xr.Dataset, number: int) -> str:
    """Words of a rung: the sentence of the step, and what the curves do not tell apart from it."""
    text = "\n".join(textwrap.wrap(str(data["sentence"][number].item()), _WIDTH))
    others = str(data["alternatives"][number].item())
    if others:
        text += "\n" + "\n".join(textwrap.wrap(f"Not told apart from: {others}", _WIDTH))
    return text


def speed_figure(data: xr.Dataset) -> Figure:
    """Draw each column over the pinion speed, theirs and ours. ``data``: ``SpeedMisfit.table``."""
    names = [str(name) for name in data["column"].to_numpy()]
    figure, axes = new_figure(len(names), 1, height=0.7 + 1.9 * len(names), sharex=True)
    speeds = data["speed"].to_numpy()
    for ax, name in zip(axes[:, 0], names, strict=True):
        column = data.sel(column=name)
        theirs, ours = (column[f"{key}_over_speed"].to_numpy() for key in ("theirs", "ours"))
        factor, unit = scaled(theirs, ours, unit=str(column["units"].item()))
        label = their_name(str(data.attrs["role"]))
        ax.plot(speeds, theirs / factor, color=RED, marker="o", markersize=4, linestyle="none", label=label)
        ax.plot(speeds, ours / factor, color=BLUE, linewidth=1.2, marker="x", markersize=4, label="spurcheck")
        ax.set_ylabel(f"{name} [{unit}]")
        words = f"misfit {percent(float(column['misfit']))}"
        write_beside(ax, words, (0.02, 1.0), (0, 2), "axes fraction", fontsize=8.0)
    axes[-1, 0].set_xlabel("pinion speed [rpm]")
    legend_outside(figure, axes[0, 0].get_legend_handles_labels()[0], 2)
    return figure
