"""Static transmission error: curves over the mesh cycle, Harris map over torque, map over tip relief."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

from lumped.quasi_static import OptimalRelief
from validation.plots.style import DASHES, GREY, LINES, RED, legend, new_figure, scaled


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
        left.plot(
            cycles,
            np.tile(te[index], 2) / factor,
            color=LINES[index % len(LINES)],
            linestyle=DASHES[index % len(DASHES)],
            label=f"{torque:.4g} N m",
        )
    left.set_xlim(0.0, 2.0)
    left.set_ylim(0.0, 1.45 * float(te.max()) / factor)
    left.set_xlabel("mesh cycles after a pair was at A")
    left.set_ylabel(f"static transmission error [{unit}]")
    handles, labels = left.get_legend_handles_labels()
    legend(left, handles=handles[::-1], labels=labels[::-1], loc="upper right", ncols=2, fontsize=7.5)
    error = harris["peak_to_peak"].to_numpy()
    factor, unit = scaled(error, unit="m")
    for index, flank in enumerate(harris["flank"].to_numpy()):
        right.plot(
            harris["torque"],
            error[index] / factor,
            color=LINES[index % len(LINES)],
            linestyle=DASHES[index % len(DASHES)],
            linewidth=2.2 if index == 0 else 1.3,
            label=str(flank),
        )
    right.axvline(harris.attrs["operating_torque"], color=RED, linewidth=0.9)
    right.annotate(
        "operating torque",
        (harris.attrs["operating_torque"], 1.0),
        xycoords=("data", "axes fraction"),
        xytext=(0, 2),
        textcoords="offset points",
        ha="center",
        fontsize=8.0,
        color=RED,
    )
    right.set_xlim(0.0, float(harris["torque"].max()))
    right.set_ylim(0.0, 1.6 * float(error.max()) / factor if error.max() > 0.0 else 1.0)
    right.set_xlabel("pinion torque [N m]")
    right.set_ylabel(f"peak to peak [{unit}]")
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
    figure, axes = new_figure(height=3.3)
    ax = axes[0, 0]
    values = relief["peak_to_peak"].to_numpy()
    factor, unit = scaled(values, unit="m")
    length, amount = 1e3 * relief["length"].to_numpy(), 1e6 * relief["amount"].to_numpy()
    filled = ax.contourf(length, amount, values / factor, levels=16, cmap="viridis")
    figure.colorbar(filled, ax=ax, label=f"peak to peak [{unit}]")
    ax.plot(1e3 * optimum.length, 1e6 * optimum.amount, "o", color="white", markeredgecolor="black")
    ax.annotate(
        f"best: {1e6 * optimum.amount:.3g} µm over {1e3 * optimum.length:.3g} mm",
        (1e3 * optimum.length, 1e6 * optimum.amount),
        xytext=(8, 8),
        textcoords="offset points",
        fontsize=8.0,
        color="white",
    )
    ax.grid(False)
    ax.set_xlabel("length of tip relief along the line of action, both gears [mm]")
    ax.set_ylabel("amount at the tip [µm]")
    ax.tick_params(color=GREY)
    return figure
