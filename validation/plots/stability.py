"""Stability: charts with their tongues, boundaries, Campbell diagram."""

from __future__ import annotations

import re
import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import QuadMesh
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from scipy.ndimage import maximum_filter
from scipy.optimize import isotonic_regression

from floquet.gear.chart import LabelledRegion
from floquet.gear.tongues import TongueMargin
from lumped.typing import FloatArray
from validation.plots.maps import COLOURS
from validation.plots.style import (
    BLACK,
    BLUE,
    GREY,
    IN_X,
    RED,
    WIDTH,
    legend,
    legend_above,
    legend_outside,
    look,
    new_figure,
    one_panel,
    write_beside,
)

UNSTABLE = "#f2a26b"
"""Colour of unstable regions."""
#: Behind text that lies on a picture.
WHITE_BOX: dict[str, Any] = {
    "boxstyle": "round,pad=0.2", "facecolor": "white", "edgecolor": "none", "alpha": 0.85,
}  # fmt: skip
#: Predicted lines up to this order are named in a Campbell diagram.
_NAMED_ORDERS = 2
_FONT = 7.5
# Upright labels need their line height; the axes take about five sixths of the figure's width.
_GAP = 1.25 * _FONT / (72.0 * WIDTH * 5.0 / 6.0)


def stability_figure(
    chart: xr.Dataset,
    operating_point: Mapping[str, float] | None = None,
    regions: Sequence[LabelledRegion | TongueMargin] = (),
    lines: Mapping[str, float] | None = None,
) -> Figure:
    """Draw how fast disturbances decay over the axes of a chart, with the edges of instability as lines.

    Unstable regions are hatched, undecided nodes dotted, neutral nodes marked with circles. A cross marks a
    region that is at most two nodes wide: thinner regions may exist beside it. A red dot marks a cell that a
    proof could not decide. A chart of one axis is drawn as a line.

    Parameters
    ----------
    chart : dataset of ``floquet.stability_chart``
    operating_point : name of each axis -> value at the operating point, which is marked
    regions : unstable regions over speed and a second axis, from ``floquet.gear.chart.label_regions``,
        which are named; over mesh damping also traced tongues from ``stability_margins``, whose edges are
        drawn
    lines : label of a tongue -> predicted speed (omega_i +- omega_j)/k [rpm], drawn dotted for named tongues
    """
    dims = map(str, chart["spectral_radius"].dims)
    x, *rest = sorted(dims, key=lambda name: name != "speed_rpm")  # speed runs to the right
    if not rest:
        return _line_figure(chart, x, (operating_point or {}).get(x))
    y = rest[0]
    figure, ax = one_panel(3.4)
    chart = chart.sortby([x, y])
    growth, unit = _growth(chart)
    verdict = chart["verdict"].transpose(y, x).to_numpy()
    undecided = verdict == 0
    neutral = verdict == 2
    xs = chart[x].to_numpy()
    ys = chart[y].to_numpy()
    values = growth.transpose(y, x).to_numpy()
    norm = Normalize(min(float(values.min()), -1e-3), 0.0)
    bar = figure.colorbar(_field(ax, xs, ys, values.clip(max=0.0), norm), ax=ax, pad=0.01)
    bar.set_label(f"growth of a disturbance [{unit}]")
    bar.ax.tick_params(labelsize=8.5)
    bar.outline.set_linewidth(0.5)
    words = "hatched: unstable" + undecided.any().item() * "; dotted: undecided"
    words += neutral.any().item() * "; circles: neutral, proven on the unit circle"
    if "cell_verdict" in chart:
        words += f"; {100.0 * chart.attrs['proven_share']:.2f} % of the area proven, red dots: not proven"
    # Not above the axes: the names of tongues stand there.
    figure.supxlabel(f"{words}; {_certificate(chart)}", fontsize=8.0, color=GREY)
    ax.set(
        xlim=(xs[0], xs[-1]), ylim=(ys[0], ys[-1]), xlabel=axis_label(chart, x), ylabel=axis_label(chart, y)
    )
    ax.grid(False)
    if xs.size > 1 and ys.size > 1:
        # A node with growth 0 counts as far below 0 as its neighbours are above: the edge lies between.
        none = undecided | neutral
        excess = np.where(none, 0.0, np.maximum(values, 0.0))
        decided = np.where(none, -1e-9 - maximum_filter(excess, size=3), values)
        if (decided > 0.0).any():
            _hatch(ax, xs, ys, decided, [0.0, np.inf], UNSTABLE, "////", RED)
            ax.contour(xs, ys, decided, levels=[0.0], colors=[BLACK], linewidths=1.0)
        if undecided.any():
            _hatch(ax, xs, ys, undecided.astype(float), [0.5, 1.5], "none", "...", GREY)
        if neutral.any():
            _hatch(ax, xs, ys, neutral.astype(float), [0.5, 1.5], "none", "o", GREY)
        _mark_thin(ax, chart, x, y)
    if "cell_verdict" in chart:
        i, j = np.nonzero(chart["cell_verdict"].transpose(f"{x}_cell", f"{y}_cell").to_numpy() == 0)
        places = chart[f"{x}_cell"].to_numpy()[i], chart[f"{y}_cell"].to_numpy()[j]
        ax.plot(*places, ".", color=RED, markersize=1.5, markeredgewidth=0.0, zorder=3, label="not proven")
    if operating_point is not None:
        mark_operating_point(ax, (operating_point[x], operating_point[y]))
    if x == "speed_rpm":
        _name_regions(ax, regions, lines or {})
    return figure


