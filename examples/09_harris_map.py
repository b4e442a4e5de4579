"""
At which torques does my relief help?
=====================================

What does the static transmission error of a pair with tip relief look like below, at and above the torque
that the relief is made for? Flat at that torque; below, the relief itself is the error, above, the
deflection.
"""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import lumped
from lumped.quasi_static import with_tip_relief


def compute() -> xr.Dataset:
    """Static transmission error of the 28/28 pair, relieved for 56.5 N m, from no load to twice that."""
    pair = lumped.load_gear_pair("nasa_28_28").with_(
        mesh__stiffness={"model": "energy"}, pinion__tip_relief=None, gear__tip_relief=None
    )
    best = lumped.optimal_relief(pair, torque=56.5)
    torques = 56.5 * np.array([0.0, 0.25, 0.5, 1.0, 1.5, 2.0])
    result = lumped.static_transmission_error(with_tip_relief(pair, best), torques)
    g = lumped.geometry(pair)
    result.attrs |= {"design_torque": best.torque, "amount": best.amount, "length": best.length}
    result.attrs["double_contact"] = (g.contact_ratio - 1.0) * g.base_pitch
    return result


def draw(result: xr.Dataset) -> Figure:
    """One curve a torque over the mesh cycle."""
    figure = Figure(figsize=(7, 4), layout="constrained")
    axes = figure.add_subplot()
    for torque in result["torque"].values[::-1]:
        curve = result["transmission_error"].sel(torque=torque)
        axes.plot(result["phase"], curve * 1e6, label=f"{torque:g} N m")
    axes.set(xlabel="mesh cycles after a pair was at A", ylabel="static transmission error [µm]")
    axes.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
    return figure


if __name__ == "__main__":
    found = compute()
    for torque, error in zip(found["torque"].values, found["peak_to_peak"].values, strict=True):
        print(f"{torque:7.3f} N m: peak to peak {error * 1e6:.3f} µm")
    draw(found).savefig("harris_map.png", dpi=150)
