"""
Where must I not run?
=====================

Where are the resonances of the periodic motion, and which mode do they belong to? At the
largest resonance the mesh frequency equals the highest natural frequency of the averaged pair; at the next
one, twice the mesh frequency does. At both the teeth may separate, and then the linear model is not valid.
"""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import lumped
from lumped.model.averaged import modes


def compute() -> xr.Dataset:
    """Peak-to-peak transmission error of the 28/28 pair, with the speeds at which mesh frequency = a mode."""
    pair = lumped.load_gear_pair("nasa_28_28")
    result = lumped.speed_sweep(pair, np.linspace(2000.0, 20000.0, 91), samples_per_cycle=64)
    result.attrs["resonant_speeds"] = [mode.resonant_speed for mode in modes(pair)]
    return result


def draw(result: xr.Dataset) -> Figure:
    """Peak-to-peak over pinion speed, resonant speeds marked."""
    figure = Figure(figsize=(7, 4), layout="constrained")
    axes = figure.add_subplot()
    axes.plot(result["speed"], result["dte_peak_to_peak"] * 1e6)
    for speed in result.attrs["resonant_speeds"]:
        line = axes.axvline(speed, color="0.6", linewidth=0.8, linestyle="--")
    line.set_label("mesh frequency = natural frequency")
    axes.legend()
    axes.set(xlabel="pinion speed [rpm]", ylabel="transmission error, peak to peak [µm]")
    return figure


if __name__ == "__main__":
    draw(compute()).savefig("dte_over_speed.png", dpi=150)
