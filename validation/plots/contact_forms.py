"""Prescribed and loaded contact beside the exact contact."""

from __future__ import annotations

from matplotlib.figure import Figure

from lumped import GearPair
from validation.plots.style import (
    BLACK,
    BLUE,
    RED,
    legend_above,
    mesh_cycles,
    one_panel,
    scaled,
)
from validation.validity.contact_forms import FORMS, ContactForms


def contact_forms_figure(pair: GearPair, found: ContactForms) -> Figure:
    """Transmission error of both forms and of the exact contact over one mesh cycle."""
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
