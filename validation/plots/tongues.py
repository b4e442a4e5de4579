"""Tongues of instability: named in a chart, traced over a parameter, and zones of one degree of freedom."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from floquet.gear.tongues import LabelledRegion, StabilityMargins, TongueMargin
from validation.plots.labels import label_above
from validation.plots.stability import (
    UNSTABLE,
    axis_label,
    mark_operating_point,
    mark_operating_range,
    stability_figure,
)
from validation.plots.style import BLACK, GREY, RED, one_panel


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
        the other axis, the traced tongues (``floquet.gear.tongues``), whose edges are then drawn
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
    mark_operating_range(ax, operating_range)
    return figure


def tongues_figure(margins: StabilityMargins, operating_range: tuple[float, float] | None = None) -> Figure:
    """Edges of every tongue from zero mesh damping to the damping that closes it.

    Parameters
    ----------
    margins : of ``floquet.gear.tongues.stability_margins``
    operating_range : speeds of operation [rpm]
    """
    figure, ax = one_panel(3.2)
    ax.set(xlim=margins.speed_range, ylim=(0.0, 1.25 * max(margins.critical_damping, margins.damping, 1e-3)))
    for tongue in margins.tongues:
        ax.fill_betweenx(
            tongue.damping, tongue.left, tongue.right, color=UNSTABLE, edgecolor=RED, linewidth=1.0
        )
    label_above(
        ax,
        [t.label for t in margins.tongues],
        [t.tip_speed for t in margins.tongues],
        [t.critical_damping for t in margins.tongues],
    )
    ax.axhline(margins.damping, color=GREY, linewidth=0.8, linestyle=(0, (4, 2)))
    mark_operating_point(ax, (margins.rpm, margins.damping))
    mark_operating_range(ax, operating_range)
    ax.set(xlabel="pinion speed [rpm]", ylabel="mesh damping ratio [-]")
    return figure


def boundaries_figure(
    found: xr.Dataset, name: str, operating_range: tuple[float, float] | None = None
) -> Figure:
    """Unstable speeds over another parameter, every tongue named.

    Parameters
    ----------
    found : dataset of ``floquet.stability_boundaries`` with one more axis
    name : that axis
    operating_range : speeds of operation [rpm]
    """
    figure, ax = one_panel(3.4)
    values = found[name].to_numpy()
    names, places, widths = [], [], []
    for row in range(found.sizes["tongue"]):
        tongue = found.isel(tongue=row)
        here = tongue["present"].to_numpy()
        lower, upper = (
            tongue[f"interval_{edge}"].transpose(name, ...).to_numpy() for edge in ("lower", "upper")
        )
        for edges in zip(lower.T, upper.T, strict=True):
            ax.fill_betweenx(values, *edges, color=UNSTABLE, linewidth=0.0)
            for edge in edges:  # marks show a tongue that is met at one value alone
                ax.plot(edge, values, color=RED, linewidth=1.0, marker=".", markersize=3.0)
        # Named where the tongue leaves the figure, or at its last value.
        last = int(np.flatnonzero(here)[-1])
        names.append(str(tongue["label"].item()))
        places.append(float(tongue["peak"][last]))
        widths.append(float(np.nanmax(upper - lower)))
    ax.set_ylim(values.min(), values.max())
    if names:
        low, high = float(found["lower"].min()), float(found["upper"].max())
        aside = 0.05 * (high - low)
        ax.set_xlim(low - aside, high + aside)
        label_above(ax, names, places, widths)
    else:
        ax.set_xticks([])
        ax.annotate("no speed of the range is unstable", (0.5, 0.5), xycoords="axes fraction", ha="center")
    mark_operating_range(ax, operating_range)
    ax.set(xlabel="pinion speed [rpm]", ylabel=axis_label(found, name))
    return figure
