"""Picture of figure 6."""

from __future__ import annotations

from matplotlib.figure import Figure

from validation.paper.figure_record import FigureRecord
from validation.paper.plots.figure5 import draw_motions


def draw_figure6(record: FigureRecord) -> Figure:
    """Draw figure 6 from its data: time left, mesh orders right."""
    return draw_motions(record, "transmission_error", (("dte", "DTE"),), height=3.1)
