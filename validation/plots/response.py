"""Motions beyond contact loss over speed: branches, jumps and multipliers."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from lumped.typing import FloatArray
from validation.plots.style import (
    BLACK,
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    SKY,
    legend_outside,
    mark_operation,
    new_figure,
    scaled,
)

_COLOURS = {1: BLUE, 2: GREEN, 3: PURPLE, 4: ORANGE}


def response_figure(
    branches: xr.Dataset, linear: xr.Dataset | None = None, runs: dict[str, xr.Dataset] | None = None
) -> Figure:
    """Root mean square of the transmission error over speed, stable and unstable, with multipliers below.

    Arrows are jumps on running up and down.

    Parameters
    ----------
    branches : ``dataset`` of ``floquet.response_branches``
    linear : sweep of the linear model, ``lumped.speed_sweep``; None: not drawn
    runs : "up" and "down" -> ``multibody.speed_sweep``; None: not drawn
    """
    figure, axes = new_figure(2, 1, height=5.2, sharex=True, gridspec_kw={"height_ratios": [2.2, 1.0]})
    top, bottom = axes[:, 0]
    rms = branches["dte_rms"].to_numpy()
    factor, unit = scaled(rms, unit="m")
    radius = branches["spectral_radius"].to_numpy() ** (1.0 / branches["n"].to_numpy())
    speed, stable = branches["speed_rpm"].to_numpy(), branches["stable"].to_numpy().astype(bool)
    for branch in np.unique(branches["branch"]):
        here = branches["branch"].to_numpy() == branch
        colour = _COLOURS.get(int(branches["n"].to_numpy()[here][0]), SKY)
        _line(top, speed[here], rms[here] / factor, stable[here], colour)
        _line(bottom, speed[here], radius[here], stable[here], colour)
    handles = [
        Line2D([], [], color=_COLOURS.get(n, SKY), label=_cycles(n))
        for n in sorted({int(n) for n in branches["n"].to_numpy()})
    ]
    handles.append(Line2D([], [], color=GREY, linestyle="--", linewidth=0.9, label="unstable"))
    if linear is not None:
        values = linear["dte_rms"].to_numpy() / factor
        top.plot(linear["speed"], values, color=BLACK, linestyle=":", linewidth=1.0)
        handles.append(Line2D([], [], color=BLACK, linestyle=":", linewidth=1.0, label="linear model"))
    for (way, run), marker in zip((runs or {}).items(), ("^", "v"), strict=False):
        look: dict[str, Any] = {
            "color": BLACK,
            "marker": marker,
            "linestyle": "",
            "markersize": 3.2,
            "fillstyle": "none",
        }
        top.plot(run["speed"], run["dte_rms"] / factor, **look)
        handles.append(Line2D([], [], **look, label=f"multibody, running {way}"))
    _jumps(top, branches, factor)
    low, high = branches.attrs["speed_low_rpm"], branches.attrs["speed_high_rpm"]
    top.set(ylabel=f"transmission error,\nroot mean square [{unit}]", xlim=(low, high))
    top.set_ylim(0.0, 1.06 * float(rms.max()) / factor)
    bottom.axhline(1.0, color=GREY, linewidth=0.8)
    bottom.set(ylabel="largest multiplier,\nper mesh cycle [-]", xlabel="pinion speed [rpm]")
    bottom.set_ylim(max(0.0, float(radius.min()) - 0.05), min(1.6, float(radius.max()) + 0.05))
    legend_outside(figure, handles, 4)
    mark_operation(bottom, branches.attrs["operating_rpm"], "operating point")
    return figure


def _cycles(n: int) -> str:
    return "repeats each mesh cycle" if n == 1 else f"repeats after {n}"


def _line(ax: Axes, speed: FloatArray, values: FloatArray, stable: NDArray[np.bool_], colour: str) -> None:
    """A branch: its stable stretches as a line, the others dashed."""
    calm = stable[:-1] & stable[1:]
    for wanted, look in ((True, {"linewidth": 1.6}), (False, {"linewidth": 0.9, "linestyle": (0, (4, 2))})):
        where = np.flatnonzero(calm == wanted)
        if where.size == 0:
            continue
        pieces = np.split(where, np.flatnonzero(np.diff(where) > 1) + 1)
        for piece in pieces:
            span = slice(piece[0], piece[-1] + 2)
            ax.plot(speed[span], values[span], color=colour, **look)


def _jumps(ax: Axes, branches: xr.Dataset, factor: float) -> None:
    """An arrow for each jump whose end is known."""
    for j in range(branches.sizes["jump"]):
        one = branches.isel(jump=j)
        speed, start, end = (float(one[f"jump_{name}"]) for name in ("speed_rpm", "dte_rms", "dte_rms_after"))
        if np.isfinite(end):
            ax.annotate(
                "",
                (speed, end / factor),
                (speed, start / factor),
                arrowprops={"arrowstyle": "-|>", "color": BLACK, "shrinkA": 0, "shrinkB": 0},
            )
