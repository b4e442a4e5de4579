"""
What is my tooth stiffness made of?
===================================

How much of the compliance is contact, tooth and gear body, and how far is the sum from ISO 6336-1? Gear
bodies and teeth have about the same compliance, the contact half as much, and the sum is within the scatter
that the standard states.
"""

import xarray as xr
from matplotlib.figure import Figure

import lumped
from lumped.path_of_contact.stiffness import iso_comparison


def compute() -> xr.Dataset:
    """Compliances of the 28/28 pair over the path of contact, and its mean mesh stiffness over ISO's."""
    pair = lumped.load_gear_pair("nasa_28_28")
    result = lumped.stiffness_components(pair)
    compared = iso_comparison(pair)
    result.attrs["mean_over_iso"] = float(compared["mean_ratio"].sel(variant="as given"))
    result.attrs["linearised_over_iso"] = float(compared["mean_ratio"].sel(variant="linearised contact"))
    return result


def draw(result: xr.Dataset) -> Figure:
    """Parts, stacked, and the pair's stiffness."""
    figure = Figure(figsize=(9, 4), layout="constrained")
    left, right = figure.subplots(1, 2)
    xi = result["position"] * 1e3
    left.stackplot(xi, result["compliance"] * 1e9, labels=result["component"].values)
    left.set(xlabel="distance from X [mm]", ylabel="compliance [nm/N]", ylim=(0, 26))
    left.legend(ncols=2, fontsize="small", loc="upper center")
    right.plot(xi, result["stiffness"] * 1e-6, label="tooth pair")
    right.axhline(result.attrs["iso_single_stiffness"] * 1e-6, linestyle="--", label="ISO 6336-1 c' b")
    right.set(xlabel="distance from X [mm]", ylabel="stiffness [MN/m]", ylim=(0, None))
    right.legend()
    return figure


if __name__ == "__main__":
    found = compute()
    share = found["compliance"].mean("position") / found["compliance"].sum("component").mean("position")
    for part in share["component"].values:
        print(f"{part:18s}{float(share.sel(component=part)):7.1%} of the mean compliance")
    for name in lumped.preset_names():
        compared = iso_comparison(lumped.load_gear_pair(name))
        print(f"\n{name}: energy stiffness over ISO 6336-1, as a whole, in size, in shape")
        print(compared.to_dataframe().round(3).to_string(header=False))
    draw(found).savefig("stiffness_components.png", dpi=150)
