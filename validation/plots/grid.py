"""Regression grid as heat maps: where the models differ by how much, and where a rule does not apply."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from numpy.typing import NDArray

from lumped.friction import LAWS
from validation.cross_check.grid.run import COMPARED, SEPARATED, STICKING
from validation.plots.style import BLACK, GREY, IN_X, new_figure, write_beside

_MARKS = {SEPARATED: ("s", "teeth separate"), STICKING: ("o", "friction may hold the teeth")}


def grid_figure(result: xr.Dataset) -> Figure:
    """How much the exact model differs at every point, and how much of its tolerance what is left uses.

    Rows are gear pairs and stiffness models; columns friction laws, within them speeds, within them torques
    from high to low. Above, the largest difference of the transmission error over its peak to peak; below,
    the largest share of a tolerance over all quantities, after the predicted part is taken off. Marks tell
    why a point is not judged; a cross, that a model failed.

    Parameters
    ----------
    result : dataset of ``validation.cross_check.grid.run.crosscheck_grid``
    """
    rows, columns = ("preset", "stiffness"), ("law", "speed", "torque")
    status = result["status"].transpose(*rows, *columns).to_numpy()
    shape = (int(np.prod(status.shape[:2])), int(np.prod(status.shape[2:])))
    status = status.reshape(shape)
    judged = result["status"] == COMPARED
    exact = result.sel(fidelity="exact")
    usage = (exact["difference"] / exact["limit"]).where(judged).max("quantity")
    figure, axes = new_figure(2, 1, height=2.6 + 0.44 * shape[0], sharex=True)
    figure.set_layout_engine("constrained")  # few rows leave less room than their words take
    for ax, values, label in (
        (
            axes[0, 0],
            exact["largest"].sel(quantity="dte"),
            "dte, exact: largest\ndifference / peak to peak [-]",
        ),
        (axes[1, 0], usage, "largest share of\na tolerance, all quantities [-]"),
    ):
        table = values.transpose(*rows, *columns).to_numpy().reshape(shape)
        finite = table[np.isfinite(table) & (table > 0.0)]
        low, high = (float(finite.min()), float(finite.max())) if finite.size else (1e-6, 1.0)
        ax.grid(visible=False)
        norm = LogNorm(low, max(high, 1.01 * low))
        image = ax.imshow(table, norm=norm, cmap="viridis", aspect="auto", interpolation="nearest")
        bar = figure.colorbar(image, ax=ax, pad=0.01, aspect=20)
        bar.set_label(label, fontsize=8.0)
        bar.ax.tick_params(labelsize=7.0)
        _marks(ax, status, legend=ax is axes[0, 0])
        _frame(ax, result)
    top, bottom = axes[:, 0]
    _laws(top, result)
    torques = result.sizes["torque"]
    bottom.set_xticks(
        torques * np.arange(shape[1] // torques) + 0.5 * (torques - 1),
        [f"{s:g}" for _ in result["law"].to_numpy() for s in result["speed"].to_numpy()],
        fontsize=7.0,
    )
    shares = ", ".join(f"{t:g}" for t in result["torque"].to_numpy())
    bottom.set_xlabel(
        f"share of the preset's speed; within each, torque {shares} of the preset's [-]", fontsize=8.0
    )
    figure.legend(loc="outside lower center", ncols=3, frameon=False, fontsize=7.5)
    return figure


def _marks(ax: Axes, status: NDArray[np.str_], *, legend: bool) -> None:
    """Say why a point is not judged."""
    # Points are drawn on the boundary between nothing and colour: grey and black are readable on both.
    for state, (marker, text) in _MARKS.items():
        y, x = np.nonzero(status == state)
        label = text if legend else None
        ax.scatter(x, y, 9, marker=marker, facecolor="none", edgecolor=GREY, linewidth=0.8, label=label)
    y, x = np.nonzero(~np.isin(status, [COMPARED, *_MARKS]))
    label = "a model failed" if legend else None
    ax.scatter(x, y, 16, marker="x", color=BLACK, linewidth=1.0, label=label)


def _frame(ax: Axes, result: xr.Dataset) -> None:
    """Name the rows, and part gear pairs and laws by white lines."""
    names = [f"{p}, {s}" for p in result["preset"].to_numpy() for s in result["stiffness"].to_numpy()]
    ax.set_yticks(range(len(names)), names, fontsize=7.0)
    ax.set_ylabel("preset, stiffness model", fontsize=8.0)
    for i in range(1, result.sizes["preset"]):
        ax.axhline(result.sizes["stiffness"] * i - 0.5, color="white", linewidth=1.6)
    for i in range(1, result.sizes["law"]):
        ax.axvline(result.sizes["speed"] * result.sizes["torque"] * i - 0.5, color="white", linewidth=1.6)


def _laws(ax: Axes, result: xr.Dataset) -> None:
    """Name the laws above their columns."""
    width = result.sizes["speed"] * result.sizes["torque"]
    for i, law in enumerate(result["law"].to_numpy()):
        name = str(law)
        words = f"law {LAWS[name].numeral}" if LAWS[name].numeral else name
        write_beside(ax, words, (width * (i + 0.5) - 0.5, 1.0), (0, 3), IN_X, ha="center")
