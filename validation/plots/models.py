"""Models beside each other: lumped and multibody, forms of the contact, springs and shafts."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from numpy.typing import NDArray

from lumped import Geometry
from lumped.typing import FloatArray
from validation.plots.style import (
    BLACK,
    BLUE,
    DASHES,
    RED,
    legend_above,
    new_figure,
    scale_y,
)

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

    ``others``: fidelity -> multibody motion at the times of ``reference``; ``keep``: which times lie off the
    switches. The others belong to either side of a jump, so no difference is drawn.
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


#: Quantity -> words of its axis.
_PANELS = {
    "dte": "transmission error,\npeak to peak",
    "force_p": "bearing forces, pinion,\nalong the LOA, p-p",
    "spectral_radius": "largest multiplier",
}
