"""Where a gear pair can jump: map over speed and torque, damping or tip relief."""

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

from lumped.typing import FloatArray
from validation.plots.stability import axis_label
from validation.plots.style import BLACK, legend_outside, new_figure, scaled

#: One motion with contact kept, one with teeth that part, several, none: told apart by lightness too.
_COLOURS = ("#d5ecdf", "#f5d58a", "#c65d2e", "#8a8a8a")
_NAMES = ("contact kept", "teeth part", "several motions: jumps", "beats or chaos")
_UP: Any = {"color": BLACK, "linewidth": 1.4, "linestyle": "-"}
_DOWN: Any = {"color": BLACK, "linewidth": 1.4, "linestyle": (0, (3, 1.2))}
_POINT: Any = {"marker": "o", "markersize": 6, "markerfacecolor": "white", "markeredgecolor": BLACK}
#: Part of the range of speeds within which jumps of neighbouring values are of one curve.
_NEAR = 0.06


def jump_map_figure(data: xr.Dataset) -> Figure:
    """Contact and number of motions, and the largest motion, over speed and a second axis, with the jumps.

    Parameters
    ----------
    data : of ``floquet.jump_map``
    """
    (name,) = (str(dim) for dim in data["motions"].dims if dim != "speed_rpm")
    data = data.transpose(name, "speed_rpm", ...).sortby([name, "speed_rpm"])
    figure, axes = new_figure(1, 2, height=3.7, sharey=True)
    speed, values = data["speed_rpm"].to_numpy(), data[name].to_numpy()
    motions, kept = data["motions"].to_numpy(), data["contact_kept"].to_numpy().astype(bool)
    state = np.select([motions == 0, motions > 1, ~kept], [3, 2, 1], 0)
    left, right = axes[0]
    norm = BoundaryNorm(np.arange(-0.5, 4.5), 4)
    shading: Any = {"shading": "nearest", "rasterized": True}
    left.pcolormesh(speed, values, state, cmap=ListedColormap(list(_COLOURS)), norm=norm, **shading)
    rms = data["dte_rms_largest"].to_numpy()
    factor, unit = scaled(rms, unit="m")
    drawn = right.pcolormesh(speed, values, rms / factor, cmap="viridis", norm=LogNorm(), **shading)
    bar = figure.colorbar(drawn, ax=right, pad=0.02)
    bar.ax.yaxis.set_major_formatter("{x:g}")
    bar.ax.yaxis.set_minor_formatter("")
    bar.set_label(f"largest transmission error, rms [{unit}]", fontsize=8.5)
    bar.outline.set_linewidth(0.5)
    handles: list[Artist] = [
        Patch(facecolor=_COLOURS[k], edgecolor=BLACK, linewidth=0.4, label=_NAMES[k])
        for k in range(4)
        if (state == k).any()
    ]
    jumps = [data[f"jump_{key}"].to_numpy() for key in (name, "speed_rpm", "rising", "n")]
    for up, look, words in ((True, _UP, "jump, running up"), (False, _DOWN, "jump, running down")):
        here = [column[jumps[2].astype(bool) == up] for column in jumps]
        if here[0].size == 0:
            continue
        handles.append(Line2D([], [], **look, label=words))
        for n in np.unique(here[3]):
            one = here[3] == n
            for ax, colour in ((left, BLACK), (right, "white")):
                _curves(ax, here[0][one], here[1][one], values, np.ptp(speed), {**look, "color": colour})
    point = data.attrs["operating_rpm"], data.attrs["operating_value"]
    inside = speed[0] <= point[0] <= speed[-1] and values[0] <= point[1] <= values[-1]
    for ax in (left, right):
        ax.set(xlim=(speed[0], speed[-1]), ylim=(values[0], values[-1]), xlabel="pinion speed [rpm]")
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
