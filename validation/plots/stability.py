"""Stability chart: spectral radius over two parameters, with its boundary and the operating point."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.figure import Figure

from validation.plots.style import BLACK, RED, new_figure

#: Blue for fast decay to white at the boundary; what is unstable gets a colour of its own, and hatching.
_STABLE = LinearSegmentedColormap.from_list("decay", ["#08519c", "#6baed6", "#f7fbff"])


def stability_figure(chart: xr.Dataset, x: str, y: str, point: tuple[float, float] | None) -> Figure:
    """Spectral radius over two axes of a chart; unstable regions hatched, the operating point marked.

    Parameters
    ----------
    chart : dataset of ``floquet.stability_chart`` over exactly the axes ``x`` and ``y``
    x, y : names of its axes
    point : operating point (x, y); None: not marked
    """
    figure, axes = new_figure(height=3.4)
    ax = axes[0, 0]
    radius = chart["spectral_radius"].transpose(y, x).to_numpy()
    xs, ys = chart[x].to_numpy(), chart[y].to_numpy()
    low = float(np.nanmin(radius))
    norm = Normalize(min(low, 0.999), 1.0)
    mesh = ax.pcolormesh(
        xs, ys, np.minimum(radius, 1.0), cmap=_STABLE, norm=norm, shading="nearest", rasterized=True
    )
    unstable = radius > 1.0
    if unstable.any():
        ax.contourf(xs, ys, radius, levels=[1.0, np.inf], colors=[RED], alpha=0.75)
        ax.contour(xs, ys, radius, levels=[1.0], colors=[BLACK], linewidths=1.0)
    if point is not None:
        ax.plot(
            *point,
            marker="o",
            markersize=8,
            markerfacecolor="white",
            markeredgecolor=BLACK,
            markeredgewidth=1.6,
        )
        ax.annotate(
            "operating point",
            point,
            xytext=(8, 6),
            textcoords="offset points",
            fontsize=8.5,
            bbox={"boxstyle": "round,pad=0.2", "facecolor": "white", "edgecolor": "none", "alpha": 0.85},
        )
    bar = figure.colorbar(mesh, ax=ax, pad=0.01)
    bar.set_label("spectral radius [-]; unstable above 1 (orange)", fontsize=8.5)
    bar.outline.set_linewidth(0.5)
    ax.set_xlabel(_label(chart, x))
    ax.set_ylabel(_label(chart, y))
    ax.set_xlim(xs[0], xs[-1])
    ax.set_ylim(ys[0], ys[-1])
    ax.grid(False)
    return figure


def _label(chart: xr.Dataset, name: str) -> str:
    attrs = chart[name].attrs
    unit = attrs.get("units", "1")
    return f"{attrs.get('long_name', name)} [{'-' if unit == '1' else unit}]"
