"""
What does one wrong sign in the equations do?
=============================================

What does the printed sign of eq. 1 do to the pair? It turns friction into a source of power in recess.
"""

import numpy as np
import xarray as xr
from matplotlib.figure import Figure

import lumped


def compute() -> xr.Dataset:
    """Pinion speed deviation with repaired and printed eq. 1, under the balanced brake torque."""
    pair = lumped.load_gear_pair("nasa_28_28").with_(friction__law="coulomb", friction__coefficient=0.05)
    signs: dict[str, tuple[int, ...]] = {"repaired": (), "printed": (1,)}
    runs = {
        name: lumped.simulate(pair, 20, initial="periodic", as_printed=equations)
        for name, equations in signs.items()
    }
    speed = {name: run["theta_p_dot"] for name, run in runs.items()}
    return xr.Dataset(speed, attrs={"mesh_efficiency": runs["repaired"].attrs["mesh_efficiency"]})


def drift(speed: xr.DataArray, cycles: int = 20) -> float:
    """Mean acceleration of the pinion from the first to the last mesh cycle [rad/s^2]."""
    means = speed[:-1].to_numpy().reshape(cycles, -1).mean(axis=1)
    return float((means[-1] - means[0]) / (speed["time"][-1] * (cycles - 1) / cycles))


def draw(result: xr.Dataset) -> Figure:
    """Deviation of the pinion speed over time."""
    figure = Figure(figsize=(7, 4), layout="constrained")
    axes = figure.add_subplot()
    for name in ("repaired", "printed"):
        axes.plot(result["time"] * 1e3, result[name] * 30 / np.pi, label=f"eq. 1 {name}")
    axes.set(xlabel="time [ms]", ylabel="pinion speed, deviation from nominal [rpm]")
    axes.legend()
    return figure


if __name__ == "__main__":
    draw(compute()).savefig("errata.png", dpi=150)