def _growth(chart: xr.Dataset) -> tuple[xr.DataArray, str]:
    """Growth rate of the worst disturbance and the unit: 1/s for a gear pair, else per period."""
    radius = chart["spectral_radius"].clip(min=1e-12)
    each = radius.copy(data=np.log(radius.to_numpy()))
    if "mesh_cycles_per_revolution" not in chart.attrs:
        return each, "1/period"
    speed = chart["speed_rpm"] if "speed_rpm" in chart else chart.attrs["operating_speed_rpm"]
    return each * (speed * chart.attrs["mesh_cycles_per_revolution"] / 60.0), "1/s"


def _mark_thin(ax: Axes, chart: xr.Dataset, x: str, y: str) -> None:
    """Mark unstable regions that are at most two nodes wide, over speed or else the first axis."""
    if "region_width" not in chart:
        return
    along = "speed_rpm" if x == "speed_rpm" else str(chart["spectral_radius"].dims[0])
    cell = float(np.diff(chart[along].to_numpy()).max())
    thin = chart["region_width"].to_numpy() <= 2.01 * cell
    places = (chart[f"region_{name}"].to_numpy()[thin] for name in (x, y))
    ax.plot(*places, "x", color=RED, markersize=5, markeredgewidth=1.0, zorder=3)


def _line_figure(chart: xr.Dataset, x: str, value: float | None) -> Figure:
    """Spectral radius over the single axis of a chart."""
    figure, ax = one_panel(2.9)
    radius = chart["spectral_radius"].sortby(x)
    xs = radius[x].to_numpy()
    values = radius.to_numpy()
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


def multipliers_figure(spectrum: xr.Dataset) -> Figure:
    """Draw multipliers beside the unit circle, and growth rates over frequencies.

    ``spectrum``: dataset of ``validation.any_system.spectrum_dataset``. Multipliers that are outside the unit
    circle by more than their bounds are red. Growth rates are 0 where the bounds contain 0.
    """
    figure, axes = new_figure(1, 2, height=3.4)
    left, right = axes[0]
    values = spectrum["multipliers"].to_numpy()
    modulus = np.abs(values)
    bound = spectrum["bound"].to_numpy()
    outside = modulus > 1.0 + bound
    turn = np.linspace(0.0, 2.0 * np.pi, 361)
    left.fill(np.cos(turn), np.sin(turn), facecolor="#eef3f8", edgecolor=BLACK, linewidth=0.8, zorder=0.5)
    growth = np.where(np.abs(modulus - 1.0) <= bound, 0.0, spectrum["growth_rate"].to_numpy())
    frequency = spectrum["frequency"].to_numpy()
    finite = np.isfinite(growth)  # a multiplier that is zero dies at once
    handles: list[Artist] = []
    for part, colour, marker, words in (
        (~outside, BLUE, "o", "modulus up to 1"), (outside, RED, "s", "modulus above 1: grows"),
    ):  # fmt: skip
        if part.any():
            style: dict[str, Any] = {"color": colour, "markersize": 4.5, "label": words}
            handles += left.plot(values[part].real, values[part].imag, marker, **style)
            right.plot(frequency[part & finite], growth[part & finite], marker, **style)
    legend_outside(figure, handles, 2)
    if not growth[finite].any():
        right.set_ylim(-0.1 / spectrum.attrs["period"], 0.1 / spectrum.attrs["period"])
    reach = 1.1 * max(1.0, float(np.abs(values).max()))
    left.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
    left.set(xlabel="real part [-]", ylabel="imaginary part [-]")
    right.axhline(0.0, color=BLACK, linewidth=0.8)
    right.set_xlim(-0.02 / spectrum.attrs["period"], 0.52 / spectrum.attrs["period"])
    right.set(xlabel="frequency [Hz], up to multiples of 1/T", ylabel="growth rate [1/s], unstable above 0")
    figure.supxlabel(
        f"{spectrum.attrs['verdict_words']}; error bounds: {spectrum.attrs['certificate']}",
        fontsize=8.0,
        color=GREY,
    )
    return figure


