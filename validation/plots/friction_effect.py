"""Difference chart of two friction laws: what one does to the growth of the fastest motion."""

from __future__ import annotations

from typing import Literal

import numpy as np
import xarray as xr
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from validation.plots.stability import axis_label, field, mark_operating_point
from validation.plots.style import BLACK, one_panel


def friction_effect_figure(
    effect: xr.Dataset, law: str, x: str, y: str, point: tuple[float, float] | None = None
) -> Figure:
    """Change of growth per mesh cycle over two axes, with the boundaries under both laws.

    Parameters
    ----------
    effect : dataset of ``floquet.gear.friction_effect.friction_effect`` over exactly the axes ``x``, ``y``
    law : which of its laws
    x, y : names of the axes
    point : operating point (x, y); None: not marked
    """
    figure, ax = one_panel(3.5)
    one = effect.sel(law=law).transpose(y, x).sortby([x, y])
    xs, ys, change = one[x].to_numpy(), one[y].to_numpy(), one["growth_change"].to_numpy()
    # Changes peak sharply at the edges of tongues; the scale serves the rest.
    reach = float(np.nanpercentile(np.abs(change), 98.0)) or 1e-12
    drawn = field(ax, xs, ys, change, Normalize(-reach, reach), "PuOr_r")
    ax.set(xlim=(xs[0], xs[-1]), ylim=(ys[0], ys[-1]))
    shown = []
    dashes: tuple[tuple[str, xr.DataArray, Literal["-", "--"]], ...] = (
        (law, one["growth"], "-"),
        (str(effect.attrs["reference"]), one["reference_growth"], "--"),
    )
    for name, growth, style in dashes:
        if min(xs.size, ys.size) > 1 and float(growth.min()) < 0.0 < float(growth.max()):
            ax.contour(xs, ys, growth.to_numpy(), levels=[0.0], colors=[BLACK], linewidths=1.1,
                       linestyles=[style])  # fmt: skip
        shown.append(Line2D([], [], color=BLACK, linewidth=1.1, linestyle=style,
                            label=f"boundary, {name.replace('_', ' ')}"))  # fmt: skip
    ax.legend(handles=shown, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, frameon=False,
              fontsize=8.5, handlelength=2.6)  # fmt: skip
    mark_operating_point(ax, point)
    bar = figure.colorbar(drawn, ax=ax, pad=0.01, extend="both")
    bar.set_label("change of growth per mesh cycle [-]\n(purple: damps, orange: drives)", fontsize=8.5)
    bar.outline.set_linewidth(0.5)
    ax.set(xlabel=axis_label(effect, x), ylabel=axis_label(effect, y))
    ax.grid(False)
    return figure
