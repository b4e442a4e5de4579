"""
How do two tooth pairs share the load?
======================================

How do two tooth pairs share the load, and how much longer does deflection make the contact? In the
middle of double contact each carries half. The length of contact grows with about the square root of the
torque, so the contact ratio of the drawing is the smallest one.
"""

import xarray as xr
from matplotlib.figure import Figure

import lumped


def compute() -> xr.Dataset:
    """Loads of the 28/28 pair with perfect involutes and energy stiffness at four torques."""
    pair = lumped.load_gear_pair("nasa_28_28").with_(
        mesh__stiffness={"model": "energy"}, pinion__tip_relief=None, gear__tip_relief=None
    )
    result = lumped.static_transmission_error(pair, [1.0, 28.25, 56.5, 113.0])
    g = lumped.geometry(pair)
    result.attrs |= {"contact_ratio": g.contact_ratio, "A": g.L_XA, "D": g.L_XD, "base_pitch": g.base_pitch}
    return result


def draw(result: xr.Dataset) -> Figure:
    """Share of one pair over its position, A and D marked."""
    figure = Figure(figsize=(7, 4), layout="constrained")
    axes = figure.add_subplot()
    one = result.stack(along=("phase", "pair")).sortby("position")
    for torque in result["torque"].values:
        axes.plot(one["position"] * 1e3, one["load_share"].sel(torque=torque), label=f"{torque:g} N m")
    for end in ("A", "D"):
        axes.axvline(result.attrs[end] * 1e3, color="0.6", linewidth=0.8)
    axes.set(xlabel="distance from X [mm]", ylabel="share of one pair in the load [-]", xlim=(5, 26))
    axes.legend()
    return figure


if __name__ == "__main__":
    found = compute()
    print(f"contact ratio of the rigid pair {found.attrs['contact_ratio']:.4f}")
    for torque, ratio in zip(found["torque"].values, found["contact_ratio"].values, strict=True):
        print(f"under {torque:6.2f} N m            {ratio:.4f}")
    draw(found).savefig("load_sharing.png", dpi=150)
