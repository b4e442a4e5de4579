"""
Which form of the contact fits my gears?
========================================

How does a tooth pair begin its contact? Prescribed contact begins at A, with a stiffness that jumps. Loaded
contact begins where the static load has closed the gap of the tip corner. The multibody model, whose contact
follows from the gap and from an elastic energy, decides: at low speed loaded contact differs from it by a
hundredth of the peak to peak, prescribed contact by more than the peak to peak itself.
"""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import lumped
import multibody

SPEEDS = (500.0, 1000.0, 2000.0, 3000.0, 4000.0, 4875.0, 6000.0, 8000.0)
FORMS = ("prescribed", "loaded")


def motions(pair: lumped.GearPair) -> dict[str, np.ndarray]:
    """Transmission error over a mesh cycle [m] in both forms of the lumped model, and with exact contact."""
    results = {
        form: lumped.steady_state(pair.with_(mesh__contact=form), samples_per_cycle=128) for form in FORMS
    }
    results["exact"] = multibody.steady_state(pair.with_(mesh__contact="loaded"), samples_per_cycle=128)
    return {name: motion["dte"].to_numpy()[:128] for name, motion in results.items()}


def compute() -> xr.Dataset:
    """Largest difference of both forms from the exact contact over speed, and the motions at 2000 rpm."""
    pair = lumped.load_gear_pair("nasa_28_28").with_(
        mesh__stiffness={"model": "energy"}, mesh__relief="ignored"
    )
    motions_by_speed = [motions(pair.with_(operating__pinion_speed=speed)) for speed in SPEEDS]
    differences = {
        form: ("speed", [np.abs(m[form] - m["exact"]).max() / np.ptp(m["exact"]) for m in motions_by_speed])
        for form in FORMS
    }
    shown = {f"dte_{name}": ("cycles", dte) for name, dte in motions_by_speed[SPEEDS.index(2000.0)].items()}
    return xr.Dataset(differences | shown, coords={"speed": list(SPEEDS), "cycles": np.arange(128) / 128})


def draw(result: xr.Dataset) -> Figure:
    """Left: one mesh cycle at 2000 rpm. Right: the difference over speed."""
    figure = Figure(figsize=(9, 3.6), layout="constrained")
    motion_axes, difference_axes = figure.subplots(1, 2)
    for name, words, line in (
        ("exact", "exact contact", "k-"),
        ("loaded", "loaded contact", "C0--"),
        ("prescribed", "prescribed contact", "C1:"),
    ):
        motion_axes.plot(result["cycles"], 1e6 * result[f"dte_{name}"], line, label=words)
        if name != "exact":
            difference_axes.semilogy(result["speed"], 100 * result[name], line + "o", label=words)
    motion_axes.set(xlabel="time [mesh cycles]", ylabel="transmission error at 2000 rpm [µm]")
    difference_axes.set(xlabel="pinion speed [rpm]", ylabel="off the exact contact / peak to peak [%]")
    figure.legend(*motion_axes.get_legend_handles_labels(), loc="outside upper center", ncols=3)
    return figure


if __name__ == "__main__":
    found = compute()
    print((100 * found[["prescribed", "loaded"]]).to_dataframe().round(2))
    draw(found).savefig("contact_forms.png", dpi=150)
