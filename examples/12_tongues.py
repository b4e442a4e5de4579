"""
At which speeds is the motion unstable?
=======================================

A stiffness that varies with the mesh frequency drives a mode where that frequency is (ω_i + ω_j)/k. How
wide are those ranges of speed, and how much damping closes them? Only the widest, 2ω_3/2, survives 1 %.
"""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import floquet
import lumped


def compute() -> xr.Dataset:
    """Boundaries of the tongues of the 28/28 pair without relief, with constant friction coefficient."""
    pair = lumped.load_gear_pair("nasa_28_28").with_(
        mesh__contact="prescribed",
        mesh__relief="ignored",
        friction__law="coulomb",
        friction__coefficient=0.05,
    )
    damping = np.geomspace(1e-3, 0.03, 12)
    boundaries = floquet.stability_boundaries(
        pair, (5000.0, 20000.0), {"damping_ratio": damping}, nodes=150, xtol=1e-4
    )
    lines = {str(tongue): speed for tongue, speed in floquet.predicted_lines(pair).items()}
    return boundaries.assign(
        predicted=("tongue", [lines[str(label)] for label in boundaries["label"].values])
    )


def draw(result: xr.Dataset) -> Figure:
    """Shade each tongue, with the predicted speed as a dashed line."""
    figure = Figure(figsize=(7, 4), layout="constrained")
    axes = figure.add_subplot()
    for row in range(result.sizes["tongue"]):
        tongue = result.isel(tongue=row)
        axes.fill_betweenx(tongue["damping_ratio"] * 100, tongue["lower"], tongue["upper"], alpha=0.5)
        axes.axvline(float(tongue["predicted"]), color="0.5", linewidth=0.8, linestyle="--")
        place = (float(tongue["peak"][0]), 100 * float(result["damping_ratio"][0]))
        name = str(tongue["label"].item()).replace("w3", "ω$_3$")
        axes.annotate(name, place, (-5, 4), textcoords="offset points", ha="right", rotation=90)
    axes.set(xlabel="pinion speed [rpm]", ylabel="mesh damping ratio [%]", yscale="log")
    return figure


if __name__ == "__main__":
    draw(compute()).savefig("tongues.png", dpi=150)
