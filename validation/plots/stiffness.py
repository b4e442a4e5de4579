"""Mesh stiffness over the mesh cycle."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from lumped import MeshCycle
from validation.plots.style import BLACK, DASHES, LINES, legend, mark_switches, new_figure, scaled


def stiffness_figure(cycle: MeshCycle, points: int = 801) -> Figure:
    """Stiffness of every tooth pair and of the mesh over one mesh cycle, exact at its jumps.

    Parameters
    ----------
    cycle : mesh cycle of the pair
    points : per smooth segment, in proportion to its length
    """
    figure, axes = new_figure(height=2.8)
    ax = axes[0, 0]
    period = cycle.period
    times, values = [], []
    for segment, (low, high) in enumerate(zip(cycle.edges[:-1], cycle.edges[1:], strict=True)):
        count = max(2, round(points * (high - low) / period))
        t = np.linspace(low, high, count)
        times.append(t / period)
        values.append(cycle.sample(t, segment).stiffness)
    x, k = np.concatenate(times), np.concatenate(values, axis=1)
    factor, unit = scaled(k.sum(axis=0), unit="N/m")
    ax.plot(x, k.sum(axis=0) / factor, color=BLACK, linewidth=1.8, label="all pairs")
    for i, row in enumerate(k):
        shown = np.where(row > 0, row, np.nan)
        ax.plot(x, shown / factor, color=LINES[i], linestyle=DASHES[i + 1], label=f"pair {i}")
    mark_switches(ax, {n: t / period for n, t in cycle.events.items()})
    ax.set_xlim(0.0, 1.0)
    ax.set_ylim(bottom=0.0)
    ax.set_xlabel("time [mesh cycles]")
    ax.set_ylabel(f"stiffness [{unit}]")
    # Above the letters of the switches, which stand on the axes.
    legend(ax, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=len(k) + 1, borderaxespad=1.7)
    return figure
