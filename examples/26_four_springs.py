"""
Four springs or two shafts
==========================

The 6-DOF model hangs each gear on two springs. Where do they come from, and are they enough? The default
pair on stiff shafts of 60 mm and on slender ones of 30 mm, each in two bearings 120 mm apart, with a motor and
a load behind couplings; sizes, bearings and inertias are assumed. Springs condensed from the shafts answer one
frequency as the shafts do, here that of the mesh at 4875 rpm. Its harmonics, and other speeds, meet modes of
the shafts that no springs have.
"""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import lumped

BEARING = {"loa_stiffness": 2e8, "oloa_stiffness": 2e8}
SPEEDS = np.linspace(1000.0, 6000.0, 21)
#: Diameters of the shafts [mm].
SETS = {"stiff": 60.0, "slender": 30.0}


def on_shafts(diameter: float) -> lumped.GearPair:
    """The default pair on two shafts alike; modes are kept up to 8 kHz."""
    shaft = {
        "segments": [{"length": 300.0, "diameter": diameter}],
        "gear_position": 90.0,
        "bearings": [{"position": 30.0} | BEARING, {"position": 150.0} | BEARING],
    }
    train = {"position": 300.0, "inertia": 0.01, "coupling_stiffness": 1e5}
    shafts = {"pinion": shaft, "gear": shaft, "motor": train, "load": train}
    return lumped.load_gear_pair("nasa_28_28").with_(
        shafts=shafts | {"damping_ratio": 0.02, "max_frequency": 8000.0}
    )


def compute() -> xr.Dataset:
    """Peak to peak of the transmission error over speed [um], on shafts and on springs, and the modes."""
    result = xr.Dataset(coords={"speed": SPEEDS})
    for name, diameter in SETS.items():
        pair = on_shafts(diameter)
        springs = lumped.condensed_bearings(pair, pair.geometry.mesh_frequency)
        for kind, sweep in (
            ("shafts", lumped.speed_sweep(pair, SPEEDS, samples_per_cycle=32, supports="shafts")),
            ("springs", lumped.speed_sweep(springs, SPEEDS, samples_per_cycle=32)),
        ):
            result[f"{name}_{kind}"] = ("speed", 1e6 * sweep["dte_peak_to_peak"].to_numpy())
        modes = lumped.shaft_modes(pair)
        result.attrs[name] = [
            f"{frequency:.0f} Hz: {of}"
            for frequency, of in zip(modes["natural_frequency"].values, modes["name"].values, strict=True)
            if frequency < 4000.0 and "whirling" not in of and "along y" not in of
        ]
    return result


def draw(result: xr.Dataset) -> Figure:
    """Both sets beside each other."""
    figure = Figure(figsize=(9, 3.6), layout="constrained")
    for axes, name in zip(figure.subplots(1, 2, sharey=True), SETS, strict=True):
        for kind, line in (("shafts", "C0-"), ("springs", "C1--")):
            axes.semilogy(result["speed"], result[f"{name}_{kind}"], line, label=f"on {kind}")
        axes.set(
            xlabel="pinion speed [rpm]", ylabel="peak to peak of the transmission error [µm]", title=name
        )
        axes.legend()
    return figure


if __name__ == "__main__":
    found = compute()
    print(found.to_dataframe().round(2))
    for name in SETS:
        print(name, *found.attrs[name], sep="\n  ")
    draw(found).savefig("four_springs.png", dpi=150)
