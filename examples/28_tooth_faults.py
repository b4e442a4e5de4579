"""
What does each tooth fault sound like?
======================================

An eccentric gear makes order 1, and one sideband on each side of the mesh harmonics. Pitch errors fall from
order 1. A fault of one tooth makes a comb of all orders: that of a crack falls towards the mesh order, and
that of a spall or a chip stays flat past it.
"""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import lumped
import spurcheck

FAULTS = {
    "eccentric 20 µm": {"pinion.mounting": {"eccentricity": 20}},
    "class 6": {"pinion.deviations": {"tolerance_class": 6, "seed": 1}},
    "crack 1 mm": {"pinion.faults": [{"kind": "crack", "tooth": 4, "depth": 1.0}]},
    "spall": {
        "pinion.faults": [
            {"kind": "spall", "tooth": 4, "start_roll_angle": 19, "end_roll_angle": 22, "width": 3}
        ]
    },
    "chip": {"pinion.faults": [{"kind": "chip", "tooth": 4, "roll_angle": 27}]},
}


def compute() -> xr.Dataset:
    """Amplitudes of the transmission error at the orders of the pinion."""
    pair = lumped.load_gear_pair("nasa_28_28").with_({"friction.law": "none", "operating.pinion_speed": 1450})
    rows = []
    for changes in FAULTS.values():
        motion = lumped.steady_state(pair.with_(changes), contact="unilateral", samples_per_cycle=256)
        rows.append(spurcheck.order_spectrum(motion, "pinion")["amplitude"])
    return xr.Dataset({"amplitude": xr.concat(rows, dim="fault").assign_coords(fault=list(FAULTS))})


def draw(result: xr.Dataset) -> Figure:
    """Amplitudes over the orders, one fault a row."""
    figure = Figure(figsize=(6, 8), layout="constrained")
    for axes, name in zip(figure.subplots(len(FAULTS), sharex=True, sharey=True), FAULTS, strict=True):
        shown = result["amplitude"].sel(fault=name).isel(order=slice(1, 71))
        axes.vlines(shown["order"], 1e-5, np.maximum(1e6 * shown, 1e-5))
        axes.set(yscale="log", ylim=(1e-5, 50), ylabel="µm", title=name, xticks=[1, 28, 56])
        axes.set_xlabel("order of the pinion")
    return figure


if __name__ == "__main__":
    draw(compute()).savefig("tooth_faults.png", dpi=150)
