"""Floquet multipliers in the complex plane, at one point and along a parameter."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from floquet.gear.multipliers import GearPairMultipliers
from validation.plots.style import BLACK, BLUE, GREY, RED, legend, one_panel


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
