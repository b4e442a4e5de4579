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

#: Mesh cycles in the period of a motion -> colour.
_COLOURS = {1: BLUE, 2: GREEN, 3: PURPLE, 4: ORANGE}
#: Colours of one motion with contact kept, one with contact loss, several, none: they differ in lightness
#: too.
_STATES = ("#d5ecdf", "#f5d58a", "#c65d2e", "#8a8a8a")
_NAMES = ("contact kept", "contact loss", "several motions: jumps", "beats or chaos")
_UP: Any = {"color": BLACK, "linewidth": 1.4, "linestyle": "-"}
_DOWN: Any = {"color": BLACK, "linewidth": 1.4, "linestyle": (0, (3, 1.2))}
_POINT: Any = {"marker": "o", "markersize": 6, "markerfacecolor": "white", "markeredgecolor": BLACK}
_ROAMS: Any = {"color": RED, "marker": "x", "markersize": 4.0, "linewidth": 0.7}
#: Jumps at neighbouring values belong to one curve within this share of the range of speeds.
_NEAR = 0.06


def response_figure(branches: xr.Dataset, linear: xr.Dataset | None = None) -> Figure:
    """Draw the root mean square of the transmission error over speed, with the largest multipliers below.

    Stable and unstable motions are drawn. Arrows are jumps on running up and down; crosses are beats and
    chaos. ``branches``: ``dataset`` of ``floquet.response_branches``; ``linear``: sweep of the linear
    model, or None.
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
        of_branch = branches["branch"].to_numpy() == branch
        colour = _COLOURS.get(int(cycles[of_branch][0]), SKY)
        _line(top, speed[of_branch], rms[of_branch] / factor, stable[of_branch], colour)
        _line(bottom, speed[of_branch], radius[of_branch], stable[of_branch], colour)
    handles = [
        Line2D([], [], color=_COLOURS.get(n, SKY), label=_cycles(n)) for n in map(int, np.unique(cycles))
    ]
    handles.append(Line2D([], [], color=GREY, linestyle="--", linewidth=0.9, label="unstable"))
    for one in np.unique(branches["attractor"]):
        of_branch = branches["attractor"].to_numpy() == one
        speeds, size = (
            branches[f"attractor_{name}"].to_numpy()[of_branch] for name in ("speed_rpm", "dte_rms")
        )
        top.plot(speeds, size / factor, **_ROAMS)
    if branches.sizes["attractor_point"]:
        handles.append(Line2D([], [], **_ROAMS, label="beats or chaos"))
    if linear is not None:
        dotted: Any = {"color": BLACK, "linestyle": ":", "linewidth": 1.0, "label": "linear model"}
        handles += top.plot(linear["speed"], linear["dte_rms"] / factor, **dotted)
    for j in range(branches.sizes["jump"]):
        one = branches.isel(jump=j)
        speeds, start, end = (
            float(one[f"jump_{name}"]) for name in ("speed_rpm", "dte_rms", "dte_rms_after")
        )
        if np.isfinite(end):
            arrow = {"arrowstyle": "-|>", "color": BLACK, "shrinkA": 0, "shrinkB": 0}
            top.annotate("", (speeds, end / factor), (speeds, start / factor), arrowprops=arrow)
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
    """Draw a branch: stable stretches as a line, unstable stretches dashed."""
    stretch_stable = stable[:-1] & stable[1:]
    for wanted, look in ((True, {"linewidth": 1.6}), (False, {"linewidth": 0.9, "linestyle": (0, (4, 2))})):
        where = np.flatnonzero(stretch_stable == wanted)
        for piece in np.split(where, np.flatnonzero(np.diff(where) > 1) + 1) if where.size else ():
            span = slice(piece[0], piece[-1] + 2)
            ax.plot(speed[span], values[span], color=colour, **look)


def jump_map_figure(data: xr.Dataset) -> Figure:
    """Draw contact, number of motions and the largest motion over speed and a second axis, with jumps.

    ``data``: result of ``floquet.jump_map``.
    """
    (name,) = (str(dim) for dim in data["motions"].dims if dim != "speed_rpm")
    data = data.transpose(name, "speed_rpm", ...).sortby([name, "speed_rpm"])
    figure, axes = new_figure(1, 2, height=3.7, sharey=True)
    states_axes, sizes_axes = axes[0]
    speed = data["speed_rpm"].to_numpy()
    values = data[name].to_numpy()
    motions = data["motions"].to_numpy()
    no_loss = data["contact_kept"].to_numpy().astype(bool)
    state = np.select([motions == 0, motions > 1, ~no_loss], [3, 2, 1], 0)
    norm = BoundaryNorm(np.arange(-0.5, 4.5), 4)
    shading: Any = {"shading": "nearest", "rasterized": True}
    states_axes.pcolormesh(speed, values, state, cmap=ListedColormap(list(_STATES)), norm=norm, **shading)
    rms = data["dte_rms_largest"].to_numpy()
    factor, unit = scaled(rms, unit="m")
    drawn = sizes_axes.pcolormesh(speed, values, rms / factor, cmap="viridis", norm=LogNorm(), **shading)
    bar = figure.colorbar(drawn, ax=sizes_axes, pad=0.02)
    bar.ax.yaxis.set_major_formatter("{x:g}")
    bar.ax.yaxis.set_minor_formatter("")
    bar.set_label(f"largest transmission error, rms [{unit}]", fontsize=8.5)
    bar.outline.set_linewidth(0.5)
    handles: list[Artist] = [
        Patch(facecolor=_STATES[k], edgecolor=BLACK, linewidth=0.4, label=_NAMES[k]) for k in np.unique(state)
    ]
    all_values, all_speeds, rising, all_cycles = (
        data[f"jump_{key}"].to_numpy() for key in (name, "speed_rpm", "rising", "n")
    )
    for up, look, words in ((True, _UP, "jump, running up"), (False, _DOWN, "jump, running down")):
        of_direction = rising.astype(bool) == up
        jump_values = all_values[of_direction]
        jump_speeds = all_speeds[of_direction]
        cycles = all_cycles[of_direction]
        if jump_values.size:
            handles.append(Line2D([], [], **look, label=words))
        for n in np.unique(cycles):
            one = cycles == n
            for ax, colour in ((states_axes, BLACK), (sizes_axes, "white")):
                _curves(
                    ax, jump_values[one], jump_speeds[one], values, np.ptp(speed), {**look, "color": colour}
                )
    point = data.attrs["operating_rpm"], data.attrs["operating_value"]
    inside = speed[0] <= point[0] <= speed[-1] and values[0] <= point[1] <= values[-1]
    for ax in (states_axes, sizes_axes):
        ax.set(xlim=(speed[0], speed[-1]), xlabel="pinion speed [rpm]")
        if values.size > 1:
            ax.set_ylim(values[0], values[-1])
        ax.grid(False)
        if inside:
            ax.plot(*point, **_POINT)
    if inside:
        handles.append(Line2D([], [], linestyle="", **_POINT, label="operating point"))
    states_axes.set_ylabel(axis_label(data, name))
    legend_outside(figure, handles, 4)
    return figure


def _curves(
    ax: Axes,
    jump_values: FloatArray,
    jump_speeds: FloatArray,
    values: FloatArray,
    span: float,
    look: dict[str, Any],
) -> None:
    """Join jumps at neighbouring values where each of the two is the nearest to the other.

    ``jump_values``, ``jump_speeds``: value of the second axis and speed of each jump; ``values``: all
    values of the second axis; ``span``: range of the speeds.
    """
    rows = [jump_speeds[jump_values == value] for value in values]
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
