"""Common style of all figures: palette, axes, units, marks, and writing to a file."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from lumped import Geometry
from lumped.typing import FloatArray
from validation.files.output import whole_file

#: Okabe and Ito's palette, distinguishable with every common colour vision deficiency.
BLACK = "#000000"
ORANGE = "#E69F00"
SKY = "#56B4E9"
GREEN = "#009E73"
YELLOW = "#F0E442"
BLUE = "#0072B2"
RED = "#D55E00"
PURPLE = "#CC79A7"
#: Colours of lines in order; yellow is too pale for a line on white.
LINES = (BLUE, RED, GREEN, PURPLE, ORANGE, SKY, BLACK)
#: Line style of short dots.
DOTTED = (0, (1.2, 1.2))
#: Line styles that go with ``LINES``, so that colour is never the only difference.
DASHES = ("-", (0, (5, 1.5)), DOTTED, (0, (6, 1.5, 1.2, 1.5)), (0, (3, 1, 1, 1, 1, 1)), "-", ":")
GREY = "#6b6b6b"
#: Coordinates of a place: x in data, y as a share of the axes.
IN_X = ("data", "axes fraction")
#: Coordinates of a place: x as a share of the axes, y in data.
IN_Y = ("axes fraction", "data")
#: Width of a figure [inch].
WIDTH = 7.2
Point = tuple[float, float]
_PREFIXES = (
    (1e9, "G"), (1e6, "M"), (1e3, "k"), (1.0, ""), (1e-3, "m"), (1e-6, "µ"), (1e-9, "n"), (1e-12, "p"),
)  # fmt: skip
_PNG_DPI = 150
_RC: Any = {
    "font.family": ["DejaVu Sans"],
    "font.size": 9.0,
    "axes.labelsize": 9.0,
    "xtick.labelsize": 8.5,
    "ytick.labelsize": 8.5,
    "legend.fontsize": 8.5,
    "axes.titlesize": 9.0,
    "mathtext.fontset": "dejavusans",
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    # Text as paths and ids from a fixed salt: the same bytes everywhere, and no font needed to read them.
    "svg.fonttype": "path",
    "svg.hashsalt": "spurcheck",
    "path.simplify": True,
}


def new_figure(
    rows: int = 1, columns: int = 1, height: float = 2.9, width: float = WIDTH, **options: Any
) -> tuple[Figure, NDArray[np.object_]]:
    """Return an empty figure of a size [inch] and its axes (rows, columns), in the house style."""
    with mpl.rc_context(_RC):
        figure = Figure(figsize=(width, height), layout="constrained")
        axes = figure.subplots(rows, columns, squeeze=False, **options)
    for ax in axes.flat:
        panel_width = width * ax.get_position().width
        panel_height = height * ax.get_position().height
        ax.locator_params(axis="x", nbins=max(3, min(round(2.6 * panel_width), 9)), steps=(1, 2, 5, 10))
        ax.locator_params(axis="y", nbins=max(3, min(round(4.0 * panel_height), 6)), steps=(1, 2, 5, 10))
        ax.tick_params(width=0.6, length=3, grid_color="#d9d9d9", grid_linewidth=0.5)
    return figure, axes


def one_panel(height: float, width: float = WIDTH) -> tuple[Figure, Axes]:
    """Return an empty figure of one panel and its axes; height and width [inch]."""
    figure, axes = new_figure(height=height, width=width)
    return figure, axes[0, 0]


def legend(ax: Axes, **options: Any) -> None:
    """Add a legend without a frame that hides nothing important."""
    settings: dict[str, Any] = {"frameon": False, "handlelength": 2.6, "borderaxespad": 0.2, "fontsize": 8.5}
    ax.legend(**(settings | options))


def legend_above(ax: Axes, columns: int, *, letters: bool = False) -> None:
    """Add a legend above the axes, where no curve can be, and above the letters of events."""
    pad = 1.7 if letters else 0.2
    place: dict[str, Any] = {"loc": "lower left", "bbox_to_anchor": (0.0, 1.0), "borderaxespad": pad}
    legend(ax, **place, ncols=columns, columnspacing=1.6)


def legend_outside(figure: Figure, handles: Sequence[Artist], columns: int) -> None:
    """Add one legend for all panels, above them."""
    figure.legend(handles=handles, loc="outside upper center", ncols=columns, frameon=False, fontsize=8.5)


def look(index: int) -> dict[str, Any]:
    """Return colour and dashes of the line with this number: colour is never the only difference."""
    return {"color": LINES[index % len(LINES)], "linestyle": DASHES[index % len(DASHES)]}


def prefix(largest: float) -> tuple[float, str]:
    """Return factor and SI prefix that bring a number of this size between 1 and 1000."""
    smallest = (1.0, "") if largest == 0.0 else _PREFIXES[-1]
    return next((one for one in _PREFIXES if largest >= one[0]), smallest)


def scaled(*values: Any, unit: str) -> tuple[float, str]:
    """Return divisor and prefixed unit of arrays that share an axis."""
    finite = [np.asarray(v, dtype=float)[np.isfinite(np.asarray(v, dtype=float))] for v in values]
    largest = max((float(np.abs(v).max()) for v in finite if v.size), default=0.0)
    factor, name = prefix(largest)
    return factor, f"{name}{unit}"


def scale_y(ax: Axes, words: str, unit: str, *values: Any) -> float:
    """Label the y axis with words and the prefixed unit of the values. Return the divisor."""
    factor, name = scaled(*values, unit=unit)
    ax.set_ylabel(f"{words} [{name}]")
    return factor


def mesh_cycles(result: xr.Dataset, g: Geometry) -> FloatArray:
    """Return the time in mesh cycles from the start of the data."""
    time = result["time"].to_numpy()
    return np.asarray((time - time[0]) / g.mesh_period, dtype=np.float64)


def mark_operation(ax: Axes, place: float, words: str) -> None:
    """Draw a red line at the operating condition, with words above the axes; nothing for a place outside."""
    low, high = sorted(ax.get_xlim())
    if not low <= place <= high:
        return
    ax.axvline(place, color=RED, linewidth=1.0)
    write_beside(ax, words, (place, 1.0), (0, 2), IN_X, ha="center", color=RED)


def write_beside(ax: Axes, words: str, place: Point, shift: Point, axes: Any = "data", **look: Any) -> None:
    """Write words beside a place, shifted by points. ``axes``: coordinates, "data", IN_X or IN_Y."""
    look = {"fontsize": 8.0} | look
    ax.annotate(words, place, xycoords=axes, xytext=shift, textcoords="offset points", **look)


def save(figure: Figure, path: Path, *, new: bool = False) -> None:
    """Write a complete figure as SVG, PDF or PNG, without dates: the same figure gives the same bytes.

    The suffix of ``path`` names the format; ``new`` as in ``validation.files.output.whole_file``.
    """
    suffix = path.suffix.lower().removeprefix(".")
    dates = {"svg": {"Date": None}, "pdf": {"CreationDate": None, "ModDate": None}}
    metadata: dict[str, Any] = dates.get(suffix, {"Software": None})
    figure.align_ylabels()
    layout = figure.get_layout_engine()
    with whole_file(path, new=new) as temporary, mpl.rc_context(_RC):
        if layout is not None:  # laid out once: with any engine, even "none", savefig draws everything twice
            layout.execute(figure)
            figure.set_layout_engine(None)
        try:
            figure.savefig(temporary, format=suffix, dpi=_PNG_DPI, metadata=metadata)
        finally:
            figure.set_layout_engine(layout)
