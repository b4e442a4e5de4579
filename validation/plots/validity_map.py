"""Validity of the lumped model over speed and torque."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from lumped.lubrication.film import REGIMES
from lumped.model.steady import UNSTABLE
from validation.plots.style import BLACK, new_figure
from validation.validity.flags import LOAD_NOISE, REVERSAL_LIMITS

#: Good, near a limit, beyond it, nothing there: told apart by lightness too, and hatched where bad.
_STATES = ("#d5ecdf", "#f5d58a", "#c65d2e", "#b8b8b8")
_REGIMES = ("#c65d2e", "#f5d58a", "#d5ecdf", "#8fc1e3")


def validity_map_figure(data: xr.Dataset, point: tuple[float, float] | None = None) -> Figure:
    """Contact, sliding and film over speed and torque, a panel each; crosses where the motion is unstable.

    ``data``: of ``validation.validity.map.validity_map``; ``point``: operating point (rpm, N m), marked where
    it is within; None: not marked.
    """
    figure, axes = new_figure(1, 3, height=3.5, sharey=True)
    speed, torque = data["speed"].to_numpy(), data["torque"].to_numpy()
    lowest, reversal = data["lowest_load"].to_numpy(), data["reversal"].to_numpy()
    nothing = np.isnan(lowest)
    unstable = data["spectral_radius"].to_numpy() > UNSTABLE
    contact = np.where(nothing, 3, np.where(lowest < -LOAD_NOISE, 2, 0))
    sliding = np.select([nothing, reversal > REVERSAL_LIMITS[1], reversal > REVERSAL_LIMITS[0]], [3, 2, 1], 0)
    near = f"reversed up to {100 * REVERSAL_LIMITS[1]:g} % of a base pitch"
    panels = (
        ("contact", contact, _STATES, ("kept", "", "lost", "no periodic motion")),
        ("direction of sliding", sliding, _STATES, ("kept", near, "reversed farther", "no periodic motion")),
        ("film, thinnest place", data["regime"].to_numpy(), _REGIMES, REGIMES),
    )
    for ax, (title, values, colours, names) in zip(axes[0], panels, strict=True):
        norm = BoundaryNorm(np.arange(-0.5, 4.5), 4)
        shading: Any = {"cmap": ListedColormap(list(colours)), "norm": norm, "shading": "nearest"}
        ax.pcolormesh(speed, torque, values, **shading, rasterized=True)
        ax.set_yscale("log")
        ax.set_yticks(_round_numbers(torque[0], torque[-1]))
        ax.yaxis.set_major_formatter("{x:g}")
        ax.minorticks_off()
        ax.grid(False)
        present = [k for k in range(4) if (values == k).any()]
        handles: list[Artist] = [
            Patch(facecolor=colours[k], edgecolor=BLACK, linewidth=0.4, label=names[k]) for k in present
        ]
        if ax is axes[0, 0] and unstable.any():
            row, column = np.nonzero(unstable)
            look: Any = {"color": BLACK, "markersize": 3.5, "markeredgewidth": 0.7}
            handles += ax.plot(speed[column], torque[row], "x", **look, label="unstable motion")
        ax.legend(
            handles=handles, loc="upper center", bbox_to_anchor=(0.5, -0.2), frameon=False, fontsize=8.0
        )
        ax.set_title(title, fontsize=9.0)
        ax.set_xlabel("pinion speed [rpm]")
        if point is not None and speed[0] <= point[0] <= speed[-1]:
            ax.plot(*point, "o", markersize=7, markerfacecolor="white", markeredgecolor=BLACK)
    axes[0, 0].set_ylabel("pinion torque [N m]")
    return figure


def _round_numbers(low: float, high: float) -> list[float]:
    """1, 2, 5, 10, 20 ... within a range."""
    decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    return [n * 10.0**d for d in decades for n in (1, 2, 5) if low <= n * 10.0**d <= high]
