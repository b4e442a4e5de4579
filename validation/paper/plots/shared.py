"""What the pictures of figures 2 to 7 share: the look of a law and of a model."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from validation.paper.operating_points import LAWS
from validation.plots.style import BLACK, BLUE, DASHES, GREEN, GREY, RED, scaled

#: Law -> colour and dash of its lumped curve.
LAW_LOOK: dict[str, tuple[str, Any]] = {
    law: (colour, dash) for law, colour, dash in zip(LAWS, (BLUE, RED, GREEN, BLACK), DASHES, strict=False)
}
#: Points of the multibody twin: hollow, so that the curve below stays visible.
TWIN: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": 3.2, "markerfacecolor": "none"}
_TWIN_POINTS = 32


def twin_points(
    ax: Axes, x: NDArray[np.float64], y: NDArray[np.float64], colour: str, place: int = 0
) -> None:
    """Draw the multibody twin as hollow points, those of different curves shifted against each other."""
    step = max(x.size // _TWIN_POINTS, 1)
    at = slice((place * step) // 4, None, step)
    ax.plot(x[at], y[at], color=colour, markeredgewidth=0.9, **TWIN)


def twin_lines(ax: Axes, x: NDArray[np.float64], values: xr.DataArray, colour: str) -> None:
    """Draw a lumped history (model, ...) as a broad pale line and its twin as a thin one on it."""
    broad: dict[str, Any] = (
        {"linewidth": 3.0, "alpha": 0.35} if "multibody" in values["model"] else {"linewidth": 1.3}
    )
    ax.plot(x, values.sel(model="lumped").to_numpy(), color=colour, solid_capstyle="butt", **broad)
    if "multibody" in values["model"]:
        ax.plot(x, values.sel(model="multibody").to_numpy(), color=colour, linewidth=0.9)


def line_handles() -> list[Line2D]:
    """Legend entries of ``twin_lines``."""
    return [
        Line2D([], [], color=GREY, linewidth=3.0, alpha=0.35, label="lumped"),
        Line2D([], [], color=GREY, linewidth=0.9, label="multibody"),
    ]


def model_handles() -> list[Line2D]:
    """Legend entries that tell the models apart."""
    return [
        Line2D([], [], color=GREY, label="lumped"),
        Line2D([], [], color=GREY, label="multibody", **TWIN),
    ]


def law_handles() -> list[Line2D]:
    """Legend entries of the four laws."""
    return [
        Line2D([], [], color=LAW_LOOK[law][0], linestyle=LAW_LOOK[law][1], label=title)
        for law, title in LAWS.items()
    ]


def histories(ax: Axes, values: xr.DataArray, unit: str) -> str:
    """Draw (law, model, phase) histories; returns the prefixed unit of the axis."""
    factor, name = scaled(values.to_numpy(), unit=unit)
    x = values["phase"].to_numpy()
    for place, (law, (colour, dash)) in enumerate(LAW_LOOK.items()):
        one = values.sel(law=law) / factor
        ax.plot(x, one.sel(model="lumped").to_numpy(), color=colour, linestyle=dash, linewidth=1.3)
        if "multibody" in values["model"]:
            twin_points(ax, x, one.sel(model="multibody").to_numpy(), colour, place)
    ax.set_xlim(0.0, 1.0)
    return name


def amplitudes(ax: Axes, values: xr.DataArray, unit: str) -> str:
    """Draw (law, model, order) amplitudes as bars, the twin as points; returns the prefixed unit."""
    factor, name = scaled(values.to_numpy(), unit=unit)
    order = values["order"].to_numpy()
    width = 0.19
    for place, (law, (colour, _)) in enumerate(LAW_LOOK.items()):
        x = order + (place - 1.5) * width
        one = values.sel(law=law) / factor
        ax.bar(x, one.sel(model="lumped").to_numpy(), width=0.9 * width, color=colour)
        if "multibody" in values["model"]:
            twin = one.sel(model="multibody").to_numpy()
            ax.plot(x, twin, color=colour, markeredgewidth=0.9, **TWIN)
    ax.set_xticks(order)
    ax.grid(False, axis="x")
    return name
