"""Picture of figure 7."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike

from lumped.typing import FloatArray
from validation.paper.figure_record import FigureRecord
from validation.paper.plots.shared import line_handles, twin_lines
from validation.plots.style import BLUE, GREEN, GREY, ORANGE, PURPLE, RED, new_figure, scaled

_LABELS = (BLUE, RED, GREEN, PURPLE)
_ROWS = (("normal_load", "normal load"), ("friction_force", "friction force"))


def draw_figure7(record: FigureRecord) -> Figure:
    """Draw figure 7 from its data: a column per speed, measured points on the panel of their speed."""
    curves = [data for part, data in record.data.items() if not part.startswith("measured")]
    points = [data for part, data in record.data.items() if part.startswith("measured")]
    figure, axes = new_figure(2, len(curves), height=5.2, sharex=True, sharey="row")
    for row, (name, label) in enumerate(_ROWS):
        factor, unit = scaled(*(data[name].to_numpy() for data in curves), unit="N")
        for column, data in enumerate(curves):
            ax = axes[row, column]
            _curves(ax, data, name, factor)
            for measured in points:
                if abs(measured.attrs["speed_rpm"] / data.attrs["speed_rpm"] - 1.0) < 0.05:
                    _points(ax, measured, name, factor)
        axes[row, 0].set_ylabel(f"{label} per pair [{unit}]")
    for ax, data in zip(axes[0], curves, strict=True):
        _roll_angle_axis(ax, data)
    for ax, data in zip(axes[-1], curves, strict=True):
        ax.set_xlabel(f"{data.attrs['speed_rpm']:g} rpm: time since pair A was at A [mesh cycles]")
        ax.set_xlim(0.0, 3.0)
    labels = curves[0]["label"].to_numpy()
    handles = [Line2D([], [], color=c, label=f"pair {n}") for n, c in zip(labels, _LABELS, strict=False)]
    handles += line_handles() if "multibody" in curves[0]["model"] else []
    if points:
        handles.append(
            Line2D([], [], color=ORANGE, marker="s", markersize=3.0, linestyle="none", label="measured")
        )
    figure.legend(handles=handles, loc="outside upper center", ncols=5, frameon=False, fontsize=8.5)
    return figure


def _roll_angle_axis(ax: Axes, data: xr.Dataset) -> None:
    """Add the pinion roll angle of pair A along the top."""
    cycles, roll = data["cycles"].to_numpy(), data["roll_angle"].to_numpy()
    slope = float((roll[-1] - roll[0]) / (cycles[-1] - cycles[0]))
    start = float(roll[0] - slope * cycles[0])

    def to_angle(u: ArrayLike) -> FloatArray:
        return np.asarray(start + slope * np.asarray(u, dtype=float), dtype=np.float64)

    def to_cycles(angle: ArrayLike) -> FloatArray:
        return np.asarray((np.asarray(angle, dtype=float) - start) / slope, dtype=np.float64)

    top = ax.secondary_xaxis("top", functions=(to_angle, to_cycles))
    top.set_xlabel("pinion roll angle of the first pair A [deg]", fontsize=9.0)
    top.tick_params(labelsize=8.5, width=0.6, length=3)


def _curves(ax: Axes, data: xr.Dataset, name: str, factor: float) -> None:
    x = data["cycles"].to_numpy()
    for label, colour in zip(data["label"].to_numpy(), _LABELS, strict=False):
        twin_lines(ax, x, data[name].sel(label=label) / factor, colour)
    ax.axhline(0.0, color=GREY, linewidth=0.6)


def _points(ax: Axes, measured: xr.Dataset, name: str, factor: float) -> None:
    for channel in measured["channel"].to_numpy():
        one = measured.sel(channel=channel)
        if str(one["quantity"].item()) != name:
            continue
        ax.errorbar(
            one["cycles"],
            one["measured"] / factor,
            yerr=one["scatter"] / factor,
            color=ORANGE,
            marker="s",
            markersize=2.5,
            linestyle="none",
            elinewidth=0.6,
            zorder=4,
        )