def _certificate(chart: xr.Dataset) -> str:
    """Words on the error bounds of a chart."""
    kind = str(chart.attrs["certificate"])
    words = f"error bounds: {'partly proven' if kind == 'mixed' else kind}"
    share = float(chart["known"].mean()) if "known" in chart else 1.0
    return words if share == 1.0 else f"{words}; {100.0 * share:.2g} % of nodes evaluated"


def _field(
    ax: Axes, xs: FloatArray, ys: FloatArray, values: FloatArray, norm: Normalize
) -> AxesImage | QuadMesh:
    """Draw values (y, x) at their nodes: an image on an even grid, else a mesh of cells."""
    style: dict[str, Any] = {"cmap": COLOURS, "norm": norm}
    # A grid is even enough if a node was moved onto the operating point by less than half a step.
    steps = [np.abs(v - np.linspace(v[0], v[-1], v.size)) for v in (xs, ys)]
    even = (
        v.size > 1 and distance.max() <= 0.5 * (v[-1] - v[0]) / (v.size - 1)
        for v, distance in zip((xs, ys), steps, strict=True)
    )  # fmt: skip
    if not all(even):
        return ax.pcolormesh(xs, ys, values, **style, shading="nearest", rasterized=True, zorder=0)
    dx = 0.5 * (xs[-1] - xs[0]) / (xs.size - 1)
    dy = 0.5 * (ys[-1] - ys[0]) / (ys.size - 1)
    extent = (xs[0] - dx, xs[-1] + dx, ys[0] - dy, ys[-1] + dy)
    return ax.imshow(values, **style, extent=extent, origin="lower", aspect="auto")


def _hatch(
    ax: Axes,
    xs: FloatArray,
    ys: FloatArray,
    values: FloatArray,
    levels: list[float],
    fill: str,
    hatch: str,
    colour: str,
) -> None:
    with mpl.rc_context({"hatch.color": colour, "hatch.linewidth": 0.7}):
        ax.contourf(xs, ys, values, levels=levels, colors=[fill], hatches=[hatch])


def _name_regions(
    ax: Axes, regions: Sequence[LabelledRegion | TongueMargin], lines: Mapping[str, float]
) -> None:
    """Name each tongue at its largest region. Fill traced tongues, which may be thinner than the grid."""
    low, high = ax.get_xlim()
    bottom, top = ax.get_ylim()
    largest: dict[str, tuple[float, float]] = {}
    for region in regions:
        if isinstance(region, TongueMargin):
            if region.critical_damping <= bottom:
                continue  # closed below the figure
            name = region.label
            place = region.tip_speed
            weight = region.critical_damping
            inside = region.damping <= top
            edges = (region.damping[inside], region.left[inside], region.right[inside])
            ax.fill_betweenx(*edges, facecolor=UNSTABLE, edgecolor=BLACK, linewidth=0.8, zorder=0.9)
        else:
            name = str(region.label)
            place = region.point["speed_rpm"]
            weight = float(region.nodes)
        if low <= place <= high and weight > largest.get(name, (0.0, 0.0))[1]:
            largest[name] = (place, weight)
    places, weights = zip(*largest.values(), strict=True) if largest else ((), ())
    label_above(ax, list(largest), places, weights)
    for label, speed in lines.items():
        if low <= speed <= high and label in largest:
            ax.axvline(speed, color=GREY, linewidth=0.7, linestyle=(0, (1, 2)))


