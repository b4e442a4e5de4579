"""Dynamic transmission error over the mesh cycle and by mesh order."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from lumped import Geometry, mesh_cycle
from lumped.schema.pair import GearPair
from validation.cross_check.metrics import MeshOrders
from validation.plots.style import BLUE, GREY, mark_switches, mesh_cycles, new_figure, scaled


def transmission_error_figure(pair: GearPair, g: Geometry, motion: xr.Dataset, orders: MeshOrders) -> Figure:
    """Periodic dynamic transmission error: over one mesh cycle, and the amplitudes of its mesh orders.

    Parameters
    ----------
    pair, g : the gear pair and its geometry
    motion : dataset of ``lumped.steady_state``
    orders : mesh orders of ``motion["dte"]``
    """
    figure, axes = new_figure(1, 2, height=2.7, width_ratios=(1.5, 1.0))
    left, right = axes[0]
    dte = motion["dte"].to_numpy()
    factor, unit = scaled(dte, unit="m")
    left.plot(mesh_cycles(motion, g), dte / factor, color=BLUE)
    left.axhline(float(dte.mean()) / factor, color=GREY, linewidth=0.8, linestyle=":")
    left.set_xlim(0.0, 1.0)
    left.set_xlabel("time [mesh cycles]")
    left.set_ylabel(f"dynamic transmission error [{unit}]")
    cycle = mesh_cycle(pair)
    mark_switches(left, {n: t / cycle.period for n, t in cycle.events.items()})
    amplitude = orders.amplitude[1:]
    factor, unit = scaled(amplitude, unit="m")
    right.bar(orders.order[1:], amplitude / factor, width=0.6, color=BLUE)
    right.set_xticks(np.asarray(orders.order[1:]))
    right.set_xlabel("mesh order [-]")
    right.set_ylabel(f"amplitude [{unit}]")
    right.grid(False, axis="x")
    return figure
