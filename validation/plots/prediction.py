"""Pictures of the prediction: over speed with its range, orders of the bearing force, error budget."""

from __future__ import annotations

import textwrap
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from validation.files.formatting import number
from validation.plots.axes import label_axis, scale_of
from validation.plots.style import (
    BLACK,
    BLUE,
    GREY,
    IN_X,
    ORANGE,
    RED,
    SKY,
    legend,
    legend_above,
    one_panel,
    write_beside,
)

#: Height and width of a figure of page 1 [inch]. Three figures stand side by side.
SMALL = (3.0, 4.2)
_COLUMN = 26


def over_speed_figure(data: xr.Dataset, operating_rpm: float, size: tuple[float, float] = SMALL) -> Figure:
    """Draw the peak to peak of the transmission error over speed, with range and motions beyond contact loss.

    Parameters
    ----------
    data : over ``speed_rpm`` the linear motion ``linear`` and, where a tooth pair pulls, ``pulling``;
        ``low`` and ``high`` where the inputs were varied. Over ``motion_speed_rpm`` the motions with
        unilateral contact ``motion`` with ``motion_stable``; over ``jump_speed_rpm`` the jumps
        ``jump_from`` and ``jump_to``; over ``roaming_speed_rpm`` beats and chaos ``roaming``. NaN: there is
        no such motion at the speed
    operating_rpm : operating speed, which is marked [rpm]
    size : height and width [inch]
    """
    figure, ax = one_panel(*size)
    speed = data["speed_rpm"]
    linear = data["linear"]
    shared = [linear, *(data[name] for name in ("low", "high", "motion") if name in data)]
    label_axis(ax, "x", speed)
    factor = label_axis(ax, "y", *shared, text="transmission error, p-p")
    x = speed.to_numpy()
    if "low" in data:
        low = data["low"].to_numpy() / factor
        high = data["high"].to_numpy() / factor
        ax.fill_between(x, low, high, color=SKY, alpha=0.4, linewidth=0.0, label="5 to 95 % of the samples")
    if not linear.isnull().all():
        ax.plot(x, linear.to_numpy() / factor, color=BLUE, linewidth=1.6, gid="linear", label="as given")
    if not data["pulling"].isnull().all():
        text = "linear, a tooth pair pulls"
        ax.plot(x, data["pulling"].to_numpy() / factor, color=BLUE, linewidth=0.9, linestyle=":", label=text)
    seen = [linear, *(data[name] for name in ("low", "high") if name in data)]
    if "motion" in data:
        stable = data["motion_stable"].to_numpy() > 0
        seen.append(data["motion"][stable])
        place = data["motion_speed_rpm"].to_numpy()
        sizes = data["motion"].to_numpy() / factor
        look: dict[str, Any] = {"linestyle": "none", "marker": ".", "markersize": 3.5}
        ax.plot(place[stable], sizes[stable], color=RED, label="unilateral contact", gid="motion", **look)
        if not stable.all():
            ax.plot(place[~stable], sizes[~stable], color=GREY, label="unstable", **look)
        if data.sizes.get("roaming_speed_rpm"):
            seen.append(data["roaming"])
            look_of: Any = {"linestyle": "none", "marker": "x", "markersize": 3.5, "color": ORANGE}
            roams = data["roaming"].to_numpy() / factor
            ax.plot(data["roaming_speed_rpm"].to_numpy(), roams, label="beats or chaos", **look_of)
        for jump_speed, start, end in zip(
            data["jump_speed_rpm"].to_numpy(),
            data["jump_from"].to_numpy() / factor,
            data["jump_to"].to_numpy() / factor,
            strict=True,
        ):
            if np.isfinite(end):
                ax.annotate(
                    "",
                    (jump_speed, end),
                    xytext=(jump_speed, start),
                    arrowprops={"arrowstyle": "->", "color": ORANGE},
                )
    ax.axvline(operating_rpm, color=BLACK, linewidth=0.9, linestyle="--")
    write_beside(ax, f"{operating_rpm:.5g} rpm", (operating_rpm, 1.0), (0, 2), IN_X, ha="center")
    ax.set_xlim(x[0], x[-1])
    # Motions that the pair cannot have (unstable, or with teeth that pull) may leave the picture.
    top = max((float(np.nanmax(part)) for part in seen if part.notnull().any()), default=None)
    ax.set_ylim(0.0, None if top is None else 1.25 * top / factor)
    legend(ax, loc="best")
    return figure


