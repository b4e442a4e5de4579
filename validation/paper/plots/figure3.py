"""Picture of figure 3."""

from __future__ import annotations

from matplotlib.figure import Figure

from validation.paper.figure_record import FigureRecord
from validation.paper.operating_points import LAWS
from validation.paper.plots.shared import LAW_LOOK
from validation.plots.style import GREY, legend, mark_switches, new_figure


def draw_figure3(record: FigureRecord) -> Figure:
    """Draw figure 3 from its data, with a close-up of the pitch point."""
    data = record.data["normalised_laws"]
    pitch, end = data.attrs["pitch"], data.attrs["contact_ratio"]
    figure, axes = new_figure(1, 2, height=3.0, width_ratios=(1.7, 1.0))
    for ax in axes[0]:
        for law, (colour, dash) in LAW_LOOK.items():
            ax.plot(
                data["cycles"],
                data["normalised_mu"].sel(law=law),
                color=colour,
                linestyle=dash,
                label=LAWS[law],
            )
        ax.axhline(0.0, color=GREY, linewidth=0.6)
        ax.axvline(pitch, color=GREY, linewidth=0.6, linestyle=(0, (2, 2)), zorder=0.5)
    whole, close = axes[0]
    mark_switches(whole, {"A": 0.0, "B": end - 1.0, "P": pitch, "C": 1.0, "D": end})
    whole.set_xlim(0.0, end)
    whole.set_xlabel("$t/t_c$ [mesh cycles since A]")
    whole.set_ylabel("µ / mean of |µ| [-]")
    legend(whole, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, borderaxespad=1.7)
    close.set_xlim(pitch - 0.03, pitch + 0.03)
    close.set_xlabel("close-up of P [mesh cycles since A]")
    close.set_ylabel("µ / mean of |µ| [-]")
    return figure
