"""The interactive page of a report, beside its index.html."""

from __future__ import annotations

from pathlib import Path

from lumped import NumericalError
from validation.interactive.page import write_interactive_page
from validation.interactive.results import FINE, Sampling
from validation.reporting.results import Results

NAME = "interactive.html"


def write_interactive(results: Results, folder: Path) -> str | None:
    """Write interactive.html and data/interactive.nc into the folder of a report.

    Returns
    -------
    name of the page; None where it cannot be computed for this pair

    Notes
    -----
    The page samples no finer than the report. It shows the exact multibody model at the operating point, over
    the cycles that the cross-check compares.
    """
    effort, check = results.effort, results.check
    sampling = Sampling(
        speeds=min(FINE.speeds, effort.chart_speeds),
        dampings=min(FINE.dampings, effort.chart_dampings),
        slices=FINE.slices if effort.sweep_speeds >= FINE.sweep_speeds else 3,
        sweep_speeds=min(FINE.sweep_speeds, effort.sweep_speeds),
    )
    motion = check.multibody["exact"]
    per_cycle = (motion.sizes["time"] - 1) // check.cycles
    settled = motion.isel(time=slice(-check.compared_cycles * per_cycle, None))
    try:
        write_interactive_page(
            results.pair,
            folder / NAME,
            data=folder / "data" / "interactive.nc",
            sampling=sampling,
            multibody=settled,
        )
    except NumericalError:  # the slices go farther from the pair than the rest of the report
        return None
    return NAME
