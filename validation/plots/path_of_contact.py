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
    RED,
    legend,
    look,
    new_figure,
    path_axis,
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
    left.set_ylabel("velocity [m/s]")
    left.set_ylim(bottom=0.0)
    legend(left, loc="center left", bbox_to_anchor=(0.0, 0.72))
    right.plot(xi, profile["film_parameter"], color=GREEN, label="film parameter")
    right.set_ylabel("film parameter [-]")
    right.set_ylim(0.0, 1.15 * float(profile["film_parameter"].max()))
    for ax in (left, right):
        path_axis(ax, g, xi)
    for threshold, name in ((1.0, "mixed"), (4.0, "elastohydrodynamic"), (10.0, "full film")):
        if threshold < right.get_ylim()[1]:
            right.axhline(threshold, color=GREY, linewidth=0.8, linestyle=":")
            right.annotate(
                f"{name} above {threshold:g}",
                (0.99, threshold),
                xycoords=("axes fraction", "data"),
                xytext=(0, 2),
                textcoords="offset points",
                ha="right",
                fontsize=7.5,
                color=GREY,
            )
    return figure


def friction_laws_figure(g: Geometry, profile: xr.Dataset, chosen: str) -> Figure:
    """Signed friction coefficient of all laws along the path of contact, the pair's own drawn strongest.

    Parameters
    ----------
    g : geometry of the pair
    profile : dataset of ``lumped.path_of_contact.friction_profile``
    chosen : name of the pair's law
    """
    figure, axes = new_figure(height=3.3)
    ax = axes[0, 0]
    xi = profile["xi"].to_numpy()
    for number, law in enumerate(profile["law"].to_numpy()):
        mu = profile["mu"].sel(law=law).to_numpy()
        # A jump at the pitch point is drawn as one: no line joins its two sides.
        jump = np.abs(np.diff(mu)) > 0.3 * np.ptp(mu)
        x, y = (
            np.insert(xi, np.flatnonzero(jump) + 1, np.nan),
            np.insert(mu, np.flatnonzero(jump) + 1, np.nan),
        )
        own = str(law) == chosen
        title = str(profile["law_title"].sel(law=law).item()) + (" (used)" if own else "")
        ax.plot(
            1e3 * x,
            y,
            **look(number),
            linewidth=2.4 if own else 1.2,
            label=title,
            zorder=3 if own else 2,
        )
    ax.axhline(0.0, color=GREY, linewidth=0.6)
    path_axis(ax, g, 1e3 * xi)
    ax.set_ylabel("friction coefficient, signed [-]")
    legend(ax, loc="upper left")
    return figure
