"""Models beside each other: lumped and multibody, forms of the contact, springs and shafts."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from numpy.typing import NDArray

from lumped import GearPair, Geometry
from lumped.typing import FloatArray
from validation.plots.style import (
    BLACK,
    BLUE,
    DASHES,
    RED,
    legend_above,
    legend_outside,
    look,
    mark_operation,
    mesh_cycles,
    new_figure,
    one_panel,
    scale_y,
    scaled,
)
from validation.validity.contact_forms import FORMS, ContactForms
from validation.validity.four_springs import LIMITS, MODELS, FourSprings

_LABELS = {
    "dte": "transmission error",
    "x_p": "pinion, along the\nline of action",
    "x_g": "gear, along the\nline of action",
    "y_p": "pinion, off the\nline of action",
    "y_g": "gear, off the\nline of action",
    "normal_load": "normal load,\nall pairs",
    "friction_force": "friction force,\nall pairs",
}
_SHOWN_CYCLES = 2


def cross_check_figure(
    g: Geometry,
    quantity: str,
    unit: str,
    reference: xr.Dataset,
    others: Mapping[str, xr.Dataset],
    keep: NDArray[np.bool_],
) -> Figure:
    """One quantity of all models over the last mesh cycles, and the differences to the lumped model below.

    Parameters
    ----------
    g : geometry of the pair
    quantity, unit : variable of the datasets and its SI unit
    reference : dataset of the lumped model
    others : fidelity -> dataset of the multibody model at the same times
    keep : which times lie off the switches; the others belong to either side of a jump, so no difference is
        drawn
    """
    figure, axes = new_figure(2, 1, height=3.9, sharex=True, height_ratios=(1.6, 1.0))
    top, bottom = axes[:, 0]
    time = reference["time"].to_numpy()
    shown = time >= time[-1] - (_SHOWN_CYCLES + 1e-9) * g.mesh_period
    x = (time[shown] - time[shown][0]) / g.mesh_period

    def history(result: xr.Dataset) -> FloatArray:
        values = result[quantity].to_numpy()[..., shown]
        return np.asarray(values.sum(axis=0) if values.ndim == 2 else values, dtype=np.float64)

    base = history(reference)
    factor = scale_y(top, _LABELS.get(quantity, quantity), unit, base)
    top.plot(x, base / factor, color=BLACK, linewidth=2.6, alpha=0.35, label="lumped")
    styles: dict[str, Any] = {
        "linear": {"color": BLUE, "linestyle": DASHES[2]},
        "exact": {"color": RED, "linestyle": DASHES[0]},
    }
    differences = {}
    for name, result in others.items():
        differences[name] = history(result) - base
        top.plot(x, history(result) / factor, **styles[name], linewidth=1.2, label=f"multibody {name}")
    # The linear difference is integration error, nine decades down: it is a number in the table, not a curve.
    drawn = [name for name in differences if name != "linear"] or list(differences)
    shares = [np.where(keep[shown], differences[name], np.nan) for name in drawn]
    factor = scale_y(bottom, f"{' and '.join(drawn)} -\nlumped", unit, *shares)
    for name, difference in zip(drawn, shares, strict=True):
        bottom.plot(x, difference / factor, color=styles[name]["color"], linewidth=1.0)
    bottom.axhline(0.0, color=BLACK, linewidth=0.5)
    bottom.set(xlabel="time, last cycles of the run [mesh cycles]", xlim=(0.0, _SHOWN_CYCLES))
    legend_above(top, 1 + len(others))
    return figure


def contact_forms_figure(pair: GearPair, found: ContactForms) -> Figure:
    """Transmission error of both forms and of the exact contact over one mesh cycle.

    ``found``: of ``contact_forms``.
    """
    figure, ax = one_panel(2.6)
    factor = scale_y(ax, "transmission error", "m", found.motions["exact"]["dte"])
    looks = {
        "exact": (BLACK, "-", "exact contact, all effects"),
        "loaded": (BLUE, (0, (5, 1.5)), FORMS["loaded"]),
        "prescribed": (RED, (0, (1.2, 1.2)), FORMS["prescribed"]),
    }
    for name, (colour, dashes, words) in looks.items():
        motion = found.motions[name]
        x = mesh_cycles(motion, pair.geometry)
        ax.plot(x, motion["dte"].to_numpy() / factor, color=colour, linestyle=dashes, label=words)
    ax.set(xlabel="time [mesh cycles]", xlim=(0.0, 1.0))
    legend_above(ax, 3)
    return figure


#: Quantity -> words of its axis.
_PANELS = {
    "dte": "transmission error,\npeak to peak",
    "force_p": "bearing forces, pinion,\nalong the LOA, p-p",
    "spectral_radius": "largest multiplier",
}


def four_springs_figure(found: FourSprings, operating_rpm: float) -> Figure:
    """Transmission error, bearing forces and largest multiplier of all models over speed.
    Shaded: speeds at which the springs of the parameters do not hold.

    ``found``: of ``four_springs``; ``operating_rpm``: marked [rpm].
    """
    figure, axes = new_figure(len(_PANELS), 1, height=5.6, sharex=True)
    speed = found.over_speed["speed"].to_numpy()
    handles = []
    for ax, (name, words) in zip(axes[:, 0], _PANELS.items(), strict=True):
        values = found.over_speed[name]
        factor, unit = (1.0, "-")
        if name != "spectral_radius":
            factor, unit = scaled(values.sel(model="shafts").to_numpy(), unit=str(values.attrs["units"]))
        lines = []
        for i, model in enumerate(("shafts", "springs", "condensed", "dynamic")):
            lines += ax.plot(speed, values.sel(model=model) / factor, **look(i), label=MODELS[model])
        machine = values.sel(model="machine") / factor  # it has no multipliers
        lines += ax.plot(speed, machine, "o", color=BLACK, markersize=4, label=MODELS["machine"])
        for low, high in found.ranges(hold=False):
            ax.axvspan(low, high, color="#f3ddd3", zorder=0, linewidth=0)
        top = float(values.sel(model=["shafts", "machine"]).max()) / factor
        # Springs may be far off: what the shafts do fills the panel.
        ax.set(ylabel=f"{words} [{unit}]", ylim=(0.0, 1.6 * top), xlim=(speed[0], speed[-1]))
        handles = lines
    mark_operation(axes[0, 0], operating_rpm, "operating point")
    axes[-1, 0].set_xlabel(
        f"pinion speed [rpm]; shaded: the given springs are off by more than {LIMITS[1]:.0%}"
    )
    legend_outside(figure, handles, 2)
    return figure
