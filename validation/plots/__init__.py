"""Figures: functions from a result to a matplotlib Figure, without global state, one file a subject."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def hand_down() -> None:
    """Give results the function that draws them: ``result.plot()``, and the picture in a notebook."""
    from lumped.display.pictures import draw_with

    draw_with(_drawn)


def _drawn(result: object) -> Figure:
    from validation.plots.of_result import plot  # matplotlib and all models, for a result that exists

    return plot(result)
