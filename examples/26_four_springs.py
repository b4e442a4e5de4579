"""
Four springs or two shafts
==========================

The 6-DOF model hangs each gear on two springs. Where do they come from, and are they enough? The default
pair on stiff and on slender shafts, each in two bearings, with motor and load behind couplings; all sizes are
assumed. Springs condensed at rest know the stiffness of the shafts and no mode of theirs; condensed at the
mesh frequency they answer that one frequency as the shafts do, not its harmonics. Points are the machine in
exudyn, with beams of its own and the exact contact.
"""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import lumped
from validation.validity.four_springs import MODELS, four_springs

BEARING = {"loa_stiffness": 2e8, "oloa_stiffness": 2e8}
BEARINGS = {"bearings": [BEARING | {"position": 30}, BEARING | {"position": 150}]}
TRAIN = {"position": 300, "inertia": 0.01, "coupling_stiffness": 1e5}
SPEEDS = np.linspace(1000.0, 6000.0, 21)
SETS = {"stiff": 60.0, "slender": 30.0}  # diameters [mm]
SHOWN = {"shafts": "-", "condensed": ":", "dynamic": "--", "machine": "o"}


def on_shafts(diameter: float) -> lumped.GearPair:
    """The default pair on two shafts alike; modes are kept up to 8 kHz."""
    shaft = {"segments": [{"length": 300, "diameter": diameter}], "gear_position": 90}
    shafts = {"pinion": shaft | BEARINGS, "gear": shaft | BEARINGS, "motor": TRAIN, "load": TRAIN}
    modes = {"damping_ratio": 0.02, "max_frequency": 8000}
    return lumped.load_gear_pair("nasa_28_28").with_(shafts=shafts | modes)


def compute() -> xr.Dataset:
    """Peak to peak of the transmission error over set, model and speed [m], and the mode of the mesh [Hz]."""
    found = {name: four_springs(on_shafts(diameter), SPEEDS) for name, diameter in SETS.items()}
    result = xr.concat([one.over_speed["dte"] for one in found.values()], "set").to_dataset()
    for name, one in found.items():
        of_mesh = one.modes["elastic_share"].sel(part="mesh").argmax("mode")
        result.attrs[name] = float(one.modes["natural_frequency"][of_mesh])
    return result.assign_coords(set=list(found))


def draw(result: xr.Dataset) -> Figure:
    """Both sets beside each other."""
    figure = Figure(figsize=(9.0, 4.0), layout="constrained")
    for axes, name in zip(figure.subplots(1, 2, sharey=True), SETS, strict=True):
        for model, look in SHOWN.items():
            values = 1e6 * result["dte"].sel(set=name, model=model)
            axes.semilogy(result["speed"], values, look, label=MODELS[model])
        axes.set(xlabel=f"pinion speed [rpm], {name} shafts", ylabel="peak to peak of DTE [µm]")
    figure.legend(*axes.get_legend_handles_labels(), loc="outside upper center", ncols=2)
    return figure


if __name__ == "__main__":
    draw(compute()).savefig("four_springs.png")
