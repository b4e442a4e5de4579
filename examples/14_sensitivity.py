"""
Which parameter moves the stability margin?
===========================================

Which parameter moves a pair that runs beside a tongue closer to it? Speed, then bearing stiffness, which
moves the tongue. Damping matters far less. The derivatives are central differences of the largest multiplier,
whose error is 1e-12.
"""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import floquet
import lumped
from floquet.gear.axes import vary

STEP = 1e-4  # over the value: the error of a difference is its square, times the curvature


def compute() -> xr.Dataset:
    """Change of the spectral radius of the 28/28 pair beside its widest tongue by each parameter."""
    pair = lumped.load_gear_pair("nasa_28_28").with_(
        operating__pinion_speed=16000.0, friction__law="coulomb", friction__coefficient=0.05
    )
    slopes = {name: _slope(pair, name, axis.own(pair)) for name, axis in floquet.GEAR_AXES.items()}
    return xr.Dataset({"relative": ("parameter", list(slopes.values()))}, {"parameter": list(slopes)})


def _slope(pair: lumped.GearPair, name: str, value: float) -> float:
    """The parameter times the derivative of the spectral radius with respect to it."""
    low, high = (vary(pair, {name: value * factor}) for factor in (1.0 - STEP, 1.0 + STEP))
    radius = [floquet.gear_pair_multipliers(one, 1e-12).spectral_radius for one in (low, high)]
    return (radius[1] - radius[0]) / (2.0 * STEP)


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
