"""
What do bore and rim do to the tooth stiffness?
===============================================

What do a bore, a thin rim and a loaded neighbour do to the stiffness of the mesh and to the transmission
error? A bore hardly matters for a free gear until its rim bends between the teeth. The neighbour loads the
same body: this makes two pairs softer, so that the step from one pair to two is smaller.
"""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import lumped

BODIES = {"solid": 0.0, "bore 40 mm": 40.0, "rim 3 modules": 61.9}  # bore [mm]


def compute() -> xr.Dataset:
    """Mean stiffness over ISO's and transmission error with three bodies."""
    model = {"mesh.stiffness": {"model": "finite_elements"}, "mesh.contact": "loaded"}
    model |= {"pinion.tip_relief": None, "gear.tip_relief": None}
    pair = lumped.load_gear_pair("nasa_28_28").with_(model)
    errors = []
    ratios = []
    for bore in BODIES.values():
        one = pair.with_(pinion__bore=bore, gear__bore=bore)
        forms = one, one.with_(mesh__contact="prescribed")  # which leaves pairs alone
        errors.append([lumped.static_transmission_error(form)["transmission_error"][0] for form in forms])
        stiffness = lumped.plane_compliance(one).attrs
        ratios.append([stiffness[name] / stiffness["iso_mean"] for name in ("mean", "mean_alone")])
    result = xr.Dataset(coords={"body": list(BODIES), "pairs": ["coupled", "alone"]})
    result["error"] = ("body", "pairs", "phase"), np.array(errors)
    return result.assign(mean_over_iso=(("body", "pairs"), ratios))


def draw(result: xr.Dataset) -> Figure:
    """Static transmission error over a mesh cycle."""
    figure = Figure(figsize=(6, 3.6), layout="constrained")
    axes = figure.subplots()
    for (body, pairs), error in result["error"].stack(case=("body", "pairs")).groupby("case"):
        style = f"C{list(BODIES).index(body)}" + ("-" if pairs == "coupled" else ":")
        axes.plot(result["phase"] / 256, 1e6 * error.squeeze(), style, label=f"{body}, {pairs}")
    axes.set(xlabel="time [mesh cycles]", ylabel="static transmission error [µm]", ylim=(0, None))
    axes.legend(fontsize=7, loc="lower left")
    return figure


if __name__ == "__main__":
    draw(compute()).savefig("thin_rims.png", dpi=150)
