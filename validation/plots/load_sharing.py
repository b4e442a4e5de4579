"""Load of a tooth pair along the path of contact, by torque."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from lumped import Geometry
from validation.plots.style import DASHES, LINES, legend_above, mark_switches, new_figure, path_marks


def load_sharing_figure(g: Geometry, static: xr.Dataset, torques: tuple[float, ...] = ()) -> Figure:
    """Share of one tooth pair in the load over its position, beyond A and D where deflection lets it touch.

    Parameters
    ----------
    g : geometry of the pair
    static : dataset of ``lumped.static_transmission_error`` over one mesh cycle
    torques : which of its torques to draw, nearest [N m]; default all
    """
    figure, axes = new_figure(height=2.9)
    ax = axes[0, 0]
    place = static["position"].to_numpy().ravel()
    order = np.argsort(place)
    near = (place[order] > g.L_XA - 0.25 * g.base_pitch) & (place[order] < g.L_XD + 0.25 * g.base_pitch)
    shown = static["torque"].to_numpy()
    if torques:
        shown = np.unique([float(static["torque"].sel(torque=one, method="nearest")) for one in torques])
    for index, torque in enumerate(shown):
        share = static["load_share"].sel(torque=torque).to_numpy().ravel()[order]
        ax.plot(
            1e3 * place[order][near],
            share[near],
            color=LINES[index % len(LINES)],
            linestyle=DASHES[index % len(DASHES)],
            label=f"{torque:.4g} N m",
        )
    ax.set_ylim(0.0, 1.05)
    ax.set_xlim(1e3 * place[order][near][0], 1e3 * place[order][near][-1])
    ax.set_xlabel("distance from X along the line of action [mm]")
    ax.set_ylabel("share of one pair in the load [-]")
    mark_switches(ax, path_marks(g), letters=False)
    for letter, value in path_marks(g).items():
        ax.annotate(letter, (value, 0.02), xytext=(2, 0), textcoords="offset points", fontsize=8.0)
    legend_above(ax, min(len(shown), 5))
    return figure
