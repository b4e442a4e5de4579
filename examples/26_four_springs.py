"""
Are four springs enough for my shafts?
======================================

The 6-DOF model hangs each gear on two springs. Where do they come from, and are they enough? The default
pair on stiff and on slender shafts, each in two bearings, with motor and load behind couplings; all sizes are
assumed. Springs condensed at rest have the stiffness of the shafts and none of their modes. Points are the
machine in exudyn, with beams of its own and the exact contact.
"""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import lumped
import multibody

BEARING = {"loa_stiffness": 2e8, "oloa_stiffness": 2e8}
BEARINGS = {"bearings": [BEARING | {"position": 30}, BEARING | {"position": 150}]}
TRAIN = {"position": 300, "inertia": 0.01, "coupling_stiffness": 1e5}
SPEEDS = np.linspace(1000.0, 6000.0, 21)
SETS = {"stiff": 60.0, "slender": 30.0}  # diameters [mm]
SHOWN = {"shafts": "-", "condensed": ":", "machine": "o"}


def on_shafts(diameter: float) -> lumped.GearPair:
    """The default pair on two shafts alike; modes are kept up to 8 kHz."""
    shaft = {"segments": [{"length": 300, "diameter": diameter}], "gear_position": 90}
    shafts = {"pinion": shaft | BEARINGS, "gear": shaft | BEARINGS, "motor": TRAIN, "load": TRAIN}
    modes = {"damping_ratio": 0.02, "max_frequency": 8000}
    return lumped.load_gear_pair("nasa_28_28").with_(shafts=shafts | modes)


def span(pair: lumped.GearPair, model: str) -> float:
    """Peak to peak of the transmission error [m]."""
    if model == "machine":
        return float(np.ptp(multibody.steady_state(pair, supports="shafts")["dte"].to_numpy()))
    if model == "condensed":
        pair = lumped.condensed_bearings(pair)
    supports = "springs" if model == "condensed" else "shafts"
    return float(lumped.steady_state(pair, supports=supports).attrs["dte_peak_to_peak"])


def compute() -> xr.Dataset:
    """Peak to peak of the transmission error over set, model and speed [m]."""
    pairs = [[on_shafts(d).with_(operating__pinion_speed=rpm) for rpm in SPEEDS] for d in SETS.values()]
    spans = [[[span(pair, model) for pair in row] for model in SHOWN] for row in pairs]
    dte = ("set", "model", "speed"), np.array(spans)
    return xr.Dataset({"dte": dte}, coords={"set": list(SETS), "model": list(SHOWN), "speed": SPEEDS})


def draw(result: xr.Dataset) -> Figure:
    """Both sets beside each other."""
    figure = Figure(figsize=(9.0, 4.0), layout="constrained")
    for axes, name in zip(figure.subplots(1, 2, sharey=True), SETS, strict=True):
        for model, look in SHOWN.items():
            values = 1e6 * result["dte"].sel(set=name, model=model)
            axes.semilogy(result["speed"], values, look, label=model)
        axes.set(xlabel=f"pinion speed [rpm], {name} shafts", ylabel="peak to peak of DTE [µm]")
    figure.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=2)
    return figure


if __name__ == "__main__":
    draw(compute()).savefig("four_springs.png")
