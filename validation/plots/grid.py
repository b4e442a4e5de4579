"""Regression grid as a heat map: where the models differ by how much, and where a rule does not apply."""

from __future__ import annotations

import numpy as np
import xarray as xr
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure

from validation.grid import COMPARED, SEPARATED, STICKING
from validation.plots.style import BLACK, GREY, new_figure

_MARKS = {SEPARATED: ("s", "teeth separate"), STICKING: ("o", "sliding may stick")}
_SHORT = {
    "coulomb": "I",
    "benedict_kelley": "II",
    "xu_kahraman": "III",
    "smoothed_coulomb": "IV",
    "composite": "V",
}


def grid_figure(result: xr.Dataset, quantity: str = "dte", fidelity: str = "exact") -> Figure:
    """Largest difference over peak to peak at every point.

    Rows are gear pairs and stiffness models; columns friction laws, within them speeds, within them torques
    from high to low. Marks tell why a point is not judged; a cross, that a model failed.

    Parameters
    ----------
    result : dataset of ``validation.grid.crosscheck_grid``
    quantity, fidelity : what to show
    """
    rows, columns = ("preset", "stiffness"), ("law", "speed", "torque")
    values = result["largest"].sel(fidelity=fidelity, quantity=quantity).transpose(*rows, *columns)
    status = result["status"].transpose(*rows, *columns).to_numpy()
    shape = (values.shape[0] * values.shape[1], int(np.prod(values.shape[2:])))
    table, status = values.to_numpy().reshape(shape), status.reshape(shape)
    finite = table[np.isfinite(table) & (table > 0.0)]
    low, high = (float(finite.min()), float(finite.max())) if finite.size else (1e-6, 1.0)
    figure, axes = new_figure(1, 1, height=1.6 + 0.26 * shape[0])
    ax = axes[0, 0]
    ax.grid(visible=False)
    norm = LogNorm(low, max(high, 1.01 * low))
    image = ax.imshow(table, norm=norm, cmap="viridis", aspect="auto", interpolation="nearest")
    # Points are drawn on the boundary between nothing and colour: grey and black are readable on both.
    for state, (marker, label) in _MARKS.items():
        y, x = np.nonzero(status == state)
        ax.scatter(x, y, 9, marker=marker, facecolor="none", edgecolor=GREY, linewidth=0.8, label=label)
    y, x = np.nonzero(~np.isin(status, [COMPARED, *_MARKS]))
    ax.scatter(x, y, 16, marker="x", color=BLACK, linewidth=1.0, label="a model failed")
    ax.set_yticks(
        range(shape[0]),
        [f"{p}, {s}" for p in result["preset"].to_numpy() for s in result["stiffness"].to_numpy()],
        fontsize=7.0,
    )
    speeds, torques = result.sizes["speed"], result.sizes["torque"]
    ax.set_xticks(
        torques * np.arange(shape[1] // torques) + 0.5 * (torques - 1),
        [f"{s:g}" for _ in result["law"].to_numpy() for s in result["speed"].to_numpy()],
        fontsize=7.0,
    )
    width = speeds * torques
    for i, law in enumerate(result["law"].to_numpy()):
        name = str(law)
        text = f"law {_SHORT[name]}" if name in _SHORT else name
        ax.annotate(
            text,
            (width * (i + 0.5) - 0.5, 1.0),
            xycoords=("data", "axes fraction"),
            xytext=(0, 3),
            textcoords="offset points",
            ha="center",
            fontsize=8.0,
        )
        if i:
            ax.axvline(width * i - 0.5, color="white", linewidth=1.6)
    for i in range(1, result.sizes["preset"]):
        ax.axhline(result.sizes["stiffness"] * i - 0.5, color="white", linewidth=1.6)
    shares = ", ".join(f"{t:g}" for t in result["torque"].to_numpy())
    ax.set_xlabel(f"share of the preset's speed; within each, torque {shares} of the preset's")
    bar = figure.colorbar(image, ax=ax, pad=0.01, aspect=30)
    bar.set_label(f"{quantity}, {fidelity}: largest difference / peak to peak")
    figure.legend(loc="outside lower center", ncols=3, frameon=False, fontsize=7.5)
    return figure
