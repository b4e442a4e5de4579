"""
Bore, rim and neighbour
=======================

What do a bore, a thin rim and a loaded neighbour do to the stiffness of the mesh and to the transmission
error? A free gear hardly feels a bore until its rim bends between the teeth. The neighbour shares the body:
with it two pairs are softer, and so are less different from one.
"""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation

import lumped
from lumped.quasi_static.stressed_pinion import stressed_pinion

BODIES = {"solid": 0.0, "bore 40 mm": 40.0, "rim 3 modules": 61.9}  # bore [mm]


def compute() -> xr.Dataset:
    """Mean stiffness over ISO's and transmission error with three bodies; the stressed pinion."""
    model = {"mesh.stiffness": {"model": "finite_elements"}, "mesh.contact": "loaded"}
    model |= {"pinion.tip_relief": None, "gear.tip_relief": None}
    pair, fields, errors, ratios = lumped.load_gear_pair("nasa_28_28").with_(model), {}, [], []
    for body, bore in BODIES.items():
        one = pair.with_(pinion__bore=bore, gear__bore=bore)
        forms = one, one.with_(mesh__contact="prescribed")  # which leaves pairs alone
        errors.append([lumped.static_transmission_error(form)["transmission_error"][0] for form in forms])
        found = lumped.plane_compliance(one).attrs
        ratios.append([found[name] / found["iso_mean"] for name in ("mean", "mean_alone")])
        fields |= {body: stressed_pinion(one, 0.3)} if bore != 40.0 else {}
    result = xr.Dataset(coords={"body": list(BODIES), "pairs": ["coupled", "alone"]})
    result["error"] = ("body", "pairs", "phase"), np.array(errors)
    return result.assign(mean_over_iso=(("body", "pairs"), ratios)).assign_attrs(fields=fields)


def draw(result: xr.Dataset) -> Figure:
    """Left: von Mises stress on the pinion's teeth, deflected 200 times as far. Right: a mesh cycle."""
    figure = Figure(figsize=(12, 3.6), layout="constrained")
    *pictures, right = figure.subplots(1, 3)
    for ax, (body, field) in zip(pictures, result.attrs["fields"].items(), strict=True):
        mesh = Triangulation(*(1e3 * (field.nodes + 200.0 * field.moved)).T, field.triangles)
        stress = np.clip(field.von_mises * 1e-6, 0.0, 150.0)
        filled = ax.tricontourf(mesh, stress, levels=np.linspace(0.0, 150.0, 16), cmap="turbo")
        ax.plot(*(1e3 * field.nodes[field.surface]).T, "k-", linewidth=0.7)
        ax.set(xlim=(-20, 12), ylim=(25, 50), aspect="equal", title=body, xlabel="x [mm]", ylabel="y [mm]")
    figure.colorbar(filled, ax=pictures, label="von Mises stress [MPa]")
    for (body, pairs), error in result["error"].stack(case=("body", "pairs")).groupby("case"):
        style = f"C{list(BODIES).index(body)}" + ("-" if pairs == "coupled" else ":")
        right.plot(result["phase"] / 256, 1e6 * error.squeeze(), style, label=f"{body}, {pairs}")
    right.set(xlabel="time [mesh cycles]", ylabel="static transmission error [µm]", ylim=(0, None))
    right.legend(fontsize=7, loc="lower left")
    return figure


if __name__ == "__main__":
    draw(compute()).savefig("stressed_teeth.png", dpi=150)
