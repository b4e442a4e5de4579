"""Picture of compared variants: each dot is the difference of two variants in one possible machine."""

from __future__ import annotations

import textwrap

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from validation.plots.axes import label_axis
from validation.plots.style import BLACK, BLUE, GREY, IN_Y, RED, new_figure, write_beside
from validation.prediction.compare import LARGER, differences, of_hundred

#: Most machines that are drawn in a row.
_DOTS = 256
#: Half the height over which the dots of a row are spread.
_HALF = 0.28
#: Longest line above the panels.
_LINE = 100
#: Height of a row [inch].
_ROW = 0.38
#: Height of a panel without its rows [inch].
_FRAME = 0.55


def compare_figure(comparison: xr.Dataset) -> Figure:
    """Draw the difference of each variant to the first in the same machine, one panel for each result.

    ``comparison``: result of ``spurcheck.compare``. A dot is a machine. The bar runs from 5 to 95 % of the
    machines, the tick is the median.
    """
    others = [str(one) for one in comparison["variant"].to_numpy()[1:]]
    names = [str(one) for one in comparison["result"].to_numpy()]
    height = len(names) * (_FRAME + _ROW * len(others)) + 0.16 * (3 + len(others))
    figure, axes = new_figure(len(names), 1, height=height)
    for ax, name in zip(axes[:, 0], names, strict=True):
        values = comparison[name].to_numpy()
        unit, per = ("%", 100.0) if name == "efficiency" else (comparison[name].attrs["units"], 1.0)
        difference = xr.DataArray(per * differences(values[1:], values[:1])[:, 0], attrs={"units": unit})
        text = str(comparison[name].attrs["long_name"])
        less = "B less A" if len(others) == 1 else "each less A"
        factor = label_axis(ax, "x", difference, text=f"{text}, {less}")
        sign = 1.0 if name in LARGER else -1.0
        for row, letter in enumerate(reversed(others)):
            size = difference.to_numpy()[others.index(letter)] / factor
            spread = _HALF * (2.0 * ((np.arange(size.size) * 0.618034) % 1.0) - 1.0)
            shown = slice(None, _DOTS)
            for side, colour in ((sign * size > 0.0, BLUE), (sign * size < 0.0, RED), (size == 0.0, GREY)):
                on_side = side[shown]
                ax.plot(
                    size[shown][on_side], row + spread[shown][on_side], linestyle="none", marker=".",
                    markersize=4.0, markeredgewidth=0.0, color=colour, alpha=0.7,
                )  # fmt: skip
            low, middle, high = np.percentile(size, (5.0, 50.0, 95.0))
            ax.plot([low, high], [row, row], color=BLACK, linewidth=1.2, gid=f"{name}_{letter}")
            ax.plot([middle], [row], color=BLACK, marker="|", markersize=9.0, markeredgewidth=1.6)
            share = float(comparison["better"].sel(result=name, variant=letter, other="A"))
            words = f"{letter} better in {of_hundred(share)} of 100"
            write_beside(ax, words, (1.0, row), (6, 0), IN_Y, va="center", annotation_clip=False)
        ax.axvline(0.0, color=BLACK, linewidth=0.9)
        ax.set_ylim(-0.5, len(others) - 0.5)
        ax.set_yticks([])
        ax.grid(False, axis="y")
    pairs = zip(comparison["variant"].to_numpy(), comparison["name"].to_numpy(), strict=True)
    lines = [textwrap.shorten(f"{letter}: {name}", _LINE, placeholder=" ...") for letter, name in pairs]
    lines += [
        "Dots: possible machines, blue where the variant is better than A, orange where it is worse.",
        "Bars: 5 to 95 % of the machines, with the median.",
    ]
    figure.suptitle("\n".join(lines), x=0.01, ha="left", fontsize=9.0)
    return figure
