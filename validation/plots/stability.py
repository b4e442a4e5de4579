"""Stability charts: spectral radius, or what a friction law changes in growth, over two parameters."""

from __future__ import annotations

import textwrap
from typing import Literal

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from scipy.ndimage import maximum_filter

from lumped.typing import BoolArray, FloatArray
from validation.plots.labels import WHITE_BOX
from validation.plots.style import BLACK, GREY, IN_X, RED, legend, one_panel, write_beside

#: Blue for fast decay to white at the boundary.
_STABLE = LinearSegmentedColormap.from_list("decay", ["#08519c", "#6baed6", "#f7fbff"])
UNSTABLE = "#f2a26b"
"""Fill of what is unstable: orange, of a grey between the blues of what is stable."""


def stability_figure(chart: xr.Dataset, x: str, y: str, point: tuple[float, float] | None) -> Figure:
    """Spectral radius over two axes of a chart; unstable regions hatched, undecided ones dotted.

    Parameters
    ----------
    chart : dataset of ``floquet.stability_chart`` over exactly the axes ``x`` and ``y``
    x, y : names of its axes
    point : operating point (x, y); None: not marked
    """
    radius = chart["spectral_radius"].transpose(y, x).sortby([x, y])
    undecided = (chart["verdict"] == 0).transpose(y, x).sortby([x, y])
    norm = Normalize(min(float(radius.min()), 0.999), 1.0)
    words = "spectral radius [-]; unstable above 1 (hatched)" + undecided.any().item() * "\nundecided: dotted"
    figure, ax = field_figure(radius.clip(max=1.0), chart, norm, _STABLE, words)
    xs, ys = radius[x].to_numpy(), radius[y].to_numpy()
    mark_unstable(ax, xs, ys, _decided(radius.to_numpy(), undecided.to_numpy()))
    _mark_undecided(ax, xs, ys, undecided.to_numpy())
    mark_operating_point(ax, point)
    return figure


def field_figure(
    values: xr.DataArray,
    chart: xr.Dataset,
    norm: Normalize,
    colours: mpl.colors.Colormap | str,
    words: str,
    extend: Literal["neither", "both"] = "neither",
) -> tuple[Figure, Axes]:
    """Return a figure of values over two axes of a chart, with its colour bar, and its axes.

    Parameters
    ----------
    values : over the vertical and the horizontal axis, rising
    chart : has the names of the axes
    norm, colours : of the values
    words : beside the colour bar, before what the errors behind the chart are
    extend : ends of the colour bar beyond which there are values
    """
    figure, ax = one_panel(3.4)
    y, x = map(str, values.dims)
    xs, ys = values[x].to_numpy(), values[y].to_numpy()
    drawn = field(ax, xs, ys, values.to_numpy(), norm, colours)
    ax.set(xlim=(xs[0], xs[-1]), ylim=(ys[0], ys[-1]))
    bar = figure.colorbar(drawn, ax=ax, pad=0.01, extend=extend)
    # Not above the axes: the names of tongues stand there.
    bar.set_label(f"{words}\n{_certificate(chart)}", fontsize=8.5)
    bar.outline.set_linewidth(0.5)
    ax.set(xlabel=axis_label(chart, x), ylabel=axis_label(chart, y))
    ax.grid(False)
    return figure, ax


def stability_line_figure(chart: xr.Dataset, x: str, value: float | None) -> Figure:
    """Spectral radius along one axis of a chart.

    Parameters
    ----------
    chart : dataset of ``floquet.stability_chart`` over exactly the axis ``x``
    x : its name
    value : of the operating point; None: not marked
    """
    figure, ax = one_panel(2.9)
    radius = chart["spectral_radius"].sortby(x)
    xs, values = radius[x].to_numpy(), radius.to_numpy()
    ax.plot(xs, values, color="#08519c", linewidth=1.2)
    undecided = (chart["verdict"].sortby(x) == 0).to_numpy()
    if undecided.any():
        ax.plot(xs[undecided], values[undecided], ".", color=GREY, markersize=4, label="undecided")
        legend(ax, loc="best")
    ax.axhline(1.0, color=BLACK, linewidth=0.8)
    ax.fill_between(xs, 1.0, np.maximum(values, 1.0), color=UNSTABLE, linewidth=0.0)
    ax.set_xlim(xs[0], xs[-1])
    mark_operating_value(ax, value)
    ax.set_title(_certificate(chart), loc="right", fontsize=7.5, color=GREY)
    ax.set(xlabel=axis_label(chart, x), ylabel="spectral radius [-], unstable above 1")
    return figure


def _certificate(chart: xr.Dataset) -> str:
    """What the errors behind a chart are, in words."""
    kind = str(chart.attrs["certificate"])
    return f"error bounds: {'partly proven' if kind == 'mixed' else kind}"


