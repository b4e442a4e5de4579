"""Floquet multipliers in the complex plane, at one point and along a parameter."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from floquet.gear.multipliers import GearPairMultipliers
from validation.plots.stability import axis_label, mark_operating_value
from validation.plots.style import BLACK, BLUE, GREY, RED, legend, new_figure, one_panel


def _unit_circle(ax: Axes, reach: float) -> None:
    """Draw the unit circle in the complex plane, which is shown up to ``reach`` in every direction."""
    angle = np.linspace(0.0, 2.0 * np.pi, 361)
    ax.plot(np.cos(angle), np.sin(angle), color=BLACK, linewidth=1.0)
    ax.set(xlim=(-reach, reach), ylim=(-reach, reach), xlabel="real part [-]", ylabel="imaginary part [-]")


def multipliers_figure(multipliers: GearPairMultipliers) -> Figure:
    """Multipliers in the complex plane, with the rigid rotation apart.

    Parameters
    ----------
    multipliers : of the gear pair
    """
    figure, ax = one_panel(3.4)
    _unit_circle(ax, 1.1 * max(1.0, multipliers.spectral_radius))
    ax.axhline(0.0, color=GREY, linewidth=0.5)
    ax.axvline(0.0, color=GREY, linewidth=0.5)
    for values, marker, colour, label in (
        (multipliers.feedback, "o", BLUE, "mesh: q, x of pinion and gear"),
        (multipliers.oloa, "s", RED, "bearings: y of pinion and gear"),
    ):
        style: Any = {"markerfacecolor": "none", "markeredgecolor": colour, "markeredgewidth": 1.6}
        ax.plot(values.real, values.imag, marker, markersize=7, label=label, **style)
    ax.plot([1.0], [0.0], "x", color=BLACK, markersize=7, label="rigid rotation (taken out)")
    ax.set_aspect("equal")
    legend(ax, loc="center left", bbox_to_anchor=(1.02, 0.5), handlelength=1.2)
    return figure


def multiplier_paths_figure(paths: xr.Dataset, operating: float | None = None) -> Figure:
    """Multipliers as one parameter varies; colour is the parameter, red where they are outside.

    Parameters
    ----------
    paths : dataset of ``floquet.gear.paths.multiplier_paths``
    operating : value of the parameter at the operating point, marked
    """
    figure, axes = new_figure(1, 2, height=4.0, gridspec_kw={"width_ratios": [1.0, 1.25]})
    left, right = axes[0]
    name = str(paths["multipliers"].dims[0])
    parameter, values = paths[name].to_numpy(), paths["multipliers"].to_numpy()
    norm = Normalize(parameter.min(), parameter.max())
    reach = 1.08 * max(1.0, float(np.abs(values).max()))
    _unit_circle(left, reach)
    for track in values.T:
        left.plot(track.real, track.imag, color=GREY, linewidth=0.5, zorder=1)
        drawn = left.scatter(track.real, track.imag, c=parameter, norm=norm, cmap="viridis", s=5, zorder=2)
        left.plot(
            track[0].real, track[0].imag, "o", color=GREY, markersize=5, markerfacecolor="white", zorder=3
        )
        outside = np.abs(track) > 1.0
        left.plot(track[outside].real, track[outside].imag, "o", color=RED, markersize=2.5)
        right.plot(parameter, np.abs(track), color=GREY, linewidth=1.0)
        right.plot(parameter[outside], np.abs(track[outside]), ".", color=RED, markersize=3)
    left.set_aspect("equal", anchor="N")
    text = axis_label(paths, name)
    figure.set_layout_engine("constrained")  # one bar below both panels
    bar = figure.colorbar(
        ScalarMappable(norm, drawn.get_cmap()), ax=[left, right], location="bottom", shrink=0.6, aspect=45
    )
    bar.set_label(f"colour of the paths: {text}; circles: where they start", fontsize=8.0)
    bar.ax.tick_params(labelsize=8.0)
    right.axhline(1.0, color=BLACK, linewidth=1.0)
    right.set(xlim=(parameter[0], parameter[-1]), ylim=(0.0, reach), xlabel=text)
    right.set_ylabel("modulus [-], red: unstable")
    mark_operating_value(right, operating)
    return figure