def boundaries_figure(boundaries: xr.Dataset) -> Figure:
    """Draw unstable speeds over another parameter, with the name of every tongue.

    ``boundaries``: dataset of ``floquet.stability_boundaries`` with one more axis.
    """
    (name,) = (str(dim) for dim in boundaries.dims if dim not in ("tongue", "interval", "speed_rpm"))
    figure, ax = one_panel(3.4)
    values = boundaries[name].to_numpy()
    rows: list[tuple[str, float, float]] = []
    for row in range(boundaries.sizes["tongue"]):
        tongue = boundaries.isel(tongue=row)
        lower, upper = (
            tongue[f"interval_{edge}"].transpose(name, ...).to_numpy() for edge in ("lower", "upper")
        )
        for edges in zip(lower.T, upper.T, strict=True):
            ax.fill_betweenx(values, *edges, color=UNSTABLE, linewidth=0.0)
            for edge in edges:  # marks show a tongue that is met at one value alone
                ax.plot(edge, values, color=RED, linewidth=1.0, marker=".", markersize=3.0)
        # Named where the tongue leaves the figure, or at its last value.
        last = int(np.flatnonzero(tongue["present"].to_numpy())[-1])
        rows.append((str(tongue["label"].item()), float(tongue["peak"][last]), np.nanmax(upper - lower)))
    ax.set_ylim(values.min(), values.max())
    if rows:
        low = float(boundaries["lower"].min())
        high = float(boundaries["upper"].max())
        aside = 0.05 * (high - low)
        ax.set_xlim(low - aside, high + aside)
        label_above(ax, *zip(*rows, strict=True))
    else:
        ax.set_xticks([])
        ax.annotate("no speed of the range is unstable", (0.5, 0.5), xycoords="axes fraction", ha="center")
    ax.set(xlabel="pinion speed [rpm]", ylabel=axis_label(boundaries, name))
    return figure


def campbell_figure(diagram: xr.Dataset, operating_rpm: float | None = None) -> Figure:
    """Draw the frequencies of the Floquet solutions, and their decay rates, over pinion speed.

    ``diagram``: dataset of ``floquet.gear.tongues.campbell``.
    """
    figure, axes = new_figure(2, 1, height=5.2, sharex=True, height_ratios=(2.2, 1.0))
    top, bottom = axes[:, 0]
    speed = diagram["speed_rpm"].to_numpy()
    decay = diagram["decay"].to_numpy()
    frequency = diagram["frequency"].to_numpy() / 1e3
    ceiling = 1.12 * float(frequency.max())
    for index, mode in enumerate(diagram["mode"].to_numpy()):
        top.plot(speed, frequency[:, index], label=f"mode {mode}", **look(index), linewidth=1.6)
        bottom.plot(speed, decay[:, index] / 1e3, **look(index), linewidth=1.6)
    for order, line in zip(
        diagram["mesh_order"].to_numpy(), diagram["mesh_frequency"].to_numpy().T / 1e3, strict=True
    ):
        top.plot(speed, line, color=GREY, linewidth=0.8)
        x = min(speed[-1], speed[-1] * ceiling / line[-1])
        if x > speed[0]:
            place = (x, min(line[-1], ceiling))
            write_beside(top, f"{order}×", place, (-2, -8), ha="right", fontsize=7.5, color=GREY)
    named = []
    lines = (diagram[name].to_numpy() for name in ("line_speed", "order", "label"))
    for x, order, label in zip(*lines, strict=True):
        for ax in (top, bottom):
            ax.axvline(x, color=RED, linewidth=0.8 if order <= _NAMED_ORDERS else 0.3, alpha=0.5, zorder=0.5)
        if order <= _NAMED_ORDERS:
            # Sums grow more easily than differences, which only friction makes unstable.
            named.append((str(label), float(x), 1.0 / order - ("-" in label)))
    upper = bottom.get_xaxis_transform()
    red = {"color": RED, "alpha": 0.2, "linewidth": 0}
    bottom.fill_between(speed, 0, 1, where=decay.min(axis=1) < 0.0, transform=upper, **red)
    bottom.axhline(0.0, color=BLACK, linewidth=0.8)
    top.set(ylim=(0.0, ceiling), xlim=(speed[0], speed[-1]), ylabel="frequency [kHz]")
    label_above(bottom, *zip(*named, strict=True)) if named else None
    bottom.set_ylabel("decay rate [1/ms]\n(< 0: unstable)")
    bottom.set_xlabel("pinion speed [rpm]; red: predicted tongues (ω$_i$ ± ω$_j$)/k")
    legend_above(top, 3)
    for ax in (top, bottom):
        mark_operating_value(ax, operating_rpm, "operating point" if ax is top else "")
    top.tick_params(labelbottom=False)
    return figure


