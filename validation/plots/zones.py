"""Stability zones of the one-degree-of-freedom gear pair with Coulomb friction (Vaishya and Singh)."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.patches import Patch

from validation.plots.labels import label_above
from validation.plots.stability import UNSTABLE
from validation.plots.style import BLACK, GREY, RED, new_figure

_CASES = {
    "reversing": "friction turns round at the pitch point",
    "constant": "friction of one sign",
}


def zones_figure(zones: xr.Dataset) -> Figure:
    """Unstable zones over mesh frequency and damping, with friction over without.

    Parameters
    ----------
    zones : dataset of ``floquet.gear.coulomb_zones.zones``
    """
    friction = float(zones.attrs["friction_coefficient"])
    figure, axes = new_figure(2, 1, height=4.8, sharex=True, sharey=True)
    x, y = zones["speed_ratio"].to_numpy(), zones["damping_ratio"].to_numpy()

    def excess(case: str) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
        radius = zones["spectral_radius"].sel(friction=case).transpose("damping_ratio", "speed_ratio")
        return np.asarray(radius.to_numpy() - 1.0)

    for ax, (case, text) in zip(axes[:, 0], _CASES.items(), strict=True):
        ax.contourf(x, y, excess(case), levels=[1e-9, np.inf], colors=[UNSTABLE])
        ax.contour(x, y, excess(case), levels=[1e-9], colors=[RED], linewidths=1.0)
        ax.contour(x, y, excess("none"), levels=[1e-9], colors=[BLACK], linewidths=1.0,
                   linestyles=[(0, (3, 1.5))])  # fmt: skip
        for order in range(1, 7):
            place = 2.0 / order
            if x[0] <= place <= x[-1]:
                ax.axvline(place, color=GREY, linewidth=0.6, linestyle=(0, (1, 2)))
        ax.set_ylabel("mesh damping ratio [-]")
        ax.annotate(text, (0.01, 0.97), xycoords="axes fraction", va="top", fontsize=9.0)
    axes[0, 0].set_xlim(x[0], x[-1])
    places = {f"2w/{order}": 2.0 / order for order in range(1, 7) if x[0] <= 2.0 / order <= x[-1]}
    label_above(axes[0, 0], list(places), list(places.values()), list(places.values()))
    axes[1, 0].legend(
        handles=[
            Patch(facecolor=UNSTABLE, edgecolor=RED, label=f"unstable, μ = {friction:g}"),
            Patch(facecolor="none", edgecolor=BLACK, linestyle="--", label="unstable without friction"),
        ],
        loc="upper left", bbox_to_anchor=(0.0, 0.88), frameon=False, fontsize=8.5,
    )  # fmt: skip
    axes[1, 0].set_xlabel("mesh frequency over natural frequency of the mean mesh [-]")
    return figure