def field(
    ax: Axes,
    xs: FloatArray,
    ys: FloatArray,
    values: FloatArray,
    norm: Normalize,
    colours: mpl.colors.Colormap | str,
) -> AxesImage | QuadMesh:
    """Draw values (y, x) at their nodes: an image on an even grid, however large, or else a mesh of cells."""
    even = all(v.size > 1 and np.allclose(np.diff(v), (v[-1] - v[0]) / (v.size - 1)) for v in (xs, ys))
    if not even:
        return ax.pcolormesh(
            xs, ys, values, cmap=colours, norm=norm, shading="nearest", rasterized=True, zorder=0
        )
    dx, dy = 0.5 * (xs[1] - xs[0]), 0.5 * (ys[1] - ys[0])
    return ax.imshow(
        values,
        cmap=colours,
        norm=norm,
        extent=(xs[0] - dx, xs[-1] + dx, ys[0] - dy, ys[-1] + dy),
        origin="lower",
        aspect="auto",
    )


def mark_unstable(ax: Axes, xs: FloatArray, ys: FloatArray, radius: FloatArray) -> None:
    """Fill, hatch and edge the region of radius (y, x) above 1."""
    if xs.size < 2 or ys.size < 2 or not (radius > 1.0).any():
        return
    with mpl.rc_context({"hatch.color": RED, "hatch.linewidth": 0.7}):
        ax.contourf(xs, ys, radius, levels=[1.0, np.inf], colors=[UNSTABLE], hatches=["////"])
    ax.contour(xs, ys, radius, levels=[1.0], colors=[BLACK], linewidths=1.0)


def _decided(radius: FloatArray, undecided: BoolArray) -> FloatArray:
    """Radius (y, x), what is undecided as far below 1 as its neighbours are above: the edge lies between."""
    excess = np.where(undecided, 0.0, np.maximum(radius - 1.0, 0.0))
    return np.where(undecided, 1.0 - 1e-9 - maximum_filter(excess, size=3), radius)


def _mark_undecided(ax: Axes, xs: FloatArray, ys: FloatArray, undecided: BoolArray) -> None:
    """Dot the region (y, x) in which the bound on the error contains 1."""
    if xs.size < 2 or ys.size < 2 or not undecided.any():
        return
    with mpl.rc_context({"hatch.color": GREY, "hatch.linewidth": 0.5}):
        ax.contourf(xs, ys, undecided.astype(float), levels=[0.5, 1.5], colors=["none"], hatches=["..."])


def mark_operating_point(ax: Axes, point: tuple[float, float] | None) -> None:
    """Circle at the point and its name beside it, on the side where there is room; nothing when outside."""
    if point is None:
        return
    (left, right), (bottom, top) = ax.get_xlim(), ax.get_ylim()
    if not (left <= point[0] <= right and bottom <= point[1] <= top):
        return
    ax.plot(
        *point, marker="o", markersize=8, markerfacecolor="white", markeredgecolor=BLACK,
        markeredgewidth=1.6, clip_on=False, zorder=5,
    )  # fmt: skip
    east = point[0] < 0.5 * (left + right)
    height = (point[1] - bottom) / (top - bottom)
    north = height < 0.5
    # Below the bar of the operating range, which runs along the upper edge.
    shift = 7 if north else -7 if height < 0.9 else -22
    aside, va = (8, "left") if east else (-8, "right"), "bottom" if north else "top"
    write_beside(
        ax, "operating point", point, (aside[0], shift), ha=aside[1], va=va, fontsize=8.5, bbox=WHITE_BOX
    )


def mark_operating_value(ax: Axes, value: float | None) -> None:
    """Dashed line at the operating point's value on the x axis, named beside it; nothing when outside."""
    low, high = sorted(ax.get_xlim())
    if value is None or not low <= value <= high:
        return
    ax.axvline(value, color=BLACK, linewidth=1.0, linestyle="--")
    look = {"rotation": 90, "va": "bottom", "bbox": WHITE_BOX}
    write_beside(ax, "operating point", (value, 0.03), (3, 0), IN_X, **look)


def mark_operating_range(ax: Axes, speeds: tuple[float, float] | None, *, lower: bool = False) -> None:
    """Bar along the upper (or lower) edge over the speeds of operation [rpm], if any, as far as shown."""
    if speeds is None:
        return
    left, right = sorted(ax.get_xlim())
    shown = (max(speeds[0], left), min(speeds[1], right))
    if shown[0] >= shown[1]:
        return
    height, shift, va = (0.012, 4, "bottom") if lower else (0.985, -4, "top")
    ax.plot(shown, (height, height), transform=ax.get_xaxis_transform(), color=BLACK, linewidth=3.0)
    place = (0.5 * (shown[0] + shown[1]), height)
    write_beside(ax, "operating range", place, (0, shift), IN_X, ha="center", va=va, bbox=WHITE_BOX)


def axis_label(chart: xr.Dataset, name: str) -> str:
    """Plain name and unit of an axis of a chart, in lines that fit the height of a figure."""
    attrs = chart[name].attrs
    unit = attrs.get("units", "1")
    return textwrap.fill(f"{attrs.get('long_name', name)} [{'-' if unit == '1' else unit}]", 40)
