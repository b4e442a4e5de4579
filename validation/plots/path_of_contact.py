"""The path of contact and the friction laws along it."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from lumped import Geometry
from validation.plots.style import (
    BLUE,
    DASHES,
    GREEN,
    GREY,
    IN_Y,
    RED,
    legend,
    look,
    new_figure,
    one_panel,
    path_axis,
    without_jumps,
    write_beside,
)


def path_figure(g: Geometry, profile: xr.Dataset) -> Figure:
    """Sliding and entraining velocity and film parameter along the path of contact.

    Parameters
    ----------
    g : geometry of the pair
    profile : dataset of ``lumped.path_of_contact.friction_profile``
    """
    figure, axes = new_figure(1, 2, height=2.7)
    xi = 1e3 * profile["xi"].to_numpy()
    left, right = axes[0]
    left.plot(xi, profile["entraining_velocity"], color=BLUE, linestyle=DASHES[0], label="entraining (sum)")
    left.plot(xi, profile["sliding_velocity"], color=RED, linestyle=DASHES[1], label="sliding")
    left.set(ylabel="velocity [m/s]", ylim=(0.0, None))
    legend(left, loc="center left", bbox_to_anchor=(0.0, 0.72))
    right.plot(xi, profile["film_parameter"], color=GREEN, label="film parameter")
    right.set(ylabel="film parameter [-]", ylim=(0.0, 1.15 * float(profile["film_parameter"].max())))
    for ax in (left, right):
        path_axis(ax, g, xi)
    for threshold, name in ((1.0, "mixed"), (4.0, "elastohydrodynamic"), (10.0, "full film")):
        if threshold < right.get_ylim()[1]:
            right.axhline(threshold, color=GREY, linewidth=0.8, linestyle=":")
            words, place = f"{name} above {threshold:g}", (0.99, threshold)
            write_beside(right, words, place, (0, 2), IN_Y, ha="right", fontsize=7.5, color=GREY)
    return figure


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
    legend(ax, loc="upper left")
    return figure
