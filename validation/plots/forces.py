"""Normal load and friction force of every tooth pair over the mesh cycle."""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from lumped import Geometry, mesh_cycle
from lumped.schema.pair import GearPair
from validation.plots.style import (
    BLACK,
    DASHES,
    GREY,
    LINES,
    legend,
    mark_switches,
    mesh_cycles,
    new_figure,
    scaled,
    with_gaps,
)


def tooth_forces_figure(pair: GearPair, g: Geometry, motion: xr.Dataset) -> Figure:
    """Normal load and friction force per tooth pair and in total, over one mesh cycle.

    Parameters
    ----------
    pair, g : the gear pair and its geometry
    motion : dataset of ``lumped.steady_state``
    """
    figure, axes = new_figure(2, 1, height=4.4, sharex=True)
    x = mesh_cycles(motion, g)
    touching = motion["contact"].to_numpy() > 0
    cycle = mesh_cycle(pair)
    for ax, name, label in (
        (axes[0, 0], "normal_load", "normal load"),
        (axes[1, 0], "friction_force", "friction force"),
    ):
        values = motion[name].to_numpy()
        factor, unit = scaled(values, values.sum(axis=0), unit="N")
        ax.plot(x, values.sum(axis=0) / factor, color=BLACK, linewidth=0.9, label="all pairs")
        for i, row in enumerate(values):
            ax.plot(
                x,
                with_gaps(x, row, touching[i]) / factor,
                color=LINES[i % len(LINES)],
                linestyle=DASHES[i % len(DASHES)],
                linewidth=1.8,
                label=f"pair {i}" + (" (ahead)" if i == 0 else ""),
            )
        ax.axhline(0.0, color=GREY, linewidth=0.6)
        ax.set_ylabel(f"{label} [{unit}]")
    marks = {n: t / cycle.period for n, t in cycle.events.items()}
    mark_switches(axes[0, 0], marks)
    mark_switches(axes[1, 0], marks, letters=False)
    axes[1, 0].set_xlabel("time [mesh cycles]")
    axes[1, 0].set_xlim(0.0, 1.0)
    legend(axes[0, 0], loc="best")
    return figure
