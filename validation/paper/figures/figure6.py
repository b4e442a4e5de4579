"""Figure 6: dynamic transmission error, in time and by mesh order."""

from __future__ import annotations

import xarray as xr

from validation.paper.figure_record import FigureRecord
from validation.paper.figures.figure5 import histories_and_orders, motion_numbers
from validation.paper.operating_points import FIGURE_4
from validation.paper.twins import quality


def figure6(runs: xr.Dataset) -> FigureRecord:
    """Figure 6 with its data and numbers; ``runs`` of ``law_runs``."""
    data = histories_and_orders(runs, ("dte",))
    return FigureRecord(
        number="6",
        title="Dynamic transmission error",
        text=(
            f"DTE over one mesh cycle and its amplitudes by mesh order at {FIGURE_4.torque:g} N m and "
            f"{FIGURE_4.speed:g} rpm, laws I to IV, lumped model and its multibody twin.{quality(runs)[1]}"
        ),
        numbers=motion_numbers(runs, data, ("dte",)),
        data={"transmission_error": data},
    )
