"""
Four springs or two shafts
==========================

The 6-DOF model hangs each gear on two springs. Where do they come from, and are they enough? The default
pair on stiff and on slender shafts, each in two bearings, with motor and load behind couplings; all sizes are
assumed. Condensed springs answer one frequency as the shafts do, here that of the mesh at 4875 rpm. Its
harmonics, and other speeds, meet modes of the shafts that no springs have.
"""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import lumped

BEARING = {"loa_stiffness": 2e8, "oloa_stiffness": 2e8}
BEARINGS = {"bearings": [BEARING | {"position": 30}, BEARING | {"position": 150}]}
TRAIN = {"position": 300, "inertia": 0.01, "coupling_stiffness": 1e5}
SPEEDS = np.linspace(1000.0, 6000.0, 21)
SETS = {"stiff": 60.0, "slender": 30.0}  # diameters [mm]


def on_shafts(diameter: float) -> lumped.GearPair:
    """The default pair on two shafts alike; modes are kept up to 8 kHz."""
    shaft = {"segments": [{"length": 300, "diameter": diameter}], "gear_position": 90}
    shafts = {"pinion": shaft | BEARINGS, "gear": shaft | BEARINGS, "motor": TRAIN, "load": TRAIN}
    modes = {"damping_ratio": 0.02, "max_frequency": 8000}
    return lumped.load_gear_pair("nasa_28_28").with_(shafts=shafts | modes)


def compute() -> xr.Dataset:
    """Peak to peak of the transmission error over speed [m], and the mode of the mesh [Hz]."""
    result = xr.Dataset(coords={"speed": SPEEDS})
    for name, diameter in SETS.items():
        pair = on_shafts(diameter)
        springs = lumped.condensed_bearings(pair, pair.geometry.mesh_frequency)
        for kind, of, supports in (("shafts", pair, "shafts"), ("springs", springs, "springs")):
            sweep = lumped.speed_sweep(of, SPEEDS, samples_per_cycle=32, supports=supports)
            result[f"{name}_{kind}"] = sweep["dte_peak_to_peak"]
        modes = lumped.shaft_modes(pair)
        of_mesh = modes["elastic_share"].sel(part="mesh").argmax("mode")
        result.attrs[name] = float(modes["natural_frequency"][of_mesh])
    return result


def draw(result: xr.Dataset) -> Figure:
    """Both sets beside each other."""
    figure = Figure(layout="constrained")
    for axes, name in zip(figure.subplots(1, 2, sharey=True), SETS, strict=True):
        for kind in ("shafts", "springs"):
            axes.semilogy(result["speed"], 1e6 * result[f"{name}_{kind}"], label=f"{name}, on {kind}")
        axes.set(xlabel="pinion speed [rpm]", ylabel="peak to peak of DTE [µm]")
        axes.legend()
    return figure


if __name__ == "__main__":
    draw(compute()).savefig("four_springs.png")