def mark_operating_point(ax: Axes, point: tuple[float, float]) -> None:
    """Draw a circle at the point, with words on the side with more space; nothing for a point outside."""
    lowest_x, highest_x = ax.get_xlim()
    lowest_y, highest_y = ax.get_ylim()
    if not (lowest_x <= point[0] <= highest_x and lowest_y <= point[1] <= highest_y):
        return
    style: dict[str, Any] = {"markerfacecolor": "white", "markeredgecolor": BLACK, "markeredgewidth": 1.6}
    ax.plot(*point, marker="o", markersize=8, **style, clip_on=False, zorder=5)
    east = point[0] < 0.5 * (lowest_x + highest_x)
    height = (point[1] - lowest_y) / (highest_y - lowest_y)
    north = height < 0.5
    shift = 7 if north else -7
    aside = (8, "left") if east else (-8, "right")
    va = "bottom" if north else "top"
    write_beside(
        ax, "operating point", point, (aside[0], shift), ha=aside[1], va=va, fontsize=8.5, bbox=WHITE_BOX
    )


def mark_operating_value(ax: Axes, value: float | None, words: str = "operating point") -> None:
    """Draw a dashed line at a value on the x axis, with words; nothing for a value outside."""
    low, high = sorted(ax.get_xlim())
    if value is None or not low <= value <= high:
        return
    ax.axvline(value, color=BLACK, linewidth=1.0, linestyle="--")
    write_beside(ax, words, (value, 0.03), (3, 0), IN_X, rotation=90, va="bottom", bbox=WHITE_BOX)


def axis_label(chart: xr.Dataset, name: str) -> str:
    """Return plain name and unit of an axis of a chart, in lines that fit the height of a figure."""
    attrs = chart[name].attrs
    unit = attrs.get("units", "1")
    return textwrap.fill(f"{attrs.get('long_name', name)} [{'-' if unit == '1' else unit}]", 40)


def spread(places: Sequence[float] | FloatArray, gap: float, low: float, high: float) -> FloatArray:
    """Move increasing places apart to at least ``gap``, within [low, high], by the least sum of squares.

    The new positions q_i + i gap minimise sum (q_i - p_i)^2 for increasing q_i, with p_i = place_i - i gap:
    this is isotonic regression. The gap is smaller where the places do not fit otherwise.
    """
    wanted = np.asarray(places, dtype=float)
    if wanted.size == 0:
        return wanted
    step = min(gap, (high - low) / max(wanted.size - 1, 1))
    offsets = step * np.arange(wanted.size)
    increasing = isotonic_regression(wanted - offsets).x
    return np.asarray(np.clip(increasing, low, high - offsets[-1]) + offsets)


def label_above(ax: Axes, names: Sequence[str], places: Sequence[float], weights: Sequence[float]) -> None:
    """Write names upright above the axes, joined to their places by thin lines.

    The limits along x must be set. Where not all names fit, the names with the largest weights are written.
    """
    low, high = sorted(ax.get_xlim())
    gap = _GAP * (high - low)
    most = int((high - low) / gap)
    shown = sorted(sorted(range(len(names)), key=lambda i: -weights[i])[:most], key=lambda i: places[i])
    upper = ax.get_xaxis_transform()
    thin: dict[str, Any] = {"color": GREY, "linewidth": 0.6, "transform": upper, "clip_on": False}
    words: dict[str, Any] = {"ha": "center", "va": "bottom", "rotation": 90, "fontsize": _FONT}
    for index, x in zip(shown, spread([places[i] for i in shown], gap, low, high), strict=True):
        ax.plot([places[index], x], [1.0, 1.035], **thin, in_layout=False)
        ax.annotate(pretty(names[index]), (x, 1.04), xycoords=upper, **words)


def pretty(label: str) -> str:
    """Return a label as in a text, with omega and indices: 2w3/5 -> 2ω₃/5."""
    digits = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
    indexed = re.sub(r"w(\d*)", lambda found: "ω" + found[1].translate(digits), label)
    return indexed.removesuffix("/1").replace("-", "−")
