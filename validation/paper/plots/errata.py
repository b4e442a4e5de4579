"""Picture of what the printed signs do to the motions."""

from __future__ import annotations

from typing import Any

from matplotlib.figure import Figure

from validation.paper.records import ErrataChapter
from validation.plots.style import BLACK, BLUE, GREEN, ORANGE, RED, new_figure, scaled

_LOOKS: dict[str, tuple[str, Any, float, float]] = {
    "repaired": (BLACK, "-", 2.6, 0.35),
    "equation 1": (BLUE, "-", 1.1, 1.0),
    "equation 2": (GREEN, (0, (1.2, 1.2)), 1.1, 1.0),
    "equation 7": (RED, (0, (5, 1.5)), 1.1, 1.0),
    "equation 9": (ORANGE, (0, (6, 1.5, 1.2, 1.5)), 1.3, 1.0),
}
_PANELS = (("dte", "DTE"), ("x_g", "LOA displacement $x_g$"), ("y_g", "OLOA displacement $y_g$"))


def draw_errata(chapter: ErrataChapter) -> Figure:
    """Draw DTE, LOA and OLOA motion of the gear over one mesh cycle, repaired and with each printed sign."""
    data = chapter.histories
    figure, axes = new_figure(1, 3, height=2.9)
    x = data["phase"].to_numpy()
    for ax, (name, label) in zip(axes[0], _PANELS, strict=True):
        factor, unit = scaled(data[name].to_numpy(), unit="m")
        for variant, (colour, dash, width, alpha) in _LOOKS.items():
            y = data[name].sel(variant=variant).to_numpy() / factor
            text = variant if variant == "repaired" else f"{variant} as printed"
            ax.plot(x, y, color=colour, linestyle=dash, linewidth=width, alpha=alpha, label=text)
        ax.set_xlim(0.0, 1.0)
        ax.set_xlabel("time [mesh cycles]")
        ax.set_ylabel(f"{label} [{unit}]")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=3, frameon=False, fontsize=8.5)
    return figure
