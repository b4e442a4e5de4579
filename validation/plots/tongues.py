"""Tongues of instability over speed and mesh damping, with the operating point."""

from __future__ import annotations

from matplotlib.figure import Figure

from validation.plots.style import BLACK, GREY, RED, new_figure
from validation.stability_margins import StabilityMargins


def tongues_figure(margins: StabilityMargins) -> Figure:
    """Edges of every tongue from zero mesh damping to the damping that closes it.

    Parameters
    ----------
    margins : of ``validation.stability_margins.stability_margins``
    """
    figure, axes = new_figure(height=3.0)
    ax = axes[0, 0]
    low, high = margins.speed_range
    labelled: list[float] = []
    for tongue in sorted(margins.tongues, key=lambda t: -t.critical_damping):
        ax.fill_betweenx(tongue.damping, tongue.left, tongue.right, color=RED, alpha=0.75, linewidth=0.8)
        tip = 0.5 * (tongue.left[-1] + tongue.right[-1])
        if any(abs(tip - other) < 0.07 * (high - low) for other in labelled):
            continue  # the table has them all
        labelled.append(float(tip))
        ax.annotate(
            tongue.label.replace("w", "ω"),
            (tip, tongue.damping[-1]),
            xytext=(0, 3),
            textcoords="offset points",
            ha="center",
            va="bottom",
            fontsize=8.0,
        )
    ax.axhline(margins.damping, color=GREY, linewidth=0.8, linestyle=(0, (4, 2)))
    ax.plot(
        margins.rpm,
        margins.damping,
        "o",
        markersize=7,
        markerfacecolor="white",
        markeredgecolor=BLACK,
        markeredgewidth=1.4,
    )
    ax.set_xlim(low, high)
    ax.set_ylim(0.0, 1.25 * max(margins.critical_damping, margins.damping, 1e-3))
    ax.set_xlabel("pinion speed [rpm]")
    ax.set_ylabel("mesh damping ratio [-]")
    return figure
