"""Stability chart with its tongues named, its boundaries traced and the operating range marked."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from floquet.gear_tongues import LabelledRegion
from validation.plots.stability import stability_figure
from validation.plots.style import BLACK, BLUE, GREY, RED, new_figure


def tongue_chart_figure(
    chart: xr.Dataset,
    y: str,
    regions: Sequence[LabelledRegion],
    lines: Mapping[str, float] | None = None,
    *,
    point: tuple[float, float] | None = None,
    operating_range: tuple[float, float] | None = None,
) -> Figure:
    """Spectral radius over speed and another axis, every unstable region named.

    Parameters
    ----------
    chart : dataset of ``floquet.stability_chart`` over speed_rpm and ``y``
    y : the other axis
    regions : of ``floquet.gear_tongues.label_regions``
    lines : label -> predicted speed [rpm] (omega_i +- omega_j)/k, ticked along the lower edge
    point : operating point (speed, y)
    operating_range : speeds of operation [rpm]
    """
    figure = stability_figure(chart, "speed_rpm", y, point)
    ax = figure.axes[0]
    low, high = ax.get_xlim()
    named: set[str] = set()
    places: list[float] = []
    for region in regions:
        text = pretty(str(region.label))
        x = region.point["speed_rpm"]
        # The largest region of a label carries its name, unless it would write over another one.
        if text in named or crowded(x, places, high - low):
            continue
        named.add(text)
        places.append(x)
        ax.annotate(
            text,
            (x, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(0, 3),
            textcoords="offset points",
            ha="center",
            va="bottom",
            rotation=90,
            fontsize=7.5,
            color=BLACK,
        )
    for label, speed in (lines or {}).items():
        if low <= speed <= high and pretty(label) in named:
            ax.axvline(speed, color=GREY, linewidth=0.7, linestyle=(0, (1, 2)))
    if operating_range is not None:
        mark_operating_range(ax, operating_range)
    return figure


def crowded(place: float, others: Sequence[float], width: float) -> bool:
    """Whether an upright label would write over one that is there, on an axis of this width."""
    return any(abs(place - other) < 0.022 * width for other in others)


def mark_operating_range(ax: Axes, speeds: tuple[float, float], *, lower: bool = False) -> None:
    """Bar along the upper (or lower) edge over the speeds of operation [rpm]."""
    height = 0.012 if lower else 0.985
    ax.plot(speeds, (height, height), transform=ax.get_xaxis_transform(), color=BLACK, linewidth=3.0)
    ax.annotate(
        "operating range",
        (0.5 * (speeds[0] + speeds[1]), height),
        xycoords=("data", "axes fraction"),
        xytext=(0, 4 if lower else -4),
        textcoords="offset points",
        ha="center",
        va="bottom" if lower else "top",
        fontsize=8.0,
        bbox={"boxstyle": "round,pad=0.15", "facecolor": "white", "edgecolor": "none", "alpha": 0.85},
    )


def pretty(label: str) -> str:
    """Label as written in text, with omega and indices: 2w3/5 -> 2ω₃/5."""
    digits = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")
    out, after = "", False
    for character in label:
        out += character.translate(digits) if after and character.isdigit() else character.replace("w", "ω")
        after = character == "w" or (after and character.isdigit())
    return out.removesuffix("/1")


def critical_damping_figure(tips: xr.Dataset, damping_ratio: float | None = None) -> Figure:
    """Critical mesh damping of every tongue, by speed and name.

    Parameters
    ----------
    tips : dataset of ``floquet.gear_tongues.critical_damping``
    damping_ratio : mesh damping ratio of the pair, drawn as a line
    """
    figure, axes = new_figure(height=3.2)
    ax = axes[0, 0]
    closed = tips.isel(tongue=np.flatnonzero(tips["closed"].to_numpy()))
    speed, damping = closed["speed"].to_numpy(), 100.0 * closed["critical_damping"].to_numpy()
    ax.vlines(speed, 0.0, damping, color=BLUE, linewidth=1.2)
    ax.plot(speed, damping, "o", color=BLUE, markersize=4)
    named: list[float] = []
    for x, height, label in zip(speed, damping, closed["label"].to_numpy(), strict=True):
        # They come by falling damping, so the larger tongue keeps its name.
        if crowded(x, named, float(np.ptp(speed)) or 1.0):
            continue
        named.append(float(x))
        ax.annotate(
            pretty(str(label)), (x, height), xytext=(0, 4), textcoords="offset points",
            ha="center", va="bottom", rotation=90, fontsize=7.5,
        )  # fmt: skip
    if damping_ratio is not None:
        ax.axhline(100.0 * damping_ratio, color=RED, linewidth=1.0)
        ax.annotate(
            "this pair", (1.0, 100.0 * damping_ratio), xycoords=("axes fraction", "data"), xytext=(-3, 3),
            textcoords="offset points", ha="right", color=RED, fontsize=8.0,
        )  # fmt: skip
    highest = max([*damping, 100.0 * damping_ratio if damping_ratio else 0.0], default=1.0)
    ax.set_ylim(0.0, 1.3 * highest)
    ax.set_xlabel("pinion speed [rpm]")
    ax.set_ylabel("critical mesh damping ratio [%]")
    return figure
