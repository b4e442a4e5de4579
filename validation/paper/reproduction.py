"""Figures 2 to 7 in one call: data, records and pictures."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import xarray as xr
from matplotlib.figure import Figure

from lumped import GearPair, load_gear_pair
from lumped.arguments import some_of
from lumped.typing import Progress
from validation.measurements import Measurement
from validation.paper import plots
from validation.paper.figures.figure2 import figure2
from validation.paper.figures.figure3 import figure3
from validation.paper.figures.figure7 import figure7
from validation.paper.figures.law_figures import figure4, figure5, figure6, law_runs
from validation.paper.records import FigureRecord
from validation.plots.style import save

#: Number of a figure -> how it is drawn from its record.
DRAW: dict[str, Callable[[FigureRecord], Figure]] = {
    "2": plots.draw_figure2,
    "3": plots.draw_figure3,
    "4": plots.draw_figure4,
    "5": plots.draw_figure5,
    "6": plots.draw_figure6,
    "7": plots.draw_figure7,
}
#: Figures of ``law_runs``, and figures of the pair alone.
_OF_RUNS = {"4": figure4, "5": figure5, "6": figure6}
_OF_PAIR = {"2": figure2, "3": figure3}


@dataclass(frozen=True, eq=False)
class PaperFigure:
    """A reproduced figure and the files it was written to.

    Attributes
    ----------
    record : text, numbers and data
    pictures : written pictures, one per format
    data : written data files, NetCDF and CSV
    """

    record: FigureRecord
    pictures: tuple[Path, ...]
    data: tuple[Path, ...]


def figure_records(
    pair: GearPair | None = None,
    figures: Sequence[str] = tuple(DRAW),
    *,
    measurements: Sequence[Measurement] = (),
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
    gears = load_gear_pair("nasa_28_28") if pair is None else pair
    if runs is None and _OF_RUNS.keys() & set(figures):
        runs = law_runs(gears, with_multibody=with_multibody)
    records = []
    for done, name in enumerate(figures, 1):
        if name in _OF_PAIR:
            records.append(_OF_PAIR[name](gears))
        elif name == "7":
            records.append(figure7(gears, measurements, with_multibody=with_multibody))
        else:
            assert runs is not None  # computed above for exactly these
            records.append(_OF_RUNS[name](runs))
        if progress is not None:
            progress(done / len(figures))
    return tuple(records)


def paper_figures(
    out: str | Path,
    pair: GearPair | None = None,
    figures: Sequence[str] = tuple(DRAW),
    *,
    measurements: Sequence[Measurement] = (),
    with_multibody: bool = True,
    formats: Sequence[str] = ("svg", "png"),
    progress: Progress | None = None,
) -> tuple[PaperFigure, ...]:
    """Write the paper's figures with their data beside them.

    Parameters
    ----------
    out : folder, created if it does not exist
    pair, figures, measurements, with_multibody, progress : as ``figure_records``
    formats : picture formats, "svg" or "png"

    Returns
    -------
    one record per figure, in the given order
    """
    some_of("formats", formats, ("svg", "png"))
    folder = Path(out)
    folder.mkdir(parents=True, exist_ok=True)
    records = figure_records(
        pair, figures, measurements=measurements, with_multibody=with_multibody, progress=progress
    )
    written = []
    for record in records:
        drawn = DRAW[record.number](record)
        pictures = tuple(folder / f"figure{record.number}.{name}" for name in formats)
        for path in pictures:
            save(drawn, path)
        written.append(PaperFigure(record, pictures, record.write(folder)))
    return tuple(written)
