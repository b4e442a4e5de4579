"""Picture of figure 4."""

from __future__ import annotations

from matplotlib.figure import Figure

from validation.paper.figure_record import FigureRecord
from validation.paper.operating_points import LAWS
from validation.paper.plots.shared import LAW_LOOK, line_handles, twin_lines
from validation.plots.style import GREY, new_figure, scaled

_COLUMNS = (("total_normal_load", "normal load"), ("total_friction_force", "friction force"))


def draw_figure4(record: FigureRecord) -> Figure:
    """Draw figure 4 from its data: one row per law, normal load left, friction force right."""
    data = record.data["total_forces"]
    figure, axes = new_figure(len(LAWS), 2, height=7.2, sharex=True, sharey="col")
    x = data["phase"].to_numpy()
    for column, (name, label) in enumerate(_COLUMNS):
        factor, unit = scaled(data[name].to_numpy(), unit="N")
        for row, (law, (colour, _)) in enumerate(LAW_LOOK.items()):
            ax = axes[row, column]
            twin_lines(ax, x, data[name].sel(law=law) / factor, colour)
            ax.axhline(0.0, color=GREY, linewidth=0.6)
            ax.set_ylabel(f"{LAWS[law]}\n{label} [{unit}]")
        axes[-1, column].set_xlabel("time [mesh cycles]")
    axes[0, 0].set_xlim(0.0, 1.0)
    if "multibody" in data["model"]:
        figure.legend(
            handles=line_handles(), loc="outside upper center", ncols=2, frameon=False, fontsize=8.5
        )
    return figure
