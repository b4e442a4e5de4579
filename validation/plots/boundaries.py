"""Boundaries of tongues over speed and another parameter."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from validation.plots.labels import label_above
from validation.plots.stability import UNSTABLE, axis_label
from validation.plots.style import RED, new_figure
from validation.plots.tongue_chart import mark_operating_range


def boundaries_figure(
    found: xr.Dataset, name: str, operating_range: tuple[float, float] | None = None
) -> Figure:
    """Unstable speeds over another parameter, every tongue named.

    Parameters
    ----------
    found : dataset of ``floquet.stability_boundaries`` with one more axis
    name : that axis
    operating_range : speeds of operation [rpm]
    """
    figure, axes = new_figure(height=3.4)
    ax = axes[0, 0]
    values = found[name].to_numpy()
    names, places, widths = [], [], []
    for row in range(found.sizes["tongue"]):
        tongue = found.isel(tongue=row)
        here = tongue["present"].to_numpy()
        lower, upper = (
            tongue[f"interval_{edge}"].transpose(name, ...).to_numpy() for edge in ("lower", "upper")
        )
        for edges in zip(lower.T, upper.T, strict=True):
            ax.fill_betweenx(values, *edges, color=UNSTABLE, linewidth=0.0)
            for edge in edges:  # marks show a tongue that is met at one value alone
                ax.plot(edge, values, color=RED, linewidth=1.0, marker=".", markersize=3.0)
        # Named where the tongue leaves the figure, or at its last value.
        last = int(np.flatnonzero(here)[-1])
        names.append(str(tongue["label"].item()))
        places.append(float(tongue["peak"][last]))
        widths.append(float(np.nanmax(upper - lower)))
    ax.set_ylim(values.min(), values.max())
    if names:
        low, high = float(found["lower"].min()), float(found["upper"].max())
        aside = 0.05 * (high - low)
        ax.set_xlim(low - aside, high + aside)
        label_above(ax, names, places, widths)
    else:
        ax.set_xticks([])
        ax.annotate("no speed of the range is unstable", (0.5, 0.5), xycoords="axes fraction", ha="center")
    if operating_range is not None:
        mark_operating_range(ax, operating_range)
    ax.set_xlabel("pinion speed [rpm]")
    ax.set_ylabel(axis_label(found, name))
    return figure
