"""
Which relief for my torque?
===========================

How much tip relief, and over which length, makes the static transmission error smallest at one torque?
And what does it do at others (Harris map)? A relief suits one torque: well below this torque it increases the
transmission error.
"""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import lumped
from lumped.quasi_static import optimal_relief, static_transmission_error, with_tip_relief


def compute() -> xr.Dataset:
    """Peak-to-peak static transmission error over torque, with and without the best linear relief."""
    pair = lumped.load_gear_pair("nasa_28_28").with_(
        mesh__stiffness={"model": "energy"}, pinion__tip_relief=None, gear__tip_relief=None
    )
    best = optimal_relief(pair)
    torques = np.linspace(1.0, 120.0, 120)
    curves = {
        name: static_transmission_error(one, torques, extended=False)["peak_to_peak"]
        for name, one in (("involute", pair), ("relieved", with_tip_relief(pair, best)))
    }
    attrs = {"design_torque": best.torque, "amount": best.amount, "length": best.length}
    return xr.Dataset(curves, attrs=attrs)


def draw(result: xr.Dataset) -> Figure:
    """Both curves over torque, the design torque marked."""
    figure = Figure(figsize=(7, 4), layout="constrained")
    axes = figure.add_subplot()
    for name in ("involute", "relieved"):
        axes.plot(result["torque"], result[name] * 1e6, label=name)
    axes.axvline(result.attrs["design_torque"], color="0.6", linewidth=0.8, label="design torque")
    axes.set(xlabel="pinion torque [N m]", ylabel="static transmission error, peak to peak [µm]")
    axes.legend()
    return figure


if __name__ == "__main__":
    draw(compute()).savefig("tip_relief_optimum.png", dpi=150)