def orders_figure(data: xr.Dataset) -> Figure:
    """Draw the amplitudes of a force by mesh order, with ``low`` and ``high`` of varied inputs."""
    figure, ax = one_panel(*SMALL)
    order = data["order"]
    amplitude = data["amplitude"]
    ends = [data[name] for name in ("low", "high") if name in data]
    factor = label_axis(ax, "y", amplitude, *ends)
    ax.set_xlabel(f"mesh order [-]; 1 is {data.attrs['mesh_frequency']:.4g} Hz")
    x = order.to_numpy()
    ax.bar(x, amplitude.to_numpy() / factor, width=0.65, color=BLUE, label="as given")
    if ends:
        low, high = (end.to_numpy() / factor for end in ends)
        ax.vlines(x, low, high, color=BLACK, linewidth=1.3, label="5 to 95 % of the samples")
        legend_above(ax, 2)
    ax.set_xticks(x)
    ax.set_ylim(bottom=0.0)
    ax.grid(False, axis="x")
    return figure


def swings_figure(data: xr.Dataset) -> Figure:
    """Draw the swing of the result with each input alone, from its 5 % to its 95 % value."""
    figure, ax = one_panel(*SMALL)
    low = data["low"]
    high = data["high"]
    factor = label_axis(ax, "x", low, high, text=str(data.attrs["quantity"]))
    place = np.arange(low.size)[::-1]
    start = low.to_numpy() / factor
    end = high.to_numpy() / factor
    nominal = float(data.attrs["given"]) / factor
    ax.barh(place, end - start, left=start, height=0.6, color=BLUE)
    ax.axvline(nominal, color=BLACK, linewidth=1.0)
    ax.set_yticks(place, [textwrap.fill(name, _COLUMN) for name in data.attrs["names"]])
    ax.set_ylabel("input")
    ax.grid(False, axis="y")
    return figure


def budget_figure(data: xr.Dataset) -> Figure:
    """Draw every error of the prediction as a bar on a logarithmic axis: ``share`` [%] over ``row``."""
    share = data["share"]
    figure, ax = one_panel(0.6 + 0.32 * share.size)
    label_axis(ax, "x", share)
    place = np.arange(share.size)[::-1]
    values = share.to_numpy()
    is_known = np.isfinite(values) & (values > 0.0)
    floor = 10.0 ** np.floor(np.log10(values[is_known].min(initial=1e-3)) - 0.5)
    largest = list(data["row"].to_numpy()).index(data.attrs["largest"])
    colours = [RED if i == largest else BLUE for i in range(values.size)]
    ax.barh(place, np.where(is_known, values, floor), left=0.0, height=0.6, color=colours)
    ax.set_xscale("log")
    ax.set_xlim(floor, max(200.0, 2.0 * float(values[is_known].max(initial=0.0))))
    for bar, value, fine in zip(place, values, is_known, strict=True):
        words = f"{number(value, 2)} %" if fine else "0" if value == 0.0 else "not known"
        write_beside(ax, words, (value if fine else floor, bar), (3, 0), va="center")
    ax.set_yticks(place, list(data.attrs["names"]))
    ax.set_ylabel("error")
    ax.grid(False, axis="y")
    return figure


def overlay_figure(data: xr.Dataset) -> Figure:
    """Draw one quantity by two programs over a mesh cycle, and their difference below."""
    from validation.plots.axes import draw_curves
    from validation.plots.style import new_figure

    figure, axes = new_figure(2, 1, height=3.6, sharex=True, height_ratios=(2.0, 1.0))
    top, bottom = axes[:, 0]
    draw_curves(top, data, ["prediction", "second"], text="transmission error")
    legend_above(top, 2)
    draw_curves(bottom, data, ["difference"])
    bottom.set_xlim(0.0, 1.0)
    top.set_xlabel("")
    _, unit = scale_of(data["difference"])
    bottom.set_ylabel(f"difference [{unit}]")
    return figure
