"""
A gear mesh between two rotors of ROSS
======================================

ROSS makes finite elements of shafts on bearings; this mesh joins two of them. At 4544 Hz the shafts bend and
twist against the mesh; where teeth meet twice as often, vibration grows.
"""

from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import floquet
import lumped

PAIR = lumped.load_gear_pair("nasa_28_28").with_(mesh__relief="ignored", mesh__damping_ratio=0.002)


def ross_shaft():
    """Shaft 30 mm thick, 240 mm between bearings of 2e8 N/m, the gear in its middle, node 2."""
    import ross  # pip install spurcheck[ross]

    body, g = lumped.bodies(PAIR), PAIR.geometry
    sizes = {"m": body.mass_pinion, "Id": body.inertia_pinion / 2, "Ip": body.inertia_pinion}
    teeth = {"n_teeth": 28, "base_diameter": 2 * g.base_radius_pinion, "pr_angle": g.operating_pressure_angle}
    steel = ross.Material(name="steel", rho=7810, E=211e9, G_s=81.2e9)
    shaft = [ross.ShaftElement(L=0.06, idl=0, odl=0.03, material=steel) for _ in range(4)]
    bearings = [ross.BearingElement(n=n, kxx=2e8, kyy=2e8, cxx=120.0, cyy=120.0) for n in (0, 4)]
    return ross.Rotor(shaft, [ross.GearElement(n=2, **sizes, **teeth)], bearings)


def on_shafts(rpm: float) -> floquet.SecondOrderSystem:
    """Both rotors with the mesh between them; the gear's turns the other way."""
    # What ROSS 2.3.0 makes of it; or validation.exchange.ross_rotor(ross_shaft(), 2, rpm) and (..., -rpm).
    with np.load(Path(on_shafts.__code__.co_filename).with_name("25_rotor.npz")) as file:
        M, C, K, G = (file[name] for name in "MCKG")
    speed, station = np.pi / 30.0 * rpm, (12, 13, 17)
    rotors = [floquet.GearRotor(M, C + sign * speed * G, K, station) for sign in (1, -1)]
    return floquet.gears_on_rotors(PAIR.with_(operating__pinion_speed=f"{rpm} rpm"), *rotors, modes=9)


def compute() -> xr.Dataset:
    """Spectral radius over speed."""
    return floquet.scan(lambda at: on_shafts(at["speed_rpm"]), {"speed_rpm": np.linspace(18e3, 21e3, 9)})


def draw(result: xr.Dataset) -> Figure:
    """Show the range of speeds in which vibration grows."""
    axes = Figure(figsize=(7, 3.5), layout="constrained").add_subplot()
    axes.set(xlabel="pinion speed [rpm]", ylabel="spectral radius [-], unstable above 1")
    axes.plot(result["speed_rpm"], result["spectral_radius"], marker=".")
    axes.axhline(1.0, color="0.5", linewidth=0.8)
    return axes.figure


if __name__ == "__main__":
    draw(compute()).savefig("gears_on_rotors.png", dpi=150)
