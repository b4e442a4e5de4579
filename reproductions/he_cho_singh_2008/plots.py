"""Pictures of the paper's figures 2 to 7 and of its errata, drawn from their records."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike, NDArray

from lumped import Geometry
from lumped.typing import FloatArray
from reproductions.he_cho_singh_2008.operating_points import LAWS, SWITCH_SPEED
from reproductions.he_cho_singh_2008.records import ErrataChapter, FigureRecord
from validation.plots.style import (
    BLACK,
    BLUE,
    DASHES,
    GREEN,
    GREY,
    IN_X,
    ORANGE,
    PURPLE,
    RED,
    legend,
    legend_outside,
    new_figure,
    scaled,
    write_beside,
)

#: Law -> colour and dash of its lumped curve.
LAW_LOOK: dict[str, tuple[str, Any]] = dict(
    zip(LAWS, zip((BLUE, RED, GREEN, BLACK), DASHES, strict=False), strict=True)
)
#: Points of the multibody twin: hollow, so that the curve below stays visible.
TWIN: dict[str, Any] = {"linestyle": "none", "marker": "o", "markersize": 3.2, "markerfacecolor": "none"}
_TWIN_POINTS = 32
_FORCES = (("normal_load", "normal load"), ("friction_force", "friction force"))
_TWO_DASHES: tuple[Any, ...] = ("-", (0, (4, 1.5)))
#: Colours of tooth pairs A, B, ...
_LABELS = (BLUE, RED, GREEN, PURPLE)


def path_marks(g: Geometry) -> dict[str, float]:
    """Letters of the path of contact -> distance from X [mm]."""
    marks = {"A": g.L_XA, "B": g.L_XB, "P": g.L_XP, "C": g.L_XC, "D": g.L_XD}
    return {name: 1e3 * place for name, place in marks.items()}


def mark_switches(ax: Axes, events: Mapping[str, float]) -> None:
    """Mark events on the x axis by thin lines, letters above the axes; equal places share a label."""
    places: dict[float, list[str]] = {}
    for name, place in events.items():
        key = next((label_place for label_place in places if abs(label_place - place) < 1e-6), place)
        places.setdefault(key, []).append(name)
    for place, names in places.items():
        ax.axvline(place, color=GREY, linewidth=0.6, linestyle=(0, (2, 2)), zorder=0.5)
        write_beside(ax, ", ".join(names), (place, 1.0), (0, 2), IN_X, ha="center", va="bottom", color=GREY)


def twin_points(
    ax: Axes, x: NDArray[np.float64], y: NDArray[np.float64], colour: str, place: int = 0
) -> None:
    """Draw the multibody twin as hollow points. ``place``: number of the curve, shifts the points."""
    step = max(x.size // _TWIN_POINTS, 1)
    shown = slice((place * step) // 4, None, step)
    ax.plot(x[shown], y[shown], color=colour, markeredgewidth=0.9, **TWIN)


def twin_lines(ax: Axes, x: NDArray[np.float64], values: xr.DataArray, colour: str) -> None:
    """Draw a history (model, ...): lumped model as a broad pale line, multibody twin as a thin line."""
    broad: dict[str, Any] = (
        {"linewidth": 3.0, "alpha": 0.35} if "multibody" in values["model"] else {"linewidth": 1.3}
    )
    ax.plot(x, values.sel(model="lumped").to_numpy(), color=colour, solid_capstyle="butt", **broad)
    if "multibody" in values["model"]:
        ax.plot(x, values.sel(model="multibody").to_numpy(), color=colour, linewidth=0.9)


def line_handles() -> list[Line2D]:
    """Legend entries of ``twin_lines``."""
    return [handle("lumped", linewidth=3.0, alpha=0.35), handle("multibody", linewidth=0.9)]


def handle(label: str, **look: Any) -> Line2D:
    """Legend entry of a line, grey unless its look says otherwise."""
    return Line2D([], [], label=label, **({"color": GREY} | look))


def histories(ax: Axes, values: xr.DataArray, unit: str) -> str:
    """Draw (law, model, phase) histories; returns the prefixed unit of the axis."""
    factor, name = scaled(values.to_numpy(), unit=unit)
    x = values["phase"].to_numpy()
    for place, (law, (colour, dash)) in enumerate(LAW_LOOK.items()):
        one = values.sel(law=law) / factor
        ax.plot(x, one.sel(model="lumped").to_numpy(), color=colour, linestyle=dash, linewidth=1.3)
        if "multibody" in values["model"]:
            twin_points(ax, x, one.sel(model="multibody").to_numpy(), colour, place)
    ax.set_xlim(0.0, 1.0)
    return name


def amplitudes(ax: Axes, values: xr.DataArray, unit: str) -> str:
    """Draw (law, model, order) amplitudes as bars, the twin as points; returns the prefixed unit."""
    factor, name = scaled(values.to_numpy(), unit=unit)
    order = values["order"].to_numpy()
    width = 0.19
    for place, (law, (colour, _)) in enumerate(LAW_LOOK.items()):
        x = order + (place - 1.5) * width
        one = values.sel(law=law) / factor
        ax.bar(x, one.sel(model="lumped").to_numpy(), width=0.9 * width, color=colour)
        if "multibody" in values["model"]:
            twin = one.sel(model="multibody").to_numpy()
            ax.plot(x, twin, color=colour, markeredgewidth=0.9, **TWIN)
    ax.set_xticks(order)
    ax.grid(False, axis="x")
    return name


def draw_figure2(record: FigureRecord) -> Figure:
    """Draw figure 2 from its data."""
    figure, axes = new_figure(1, 2, height=3.3)
    _friction(axes[0, 0], record)
    _means(axes[0, 1], record)
    return figure


def _friction(ax: Axes, record: FigureRecord) -> None:
    data = record.data["friction_in_time"]
    for gears, dash in zip(data["gears"].to_numpy(), _TWO_DASHES, strict=True):
        one = data.sel(gears=gears)
        for law, colour in (("II", RED), ("III", GREEN)):
            ax.plot(
                one["cycles"], one["mu"].sel(law=law), color=colour, linestyle=dash, label=f"{law}, {gears}"
            )
        ax.axvline(float(one["pitch"]), color=GREY, linewidth=0.6, linestyle=dash, zorder=0.5)
        shift, side = (3, "left") if dash == "-" else (-3, "right")
        place = (float(one["pitch"]), 0.0)
        write_beside(ax, f"P, {gears}", place, (shift, 3), IN_X, ha=side, fontsize=7.5, color=GREY)
    ax.axhline(0.0, color=GREY, linewidth=0.6)
    ax.set(xlim=(0.0, float(data["contact_ratio"].max())))
    ax.set(xlabel="(a) time since A [mesh cycles]", ylabel="friction coefficient [-]")
    legend(ax, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2)


def _means(ax: Axes, record: FigureRecord) -> None:
    data = record.data["mean_over_speed"]
    for calibration, dash in zip(data["calibration"].to_numpy(), _TWO_DASHES, strict=True):
        one = data.sel(calibration=calibration)["mean_mu"]
        for law, colour, width in (("II", RED, 0.8), ("III", GREEN, 0.8), ("V", BLACK, 1.8)):
            label = f"{law}, {calibration}" if law == "V" else None
            ax.plot(
                one["speed"], one.sel(law=law), color=colour, linestyle=dash, linewidth=width, label=label
            )
    last = data.isel(calibration=0, speed=-1)["mean_mu"]
    for law, colour in (("II", RED), ("III", GREEN)):
        place = (float(data["speed"][-1]), float(last.sel(law=law)))
        write_beside(ax, law, place, (-4, 5), ha="right", color=colour, fontsize=8.5)
    ax.axvline(SWITCH_SPEED, color=BLUE, linewidth=0.8, linestyle=":", label="paper's switch (calibrated)")
    ax.set(xlim=(0.0, float(data["speed"][-1])), ylim=(0.0, None))
    ax.set(xlabel="(b) pinion speed [rpm]", ylabel="mean of |µ| over the path [-]")
    legend(ax, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=1)


def draw_figure3(record: FigureRecord) -> Figure:
    """Draw figure 3 from its data, with a close-up of the pitch point."""
    data = record.data["normalised_laws"]
    pitch = data.attrs["pitch"]
    end = data.attrs["contact_ratio"]
    figure, axes = new_figure(1, 2, height=3.0, width_ratios=(1.7, 1.0))
    for ax in axes[0]:
        for law, (colour, dash) in LAW_LOOK.items():
            mu = data["normalised_mu"].sel(law=law)
            ax.plot(data["cycles"], mu, color=colour, linestyle=dash, label=LAWS[law])
        ax.axhline(0.0, color=GREY, linewidth=0.6)
        ax.axvline(pitch, color=GREY, linewidth=0.6, linestyle=(0, (2, 2)), zorder=0.5)
        ax.set_ylabel("µ / mean of |µ| [-]")
    full_path, close = axes[0]
    mark_switches(full_path, {"A": 0.0, "B": end - 1.0, "P": pitch, "C": 1.0, "D": end})
    full_path.set(xlim=(0.0, end), xlabel="$t/t_c$ [mesh cycles since A]")
    legend(full_path, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, borderaxespad=1.7)
    close.set(xlim=(pitch - 0.03, pitch + 0.03), xlabel="close-up of P [mesh cycles since A]")
    return figure


def draw_figure4(record: FigureRecord) -> Figure:
    """Draw figure 4 from its data: one row per law, normal load left, friction force right."""
    data = record.data["total_forces"]
    figure, axes = new_figure(len(LAWS), 2, height=7.2, sharex=True, sharey="col")
    x = data["phase"].to_numpy()
    for column, (force, label) in enumerate(_FORCES):
        name = f"total_{force}"
        factor, unit = scaled(data[name].to_numpy(), unit="N")
        for row, (law, (colour, _)) in enumerate(LAW_LOOK.items()):
            ax = axes[row, column]
            twin_lines(ax, x, data[name].sel(law=law) / factor, colour)
            ax.axhline(0.0, color=GREY, linewidth=0.6)
            ax.set_ylabel(f"{LAWS[law]}\n{label} [{unit}]")
        axes[-1, column].set_xlabel("time [mesh cycles]")
    axes[0, 0].set_xlim(0.0, 1.0)
    if "multibody" in data["model"]:
        legend_outside(figure, line_handles(), 2)
    return figure


_MOTIONS = {"x_p": "LOA displacement $x_p$", "y_p": "OLOA displacement $y_p$", "dte": "DTE"}


def draw_motions(record: FigureRecord) -> Figure:
    """Draw figure 5 or 6 from its data: a row per variable; time left, mesh orders right."""
    (data,) = record.data.values()
    rows = [name for name in _MOTIONS if name in data]
    figure, axes = new_figure(len(rows), 2, height=1.0 + 2.1 * len(rows), width_ratios=(1.25, 1.0))
    for (time, order), name in zip(axes, rows, strict=True):
        unit = histories(time, data[name], "m")
        time.set_ylabel(f"{_MOTIONS[name]} [{unit}]")
        unit = amplitudes(order, data[f"{name}_amplitude"], "m")
        order.set_ylabel(f"amplitude [{unit}]")
    axes[-1, 0].set_xlabel("time [mesh cycles]")
    axes[-1, 1].set_xlabel("mesh order [-]")
    models = [handle("lumped"), handle("multibody", **TWIN)] if "multibody" in data["model"] else []
    laws = [handle(title, color=LAW_LOOK[law][0], linestyle=LAW_LOOK[law][1]) for law, title in LAWS.items()]
    legend_outside(figure, laws + models, 3)
    return figure


def draw_figure7(record: FigureRecord) -> Figure:
    """Draw figure 7 from its data: a column per speed, measured points on the panel of their speed."""
    curves = [data for part, data in record.data.items() if not part.startswith("measured")]
    points = [data for part, data in record.data.items() if part.startswith("measured")]
    figure, axes = new_figure(2, len(curves), height=5.2, sharex=True, sharey="row")
    for row, (name, label) in enumerate(_FORCES):
        factor, unit = scaled(*(data[name].to_numpy() for data in curves), unit="N")
        for ax, data in zip(axes[row], curves, strict=True):
            for pair, colour in zip(data["label"].to_numpy(), _LABELS, strict=False):
                twin_lines(ax, data["cycles"].to_numpy(), data[name].sel(label=pair) / factor, colour)
            ax.axhline(0.0, color=GREY, linewidth=0.6)
            for measured in points:
                if abs(measured.attrs["speed_rpm"] / data.attrs["speed_rpm"] - 1.0) < 0.05:
                    _points(ax, measured, name, factor)
        axes[row, 0].set_ylabel(f"{label} per pair [{unit}]")
    for (top, bottom), data in zip(axes.T, curves, strict=True):
        _roll_angle_axis(top, data)
        speed = data.attrs["speed_rpm"]
        bottom.set(xlabel=f"{speed:g} rpm: time since pair A was at A [mesh cycles]", xlim=(0.0, 3.0))
    labels = curves[0]["label"].to_numpy()
    handles = [handle(f"pair {n}", color=colour) for n, colour in zip(labels, _LABELS, strict=False)]
    handles += line_handles() if "multibody" in curves[0]["model"] else []
    if points:
        handles.append(handle("measured", color=ORANGE, marker="s", markersize=3.0, linestyle="none"))
    legend_outside(figure, handles, 5)
    return figure


def _roll_angle_axis(ax: Axes, data: xr.Dataset) -> None:
    """Add the pinion roll angle of pair A along the top."""
    cycles = data["cycles"].to_numpy()
    roll = data["roll_angle"].to_numpy()
    slope = float((roll[-1] - roll[0]) / (cycles[-1] - cycles[0]))
    start = float(roll[0] - slope * cycles[0])

    def to_angle(u: ArrayLike) -> FloatArray:
        return np.asarray(start + slope * np.asarray(u, dtype=float), dtype=np.float64)

    def to_cycles(angle: ArrayLike) -> FloatArray:
        return np.asarray((np.asarray(angle, dtype=float) - start) / slope, dtype=np.float64)

    top = ax.secondary_xaxis("top", functions=(to_angle, to_cycles))
    top.set_xlabel("pinion roll angle of the first pair A [deg]", fontsize=9.0)
    top.tick_params(labelsize=8.5, width=0.6, length=3)


def _points(ax: Axes, measured: xr.Dataset, name: str, factor: float) -> None:
    look: dict[str, Any] = {"color": ORANGE, "marker": "s", "markersize": 2.5, "linestyle": "none"}
    for channel in measured["channel"].to_numpy():
        one = measured.sel(channel=channel)
        if str(one["quantity"].item()) == name:
            scatter = one["scatter"] / factor
            ax.errorbar(one["cycles"], one["theirs"] / factor, yerr=scatter, elinewidth=0.6, zorder=4, **look)


_LOOKS: dict[str, tuple[str, Any, float, float]] = {
    "repaired": (BLACK, "-", 2.6, 0.35),
    "equation 1": (BLUE, "-", 1.1, 1.0),
    "equation 2": (GREEN, (0, (1.2, 1.2)), 1.1, 1.0),
    "equation 7": (RED, (0, (5, 1.5)), 1.1, 1.0),
    "equation 9": (ORANGE, (0, (6, 1.5, 1.2, 1.5)), 1.3, 1.0),
}
_PANELS = (("dte", "DTE"), ("x_g", "LOA displacement $x_g$"), ("y_g", "OLOA displacement $y_g$"))


def draw_errata(chapter: ErrataChapter) -> Figure:
    """Draw DTE, LOA and OLOA motion of the gear over one mesh cycle, repaired and with each printed sign."""
    data = chapter.histories
    figure, axes = new_figure(1, 3, height=2.9)
    x = data["phase"].to_numpy()
    for ax, (name, label) in zip(axes[0], _PANELS, strict=True):
        factor, unit = scaled(data[name].to_numpy(), unit="m")
        for variant, (colour, dash, width, alpha) in _LOOKS.items():
            y = data[name].sel(variant=variant).to_numpy() / factor
            text = variant if variant == "repaired" else f"{variant} as printed"
            ax.plot(x, y, color=colour, linestyle=dash, linewidth=width, alpha=alpha, label=text)
        ax.set(xlim=(0.0, 1.0), xlabel="time [mesh cycles]", ylabel=f"{label} [{unit}]")
    legend_outside(figure, axes[0, 0].lines, 3)
    return figure
