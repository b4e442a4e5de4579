"""The mesh along the path of contact: sliding, film, friction, stiffness, load sharing, losses."""

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
    ORANGE,
    RED,
    SKY,
    legend_above,
    look,
    new_figure,
    one_panel,
    path_axis,
    without_jumps,
    write_beside,
)

_POINTS = 801  # of a mesh cycle


def path_figure(g: Geometry, profile: xr.Dataset, thresholds: tuple[float, ...]) -> Figure:
    """Sliding and entraining velocity and film parameter along the path of contact.

    ``profile``: dataset of ``lumped.path_of_contact.friction_profile``; ``thresholds``: film parameters at
    which the lubrication regime changes.
    """
    figure, axes = new_figure(1, 2, height=2.7)
    xi, film = 1e3 * profile["xi"].to_numpy(), profile["film_parameter"].to_numpy()
    left, right = axes[0]
    left.plot(xi, profile["entraining_velocity"], color=BLUE, linestyle=DASHES[0], label="entraining (sum)")
    left.plot(xi, profile["sliding_velocity"], color=RED, linestyle=DASHES[1], label="sliding")
    left.set(ylabel="velocity [m/s]", ylim=(0.0, None))
    legend_above(left, 2, letters=True)
    top = 1.25 * float(film.max())
    right.plot(xi, film, color=BLUE)
    right.set(ylabel="film parameter [-]", ylim=(0.0, top))
    edges = (0.0, *thresholds, np.inf)
    for index, name in enumerate(str(profile["regime"].attrs["flag_meanings"]).split(", ")):
        low, high = edges[index], min(edges[index + 1], top)
        if low < top:
            right.axhspan(low, high, color=GREY, alpha=0.08 * index, linewidth=0)
            write_beside(right, name, (0.01, high), (0, -2), IN_Y, va="top", fontsize=7.5, color="#404040")
    for ax in (left, right):
        path_axis(ax, g, xi)
    return figure


def friction_laws_figure(g: Geometry, profile: xr.Dataset, chosen: str) -> Figure:
    """Signed friction coefficient of all laws along the path of contact, the pair's own drawn strongest.

    ``profile``: dataset of ``lumped.path_of_contact.friction_profile``.
    """
    figure, ax = one_panel(3.3)
    xi = 1e3 * profile["xi"].to_numpy()
    for number, law in enumerate(profile["law"].to_numpy()):
        mu = profile["mu"].sel(law=law).to_numpy()
        own = str(law) == chosen
        title = str(profile["law_title"].sel(law=law).item()) + (" (used)" if own else "")
        weight, order = (2.4, 3) if own else (1.2, 2)
        curve = without_jumps(xi, mu, 0.3 * np.ptp(mu))
        ax.plot(*curve, **look(number), linewidth=weight, label=title, zorder=order)
    ax.axhline(0.0, color=GREY, linewidth=0.6)
    path_axis(ax, g, xi)
    ax.set_ylabel("friction coefficient, signed [-]")
    legend_above(ax, 3, letters=True)
    return figure


_PARTS = (("contact", GREY), ("bending", BLUE), ("shear", SKY), ("axial", ORANGE), ("foundation", GREEN))


def _written(torque: float) -> str:
    """A torque in four digits, never as 2e+04."""
    return f"{float(f'{torque:.4g}'):.12g}"
