"""The path of contact and the friction laws along it."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from lumped import Geometry
from validation.plots.style import (
    BLUE,
    DASHES,
    GREY,
    IN_Y,
    RED,
    legend_above,
    look,
    new_figure,
    one_panel,
    path_axis,
    without_jumps,
    write_beside,
)


def path_figure(g: Geometry, profile: xr.Dataset, thresholds: tuple[float, ...]) -> Figure:
    """Sliding and entraining velocity and film parameter along the path of contact.

    Parameters
    ----------
    g : geometry of the pair
    profile : dataset of ``lumped.path_of_contact.friction_profile``
    thresholds : film parameters at which the lubrication regime changes
    """
    figure, axes = new_figure(1, 2, height=2.7)
    xi = 1e3 * profile["xi"].to_numpy()
    left, right = axes[0]
    left.plot(xi, profile["entraining_velocity"], color=BLUE, linestyle=DASHES[0], label="entraining (sum)")
    left.plot(xi, profile["sliding_velocity"], color=RED, linestyle=DASHES[1], label="sliding")
    left.set(ylabel="velocity [m/s]", ylim=(0.0, None))
    legend_above(left, 2, letters=True)
    _film_parameter(right, profile, thresholds)
    for ax in (left, right):
        path_axis(ax, g, xi)
    return figure


def _film_parameter(ax: Axes, profile: xr.Dataset, thresholds: tuple[float, ...]) -> None:
    """Film parameter over the path of contact, with its lubrication regimes shaded and named."""
    parameter = profile["film_parameter"].to_numpy()
    ax.plot(1e3 * profile["xi"], parameter, color=BLUE)
    ax.set_ylabel("film parameter [-]")
    top = 1.25 * float(parameter.max())
    ax.set_ylim(0.0, top)
    edges = (0.0, *thresholds, np.inf)
    names = str(profile["regime"].attrs["flag_meanings"]).split(", ")
    for index, name in enumerate(names):
        low, high = edges[index], min(edges[index + 1], top)
        if low >= top:
            continue
        ax.axhspan(low, high, color=GREY, alpha=0.08 * index, linewidth=0)
        write_beside(ax, name, (0.01, high), (0, -2), IN_Y, va="top", fontsize=7.5, color="#404040")


def friction_laws_figure(g: Geometry, profile: xr.Dataset, chosen: str) -> Figure:
    """Signed friction coefficient of all laws along the path of contact, the pair's own drawn strongest.

    Parameters
    ----------
    g : geometry of the pair
    profile : dataset of ``lumped.path_of_contact.friction_profile``
    chosen : name of the pair's law
    """
    figure, ax = one_panel(3.3)
    xi = profile["xi"].to_numpy()
    for number, law in enumerate(profile["law"].to_numpy()):
        mu = profile["mu"].sel(law=law).to_numpy()
        x, y = without_jumps(1e3 * xi, mu, 0.3 * np.ptp(mu))
        own = str(law) == chosen
        title = str(profile["law_title"].sel(law=law).item()) + (" (used)" if own else "")
        weight, order = (2.4, 3) if own else (1.2, 2)
        ax.plot(x, y, **look(number), linewidth=weight, label=title, zorder=order)
    ax.axhline(0.0, color=GREY, linewidth=0.6)
    path_axis(ax, g, 1e3 * xi)
    ax.set_ylabel("friction coefficient, signed [-]")
    legend_above(ax, 3, letters=True)
    return figure
