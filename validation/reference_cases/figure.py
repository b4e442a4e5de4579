"""The picture of a reference case: one panel a channel."""

from __future__ import annotations

from matplotlib.figure import Figure

from lumped.typing import FloatArray
from validation.check.curves import Channel, Curves
from validation.plots.style import BLUE, GREY, new_figure, scale_y

#: Words above a panel where the plain name is too long.
_SHORT = {
    "theta_p": "pinion rotation about its mean",
    "x_p": "pinion along the line of action",
    "x_g": "gear along the line of action",
    "y_p": "pinion across the line of action",
    "y_g": "gear across the line of action",
    "dte_dot": "rate of the transmission error",
    "mesh_force": "mesh force",
    "friction": "friction force",
    "bearing_force_x_p": "pinion bearing force along the line of action",
}


def case_figure(curves: Curves, mesh_period: float, mesh_cycles: int) -> Figure:
    """Draw every channel over the period.

    Parameters
    ----------
    curves : curves over the period, with the time as abscissa
    mesh_period : mesh cycle [s]
    mesh_cycles : mesh cycles of the period
    """
    channels = curves.channels
    rows = -(-len(channels) // 2)
    figure, axes = new_figure(rows, 2, height=0.5 + 1.7 * rows, sharex=True)
    place = curves.places / mesh_period
    panels = axes.ravel().tolist()
    for ax in panels[len(channels) :]:
        ax.set_visible(False)
    for ax, channel in zip(panels, channels, strict=False):
        values = _drawn(channel)
        factor = scale_y(ax, channel.quantity, channel.kind.unit, values)
        ax.set_title(_SHORT.get(channel.quantity, channel.kind.words), loc="left", fontsize=8.5)
        ax.plot(place, values / factor, color=BLUE, linewidth=1.0 if mesh_cycles == 1 else 0.6)
        if values.min() < 0.0 < values.max():
            ax.axhline(0.0, color=GREY, linewidth=0.6)
        ax.set(xlim=(0.0, mesh_cycles))
    for ax in panels[max(len(channels) - 2, 0) : len(channels)]:
        ax.tick_params(labelbottom=True)
        ax.set_xlabel("time [mesh cycles]")
    return figure


def _drawn(channel: Channel) -> FloatArray:
    """Values of a channel; an angle, which has no zero, is drawn about its mean."""
    values = channel.values
    return values - values.mean() if channel.quantity.startswith("theta") else values
