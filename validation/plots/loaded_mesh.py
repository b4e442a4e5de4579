"""The loaded mesh at rest: load sharing, static transmission error, Harris map, tip relief."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from lumped import Geometry
from lumped.quasi_static import OptimalRelief
from validation.plots.style import (
    GREY,
    legend,
    legend_above,
    look,
    mark_operation,
    mark_switches,
    new_figure,
    one_panel,
    path_marks,
    scaled,
    write_beside,
)


def load_sharing_figure(g: Geometry, static: xr.Dataset) -> Figure:
    """Share of one tooth pair in the load over its position, beyond A and D where deflection lets it touch.

    Parameters
    ----------
    g : geometry of the pair
    static : dataset of ``lumped.static_transmission_error`` over one mesh cycle
    """
    figure, ax = one_panel(2.9)
    place = static["position"].to_numpy().ravel()
    order = np.argsort(place)
    near = (place[order] > g.L_XA - 0.25 * g.base_pitch) & (place[order] < g.L_XD + 0.25 * g.base_pitch)
    shown = static["torque"].to_numpy()
    for index, torque in enumerate(shown):
        share = static["load_share"].sel(torque=torque).to_numpy().ravel()[order]
        ax.plot(1e3 * place[order][near], share[near], **look(index), label=f"{_written(torque)} N m")
    ax.set(ylim=(0.0, 1.05), xlim=(1e3 * place[order][near][0], 1e3 * place[order][near][-1]))
    ax.set(xlabel="distance from X along the line of action [mm]", ylabel="share of one pair in the load [-]")
    mark_switches(ax, path_marks(g), letters=False)
    for letter, value in path_marks(g).items():
        write_beside(ax, letter, (value, 0.02), (2, 0))
    legend_above(ax, min(len(shown), 5))
    return figure


def harris_figure(static: xr.Dataset, harris: xr.Dataset) -> Figure:
    """Curves of static transmission error, and their peak to peak over torque for several flanks.

    Parameters
    ----------
    static : dataset of ``lumped.static_transmission_error``
    harris : ``peak_to_peak`` [m] over ``flank`` and ``torque`` [N m]; attribute ``operating_torque``
    """
    figure, axes = new_figure(1, 2, height=3.3)
    left, right = axes[0]
    phase = static["phase"].to_numpy()
    te = static["transmission_error"].to_numpy()
    factor, unit = scaled(te, unit="m")
    cycles = np.concatenate([phase, phase + 1.0])
    for index, torque in enumerate(static["torque"].to_numpy()):
        left.plot(cycles, np.tile(te[index], 2) / factor, **look(index), label=f"{_written(torque)} N m")
    left.set(xlim=(0.0, 2.0), ylim=(0.0, 1.45 * float(te.max()) / factor))
    left.set(xlabel="mesh cycles after a pair was at A", ylabel=f"static transmission error [{unit}]")
    legend(left, reverse=True, loc="upper right", ncols=2, fontsize=7.5)
    error = harris["peak_to_peak"].to_numpy()
    factor, unit = scaled(error, unit="m")
    for index, flank in enumerate(harris["flank"].to_numpy()):
        width = 2.2 if index == 0 else 1.3
        right.plot(harris["torque"], error[index] / factor, **look(index), linewidth=width, label=str(flank))
    mark_operation(right, harris.attrs["operating_torque"], "operating torque")
    right.set_xlim(0.0, float(harris["torque"].max()))
    right.set_ylim(0.0, 1.6 * float(error.max()) / factor if error.max() > 0.0 else 1.0)
    right.set(xlabel="pinion torque [N m]", ylabel=f"peak to peak [{unit}]")
    # Lines run behind it; without a ground they would cross the words.
    box = {"frameon": True, "facecolor": "white", "edgecolor": "none", "framealpha": 1.0}
    legend(right, loc="upper left", fontsize=7.5, **box)
    return figure


def relief_figure(relief: xr.Dataset, optimum: OptimalRelief) -> Figure:
    """Peak to peak static transmission error over amount and length of tip relief, with the optimum.

    Parameters
    ----------
    relief : dataset of ``lumped.quasi_static.relief_map``
    optimum : record of ``lumped.optimal_relief``
    """
    figure, ax = one_panel(3.3)
    values = relief["peak_to_peak"].to_numpy()
    factor, unit = scaled(values, unit="m")
    length, amount = 1e3 * relief["length"].to_numpy(), 1e6 * relief["amount"].to_numpy()
    filled = ax.contourf(length, amount, values / factor, levels=16, cmap="viridis")
    figure.colorbar(filled, ax=ax, label=f"peak to peak [{unit}]")
    best = (1e3 * optimum.length, 1e6 * optimum.amount)
    ax.plot(*best, "o", color="white", markeredgecolor="black")
    write_beside(ax, f"best: {best[1]:.3g} µm over {best[0]:.3g} mm", best, (8, 8), color="white")
    ax.grid(False)
    ax.set_xlabel("length of tip relief along the line of action, both gears [mm]")
    ax.set_ylabel("amount at the tip [µm]")
    ax.tick_params(color=GREY)
    return figure


def _written(torque: float) -> str:
    """A torque in four digits, never as 2e+04."""
    return f"{float(f'{torque:.4g}'):.12g}"
