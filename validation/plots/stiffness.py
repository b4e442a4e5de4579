"""Stiffness of the mesh and of its parts."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from lumped import Geometry, MeshCycle
from validation.plots.style import (
    BLACK,
    BLUE,
    DASHES,
    GREEN,
    GREY,
    LINES,
    ORANGE,
    PURPLE,
    RED,
    SKY,
    legend,
    mark_switches,
    new_figure,
    one_panel,
    path_axis,
    scaled,
    switches_in_cycles,
    without_jumps,
)

_POINTS = 801  # of a mesh cycle


def stiffness_figure(cycle: MeshCycle) -> Figure:
    """Stiffness of every tooth pair and of the mesh over one mesh cycle, exact at its jumps.

    Parameters
    ----------
    cycle : mesh cycle of the pair
    """
    figure, ax = one_panel(2.8)
    period = cycle.period
    times, values = [], []
    for segment, (low, high) in enumerate(zip(cycle.edges[:-1], cycle.edges[1:], strict=True)):
        t = np.linspace(low, high, max(2, round(_POINTS * (high - low) / period)))
        times.append(t / period)
        values.append(cycle.sample(t, segment).stiffness)
    x, k = np.concatenate(times), np.concatenate(values, axis=1)
    factor, unit = scaled(k.sum(axis=0), unit="N/m")
    ax.plot(x, k.sum(axis=0) / factor, color=BLACK, linewidth=1.8, label="all pairs")
    for i, row in enumerate(k):
        shown = np.where(row > 0, row, np.nan)
        ax.plot(x, shown / factor, color=LINES[i], linestyle=DASHES[i + 1], label=f"pair {i}")
    mark_switches(ax, switches_in_cycles(cycle))
    ax.set(xlim=(0.0, 1.0), ylim=(0.0, None), xlabel="time [mesh cycles]", ylabel=f"stiffness [{unit}]")
    # Above the letters of the switches, which stand on the axes.
    legend(ax, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=len(k) + 1, borderaxespad=1.7)
    return figure


_PARTS = (("contact", GREY), ("bending", BLUE), ("shear", SKY), ("axial", ORANGE), ("foundation", GREEN))
_HATCHES = ("", "//", "", "xx", "..")


def stiffness_components_figure(g: Geometry, components: xr.Dataset) -> Figure:
    """Compliance of the parts of a tooth pair, stacked, and the pair's stiffness with ISO's c'.

    Parameters
    ----------
    g : geometry of the pair
    components : dataset of ``lumped.stiffness_components``
    """
    figure, axes = new_figure(1, 2, height=3.1)
    left, right = axes[0]
    xi = 1e3 * components["position"].to_numpy()
    names = components["component"].to_numpy().astype(str)
    compliance = components["compliance"].to_numpy()
    factor, unit = scaled(compliance.sum(axis=0), unit="m/N")
    floor = np.zeros(xi.size)
    for (part, colour), hatch in zip(_PARTS, _HATCHES, strict=True):
        rows = np.char.startswith(names, part)
        top = floor + compliance[rows].sum(axis=0) / factor
        label = part if part == "contact" else f"{part}, both teeth"
        look = {"facecolor": colour, "hatch": hatch, "label": label, "edgecolor": "white", "linewidth": 0.4}
        left.fill_between(xi, floor, top, **look, alpha=0.75)
        floor = top
    left.set(ylabel=f"compliance [{unit}]", ylim=(0.0, 1.45 * float(floor.max())))
    look = {"loc": "upper center", "fontsize": 7.0, "handlelength": 1.6, "columnspacing": 1.0}
    legend(left, reverse=True, ncols=2, **look)
    stiffness = components["stiffness"].to_numpy()
    iso = float(components.attrs["iso_single_stiffness"])
    factor, unit = scaled(stiffness, unit="N/m")
    right.plot(xi, stiffness / factor, color=BLACK, label="tooth pair, energy")
    right.axhline(iso / factor, color=RED, linestyle="--", label="ISO 6336-1, c' b")
    for which, colour, dashes in (("pinion", PURPLE, DASHES[2]), ("gear", BLUE, DASHES[3])):
        own = 1.0 / compliance[np.char.endswith(names, which)].sum(axis=0) / factor
        right.plot(xi, own, color=colour, linestyle=dashes, label=f"tooth and body of the {which}")
    right.set(ylabel=f"stiffness [{unit}]", ylim=(0.0, 1.45 * right.get_ylim()[1]))
    legend(right, loc="upper center", fontsize=7.5)
    for ax in (left, right):
        path_axis(ax, g, xi)
    return figure


def energy_mesh_figure(energy: xr.Dataset) -> Figure:
    """Total potential-energy mesh stiffness over the mesh cycle with its mean and ISO's.

    Parameters
    ----------
    energy : dataset of ``lumped.mesh_stiffness`` for the energy model
    """
    figure, ax = one_panel(2.6)
    phase = energy["phase"].to_numpy()
    total = energy["mesh_stiffness"].to_numpy()
    factor, unit = scaled(total, unit="N/m")
    x, y = without_jumps(phase, total / factor, 0.1 * float(total.max()) / factor)
    ax.plot(x, y, color=BLACK, linewidth=1.8, label="all pairs, energy")
    ax.axhline(energy.attrs["mean"] / factor, color=BLUE, linestyle="-.", label="its mean")
    ax.axhline(energy.attrs["iso_mean"] / factor, color=RED, linestyle="--", label="ISO 6336-1, c_γ b")
    ax.set(xlim=(0.0, 1.0), ylim=(0.0, 1.3 * float(total.max()) / factor))
    ax.set(xlabel="time [mesh cycles after a pair was at A]", ylabel=f"mesh stiffness [{unit}]")
    legend(ax, loc="upper right", ncols=3)
    return figure


def tooth_stiffness_figure(g: Geometry, curves: xr.Dataset) -> Figure:
    """Stiffness of a tooth pair alone over the path of contact by several ways.

    Parameters
    ----------
    g : geometry of the pair
    curves : ``curves`` of ``validation.verification.tooth_stiffness.ToothStiffness``
    """
    figure, ax = one_panel(2.8)
    stiffness = curves["stiffness"]
    factor, unit = scaled(stiffness.to_numpy(), unit="N/m")
    styles = zip((BLACK, GREY, BLUE, RED), ("-", "-", "--", "-."), strict=True)
    for name, (colour, dashes) in zip(map(str, curves["way"].to_numpy()), styles, strict=True):
        k = stiffness.sel(way=name).to_numpy() / factor
        ax.plot(curves["position"].to_numpy() * 1e3, k, color=colour, linestyle=dashes, label=name)
    path_axis(ax, g)
    ax.set(ylim=(0.0, None), ylabel=f"stiffness [{unit}]")
    legend(ax, loc="lower center", ncols=2)
    return figure
