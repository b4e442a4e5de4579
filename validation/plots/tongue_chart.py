"""Stability chart with its tongues named, their traced edges and the operating range marked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from floquet.gear.margins import TongueMargin
from floquet.gear.tongues import LabelledRegion
from validation.plots.labels import WHITE_BOX, label_above
from validation.plots.stability import UNSTABLE, stability_figure
from validation.plots.style import BLACK, BLUE, GREY, RED, new_figure


def tongue_chart_figure(
    chart: xr.Dataset,
    y: str,
    regions: Sequence[LabelledRegion | TongueMargin],
    lines: Mapping[str, float] | None = None,
    *,
    point: tuple[float, float] | None = None,
    operating_range: tuple[float, float] | None = None,
) -> Figure:
    """Spectral radius over speed and another axis, every tongue named.

    Parameters
    ----------
    chart : dataset of ``floquet.stability_chart`` over speed_rpm and ``y``
    y : the other axis
    regions : unstable regions of the chart (``floquet.gear.tongues.label_regions``); or, with mesh damping as
        the other axis, the traced tongues (``floquet.gear.margins``), whose edges are then drawn
    lines : label -> predicted speed [rpm] (omega_i +- omega_j)/k, dotted where the tongue is named
    point : operating point (speed, y)
    operating_range : speeds of operation [rpm]
    """
    figure = stability_figure(chart, "speed_rpm", y, point)
    ax = figure.axes[0]
    (low, high), (bottom, top) = ax.get_xlim(), ax.get_ylim()
    largest: dict[str, tuple[float, float]] = {}
    for region in regions:
        if isinstance(region, TongueMargin):
            if region.critical_damping <= bottom:
                continue  # closed below the figure
            name, place, weight = region.label, region.tip_speed, region.critical_damping
            # Tongues thinner than the grid of the chart are seen by their traced edges alone.
            inside = region.damping <= top
            edges = (region.damping[inside], region.left[inside], region.right[inside])
            ax.fill_betweenx(*edges, facecolor=UNSTABLE, edgecolor=BLACK, linewidth=0.8, zorder=0.9)
        else:
            name, place, weight = str(region.label), region.point["speed_rpm"], float(region.nodes)
        if low <= place <= high and weight > largest.get(name, (0.0, 0.0))[1]:
            largest[name] = (place, weight)  # the largest region of a label carries its name
    places, weights = zip(*largest.values(), strict=True) if largest else ((), ())
    label_above(ax, list(largest), places, weights)
    for label, speed in (lines or {}).items():
        if low <= speed <= high and label in largest:
            ax.axvline(speed, color=GREY, linewidth=0.7, linestyle=(0, (1, 2)))
    if operating_range is not None:
        mark_operating_range(ax, operating_range)
    return figure


def mark_operating_range(ax: Axes, speeds: tuple[float, float], *, lower: bool = False) -> None:
    """Bar along the upper (or lower) edge over the speeds of operation [rpm], as far as they are shown."""
    left, right = sorted(ax.get_xlim())
    shown = (max(speeds[0], left), min(speeds[1], right))
    if shown[0] >= shown[1]:
        return
    height = 0.012 if lower else 0.985
    ax.plot(shown, (height, height), transform=ax.get_xaxis_transform(), color=BLACK, linewidth=3.0)
    ax.annotate(
        "operating range", (0.5 * (shown[0] + shown[1]), height), xycoords=("data", "axes fraction"),
        xytext=(0, 4 if lower else -4), textcoords="offset points", ha="center",
        va="bottom" if lower else "top", fontsize=8.0, bbox=WHITE_BOX,
    )  # fmt: skip


def critical_damping_figure(tips: xr.Dataset, damping_ratio: float | None = None) -> Figure:
    """Critical mesh damping of every tongue, by speed and name.

    Parameters
    ----------
    tips : dataset of ``floquet.gear.tongues.critical_damping``
    damping_ratio : mesh damping ratio of the pair, drawn as a line
    """
    figure, axes = new_figure(height=3.2)
    ax = axes[0, 0]
    closed = tips.isel(tongue=np.flatnonzero(tips["closed"].to_numpy()))
    speed, damping = closed["speed"].to_numpy(), 100.0 * closed["critical_damping"].to_numpy()
    ax.vlines(speed, 0.0, damping, color=BLUE, linewidth=1.2)
    ax.plot(speed, damping, "o", color=BLUE, markersize=4)
    ax.set_xlim(ax.get_xlim())
    label_above(ax, list(map(str, closed["label"].to_numpy())), list(speed), list(damping))
    if damping_ratio is not None:
        ax.axhline(100.0 * damping_ratio, color=RED, linewidth=1.0)
        ax.annotate(
            "this pair", (1.0, 100.0 * damping_ratio), xycoords=("axes fraction", "data"), xytext=(-3, 3),
            textcoords="offset points", ha="right", color=RED, fontsize=8.0,
        )  # fmt: skip
    highest = max([*damping, 100.0 * damping_ratio if damping_ratio else 0.0], default=1.0)
    ax.set_ylim(0.0, 1.15 * highest)
    ax.set_xlabel("pinion speed [rpm]")
    ax.set_ylabel("critical mesh damping ratio [%]")
    return figure
