"""Picture of figure 5."""

from __future__ import annotations

from matplotlib.figure import Figure

from validation.paper.figure_record import FigureRecord
from validation.paper.plots.shared import amplitudes, histories, law_handles, model_handles
from validation.plots.style import new_figure

_ROWS = (("x_p", "LOA displacement $x_p$"), ("y_p", "OLOA displacement $y_p$"))


def draw_figure5(record: FigureRecord) -> Figure:
    """Draw figure 5 from its data: LOA above, OLOA below; time left, mesh orders right."""
    return draw_motions(record, "motions", _ROWS, height=5.2)


def draw_motions(
    record: FigureRecord, part: str, rows: tuple[tuple[str, str], ...], *, height: float
) -> Figure:
    """Draw histories and amplitudes by mesh order, one row per variable."""
    data = record.data[part]
    figure, axes = new_figure(len(rows), 2, height=height, width_ratios=(1.25, 1.0))
    for (time, order), (name, label) in zip(axes, rows, strict=True):
        unit = histories(time, data[name], "m")
        time.set_ylabel(f"{label} [{unit}]")
        unit = amplitudes(order, data[f"{name}_amplitude"], "m")
        order.set_ylabel(f"amplitude [{unit}]")
    axes[-1, 0].set_xlabel("time [mesh cycles]")
    axes[-1, 1].set_xlabel("mesh order [-]")
    handles = law_handles() + (model_handles() if "multibody" in data["model"] else [])
    figure.legend(handles=handles, loc="outside upper center", ncols=3, frameon=False, fontsize=8.5)
    return figure
