"""Names of tongues along an axis: written as in print, moved apart so that none hides another."""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from scipy.optimize import isotonic_regression

from lumped.typing import FloatArray
from validation.plots.style import BLACK, GREY, WIDTH

#: Behind text that lies on a picture.
WHITE_BOX: dict[str, Any] = {
    "boxstyle": "round,pad=0.2", "facecolor": "white", "edgecolor": "none", "alpha": 0.85,
}  # fmt: skip
_FONT = 7.5
# Upright labels need their line height; the axes take about five sixths of the figure's width.
_GAP = 1.25 * _FONT / (72.0 * WIDTH * 5.0 / 6.0)


def spread(places: Sequence[float] | FloatArray, gap: float, low: float, high: float) -> FloatArray:
    """Move places apart to at least ``gap``, within [low, high], by the least sum of squares.

    With p_i = place_i - i gap the wanted positions minimise sum (q_i - p_i)^2 for increasing q_i, which is
    isotonic regression.

    Parameters
    ----------
    places : increasing
    gap : least distance; shrunk where they do not fit otherwise
    low, high : ends
    """
    wanted = np.asarray(places, dtype=float)
    if wanted.size == 0:
        return wanted
    step = min(gap, (high - low) / max(wanted.size - 1, 1))
    offsets = step * np.arange(wanted.size)
    moved = isotonic_regression(wanted - offsets).x
    return np.asarray(np.clip(moved, low, high - offsets[-1]) + offsets)


def label_above(ax: Axes, names: Sequence[str], places: Sequence[float], weights: Sequence[float]) -> int:
    """Write names upright above the axes, joined to their places by thin lines.

    Parameters
    ----------
    ax : its limits along x must be set
    names, places : what is written where, in data coordinates
    weights : where there are more than fit, the largest are written

    Returns
    -------
    how many are left out
    """
    low, high = sorted(ax.get_xlim())
    gap = _GAP * (high - low)
    room = int((high - low) / gap)
    kept = sorted(sorted(range(len(names)), key=lambda i: -weights[i])[:room], key=lambda i: places[i])
    moved = spread([places[i] for i in kept], gap, low, high)
    upper = ax.get_xaxis_transform()
    for index, x in zip(kept, moved, strict=True):
        ax.plot(
            [places[index], x], [1.0, 1.035], color=GREY, linewidth=0.6, transform=upper, clip_on=False,
            in_layout=False,
        )  # fmt: skip
        ax.annotate(
            pretty(names[index]), (x, 1.04), xycoords=upper, ha="center", va="bottom", rotation=90,
            fontsize=_FONT, color=BLACK,
        )  # fmt: skip
    return len(names) - len(kept)


def pretty(label: str) -> str:
    """Label as written in text, with omega and indices: 2w3/5 -> 2ω₃/5."""
    digits = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
    indexed = re.sub(r"w(\d*)", lambda found: "ω" + found[1].translate(digits), label)
    return indexed.removesuffix("/1").replace("-", "−")
