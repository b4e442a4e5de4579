"""The paper's contact and the loaded one beside the exact contact, and where the losses go over speed."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from lumped import GearPair
from validation.plots.style import (
    BLACK,
    BLUE,
    RED,
    legend_above,
    legend_outside,
    look,
    mark_operation,
    mesh_cycles,
    new_figure,
    one_panel,
    scaled,
)
from validation.validity.contact_forms import FORMS, PLACES, ContactForms


def contact_forms_figure(pair: GearPair, found: ContactForms) -> Figure:
    """Transmission error of both forms and of the exact contact over one mesh cycle.

    Parameters
    ----------
    pair : the gear pair
    found : of ``contact_forms``
    """
    figure, ax = one_panel(2.6)
    exact = found.motions["exact"]["dte"].to_numpy()
    factor, unit = scaled(exact, unit="m")
    looks = {
        "exact": (BLACK, "-", "exact contact, all effects"),
        "loaded": (BLUE, (0, (5, 1.5)), FORMS["loaded"]),
        "prescribed": (RED, (0, (1.2, 1.2)), FORMS["prescribed"]),
    }
    for name, (colour, dashes, words) in looks.items():
        motion = found.motions[name]
        x = mesh_cycles(motion, pair.geometry)
        ax.plot(x, motion["dte"].to_numpy() / factor, color=colour, linestyle=dashes, label=words)
    ax.set(xlabel="time [mesh cycles]", ylabel=f"transmission error [{unit}]", xlim=(0.0, 1.0))
    legend_above(ax, 3)
    return figure


def losses_over_speed_figure(losses: xr.Dataset, operating_rpm: float) -> Figure:
    """Mean losses over the input power by place, left in the loaded and right in prescribed contact.

    Parameters
    ----------
    losses : dataset of ``losses_over_speed``
    operating_rpm : operating speed, marked [rpm]
    """
    figure, axes = new_figure(1, 2, height=3.0, sharey=True, sharex=True)
    speed = losses["speed"].to_numpy()
    for ax, form in zip(axes[0], ("loaded", "prescribed"), strict=True):
        of = losses.sel(form=form)
        for i, (name, words) in enumerate(PLACES.items()):
            if name == "energy_residual" and form == "loaded":
                continue
            share = 100.0 * of[name].to_numpy() / of["driving"].to_numpy()
            ax.plot(speed, share, **look(i), label=words)
        ax.set(xlabel=f"pinion speed [rpm], {FORMS[form]}", xlim=(speed[0], speed[-1]))
        ax.xaxis.set_major_locator(MaxNLocator(5))
        mark_operation(ax, operating_rpm, "operating point")
    largest = np.nanmax([np.nanmax(100.0 * losses[n] / losses["driving"]) for n in PLACES])
    axes[0, 0].set(ylabel="power over input power [%]", ylim=(0.0, 1.15 * float(largest)))
    legend_outside(figure, axes[0, 1].get_lines()[: len(PLACES)], len(PLACES))
    return figure
