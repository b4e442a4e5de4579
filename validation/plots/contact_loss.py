"""Motions beyond contact loss: branches over speed, and the map of jumps over speed and a second axis."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.colors import BoundaryNorm, ListedColormap, LogNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from lumped.typing import FloatArray
from validation.plots.stability import axis_label
from validation.plots.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    RED,
    SKY,
    legend_outside,
    mark_operation,
    new_figure,
    scale_y,
    scaled,
)

#: Cycles after which a motion repeats -> colour.
_COLOURS = {1: BLUE, 2: GREEN, 3: PURPLE, 4: ORANGE}
#: One motion with contact kept, one with contact loss, several, none: told apart by lightness too.
_STATES = ("#d5ecdf", "#f5d58a", "#c65d2e", "#8a8a8a")
_NAMES = ("contact kept", "contact loss", "several motions: jumps", "beats or chaos")
_UP: Any = {"color": BLACK, "linewidth": 1.4, "linestyle": "-"}
_DOWN: Any = {"color": BLACK, "linewidth": 1.4, "linestyle": (0, (3, 1.2))}
_POINT: Any = {"marker": "o", "markersize": 6, "markerfacecolor": "white", "markeredgecolor": BLACK}
_ROAMS: Any = {"color": RED, "marker": "x", "markersize": 4.0, "linewidth": 0.7}
#: Part of the range of speeds within which jumps of neighbouring values are of one curve.
_NEAR = 0.06


def response_figure(branches: xr.Dataset, linear: xr.Dataset | None = None) -> Figure:
    """Root mean square of the transmission error over speed, stable and unstable, with multipliers below.

    Arrows are jumps on running up and down; crosses are beats and chaos. ``branches`` is the ``dataset`` of
    ``floquet.response_branches``, ``linear`` the sweep of the linear model, if it is to be drawn.
    """
    figure, axes = new_figure(2, 1, height=5.2, sharex=True, height_ratios=(2.2, 1.0))
    top, bottom = axes[:, 0]
    rms = branches["dte_rms"].to_numpy()
    cycles = branches["n"].to_numpy()
    roams = branches["attractor_dte_rms"].to_numpy()
    factor = scale_y(top, "transmission error,\nroot mean square", "m", np.append(rms, roams))
    radius = branches["spectral_radius"].to_numpy() ** (1.0 / cycles)
    speed = branches["speed_rpm"].to_numpy()
    stable = branches["stable"].to_numpy().astype(bool)
    for branch in np.unique(branches["branch"]):
        here = branches["branch"].to_numpy() == branch
        colour = _COLOURS.get(int(cycles[here][0]), SKY)
        _line(top, speed[here], rms[here] / factor, stable[here], colour)
        _line(bottom, speed[here], radius[here], stable[here], colour)
    handles = [
        Line2D([], [], color=_COLOURS.get(n, SKY), label=_cycles(n)) for n in map(int, np.unique(cycles))
    ]
    handles.append(Line2D([], [], color=GREY, linestyle="--", linewidth=0.9, label="unstable"))
    for one in np.unique(branches["attractor"]):
        here = branches["attractor"].to_numpy() == one
        at, size = (branches[f"attractor_{name}"].to_numpy()[here] for name in ("speed_rpm", "dte_rms"))
        top.plot(at, size / factor, **_ROAMS)
    if branches.sizes["attractor_point"]:
        handles.append(Line2D([], [], **_ROAMS, label="beats or chaos"))
    if linear is not None:
        dotted: Any = {"color": BLACK, "linestyle": ":", "linewidth": 1.0, "label": "linear model"}
        handles += top.plot(linear["speed"], linear["dte_rms"] / factor, **dotted)
    for j in range(branches.sizes["jump"]):
        one = branches.isel(jump=j)
        at, start, end = (float(one[f"jump_{name}"]) for name in ("speed_rpm", "dte_rms", "dte_rms_after"))
        if np.isfinite(end):
            arrow = {"arrowstyle": "-|>", "color": BLACK, "shrinkA": 0, "shrinkB": 0}
            top.annotate("", (at, end / factor), (at, start / factor), arrowprops=arrow)
    top.set_xlim(branches.attrs["speed_low_rpm"], branches.attrs["speed_high_rpm"])
    top.set_ylim(0.0, 1.06 * float(np.append(rms, roams).max()) / factor)
    bottom.axhline(1.0, color=GREY, linewidth=0.8)
    bottom.set(ylabel="largest multiplier,\nper mesh cycle [-]", xlabel="pinion speed [rpm]")
    bottom.set_ylim(max(0.0, float(radius.min()) - 0.05), min(1.6, float(radius.max()) + 0.05))
    legend_outside(figure, handles, 4)
    mark_operation(bottom, branches.attrs["operating_rpm"], "operating point")
    return figure


def _cycles(n: int) -> str:
    return "repeats each mesh cycle" if n == 1 else f"repeats after {n}"


def _line(ax: Axes, speed: FloatArray, values: FloatArray, stable: NDArray[np.bool_], colour: str) -> None:
    """A branch: its stable stretches as a line, the others dashed."""
    calm = stable[:-1] & stable[1:]
    for wanted, look in ((True, {"linewidth": 1.6}), (False, {"linewidth": 0.9, "linestyle": (0, (4, 2))})):
        where = np.flatnonzero(calm == wanted)
        for piece in np.split(where, np.flatnonzero(np.diff(where) > 1) + 1) if where.size else ():
            span = slice(piece[0], piece[-1] + 2)
            ax.plot(speed[span], values[span], color=colour, **look)


def jump_map_figure(data: xr.Dataset) -> Figure:
    """Contact and number of motions, and the largest motion, over speed and a second axis, with the jumps.

    ``data``: of ``floquet.jump_map``.
    """
    (name,) = (str(dim) for dim in data["motions"].dims if dim != "speed_rpm")
    data = data.transpose(name, "speed_rpm", ...).sortby([name, "speed_rpm"])
    figure, axes = new_figure(1, 2, height=3.7, sharey=True)
    left, right = axes[0]
    speed = data["speed_rpm"].to_numpy()
    values = data[name].to_numpy()
    motions = data["motions"].to_numpy()
    no_loss = data["contact_kept"].to_numpy().astype(bool)
    state = np.select([motions == 0, motions > 1, ~no_loss], [3, 2, 1], 0)
    norm = BoundaryNorm(np.arange(-0.5, 4.5), 4)
    shading: Any = {"shading": "nearest", "rasterized": True}
    left.pcolormesh(speed, values, state, cmap=ListedColormap(list(_STATES)), norm=norm, **shading)
    rms = data["dte_rms_largest"].to_numpy()
    factor, unit = scaled(rms, unit="m")
    drawn = right.pcolormesh(speed, values, rms / factor, cmap="viridis", norm=LogNorm(), **shading)
    bar = figure.colorbar(drawn, ax=right, pad=0.02)
    bar.ax.yaxis.set_major_formatter("{x:g}")
    bar.ax.yaxis.set_minor_formatter("")
    bar.set_label(f"largest transmission error, rms [{unit}]", fontsize=8.5)
    bar.outline.set_linewidth(0.5)
    handles: list[Artist] = [
        Patch(facecolor=_STATES[k], edgecolor=BLACK, linewidth=0.4, label=_NAMES[k]) for k in np.unique(state)
    ]
    jumps = [data[f"jump_{key}"].to_numpy() for key in (name, "speed_rpm", "rising", "n")]
    for up, look, words in ((True, _UP, "jump, running up"), (False, _DOWN, "jump, running down")):
        at, place, _, cycles = (column[jumps[2].astype(bool) == up] for column in jumps)
        if at.size:
            handles.append(Line2D([], [], **look, label=words))
        for n in np.unique(cycles):
            one = cycles == n
            for ax, colour in ((left, BLACK), (right, "white")):
                _curves(ax, at[one], place[one], values, np.ptp(speed), {**look, "color": colour})
    point = data.attrs["operating_rpm"], data.attrs["operating_value"]
    inside = speed[0] <= point[0] <= speed[-1] and values[0] <= point[1] <= values[-1]
    for ax in (left, right):
        ax.set(xlim=(speed[0], speed[-1]), xlabel="pinion speed [rpm]")
        if values.size > 1:
            ax.set_ylim(values[0], values[-1])
        ax.grid(False)
        if inside:
            ax.plot(*point, **_POINT)
    if inside:
        handles.append(Line2D([], [], linestyle="", **_POINT, label="operating point"))
    left.set_ylabel(axis_label(data, name))
    legend_outside(figure, handles, 4)
    return figure


def _curves(
    ax: Axes, at: FloatArray, speed: FloatArray, values: FloatArray, span: float, look: dict[str, Any]
) -> None:
    """Jumps at neighbouring values joined, each to the nearest where both are the nearest to each other."""
    rows = [speed[at == value] for value in values]
    alone = [np.ones(row.size, dtype=bool) for row in rows]
    for j, (one, two) in enumerate(pairwise(rows)):
        if not one.size or not two.size:
            continue
        apart = np.abs(one[:, None] - two)
        for k, nearest in enumerate(apart.argmin(axis=1)):
            if apart[:, nearest].argmin() == k and apart[k, nearest] < _NEAR * span:
                ax.plot([one[k], two[nearest]], values[j : j + 2], **look)
                alone[j][k] = alone[j + 1][nearest] = False
    for value, row, single in zip(values, rows, alone, strict=True):
        if single.any():
            ax.plot(row[single], np.full(int(single.sum()), value), ".", color=look["color"], markersize=3.0)
