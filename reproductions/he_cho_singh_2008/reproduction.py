"""The records of figures 2 to 7, and how each is drawn."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache

import xarray as xr
from matplotlib.figure import Figure

from lumped import GearPair
from lumped.arguments import some_of
from lumped.typing import Progress
from reproductions.he_cho_singh_2008 import plots
from reproductions.he_cho_singh_2008.figures.figure2 import figure2
from reproductions.he_cho_singh_2008.figures.figure3 import figure3
from reproductions.he_cho_singh_2008.figures.figure7 import figure7
from reproductions.he_cho_singh_2008.figures.law_figures import figure4, figure_of_motions, law_runs
from reproductions.he_cho_singh_2008.operating_points import papers_pair
from reproductions.he_cho_singh_2008.records import FigureRecord
from validation.check.curves import Curves

#: Number of a figure -> how it is drawn from its record.
DRAW: dict[str, Callable[[FigureRecord], Figure]] = {
    "2": plots.draw_figure2,
    "3": plots.draw_figure3,
    "4": plots.draw_figure4,
    "5": plots.draw_motions,
    "6": plots.draw_motions,
    "7": plots.draw_figure7,
}


def figure_records(
    pair: GearPair | None = None,
    figures: Sequence[str] = tuple(DRAW),
    *,
    measurements: Sequence[Curves] = (),
    with_multibody: bool = True,
    runs: xr.Dataset | None = None,
    progress: Progress | None = None,
) -> tuple[FigureRecord, ...]:
    """Compute the data of the paper's figures.

    Parameters
    ----------
    pair : the gear pair of figures 3 to 7 and the first of figure 2; default ``nasa_28_28``. Speeds, torques
        and laws are the paper's
    figures : numbers of the figures
    measurements : records for figure 7
    with_multibody : whether figures 4 to 7 get their multibody twin
    runs : of ``law_runs`` for this pair, where they are known already
    progress : called with the finished fraction

    Raises
    ------
    ParameterError : an unknown figure
    NumericalError : a model fails; the text says what to try
    """
    some_of("figures", figures, DRAW, "Correct the number.")
    gears = papers_pair("nasa_28_28" if pair is None else pair)

    @cache
    def of_laws() -> xr.Dataset:
        return law_runs(gears, with_multibody=with_multibody) if runs is None else runs

    make: dict[str, Callable[[], FigureRecord]] = {
        "2": lambda: figure2(gears),
        "3": lambda: figure3(gears),
        "4": lambda: figure4(of_laws()),
        "5": lambda: figure_of_motions("5", of_laws()),
        "6": lambda: figure_of_motions("6", of_laws()),
        "7": lambda: figure7(gears, measurements, with_multibody=with_multibody),
    }
    records = []
    for done, name in enumerate(figures, 1):
        records.append(make[name]())
        if progress is not None:
            progress(done / len(figures))
    return tuple(records)
