"""
What is my tooth stiffness made of?
===================================

How much of the compliance is contact, tooth and gear body, and how far is the sum from ISO 6336-1? Gear
bodies and teeth yield about alike, the contact half as much, and the sum lies in the scatter that the
standard states.
"""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import lumped
from lumped.stiffness import iso6336
from lumped.stiffness.energy import HertzLaw, energy_curve


def over_iso(pair: lumped.GearPair, contact: HertzLaw = "weber_banaschek") -> tuple[float, float, float]:
    """Energy stiffness over ISO 6336-1's: mean of the mesh, and its factors by size and by shape."""
    g = pair.geometry
    curve = energy_curve(pair, contact)
    mean = curve.mean() * g.contact_ratio / iso6336.mean_of(pair)
    size = float(curve(np.linspace(g.L_XA, g.L_XD, 402)[1:-1]).max()) / iso6336.single_of(pair)
    return mean, size, mean / size


def at_load(pair: lumped.GearPair, load: float) -> lumped.GearPair:
    """The pair with a tangential load per face width [N/mm] on the reference circle."""
    g = pair.geometry
    return pair.with_(operating__pinion_torque=load * 1e3 * g.face_width * g.reference_radius_pinion)


def compute() -> xr.Dataset:
    """Compliances of the 28/28 pair over the path of contact, and its mean mesh stiffness over ISO's."""
    pair = lumped.load_gear_pair("nasa_28_28")
    result = lumped.stiffness_components(pair)
    result.attrs["mean_over_iso"] = over_iso(pair)[0]
    result.attrs["linearised_over_iso"] = over_iso(pair, "linear")[0]
    return result


def draw(result: xr.Dataset) -> Figure:
    """Draw the parts of the compliance, stacked, and the stiffness of the tooth pair."""
    figure = Figure(figsize=(9, 4), layout="constrained")
    compliance_axes, stiffness_axes = figure.subplots(1, 2)
    xi = result["position"] * 1e3
    compliance_axes.stackplot(xi, result["compliance"] * 1e9, labels=result["component"].values)
    compliance_axes.set(xlabel="distance from X [mm]", ylabel="compliance [nm/N]", ylim=(0, 26))
    compliance_axes.legend(ncols=2, fontsize="small", loc="upper center")
    stiffness_axes.plot(xi, result["stiffness"] * 1e-6, label="tooth pair")
    stiffness_axes.axhline(
        result.attrs["iso_single_stiffness"] * 1e-6, linestyle="--", label="ISO 6336-1 c' b"
    )
    stiffness_axes.set(xlabel="distance from X [mm]", ylabel="stiffness [MN/m]", ylim=(0, None))
    stiffness_axes.legend()
    return figure


if __name__ == "__main__":
    found = compute()
    share = found["compliance"].mean("position") / found["compliance"].sum("component").mean("position")
    for part in share["component"].values:
        print(f"{part:18s}{float(share.sel(component=part)):7.1%} of the mean compliance")
    for name in lumped.preset_names():
        one = lumped.load_gear_pair(name)
        print(f"\n{name}: energy stiffness over ISO 6336-1, as a whole, in size, in shape")
        print("as given            " + "".join(f"{ratio:8.3f}" for ratio in over_iso(one)))
        for load in (100.0, 1600.0):
            print(f"{load:4g} N/mm           " + "".join(f"{r:8.3f}" for r in over_iso(at_load(one, load))))
        print("linearised contact  " + "".join(f"{ratio:8.3f}" for ratio in over_iso(one, "linear")))
    draw(found).savefig("stiffness_components.png", dpi=150)
