"""
Which parameter moves the stability margin
==========================================

What brings a pair beside a tongue closer to it? Speed, then bearing stiffness: they move the tongue.
Damping matters less by far. Derivatives of the largest multiplier, from left and right eigenvectors.
"""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import lumped
from floquet import gear_sensitivities


def compute() -> xr.Dataset:
    """Sensitivities of the 28/28 pair at the edge of its widest tongue."""
    pair = lumped.load_gear_pair("nasa_28_28").with_(
        operating__pinion_speed=16000.0, friction__law="coulomb", friction__coefficient=0.05
    )
    return gear_sensitivities(pair)


def draw(result: xr.Dataset) -> Figure:
    """Change of the spectral radius for one per cent more of each parameter."""
    figure = Figure(figsize=(7, 4), layout="constrained")
    axes = figure.add_subplot()
    order = np.argsort(np.abs(result["relative"].to_numpy()))
    names = [str(name).replace("_", " ") for name in result["parameter"].to_numpy()[order]]
    axes.barh(names, 0.01 * result["relative"].to_numpy()[order])
    axes.axvline(0.0, color="0.3", linewidth=0.8)
    axes.set(xlabel="change of the largest |multiplier| per +1 % [-]", ylabel="parameter")
    return figure


if __name__ == "__main__":
    draw(compute()).savefig("sensitivity.png", dpi=150)
