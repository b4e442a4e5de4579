"""Tongues of instability over speed and mesh damping, with the operating point."""

from __future__ import annotations

from matplotlib.figure import Figure

from floquet.gear.margins import StabilityMargins
from validation.plots.labels import label_above
from validation.plots.stability import UNSTABLE, mark_operating_point
from validation.plots.style import GREY, RED, new_figure
from validation.plots.tongue_chart import mark_operating_range


def tongues_figure(margins: StabilityMargins, operating_range: tuple[float, float] | None = None) -> Figure:
    """Edges of every tongue from zero mesh damping to the damping that closes it.

    Parameters
    ----------
    margins : of ``floquet.gear.margins.stability_margins``
    operating_range : speeds of operation [rpm]
    """
    figure, axes = new_figure(height=3.2)
    ax = axes[0, 0]
    ax.set_xlim(*margins.speed_range)
    ax.set_ylim(0.0, 1.25 * max(margins.critical_damping, margins.damping, 1e-3))
    for tongue in margins.tongues:
        ax.fill_betweenx(
            tongue.damping, tongue.left, tongue.right, color=UNSTABLE, edgecolor=RED, linewidth=1.0
        )
    label_above(
        ax,
        [t.label for t in margins.tongues],
        [t.tip_speed for t in margins.tongues],
        [t.critical_damping for t in margins.tongues],
    )
    ax.axhline(margins.damping, color=GREY, linewidth=0.8, linestyle=(0, (4, 2)))
    mark_operating_point(ax, (margins.rpm, margins.damping))
    if operating_range is not None:
        mark_operating_range(ax, operating_range)
    ax.set_xlabel("pinion speed [rpm]")
    ax.set_ylabel("mesh damping ratio [-]")
    return figure
