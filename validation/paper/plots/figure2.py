"""Picture of figure 2."""

from __future__ import annotations

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from validation.paper.figure_record import FigureRecord
from validation.paper.operating_points import SWITCH_SPEED
from validation.plots.style import BLACK, BLUE, GREEN, GREY, RED, legend, new_figure


def draw_figure2(record: FigureRecord) -> Figure:
    """Draw figure 2 from its data."""
    figure, axes = new_figure(1, 2, height=3.3)
    _friction(axes[0, 0], record)
    _means(axes[0, 1], record)
    return figure


def _friction(ax: Axes, record: FigureRecord) -> None:
    data = record.data["friction_in_time"]
    for gears, dash in zip(data["gears"].to_numpy(), ("-", (0, (4, 1.5))), strict=True):
        one = data.sel(gears=gears)
        for law, colour in (("II", RED), ("III", GREEN)):
            ax.plot(
                one["cycles"], one["mu"].sel(law=law), color=colour, linestyle=dash, label=f"{law}, {gears}"
            )
        ax.axvline(float(one["pitch"]), color=GREY, linewidth=0.6, linestyle=dash, zorder=0.5)
        ax.annotate(
            f"P, {gears}",
            (float(one["pitch"]), 0.0),
            xycoords=("data", "axes fraction"),
            xytext=(-3 if dash != "-" else 3, 3),
            textcoords="offset points",
            ha="right" if dash != "-" else "left",
            fontsize=7.5,
            color=GREY,
        )
    ax.axhline(0.0, color=GREY, linewidth=0.6)
    ax.set_xlim(0.0, float(data["contact_ratio"].max()))
    ax.set_xlabel("(a) time since A [mesh cycles]")
    ax.set_ylabel("friction coefficient [-]")
    legend(ax, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2)


def _means(ax: Axes, record: FigureRecord) -> None:
    data = record.data["mean_over_speed"]
    looks = zip(data["calibration"].to_numpy(), ("-", (0, (4, 1.5))), strict=True)
    for calibration, dash in looks:
        one = data.sel(calibration=calibration)["mean_mu"]
        for law, colour, width in (("II", RED, 0.8), ("III", GREEN, 0.8), ("V", BLACK, 1.8)):
            label = f"{law}, {calibration}" if law == "V" else None
            ax.plot(
                one["speed"], one.sel(law=law), color=colour, linestyle=dash, linewidth=width, label=label
            )
    last = data.isel(calibration=0, speed=-1)["mean_mu"]
    for law, colour in (("II", RED), ("III", GREEN)):
        place = (float(data["speed"][-1]), float(last.sel(law=law)))
        ax.annotate(
            law, place, xytext=(-4, 5), textcoords="offset points", ha="right", color=colour, fontsize=8.5
        )
    ax.axvline(SWITCH_SPEED, color=BLUE, linewidth=0.8, linestyle=":", label="paper's switch (calibrated)")
    ax.set_xlim(0.0, float(data["speed"][-1]))
    ax.set_ylim(bottom=0.0)
    ax.set_xlabel("(b) pinion speed [rpm]")
    ax.set_ylabel("mean of |µ| over the path [-]")
    legend(ax, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=1)
