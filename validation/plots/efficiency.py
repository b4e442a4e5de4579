"""Mesh losses: by friction law, along the path of contact, and over the mesh cycle."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from lumped import Geometry
from validation.plots.style import (
    BLACK,
    BLUE,
    GREY,
    RED,
    legend_above,
    new_figure,
    one_panel,
    path_axis,
    scaled,
)


def efficiency_figure(losses: xr.Dataset, chosen: str) -> Figure:
    """Relative loss of the mesh by friction law: closed form, quasi-static, periodic motion.

    Parameters
    ----------
    losses : ``mesh_efficiency``, ``mesh_efficiency_dynamic`` and ``mesh_efficiency_closed_form`` over ``law``
    chosen : name of the pair's law
    """
    laws = [str(name) for name in losses["law"].to_numpy()]
    figure, ax = one_panel(0.9 + 0.4 * max(len(laws), 2))
    place = np.arange(len(laws))
    series = (
        ("mesh_efficiency_closed_form", "mean |µ| times closed form", "s", BLACK, -0.18),
        ("mesh_efficiency", "quasi-static", "o", BLUE, 0.0),
        ("mesh_efficiency_dynamic", "periodic motion", "D", RED, 0.18),
    )
    for name, label, marker, colour, shift in series:
        loss = 100.0 * (1.0 - losses[name].to_numpy())
        ax.plot(loss, place + shift, linestyle="none", marker=marker, markersize=5, color=colour, label=label)
    titles = [str(title) for title in losses["law_title"].to_numpy()]
    shown = [t + (" (used)" if n == chosen else "") for n, t in zip(laws, titles, strict=True)]
    ax.set_yticks(place, shown)
    ax.invert_yaxis()
    ax.set(xlim=(0.0, None), xlabel="loss of the mesh over input power [%]", ylabel="friction law")
    legend_above(ax, 3)
    return figure


def sliding_power_figure(
    g: Geometry, quasi_static: xr.Dataset, periodic: xr.Dataset, instants: tuple[xr.Dataset, xr.Dataset]
) -> Figure:
    """Local sliding power of one pair over the path, and instantaneous efficiency over the mesh cycle.

    Parameters
    ----------
    g : geometry of the pair
    quasi_static, periodic : datasets of ``lumped.losses.sliding_power_along_path``
    instants : datasets with ``instantaneous_efficiency`` over ``time``, quasi-static and periodic
    """
    figure, axes = new_figure(1, 2, height=2.9)
    left, right = axes[0]
    powers = [data["sliding_power"].to_numpy() for data in (quasi_static, periodic)]
    factor, unit = scaled(*powers, unit="W")
    looks = (("quasi-static", BLUE, "--"), ("periodic motion", RED, "-"))
    paths = (quasi_static, periodic)
    for path, power, instant, (label, colour, dashes) in zip(paths, powers, instants, looks, strict=True):
        style: Any = {"color": colour, "linestyle": dashes, "label": label, "linewidth": 1.2}
        left.plot(1e3 * path["xi"], power / factor, **style)
        right.plot(instant["time"] / g.mesh_period, 100.0 * instant["instantaneous_efficiency"], **style)
    left.set_ylabel(f"sliding power of one pair [{unit}]")
    path_axis(left, g)
    right.axhline(100.0, color=GREY, linewidth=0.6)
    right.set(xlim=(0.0, 1.0), xlabel="time [mesh cycles]", ylabel="instantaneous efficiency [%]")
    legend_above(right, 2)
    return figure
